//! `staya experiment` with figures that are data, at the command line.

use serde_json::Value;
use staya_sim::scenario::{Overrides, Scenario};
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn staya(arguments: &[&str]) -> Output {
    let mut command = Command::new(staya_tests::program());
    let ended = command.arg("experiment").args(arguments).current_dir(staya_tests::root()).stdin(Stdio::null());
    ended.output().expect("staya starts")
}

fn json(arguments: &[&str]) -> Value {
    let ended = staya(&[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success(), "{error}");
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

#[test]
fn a_swap_is_run_drawn_and_printed() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let out = dir.path().join("out");
    let folder = out.to_str().expect("UTF-8");
    let told = json(&["swap", "--axis", "count=2..3,6", "--axis", "radius_m=2,2,2", "--out", folder]);
    let points = told["points"].as_array().expect("points");
    assert_eq!(points.len(), 3);
    for point in points {
        assert_eq!(point["figures"]["collisions"]["max"], 0.0);
        assert!(point["figures"]["free.worst_ratio"]["max"].as_f64().expect("all arrive") < 1.5);
    }
    for file in told["files"].as_array().expect("names") {
        assert!(Path::new(file.as_str().expect("a name")).exists());
    }
    // Complete rows are replaced.
    let table = staya(&["swap", "--set", "count=2", "--set", "radius_m=3", "--out", folder]);
    let table = String::from_utf8(table.stdout).expect("UTF-8");
    assert!(table.contains("Robots on a circle change places") && table.contains("free.worst_ratio"), "{table}");
}

#[test]
fn a_doorway_is_run_drawn_and_judged() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let folder = dir.path().to_str().expect("UTF-8");
    let told = json(&["orca/doorway", "--quick", "--out", folder]);
    let points = told["points"].as_array().expect("points");
    assert_eq!(points.len(), 5);
    for point in points {
        assert_eq!(point["figures"]["flow.from_west"]["mean"], 20.0);
    }
    let verdicts = told["verdicts"].as_array().expect("verdicts");
    assert!(!verdicts.is_empty() && verdicts.iter().all(|verdict| verdict["judgement"] == "holds"), "{verdicts:?}");
    for width in ["0.8", "2"] {
        assert!(dir.path().join(format!("pictures/doorway-{width}.png")).exists(), "a picture of each width");
    }
    assert!(std::fs::read_to_string(dir.path().join("verdict.txt")).expect("a verdict").starts_with("holds\n"));
}

#[test]
fn a_condition_that_does_not_hold_fails_the_command() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let path = |name: &str| dir.path().join(name).to_str().expect("UTF-8").to_owned();
    let scenario = staya_tests::root().join("papers/orca/swap/scenario.toml");
    let plan = |more: &str| {
        format!(
            "name = 'late'\nscenario = {scenario:?}\nmeasures = ['free.worst_ratio']\nreference = 'paper.csv'\n\
             seeds = {{ from = 1, count = 6, quick = 2 }}\n[axes]\nplane.robots.circle.count = [2, 3]\n\
             [[accept]]\nmeasure = 'free.worst_ratio'\nat_most = 1.05\n{more}\n\
             [[accept]]\nmeasure = 'free.worst_ratio'\nwhere = {{ count = 2 }}\nwithin = 0.2\n"
        )
    };
    std::fs::write(path("plan.toml"), plan("")).expect("write");
    std::fs::write(path("paper.csv"), "# by hand\ncount,free.worst_ratio\n2,1\n3,1\n").expect("write");
    let run = |more: &[&str]| {
        let ended = staya(&[&[&path("plan.toml"), "--out", &path("out"), "--restart"], more].concat());
        let [out, error] = [&ended.stdout, &ended.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        (ended.status.code(), out, error)
    };
    let (code, out, error) = run(&[]);
    assert_eq!(code, Some(1), "{out}{error}");
    assert!(error.contains("late: 1 of 2 conditions are not as expected"), "{error}");
    assert!(out.contains("at most 1.05: DOES NOT HOLD, 1.0563 at 2"), "{out}");
    assert!(out.contains("within 20 % of the reference: holds"), "{out}");
    // Two runs do not decide about a mean, and do not fail the command for that.
    let (code, out, error) = run(&["--quick"]);
    assert_eq!(code, Some(1), "{out}{error}");
    assert!(out.contains("within 20 % of the reference: TOO FEW RUNS"), "{out}");
    // A known failure is expected until it holds.
    std::fs::write(path("plan.toml"), plan("claim = 'No robot waits'\nfails = 'both turn'")).expect("write");
    let (code, out, error) = run(&[]);
    assert_eq!(code, Some(0), "{out}{error}");
    assert!(
        out.contains("No robot waits: free.worst_ratio at most 1.05: does not hold, 1.0563 at 2 (known: both turn)"),
        "{out}"
    );
    let (code, out, error) = run(&["--quick"]);
    assert_eq!(code, Some(0), "{out}{error}");
    assert!(out.contains("1 of 2 conditions need more runs"), "{out}");
    // Other values are another study, which nothing is said about.
    let ended = staya(&[&path("plan.toml"), "--out", &path("other"), "--set", "radio.loss=0.1"]);
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}

