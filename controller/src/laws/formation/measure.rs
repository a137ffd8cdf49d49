//! Measures of formation quality (KUZ section 6): by a robot, and by an observer of all robots.

use super::Found;
use crate::grid::{Cell, Norm};

/// The graph distance and its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GraphDistance {
    /// Missing neighbours (m0).
    pub less: u32,
    /// Robots that stand in the place of another (m1).
    pub more: u32,
    /// Sum over the common vertices of |actual - desired|, [`UNIT`](crate::grid::UNIT)s.
    pub offsets: u32,
}

impl GraphDistance {
    /// dist = m0 + m1 + kappa * offsets with kappa = 1 / diameter of the map (cells, at least 1),
    /// in [`UNIT`](crate::grid::UNIT)ths, rounded down.
    #[must_use]
    pub fn units(&self, diameter: u32) -> u32 {
        let whole = self.less.saturating_add(self.more);
        let offsets = self.offsets.checked_div(diameter.max(1)).unwrap_or(0);
        whole.saturating_mul(crate::grid::UNIT).saturating_add(offsets)
    }
}

/// The graph distance between the template and the neighbours that a robot in `cell` found.
#[must_use]
pub fn graph_distance<const F: usize>(cell: Cell, found: &Found<F>) -> GraphDistance {
    let offsets = found.members.iter().fold(0_u32, |sum, member| {
        let off = (cell + member.offset).distance(member.seen.cell, Norm::Euclidean);
        sum.saturating_add(off)
    });
    GraphDistance { less: found.less.into(), more: found.more.into(), offsets }
}

/// The formation error dPhi: a sum over ticks of distances between desired and actual cells, for an
/// observer that knows every cell, such as a ground station.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormationError {
    sum: u64,
    count: u32,
}

impl FormationError {
    /// Creates an empty sum.
    #[must_use]
    pub const fn new() -> Self {
        Self { sum: 0, count: 0 }
    }

    /// Adds one robot in one tick.
    pub fn add(&mut self, desired: Cell, actual: Cell) {
        let off = u64::from(desired.distance(actual, Norm::Euclidean));
        self.sum = self.sum.saturating_add(off);
        self.count = self.count.saturating_add(1);
    }

    /// The mean so far, [`UNIT`](crate::grid::UNIT)s per robot and tick; 0 before the first.
    #[must_use]
    pub fn mean(&self) -> u32 {
        let mean = self.sum.checked_div(self.count.into()).unwrap_or(0);
        u32::try_from(mean).unwrap_or(u32::MAX)
    }
}
