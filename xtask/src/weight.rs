//! `cargo xtask weight`: what the README's first command costs, beside the last record, and no
//! library compiled twice.

use crate::prelude::*;
use crate::report::processor_time;
use crate::session::{PROGRAMS, folders};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The records, one line each.
const RECORDS: &str = "xtask/weight.csv";
const HEADER: &str = "date,commit,units,processor_s,peer_s,program_bytes,code_lines";

#[derive(clap::Args)]
pub struct Options {
    /// Also measure ripgrep
    #[arg(long)]
    peer: bool,
    /// Add a record
    #[arg(long)]
    record: bool,
}

/// The command: prints each figure beside the last record.
pub fn run(s: &mut Session, options: &Options) {
    s.report.step(SHARED, || check_shared(&s.repo));
    s.report.step("weight", || measure(&s.repo, options));
}

fn measure(repo: &Repo, options: &Options) -> Result<()> {
    let folder = repo.target.join("weight");
    files::make_empty(&folder)?;
    execute(&mut repo.cargo("fetch --locked"))?;
    let units = plan(repo, MAIN, MAIN)?.len();
    let mut build = repo.cargo(&format!("build --release --locked --package {MAIN}"));
    let processor_s = seconds(build.env("CARGO_TARGET_DIR", &folder))?;
    let bytes = files::bytes(&folder.join("release").join(files::name(&repo.program("release", MAIN))))?.len();
    let mut peer = repo.cargo("install ripgrep --locked --root");
    peer.arg(folder.join("ripgrep")).env("CARGO_TARGET_DIR", folder.join("peer"));
    let peer_s = if options.peer { Some(seconds(&mut peer)?) } else { None };
    let code_lines = code_lines(repo)?;
    let figures = [Some(units as f64), Some(processor_s), peer_s, Some(bytes as f64), Some(code_lines as f64)];
    let file = repo.root.join(RECORDS);
    let records = files::read(&file)?;
    print!("{}", table(&records, &figures));
    if options.record {
        let now = repo.answer("date -u +%F && git rev-parse --short HEAD").context("no commit here")?;
        let figures = figures.map(|figure| figure.map_or(String::new(), |figure| format!("{}", round(figure, 10.0))));
        files::write(&file, format!("{records}{},{}\n", now.replace('\n', ","), figures.join(",")))?;
    }
    Ok(())
}

/// Rounds to one of these parts of 1.
fn round(figure: f64, parts: f64) -> f64 {
    (figure * parts).round() / parts
}

/// Runs a command; the seconds that processors worked for it, the system's included.
fn seconds(command: &mut std::process::Command) -> Result<f64> {
    let before = processor_time().context("no /proc/self/stat here, which says how long processors worked")?;
    execute(command)?;
    let worked = processor_time().and_then(|after| after.checked_sub(before));
    Ok(worked.unwrap_or_default().as_secs_f64())
}

/// Each figure, its value in the last record that has it, and the ratio of both; the time also as a
/// ratio to the peer's.
fn table(records: &str, figures: &[Option<f64>; 5]) -> String {
    let over_peer = |row: &[Option<f64>]| Some((*row.get(1)?)? / (*row.get(2)?)?);
    let with_ratio = |mut row: Vec<Option<f64>>| {
        row.push(over_peer(&row));
        row
    };
    let rows = records.lines().skip(1).map(|row| row.split(',').skip(2).map(|field| field.parse().ok()).collect());
    let rows: Vec<_> = rows.map(with_ratio).collect();
    let mut text = format!("{:<24}{:>14}{:>14}{:>8}\n", "", "now", "recorded", "ratio");
    let names = HEADER.split(',').skip(2).chain(["processor_s / peer_s"]);
    for (at, (name, now)) in names.zip(with_ratio(figures.to_vec())).enumerate() {
        let before = rows.iter().rev().find_map(|row| *row.get(at)?);
        let ratio = now.zip(before).map(|(now, before)| now / before);
        let shown = |value: Option<f64>| value.map_or(String::from("-"), |value| round(value, 100.0).to_string());
        text += &format!("{name:<24}{:>14}{:>14}{:>8}\n", shown(now), shown(before), shown(ratio));
    }
    text
}

/// Lines of code in the sources of all crates of the workspace, which it prints for each. Blank
/// lines and comments are left out, and tests: files of them, and modules of them at the end of
/// other files.
fn code_lines(repo: &Repo) -> Result<usize> {
    let is_wanted = |path: &Path| {
        let is_code = !["bin", "tests", "tests.rs"].contains(&files::name(path).as_str());
        is_code && (path.is_dir() || files::has_extension(path, &["rs"]))
    };
    let mut sum = 0;
    for folder in folders(repo)?.iter().filter(|folder| folder.join("src").is_dir()) {
        let mut count = 0;
        for file in files::below(&folder.join("src"), &is_wanted)? {
            let text = files::read(&file)?;
            let lines = text.lines().take_while(|line| *line != "mod tests {").map(str::trim);
            count += lines.filter(|line| !line.is_empty() && !line.starts_with("//")).count();
        }
        println!("{count:>7}  {}", folder.strip_prefix(&repo.root)?.display());
        sum += count;
    }
    Ok(sum)
}

/// The name of the step in `cargo xtask check`.
pub const SHARED: &str = "no library compiled twice for the programs";

/// Cargo's plan for a program, `cargo build --unit-graph`: the calls of the compiler and of build
/// scripts. Nothing is compiled.
fn plan(repo: &Repo, package: &str, program: &str) -> Result<Vec<Value>> {
    // The option is stable enough to be read, and not stable.
    let line = format!("build --release --locked --package {package} --bin {program} --unit-graph -Zunstable-options");
    let plan = output_of(repo.cargo(&line).env("RUSTC_BOOTSTRAP", "1"));
    let mut graph: Value = serde_json::from_str(&plan.with_context(|| format!("cargo does not plan {program}"))?)?;
    let units = graph["units"].as_array_mut().with_context(|| format!("cargo's plan of {program} has no units"))?;
    units.retain(|unit| unit["mode"] == "build");
    Ok(std::mem::take(units))
}

/// Compares the plans of all programs: one folder has each library once if they want the same
/// features of it.
pub fn check_shared(repo: &Repo) -> Result<()> {
    let plans = PROGRAMS.map(|(package, program)| Ok((program, plan(repo, package, program)?)));
    let plans = plans.into_iter().collect::<Result<Vec<_>>>()?;
    none_of(&differences(&plans), "libraries are compiled twice")
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
