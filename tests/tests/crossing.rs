//! Golden tables of swaps, doorways and other crossings: the figures of `papers/orca`.

use staya_lab::figure;
use staya_lab::sweep::plan::Changes;
use staya_lab::sweep::run::perform;
use staya_lab::sweep::{Figure, Plan};
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{golden, root, run};
use std::fs;

/// Makes all runs of a figure (`PAPER/FIGURE`) with these changes. Returns the plan, a table of the
/// runs, and their figures.
pub fn table(figure: &str, changes: &[&str], seeds: u32) -> (Plan, String, Vec<Vec<Figure>>) {
    let fields = changes.iter().map(|change| change.parse().expect("a change")).collect();
    let changes = Changes { fields, seeds: Some(seeds), ..Changes::default() };
    let path = root().join("papers").join(figure).join("figure.toml");
    let plan = Plan::load(&path, &changes).expect("a sound plan");
    let mut text =
        format!("{}, seed, {}, trace\n", plan.axes().collect::<Vec<_>>().join(", "), plan.measures().join(", "));
    let mut all = Vec::new();
    for number in 0..plan.runs() {
        let row = perform(&plan, number, || true).expect("a run that is not stopped").row;
        let figures: Vec<_> = row.figures.iter().map(ToString::to_string).collect();
        let (values, seed) = (plan.values_of(number).join(", "), plan.run(number).seed);
        text += &format!("{values}, {seed}, {}, {}\n", figures.join(", "), row.trace_hash);
        all.push(row.figures);
    }
    (plan, text, all)
}

/// Compares a table of a figure. A run lacks its story if not all robots arrive or robots overlap.
fn golden_figure(name: &str, figure: &str, changes: &[&str], seeds: u32) {
    let (plan, text, all) = table(&format!("orca/{figure}"), changes, seeds);
    let column = |measure: &str| plan.measures().iter().position(|name| name == measure);
    let times = column("free.worst_ratio").expect("a measure");
    let overlaps = ["collisions", "intruder_overlaps"].map(column);
    let mut gaps = Vec::new();
    for (number, figures) in (0..).zip(&all) {
        let seed = plan.run(number).seed;
        if figures[times].0.is_none() && name != "crossing-flock" {
            gaps.push(format!("seed {seed}: not all robots arrive"));
        }
        if overlaps.into_iter().flatten().any(|column| figures[column].0 != Some(0.0)) {
            gaps.push(format!("seed {seed}: robots overlap"));
        }
    }
    golden(name, &text, &gaps);
}

#[test]
fn golden_swap() {
    let [count, radius] = ["count=2,3,4,8,12,16,24,32", "radius_m=2,2,2,2,2,2,2.4,3.2"];
    golden_figure("swap", "swap", &[count, radius], 1);
}

#[test]
fn golden_swap_by_template_with_noise_and_losses() {
    let changes = [
        "count=6,12",
        "radius_m=2,2",
        "plane.robots.circle.noise_m=0.05",
        "plane.safety=template_2k",
        "radio.loss=0.1",
    ];
    golden_figure("swap-template", "swap", &changes, 3);
}

#[test]
fn golden_doorway() {
    golden_figure("doorway-experiment", "doorway", &["door_m=0.8,1.3"], 1);
}

#[test]
fn golden_crossing_of_each_kind() {
    let cases = ["blocks", "four_ways", "tee", "door", "doors", "parked_door", "corridor", "parked", "mixed"];
    for case in cases.into_iter().chain(["intruder", "dead_end", "sphere", "blackout", "flock"]) {
        golden_figure(&format!("crossing-{case}"), "crossing", &[&format!("scenario={case}")], 1);
    }
}

#[test]
fn each_figure_is_found_by_name_and_by_place() {
    let figures = figure::all().expect("the figures of the checkout");
    assert!(figures.len() >= 3);
    for known in figures {
        for name in [&known.name, &known.place] {
            assert_eq!(figure::find(name).expect("a figure").path, known.path);
        }
    }
    let error = figure::find("doorwya").expect_err("no such figure").to_string();
    assert_eq!(error, "doorwya: there is no such experiment; did you mean doorway?");
}

/// Seeds in which robots once met in a narrow corridor, or met one that had arrived there. The
/// last of the crowd passes those that have arrived.
#[test]
fn discs_that_route_among_walls_all_arrive() {
    let path = root().join("scenarios/twenty-discs.toml");
    let text = fs::read_to_string(&path).unwrap();
    let crowd = text.replace("count = 20", "count = 40");
    for (text, seed, robots) in [(&text, 2, 20), (&text, 9, 20), (&crowd, 5, 40)] {
        let overrides = Overrides { seed: Some(seed), ticks: Some(3000) };
        let scenario = Scenario::parse(text, &path, &overrides).unwrap();
        let outcome = run(&scenario).0;
        assert_eq!((outcome.arrived, outcome.collisions), (robots, 0), "seed {seed}");
    }
}
