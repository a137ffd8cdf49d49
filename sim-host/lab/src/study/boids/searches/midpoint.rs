//! A k-d tree whose boxes are cut in the middle.

use super::tree::images;
use staya_sim::nearby::{Found, Nearest, Query, Real, Search, Space, margin, numbered};

/// As in scipy's `KDTree`, which STA's listing uses.
const LEAF: usize = 10;

#[derive(Clone, Copy, Debug)]
enum Node<R> {
    /// Range of points in the tree's order, without its end.
    Leaf(u32, u32),
    /// Points below `at` along `axis` are in the next node, others in node `above`.
    Cut { axis: u8, at: R, above: u32 },
}

/// A k-d tree by the sliding midpoint rule (S. Maneewongvatana and D. M. Mount 1999; STA, section
/// 2.2): a box is cut in the middle of its longest side. If all points lie on one side, the cut
/// slides to the nearest point, so that no leaf is empty.
///
/// Build: O(n log n) for evenly distributed points, at worst O(n^2). Query: O(log n + found) for
/// most queries. On a torus, a ball is searched once more for each border that it crosses.
#[derive(Clone, Debug)]
pub struct MidpointTree<R, const D: usize> {
    space: Space<R, D>,
    nodes: Vec<Node<R>>,
    order: Vec<u32>,
    /// In that order, folded into the torus.
    points: Vec<[R; D]>,
}

impl<R: Real, const D: usize> MidpointTree<R, D> {
    /// Creates a search without points.
    #[must_use]
    pub const fn new(space: Space<R, D>) -> Self {
        Self { space, nodes: Vec::new(), order: Vec::new(), points: Vec::new() }
    }

    /// Uses an explicit stack, because the tree may be as deep as there are points.
    fn grow(&mut self, folded: &[[R; D]]) {
        let (mut low, mut high) = ([R::MAX; D], [-R::MAX; D]);
        for &index in &self.order {
            for axis in 0..D {
                low[axis] = low[axis].min(folded[index as usize][axis]);
                high[axis] = high[axis].max(folded[index as usize][axis]);
            }
        }
        let mut open = vec![Open { from: 0, to: self.order.len(), low, high, parent: None }];
        while let Some(Open { from, to, low, high, parent }) = open.pop() {
            let here = self.nodes.len() as u32;
            // The subtree above a cut is built after the one below, so its index is stored now.
            if let Some(Node::Cut { above, .. }) = parent.and_then(|parent| self.nodes.get_mut(parent as usize)) {
                *above = here;
            }
            let part = &mut self.order[from..to];
            let Some((axis, at)) = (part.len() > LEAF).then(|| cut(part, folded, low, high)).flatten() else {
                self.nodes.push(Node::Leaf(from as u32, to as u32));
                continue;
            };
            let middle = from + partition(part, |index| folded[index as usize][axis] < at);
            self.nodes.push(Node::Cut { axis: axis as u8, at, above: 0 });
            let (mut below_high, mut above_low) = (high, low);
            (below_high[axis], above_low[axis]) = (at, at);
            open.push(Open { from: middle, to, low: above_low, high, parent: Some(here) });
            open.push(Open { from, to: middle, low, high: below_high, parent: None });
        }
    }

    fn visit(&self, ball: [R; D], radius: R, at: [R; D], each: &mut dyn FnMut(u32, [R; D])) {
        let reach = radius + margin(ball.iter().fold(radius, |far, &c| far.max(c.abs())), radius);
        let mut open = vec![0_u32];
        while let Some(number) = open.pop() {
            match self.nodes.get(number as usize) {
                Some(&Node::Cut { axis, at, above }) => {
                    let along = ball[usize::from(axis)];
                    if along + reach >= at {
                        open.push(above);
                    }
                    if along - reach < at {
                        open.push(number + 1);
                    }
                }
                Some(&Node::Leaf(from, to)) => {
                    let range = from as usize..to as usize;
                    for (&index, &point) in self.order[range.clone()].iter().zip(&self.points[range]) {
                        each(index, self.space.offset(at, point));
                    }
                }
                None => {}
            }
        }
    }
}

/// The nearest point of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint<R> {
    /// Its squared distance; the largest number if there is no point.
    pub distance_squared: R,
    /// Points whose distance was computed.
    pub visits: u64,
}

