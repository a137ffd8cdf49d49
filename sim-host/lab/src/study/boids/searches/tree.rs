//! A k-d tree of the crate `kiddo`.

use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;
use staya_sim::nearby::{Found, Nearest, Query, Real, Search, Space, margin, numbered};

const LEAF: usize = 32;

/// A number type supported by the library, whose own trait bounds are not public.
pub trait Grow: Real {
    /// The library's tree for this number type.
    type Over<const D: usize>: Clone + std::fmt::Debug + Send + Sync;

    /// Builds the tree over at least one point; all points are finite.
    fn grow<const D: usize>(points: &[[Self; D]]) -> Self::Over<D>;

    /// Calls `each` with the index of every point within the root of `squared`.
    fn visit<const D: usize>(tree: &Self::Over<D>, at: &[Self; D], squared: Self, each: &mut dyn FnMut(u32));
}

macro_rules! impl_tree {
    ($float:ident) => {
        impl Grow for $float {
            type Over<const D: usize> = ImmutableKdTree<$float, u32, D, LEAF>;

            fn grow<const D: usize>(points: &[[Self; D]]) -> Self::Over<D> {
                ImmutableKdTree::new_from_slice(points)
            }

            fn visit<const D: usize>(tree: &Self::Over<D>, at: &[Self; D], squared: Self, each: &mut dyn FnMut(u32)) {
                for found in tree.within_unsorted::<SquaredEuclidean>(at, squared) {
                    each(found.item);
                }
            }
        }
    };
}

impl_tree!(f32);
impl_tree!(f64);

/// The k-d tree of the crate `kiddo`. Build: O(n log n). Query: O(log n + found) for most queries.
///
/// The library returns candidates; distances, limits and order are computed as in the other
/// searches. On a torus, a ball is searched once more for each border that it crosses.
#[derive(Clone, Debug)]
pub struct Tree<R: Grow, const D: usize> {
    space: Space<R, D>,
    tree: Option<R::Over<D>>,
    points: Vec<[R; D]>,
    /// Original indices; empty if all points are finite.
    indices: Vec<u32>,
}

impl<R: Grow, const D: usize> Tree<R, D> {
    /// Creates a search without points.
    #[must_use]
    pub const fn new(space: Space<R, D>) -> Self {
        Self { space, tree: None, points: Vec::new(), indices: Vec::new() }
    }
}

impl<R: Grow, const D: usize> Search<R, D> for Tree<R, D> {
    fn rebuild(&mut self, points: &[[R; D]]) {
        let count = numbered(points);
        self.points.clear();
        self.indices.clear();
        for (index, &point) in (0..count).zip(points) {
            let point = self.space.fold(point);
            if is_finite(&point) {
                self.points.push(point);
                self.indices.push(index);
            }
        }
        self.tree = (!self.points.is_empty()).then(|| R::grow(&self.points));
    }

    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>) {
        let mut nearest = Nearest::new(query, found);
        let at = self.space.fold(query.at);
        let tree = self.tree.as_ref();
        let Some(tree) = tree.filter(|_| query.radius >= R::ZERO && is_finite(&at)) else {
            return nearest.finish();
        };
        let mut offer = |place: u32| {
            let point = self.points[place as usize];
            nearest.offer(self.indices[place as usize], self.space.offset(at, point));
        };
        let Some(period) = self.space.period() else {
            R::visit(tree, &at, squared(&at, query.radius), &mut offer);
            return nearest.finish();
        };
        let balls = images(at, query.radius, period);
        let is_apart = (0..D).all(|axis| query.radius < period[axis] * quarter());
        if is_apart {
            for ball in &balls {
                R::visit(tree, ball, squared(ball, query.radius), &mut offer);
            }
        } else {
            let mut places = Vec::new();
            for ball in &balls {
                let squared = squared(ball, query.radius);
                R::visit(tree, ball, squared, &mut |place| places.push(place));
            }
            places.sort_unstable();
            places.dedup();
            places.into_iter().for_each(offer);
        }
        nearest.finish();
    }
}

/// Centres of the ball and of those images around the torus that may reach into it.
pub(super) fn images<R: Real, const D: usize>(at: [R; D], radius: R, period: [R; D]) -> Vec<[R; D]> {
    let mut balls = vec![at];
    for axis in 0..D {
        let reach = radius + margin(at[axis], radius + period[axis]);
        let (low, high) = (at[axis] - reach, at[axis] + reach);
        for index in 0..balls.len() {
            let mut moved = |by: R| {
                let mut ball = balls[index];
                ball[axis] = at[axis] + by;
                balls.push(ball);
            };
            if low <= R::ZERO {
                moved(period[axis]);
            }
            if high >= period[axis] {
                moved(-period[axis]);
            }
        }
    }
    balls
}

/// Slightly enlarged, because the library may round differently.
fn squared<R: Real, const D: usize>(at: &[R; D], radius: R) -> R {
    let far = at.iter().fold(radius, |far, &c| far.max(c.abs()));
    let reach = radius + margin(far, radius);
    // The square may underflow.
    let squared = reach * reach + R::EPSILON * R::EPSILON * R::EPSILON;
    squared.min(R::MAX)
}

fn quarter<R: Real>() -> R {
    R::HALF * R::HALF
}

fn is_finite<R: Real, const D: usize>(point: &[R; D]) -> bool {
    point.iter().all(|c| c.is_finite())
}
