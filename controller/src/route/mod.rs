//! Windowed routing: the cheapest way out of what the robot sees, towards its target.
//!
//! Source: KUZ sections 3 and 5, algorithms 1 and 3, equations 7 to 10. Read section 3 first.
//! Costs are integers in units of 1/[`TICK`] tick, so that host and device agree to the bit.
//!
//! What differs from the paper: the direction of algorithm 3, line 7 is (target - cell), which the
//! listing has the wrong way round; one reverse search from the exits serves all directions; beside
//! the listing's single exit ([`ExitRule::Ray`]) every border cell may be the exit, priced by
//! equation 10 ([`ExitRule::Best`]).

mod field;
mod router;
mod visits;

#[cfg(test)]
#[allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::integer_division_remainder_used
)]
mod tests;

pub use field::{CostField, Unreachable};
pub use router::{PLAN, Replan, Router};
pub use visits::VisitMemory;

use crate::grid::{Dir, Norm, UNIT};

/// A cost in units of 1/[`TICK`] tick; [`EXCLUDED`] when there is no way.
pub type Cost = u32;

/// Cost of crossing one cell of impassability 1 by an axis move with gain 1.
pub const TICK: Cost = UNIT << Gain::FRACTION_BITS;

/// The cost of a direction that cannot be taken.
pub const EXCLUDED: Cost = Cost::MAX;

/// A non-negative coefficient with four fractional bits: 0, 1/16, ... 4095 15/16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gain(u16);

impl Gain {
    /// Bits behind the point.
    pub const FRACTION_BITS: u32 = 4;
    /// 0: the term has no effect.
    pub const ZERO: Self = Self(0);
    /// 1.
    pub const ONE: Self = Self::from_int(1);

    /// The whole number `value`, saturating at 4095.
    #[must_use]
    pub const fn from_int(value: u16) -> Self {
        Self(if value > 4095 {
            u16::MAX
        } else {
            value << Self::FRACTION_BITS
        })
    }

    /// The number `sixteenths / 16`.
    #[must_use]
    pub const fn from_sixteenths(sixteenths: u16) -> Self {
        Self(sixteenths)
    }

    /// The number in sixteenths.
    #[must_use]
    pub const fn sixteenths(self) -> u16 {
        self.0
    }

    /// `self * length`, for a length in [`UNIT`]s: a cost in [`TICK`] units. Saturates.
    #[must_use]
    pub const fn of(self, length: u32) -> Cost {
        length.saturating_mul(self.0 as u32)
    }
}

/// Where a route leaves the window when the target lies outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ExitRule {
    /// The border cell with the least path cost + a3 * distance to the target (eq. 10).
    #[default]
    Best,
    /// The border cell where the ray to the target crosses the border (alg. 3, line 8); if it is
    /// blocked, the nearest border cell that can be reached.
    Ray,
}

/// Parameters of the route cost T(r) = a0 sum |d| u + a1 #occupied + a2 sum visits + a3 |exit - target|.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RouteParams {
    /// Radius r of the window in cells (KUZ: 5). A larger one sees dead ends earlier and costs
    /// O(r^2) time and memory; 1 is plain greedy descent.
    pub radius: u8,
    /// Which border cells end a route.
    pub exit: ExitRule,
    /// Length of a diagonal move.
    pub norm: Norm,
    /// Whether a diagonal move may pass a blocked orthogonal neighbour.
    pub corner_cutting: bool,
    /// Weight of travel time, ticks (eq. 7). 0 makes land free: only for special purposes.
    pub a0: Gain,
    /// Ticks that a cell occupied by another robot costs extra (eq. 7). 0 queues behind others;
    /// large values take long detours around a crowd.
    pub a1: Gain,
    /// Ticks per earlier visit of a cell (eq. 9). 0 can circle for ever before a dead end larger
    /// than the window; too large drives the robot away from good land that it used before.
    pub a2: Gain,
    /// Ticks per cell of distance between exit and target (eq. 10). It should be near the time
    /// that a cell of the land takes: smaller wanders, larger runs straight over bad ground.
    pub a3: Gain,
}

impl Default for RouteParams {
    /// r = 5, best exit, Euclidean, no corner cutting, a = (1, 2, 3, 3).
    fn default() -> Self {
        Self {
            radius: 5,
            exit: ExitRule::Best,
            norm: Norm::Euclidean,
            corner_cutting: false,
            a0: Gain::ONE,
            a1: Gain::from_int(2),
            a2: Gain::from_int(3),
            a3: Gain::from_int(3),
        }
    }
}

/// What each of the eight moves costs at best: the least T over the routes that begin with it and
/// do not return to the robot's cell (eq. 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weights([Cost; 8]);

impl Weights {
    /// No move is open.
    pub const CLOSED: Self = Self([EXCLUDED; 8]);

    /// Weights from the costs of the moves in the order of [`Dir::MOVES`].
    #[must_use]
    pub const fn new(costs: [Cost; 8]) -> Self {
        Self(costs)
    }

    /// The weight of a move; [`EXCLUDED`] for closed ones and for [`Dir::Stay`].
    #[must_use]
    pub fn get(&self, dir: Dir) -> Cost {
        self.0.get(dir.index()).copied().unwrap_or(EXCLUDED)
    }

    /// Replaces the weight of a move; `Stay` has none.
    pub fn set(&mut self, dir: Dir, cost: Cost) {
        if let Some(slot) = self.0.get_mut(dir.index()) {
            *slot = cost;
        }
    }

    /// The cheapest move, the first of equals in the order of [`Dir::MOVES`]; `None` if all are closed.
    #[must_use]
    pub fn best(&self) -> Option<Dir> {
        self.iter()
            .filter(|&(_, cost)| cost != EXCLUDED)
            .min_by_key(|&(_, cost)| cost)
            .map(|(dir, _)| dir)
    }

    /// All moves with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (Dir, Cost)> + '_ {
        Dir::MOVES.into_iter().zip(self.0)
    }
}