impl<R: Real, const D: usize> MidpointTree<R, D> {
    /// The nearest point in open space. Boxes beyond the nearest point found so far are skipped;
    /// the squared distance to a box changes along one axis with each cut (S. Arya and D. M. Mount
    /// 1993).
    #[must_use]
    pub fn nearest(&self, at: [R; D]) -> NearestPoint<R> {
        let mut best = NearestPoint { distance_squared: R::MAX, visits: 0 };
        let mut open = vec![(0_u32, R::ZERO, [R::ZERO; D])];
        while let Some((number, box_squared, ways)) = open.pop() {
            if box_squared >= best.distance_squared {
                continue;
            }
            match self.nodes.get(number as usize) {
                Some(&Node::Cut { axis, at: cut, above }) => {
                    let axis = usize::from(axis);
                    let way = at[axis] - cut;
                    let (near, far) = if way < R::ZERO { (number + 1, above) } else { (above, number + 1) };
                    let mut far_ways = ways;
                    far_ways[axis] = way;
                    let far_squared = far_ways.iter().fold(R::ZERO, |sum, &way| sum + way * way);
                    open.push((far, far_squared, far_ways));
                    open.push((near, box_squared, ways));
                }
                Some(&Node::Leaf(from, to)) => {
                    for point in &self.points[from as usize..to as usize] {
                        let squared = |sum: R, axis: usize| sum + (point[axis] - at[axis]) * (point[axis] - at[axis]);
                        best.distance_squared = best.distance_squared.min((0..D).fold(R::ZERO, squared));
                        best.visits += 1;
                    }
                }
                None => {}
            }
        }
        best
    }
}

struct Open<R, const D: usize> {
    from: usize,
    to: usize,
    low: [R; D],
    high: [R; D],
    parent: Option<u32>,
}

/// Axis and place of a cut with points on both sides; `None` if all points coincide.
fn cut<R: Real, const D: usize>(part: &[u32], points: &[[R; D]], low: [R; D], high: [R; D]) -> Option<(usize, R)> {
    let along = |axis: usize| part.iter().map(move |&index| points[index as usize][axis]);
    let ends = |axis: usize| along(axis).fold((R::MAX, -R::MAX), |(low, high), c| (low.min(c), high.max(c)));
    let mut axes: [usize; D] = std::array::from_fn(|axis| axis);
    axes.sort_by(|&a, &b| (high[b] - low[b]).order(high[a] - low[a]));
    let (axis, (least, greatest)) = axes.into_iter().map(|axis| (axis, ends(axis))).find(|(_, (a, b))| a < b)?;
    let middle = low[axis] + (high[axis] - low[axis]) * R::HALF;
    let at = if middle > greatest {
        greatest
    } else if middle <= least {
        along(axis).filter(|c| *c > least).fold(R::MAX, R::min)
    } else {
        middle
    };
    Some((axis, at))
}

fn partition(part: &mut [u32], is_below: impl Fn(u32) -> bool) -> usize {
    let mut below = 0;
    for place in 0..part.len() {
        if is_below(part[place]) {
            part.swap(below, place);
            below += 1;
        }
    }
    below
}

impl<R: Real, const D: usize> Search<R, D> for MidpointTree<R, D> {
    fn rebuild(&mut self, points: &[[R; D]]) {
        let count = numbered(points);
        let folded: Vec<[R; D]> = points.iter().map(|&point| self.space.fold(point)).collect();
        self.nodes.clear();
        self.order.clear();
        let is_finite = |index: &u32| folded[*index as usize].iter().all(|c| c.is_finite());
        self.order.extend((0..count).filter(is_finite));
        self.grow(&folded);
        self.points.clear();
        self.points.extend(self.order.iter().map(|&index| folded[index as usize]));
    }

    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>) {
        let mut nearest = Nearest::new(query, found);
        let at = self.space.fold(query.at);
        if !(query.radius >= R::ZERO && at.iter().all(|c| c.is_finite())) {
            return nearest.finish();
        }
        let Some(period) = self.space.period() else {
            self.visit(at, query.radius, at, &mut |index, way| nearest.offer(index, way));
            return nearest.finish();
        };
        let mut ways = Vec::new();
        for ball in images(at, query.radius, period) {
            self.visit(ball, query.radius, at, &mut |index, way| ways.push((index, way)));
        }
        ways.sort_unstable_by_key(|(index, _)| *index);
        ways.dedup_by_key(|(index, _)| *index);
        ways.into_iter().for_each(|(index, way)| nearest.offer(index, way));
        nearest.finish();
    }
}
