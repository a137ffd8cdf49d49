//! The nearest of many that are offered, in order.

use super::{Query, Real};
use std::cmp::Ordering;

/// Up to so many are kept in order as they come; more are sorted now and then.
const FEW: usize = 32;

/// A point that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<R, const D: usize> {
    /// Its place among the points.
    pub index: u32,
    /// Its squared distance.
    pub distance_squared: R,
    /// The way to it.
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

/// Keeps the nearest of the points that are offered to it. Never holds more than twice what is wanted, or
/// 64.
pub struct Nearest<'a, R, const D: usize> {
    found: &'a mut Vec<Found<R, D>>,
    /// What is farther does not count: the radius, later the farthest of those that are kept.
    limit: R,
    most: usize,
    except: Option<u32>,
}

impl<'a, R: Real, const D: usize> Nearest<'a, R, D> {
    /// Empties `found` and collects there.
    pub fn new(query: &Query<R, D>, found: &'a mut Vec<Found<R, D>>) -> Self {
        found.clear();
        // The square of a negative radius would be that of its opposite.
        let limit = if query.radius >= R::ZERO && query.most > 0 {
            // What is infinitely far is never found.
            (query.radius * query.radius).min(R::MAX)
        } else {
            -R::ONE
        };
        Self { found, limit, most: query.most, except: query.except }
    }

    /// A point at this way from the place that the query is about.
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

    /// Whether nothing counts any more that is at least so far away (more than 0).
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

    /// Forgets all but the wanted ones; what is farther than those does not come in any more.
    fn shrink(&mut self) {
        if self.found.len() > self.most {
            let (_, last, _) = self.found.select_nth_unstable_by(self.most - 1, Found::order);
            self.limit = last.distance_squared;
            self.found.truncate(self.most);
        }
    }

    /// Brings the answer into order.
    pub fn finish(mut self) {
        if self.most > FEW {
            self.shrink();
            self.found.sort_unstable_by(Found::order);
        }
    }
}
