//! `[plane.lattice]`, `[plane.goal_flock]` and `[plane.boids]`.

use super::super::ranges::{range, row, unit};
use super::super::source::Source;
use super::super::{ScenarioError, ScenarioFile};
use super::fields::Group;
use crate::radio::RadioParams;
use staya_controller::agent::{BoidsSetup, GuidanceKind, GuidanceSetup};
use staya_controller::boids::BoidsParams;
use staya_controller::goal_flock::GoalParams;
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, ReferenceMotion};
use staya_controller::parameters::{MIN_DISTANCE, Parameters as _, TOLERANCE};

/// Ratio of the alpha gain to the goal gain in algorithm 2: see `LatticeParams::gamma`.
const GAMMA_OF_TWO: f32 = 50.0;

/// Size of the largest formation. Flock numbers start there: beacons store both in one field.
pub(super) fn places(file: &ScenarioFile) -> u8 {
    let in_cells = file.robots.iter().flat_map(|robots| &robots.formation.0);
    let formations = in_cells.chain(file.group_formations());
    let places = formations.map(|formation| match (formation.rows, formation.columns, &formation.places) {
        (Some(rows), Some(columns), _) => usize::from(rows) * usize::from(columns),
        (_, _, places) => places.as_ref().map_or(0, Vec::len),
    });
    places.max().map_or(0, |most| u8::try_from(most).unwrap_or(u8::MAX))
}

pub(super) fn number(source: &Source<'_>, group: &Group, given: Option<u8>, places: u8) -> Result<(), ScenarioError> {
    let (what, remedy) = match given {
        Some(_) if group.body.guidance == GuidanceKind::Formation => {
            ("robots in formation are in no flock".to_owned(), "leave it out".to_owned())
        }
        Some(given) if given < places => (
            format!("{given} is also the number of a place in a formation, and robots cannot tell these apart"),
            format!("give {places} or more, or leave it out"),
        ),
        _ => return Ok(()),
    };
    Err(source.error(&group.field("flock"), what, remedy))
}

fn goes_with<T: Copy>(
    source: &Source<'_>,
    group: &Group,
    guidance: GuidanceKind,
    name: &str,
    given: Option<T>,
) -> Result<Option<T>, ScenarioError> {
    let field = group.field(name);
    match (group.body.guidance == guidance, given.is_some()) {
        (true, false) => {
            let what = "this guidance needs distances to go by";
            let remedy = "scenarios/README.md lists the fields of its table";
            Err(source.error(&field, what, remedy))
        }
        (false, true) => {
            let remedy = format!("give {}.guidance = \"{name}\", or leave this table out", group.table);
            Err(source.error(&field, "these robots have another guidance", remedy))
        }
        _ => Ok(given),
    }
}

