//! Settings of formations.

use super::{
    Footprint, FormationGuidance, FormationInPlane, FormationParams, NEVER, NextMove, Prediction, Recovery, Steering,
};
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::laws::any::{Large, large};
use crate::laws::cells::{FarMap, OverCells};
use crate::parameters::{Parameters, choice, switch, worded};
use crate::route::{Replan, RouteSettings};
use crate::scalar::{Scalar, cast};
use crate::template::{TEMPLATE, Template};
use serde::{Deserialize, Serialize};

/// Settings of [`FormationGuidance`], on the grid and in the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormationSettings {
    /// Routes of the leaders.
    pub route: RouteSettings,
    /// Keeping the formation.
    pub params: FormationParams,
    /// Whether the top leader waits for followers.
    pub waits: bool,
    /// The robot's place, and those of its neighbours.
    pub template: Template<TEMPLATE>,
}

worded!(Prediction, Recovery);

/// A formation that would keep its plans.
pub const NO_SEARCH: Contradiction =
    Contradiction::new("replan", "robots in formation search in each cell", "give \"each_cell\", or leave it out");

crate::parameters! {
    impl[] FormationSettings {
        switch("waits", "FORM_WAITS", "whether the top leader waits for followers") => waits,
        switch("closes_ranks", "FORM_CLOSES", "whether robots behind a dead one move up a place") => params.closes_ranks,
        choice("prediction", "FORM_PREDICTION", Prediction::WORDS, "others act as announced, or as this robot")
            => params.prediction,
        choice("recovery", "FORM_RECOVERY", Recovery::WORDS, "a leader of late robots waits, or heads where they head")
            => params.recovery,
    }
}

impl Default for FormationSettings {
    fn default() -> Self {
        let (route, params) = (RouteSettings::default(), FormationParams::default());
        Self { route, params, waits: true, template: Template::default() }
    }
}

impl FormationSettings {
    /// Creates the law on the grid with followers that steer by `steering`, and with a map.
    #[must_use]
    pub fn on_grid<const CELLS: usize, const M: usize, const L: usize, K: Steering, H>(
        &self,
        steering: K,
        map: H,
    ) -> FormationGuidance<CELLS, M, TEMPLATE, L, K, H> {
        let mut params = self.params;
        if !self.waits {
            (params.halt_lag, params.resume_lag) = (NEVER, NEVER);
        }
        let law = FormationGuidance::steered(self.route.params, params, self.template.clone(), steering, map);
        law.sharpness(self.route.sharpness)
    }

    /// How a leader prices the land under the others, if it does.
    #[must_use]
    pub const fn footprint(&self) -> Option<Footprint> {
        Footprint::of(self.params.footprint, self.route.speed_mps.is_some())
    }
}

impl Settings for FormationSettings {
    const NAME: &'static str = "formation";
    const WHAT: &'static str = "robots in places that travel together over land in cells (A. V. Kuznetsov, KUZ)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
        self.route.tables(visit);
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.route.adapt(is_given, around)?;
        let lags = ["halt_cells", "resume_cells"];
        if let Some(row) = lags.into_iter().find(|row| !self.waits && is_given(row)) {
            let (what, remedy) = ("with waits = false no robot waits", "leave out one of the two");
            return Err(Contradiction::new(row, what, remedy));
        }
        if self.route.replan == Replan::UntilChanged {
            return Err(NO_SEARCH);
        }
        let params = &mut self.params;
        if !is_given("resume_cells") {
            params.resume_lag = params.resume_lag.min(params.halt_lag);
        }
        if params.resume_lag > params.halt_lag {
            let (what, remedy) = ("more than halt_cells", "give at most halt_cells");
            return Err(Contradiction::new("resume_cells", what, remedy));
        }
        Ok(())
    }
}

impl SettingsOfLaw for FormationSettings {
    const MOTION: Motion = Motion::Cells;
    const GOALS: Goals = Goals::Cell;

    fn cells(&self) -> usize {
        self.route.cells()
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H: FarMap> MakesLaw<S, CELLS, M, L, H>
    for FormationSettings
{
    type Law = OverCells<
        Large<FormationInPlane<S, CELLS, M, TEMPLATE, L, H>>,
        Large<FormationGuidance<CELLS, M, TEMPLATE, L, NextMove, H>>,
    >;

    fn law(&self, map: H) -> Self::Law {
        let on_grid = self.on_grid(NextMove, map);
        match self.route.speed_mps {
            Some(speed) => OverCells::InPlane(large(FormationInPlane::new(on_grid, cast(speed)))),
            None => OverCells::OnGrid(large(on_grid)),
        }
    }
}
