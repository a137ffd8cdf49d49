//! Every law with every safety layer, with a perfect, a lossy and a dead radio: robots
//! arrive or stay together, do not overlap where that can be avoided, and stay in their area.

use rayon::prelude::*;
use staya_controller::agent::{Goals, LawSettings, LayerSettings};
use staya_controller::push_out::Model;
use staya_sim::metrics::flock::FlockMeter;
use staya_sim::nearby::Space;
use staya_sim::scenario::{Overrides, Scenario, ScenarioError};
use staya_tests::run;
use std::path::Path;

const ROBOTS: usize = 6;
const RADIUS_M: f64 = 0.2;
const FASTEST_MPS: f64 = 1.0;
const SPACING_M: f64 = 1.0;

const RADIOS: [(&str, &str); 3] = [("perfect", ""), ("lossy", "loss = 0.3"), ("dead", "loss = 1")];

type Layer = (&'static str, Model);

fn layers() -> Vec<Layer> {
    let kinds = LayerSettings::ALL.iter().map(|&(name, _)| (name, Model::Radial));
    kinds.chain([("push_out", Model::Tangential)]).collect()
}

fn goals(law: &str) -> Goals {
    LawSettings::by_name(law).expect("a law").goals()
}

/// Robots, settings, and the smallest and largest x and y.
fn swarm(law: &str) -> (&'static str, &'static str, [f64; 2]) {
    match law {
        _ if goals(law) == Goals::Waypoints => {
            ("robots.circle = { count = 6, radius_m = 3, noise_m = 0.05 }", "", [-5.0, 5.0])
        }
        "lattice" => (
            "robots.cloud = { count = 6, from_m = [0, 0], to_m = [3, 3], goals_m = [[6, 6]] }\nlattice = { spacing_m = 1 }",
            "",
            [-4.0, 10.0],
        ),
        "goal_flock" => (
            "robots.cloud = { count = 6, from_m = [0, 0], to_m = [3, 3], goals_m = [[8, 8]] }\n\
             goal_flock = { min_distance_m = 0.7 }",
            "",
            [-4.0, 12.0],
        ),
        "boids" => (
            "robots.cloud = { count = 6, from_m = [0, 0], to_m = [4, 4] }\nboids = { crowded_m = 0.8, closest_m = 4 }",
            "",
            [-100.0, 100.0],
        ),
        _ if goals(law) == Goals::Cell && law != "formation" => (
            "",
            "[terrain]\nuniform = { width = 12, height = 12, classes = 1 }\n[robots]\nlist = [{ start = [1, 5], goal = [10, 5] }, \
             { start = [10, 6], goal = [1, 6] }, { start = [5, 1], goal = [5, 10] }, { start = [6, 10], goal = [6, 1] }, \
             { start = [1, 1], goal = [10, 10] }, { start = [10, 1], goal = [1, 10] }]",
            [0.0, 12.0],
        ),
        "formation" => (
            "",
            "[terrain]\nuniform = { width = 24, height = 12, classes = 1 }\n\
             [robots.formation]\nrows = 2\ncolumns = 3\nspacing = [2, -2]\nstart = [2, 8]\ngoal = [16, 8]",
            [0.0, 24.0],
        ),
        _ => ("robots.cloud = { count = 6, from_m = [0, 0], to_m = [4, 4] }", "", [-100.0, 100.0]),
    }
}

fn scenario(law: &str, (safety, model): Layer, radio: &str) -> Result<Scenario, ScenarioError> {
    let (own, above, _) = swarm(law);
    let push_out = match safety {
        "push_out" => format!("push_out = {{ min_distance_m = 0.5, model = \"{}\" }}", model.name()),
        _ => String::new(),
    };
    let text = format!(
        "name = \"matrix\"\nseed = 1\nticks = 1800\ntick_s = 0.05\n[radio]\nrange_m = 30\n{radio}\n{above}\n[plane]\n\
         radius_m = {RADIUS_M}\nmax_speed_mps = {FASTEST_MPS}\ntolerance_m = 0.05\nlaw = \"{}\"\nsafety = \"{}\"\n{own}\n{push_out}\n",
        law, safety,
    );
    Scenario::parse(&text, Path::new("matrix.toml"), &Overrides::default())
}

/// A robot with a straight path cannot pass another one if both turn aside.
fn is_refused(law: &str, layer: Layer) -> bool {
    (law, layer) == ("waypoint", ("push_out", Model::Tangential))
}

#[derive(Debug)]
struct Verdict {
    arrived: usize,
    /// For a range of two spacings.
    parts: usize,
    overlaps: u64,
    deepest_m: f64,
    /// Within the speed limit and the area.
    stays: bool,
}

fn verdict(law: &str, safety: Layer, radio: &str) -> Verdict {
    let (.., [low, high]) = swarm(law);
    let scenario = scenario(law, safety, radio).unwrap_or_else(|error| panic!("{error}"));
    let (outcome, rows) = run(&scenario);
    let robots = || rows.iter().flat_map(|(_, robots)| robots);
    let is_fine = |at: &[f64; 3], v: &[f64; 3]| {
        let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        at[..2].iter().all(|x| (low..high).contains(x)) && speed <= FASTEST_MPS * 1.001
    };
    let stays = robots().all(|robot| is_fine(&robot.motion.position_m, &robot.motion.velocity_mps));
    let last = &rows.last().expect("an end").1;
    let (places, velocities): (Vec<_>, Vec<_>) =
        last.iter().map(|robot| (robot.motion.position_m, robot.motion.velocity_mps)).unzip();
    let mut meter = FlockMeter::<3>::new(SPACING_M, 2.0 * SPACING_M, Space::OPEN);
    let clearance = outcome.clearance.expect("bodies have sizes");
    Verdict {
        arrived: outcome.arrived,
        parts: meter.look(&places, &velocities).expect("robots are somewhere").components,
        overlaps: clearance.overlaps,
        deepest_m: -clearance.bodies_m,
        stays,
    }
}

fn complaint(law: &str, (safety, _): Layer, radio: &str, verdict: &Verdict) -> &'static str {
    let hears = radio != "dead";
    let has_goal = goals(law).are_own() || law == "goal_flock";
    let guards = safety != "none";
    // Each expects the others, and hears none.
    if !hears && guards && safety != "push_out" {
        return if verdict.arrived > 0 || verdict.overlaps > 0 { "a robot without a radio moved" } else { "" };
    }
    if !verdict.stays {
        return "a robot left the area or was too fast";
    }
    if has_goal && verdict.arrived < ROBOTS {
        return "not all arrived";
    }
    if law == "lattice" && hears && verdict.parts > 1 {
        return "the flock broke up";
    }
    match radio {
        "perfect" if guards && verdict.overlaps > 0 => "robots overlapped",
        // See docs/limits.md.
        "lossy" if guards && verdict.deepest_m > RADIUS_M / 10.0 => "robots overlapped deeply",
        _ => "",
    }
}

