//! `cargo xtask figures`: the figures of all scenarios and experiments, recorded before a change of
//! the code and compared after it.

use crate::files;
use crate::options::Options;
use crate::repo::{Repo, output_of};
use crate::session::Session;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Of its own: no parameter was chosen on them, and no other table has them.
const SEEDS: std::ops::RangeInclusive<u32> = 7001..=7005;
/// Small versions of the experiments, with the first seeds.
const EXPERIMENTS: [&[&str]; 8] = [
    &["route", "--runs", "10"],
    &["scouting", "--seeds", "5"],
    &["formation", "--seeds", "3"],
    &["swap", "--axis", "count=4,8,16,32", "--axis", "radius_m=2,2,2,3.2", "--set", "plane.robots.circle.noise_m=0.05"],
    &["doorway"],
    &["crossing", "--seeds", "3"],
    &["flock", "--seeds", "1", "--robots", "30"],
    &["goals", "--seeds", "1", "--robots", "25"],
];
const SEEDS_OF_EXPERIMENTS: usize = 2;
/// Runs of minutes.
const LARGE: [&str; 3] = ["million", "scale", "scale-plane"];
/// Results that depend on the machine.
const LEFT_OUT: [&str; 5] = ["wall_seconds", "seed", "pictures", "tables", "parameters"];
/// The difference of two means is within this many standard errors in 95 % of cases, if nothing has
/// changed (Student's t for two times five values).
const T: f64 = 2.306;
const HASH: &str = "trace_hash";

/// Values by scenario or experiment and figure, in the order of the seeds.
type Figures = BTreeMap<(String, String), Vec<String>>;

/// The command: records the figures in `target/figures.csv` or `--out`, and compares them with
/// those of `--against`.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    let Some(staya) = s.staya("release") else { return };
    let file = options.value("--out").map_or_else(|| s.repo.target.join("figures.csv"), Into::into);
    let mut figures = Figures::new();
    s.report.step("figures of scenarios and experiments", || {
        figures = measured(&s.repo, &staya)?;
        println!("{} figures: {}", figures.len(), file.display());
        files::write(&file, text(&figures))
    });
    if let Some(before) = options.value("--against") {
        s.report.step("as before", || compare(&read(Path::new(before))?, &figures));
    }
}

fn measured(repo: &Repo, staya: &Path) -> Result<Figures, String> {
    let mut figures = Figures::new();
    for path in files::sources(&repo.root.join("scenarios"), &["toml"])? {
        let name = files::stem(&path);
        if LARGE.contains(&name.as_str()) {
            continue;
        }
        for seed in SEEDS {
            let mut run = repo.command(staya);
            run.arg("run").arg(&path).arg("--no-trace");
            add(repo, &mut run, (&name, seed), &mut figures)?;
        }
        println!("{name}");
    }
    for arguments in EXPERIMENTS {
        let name = format!("experiment-{}", arguments[0]);
        for seed in SEEDS.take(SEEDS_OF_EXPERIMENTS) {
            let mut run = repo.command(staya);
            run.arg("experiment").args(arguments).arg("--restart");
            add(repo, &mut run, (&name, seed), &mut figures)?;
        }
        println!("{name}");
    }
    Ok(figures)
}

/// Adds the figures of a run with this seed.
fn add(repo: &Repo, run: &mut Command, (name, seed): (&str, u32), figures: &mut Figures) -> Result<(), String> {
    run.args(["--json", "--quiet", "--seed", &seed.to_string(), "--out"]);
    let json = output_of(run.arg(repo.target.join("figures").join(name)));
    let json = json.ok_or_else(|| format!("{name}, seed {seed}: no results"))?;
    let json: Value = serde_json::from_str(&json).map_err(|error| format!("{name}: {error}"))?;
    numbers(&json, "", &mut |figure, value| {
        figures.entry((name.to_owned(), figure.to_owned())).or_default().push(value);
    });
    Ok(())
}

/// Calls `found` with the path and the text of each number and of the trace hash.
fn numbers(value: &Value, path: &str, found: &mut impl FnMut(&str, String)) {
    match value {
        Value::Number(number) => found(path, number.to_string()),
        Value::String(hash) if path == HASH => found(path, hash.clone()),
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                numbers(item, &format!("{path}[{index}]"), found);
            }
        }
        Value::Object(fields) => {
            for (name, value) in fields.iter().filter(|(name, _)| !LEFT_OUT.contains(&name.as_str())) {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                numbers(value, &path, found);
            }
        }
        _ => {}
    }
}

fn text(figures: &Figures) -> String {
    let line =
        |((name, figure), values): (&(String, String), &Vec<String>)| format!("{name},{figure},{}\n", values.join(","));
    figures.iter().map(line).collect()
}

fn read(file: &Path) -> Result<Figures, String> {
    let text = files::read(file)?;
    let rows = text.lines().map(|line| {
        let mut fields = line.split(',').map(str::to_owned);
        let key = fields.next().zip(fields.next());
        key.map(|key| (key, fields.collect())).ok_or_else(|| format!("{}: {line:?} is no row", file.display()))
    });
    rows.collect()
}

