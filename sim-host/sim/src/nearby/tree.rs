//! A k-d tree, by the crate `kiddo`.

use super::nearest::Nearest;
use super::{Found, Query, Real, Search, Space, numbered};

/// A k-d tree: O(n log n) to build, O(log n + found) for most queries, wherever points lie.
///
/// The library says who may be near; distances, limits and order are computed here, as by the other searches.
/// On a torus the ball is looked for once more for each border that it crosses.
#[derive(Clone, Debug)]
pub struct Tree<R: Real, const D: usize> {
    space: Space<R, D>,
    /// `None`: no points.
    tree: Option<R::Over<D>>,
    /// Folded; those that are not finite are left out.
    points: Vec<[R; D]>,
    /// Their indices for those who built the tree; empty when nobody was left out.
    indices: Vec<u32>,
}

impl<R: Real, const D: usize> Tree<R, D> {
    /// A search over no points yet.
    #[must_use]
    pub const fn new(space: Space<R, D>) -> Self {
        Self { space, tree: None, points: Vec::new(), indices: Vec::new() }
    }
}

impl<R: Real, const D: usize> Search<R, D> for Tree<R, D> {
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
            // A point may be in several images of so large a ball.
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

/// The centres of a ball and of those of its images around the torus that may reach into it.
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

/// The squared radius for the library: a little more, because it may round otherwise.
fn squared<R: Real, const D: usize>(at: &[R; D], radius: R) -> R {
    let far = at.iter().fold(radius, |far, &c| far.max(c.abs()));
    let reach = radius + margin(far, radius);
    // Where the square is too small for a number, the smallest number will do.
    let squared = reach * reach + R::EPSILON * R::EPSILON * R::EPSILON;
    squared.min(R::MAX)
}

/// More than rounding can lose in differences of such coordinates.
pub(super) fn margin<R: Real>(coordinate: R, length: R) -> R {
    (coordinate.abs() + length) * R::EPSILON * R::from_i32(8)
}

fn quarter<R: Real>() -> R {
    R::HALF * R::HALF
}

fn is_finite<R: Real, const D: usize>(point: &[R; D]) -> bool {
    point.iter().all(|c| c.is_finite())
}
