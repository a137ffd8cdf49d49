//! `staya orca` at the command line.

use serde_json::Value;
use std::fs;
use std::process::{Command, Output, Stdio};

fn staya(arguments: &[&str]) -> Output {
    let mut command = Command::new(staya_tests::program());
    let ended = command.args(arguments).stdin(Stdio::null()).output();
    ended.expect("staya starts")
}

fn json(arguments: &[&str]) -> Value {
    let ended = staya(&[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success(), "{error}");
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

#[test]
fn draw_writes_four_pictures_of_the_papers_example() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let out = dir.path().join("a/b");
    let folder = out.to_str().expect("UTF-8");
    let drawn = json(&["orca", "draw", "--out", folder]);
    let near = |value: &Value, wanted: f64| (value.as_f64().expect("a number") - wanted).abs() < 1e-6;
    assert!(near(&drawn["change_mps"], 0.292893));
    assert!(near(&drawn["point_mps"][0], 1.707107) && near(&drawn["point_mps"][1], 0.792893));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!(near(&drawn["normal"][0], half) && near(&drawn["normal"][1], -half));
    assert_eq!(drawn["pictures"].as_array().expect("names").len(), 8);
    for name in ["velocity-obstacle", "r-function", "m-images", "template"] {
        let png = fs::read(out.join(format!("{name}.png"))).expect("a picture");
        assert!(png.starts_with(b"\x89PNG"), "{name}");
        let svg = fs::read_to_string(out.join(format!("{name}.svg"))).expect("a picture");
        assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{name}");
    }
    let free = json(&["orca", "draw", "--velocity-a", "-3,-3", "--share", "0.5", "--out", folder]);
    assert!(free["change_mps"].as_f64().expect("a number") < 0.0);
}

#[test]
fn invalid_scenes_and_unwritable_folders_are_refused_in_one_line() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let file = dir.path().join("file");
    fs::write(&file, "mine").expect("write");
    let way = file.to_str().expect("UTF-8");
    for (arguments, remedy) in [
        (vec!["--place-b", "2,-2"], "more than 2 m apart"),
        (vec!["--horizon", "0"], "above 0"),
        (vec!["--velocity-a", "inf,0"], "finite"),
        (vec!["--out", way], "choose another output directory"),
    ] {
        let ended = staya(&[&["orca", "draw"], &arguments[..]].concat());
        let error = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(1), "{error}");
        assert!(ended.stdout.is_empty() && error.lines().count() == 1, "{error}");
        assert!(error.contains(remedy), "{error}");
    }
}

#[test]
fn the_table_is_reproducible_and_readable() {
    let arguments = ["orca", "table", "--pairs", "500", "--seed", "7"];
    let table = json(&arguments);
    assert_eq!(table, json(&arguments));
    assert!(table["bytes"].as_u64().is_some_and(|bytes| bytes <= 2048), "{table}");
    assert!(table["distance"]["max"].as_f64().is_some_and(|error| (1e-6..0.1).contains(&error)), "{table}");
    let shown = String::from_utf8(staya(&arguments).stdout).expect("UTF-8");
    assert!(shown.contains("500 pairs, seed 7") && shown.lines().count() == 4, "{shown}");
}