/// Figures of runs that lose no packet are equal; of others, nineteen in twenty are within their
/// 95 % intervals.
fn compare(before: &Figures, now: &Figures) -> Result<(), String> {
    let (mut equal, mut within, mut beyond, mut unlike) = (0, 0, Vec::new(), Vec::new());
    for (key @ (name, figure), values) in before {
        let of_now = now.get(key).map_or(&[][..], Vec::as_slice);
        if of_now == values {
            equal += 1;
            continue;
        }
        let loses = [before, now].iter().any(|figures| loses(figures, name, figure));
        match (loses, interval(values, of_now)) {
            _ if loses && figure == HASH => {}
            (true, Some(true)) => within += 1,
            (true, Some(false)) => beyond.push((key, values, of_now)),
            _ => unlike.push((key, values, of_now)),
        }
    }
    unlike.extend(now.iter().filter(|(key, _)| !before.contains_key(key)).map(|(key, now)| (key, &NONE, &now[..])));
    println!("{equal} equal, {within} within their intervals, {} beyond, {} unlike", beyond.len(), unlike.len());
    for ((name, figure), before, now) in beyond.iter().chain(&unlike) {
        println!("{name} {figure}: {} before, {} now", before.join(" "), now.join(" "));
    }
    if !unlike.is_empty() {
        return Err(format!("{} figures without loss of packets differ", unlike.len()));
    }
    if beyond.len() * 20 > (within + beyond.len()).max(20) {
        return Err(format!("{} of {} figures are beyond their intervals", beyond.len(), within + beyond.len()));
    }
    Ok(())
}

static NONE: Vec<String> = Vec::new();

/// Whether packets are lost in a scenario or an experiment, or in the part of it with this figure.
fn loses(figures: &Figures, name: &str, figure: &str) -> bool {
    let parts = figure.match_indices('.').map(|(end, _)| format!("{}.loss", &figure[..end]));
    let all = ["packets.lost", "packets.corrupted", "loss", "conditions.loss"].map(str::to_owned);
    all.into_iter().chain(parts).any(|figure| {
        let values = figures.get(&(name.to_owned(), figure));
        values.is_some_and(|values| values.iter().any(|value| value.parse() != Ok(0.0)))
    })
}

/// Whether the difference of two means is as small as chance makes it; `None` if they are no
/// numbers.
fn interval(before: &[String], now: &[String]) -> Option<bool> {
    let numbers = |values: &[String]| values.iter().map(|value| value.parse().ok()).collect::<Option<Vec<f64>>>();
    let (before, now) = (numbers(before)?, numbers(now)?);
    if before.len() < 2 || now.len() < 2 {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let error = |values: &[f64]| {
        let mean = mean(values);
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        squares / ((values.len() - 1) * values.len()) as f64
    };
    let difference = mean(&before) - mean(&now);
    Some(difference * difference <= T * T * (error(&before) + error(&now)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(rows: &[(&str, &[&str])]) -> Figures {
        let row = |(figure, values): &(&str, &[&str])| {
            (("s".to_owned(), (*figure).to_owned()), values.iter().map(|value| (*value).to_owned()).collect())
        };
        rows.iter().map(row).collect()
    }

    #[test]
    fn without_loss_figures_are_equal_with_loss_alike() {
        let lost: (&str, &[&str]) = ("packets.lost", &["5", "6", "7"]);
        let before = [("arrived", &["9", "9", "10"][..]), ("trace_hash", &["a", "b", "c"])];
        let near = [("arrived", &["10", "9", "9"][..]), ("trace_hash", &["x", "y", "z"])];
        let far = [("arrived", &["1", "1", "2"][..]), ("trace_hash", &["x", "y", "z"])];
        let of = |rows: &[(&str, &[&str])], loses: bool| figures(&[rows, &[lost][..usize::from(loses)]].concat());
        assert!(compare(&of(&before, false), &of(&before, false)).is_ok());
        assert!(compare(&of(&before, false), &of(&near, false)).is_err());
        assert!(compare(&of(&before, true), &of(&near, true)).is_ok());
        let [few, many] =
            [compare(&of(&before, true), &of(&far, true)), compare(&of(&before, true), &figures(&[lost]))];
        assert!(few.is_ok() && many.is_err(), "one figure in twenty may be beyond; a missing one may not");
        let part = |name: &'static str| [("points[4].loss", &["0.3", "0.3", "0.3"][..]), (name, &["1", "2", "3"])];
        let changed = [("points[4].loss", &["0.3", "0.3", "0.3"][..]), ("points[4].time", &["2", "2", "3"])];
        assert!(compare(&figures(&part("points[4].time")), &figures(&changed)).is_ok(), "this point loses packets");
        let file = text(&of(&before, true));
        assert_eq!(file.lines().count(), 3);
    }
}
