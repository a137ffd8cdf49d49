//! Formation keeping: a robot's neighbours, their places, and the resulting cost of each move.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2 and 5 to 7; section 6 for the
//! measures. All functions are pure; a robot's state is [`PaceControl`] and its
//! [`Template`](crate::template::Template). Lengths are integers in [`UNIT`]s
//! per cell, costs those of [`crate::cost`]. In the plane, places are points ([`Drive`]).
//!
//! The paper's own law is in the crate `staya-papers`. Differences to it
//! (results: `staya experiment formation`):
//!
//! - **Route.** In the paper each robot weighs the route to its *own* target against the places of
//!   its neighbours, so six robots take six routes around a hill. Weights that hold them together
//!   cost up to 2.8 times the time, lighter ones a larger error. Here the top leader alone chooses
//!   the route, by the land that the whole formation would cross ([`blended`]). The others head for
//!   their places beside it ([`aim`]).
//! - **Waiting.** The leader waits when a robot has fallen behind by more than r0 ([`lag`]); one
//!   ahead or aside loses nothing if the formation continues.
//! - **Weights.** The paper's sum over all neighbours outweighs the land. Here the weight is a gain
//!   times half the distance to the place given by the top leader and half the mean of those given
//!   by the direct neighbours ([`distances`]).
//! - **Stop.** A requested stop makes the top leader wait, or head for `def` as in the paper
//!   ([`Recovery`]).
//! - **Surplus.** Strangers in the places of missing neighbours (item 6) are asked to choose
//!   another direction ([`Found::surplus`]). Each decision is a new random draw anyway.
//! - **Leader.** A new leader is chosen when the old one falls silent or a smaller number is found,
//!   not only at t = 0. It may be a farther neighbour ([`find_leader`]).
//! - **Patience.** No robot waits forever ([`FormationParams::patience`]), and a leader does not
//!   wait for robots that follow another leader.
//! - **Additions.** Followers may look ahead ([`Steering`]) and close gaps ([`GapClosing`]).
//! - **Misprints.** `less` is counted once (algorithm 5), the leader is the smallest number
//!   (algorithm 6), sums restart for each direction (algorithm 7).

mod gap_closing;
#[cfg(feature = "agent")]
mod law;
mod lookahead;
mod measure;
mod neighbors;
mod places;
#[cfg(feature = "agent")]
mod settings;
mod steering;

#[cfg(test)]
mod tests;

pub use gap_closing::GapClosing;
#[cfg(feature = "agent")]
pub use law::{FormationGuidance, FormationInPlane};
pub use lookahead::{NextMove, Steering};
pub use measure::{FormationError, GraphDistance, graph_distance};
pub use neighbors::{Found, Member, Seen, find_leader, find_neighbors};
#[cfg(feature = "agent")]
pub(crate) use places::scaled;
pub use places::{Drive, behind, is_straight};
#[cfg(feature = "agent")]
pub use settings::{FormationSettings, NO_SEARCH};
pub use steering::{Anchor, Footprint, PaceControl, aim, blended, def, deviation, distances, lag, should_stay};

use crate::cost::Gain;
use crate::grid::UNIT;
use crate::names::named;
use crate::parameters::row;
use serde::{Deserialize, Serialize};

named! {
    /// How a robot predicts where another robot will be at the end of its own next move.
    #[derive(Default)]
    pub enum Prediction {
        /// It continues in the direction that it announced, as fast as the land allows: O(1).
        #[default]
        Constant = "constant",
        /// It makes the move that this robot would make in its place (KUZ section 7, item 1), on
        /// the land that this robot sees. One more search per neighbour; `Constant` if it is out of
        /// sight.
        Reflexive = "reflexive",
    }
}

named! {
    /// The reaction of the top leader to a robot that is too far behind.
    #[derive(Default)]
    pub enum Recovery {
        /// It stops.
        #[default]
        Wait = "wait",
        /// It heads for `cell + def` (KUZ section 7), where the others are displaced to.
        Def = "def",
    }
}

