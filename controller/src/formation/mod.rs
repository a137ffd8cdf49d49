//! Formation keeping: which neighbours a robot should have, where they are, and what each move
//! therefore costs.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2 and 5 to 7; section 6 for the
//! measures. Read section 7 first. In the plane, places are points: see [`Drive`] in `places.rs`.
//! The text below on cells applies to the grid, and in the plane to detours around closed cells.
//!
//! All functions are pure functions on slices; a robot's state consists of [`PaceControl`] and its
//! [`Template`](crate::template::Template). Lengths are integers in [`UNIT`](crate::grid::UNIT)s
//! per cell, costs those of [`crate::cost`].
//!
//! The paper's own law is in `published`, behind the feature of that name. Differences to it, and
//! why (results: `staya experiment formation`):
//!
//! - **Route.** In the paper each robot weighs the shortest route to its *own* target against the
//!   places of its neighbours. Six robots then take six different routes around a hill, pull at
//!   each other, and jam in one run of eight. Here the top leader alone chooses the route, and
//!   prices land by what the whole formation would cross ([`blended`]). The others head for their
//!   places beside it and ahead of it ([`aim`]), weighing their own land against the places of
//!   their neighbours (algorithm 7).
//! - **Waiting.** The leader waits when a robot has fallen behind by more than r0, not when any
//!   robot is off its place in any direction ([`lag`]): a robot ahead or aside loses nothing if the
//!   formation continues.
//! - **Weights.** The paper adds the distances of all neighbours found to the weights. With many
//!   neighbours this sum outweighs the land. Here it is a gain times half the distance to the place
//!   given by the top leader and half the mean of the places given by the direct neighbours
//!   ([`distances`]).
//! - **Stop.** A requested stop makes the top leader wait ([`Recovery::Wait`]). The paper's leader
//!   heads for `def` instead, which is [`Recovery::Def`].
//! - **Surplus.** When neighbours are missing or strangers stand in their places (item 6), the
//!   paper shuffles again or asks the strangers to choose another direction. Here the strangers are
//!   asked ([`Found::surplus`]). Shuffling again is unnecessary, as each decision is a new random
//!   draw.
//! - **Leader.** A new leader is chosen when the old one falls silent or a smaller number is found,
//!   so that a formation survives the loss of any robot. Algorithm 2 chooses at t = 0 only. A robot
//!   without a direct neighbour to follow follows a farther one ([`find_leader`]).
//! - **Patience.** No robot waits forever: see [`FormationParams::patience`]. A leader does not
//!   wait for robots that follow another leader.
//! - **Look-ahead.** With the law "lookahead" followers plan their routes to where their places
//!   will be some moves later ([`Course`]).
//! - **GapClosing.** If ranks are closed ([`FormationParams::closes_ranks`]), robots behind a dead
//!   robot move up.
//! - **Misprints.** `less` is counted once (algorithm 5), the leader is the smallest number
//!   (algorithm 6), sums restart for each direction (algorithm 7).

mod gap_closing;
mod lookahead;
mod measure;
mod neighbors;
mod places;
#[cfg(feature = "published")]
pub mod published;
mod steering;

#[cfg(test)]
mod tests;

pub use gap_closing::GapClosing;
pub use lookahead::{Course, NextMove, Steering};
pub use measure::{FormationError, GraphDistance, graph_distance};
pub use neighbors::{Found, Member, Seen, find_leader, find_neighbors};
pub(crate) use places::scaled;
pub use places::{Drive, behind, is_straight};
pub use steering::{Anchor, Footprint, PaceControl, aim, blended, def, deviation, distances, lag, should_stay};

use crate::cost::Gain;
use crate::names::named;
use serde::{Deserialize, Serialize};

