//! `staya experiment swap` and `doorway` at the command line.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn staya(arguments: &[&str]) -> Output {
    let mut command = Command::new(staya_tests::program());
    let ended = command.args(arguments).stdin(Stdio::null()).output();
    ended.expect("staya starts")
}

fn json(arguments: &[&str]) -> Value {
    let ended = staya(&[&["experiment"], arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success(), "{error}");
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

#[test]
fn a_swap_is_run_drawn_and_printed() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let out = dir.path().join("out");
    let folder = out.to_str().expect("UTF-8");
    let told = json(&["swap", "--robots", "2..3,6", "--out", folder]);
    let rows = told["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 3);
    for row in rows {
        assert_eq!((&row["clean"], &row["overlaps"]), (&1.into(), &0.into()));
        assert!(row["worst_time_ratio"].as_f64().expect("all arrive") < 1.5);
    }
    assert_eq!(told["conditions"]["step_s"], 0.05);
    for picture in told["pictures"].as_array().expect("names") {
        assert!(Path::new(picture.as_str().expect("a name")).exists());
    }
    let table = staya(&["experiment", "swap", "--robots", "2", "--out", folder]);
    let table = String::from_utf8(table.stdout).expect("UTF-8");
    assert!(table.contains("dt 0.05 s") && table.contains("2/2"), "{table}");
}

#[test]
fn a_doorway_is_run_drawn_and_printed() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let folder = dir.path().to_str().expect("UTF-8");
    let told = json(&["doorway", "--widths", "0.8,2", "--robots", "1", "--out", folder]);
    for run in told["runs"].as_array().expect("runs") {
        assert_eq!((&run["arrived"], &run["overlaps"]), (&2.into(), &0.into()));
        assert_eq!(run["through"], serde_json::json!([1, 1]));
    }
    for width in ["0.8", "2"] {
        assert!(dir.path().join(format!("doorway-{width}m.png")).exists(), "a picture of each width");
    }
}

#[test]
fn parameters_out_of_range_are_refused_in_one_line() {
    for (arguments, remedy) in [
        (&["swap", "--robots", "0"][..], "2..64"),
        (&["swap", "--step", "0"], "--step 0 is out of range: give 0.001 to 10"),
        (&["swap", "--loss", "1.5"], "--loss 1.5 is out of range"),
        (&["swap", "--speed", "nan"], "--speed NaN is out of range"),
        (&["swap", "--circle", "-1"], "--circle is out of range"),
        (&["doorway", "--widths", "-1"], "--widths -1 is out of range"),
        (&["doorway", "--robots", "0"], "1..=1000"),
        (&["doorway", "--out", "/dev/null/x"], "results have no place"),
    ] {
        let ended = staya(&[&["experiment"], arguments].concat());
        let error = String::from_utf8_lossy(&ended.stderr);
        assert!(!ended.status.success(), "{arguments:?}");
        assert!(error.contains(remedy), "{arguments:?}: {error}");
    }
}
