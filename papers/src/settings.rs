//! Settings of the laws of papers.

use crate::criteria::PublishedParams;
use crate::{Course, PublishedFormation};
use staya_controller::agent::{
    Around, Contradiction, FarMap, FormationGuidance, FormationSettings, Goals, Motion, RouteSettings, Settings,
    SettingsOfLaw, TEMPLATE,
};
use staya_controller::formation::{FormationParams, NO_SEARCH, Prediction};
use staya_controller::grid::UNIT;
use staya_controller::parameters::{Parameters, choice, row};
use staya_controller::route::Replan;
use staya_controller::template::Template;

/// Settings of [`PublishedFormation`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PublishedSettings {
    /// Routes of the robots.
    pub route: RouteSettings,
    /// Keeping the formation.
    pub params: PublishedParams,
    /// The robot's place, and those of its neighbours.
    pub template: Template<TEMPLATE>,
}

staya_controller::parameters! {
    impl[] PublishedSettings {
        row("eps_cells", "FORM_EPS", "cells", [0.0, 255.0], "largest distance from a place that still counts as there")
            => params.eps,
        row("place_gain", "FORM_GAIN", "ticks", [0.0, 4095.0], "price of a cell of deviation from one neighbour")
            => params.gain,
        row("halt_cells", "FORM_HALT", "cells", [0.0, 937.0], "sum of deviations at which the formation is lost")
            => params.halt / UNIT as f32,
        row("resume_cells", "FORM_RESUME", "cells", [0.0, 937.0], "sum at which it is kept again")
            .depends("9, at most `halt_cells`") => params.resume / UNIT as f32,
        row("crowd", "FORM_CROWD", "robots", [0.0, 255.0], "missing or surplus robots above which others are asked to turn")
            => params.crowd,
        choice("prediction", "FORM_PREDICTION", Prediction::WORDS, "others act as announced, or as this robot")
            => params.prediction,
    }
}

impl PublishedSettings {
    /// Creates the law.
    #[must_use]
    pub fn law<const CELLS: usize, const M: usize>(&self) -> PublishedFormation<CELLS, M, TEMPLATE> {
        PublishedFormation::new(self.route.params, self.params, self.template.clone()).sharpness(self.route.sharpness)
    }
}

impl Settings for PublishedSettings {
    const NAME: &'static str = "formation_paper";
    const WHAT: &'static str =
        "formations on the grid as published: each robot weighs its own route (A. V. Kuznetsov, KUZ)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
        self.route.tables(visit);
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.route.adapt(is_given, around)?;
        if self.route.replan == Replan::UntilChanged {
            return Err(NO_SEARCH);
        }
        if !is_given("resume_cells") {
            self.params.resume = self.params.resume.min(self.params.halt);
        }
        if self.params.resume > self.params.halt {
            let (what, remedy) = ("more than halt_cells", "give at most halt_cells");
            return Err(Contradiction::new("resume_cells", what, remedy));
        }
        Ok(())
    }
}

impl SettingsOfLaw for PublishedSettings {
    const MOTION: Motion = Motion::Cells;
    const GOALS: Goals = Goals::Cell;
}

/// Settings of formations on the grid whose followers predict the [`Course`] of their leader.
#[derive(Clone, Debug, PartialEq)]
pub struct LookaheadSettings(pub FormationSettings);

impl Default for LookaheadSettings {
    fn default() -> Self {
        Self(FormationSettings { params: FormationParams::looking_ahead(), ..FormationSettings::default() })
    }
}

impl LookaheadSettings {
    /// Creates the law, with a map.
    #[must_use]
    pub fn law<const CELLS: usize, const M: usize, const L: usize, H: FarMap>(
        &self,
        map: H,
    ) -> FormationGuidance<CELLS, M, TEMPLATE, L, Course, H> {
        self.0.on_grid(Course::new(), map)
    }
}

impl Settings for LookaheadSettings {
    const NAME: &'static str = "formation_lookahead";
    const WHAT: &'static str = "formations on the grid whose followers plan to where their places will be";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.0.tables(visit);
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.0.adapt(is_given, around)
    }
}

impl SettingsOfLaw for LookaheadSettings {
    const MOTION: Motion = Motion::Cells;
    const GOALS: Goals = Goals::Cell;
}
