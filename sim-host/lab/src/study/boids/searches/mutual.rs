//! Search over all pairs.

use staya_sim::nearby::{Found, Nearest, Query, Real, Search, Space, numbered};

/// Search over all pairs that uses each distance for both points (STA, section 2.2).
///
/// Build: O(n^2), with half the distances of [`AllPairs`](staya_sim::nearby::AllPairs); stores
/// every pair within the radius. Queries at its points use these pairs; other points or larger
/// radii search all points.
#[derive(Clone, Debug)]
pub struct MutualPairs<R, const D: usize> {
    space: Space<R, D>,
    radius: R,
    points: Vec<[R; D]>,
    near: Vec<Vec<(u32, [R; D])>>,
}

impl<R: Real, const D: usize> MutualPairs<R, D> {
    /// Creates a search without points, for queries of at most this radius at its points.
    #[must_use]
    pub const fn new(space: Space<R, D>, radius: R) -> Self {
        Self { space, radius, points: Vec::new(), near: Vec::new() }
    }
}

impl<R: Real, const D: usize> Search<R, D> for MutualPairs<R, D> {
    fn rebuild(&mut self, points: &[[R; D]]) {
        let count = numbered(points);
        self.points.clear();
        let folded = points.iter().map(|&point| self.space.fold(point));
        self.points.extend(folded);
        self.near.resize(points.len(), Vec::new());
        self.near.iter_mut().for_each(Vec::clear);
        let limit = (self.radius * self.radius).min(R::MAX);
        for one in 0..count {
            let at = self.points[one as usize];
            for (other, &point) in (one + 1..count).zip(&self.points[one as usize + 1..]) {
                let way = self.space.offset(at, point);
                let mut squared = R::ZERO;
                for along in way {
                    squared += along * along;
                }
                if squared <= limit {
                    self.near[one as usize].push((other, way));
                    self.near[other as usize].push((one, way.map(|along| -along)));
                }
            }
        }
    }

    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>) {
        let at = self.space.fold(query.at);
        let mut nearest = Nearest::new(query, found);
        let asks = query.except.filter(|&own| {
            query.radius <= self.radius && self.points.get(own as usize).is_some_and(|&point| point == at)
        });
        if let Some(own) = asks {
            for &(index, way) in &self.near[own as usize] {
                nearest.offer(index, way);
            }
        } else {
            for (index, &point) in (0..).zip(&self.points) {
                nearest.offer(index, self.space.offset(at, point));
            }
        }
        nearest.finish();
    }
}