#[test]
fn all_experiments_are_listed() {
    let told = json(&[]);
    let all = told["experiments"].as_array().expect("a list");
    let has = |name: &str| all.iter().any(|known| known["name"] == name);
    assert!(["swap", "doorway", "crossing", "route", "boids"].into_iter().all(has), "{told}");
}

#[test]
fn wrong_changes_are_refused_in_one_line() {
    for (arguments, remedy) in [
        (&["swap", "--set", "count=0", "--set", "radius_m=2"][..], "plane.robots.circle.count: 0 is out of range"),
        (&["swap", "--axis", "count=4,8"], "give as many values of each of them"),
        (&["swap", "--set", "tick_s=0"], "swap/scenario.toml:6:10: tick_s: 0 is out of range"),
        (&["swap", "--set", "radio.loss=1.5"], "radio.loss: 1.5 is not a probability"),
        (&["swap", "--set", "radio.los=1"], "unknown field `los`"),
        (&["swap", "--axis", "radio.loss"], "give FIELD=VALUE"),
        (&["doorway", "--set", "door_m=-1"], "door_m: -1 is out of range"),
        (&["doorway", "--axis", "door_m=1,1"], "1 is listed twice"),
        (&["crossing", "--axis", "scenario=tea"], "give some of blocks"),
        (&["doorway", "--seeds", "0"], "0 is not in 1..=1000000"),
        (&["doorwya"], "did you mean doorway?"),
        (&["doorway", "--out", "/dev/null/x"], "results have no place"),
    ] {
        let ended = staya(arguments);
        let error = String::from_utf8_lossy(&ended.stderr);
        assert!(!ended.status.success(), "{arguments:?}");
        assert!(error.contains(remedy), "{arguments:?}: {error}");
    }
}

#[test]
fn every_scenario_of_a_figure_is_a_scenario_of_its_own() {
    let mut folders = vec![staya_tests::root().join("papers")];
    let (mut read, mut studies) = (0, 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let is_scenario = path.extension().is_some_and(|end| end == "toml")
                && !path.ends_with("figure.toml")
                && !path.ends_with("Cargo.toml");
            if path.is_dir() {
                folders.push(path);
            } else if is_scenario {
                let scenario = Scenario::load(&path, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
                let is_said = scenario.remarks().iter().any(|remark| remark.contains("[study]"));
                assert_eq!(is_said, scenario.origin.has_study, "{}", path.display());
                (read, studies) = (read + 1, studies + u32::from(is_said));
            }
        }
    }
    assert!(read > 40 && studies > 5, "{read} files, {studies} with a study");
}