/// Gains default to values that are stable with this radio's delay.
pub(super) fn lattice(
    source: &Source<'_>,
    file: &ScenarioFile,
    group: &Group,
) -> Result<Option<GuidanceSetup>, ScenarioError> {
    let given = goes_with(source, group, GuidanceKind::Lattice, "lattice", group.body.lattice)?;
    let Some(given) = given else {
        return Ok(None);
    };
    let mut params = LatticeParams::<f32>::new(1.0);
    let fields = [("spacing_m", Some(given.spacing_m)), ("obstacle_ratio", given.obstacle_ratio)];
    group.set(source, "lattice", &mut params, &fields)?;
    params.algorithm = match given.algorithm {
        Some(1) => Algorithm::One,
        Some(2) => Algorithm::Two,
        None | Some(3) => Algorithm::Three,
        Some(other) => {
            let what = format!("there is no algorithm {other}");
            return Err(source.error(&group.field("lattice.algorithm"), what, "give 1, 2 or 3"));
        }
    };
    if given.takes_turns == Some(true) {
        if params.algorithm != Algorithm::Three {
            let (what, remedy) = ("robots take turns in algorithm 3 only", "give algorithm = 3, or leave it out");
            return Err(source.error(&group.field("lattice.takes_turns"), what, remedy));
        }
        params.algorithm = Algorithm::ThreeInTurn;
    }
    if params.algorithm == Algorithm::Two {
        // The pull grows with the size of the flock.
        params.gamma = Gain::critical(params.alpha.position / GAMMA_OF_TWO);
    }
    if given.c_alpha.is_none() {
        let (delay_s, rate_hz) = file.radio.news(file.tick_s);
        params = params.stable_for(delay_s as f32, rate_hz as f32);
    }
    let table = params.table();
    for (field, gain, name, param) in [
        ("lattice.c_alpha", given.c_alpha, "c1_alpha", &mut params.alpha),
        ("lattice.c_beta", given.c_beta, "c1_beta", &mut params.beta),
        ("lattice.c_gamma", given.c_gamma, "c1_gamma", &mut params.gamma),
    ] {
        if let Some(gain) = gain {
            let row = row(table, name);
            group.within(source, field, gain, range(row), unit(row))?;
            *param = Gain::critical(gain as f32);
        }
    }
    let motion = match (given.goal_moves, given.goal_rest_m) {
        (Some(false), None) => ReferenceMotion::Static,
        (_, None) => ReferenceMotion::Dynamic,
        (Some(false), Some(within_m)) => {
            group.within(source, "lattice.goal_rest_m", within_m, [0.01, 1e6], "metres")?;
            ReferenceMotion::Resting(within_m as f32)
        }
        (_, Some(_)) => {
            let (what, remedy) = ("a goal that moves gives no rest", "give goal_moves = false, or leave it out");
            return Err(source.error(&group.field("lattice.goal_rest_m"), what, remedy));
        }
    };
    Ok(Some(GuidanceSetup::Lattice { params, motion }))
}

pub(in super::super) fn remark(params: &LatticeParams<f32>, radio: &RadioParams, tick_s: f64) -> Option<String> {
    let (delay_s, rate_hz) = radio.news(tick_s);
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

pub(super) fn goal_flock(
    source: &Source<'_>,
    group: &Group,
    cruise_mps: f64,
    seed: u64,
) -> Result<Option<GuidanceSetup>, ScenarioError> {
    let wanted = GuidanceKind::GoalFlock;
    let Some(given) = goes_with(source, group, wanted, "goal_flock", group.body.goal_flock)? else {
        return Ok(None);
    };
    let least = given.min_distance_m;
    group.within(source, "goal_flock.min_distance_m", least, range(&MIN_DISTANCE), "metres")?;
    let seen = given.neighborhood_m.unwrap_or(4.0 * least);
    let [_, most] = range(row(GoalParams::<f32>::TABLE, "neighborhood_m"));
    group.within(source, "goal_flock.neighborhood_m", seen, [2.0 * least, most], "metres")?;
    let arrival_m = given.arrival_m.unwrap_or(seen);
    group.within(source, "goal_flock.arrival_m", arrival_m, range(&TOLERANCE), "metres")?;
    let mut params = GoalParams::new(least as f32, cruise_mps as f32);
    params.neighborhood_m = seen as f32;
    let gains = [("k1", given.k1), ("k2", given.k2), ("k3", given.k3)];
    group.set(source, "goal_flock", &mut params, &gains)?;
    Ok(Some(GuidanceSetup::GoalFlock { params, arrival_m: arrival_m as f32, seed }))
}

pub(super) fn boids(
    source: &Source<'_>,
    group: &Group,
    cruise_mps: f64,
) -> Result<Option<GuidanceSetup>, ScenarioError> {
    let given = goes_with(source, group, GuidanceKind::Boids, "boids", group.body.boids)?;
    let Some(given) = given else {
        return Ok(None);
    };
    let mut params = BoidsSetup::PAPER;
    for (name, value, param) in [
        ("crowded_m", Some(given.crowded_m), &mut params.crowded_m),
        ("closest_m", Some(given.closest_m), &mut params.closest_m),
        ("max_turn", given.max_turn, &mut params.max_turn),
        ("max_turn_away", given.max_turn_away, &mut params.max_turn_away),
    ] {
        if let Some(value) = value {
            let row = row(BoidsParams::<f32>::TABLE, name);
            group.within(source, &format!("boids.{name}"), value, range(row), unit(row))?;
            *param = value as f32;
        }
    }
    Ok(Some(GuidanceSetup::Boids { params, speed_mps: cruise_mps as f32 }))
}
