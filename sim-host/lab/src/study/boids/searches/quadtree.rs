//! A quadtree with a point in each node.

use super::tree::images;
use staya_sim::nearby::{Found, Nearest, Query, Real, Search, Space, margin, numbered};

/// A quadtree as STA, section 2.3, describes it: a node has a boid and the subtrees of those to its
/// north-east, north-west, south-west and south-east.
///
/// Boids are inserted in their order. Build: O(n log n) for randomly ordered points, at worst
/// O(n^2). Query: O(log n + found) for most queries. On a torus, a ball is searched once more for
/// each border that it crosses.
#[derive(Clone, Debug)]
pub struct Quadtree<R> {
    space: Space<R, 2>,
    nodes: Vec<Node<R>>,
}

#[derive(Clone, Copy, Debug)]
struct Node<R> {
    index: u32,
    at: [R; 2],
    /// Numbers of nodes; 0, the root, is the child of none.
    children: [u32; 4],
}

/// East or north include points with an equal coordinate.
const fn quadrant(is_east: bool, is_north: bool) -> usize {
    match (is_east, is_north) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    }
}

impl<R: Real> Quadtree<R> {
    /// Creates a search without points.
    #[must_use]
    pub const fn new(space: Space<R, 2>) -> Self {
        Self { space, nodes: Vec::new() }
    }

    fn insert(&mut self, index: u32, at: [R; 2]) {
        let new = self.nodes.len() as u32;
        let mut here = 0;
        while let Some(node) = self.nodes.get_mut(here) {
            let child = &mut node.children[quadrant(at[0] >= node.at[0], at[1] >= node.at[1])];
            if *child == 0 {
                *child = new;
                break;
            }
            here = *child as usize;
        }
        self.nodes.push(Node { index, at, children: [0; 4] });
    }

    fn visit(&self, ball: [R; 2], radius: R, at: [R; 2], each: &mut dyn FnMut(u32, [R; 2])) {
        let reach = radius + margin(ball[0].abs().max(ball[1].abs()), radius);
        let mut open = vec![0_u32];
        while let Some(node) = open.pop().and_then(|number| self.nodes.get(number as usize)) {
            each(node.index, self.space.offset(at, node.at));
            let reaches = |axis: usize| [ball[axis] - reach < node.at[axis], ball[axis] + reach >= node.at[axis]];
            let (across, along) = (reaches(0), reaches(1));
            for (is_east, is_north) in [(true, true), (false, true), (false, false), (true, false)] {
                let child = node.children[quadrant(is_east, is_north)];
                if child != 0 && across[usize::from(is_east)] && along[usize::from(is_north)] {
                    open.push(child);
                }
            }
        }
    }
}

impl<R: Real> Search<R, 2> for Quadtree<R> {
    fn rebuild(&mut self, points: &[[R; 2]]) {
        let count = numbered(points);
        self.nodes.clear();
        for (index, &point) in (0..count).zip(points) {
            let at = self.space.fold(point);
            if at.iter().all(|c| c.is_finite()) {
                self.insert(index, at);
            }
        }
    }

    fn within(&self, query: &Query<R, 2>, found: &mut Vec<Found<R, 2>>) {
        let mut nearest = Nearest::new(query, found);
        let at = self.space.fold(query.at);
        if !(query.radius >= R::ZERO && at.iter().all(|c| c.is_finite())) {
            return nearest.finish();
        }
        let balls = self.space.period().map_or(vec![at], |period| images(at, query.radius, period));
        let mut ways = Vec::new();
        for ball in balls {
            self.visit(ball, query.radius, at, &mut |index, way| ways.push((index, way)));
        }
        // A ball and its image may find the same point.
        ways.sort_unstable_by_key(|(index, _)| *index);
        ways.dedup_by_key(|(index, _)| *index);
        ways.into_iter().for_each(|(index, way)| nearest.offer(index, way));
        nearest.finish();
    }
}
