//! `--set`, help, and commands of other programs.

use std::process::{Command, Output, Stdio};

fn staya(arguments: &[&str]) -> Output {
    let mut command = Command::new(staya_tests::program());
    command.args(arguments).stdin(Stdio::null()).output().expect("staya starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn hash(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out").display().to_string();
    let six = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/six-robots.toml");
    let all = [&["run", six, "--quiet", "--json", "--no-trace", "--out", &out], arguments].concat();
    let Output { status, stdout, stderr } = staya(&all);
    assert!(status.success(), "{}", text(&stderr));
    let json: serde_json::Value = serde_json::from_slice(&stdout).expect("one JSON object");
    json["trace_hash"].as_str().expect("a hash").to_owned()
}

#[test]
fn an_overridden_field_equals_one_in_the_file() {
    let plain = hash(&["--ticks", "40", "--seed", "9"]);
    assert_eq!(hash(&["--set", "ticks=40", "--set", "seed=9"]), plain);
    assert_ne!(hash(&["--set", "ticks=40", "--set", "seed=9", "--set", "radio.loss=0.9"]), plain);
}

#[test]
fn an_invalid_override_names_field_and_remedy() {
    let six = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/six-robots.toml");
    let Output { status, stdout, stderr } = staya(&["run", six, "--set", "radio.loss=7"]);
    let said = text(&stderr);
    assert!(status.code() == Some(1) && stdout.is_empty(), "{said}");
    assert!(said.contains("radio.loss: 7 is not a probability (by --set)"), "{said}");
    let Output { status, stderr, .. } = staya(&["run", six, "--set", "loss"]);
    assert!(status.code() == Some(2) && text(&stderr).contains("FIELD=VALUE"), "{}", text(&stderr));
}

#[test]
fn commands_of_other_programs_are_found_with_their_own_help() {
    for arguments in [&["sweep", "--help"][..], &["help", "sweep"]] {
        let Output { status, stdout, stderr } = staya(arguments);
        assert!(status.success(), "{}", text(&stderr));
        assert!(text(&stdout).contains("Usage: staya sweep"), "{}", text(&stdout));
    }
    let Output { status, stdout, .. } = staya(&["help"]);
    let help = text(&stdout);
    assert!(status.success() && ["run", "sweep", "bridge", "voxel"].iter().all(|name| help.contains(name)), "{help}");
    let Output { status, stderr, .. } = staya(&["sweep", "no-such-plan.toml"]);
    assert!(status.code() == Some(1) && text(&stderr).starts_with("staya: "), "{}", text(&stderr));
}
