//! What a run is measured by: how well the formation is kept, and when robots arrive.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 6. All sums run over robots in the order of their numbers, on one
//! thread, so that every figure is the same on any machine. Distances are Euclidean, between cells.

pub mod flock;
mod formation;
mod formations;
pub mod waits;

#[doc(hidden)]
pub use formation::in_cells;
pub use formation::{FORMED_AFTER_S, FormationMeter, Keeping, PlaceError, free_formation_s};
pub use formations::{FormationKept, FormationMeters};

use rayon::prelude::*;

/// When each robot came to its target for good.
#[derive(Clone, Debug)]
pub struct Arrivals {
    at: Vec<Option<u64>>,
    count: usize,
}

impl Arrivals {
    /// Nobody has arrived.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        Self { at: vec![None; robots], count: 0 }
    }

    /// Takes note of who stands at its target now: `free_at(i)` is when the last crossing of robot number i's body ends,
    /// in [`UNIT`](staya_controller::grid::UNIT)ths of a tick; `None` for one that is not there. A robot that leaves its
    /// target has not arrived. In parallel.
    pub fn note(&mut self, free_at: impl Fn(usize) -> Option<u64> + Sync) {
        let robots = self.at.par_iter_mut().enumerate().with_min_len(256);
        let count = robots.map(|(index, at)| {
            *at = free_at(index).map(|free_at| at.unwrap_or(free_at));
            usize::from(at.is_some())
        });
        self.count = count.sum();
    }

    /// When robot number `index` arrived is as it was at another time.
    pub(crate) fn set(&mut self, index: usize, at: Option<u64>) {
        let before = std::mem::replace(&mut self.at[index], at);
        self.count = self.count + usize::from(at.is_some()) - usize::from(before.is_some());
    }

    /// A robot comes from another rank, behind those that are here.
    pub fn admit(&mut self) {
        self.at.push(None);
    }

    /// Robot number `index` goes to another rank; the last one takes its place.
    pub fn dismiss(&mut self, index: usize) {
        self.set(index, None);
        self.at.swap_remove(index);
    }

    /// How many robots stand at their targets.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Whether all do.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.count == self.at.len()
    }

    /// When each robot's last move was over, [`UNIT`](staya_controller::grid::UNIT)ths of a tick
    /// after the start: the travel time of KUZ eq. 7, waiting included. `None`: not there.
    #[must_use]
    pub fn times(&self) -> &[Option<u64>] {
        &self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_leaves_his_target_has_not_arrived() {
        let mut arrivals = Arrivals::new(2);
        arrivals.note(|index| (index == 0).then_some(70));
        arrivals.note(|index| (index == 0).then_some(700));
        assert_eq!((arrivals.count(), arrivals.times()), (1, &[Some(70), None][..]));
        arrivals.note(|index| (index == 1).then_some(99));
        assert_eq!((arrivals.count(), arrivals.times()), (1, &[None, Some(99)][..]));
        assert!(!arrivals.is_complete());
        arrivals.note(|index| Some([800, 900][index]));
        assert_eq!(arrivals.times(), [Some(800), Some(99)]);
        assert!(arrivals.is_complete());
    }
}
