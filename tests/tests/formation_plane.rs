//! Formations in the plane: distances of robots from their places, and travel times. The law was
//! tuned on [`TUNED`] only. Run with `-- --nocapture` to print the results.

use staya_controller::grid::UNIT;
use staya_sim::engine::Outcome;
use staya_sim::metrics::{PlaceError, free_formation_s};
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{run, scenario};
use std::path::Path;

/// Each line replaces lines of `companions/formation.toml` with the same start, or is inserted.
type Changes<'a> = &'a [(&'a str, &'a str)];

/// Name, scene, and bounds: error after 10 s, metres, and travel time relative to free motion.
type Scene<'a> = (&'a str, Changes<'a>, f64, f64);

const TUNED: Scene<'_> = ("six rovers", &[], 1.0, 1.2);

const SMALL: Changes<'_> = &[
    ("cell_m =", "cell_m = 0.5"),
    ("radius_m =", "radius_m = 0.15"),
    ("max_speed_mps =", "max_speed_mps = 0.5"),
    ("max_acceleration_mps2 =", ""),
    ("horizon_s =", "horizon_s = 2"),
    ("margin_m =", "margin_m = 0.004"),
];
const FAST: Changes<'_> =
    &[("radius_m =", "radius_m = 0.5"), ("max_speed_mps =", "max_speed_mps = 5"), ("max_acceleration_mps2 =", "")];

const SCENES: &[Scene<'_>] = &[
    ("three rows of three", &[("rows =", "rows = 3")], 1.0, 1.2),
    ("a column of six", &[("rows =", "rows = 1"), ("columns =", "columns = 6")], 1.0, 1.2),
    (
        "two rows of ten",
        &[
            ("columns =", "columns = 10"),
            ("uniform =", "uniform = { width = 100, height = 80, classes = 1 }"),
            ("start =", "start = [30, 20]"),
        ],
        1.0,
        1.2,
    ),
    (
        "3 m apart",
        &[
            ("cell_m =", "cell_m = 1"),
            ("uniform =", "uniform = { width = 140, height = 140, classes = 1 }"),
            ("spacing =", "spacing = [-3, -3]"),
            ("goal =", "goal = [120, 120]"),
        ],
        1.0,
        1.6,
    ),
    ("20 m apart", &[("spacing =", "spacing = [-5, -5]")], 1.0, 1.2),
    ("small and slow", SMALL, 0.1, 1.2),
    ("fast, without inertia", FAST, 1.0, 1.2),
    ("without inertia", &[("max_acceleration_mps2 =", "")], 1.0, 1.2),
    (
        "sluggish",
        &[("max_acceleration_mps2 =", "max_acceleration_mps2 = 0.5"), ("horizon_s =", "horizon_s = 8")],
        1.0,
        1.2,
    ),
    (
        "with a lag of 0.8 s",
        &[("max_acceleration_mps2 =", "max_acceleration_mps2 = 1\nlag_s = 0.8"), ("horizon_s =", "horizon_s = 5.6")],
        1.0,
        1.2,
    ),
    ("no delay", &[("delay_ms =", "delay_ms = 0")], 1.0, 1.2),
    ("300 ms of delay", &[("delay_ms =", "delay_ms = 300")], 1.0, 1.2),
    ("30 % lost", &[("delay_ms =", "delay_ms = 100\nloss = 0.3")], 1.0, 1.2),
    ("60 % lost", &[("delay_ms =", "delay_ms = 100\nloss = 0.6")], 1.0, 1.3),
    ("to the west-south-west", &[("start =", "start = [60, 60]"), ("goal =", "goal = [20, 30]")], 1.0, 1.2),
    ("to the north", &[("goal =", "goal = [20, 70]")], 1.0, 1.2),
];

