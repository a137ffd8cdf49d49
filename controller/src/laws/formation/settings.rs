//! Settings of formations.

use super::{FormationGuidance, FormationParams, NEVER, Prediction, Recovery, Steering};
use crate::law::{Around, Contradiction, Goals, Motion, Settings};
use crate::parameters::{Parameters, choice, switch, worded};
use crate::route::{Replan, RouteSettings};
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
pub const NO_SEARCH: Contradiction = Contradiction {
    row: "replan",
    what: "robots in formation search in each cell",
    remedy: "give \"each_cell\", or leave it out",
};

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
    pub fn law<const CELLS: usize, const M: usize, const L: usize, K: Steering, H>(
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
}

impl Settings for FormationSettings {
    const NAME: &'static str = "formation";
    const WHAT: &'static str = "robots in places that travel together over land in cells (A. V. Kuznetsov, KUZ)";
    const MOTION: Motion = Motion::Cells;
    const GOALS: Goals = Goals::Cell;

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
            return Err(Contradiction { row, what, remedy });
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
            return Err(Contradiction { row: "resume_cells", what, remedy });
        }
        Ok(())
    }
}
