//! Windowed routing: the cheapest route out of the robot's view, towards its target.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), sections 3 and 5, algorithms 1 and 3, equations 7 to 10.
//! Costs are integers ([`crate::cost`]), so that host and device agree bit for bit.
//!
//! Differences to the paper:
//!
//! - The direction of algorithm 3, line 7 is (target - cell); the listing has it reversed.
//! - One reverse search from the exits serves all directions.
//! - Every border cell may be the exit ([`ExitRule::Best`]).
//! - A robot that does not approach its target learns or follows the wall ([`Router`]).

mod escape;
mod field;
mod known;
#[cfg(feature = "agent")]
mod law;
mod learned;
mod router;
#[cfg(feature = "agent")]
mod settings;
mod visits;

#[cfg(test)]
mod escape_tests;
#[cfg(test)]
mod tests;

pub use field::{CostField, Unreachable};
pub use known::{LandMemory, SUPPOSED_CLOSED, supposed};
#[cfg(feature = "agent")]
pub use law::RouteGuidance;
pub use learned::LearnedCosts;
pub use router::{PLAN, Replan, Router};
#[cfg(feature = "agent")]
pub use settings::{RouteSettings, SIGHT};
pub use visits::VisitMemory;

use crate::cost::Gain;
#[cfg(feature = "agent")]
use crate::cost::{EXCLUDED, TICK, Weights};
use crate::grid::{Cell, Dir, Norm, Window};
use crate::names::named;
use crate::parameters::row;
use serde::{Deserialize, Serialize};

named! {
    /// Where a route leaves the window when the target lies outside.
    #[derive(Default)]
    pub enum ExitRule {
        /// The border cell with the least path cost + a3 * distance to the target (eq. 10).
        #[default]
        Best = "best",
        /// The border cell on the ray to the target (alg. 3, line 8), or the nearest reachable one.
        Ray = "ray",
    }
}

/// Parameters of the route cost a0 sum |d| u + a1 #occupied + a2 sum visits + a3 |exit - target|.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RouteParams {
    /// Radius r of the window in cells (KUZ: 5). A larger one shows dead ends earlier and costs
    /// O(r^2) time and memory; 1 is greedy descent.
    pub radius: u8,
    /// Which border cells end a route.
    pub exit: ExitRule,
    /// Length of a diagonal move.
    pub norm: Norm,
    /// Whether a diagonal move may pass a blocked orthogonal neighbour.
    pub corner_cutting: bool,
    /// Weight of travel time, ticks (eq. 7). 0 makes land free.
    pub a0: Gain,
    /// Additional ticks for a cell occupied by another robot (eq. 7). With 0 the robot queues
    /// behind others; large values lead to long detours.
    pub a1: Gain,
    /// Ticks per earlier visit of a cell (eq. 9). With 0 the robot can circle in a dead end until
    /// [`Router`] takes another route; a large value keeps it off land that it used.
    pub a2: Gain,
    /// Ticks per cell of distance between exit and target (eq. 10), near the time that a cell takes
    /// on a good route. Below half of that it may not arrive; with more it moves straighter.
    pub a3: Gain,
}

impl RouteParams {
    /// The default.
    pub const DEFAULT: Self = Self {
        radius: 5,
        exit: ExitRule::Best,
        norm: Norm::Euclidean,
        corner_cutting: false,
        a0: Gain::ONE,
        a1: Gain::from_int(2),
        a2: Gain::from_int(3),
        a3: Gain::from_int(3),
    };
}

impl Default for RouteParams {
    /// r = 5, best exit, Euclidean, no corner cutting, a = (1, 2, 3, 3).
    ///
    /// On random natural land a3 = 3 loses almost the least time against the optimum
    /// (`staya experiment route --axis grid.route.a3=1,2,3`); a1 and a2 hardly matter there unless
    /// they are 0.
    fn default() -> Self {
        Self::DEFAULT
    }
}

crate::parameters! {
    impl[] RouteParams {
        row("a0", "ROUTE_A0", "", [0.0, 4095.0], "weight of travel time") => a0,
        row("a1", "ROUTE_A1", "ticks", [0.0, 4095.0], "extra cost of a cell with another robot") => a1,
        row("a2", "ROUTE_A2", "ticks", [0.0, 4095.0], "extra cost of a cell for each earlier visit") => a2,
        row("a3", "ROUTE_A3", "ticks", [0.0, 4095.0], "price of a cell between the window and the target") => a3,
    }
}

impl RouteParams {
    fn opens(&self, window: &Window<'_>, cell: Cell, dir: Dir) -> bool {
        let Cell { x, y } = dir.offset();
        let passable = |dx, dy| window.is_passable(cell + Cell::new(dx, dy));
        let corners = !dir.is_diagonal() || self.corner_cutting || passable(x, 0) && passable(0, y);
        corners && passable(x, y)
    }

    /// Every move that the land permits from `cell`, for a robot that only moves aside.
    #[cfg(feature = "agent")]
    pub(crate) fn open_moves(&self, window: &Window<'_>, cell: Cell) -> Weights {
        Weights::new(Dir::MOVES.map(|dir| if self.opens(window, cell, dir) { TICK } else { EXCLUDED }))
    }
}

fn ray_exit(radius: u8, from: Cell, target: Cell) -> Cell {
    let (dx, dy) = (i64::from(target.x) - i64::from(from.x), i64::from(target.y) - i64::from(from.y));
    let longest = dx.abs().max(dy.abs());
    let scale = |d: i64| {
        let half = if d < 0 { -longest } else { longest };
        (2 * d * i64::from(radius) + half).checked_div(2 * longest).unwrap_or(0)
    };
    from + Cell::new(scale(dx) as i16, scale(dy) as i16)
}
