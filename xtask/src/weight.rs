//! `cargo xtask weight`: what the README's first command costs, beside the last record, and no
//! library compiled twice.

use crate::files;
use crate::options::Options;
use crate::repo::{Repo, output_of, run};
use crate::report::processor_time;
use crate::session::{MAIN, Session, folders, programs};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The records, one line each.
const RECORDS: &str = "xtask/weight.csv";
const HEADER: &str = "date,commit,units,processor_s,peer_s,program_bytes,code_lines";
const PEER: [&str; 4] = ["install", "ripgrep", "--locked", "--root"];

/// The command: prints each figure beside the last record; `--record` adds one, `--peer` also
/// measures another program.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    s.report.step(SHARED, || check_shared(&s.repo));
    s.report.step("weight", || measure(&s.repo, options));
}

fn measure(repo: &Repo, options: &Options<'_>) -> Result<(), String> {
    let folder = repo.target.join("weight");
    files::make_empty(&folder)?;
    run(&mut repo.cargo(&["fetch", "--locked"]))?;
    let units = plan(repo, MAIN, MAIN)?.len();
    let mut build = repo.cargo(&["build", "--release", "--locked", "--package", MAIN]);
    let processor_s = seconds(build.env("CARGO_TARGET_DIR", &folder))?;
    let bytes = files::bytes(&folder.join("release").join(files::name(&repo.program("release", MAIN))))?.len();
    let mut peer = repo.cargo(&PEER);
    peer.arg(folder.join("ripgrep")).env("CARGO_TARGET_DIR", folder.join("peer"));
    let peer_s = if options.has("--peer") { Some(seconds(&mut peer)?) } else { None };
    let lines = code_lines(repo)?;
    lines.iter().for_each(|(member, lines)| println!("{lines:>7}  {member}"));
    let code_lines: usize = lines.iter().map(|(_, lines)| lines).sum();
    let figures = [Some(units as f64), Some(processor_s), peer_s, Some(bytes as f64), Some(code_lines as f64)];
    let file = repo.root.join(RECORDS);
    let records = files::read(&file).unwrap_or_else(|_| format!("{HEADER}\n"));
    print!("{}", table(&records, &figures));
    if !options.has("--record") {
        return Ok(());
    }
    let date = output_of(repo.command("date").args(["-u", "+%F"])).unwrap_or_default();
    let commit = output_of(repo.command("git").args(["rev-parse", "--short", "HEAD"])).unwrap_or_default();
    let figures = figures.map(|figure| figure.map_or(String::new(), |figure| format!("{}", round(figure))));
    files::write(&file, format!("{records}{date},{commit},{}\n", figures.join(",")))
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

/// Each figure, its value in the last record that has it, and the ratio of both; the time also as a
/// ratio to the peer's.
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

/// Lines of code in the sources of each crate of the workspace. Blank lines and comments are left
/// out, and tests: files of them, and modules of them at the end of other files.
fn code_lines(repo: &Repo) -> Result<Vec<(String, usize)>, String> {
    let count = |folder: &PathBuf| {
        let is_code = |path: &Path| !["bin", "tests", "tests.rs"].contains(&files::name(path).as_str());
        let is_rust = |path: &Path| path.is_dir() || files::has_extension(path, &["rs"]);
        let sources = files::below(&folder.join("src"), &|path| is_code(path) && is_rust(path))?;
        let texts = sources.iter().map(|file| files::read(file)).collect::<Result<Vec<_>, _>>()?;
        let lines = texts.iter().flat_map(|text| text.lines().take_while(|line| *line != "mod tests {"));
        let lines = lines.map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
        Ok((folder.strip_prefix(&repo.root).unwrap_or(folder).display().to_string(), lines.count()))
    };
    folders(repo)?.iter().filter(|folder| folder.join("src").is_dir()).map(count).collect()
}

/// The name of the step in `cargo xtask check`.
pub const SHARED: &str = "no library compiled twice for the programs";

/// Cargo's plan for a program, `cargo build --unit-graph`: the calls of the compiler and of build
/// scripts. Nothing is compiled.
fn plan(repo: &Repo, package: &str, program: &str) -> Result<Vec<Value>, String> {
    let mut plan = repo.cargo(&["build", "--release", "--locked", "--package", package, "--bin", program]);
    // The option is stable enough to be read, and not stable.
    plan.args(["--unit-graph", "-Zunstable-options"]).env("RUSTC_BOOTSTRAP", "1");
    let text = output_of(&mut plan).ok_or_else(|| format!("cargo does not plan {program}"))?;
    let graph: Value = serde_json::from_str(&text).map_err(|error| format!("cargo's plan of {program}: {error}"))?;
    let units = graph["units"].as_array().ok_or_else(|| format!("cargo's plan of {program} has no units"))?;
    Ok(units.iter().filter(|unit| unit["mode"] == "build").cloned().collect())
}

/// Compares the plans of all programs: one folder has each library once if they want the same
/// features of it.
pub fn check_shared(repo: &Repo) -> Result<(), String> {
    let plan = |(package, program): (String, &'static str)| Ok((program, plan(repo, &package, program)?));
    let plans = programs(repo)?.into_iter().map(plan).collect::<Result<Vec<_>, String>>()?;
    let faults = differences(&plans);
    faults.iter().for_each(|fault| println!("{fault}"));
    match faults.len() {
        0 => Ok(()),
        count => Err(format!("{count} libraries compiled twice: {}", faults.join("; "))),
    }
}

/// Each library of which programs want different features, with what differs.
fn differences(plans: &[(&str, Vec<Value>)]) -> Vec<String> {
    let mut wanted: BTreeMap<_, BTreeMap<BTreeSet<&str>, BTreeSet<&str>>> = BTreeMap::new();
    for (program, units) in plans {
        for unit in
            units.iter().filter(|unit| !["bin", "custom-build"].map(Value::from).contains(&unit["target"]["kind"][0]))
        {
            // The profile of a library for build scripts and macros differs.
            let key = ["pkg_id", "target", "profile", "platform"].map(|field| unit[field].to_string());
            let name = unit["target"]["name"].as_str().unwrap_or_default();
            let features = unit["features"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            wanted.entry((name, key)).or_default().entry(features).or_default().insert(program);
        }
    }
    let faults = wanted.into_iter().filter(|(_, sets)| sets.len() > 1).map(|((name, _), sets)| {
        let common = sets.keys().cloned().reduce(|a, b| &a & &b).unwrap_or_default();
        let set = |(features, programs): (&BTreeSet<&str>, &BTreeSet<&str>)| {
            let [own, programs] = [features - &common, programs.clone()].map(Vec::from_iter);
            format!("{{{}}} for {}", own.join(","), programs.join(", "))
        };
        format!("{name} with {}", sets.iter().map(set).collect::<Vec<_>>().join(" and with "))
    });
    faults.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(features: &[&str], kind: &str, opt_level: &str) -> Vec<Value> {
        vec![serde_json::json!({
            "pkg_id": "serde", "target": { "name": "serde", "kind": [kind] }, "mode": "build",
            "profile": { "opt_level": opt_level }, "platform": null, "features": features
        })]
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
