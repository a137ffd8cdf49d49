//! `[plane.lattice]`, `[plane.goal_flock]` and `[plane.boids]`.

use super::super::ScenarioFile;
use super::super::given::Given;
use super::super::source::Checked;
use super::body::Group;
use super::table::{BoidsTable, GoalFlockTable, LatticeTable};
use crate::radio::RadioParams;
use staya_controller::agent::{BoidsSetup, GuidanceKind, GuidanceSetup};
use staya_controller::goal_flock::GoalParams;
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, ReferenceMotion};
use staya_controller::parameters::TOLERANCE;

/// Ratio of the alpha gain to the goal gain in algorithm 2: see `LatticeParams::gamma`.
const GAMMA_OF_TWO: f32 = 50.0;

/// Size of the largest formation. Flock numbers start there: beacons store both in one field.
pub(super) fn places(file: &ScenarioFile) -> u8 {
    let places = file.formations().map(|formation| match (formation.rows, formation.columns, &formation.places) {
        (Some(rows), Some(columns), _) => usize::from(rows) * usize::from(columns),
        (_, _, places) => places.as_ref().map_or(0, Vec::len),
    });
    places.max().map_or(0, |most| u8::try_from(most).unwrap_or(u8::MAX))
}

pub(super) fn number(group: &Group<'_>, given: Option<u8>, places: u8) -> Checked {
    let Some(given) = given else { return Ok(()) };
    let is_formation = group.body.guidance == GuidanceKind::Formation;
    group.at.require(!is_formation, "flock", "robots in formation are in no flock", "leave it out")?;
    let what = format!("{given} is also the number of a place in a formation, and robots cannot tell these apart");
    group.at.require(given >= places, "flock", what, format!("give {places} or more, or leave it out"))
}

/// The law of a group that flocks. Its table and the law go together.
pub(super) fn guidance(group: &Group<'_>, cruise_mps: f64) -> Checked<Option<GuidanceSetup>> {
    let body = &group.body;
    for (guidance, has_table) in [
        (GuidanceKind::Lattice, body.lattice.is_some()),
        (GuidanceKind::GoalFlock, body.goal_flock.is_some()),
        (GuidanceKind::Boids, body.boids.is_some()),
    ] {
        let (name, is_own) = (guidance.name(), body.guidance == guidance);
        let remedy = "scenarios/README.md lists the fields of its table";
        group.at.require(has_table || !is_own, name, "this guidance needs distances to go by", remedy)?;
        let remedy = format!("give {}.guidance = \"{name}\", or leave this table out", group.at.path);
        group.at.require(is_own || !has_table, name, "these robots have another guidance", remedy)?;
    }
    let lattice = body.lattice.as_ref().map(|table| lattice(group, table));
    let goal_flock = || Some(goal_flock(group, body.goal_flock.as_ref()?, cruise_mps));
    let boids = || Some(Ok(boids(body.boids.as_ref()?, cruise_mps)));
    lattice.or_else(goal_flock).or_else(boids).transpose()
}

/// Gains default to values that are stable with this radio's delay.
fn lattice(group: &Group<'_>, given: &LatticeTable) -> Checked<GuidanceSetup> {
    let mut params = LatticeParams::<f32>::new(1.0);
    params.algorithm = match (given.algorithm, given.takes_turns) {
        (1, false) => Algorithm::One,
        (2, false) => Algorithm::Two,
        (3, false) => Algorithm::Three,
        (3, true) => Algorithm::ThreeInTurn,
        _ => {
            let (what, remedy) = ("robots take turns in algorithm 3 only", "give algorithm = 3, or leave it out");
            return Err(group.at.error("lattice.takes_turns", what, remedy));
        }
    };
    if params.algorithm == Algorithm::Two {
        // The pull grows with the size of the flock.
        params.gamma = Gain::critical(params.alpha.position / GAMMA_OF_TWO);
    }
    if given.params.get("c_alpha").is_none() {
        let (delay_s, rate_hz) = group.draft.file.radio.news(group.draft.step_s());
        params = params.stable_for(delay_s as f32, rate_hz as f32);
    }
    given.params.store(&mut params);
    for (name, gain) in [("c_alpha", &mut params.alpha), ("c_beta", &mut params.beta), ("c_gamma", &mut params.gamma)] {
        if given.params.get(name).is_some() {
            *gain = Gain::critical(gain.position);
        }
    }
    let motion = match (given.goal_moves, given.goal_rest_m) {
        (true, None) => ReferenceMotion::Dynamic,
        (false, None) => ReferenceMotion::Static,
        (false, Some(within_m)) => ReferenceMotion::Resting(within_m as f32),
        (true, Some(_)) => {
            let (what, remedy) = ("a goal that moves gives no rest", "give goal_moves = false, or leave it out");
            return Err(group.at.error("lattice.goal_rest_m", what, remedy));
        }
    };
    Ok(GuidanceSetup::Lattice { params, motion })
}

pub(super) fn remark(params: &LatticeParams<f32>, radio: &RadioParams, step_s: f64) -> Option<String> {
    let (delay_s, rate_hz) = radio.news(step_s);
    let news_s = delay_s + 1.0 / rate_hz;
    let (gain, pull) = (f64::from(params.alpha.position), f64::from(params.gamma.position));
    if news_s > 1.001 * f64::from(params.oldest_news_s()) {
        let bearable = params.stable_for(delay_s as f32, rate_hz as f32).alpha.position;
        return Some(format!(
            "plane.lattice.c_alpha = {gain}: the flock will shake itself apart, since robots hear of each other up to \
             {news_s:.2} s late; at most {bearable:.2} bears that, and is taken if you leave the field out"
        ));
    }
    (params.algorithm == Algorithm::Two && gain < 0.99 * f64::from(GAMMA_OF_TWO) * pull).then(|| {
        format!(
            "plane.lattice.c_gamma = {pull}: in algorithm 2 it squeezes a large flock until robots coincide; give at most \
             c_alpha / {GAMMA_OF_TWO} = {:.3}",
            gain / f64::from(GAMMA_OF_TWO)
        )
    })
}

fn goal_flock(group: &Group<'_>, given: &GoalFlockTable, cruise_mps: f64) -> Checked<GuidanceSetup> {
    let least_m = given.params.need("min_distance_m");
    let seen_m = given.params.get("neighborhood_m").unwrap_or(4.0 * least_m);
    let most_m = Given::<GoalParams<f32>>::limits("neighborhood_m").most();
    group.at.within("goal_flock.neighborhood_m", seen_m, 2.0 * least_m..=most_m, "metres")?;
    let arrival_m = given.arrival_m.unwrap_or(seen_m);
    group.at.limit("goal_flock.arrival_m", arrival_m, &super::Limits::of(&TOLERANCE))?;
    let mut params = GoalParams::new(least_m as f32, cruise_mps as f32);
    given.params.store(&mut params);
    params.neighborhood_m = seen_m as f32;
    Ok(GuidanceSetup::GoalFlock { params, arrival_m: arrival_m as f32, seed: group.draft.file.seed })
}

fn boids(given: &BoidsTable, cruise_mps: f64) -> GuidanceSetup {
    let usual = BoidsSetup::PAPER;
    let value = |name, usual| given.params.get(name).map_or(usual, |value| value as f32);
    let params = BoidsSetup {
        crowded_m: value("crowded_m", usual.crowded_m),
        closest_m: value("closest_m", usual.closest_m),
        max_turn: value("max_turn", usual.max_turn),
        max_turn_away: value("max_turn_away", usual.max_turn_away),
    };
    GuidanceSetup::Boids { params, speed_mps: cruise_mps as f32 }
}
