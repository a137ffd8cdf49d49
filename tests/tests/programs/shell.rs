//! `--set`, `staya completions`, `staya man`: what a shell meets.

use std::path::Path;
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
fn a_field_that_is_set_is_as_if_the_file_said_it() {
    let plain = hash(&["--ticks", "40", "--seed", "9"]);
    assert_eq!(hash(&["--set", "ticks=40", "--set", "seed=9"]), plain);
    assert_ne!(hash(&["--set", "ticks=40", "--set", "seed=9", "--set", "radio.loss=0.9"]), plain);
}

#[test]
fn a_wrong_setting_names_field_and_remedy() {
    let six = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/six-robots.toml");
    let Output { status, stdout, stderr } = staya(&["run", six, "--set", "radio.loss=7"]);
    let said = text(&stderr);
    assert!(status.code() == Some(1) && stdout.is_empty(), "{said}");
    assert!(said.contains("radio.loss: 7 is no probability (by --set)"), "{said}");
    let Output { status, stderr, .. } = staya(&["run", six, "--set", "loss"]);
    assert!(status.code() == Some(2) && text(&stderr).contains("FIELD=VALUE"), "{}", text(&stderr));
}

#[test]
fn shells_and_man_know_every_command() {
    let help = text(&staya(&["--help"]).stdout);
    let commands = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let commands = commands.take_while(|line| !line.is_empty()).filter_map(|line| line.split_whitespace().next());
    let commands: Vec<_> = commands.filter(|name| *name != "help").collect();
    assert!(commands.contains(&"run") && commands.len() > 10, "{help}");
    for shell in ["bash", "zsh", "fish"] {
        let script = text(&staya(&["completions", shell]).stdout);
        for name in &commands {
            assert!(script.contains(name), "{shell} does not know {name}");
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("man1");
    assert!(staya(&["man", &pages.display().to_string()]).status.success());
    for name in &commands {
        let page = std::fs::read_to_string(pages.join(format!("staya-{name}.1"))).unwrap_or_default();
        assert!(page.contains(".SH SYNOPSIS"), "{name}");
    }
    let Output { status, stderr, .. } = staya(&["man", "/proc/none"]);
    let said = text(&stderr);
    assert!(!Path::new("/proc/none").exists() && status.code() == Some(1) && said.contains("can be made"), "{said}");
}
