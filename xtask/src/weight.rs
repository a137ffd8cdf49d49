//! `cargo xtask weight`: what the README's first command costs, beside the last record, and no library compiled twice.

use crate::repo::{Repo, output_of, run};
use crate::report::{Report, processor_time};
use crate::source::{members, modules};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The program of the README's first command.
const MAIN: &str = "staya";
/// Programs that it hands over to; those that the workspace does not have are left out.
const OTHERS: [&str; 5] = ["staya-lab", "staya-view", "staya-mav", "staya-hil", "staya-voxel"];
/// The records, one line each.
const RECORDS: &str = "xtask/weight.csv";
const HEADER: &str = "date,commit,units,processor_s,peer_s,program_bytes,code_lines";
const PEER: [&str; 4] = ["install", "ripgrep", "--locked", "--root"];

/// Measures, prints each figure beside the last record, and adds a record if `is_recorded`. With `has_peer` the time of the same
/// processors for another program stands beside it.
pub fn run_command(repo: &Repo, report: &mut Report, is_recorded: bool, has_peer: bool) {
    report.step(SHARED, || check_shared(repo));
    report.step("weight", || {
        let folder = repo.target.join("weight");
        let _ = fs::remove_dir_all(&folder);
        run(&mut repo.cargo(&["fetch", "--locked"]))?;
        let units = graph(repo, MAIN, MAIN)?.units;
        let units = units.iter().filter(|unit| unit.mode == "build").count();
        let mut build = repo.cargo(&["build", "--release", "--locked", "--package", MAIN]);
        let processor_s = seconds(build.env("CARGO_TARGET_DIR", &folder))?;
        let program = folder.join("release").join(format!("{MAIN}{}", std::env::consts::EXE_SUFFIX));
        let program_bytes = fs::metadata(&program).map_err(|error| format!("{}: {error}", program.display()))?.len();
        let mut peer = repo.cargo(&PEER);
        peer.arg(folder.join("ripgrep")).env("CARGO_TARGET_DIR", folder.join("peer"));
        let peer_s = if has_peer { Some(seconds(&mut peer)?) } else { None };
        let lines = code_lines(&repo.root)?;
        lines.iter().for_each(|(member, lines)| println!("{lines:>7}  {member}"));
        let code_lines: usize = lines.iter().map(|(_, lines)| lines).sum();
        let figures =
            [Some(units as f64), Some(processor_s), peer_s, Some(program_bytes as f64), Some(code_lines as f64)];
        let file = repo.root.join(RECORDS);
        let records = fs::read_to_string(&file).unwrap_or_else(|_| format!("{HEADER}\n"));
        print!("{}", table(&records, &figures));
        if is_recorded {
            let date = output_of(repo.command("date").args(["-u", "+%F"])).unwrap_or_default();
            let commit = output_of(repo.command("git").args(["rev-parse", "--short", "HEAD"])).unwrap_or_default();
            let figures = figures.map(|figure| figure.map_or(String::new(), |figure| format!("{}", round(figure))));
            let record = format!("{records}{date},{commit},{}\n", figures.join(","));
            fs::write(&file, record).map_err(|error| format!("{}: {error}", file.display()))?;
        }
        Ok(())
    });
}

/// To a tenth.
fn round(figure: f64) -> f64 {
    (figure * 10.0).round() / 10.0
}

/// Runs a command; the seconds that processors worked for it, the system's included.
fn seconds(command: &mut std::process::Command) -> Result<f64, String> {
    let before = processor_time().ok_or("no /proc/self/stat here, which says how long processors worked")?;
    run(command)?;
    let worked = processor_time().and_then(|after| after.checked_sub(before));
    Ok(worked.unwrap_or_default().as_secs_f64())
}

/// Each figure, its value in the last record that has it, and the ratio of both; the time also as a ratio to the peer's.
fn table(records: &str, figures: &[Option<f64>; 5]) -> String {
    let rows: Vec<Vec<Option<f64>>> =
        records.lines().skip(1).map(|row| row.split(',').skip(2).map(|field| field.parse().ok()).collect()).collect();
    let last = |at: usize| rows.iter().rev().find_map(|row| *row.get(at)?);
    let mut text = format!("{:<24}{:>14}{:>14}{:>8}\n", "", "now", "recorded", "ratio");
    let mut line = |name: &str, now: Option<f64>, before: Option<f64>| {
        let shown = |value: Option<f64>| {
            value.map_or(String::from("-"), |value| format!("{}", (value * 100.0).round() / 100.0))
        };
        let ratio = now.zip(before).map(|(now, before)| now / before);
        text += &format!("{name:<24}{:>14}{:>14}{:>8}\n", shown(now), shown(before), shown(ratio));
    };
    for (at, name) in HEADER.split(',').skip(2).enumerate() {
        line(name, figures[at], last(at));
    }
    let over_peer = |row: &[Option<f64>]| Some((*row.get(1)?)? / (*row.get(2)?)?);
    line("processor_s / peer_s", over_peer(figures), rows.iter().rev().find_map(|row| over_peer(row)));
    text
}

/// Lines of code in `src` of each crate of the workspace, tests, comments and blank lines left out.
fn code_lines(root: &Path) -> Result<Vec<(String, usize)>, String> {
    let count = |member: String| {
        let modules = modules(&root.join(&member).join("src"))?;
        Ok((member, modules.values().map(|module| module.lines.len()).sum()))
    };
    members(root)?.into_iter().map(count).collect()
}

/// The name of the step in `cargo xtask check`.
pub const SHARED: &str = "no library compiled twice for the programs";

