//! Neighbour search over whole swarms: for metrics, experiments without a radio, and benchmarks.
//!
//! All searches share the interface [`Search`] and give identical results, bit for bit:
//! [`AllPairs`] is the reference, [`Cells`] is for use. They work in two or three dimensions, in
//! `f32` or `f64`, in open space or on a torus ([`Space`]).
//!
//! Robots do not use this: their information arrives as bytes.

mod cells;
mod nearest;
mod space;
#[cfg(test)]
mod tests;

pub use cells::Cells;
pub use nearest::{Found, Nearest};
pub use space::{Real, Space, margin};

/// A search query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<R, const D: usize> {
    /// Centre of the search.
    pub at: [R; D],
    /// Search radius, inclusive; a negative radius or NaN finds nothing.
    pub radius: R,
    /// Largest number of results: the nearest ones, by (squared distance, index).
    pub most: usize,
    /// Index of a point to exclude, usually that of the querying robot.
    pub except: Option<u32>,
}

/// A search for the points within a radius.
///
/// All implementations give identical results, bit for bit: [`Space::offset`] computes distances in
/// the precision of `R`, which are summed over the axes in order.
pub trait Search<R: Real, const D: usize>: Sync {
    /// Replaces all points; their indices are their positions in the slice. Points with a
    /// coordinate that is not finite are never found.
    ///
    /// # Panics
    /// If there are more than 2^32 - 1 points.
    fn rebuild(&mut self, points: &[[R; D]]);

    /// Replaces `found` by the points in the radius, sorted by (squared distance, index).
    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>);
}

/// Visits every point: O(n) per query; building only copies the points.
#[derive(Clone, Debug)]
pub struct AllPairs<R, const D: usize> {
    space: Space<R, D>,
    points: Vec<[R; D]>,
}

impl<R: Real, const D: usize> AllPairs<R, D> {
    /// Creates an empty index.
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

/// Number of points.
///
/// # Panics
/// If there are more than 2^32 - 1 points.
#[must_use]
pub fn numbered<R, const D: usize>(points: &[[R; D]]) -> u32 {
    u32::try_from(points.len()).expect("no more than 2^32 - 1 points")
}
