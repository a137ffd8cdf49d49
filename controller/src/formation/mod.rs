//! Keeping a formation: who my neighbours should be, where they are, and what that makes each move
//! cost.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2 and 5 to 7; section 6 for the measures. Read section 7
//! first.
//! In the plane robots follow places that are points: [`Drive`], in `places.rs`. What is said below of cells holds for the grid, and in the plane for
//! ways around what is closed.
//!
//! Everything here is a pure function on slices; what a robot remembers is [`Pace`] and its
//! [`Template`](crate::template::Template). Lengths are integers in [`UNIT`](crate::grid::UNIT)s per cell,
//! costs those of [`crate::cost`].
//!
//! The paper's own law is in `published`, behind the feature of that name. What differs from it here, and why (figures: `staya experiment
//! formation`):
//! - In the paper each robot weighs the shortest way to its *own* target against its neighbours'
//!   places. Six robots then take six different ways around a hill, pull at each other, and jam in
//!   one run of eight. Here the top leader alone chooses the way, and prices land by what the whole
//!   formation would cross ([`blended`]); the others head for their places beside it and ahead of
//!   where it is ([`aim`]), weighing their own land against their neighbours' places (algorithm 7).
//! - The leader waits when somebody has fallen behind by more than r0, rather than when anybody is
//!   off his place in any direction ([`lag`]): who is ahead or aside loses nothing by going on.
//! - The paper adds the distances of all neighbours found to the weights. Here it is a gain times half the
//!   distance to the place by the top leader and half the mean by the direct neighbours
//!   ([`distances`]): a sum would outweigh the land the more, the more neighbours there are.
//! - A stop by request makes the top leader stand ([`Recovery::Wait`]); the paper's leader heads for
//!   `def` instead, which is [`Recovery::Def`].
//! - When neighbours are missing or strangers stand in their places (item 6), the paper shuffles anew or
//!   asks the strangers to choose another direction. Here the strangers are asked
//!   ([`Found::surplus`]); there is nothing to shuffle anew, as each decision is a new draw.
//! - A leader is chosen anew when the old one falls silent or a smaller number is found (algorithm 2
//!   chooses at t = 0 only), so that a formation outlives any robot.
//! - Nobody waits for ever: see [`FormationParams::patience`]. A leader does not wait for those who follow
//!   somebody else.
//! - By the law "lookahead" those who follow plan their way to where their places will be some moves later ([`Course`]).
//! - When the ranks are closed ([`FormationParams::closes_ranks`]), those behind a dead robot move up.
//! - Who has no direct neighbour to follow follows a farther one ([`find_leader`]).
//! - The listing's misprints are resolved: `less` is counted once (algorithm 5), the leader is the
//!   smallest number (algorithm 6), sums restart for each direction (algorithm 7).

mod lookahead;
mod measure;
mod neighbors;
mod places;
#[cfg(feature = "published")]
pub mod published;
mod ranks;
mod steering;

#[cfg(test)]
mod tests;

pub use lookahead::{Course, NextMove, Steering};
pub use measure::{FormationError, GraphDistance, graph_distance};
pub use neighbors::{Found, Member, Seen, find_leader, find_neighbors};
pub(crate) use places::scaled;
pub use places::{Drive, behind, is_straight};
pub use ranks::Ranks;
pub use steering::{Anchor, Footprint, Pace, aim, blended, def, deviation, distances, lag, should_stay};

use crate::cost::Gain;
use crate::names::named;
use serde::{Deserialize, Serialize};

named! {
    /// How a robot foresees where another one will be when its own next move is over.
    #[derive(Default)]
    pub enum Prediction {
        /// It goes on in the direction that it announced, as fast as the land allows: O(1).
        #[default]
        Constant = "constant",
        /// What would I do in its place (KUZ section 7, item 1): one's own choice of a move from its
        /// cell, for its target and place, on the land that one sees; never a prediction inside a
        /// prediction. One more search of the window per neighbour. Falls back to `Constant` for a robot
        /// whose surroundings are not in sight.
        Reflexive = "reflexive",
    }
}

named! {
    /// What the top leader does while somebody is too far behind.
    #[derive(Default)]
    pub enum Recovery {
        /// It stands: nobody loses more time than the slowest needs.
        #[default]
        Wait = "wait",
        /// It heads for `cell + def` (KUZ section 7), towards where the others are off to.
        Def = "def",
    }
}

/// As [`FormationParams::halt_lag`]: no lag is too large (936 cells, and who is farther than eps, 255 at most, is not waited for).
pub const NEVER: u16 = u16::MAX;

/// Parameters of formation keeping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormationParams {
    /// How far from its place a neighbour may be and still counts as found, cells (eps of
    /// algorithm 5). Small values lose sight of who strays, so that nobody waits for him.
    pub eps: u8,
    /// Price of being off one's place, ticks per cell (the coefficient of the scalarisation). 0:
    /// everybody takes the shortest way; large values push robots straight over bad land.
    pub gain: Gain,
    /// How far somebody may fall behind before the top leader waits, [`UNIT`](crate::grid::UNIT)s (r0). Smaller keeps
    /// the formation tighter and costs time; [`NEVER`]: nobody waits.
    pub halt_lag: u16,
    /// How near he must have come again before it goes on, [`UNIT`](crate::grid::UNIT)s; at most `halt_lag`.
    pub resume_lag: u16,
    /// How far ahead of the top leader's cell the others aim, cells along its heading: makes up for
    /// the time that its move and the news of it take.
    pub lead: u8,
    /// How much of a cell's price for the top leader is the land under the others' places when it
    /// stands there, sixteenths: 0 only its own, 16 only theirs. In the plane, unless it is 0, the dearest cell of all counts.
    pub footprint: u8,
    /// Decisions for which a leader waits on end, and for which a follower is behind on end, before each goes on for
    /// itself until they are together again. Smaller ones part the formation at every obstacle; larger ones let it
    /// stand the longer for a robot that has no way. In the plane a leader waits for so many seconds.
    pub patience: u16,
    /// Whether a dead robot's place is closed by those behind it ([`Ranks`]) or stays empty. Kept places keep everybody at
    /// the distances that were wanted; closed ones leave no gap behind the leader and keep the formation within reach of its
    /// radio.
    pub closes_ranks: bool,
    /// How others are foreseen.
    pub prediction: Prediction,
    /// What the top leader does while somebody is too far behind.
    pub recovery: Recovery,
}

impl FormationParams {
    /// What followers who look ahead ([`Course`]) do well with: a leader who waits from 3 cells on (210 units), and twice the price for
    /// being off one's place; chosen on seed 1 of `staya experiment formation`.
    #[must_use]
    pub fn looking_ahead() -> Self {
        Self { gain: Gain::from_sixteenths(32), halt_lag: 210, resume_lag: 210, ..Self::default() }
    }
}

impl Default for FormationParams {
    /// What reaches the figures of `staya experiment formation`: eps 10 cells, gain 1, r0 300 units
    /// (4.3 cells) without hysteresis, one cell ahead, half of the price by the others'
    /// land, a patience of 100 decisions, constant velocity (no worse than reflexive there, for less work), waiting.
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
