//! Golden tables of swaps, doorways and other crossings, as printed by the commands.

use staya_controller::agent::SafetyKind;
use staya_lab::crossing::cases::{self, Case};
use staya_lab::crossing::{Conditions, doorway, swap};
use staya_lab::experiment::Experiment as _;
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{golden, root, run};
use std::fs;

/// Gaps in the story of one run, from its seed, arrived robots, all robots, and overlaps.
fn lacks(seed: u64, arrived: usize, robots: usize, overlaps: u64) -> impl Iterator<Item = String> {
    let late = (arrived < robots).then(|| format!("seed {seed}: not all robots arrive"));
    late.into_iter().chain((overlaps > 0).then(|| format!("seed {seed}: robots overlap")))
}

fn golden_swaps(name: &str, plan: &swap::Plan) {
    let report = plan.measure().expect("a sound plan");
    let gaps = report.runs.iter().flat_map(|run| lacks(run.seed, run.arrived, run.robots as usize, run.overlaps));
    golden(name, &report.to_string(), &gaps.collect::<Vec<_>>());
}

#[test]
fn golden_swap() {
    let plan = swap::Plan { robots: vec![2, 3, 4, 8, 12, 16, 24, 32], ..swap::Plan::default() };
    golden_swaps("swap", &plan);
}

#[test]
fn golden_swap_by_template_with_noise_and_losses() {
    let plan = swap::Plan {
        robots: vec![6, 12],
        noise_m: 0.05,
        seeds: 3,
        conditions: Conditions { safety: SafetyKind::Template2k, loss: 0.1, ..Conditions::default() },
        ..swap::Plan::default()
    };
    golden_swaps("swap-template", &plan);
}

#[test]
fn golden_doorway() {
    let plan = doorway::Plan { widths_m: vec![0.8, 1.3], robots: 6, ..doorway::Plan::default() };
    let report = plan.measure().expect("a sound plan");
    let gaps = report.runs.iter().flat_map(|run| lacks(run.seed, run.arrived, run.robots, run.overlaps));
    golden("doorway-experiment", &report.to_string(), &gaps.collect::<Vec<_>>());
}

/// Small enough for a debug build.
const fn few(case: Case) -> u32 {
    match case {
        Case::DeadEnd => 2,
        Case::FourWays | Case::Tee | Case::Corridor => 3,
        Case::Blocks => 4,
        Case::Door | Case::Doors | Case::ParkedDoor | Case::Parked => 6,
        Case::Mixed | Case::Intruder | Case::Blackout => 8,
        Case::Flock => 9,
        Case::Sphere => 12,
    }
}

#[test]
fn golden_crossing_of_each_kind() {
    for case in Case::ALL {
        let plan = cases::Plan { cases: vec![case], robots: Some(few(case)), seeds: 2, ..cases::Plan::default() };
        let report = plan.measure().expect("a sound plan");
        let gaps = report.runs.iter().flat_map(|run| {
            let parts = run.parts.filter(|parts| *parts > 1).map(|_| format!("seed {}: more than one flock", run.seed));
            lacks(run.seed, run.arrived, run.robots, run.overlaps + run.intruder_overlaps).chain(parts)
        });
        golden(&format!("crossing-{}", case.name()), &report.to_string(), &gaps.collect::<Vec<_>>());
    }
}

/// Seeds in which robots once met in a narrow corridor, or met one that had arrived there. Of the
/// crowd one robot does not get past those that have arrived (docs/limits.md).
#[test]
fn discs_that_route_among_walls_all_arrive() {
    let path = root().join("scenarios/twenty-discs.toml");
    let text = fs::read_to_string(&path).unwrap();
    let crowd = text.replace("count = 20", "count = 40");
    for (text, seed, robots) in [(&text, 2, 20), (&text, 9, 20), (&crowd, 5, 39)] {
        let overrides = Overrides { seed: Some(seed), ticks: Some(2000) };
        let scenario = Scenario::parse(text, &path, &overrides).unwrap();
        let outcome = run(&scenario).0;
        assert_eq!((outcome.arrived, outcome.collisions), (robots, 0), "seed {seed}");
    }
}
