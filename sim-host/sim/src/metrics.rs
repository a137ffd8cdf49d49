//! Measurements of a run: formation quality and arrivals.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 6. All sums run over robots by id on one thread, so
//! that every value is identical on any machine. Distances are Euclidean, between cells.

pub mod flock;
mod formation;
mod formations;
pub mod waits;

#[doc(hidden)]
pub use formation::in_cells;
pub use formation::{FORMED_AFTER_S, FormationMeter, FormationQuality, Member, PlaceError, free_formation_s};
pub use formations::{FormationKept, FormationMeters};

use rayon::prelude::*;

/// Arrival times of the robots.
#[derive(Clone, Debug)]
pub struct Arrivals {
    at: Vec<Option<u64>>,
    count: usize,
}

impl Arrivals {
    /// Creates a record in which no robot has arrived.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        Self { at: vec![None; robots], count: 0 }
    }

    /// Updates the arrivals after a tick, in parallel. `free_at(i)` is the end of the last crossing
    /// of robot `i`, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick, or `None` if it is not
    /// at its goal. A robot that leaves its goal has not arrived.
    pub fn note(&mut self, free_at: impl Fn(usize) -> Option<u64> + Sync) {
        let robots = self.at.par_iter_mut().enumerate().with_min_len(256);
        let count = robots.map(|(index, at)| {
            *at = free_at(index).map(|free_at| at.unwrap_or(free_at));
            usize::from(at.is_some())
        });
        self.count = count.sum();
    }

    pub(crate) fn set(&mut self, index: usize, at: Option<u64>) {
        let before = std::mem::replace(&mut self.at[index], at);
        self.count = self.count + usize::from(at.is_some()) - usize::from(before.is_some());
    }

    /// Appends a robot that comes from another MPI rank.
    pub fn admit(&mut self) {
        self.at.push(None);
    }

    /// Removes a robot that goes to another MPI rank; the last robot takes its index.
    pub fn dismiss(&mut self, index: usize) {
        self.set(index, None);
        self.at.swap_remove(index);
    }

    /// Number of robots at their goals.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Whether all robots are at their goals.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.count == self.at.len()
    }

    /// End of each robot's last move, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick after
    /// the start: the travel time of KUZ eq. 7, waiting included. `None` if it is not at its goal.
    #[must_use]
    pub fn times(&self) -> &[Option<u64>] {
        &self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_that_leaves_its_goal_has_not_arrived() {
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
