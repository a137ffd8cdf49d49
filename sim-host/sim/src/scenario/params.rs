//! `[grid]`, `[route]` and `[formation]`: route planning and formation keeping. Defaults are the
//! controller's; a test compares them with the list in scenarios/README.md.

use super::given::Given;
use super::ranges::units;
use super::source::Checked;
use super::{Draft, ScenarioFile};
use crate::{choice, defaults, names, table};
use staya_controller::agent::RouteSetup;
use staya_controller::cost::Gain;
use staya_controller::formation::{FormationParams, NEVER, Prediction, Recovery};
use staya_controller::grid::{Norm, UNIT};
use staya_controller::parameters::Value as _;
use staya_controller::route::{ExitRule, Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_papers::criteria::PublishedParams;

table! {
    /// `[grid]`.
    #[derive(Copy)]
    pub struct GridTable {
        /// `"euclidean"` (a diagonal move is sqrt 2 long; the default) or `"chebyshev"` (1).
        pub norm: Norm = Default::default();
        /// Whether a diagonal move may pass a blocked orthogonal neighbour. Default: false.
        pub corner_cutting: bool = false;
        /// Number of neighbours of a cell to which robots move, 4 or 8. Default: 8.
        pub moves: u8 = 8;
        /// Whether all robots move at once, as in POGEMA; for 4 neighbours. Default: false.
        pub simultaneous: bool = false;
    }
}

table! {
    /// `[route]`: windowed routing (KUZ sections 3 and 5). Coefficients are rounded to sixteenths.
    pub struct RouteTable {
        // Coefficients of the costs.
        part costs: Given<RouteParams>;
        /// Sight, cells in each direction, 1 to 16.
        pub radius: Option<u8>, 1.0..=16.0, "cells";
        /// Which border cells of the window end a route: `"best"` (eq. 10) or `"ray"` (alg. 3).
        pub exit: Option<ExitRule>;
        /// When to plan: `"each_cell"` or `"until_changed"` (keeps its plan; not in formations).
        pub replan: Replan = Default::default();
        /// Weighted shuffle: a move that costs this many more ticks than another is half as likely
        /// to be tried first, 0 to 4095. 0: cheapest first, without randomness.
        pub halved_per_ticks: f64 = 0.0, 0.0..=4095.0, "";
    }
}

choice! {
    /// The laws of formation keeping by name.
    #[derive(Default)]
    pub enum FormationLaw {
        /// Staya's: the top leader chooses the route and waits ([`staya_controller::formation`]).
        #[default]
        Staya = "staya",
        /// The paper's: each robot weighs its own route ([`PublishedParams`]).
        Paper = "paper",
        /// Staya's, with routes to the future positions of places ([`staya_papers::Course`]).
        Lookahead = "lookahead",
    }
}

table! {
    /// `[formation]`: keeping a formation (KUZ section 7); for `robots.formation` only.
    pub struct FormationTable {
        // Cost of distance from the own place, and lags; `resume_cells` is at most `halt_cells`.
        part params: Given<FormationParams>;
        /// The law: `"staya"`; `"lookahead"` (`"staya"` with followers that plan to where their
        /// places will be); `"paper"` (as published by A. V. Kuznetsov). The last two are for the
        /// grid only.
        pub law: FormationLaw = Default::default();
        /// Largest number of graph edges between robots that count as neighbours, 1 or more; no
        /// robot may have more than 8 neighbours. Default: the largest of 3, 2, 1 that fits.
        pub rho: Option<u8>;
        /// Distance from its place within which a neighbour counts as found, cells.
        pub eps: Option<u8>;
        /// Whether the top leader waits for followers; not with `law = "paper"`, nor in the plane.
        pub waits: bool = true;
        /// Missing or surplus robots above which others are asked to turn; with `law = "paper"`.
        pub crowd: Option<u8>;
        /// How far ahead of the top leader's cell the followers aim, cells.
        pub lead: Option<u8>;
        /// Weight of the land under followers in the leader's costs, 0 to 1; rounded to sixteenths.
        pub footprint: Option<f64>, 0.0..=1.0, "(a share)";
        /// Whether robots behind a dead robot move up a place each; otherwise its place stays
        /// empty.
        pub closes_ranks: Option<bool>;
        /// Prediction of others: `"constant"` (as announced) or `"reflexive"` (as this robot
        /// decides).
        pub prediction: Option<Prediction>;
        /// Reaction of the top leader to lag: `"wait"` or `"def"` (go where the others are
        /// heading).
        pub recovery: Option<Recovery>;
    }
}

names!(Norm, ExitRule, Replan, Prediction, Recovery);
defaults!(GridTable, RouteTable, FormationTable);

const MAX_RADIUS: u8 = 16;

pub(super) fn sight(file: &ScenarioFile) -> u8 {
    file.route.radius.unwrap_or(RouteParams::default().radius)
}

pub(super) fn routing(draft: &Draft<'_>) -> Checked<RouteSetup> {
    let (table, grid) = (&draft.file.route, &draft.file.grid);
    let mut radius = sight(&draft.file);
    if let Some(scouting) = &draft.file.scouting {
        let wide = scouting.radius.unwrap_or(MAX_RADIUS);
        draft.within("scouting.radius", wide.into(), radius.into()..=MAX_RADIUS.into(), "cells")?;
        radius = wide;
    }
    let (norm, corner_cutting) = (grid.norm, grid.corner_cutting);
    let mut params = RouteParams { radius, norm, corner_cutting, ..RouteParams::default() };
    params.exit = table.exit.unwrap_or(params.exit);
    table.costs.store(&mut params);
    let sharpness = match Gain::nearest(table.halved_per_ticks as f32) {
        Gain::ZERO => Sharpness::Greedy,
        halving => Sharpness::HalvedPer(halving),
    };
    Ok(RouteSetup { params, replan: table.replan, sharpness })
}

pub(super) fn formation(draft: &Draft<'_>) -> Checked<FormationParams> {
    let table = &draft.file.formation;
    let looks_ahead = table.law == FormationLaw::Lookahead;
    let mut params = if looks_ahead { FormationParams::looking_ahead() } else { FormationParams::default() };
    params.eps = table.eps.unwrap_or(params.eps);
    params.lead = table.lead.unwrap_or(params.lead);
    params.gain = table.params.get("gain").map_or(params.gain, |gain| Gain::nearest(gain as f32));
    params.halt_lag = table.params.get("halt_cells").map_or(params.halt_lag, units);
    params.resume_lag = params.resume_lag.min(params.halt_lag);
    if let Some(cells) = table.params.get("resume_cells") {
        let most = f64::from(params.halt_lag) / f64::from(UNIT);
        draft.within("formation.resume_cells", cells, 0.0..=most, "cells")?;
        params.resume_lag = units(cells);
    }
    params.footprint = table.footprint.map_or(params.footprint, |share| libm::round(share * 16.0) as u8);
    if !table.waits {
        (params.halt_lag, params.resume_lag) = (NEVER, NEVER);
    }
    params.closes_ranks = table.closes_ranks.unwrap_or(params.closes_ranks);
    params.prediction = table.prediction.unwrap_or(params.prediction);
    params.recovery = table.recovery.unwrap_or(params.recovery);
    Ok(params)
}

/// The law of formations, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormationSetup {
    /// Staya's.
    Staya(FormationParams),
    /// Staya's, whose followers predict the course of their formation; grid only.
    Lookahead(FormationParams),
    /// The published one; grid only.
    Published(PublishedParams),
}

