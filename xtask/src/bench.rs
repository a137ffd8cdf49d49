//! `cargo xtask bench`: the project's benchmarks and those beside peer crates, in one run on one
//! machine.

use crate::clients;
use crate::repo::{Repo, output_of, run as run_to_end};
use crate::report::{Counts, Report};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

const PEERS: &str = "tests/peers";
/// Those that are no criterion's.
const BRIDGE: &str = "bridge";
const VIEW: &str = "view";
/// Runs of one scenario with a page that nobody looks at, each beside one without; a ratio of one pair tells of the machine, their median of the page.
const PAIRS: usize = 9;
/// That median at most.
const VIEW_COSTS: f64 = 1.03;

/// What a benchmark should reach.
enum Goal {
    /// At least this many times as fast as the other benchmark.
    Faster(f64, &'static str),
    /// A median below this many nanoseconds.
    Under(f64),
}

/// Benchmarks with a goal; the others are listed without one.
const GOALS: [(&str, Goal); 7] = [
    ("cost_field_16x16/staya", Goal::Faster(5.0, "cost_field_16x16/pathfinding")),
    ("cost_field_32x32/staya", Goal::Faster(5.0, "cost_field_32x32/pathfinding")),
    ("orca_10/staya", Goal::Faster(1.0, "orca_10/dodgy_2d")),
    // 0.75 microseconds a robot.
    ("orca_step_1000/staya", Goal::Under(750_000.0)),
    ("flock_100k/staya", Goal::Faster(2.0, "flock_100k/krabmaga")),
    ("agent_step/constant_velocity", Goal::Under(5_000.0)),
    ("agent_step/reflexive", Goal::Under(25_000.0)),
];

/// Runs the benchmarks whose name contains `name` and judges their medians.
pub fn run(repo: &Repo, report: &mut Report, name: Option<&str>) {
    if !matches!(name, Some(BRIDGE | VIEW)) {
        criterion(repo, report, name);
    }
    if name.is_none_or(|name| BRIDGE.contains(name)) {
        bridge(repo, report);
    }
    if name.is_none_or(|name| VIEW.contains(name)) {
        view(repo, report);
    }
}

/// The program as users have it; `what` it is for.
fn release(repo: &Repo, report: &mut Report, what: &str) -> Option<PathBuf> {
    let mut build = repo.cargo(&["build", "--release", "--locked", "--package", "staya"]);
    let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
    report.step(what, || run_to_end(&mut build)).then(|| repo.target.join("release").join(program))
}

/// What a page costs a run that nobody looks at, and how many pictures a second there are of how many robots; the benchmark judges these.
fn view(repo: &Repo, report: &mut Report) {
    const NAME: &str = "a run with a page, nobody looking";
    let Some(program) = release(repo, report, "staya for its pages") else {
        return report.skip(NAME, "the program was not built");
    };
    report.part(NAME, || {
        let mut ratios = Vec::new();
        for pair in 0..PAIRS {
            // By turns, so that a machine that becomes slower is slower for both.
            let mut seconds = [0.0; 2];
            for with_page in [pair % 2, 1 - pair % 2] {
                let page: &[&str] = if with_page == 1 { &["--view"] } else { &[] };
                let mut run = repo.command(&program);
                run.args(["run", "scenarios/twenty-discs.toml", "--json", "-q", "--out"])
                    .arg(repo.target.join("bench-view"));
                let said = output_of(run.args(page));
                match said.as_deref().and_then(|json| number(json, "wall_seconds")) {
                    Some(wall) => seconds[with_page] = wall,
                    None => return (Counts { failed: 1, ..Counts::default() }, "`staya run` failed".to_owned()),
                }
            }
            println!("without {:.3} s, with a page {:.3} s", seconds[0], seconds[1]);
            ratios.push(seconds[1] / seconds[0]);
        }
        ratios.sort_by(f64::total_cmp);
        let median = ratios[PAIRS / 2];
        let is_met = median <= VIEW_COSTS;
        let note = format!("{median:.3} times as long (median of {PAIRS} pairs), at most {VIEW_COSTS}");
        (Counts { passed: is_met.into(), failed: (!is_met).into(), ..Counts::default() }, note)
    });
    let bench = repo.cargo(&["bench", "--locked", "--package", "staya-view", "--bench", "view"]);
    report.command("pictures a second", bench);
}

/// The number in a field of printed JSON.
fn number(json: &str, field: &str) -> Option<f64> {
    let (_, value) = json.split_once(&format!("\"{field}\":"))?;
    let end = value.find([',', '}'])?;
    value.get(..end)?.trim().parse().ok()
}

/// Messages through `staya bridge` beside pymavlink; the script judges.
fn bridge(repo: &Repo, report: &mut Report) {
    const NAME: &str = "bridge beside pymavlink";
    let python = match clients::prepare(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(NAME, &reason),
    };
    let Some(program) = release(repo, report, "staya for the bridge") else {
        return report.skip(NAME, "the program was not built");
    };
    let mut bench = repo.command(&python);
    bench.arg("tests/python/bench_bridge.py");
    bench.env("STAYA", program);
    report.command(NAME, bench);
}

fn criterion(repo: &Repo, report: &mut Report, name: Option<&str>) {
    let home = repo.target.join("criterion");
    let start = SystemTime::now();
    // Only targets that are benchmarks: a library's own tests need no release build.
    let own = repo.cargo(&["bench", "--locked", "--workspace", "--exclude", "staya-view", "--bench", "*"]);
    let peers = repo.cargo_in(PEERS, &["bench", "--locked", "--bench", "*"]);
    for (what, mut bench) in [("benchmarks", own), ("benchmarks beside peers", peers)] {
        bench.env("CRITERION_HOME", &home);
        bench.args(name.map(|name| ["--", name]).into_iter().flatten());
        report.command(what, bench);
    }
    report.part("goals", || {
        let (mut counts, note) = judge(&medians(&home, start));
        if name.is_some() {
            // Nobody asked for the others.
            counts.skipped = 0;
        }
        (counts, note)
    });
}

/// Prints each median beside its goal and counts the goals.
fn judge(medians: &[(String, f64)]) -> (Counts, String) {
    let of = |name: &str| medians.iter().find(|(known, _)| known == name).map(|&(_, ns)| ns);
    let width = medians.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut counts = Counts::default();
    println!("{:width$}  {:>10}  goal", "benchmark", "median");
    for (name, median) in medians {
        let goal = GOALS.iter().find(|(known, _)| known == name).map(|(_, goal)| goal);
        let (met, what) = match goal {
            None => (None, String::new()),
            Some(Goal::Under(limit)) => (Some(median < limit), format!("under {}", shown(*limit))),
            Some(Goal::Faster(times, peer)) => match of(peer) {
                None => (None, format!("{peer} did not run")),
                Some(other) => {
                    let ratio = other / median;
                    let what = format!("{ratio:.1} times as fast as {peer}, at least {times}");
                    (Some(ratio >= *times), what)
                }
            },
        };
        let verdict = match met {
            None => "",
            Some(true) => ": met",
            Some(false) => ": MISSED",
        };
        println!("{name:width$}  {:>10}  {what}{verdict}", shown(*median));
        counts.passed += u64::from(met == Some(true));
        counts.failed += u64::from(met == Some(false));
    }
    let ran = counts.passed + counts.failed;
    counts.skipped = (GOALS.len() as u64).saturating_sub(ran);
    let note = if counts.skipped > 0 { "skipped: goals of benchmarks that did not run" } else { "" };
    (counts, note.to_string())
}

/// The medians in nanoseconds that criterion wrote since `start`, by name.
fn medians(home: &Path, start: SystemTime) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for group in folders(home) {
        for function in folders(&home.join(&group)) {
            let file = home.join(&group).join(&function).join("new/estimates.json");
            let fresh = fs::metadata(&file).and_then(|meta| meta.modified());
            if !fresh.is_ok_and(|time| time >= start) {
                continue;
            }
            if let Some(ns) = fs::read_to_string(&file).ok().as_deref().and_then(median) {
                found.push((format!("{group}/{function}"), ns));
            }
        }
    }
    found
}

/// Names of the folders in a folder, sorted; none if it cannot be read.
fn folders(parent: &Path) -> Vec<String> {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The median's point estimate in criterion's estimates.json.
fn median(json: &str) -> Option<f64> {
    let (_, median) = json.split_once("\"median\"")?;
    number(median, "point_estimate")
}

/// Nanoseconds for people.
fn shown(ns: f64) -> String {
    match ns {
        ns if ns < 1e3 => format!("{ns:.1} ns"),
        ns if ns < 1e6 => format!("{:.2} us", ns / 1e3),
        ns if ns < 1e9 => format!("{:.2} ms", ns / 1e6),
        ns => format!("{:.2} s", ns / 1e9),
    }
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
            of("cost_field_16x16/pathfinding", 500.0),
            of("cost_field_16x16/staya", 100.0),
            of("cost_field_32x32/staya", 100.0),
        ];
        let (counts, _) = judge(&medians);
        assert_eq!(
            counts,
            Counts {
                passed: 2,
                failed: 1,
                // The peer of the one did not run, and neither did the others.
                skipped: GOALS.len() as u64 - 3
            }
        );
    }
}
