//! The numbers that a law is made from, as hosts read them from files, C and Python.

use crate::grid::Norm;
use crate::parameters::Parameters;

/// The bodies that a law moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// By velocities, in the plane or in space.
    Velocities,
    /// From cell to cell: on the grid, or over cells in the plane.
    Cells,
}

/// The goals that a law takes from a scenario or an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goals {
    /// None.
    None,
    /// A cell at which it stays.
    Cell,
    /// A waypoint at which it stays, with others on the way.
    Waypoints,
    /// Up to this many, which it shares with the robots of its flock.
    Shared(u8),
}

impl Goals {
    /// Returns whether each robot has a goal of its own, at which it stays.
    #[must_use]
    pub const fn are_own(self) -> bool {
        matches!(self, Self::Cell | Self::Waypoints)
    }

    /// Returns the number of goals that an operator can move.
    #[must_use]
    pub const fn movable(self) -> u8 {
        match self {
            Self::None | Self::Cell => 0,
            Self::Waypoints => 1,
            Self::Shared(count) => count,
        }
    }
}

/// Properties of bodies, radio and cells on which the values of a law depend if they are not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Cruising speed of the body, m/s; `None`: it moves from cell to cell.
    pub cruise_mps: Option<f32>,
    /// Distance at which its goal counts as reached, metres.
    pub tolerance_m: f32,
    /// Age of the beacons of others when they arrive, seconds.
    pub delay_s: f32,
    /// Beacons of a robot that arrive in a second.
    pub rate_hz: f32,
    /// Seed of draws that all robots make alike.
    pub seed: u64,
    /// Sight of the robot in each direction, cells.
    pub radius: u8,
    /// Length of a diagonal move.
    pub norm: Norm,
    /// Whether a diagonal move may pass a blocked orthogonal neighbour.
    pub corner_cutting: bool,
}

/// Values that contradict each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contradiction {
    /// The name of the row to change.
    pub row: &'static str,
    /// The fault in a few words.
    pub what: &'static str,
    /// How to correct it.
    pub remedy: &'static str,
}

/// The numbers and choices that a law is made from; `Default` has those that do not depend on
/// anything.
pub trait Settings: Clone + Default {
    /// The name of the law in scenarios, C and Python.
    const NAME: &'static str;

    /// The law in a sentence.
    const WHAT: &'static str;

    /// The bodies that it moves.
    const MOTION: Motion;

    /// The goals that it takes.
    const GOALS: Goals;

    /// Calls `visit` with each table; names differ in all of them.
    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters));

    /// Sets the values that depend on others and are not given.
    ///
    /// # Errors
    /// [`Contradiction`] of given values.
    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction>;
}
