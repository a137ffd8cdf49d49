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
    setup.route = StayaRoute {
        time_gain_16ths: route.a0.sixteenths(),
        others_gain_16ths: route.a1.sixteenths(),
        visits_gain_16ths: route.a2.sixteenths(),
        way_gain_16ths: route.a3.sixteenths(),
        halved_per_16ths: 0,
        radius_cells: route.radius,
        exit_on_ray: 0,
        diagonals_count_as_one: 0,
        cuts_corners: 0,
        keeps_plan: 0,
    };
    setup.formation.gain_16ths = formation.gain.sixteenths();
    setup.formation.halt_lag_units = formation.halt_lag;
    setup.formation.resume_lag_units = formation.resume_lag;
    setup.formation.patience = formation.patience;
    setup.formation.eps_cells = formation.eps;
    setup.formation.lead_cells = formation.lead;
    setup.formation.footprint_16ths = formation.footprint;
}

fn route_params(route: &StayaRoute) -> Checked<RouteParams> {
    if route.radius_cells > STAYA_MAX_RADIUS {
        return Err(StayaStatus::Search);
    }
    if route.radius_cells == 0 {
        return Err(StayaStatus::Number);
    }
    Ok(RouteParams {
        radius: route.radius_cells,
        exit: if route.exit_on_ray == 0 { ExitRule::Best } else { ExitRule::Ray },
        norm: if route.diagonals_count_as_one == 0 { Norm::Euclidean } else { Norm::Chebyshev },
        corner_cutting: route.cuts_corners != 0,
        a0: Gain::from_sixteenths(route.time_gain_16ths),
        a1: Gain::from_sixteenths(route.others_gain_16ths),
        a2: Gain::from_sixteenths(route.visits_gain_16ths),
        a3: Gain::from_sixteenths(route.way_gain_16ths),
    })
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
    let params = route_params(&setup.route)?;
    let sharpness = match setup.route.halved_per_16ths {
        0 => Sharpness::Greedy,
        gain => Sharpness::HalvedPer(Gain::from_sixteenths(gain)),
    };
    let replan = if setup.route.keeps_plan == 0 { Replan::EachCell } else { Replan::UntilChanged };
    let route = || Route::new(params).replan(replan).sharpness(sharpness);
    let formation = || {
        let (params, template) = (formation_params(&setup.formation)?, setup.formation.template()?);
        Ok(Formation::new(route_params(&setup.route)?, params, template).sharpness(sharpness))
    };
    let speed = cast(setup.speed_mps);
    Ok(match law {
        StayaLaw::Route => Law::Route(CellFollower::new(route(), speed)),
        StayaLaw::Formation => Law::Formation(FormationInPlane::new(formation()?, speed)),
        StayaLaw::RouteOnGrid => Law::RouteOnGrid(route()),
        _ => Law::FormationOnGrid(formation()?),
    })
}