/// As [`FormationParams::halt_lag`]: the leader never waits. No lag reaches this value (936 cells),
/// since robots beyond eps, at most 255 cells, are not waited for.
pub const NEVER: u16 = u16::MAX;

/// Parameters of formation keeping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormationParams {
    /// How far from its place a neighbour still counts as found, cells (eps of algorithm 5). With a
    /// small value the formation does not wait for robots that stray.
    pub eps: u8,
    /// Price of being off the own place, ticks per cell. With 0 all robots take the shortest route;
    /// large values push robots straight over bad land.
    pub gain: Gain,
    /// Lag of a robot at which the top leader waits, [`UNIT`]s (r0). A smaller
    /// value keeps the formation tighter and costs time; with [`NEVER`] the leader does not wait.
    pub halt_lag: u16,
    /// Lag at which the leader continues, [`UNIT`]s; at most `halt_lag`.
    pub resume_lag: u16,
    /// How far ahead of the top leader the others aim, cells: its move and the delay of its beacon.
    pub lead: u8,
    /// Share of the land under the others' places in the top leader's price of a cell, sixteenths:
    /// 0 counts only its own cell, 16 only theirs. In the plane all values but 0: the dearest cell.
    pub footprint: u8,
    /// Consecutive decisions for which a leader waits, or a follower is behind, before each
    /// continues alone. With a small value the formation splits at every obstacle; with a large one
    /// it waits longer for a robot without a route. In the plane: seconds.
    pub patience: u16,
    /// Whether robots behind a dead robot move up into its place ([`GapClosing`]), which keeps the
    /// formation within radio range, or leave it empty, which keeps all intended distances.
    pub closes_ranks: bool,
    /// How robots predict the positions of others.
    pub prediction: Prediction,
    /// The reaction of the top leader to a robot that is too far behind.
    pub recovery: Recovery,
}

impl FormationParams {
    /// Good values for followers that look ahead ([`Steering`]): the leader waits from 3 cells (210
    /// units) on, and the gain is doubled; chosen on seed 1 of `staya experiment formation`.
    #[must_use]
    pub fn looking_ahead() -> Self {
        Self { gain: Gain::from_sixteenths(32), halt_lag: 210, resume_lag: 210, ..Self::default() }
    }

    const fn is_sound(&self) -> bool {
        self.resume_lag <= self.halt_lag
    }
}

crate::parameters! {
    impl[] FormationParams, where is_sound {
        row("eps_cells", "FORM_EPS", "cells", [0.0, 255.0], "largest distance from a place that still counts as there")
            => eps,
        row("place_gain", "FORM_GAIN", "ticks", [0.0, 4095.0], "price of a cell off the own place") => gain,
        row("halt_cells", "FORM_HALT", "cells", [0.0, 937.0], "lag of a robot at which the leader waits")
            => halt_lag / UNIT as f32,
        row("resume_cells", "FORM_RESUME", "cells", [0.0, 937.0], "lag at which the waiting leader continues")
            .depends("`halt_cells`") => resume_lag / UNIT as f32,
        row("lead_cells", "FORM_LEAD", "cells", [0.0, 255.0], "how far ahead of the leader the others aim") => lead,
        row("footprint", "FORM_FOOTPRINT", "", [0.0, 1.0], "share of the others' land in the leader's price")
            => footprint / 16.0,
        row("patience", "FORM_PATIENCE", "decisions", [0.0, 30_000.0], "how long to wait before each robot continues alone")
            => patience,
    }
}

impl Default for FormationParams {
    /// The values of `staya experiment formation`: eps 10 cells, gain 1, r0 300 units (4.3 cells)
    /// without hysteresis, one cell ahead, half of the price from the others' land, a patience of
    /// 100 decisions, waiting, and constant prediction.
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
