//! Settings of routes.

use super::{ExitRule, Replan, RouteGuidance, RouteParams};
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::laws::any::{Large, large};
use crate::laws::cells::{CellFollower, FarMap, OverCells};
use crate::parameters::{Parameter, Parameters, Value, choice, row, worded};
use crate::scalar::{Scalar, cast};
use crate::shuffle::Sharpness;
use serde::{Deserialize, Serialize};

/// Settings of [`RouteGuidance`], on the grid and in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RouteSettings {
    /// Costs of a route.
    pub params: RouteParams,
    /// When to repeat the search.
    pub replan: Replan,
    /// How strictly the order of moves follows their weights.
    pub sharpness: Sharpness,
    /// Preferred speed, m/s; `None`: from cell to cell.
    pub speed_mps: Option<f32>,
}

worded!(ExitRule, Replan);

/// Sight of a robot over cells.
pub const SIGHT: Parameter =
    row("radius", "ROUTE_RADIUS", "cells", [1.0, 16.0], "sight in each direction").of_body("grid.radius");

/// Ticks that halve the probability of a move; 0: the cheapest first.
impl Value for Sharpness {
    fn number(self) -> f32 {
        match self {
            Self::Greedy => 0.0,
            Self::HalvedPer(gain) => gain.number(),
        }
    }

    fn nearest(number: f32) -> Self {
        match Value::nearest(number) {
            crate::cost::Gain::ZERO => Self::Greedy,
            halving => Self::HalvedPer(halving),
        }
    }
}

crate::parameters! {
    impl[] RouteSettings {
        SIGHT => params.radius,
        choice("exit", "ROUTE_EXIT", ExitRule::WORDS, "border cells that end a route: eq. 10, or algorithm 3")
            => params.exit,
        choice("replan", "ROUTE_REPLAN", Replan::WORDS, "when to plan; in formations in each cell")
            => replan,
        row("halved_per_ticks", "ROUTE_HALVED", "ticks", [0.0, 4095.0], "a move dearer by this is tried first half as often")
            => sharpness,
    }
}

impl RouteSettings {
    /// Creates the law on the grid, with a map.
    #[must_use]
    pub const fn on_grid<const CELLS: usize, const M: usize, const L: usize, H>(
        &self,
        map: H,
    ) -> RouteGuidance<CELLS, M, L, H> {
        RouteGuidance::with_map(self.params, map).replan(self.replan).sharpness(self.sharpness)
    }
}

impl Settings for RouteSettings {
    const NAME: &'static str = "route";
    const WHAT: &'static str = "each robot over land in cells to its own goal (A. V. Kuznetsov, KUZ)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }

    fn adapt(&mut self, _: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.params.radius = around.radius;
        (self.params.norm, self.params.corner_cutting) = (around.norm, around.corner_cutting);
        self.speed_mps = around.cruise_mps;
        Ok(())
    }
}

impl SettingsOfLaw for RouteSettings {
    const MOTION: Motion = Motion::Cells;
    const GOALS: Goals = Goals::Cell;

    fn cells(&self) -> usize {
        let side = 2 * usize::from(self.params.radius) + 3;
        side * side
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H: FarMap> MakesLaw<S, CELLS, M, L, H>
    for RouteSettings
{
    type Law = OverCells<Large<CellFollower<S, RouteGuidance<CELLS, M, L, H>>>, RouteGuidance<CELLS, M, L, H>>;

    fn law(&self, map: H) -> Self::Law {
        match self.speed_mps {
            Some(speed) => OverCells::InPlane(large(CellFollower::new(self.on_grid(map), cast(speed)))),
            None => OverCells::OnGrid(self.on_grid(map)),
        }
    }
}
