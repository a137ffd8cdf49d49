//! `cargo xtask bench`: the project's benchmarks and those beside peer crates, in one run on one
//! machine.

use crate::prelude::*;
use crate::python;
use std::time::SystemTime;

const PEERS: &str = "tests/peers";
/// The benchmark that takes a seed and settings.
const RVO2: &str = "rvo2";
/// Benchmarks that are not criterion's: name, row of the closing table, script and its environment.
const SCRIPTS: [(&str, &str, &str, Environment); 3] = [
    ("bridge", "bridge beside pymavlink", "tests/python/bench_bridge.py", python::client_environment),
    ("view", "a run with a page that no browser shows", "tests/python/bench_view.py", python::client_environment),
    (RVO2, "26 scenes beside RVO2", "tests/rvo2/bench.py", python::rvo2_environment),
];

/// Prepares an environment and returns its Python.
type Environment = fn(&Repo) -> Result<PathBuf>;

/// Benchmarks with a goal: the least ratio of its speed to another benchmark's in the same run. No
/// goal is a time, which would be one of the machine.
const GOALS: [(&str, f64, &str); 6] = [
    ("cost_field_16x16/staya", 5.0, "cost_field_16x16/pathfinding"),
    ("cost_field_32x32/staya", 4.0, "cost_field_32x32/pathfinding"),
    ("orca_10/staya", 1.0, "orca_10/dodgy_2d"),
    ("orca_step_1000/staya", 0.9, "orca_step_1000/dodgy_2d"),
    ("flock_100k/staya", 2.0, "flock_100k/krabmaga"),
    ("agent_step/reflexive", 0.2, "agent_step/constant_velocity"),
];

#[derive(clap::Args)]
pub struct Options {
    /// Only benchmarks whose name contains this
    name: Option<String>,
    /// Seed of the scenes of `rvo2` [default: 1]
    #[arg(long, value_name = "N", requires = "name")]
    seed: Option<u64>,
    /// Override a scenario field for Staya in `rvo2`, for example plane.orca.horizon_s=0.7; may be
    /// repeated
    #[arg(long = "set", value_name = "FIELD=VALUE", requires = "name")]
    settings: Vec<String>,
}

/// Runs the benchmarks whose name contains the given one and judges them by their goals.
pub fn run(s: &mut Session, options: &Options) {
    let name = options.name.as_deref();
    let arguments = options.arguments();
    if name != Some(RVO2) && !arguments.is_empty() {
        let reason = "--seed and --set are options of rvo2 only; run `cargo xtask bench rvo2`";
        s.report.step("options", || bail!(reason));
        return;
    }
    let is_wanted = |known: &str| name.is_none_or(|name| known.contains(name));
    if !SCRIPTS.iter().any(|(script, ..)| name == Some(script)) {
        criterion(s, name);
    }
    for (_, row, file, python) in SCRIPTS.iter().filter(|(script, ..)| is_wanted(script)) {
        script(s, row, file, *python, &arguments);
    }
    if is_wanted("view") {
        let mut bench = s.repo.cargo("bench --locked --package staya-view --bench view");
        s.report.command("pictures a second", &mut bench);
    }
}

/// Runs the benchmarks that have goals, and those that the goals compare with.
pub fn run_goals(s: &mut Session) {
    let names: Vec<&str> = GOALS.iter().flat_map(|(name, _, other)| [*name, *other]).collect();
    criterion(s, Some(&format!("^({})$", names.join("|"))));
    // The goals beside RVO2 are not reached (docs/results.md): they would hide other failures.
    for (_, row, file, python) in SCRIPTS.iter().filter(|(name, ..)| *name != RVO2) {
        script(s, row, file, *python, &[]);
    }
}

impl Options {
    /// The options for the script of `rvo2`.
    fn arguments(&self) -> Vec<String> {
        let seed = self.seed.iter().map(|seed| ("--seed", seed.to_string()));
        let settings = self.settings.iter().map(|setting| ("--set", setting.clone()));
        seed.chain(settings).flat_map(|(option, value)| [option.to_string(), value]).collect()
    }
}

