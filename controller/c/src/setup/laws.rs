//! Creates the laws that cross land in cells from their parameters.

use super::{STAYA_MAX_RADIUS, StayaFormation, StayaRoute, StayaSetup};
use crate::choices::StayaLaw;
use crate::law::{Formation, Law, Route};
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{CELLS, CellFollower, FormationInPlane};
use staya_controller::cost::Gain;
use staya_controller::formation::{FormationParams, Prediction, Recovery};
use staya_controller::grid::Norm;
use staya_controller::route::{ExitRule, Replan, RouteParams};
use staya_controller::scalar::cast;
use staya_controller::shuffle::Sharpness;

const _: () = {
    let side = 2 * STAYA_MAX_RADIUS as usize + 3;
    assert!(side * side == CELLS);
};

pub(super) fn defaults(setup: &mut StayaSetup) {
    let (route, formation) = (RouteParams::default(), FormationParams::default());
    setup.route.time_gain_16ths = route.a0.sixteenths();
    setup.route.others_gain_16ths = route.a1.sixteenths();
    setup.route.visits_gain_16ths = route.a2.sixteenths();
    setup.route.way_gain_16ths = route.a3.sixteenths();
    setup.route.radius_cells = route.radius;
    setup.formation.gain_16ths = formation.gain.sixteenths();
    (setup.formation.halt_lag_units, setup.formation.resume_lag_units) = (formation.halt_lag, formation.resume_lag);
    (setup.formation.patience, setup.formation.eps_cells) = (formation.patience, formation.eps);
    (setup.formation.lead_cells, setup.formation.footprint_16ths) = (formation.lead, formation.footprint);
}

fn route_params(route: &StayaRoute) -> Checked<RouteParams> {
    match route.radius_cells {
        0 => Err(StayaStatus::Number),
        1..=STAYA_MAX_RADIUS => Ok(RouteParams {
            radius: route.radius_cells,
            exit: if route.exit_on_ray == 0 { ExitRule::Best } else { ExitRule::Ray },
            norm: if route.diagonals_count_as_one == 0 { Norm::Euclidean } else { Norm::Chebyshev },
            corner_cutting: route.cuts_corners != 0,
            a0: Gain::from_sixteenths(route.time_gain_16ths),
            a1: Gain::from_sixteenths(route.others_gain_16ths),
            a2: Gain::from_sixteenths(route.visits_gain_16ths),
            a3: Gain::from_sixteenths(route.way_gain_16ths),
        }),
        _ => Err(StayaStatus::Search),
    }
}

fn formation_params(formation: &StayaFormation) -> Checked<FormationParams> {
    if formation.resume_lag_units > formation.halt_lag_units {
        return Err(StayaStatus::Number);
    }
    Ok(FormationParams {
        eps: formation.eps_cells,
        gain: Gain::from_sixteenths(formation.gain_16ths),
        halt_lag: formation.halt_lag_units,
        resume_lag: formation.resume_lag_units,
        lead: formation.lead_cells,
        footprint: formation.footprint_16ths,
        patience: formation.patience,
        closes_ranks: formation.closes_ranks != 0,
        prediction: if formation.foresees_others == 0 { Prediction::Constant } else { Prediction::Reflexive },
        recovery: if formation.turns_back == 0 { Recovery::Wait } else { Recovery::Def },
    })
}

pub(super) fn law(setup: &StayaSetup, law: StayaLaw) -> Checked<Law> {
    let (params, speed) = (route_params(&setup.route)?, cast(setup.speed_mps));
    let sharpness = match setup.route.halved_per_16ths {
        0 => Sharpness::Greedy,
        gain => Sharpness::HalvedPer(Gain::from_sixteenths(gain)),
    };
    let replan = if setup.route.keeps_plan == 0 { Replan::EachCell } else { Replan::UntilChanged };
    let route = || Route::new(params).replan(replan).sharpness(sharpness);
    let formation = || {
        let (keeping, template) = (formation_params(&setup.formation)?, setup.formation.template()?);
        Ok(Formation::new(params, keeping, template).sharpness(sharpness))
    };
    Ok(match law {
        StayaLaw::Route => Law::Route(CellFollower::new(route(), speed)),
        StayaLaw::Formation => Law::Formation(FormationInPlane::new(formation()?, speed)),
        StayaLaw::RouteOnGrid => Law::RouteOnGrid(route()),
        _ => Law::FormationOnGrid(formation()?),
    })
}