impl FormationSetup {
    pub(super) fn new(draft: &Draft<'_>) -> Checked<Self> {
        Ok(match draft.file.formation.law {
            FormationLaw::Staya => Self::Staya(formation(draft)?),
            FormationLaw::Lookahead => Self::Lookahead(formation(draft)?),
            FormationLaw::Paper => Self::Published(published(&draft.file.formation)),
        })
    }

    /// Parameters of Staya's law; with the published law, the defaults.
    #[must_use]
    pub fn params(&self) -> FormationParams {
        match self {
            Self::Staya(params) | Self::Lookahead(params) => *params,
            Self::Published(_) => FormationParams::default(),
        }
    }

    /// Distance from its place within which a member counts as found, cells.
    #[must_use]
    pub fn eps(&self) -> u8 {
        match self {
            Self::Published(params) => params.eps,
            _ => self.params().eps,
        }
    }
}

fn published(table: &FormationTable) -> PublishedParams {
    let usual = PublishedParams::default();
    let halt = table.params.get("halt_cells").map_or(usual.halt, units);
    PublishedParams {
        eps: table.eps.unwrap_or(usual.eps),
        gain: table.params.get("gain").map_or(usual.gain, |gain| Gain::nearest(gain as f32)),
        halt,
        resume: table.params.get("resume_cells").map_or(usual.resume, units).min(halt),
        crowd: table.crowd.unwrap_or(usual.crowd),
        prediction: table.prediction.unwrap_or(usual.prediction),
    }
}
