//! Who is near whom, for everything that the host computes over whole swarms: metrics, experiments without a radio,
//! benchmarks.
//!
//! Searches with one interface, [`Search`], and equal answers, bit for bit: [`AllPairs`] is the reference, [`Cells`] is the one to
//! use. In two or three dimensions, in f32 or f64, in the open or on a torus ([`Space`]).
//!
//! Robots never see any of this: they know what arrives as bytes.

mod cells;
mod nearest;
mod space;
#[cfg(test)]
mod tests;

pub use cells::Cells;
pub use nearest::{Found, Nearest};
pub use space::{Real, Space, margin};

/// What to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<R, const D: usize> {
    /// Around which place.
    pub at: [R; D],
    /// How far at most, inclusive; nothing is found within a radius that is negative or not a number.
    pub radius: R,
    /// How many at most: the nearest ones, by (squared distance, index).
    pub most: usize,
    /// The point that does not count: who asks.
    pub except: Option<u32>,
}

/// A search for the points within a radius.
///
/// All implementations give the same answers, bit for bit: distances are computed by [`Space::offset`] in the
/// precision of `R` and summed over the axes in order.
pub trait Search<R: Real, const D: usize>: Sync {
    /// Takes these points instead of those before; their indices are their places in the slice. Points with a coordinate that
    /// is not finite are never found.
    ///
    /// # Panics
    /// When there are more than 2^32 - 1 points.
    fn rebuild(&mut self, points: &[[R; D]]);

    /// Puts the points within the radius into `found`, which is emptied first, in the order of (squared distance, index).
    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>);
}

/// Looks at every point: O(n) a query, O(1) to build but for the copy.
#[derive(Clone, Debug)]
pub struct AllPairs<R, const D: usize> {
    space: Space<R, D>,
    points: Vec<[R; D]>,
}

impl<R: Real, const D: usize> AllPairs<R, D> {
    /// A search over no points yet.
    #[must_use]
    pub const fn new(space: Space<R, D>) -> Self {
        Self { space, points: Vec::new() }
    }
}

impl<R: Real, const D: usize> Search<R, D> for AllPairs<R, D> {
    fn rebuild(&mut self, points: &[[R; D]]) {
        let _ = numbered(points);
        self.points.clear();
        let folded = points.iter().map(|&point| self.space.fold(point));
        self.points.extend(folded);
    }

    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>) {
        let at = self.space.fold(query.at);
        let mut nearest = Nearest::new(query, found);
        for (index, &point) in (0..).zip(&self.points) {
            nearest.offer(index, self.space.offset(at, point));
        }
        nearest.finish();
    }
}

/// The number of points.
///
/// # Panics
/// When there are more than 2^32 - 1.
#[must_use]
pub fn numbered<R, const D: usize>(points: &[[R; D]]) -> u32 {
    u32::try_from(points.len()).expect("no more than 2^32 - 1 points")
}
