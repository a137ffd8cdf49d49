//! Collects the nearest of a sequence of points.

use super::{Query, Real};
use std::cmp::Ordering;

/// Up to this number of results, points are inserted in order; more are sorted at intervals.
const FEW: usize = 32;

/// A search result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<R, const D: usize> {
    /// Index of the point.
    pub index: u32,
    /// Squared distance from the query's centre.
    pub distance_squared: R,
    /// Vector from the query's centre to the point.
    pub offset: [R; D],
}

impl<R: Real, const D: usize> Found<R, D> {
    fn order(&self, other: &Self) -> Ordering {
        let nearer = self.distance_squared.order(other.distance_squared);
        nearer.then(self.index.cmp(&other.index))
    }

    #[inline]
    fn is_before(&self, other: &Self) -> bool {
        self.distance_squared < other.distance_squared
            || (self.distance_squared == other.distance_squared && self.index < other.index)
    }
}

/// Collects the nearest of the offered points. Holds at most twice the requested number, or 64.
pub struct Nearest<'a, R, const D: usize> {
    found: &'a mut Vec<Found<R, D>>,
    /// Squared limit: the radius, later the distance of the farthest kept point.
    limit: R,
    most: usize,
    except: Option<u32>,
}

impl<'a, R: Real, const D: usize> Nearest<'a, R, D> {
    /// Clears `found` and collects results there.
    pub fn new(query: &Query<R, D>, found: &'a mut Vec<Found<R, D>>) -> Self {
        found.clear();
        // Squaring would make a negative radius positive.
        let limit = if query.radius >= R::ZERO && query.most > 0 {
            // Points at infinite distance are never found.
            (query.radius * query.radius).min(R::MAX)
        } else {
            -R::ONE
        };
        Self { found, limit, most: query.most, except: query.except }
    }

    /// Offers a point at `offset` from the query's centre.
    #[inline]
    pub fn offer(&mut self, index: u32, offset: [R; D]) {
        let mut distance_squared = R::ZERO;
        for way in offset {
            distance_squared += way * way;
        }
        if distance_squared <= self.limit && self.except != Some(index) {
            self.keep(Found { index, distance_squared, offset });
        }
    }

    /// Whether points at this distance or more (above 0) are out of the limit.
    #[inline]
    pub fn is_beyond(&self, distance: R) -> bool {
        distance * distance > self.limit
    }

    #[inline]
    fn keep(&mut self, new: Found<R, D>) {
        if self.most > FEW {
            self.found.push(new);
            if self.found.len() >= self.most.saturating_mul(2) {
                self.shrink();
            }
            return;
        }
        if self.found.len() == self.most {
            match self.found.last() {
                Some(last) if new.is_before(last) => drop(self.found.pop()),
                _ => return,
            }
        }
        let mut place = self.found.len();
        self.found.push(new);
        while place > 0 && new.is_before(&self.found[place - 1]) {
            self.found[place] = self.found[place - 1];
            place -= 1;
        }
        self.found[place] = new;
        if let Some(last) = self.found.last().filter(|_| self.found.len() == self.most) {
            self.limit = last.distance_squared;
        }
    }

    fn shrink(&mut self) {
        if self.found.len() > self.most {
            let (_, last, _) = self.found.select_nth_unstable_by(self.most - 1, Found::order);
            self.limit = last.distance_squared;
            self.found.truncate(self.most);
        }
    }

    /// Sorts the results.
    pub fn finish(mut self) {
        if self.most > FEW {
            self.shrink();
            self.found.sort_unstable_by(Found::order);
        }
    }
}