/// One call of the compiler or of a build script, as `cargo build --unit-graph` plans it.
#[derive(Deserialize)]
struct Unit {
    pkg_id: String,
    target: Target,
    /// What for: `build`, or `run-custom-build`.
    mode: String,
    /// Differs between a library of programs and the same library of build scripts and macros.
    profile: serde_json::Value,
    platform: Option<String>,
    features: BTreeSet<String>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
}

#[derive(Deserialize)]
struct Graph {
    units: Vec<Unit>,
}

/// What cargo would compile for a program, without compiling it.
fn graph(repo: &Repo, package: &str, program: &str) -> Result<Graph, String> {
    let mut plan = repo.cargo(&["build", "--release", "--locked", "--package", package, "--bin", program]);
    // The option is stable enough to be read, and not stable.
    plan.args(["--unit-graph", "-Zunstable-options"]).env("RUSTC_BOOTSTRAP", "1");
    let text = output_of(&mut plan).ok_or_else(|| format!("cargo does not plan {program}"))?;
    serde_json::from_str(&text).map_err(|error| format!("cargo's plan of {program}: {error}"))
}

/// Compares the plans of all programs: one folder has each library once if they want the same features of it.
pub fn check_shared(repo: &Repo) -> Result<(), String> {
    let metadata = output_of(&mut repo.cargo(&["metadata", "--no-deps", "--format-version", "1", "--locked"]));
    let metadata = serde_json::from_str(&metadata.ok_or("cargo metadata fails")?);
    let metadata: serde_json::Value = metadata.map_err(|error| format!("cargo metadata: {error}"))?;
    let mut graphs = Vec::new();
    for program in std::iter::once(MAIN).chain(OTHERS) {
        let has_it = |package: &&serde_json::Value| {
            let targets = package["targets"].as_array().into_iter().flatten();
            targets.into_iter().any(|target| target["name"] == program && target["kind"][0] == "bin")
        };
        let package = metadata["packages"].as_array().and_then(|packages| packages.iter().find(has_it));
        if let Some(package) = package.and_then(|package| package["name"].as_str()) {
            graphs.push((program, graph(repo, package, program)?));
        }
    }
    println!("{}", graphs.iter().map(|(program, _)| *program).collect::<Vec<_>>().join(", "));
    let faults = differences(&graphs);
    faults.iter().for_each(|fault| println!("{fault}"));
    match faults.len() {
        0 => Ok(()),
        count => Err(format!("{count} libraries compiled twice: {}", faults.join("; "))),
    }
}

/// Each library of which programs want different features, with what differs.
fn differences(graphs: &[(&str, Graph)]) -> Vec<String> {
    let mut wanted: BTreeMap<_, BTreeMap<&BTreeSet<String>, BTreeSet<&str>>> = BTreeMap::new();
    for (program, graph) in graphs {
        let libraries = graph.units.iter().filter(|unit| unit.mode == "build");
        for unit in
            libraries.filter(|unit| !unit.target.kind.iter().any(|kind| kind == "bin" || kind == "custom-build"))
        {
            let key = (&unit.pkg_id, &unit.target.name, unit.profile.to_string(), &unit.platform);
            wanted.entry(key).or_default().entry(&unit.features).or_default().insert(program);
        }
    }
    let faults = wanted.into_iter().filter(|(_, sets)| sets.len() > 1).map(|((_, name, ..), sets)| {
        let common = sets.keys().copied().cloned().reduce(|a, b| &a & &b).unwrap_or_default();
        let list = |set: &BTreeSet<String>| set.difference(&common).cloned().collect::<Vec<_>>().join(",");
        let set = |(features, programs): (&&BTreeSet<String>, &BTreeSet<&str>)| {
            format!("{{{}}} for {}", list(features), programs.iter().copied().collect::<Vec<_>>().join(", "))
        };
        format!("{name} with {}", sets.iter().map(set).collect::<Vec<_>>().join(" and with "))
    });
    faults.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(features: &[&str], kind: &str, opt_level: &str) -> Graph {
        let unit = serde_json::json!({
            "pkg_id": "serde", "target": { "name": "serde", "kind": [kind] }, "mode": "build",
            "profile": { "opt_level": opt_level }, "platform": null, "features": features
        });
        Graph { units: vec![serde_json::from_value(unit).expect("a unit")] }
    }

    #[test]
    fn a_library_with_two_sets_of_features_is_named() {
        let one = plan(&["std", "derive"], "lib", "3");
        let twice = |other| differences(&[("staya", plan(&["std", "derive"], "lib", "3")), ("staya-lab", other)]);
        assert_eq!(twice(one), [""; 0]);
        assert_eq!(twice(plan(&["std"], "lib", "3")), ["serde with {derive} for staya and with {} for staya-lab"]);
        // For a build script it is another library.
        assert_eq!(twice(plan(&["std"], "lib", "0")), [""; 0]);
        assert_eq!(twice(plan(&["std"], "bin", "3")), [""; 0]);
    }

    #[test]
    fn figures_stand_beside_the_last_record_that_has_them() {
        let records = format!("{HEADER}\n2026-01-01,abc,100,50,25,1000,10\n2026-01-02,abd,200,40,,1000,10\n");
        let table = table(&records, &[Some(100.0), Some(20.0), Some(10.0), Some(1500.0), Some(10.0)]);
        let rows: Vec<Vec<&str>> = table.lines().map(|row| row.split_whitespace().collect()).collect();
        assert_eq!(rows[1], ["units", "100", "200", "0.5"]);
        assert_eq!(rows[3], ["peer_s", "10", "25", "0.4"]);
        assert_eq!(rows[6], ["processor_s", "/", "peer_s", "2", "2", "1"]);
    }
}
