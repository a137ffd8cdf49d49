//! Costs of moves as integers, identical on host and device.
//!
//! A cost is a time in units of 1/[`TICK`] of a tick, the time to cross a cell of impassability 1.
//! Behaviours give each of the eight moves a weight and add their weights (A. V. Kuznetsov 2017,
//! KUZ, section 7: "it is simplest to add them").

use crate::grid::{Dir, UNIT};
use serde::{Deserialize, Serialize};

/// A cost in units of 1/[`TICK`] tick; [`EXCLUDED`] if no route exists.
pub type Cost = u32;

/// Cost of crossing one cell of impassability 1 by an axis move with gain 1.
pub const TICK: Cost = UNIT << Gain::FRACTION_BITS;

/// The cost of a direction that cannot be taken.
pub const EXCLUDED: Cost = Cost::MAX;

/// A non-negative coefficient with four fractional bits: 0, 1/16, ... 4095 15/16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gain(u16);

impl Gain {
    /// Number of fractional bits.
    pub const FRACTION_BITS: u32 = 4;
    /// 0, so that the term has no effect.
    pub const ZERO: Self = Self(0);
    /// 1.
    pub const ONE: Self = Self::from_int(1);

    /// The whole number `value`, saturating at 4095.
    #[must_use]
    pub const fn from_int(value: u16) -> Self {
        Self(if value > 4095 { u16::MAX } else { value << Self::FRACTION_BITS })
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

/// The best cost of each of the eight moves; for a route, the least T over the routes that begin
/// with the move and do not return to the robot's cell (KUZ eq. 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Weights([Cost; 8]);

impl Weights {
    /// Weights with all moves closed.
    pub const CLOSED: Self = Self([EXCLUDED; 8]);

    /// Creates weights from the costs of the moves in the order of [`Dir::MOVES`].
    #[must_use]
    pub const fn new(costs: [Cost; 8]) -> Self {
        Self(costs)
    }

    /// Returns the weight of a move; [`EXCLUDED`] for closed moves and for [`Dir::Stay`].
    #[must_use]
    pub fn get(&self, dir: Dir) -> Cost {
        self.0.get(dir.index()).copied().unwrap_or(EXCLUDED)
    }

    /// Sets the weight of a move; ignored for `Stay`.
    pub fn set(&mut self, dir: Dir, cost: Cost) {
        if let Some(slot) = self.0.get_mut(dir.index()) {
            *slot = cost;
        }
    }

    /// Returns the cheapest open move, the first of equals in the order of [`Dir::MOVES`].
    #[must_use]
    pub fn best(&self) -> Option<Dir> {
        self.iter().filter(|&(_, cost)| cost != EXCLUDED).min_by_key(|&(_, cost)| cost).map(|(dir, _)| dir)
    }

    /// Adds the weights of each move; a move that is closed in one of them stays closed.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        for (dir, cost) in other.iter() {
            let own = self.get(dir);
            if own != EXCLUDED && cost != EXCLUDED {
                self.set(dir, own.saturating_add(cost).min(EXCLUDED - 1));
            } else {
                self.set(dir, EXCLUDED);
            }
        }
        self
    }

    /// Closes a move.
    #[must_use]
    pub fn without(mut self, dir: Dir) -> Self {
        self.set(dir, EXCLUDED);
        self
    }

    /// Iterates over all moves and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (Dir, Cost)> + '_ {
        Dir::MOVES.into_iter().zip(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_keeps_moves_open_that_are_open_in_both() {
        let costs = |first, second| {
            let mut weights = Weights::new([1; 8]);
            weights.set(Dir::East, first);
            weights.set(Dir::North, second);
            weights
        };
        let sum = costs(EXCLUDED - 1, EXCLUDED).plus(&costs(EXCLUDED - 1, 0));
        assert_eq!(sum.get(Dir::East), EXCLUDED - 1);
        assert_eq!(sum.get(Dir::North), EXCLUDED);
        assert_eq!(sum.get(Dir::South), 2);
        assert_eq!(sum.get(Dir::Stay), EXCLUDED);
    }
}