named! {
    /// How a robot predicts where another robot will be at the end of its own next move.
    #[derive(Default)]
    pub enum Prediction {
        /// It continues in the direction that it announced, as fast as the land allows: O(1).
        #[default]
        Constant = "constant",
        /// It makes the move that this robot would make in its place (KUZ section 7, item 1): from
        /// its cell, for its target and place, on the land that this robot sees. Predictions are
        /// not nested. One more search of the window per neighbour. Falls back to `Constant` for a
        /// robot whose surroundings are out of sight.
        Reflexive = "reflexive",
    }
}

named! {
    /// What the top leader does while a robot is too far behind.
    #[derive(Default)]
    pub enum Recovery {
        /// It stops, so that no robot loses more time than the slowest needs.
        #[default]
        Wait = "wait",
        /// It heads for `cell + def` (KUZ section 7), the direction in which the others are
        /// displaced.
        Def = "def",
    }
}

/// As [`FormationParams::halt_lag`]: the leader never waits. No lag reaches this value (936 cells),
/// since robots farther away than eps, at most 255 cells, are not waited for.
pub const NEVER: u16 = u16::MAX;

/// Parameters of formation keeping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormationParams {
    /// How far from its place a neighbour may be and still counts as found, cells (eps of algorithm
    /// 5). With a small value robots that stray are lost, and the formation does not wait for them.
    pub eps: u8,
    /// Price of being off the own place, ticks per cell (the coefficient of the scalarisation).
    /// With 0 all robots take the shortest route; large values push robots straight over bad land.
    pub gain: Gain,
    /// How far a robot may fall behind before the top leader waits, [`UNIT`](crate::grid::UNIT)s
    /// (r0). A smaller value keeps the formation tighter and costs time; with [`NEVER`] the leader
    /// does not wait.
    pub halt_lag: u16,
    /// The lag down to which that robot must catch up before the leader continues,
    /// [`UNIT`](crate::grid::UNIT)s; at most `halt_lag`.
    pub resume_lag: u16,
    /// How far ahead of the top leader's cell the others aim, cells along its heading. Compensates
    /// for the duration of its move and the delay of its beacon.
    pub lead: u8,
    /// Share of the land under the others' places in the top leader's price of a cell, sixteenths:
    /// 0 counts only its own cell, 16 only theirs. In the plane, unless it is 0, the dearest cell
    /// of all counts.
    pub footprint: u8,
    /// Number of consecutive decisions for which a leader waits, and for which a follower is
    /// behind, before each continues alone until they are together again. With a small value the
    /// formation splits at every obstacle; with a large one it waits longer for a robot without a
    /// route. In the plane it is the leader's waiting time in seconds.
    pub patience: u16,
    /// Whether robots behind a dead robot move up into its place ([`GapClosing`]) or leave it
    /// empty. Fixed places keep all robots at the intended distances; moving up leaves no gap
    /// behind the leader and keeps the formation within its radio range.
    pub closes_ranks: bool,
    /// How robots predict the positions of others.
    pub prediction: Prediction,
    /// What the top leader does while a robot is too far behind.
    pub recovery: Recovery,
}

impl FormationParams {
    /// Good values for followers that look ahead ([`Course`]): the leader waits from 3 cells on
    /// (210 units), and being off the own place costs twice as much; chosen on seed 1 of
    /// `staya experiment formation`.
    #[must_use]
    pub fn looking_ahead() -> Self {
        Self { gain: Gain::from_sixteenths(32), halt_lag: 210, resume_lag: 210, ..Self::default() }
    }
}

impl Default for FormationParams {
    /// The values behind the results of `staya experiment formation`: eps 10 cells, gain 1, r0 300
    /// units (4.3 cells) without hysteresis, one cell ahead, half of the price from the others'
    /// land, a patience of 100 decisions, waiting, and constant velocity (no worse than reflexive
    /// there, for less work).
    fn default() -> Self {
        Self {
            eps: 10,
            gain: Gain::ONE,
            halt_lag: 300,
            resume_lag: 300,
            lead: 1,
            footprint: 8,
            patience: 100,
            closes_ranks: false,
            prediction: Prediction::Constant,
            recovery: Recovery::Wait,
        }
    }
}