/// A benchmark in Python with the program as users have it; the script judges.
fn script(s: &mut Session, name: &str, file: &str, python: Environment, arguments: &[String]) {
    let program = s.staya("release");
    s.report.step(name, || {
        let program = program?;
        execute(s.repo.command(python(&s.repo)?).arg(file).args(arguments).env("STAYA", program))
    });
}

/// Runs the benchmarks, all of which stand beside peers.
fn criterion(s: &mut Session, filter: Option<&str>) {
    let home = s.repo.target.join("criterion");
    let start = SystemTime::now();
    let mut benches = s.repo.cargo_in(PEERS, "bench --locked --bench *");
    benches.env("CRITERION_HOME", &home).args(filter.iter().flat_map(|name| ["--", name]));
    s.report.command("benchmarks", &mut benches);
    s.report.part("goals", || {
        let mut counts = judge(&medians(&home, start));
        if filter.is_some_and(|name| !name.starts_with('^')) {
            // The others were not asked for.
            counts.skipped = 0;
        }
        let note = if counts.skipped > 0 { "skipped: goals of benchmarks that did not run" } else { "" };
        Ok((counts, note.to_string()))
    });
}

/// Prints each median beside its goal and counts the goals.
fn judge(medians: &[(String, f64)]) -> Counts {
    let width = medians.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut counts = Counts { skipped: GOALS.len() as u64, ..Counts::default() };
    println!("{:width$}  {:>14}  goal", "benchmark", "median, us");
    for (name, median) in medians {
        let goal = GOALS.iter().find(|(known, ..)| known == name).map(|(_, times, other)| {
            let Some((_, ns)) = medians.iter().find(|(name, _)| name == other) else {
                return format!("{other} did not run");
            };
            let (ratio, is_met) = (ns / median, ns / median >= *times);
            counts.skipped -= 1;
            counts.passed += u64::from(is_met);
            counts.failed += u64::from(!is_met);
            let verdict = if is_met { "met" } else { "MISSED" };
            format!("{ratio:.1} times as fast as {other}, at least {times}: {verdict}")
        });
        println!("{name:width$}  {:>14.4}  {}", median / 1e3, goal.unwrap_or_default());
    }
    counts
}

/// The medians in nanoseconds that criterion wrote since `start`, by name.
fn medians(home: &Path, start: SystemTime) -> Vec<(String, f64)> {
    let inside = |folder: &Path| files::entries(folder).unwrap_or_default();
    let read = |folder: &Path| {
        let file = folder.join("new/estimates.json");
        let is_fresh = file.metadata().and_then(|meta| meta.modified()).is_ok_and(|time| time >= start);
        let name = folder.strip_prefix(home).ok()?.display().to_string();
        Some((name, files::read(&file).ok().filter(|_| is_fresh).as_deref().and_then(median)?))
    };
    inside(home).iter().flat_map(|group| inside(group)).filter_map(|folder| read(&folder)).collect()
}

/// The median's point estimate in criterion's estimates.json.
fn median(json: &str) -> Option<f64> {
    let estimates: serde_json::Value = serde_json::from_str(json).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_is_read_from_estimates() {
        let json = r#"{"mean":{"point_estimate":1.5},"median":{"confidence_interval":
            {"confidence_level":0.95,"lower_bound":1.0},"point_estimate":42.25,"standard_error":0.1}}"#;
        assert_eq!(median(json), Some(42.25));
        assert_eq!(median("{}"), None);
        assert_eq!(median(r#"{"median":{"point_estimate":"#), None);
    }

    #[test]
    fn goals_are_met_missed_or_not_run() {
        let of = |name: &str, ns: f64| (name.to_string(), ns);
        let medians = [
            of("agent_step/constant_velocity", 4_999.0),
            of("agent_step/reflexive", 25_000.0),
            of("cost_field_16x16/pathfinding", 499.0),
            of("cost_field_16x16/staya", 100.0),
            of("cost_field_32x32/staya", 100.0),
            of("orca_10/dodgy_2d", 100.0),
            of("orca_10/staya", 99.0),
        ];
        // The peer of one did not run, and neither did the others.
        let skipped = GOALS.len() as u64 - 3;
        assert_eq!(judge(&medians), Counts { passed: 1, failed: 2, skipped });
    }
}