#[test]
fn unsupported_combinations_are_refused_with_a_remedy() {
    let mut refused = 0;
    for &(law, _) in LawSettings::ALL {
        for layer in layers() {
            let answer = scenario(law, layer, "");
            assert_eq!(answer.is_err(), is_refused(law, layer), "{law} behind {layer:?}");
            refused += usize::from(answer.is_err_and(|error| error.to_string().contains("plane.push_out.model")));
        }
    }
    assert_eq!(refused, 1);
}

#[test]
fn every_law_works_with_every_safety_layer_and_radio() {
    let mut all = Vec::new();
    for &(law, _) in LawSettings::ALL {
        for safety in layers().into_iter().filter(|&layer| !is_refused(law, layer)) {
            all.extend(RADIOS.map(|radio| (law, safety, radio)));
        }
    }
    let complaints: Vec<String> = all
        .par_iter()
        .filter_map(|&(law, safety, (radio, fields))| {
            let verdict = verdict(law, safety, fields);
            let complaint = complaint(law, safety, radio, &verdict);
            let (layer, model) = (safety.0, safety.1.name());
            let pair = format!("{} behind {layer} ({model}), {radio} radio", law);
            (!complaint.is_empty()).then(|| format!("{pair}: {complaint}: {verdict:?}"))
        })
        .collect();
    assert!(complaints.is_empty(), "{} of {}:\n{}", complaints.len(), all.len(), complaints.join("\n"));
}