fn scene(name: &str, changes: Changes<'_>, seed: u64) -> Scenario {
    let path = staya_tests::root().join("companions/formation.toml");
    let mut text = std::fs::read_to_string(path).expect("the scenario");
    for (start, line) in changes {
        assert!(text.lines().any(|old| old.starts_with(start)), "no line begins with {start}");
        text = text.lines().map(|old| if old.starts_with(start) { *line } else { old }.to_owned() + "\n").collect();
    }
    let overrides = Overrides { seed: Some(seed), ticks: None };
    let parsed = Scenario::parse(&text, Path::new("formation.toml"), &overrides);
    parsed.unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Outcome, error, and travel time relative to free motion.
fn travel(scenario: &Scenario) -> (Outcome, PlaceError, f64) {
    let (outcome, _) = run(scenario);
    let error = outcome.place_error.expect("longer than it takes to form");
    let last = outcome.arrival_times.iter().map(|at| at.unwrap_or(u64::MAX)).max().expect("robots");
    let ratio = last as f64 / f64::from(UNIT) * scenario.tick_s() / free_formation_s(scenario).expect("a formation");
    (outcome, error, ratio)
}

fn keeps_to(&(name, changes, most_m, most_times): &Scene<'_>) {
    for seed in 1..=2 {
        let scenario = scene(name, changes, seed);
        let (outcome, error, ratio) = travel(&scenario);
        let PlaceError { mean_m, worst_m, .. } = error;
        println!("{name}, seed {seed}: at most {worst_m:.2} m, mean {mean_m:.3} m, {ratio:.3} times");
        assert_eq!((outcome.arrived, outcome.collisions), (scenario.robots.len(), 0), "{name}");
        assert!(worst_m <= most_m && ratio <= most_times, "{name}: {error:?}, {ratio}");
    }
}

#[test]
fn six_rovers_stay_within_a_metre_and_take_at_most_a_fifth_longer() {
    keeps_to(&TUNED);
}

#[test]
fn other_formations_keep_their_bounds() {
    SCENES.iter().for_each(keeps_to);
}

#[test]
fn robots_that_start_elsewhere_form_on_the_way() {
    let line = "starts = [[20, 20], [23, 20], [25, 20], [28, 20], [30, 20], [33, 20]]";
    for (goal, most_times) in [("goal = [60, 60]", 1.2), ("goal = [70, 20]", 1.2), ("goal = [20, 60]", 1.5)] {
        let scenario = scene(goal, &[("start =", line), ("goal =", goal)], 1);
        let mut error_m = Vec::new();
        let outcome = staya_sim::engine::simulate(&scenario, |moment, rows| {
            let worst = rows.map(|row| f64::from(row.formation_error_cells) * 4.0).fold(0.0, f64::max);
            error_m.push((moment.row.time_s, worst));
            std::ops::ControlFlow::Continue(())
        })
        .expect("sound");
        let (_, _, ratio) = travel(&scenario);
        let formed_s = error_m.iter().rev().find(|(_, error_m)| *error_m > 1.0).map_or(0.0, |(at_s, _)| *at_s);
        println!("in a line, {goal}: within 1 m from {formed_s:.1} s on, {ratio:.3} times");
        assert_eq!((outcome.arrived, outcome.collisions), (6, 0));
        // Robot 6 starts 66 m from its place.
        assert!(formed_s < 1.5 * 66.0 / 2.0 && ratio <= most_times, "{goal}: {formed_s} s, {ratio}");
    }
}

#[test]
fn on_rough_terrain_the_mean_error_is_bounded() {
    let six = scenario("six-discs", None);
    let obstacles = scene("obstacles", &[("uniform =", "natural = { width = 80, height = 80, obstacles = 40 }")], 1);
    for (name, scenario, most_m) in [("six-discs", six, 0.2), ("among 40 obstacles", obstacles, 0.2)] {
        let (outcome, PlaceError { mean_m, worst_m, .. }, ratio) = travel(&scenario);
        println!("{name}: at most {worst_m:.2} m, mean {mean_m:.3} m, {ratio:.2} times of straight on easy land");
        assert_eq!((outcome.arrived, outcome.collisions), (6, 0), "{name}");
        assert!(mean_m <= most_m, "{name}: {mean_m} m");
    }
}

#[test]
fn no_robot_waits_for_ever() {
    for robot in 1..=6 {
        let fault = format!("margin_m = 0.5\n[[fault]]\nrobot = {robot}\nat_s = 30\ndown_s = 900");
        let scenario = scene("a dead member", &[("margin_m =", &fault)], 1);
        let (outcome, _) = run(&scenario);
        println!("robot {robot} dies: {} arrive in {:.1} s", outcome.arrived, outcome.seconds);
        let late: Vec<_> =
            (0..6).filter(|&other| other + 1 != robot && outcome.arrival_times[other].is_none()).collect();
        assert_eq!(late, [0_usize; 0], "without {robot}");
    }
    let scenario = scene("silence", &[("delay_ms =", "delay_ms = 100\nblackout_s = [[40, 50]]")], 1);
    let (outcome, error, ratio) = travel(&scenario);
    println!("10 s of silence: at most {:.2} m, {ratio:.3} times", error.worst_m);
    assert!((outcome.arrived, outcome.collisions) == (6, 0) && ratio < 1.3, "{ratio}");
}
