//! `cargo xtask mutants`: changes that the tests of the controller must notice.
//!
//! `cargo-mutants` plants them in a copy of the sources. `.cargo/mutants.toml` lists the modules,
//! and the survivors that are accepted, each with its reason.

use crate::prelude::*;

/// The share that `cargo xtask test --all` plants: some 23 of 4,500, in a minute and a half per
/// ten on two processors.
const SHARD: &str = "0/200";
/// Least share of viable mutants that the tests notice, percent, of a shard and of a sample.
const CAUGHT: u64 = 50;
const CAUGHT_OF_SAMPLE: u64 = 95;
/// The modules of a sample, which keep robots apart: beginnings of paths.
const SAMPLED: [&str; 5] = [
    "controller/src/agent/link.rs",
    "controller/src/agent/link/",
    "controller/src/neighbor/",
    "controller/src/orca/",
    "controller/src/safety/",
];
/// Tests of all modules of `.cargo/mutants.toml`, and of those of a sample.
const TESTED: [&str; 6] = ["agent::", "auth::", "laws::cells::", "neighbor::", "orca::", "wire::"];
const TESTED_OF_SAMPLE: [&str; 6] =
    ["agent::", "laws::formation::", "laws::waypoint::", "neighbor::", "orca::", "safety::"];
/// Long simulations and random bytes, which take most of the time: the other tests must suffice.
const SKIPPED: [&str; 2] = ["simulation", "tests::nonsense"];
/// Tests that take most of the rest of the time.
const SKIPPED_OF_SAMPLE: [&str; 8] = [
    "a_working_robot_is_not",
    "an_expired_stop_does_not",
    "any_law",
    "false_maps_cost_time",
    "land::",
    "radio_outages",
    "robots_with_one_goal",
    "with_other_numbering",
];
/// Without optimisation a mutant compiles in a fifth of the time; its tests need more stack.
const ENVIRONMENT: [(&str, &str); 5] = [
    ("CARGO_PROFILE_DEV_INCREMENTAL", "true"),
    ("CARGO_PROFILE_DEV_OPT_LEVEL", "0"),
    ("PROPTEST_CASES", "64"),
    ("PROPTEST_RNG_SEED", "1"),
    ("RUST_MIN_STACK", "16000000"),
];
/// Other crates are compiled once, so they are optimised. Only the nightly test harness ends at the
/// first test that fails; `RUSTC_BOOTSTRAP` enables that when tests run, not when they compile.
const CONFIG: [&str; 2] = [
    "--cargo-arg=--config=profile.dev.package.\"*\".opt-level=2",
    "--cargo-arg=--config=target.'cfg(all())'.runner=['env','RUSTC_BOOTSTRAP=1']",
];

/// The mutants to plant; by default a shard.
#[derive(Default, clap::Args)]
pub struct Options {
    /// Every N-th one from the K-th on
    #[arg(long, value_name = "K/N", conflicts_with = "sample")]
    shard: Option<String>,
    /// N random ones of the modules that keep robots apart: 95 % must be noticed
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// The seed of the sample
    #[arg(long, value_name = "S", default_value_t = 1, requires = "sample")]
    seed: u64,
    /// None of this file; may be repeated
    #[arg(long, value_name = "PATH")]
    exclude: Vec<String>,
}

/// Plants mutants, one at a time, and counts those that the tests notice.
pub fn run(s: &mut Session, options: &Options) {
    let name = match (options.sample, &options.shard) {
        (Some(count), _) => format!("mutants, {count} of seed {}", options.seed),
        (None, shard) => format!("mutants, shard {}", shard.as_deref().unwrap_or(SHARD)),
    };
    s.report.part(&name, || planted(&s.repo, options));
}

fn planted(repo: &Repo, options: &Options) -> Result<(Counts, String)> {
    let folder = repo.target.join("mutants");
    let (sources, output) = (folder.join("sources"), folder.join("mutants.out"));
    let program = program(repo)?;
    // An interrupted run leaves no mutant behind.
    repo.copy(&sources, |_, bytes| bytes)?;
    let command = |line: &str| {
        let mut mutants = repo.command(&program);
        mutants.words("mutants --package staya-controller --colors never").words(line).current_dir(&sources);
        mutants.args(options.exclude.iter().flat_map(|path| ["--exclude", path]));
        mutants
    };
    let mut mutants = command("--in-place --features host --cargo-arg=--lib");
    mutants.args(CONFIG).words("--timeout-multiplier 5 --minimum-test-timeout 60").arg("--output").arg(&folder);
    if output.is_dir() {
        std::fs::remove_dir_all(&output).with_context(|| format!("cannot remove {}", output.display()))?;
    }
    let tests = ["--", "--", "-Zunstable-options", "--fail-fast"];
    let least = if let Some(count) = options.sample {
        let list = output_of(&mut command("--list")).context("cargo mutants --list fails")?;
        let accepted = accepted(&files::read(&repo.root.join(".cargo/mutants.toml"))?)?;
        // The others count as noticed by an earlier run. Names are exact; `--re` passes mutants
        // that delete a field whatever it says.
        files::write(&output.join("caught.txt"), not_chosen(&list, &accepted, count, options.seed))?;
        mutants.arg("--iterate").args(tests).args(TESTED_OF_SAMPLE);
        mutants.args(SKIPPED_OF_SAMPLE.iter().flat_map(|name| ["--skip", name]));
        CAUGHT_OF_SAMPLE
    } else {
        let shard = options.shard.as_deref().unwrap_or(SHARD);
        mutants.words("--sharding round-robin --shard").arg(shard).args(tests).args(TESTED);
        CAUGHT
    };
    mutants.args(SKIPPED.iter().flat_map(|name| ["--skip", name]));
    mutants.env("CARGO_TARGET_DIR", folder.join("target")).envs(ENVIRONMENT);
    // A survivor is not an error here: the share decides.
    let ended = execute(&mut mutants);
    let outcomes = files::read(&output.join("outcomes.json"));
    judged(&outcomes.map_err(|error| ended.err().map_or(error, |reason| reason.context("cargo mutants")))?, least)
}

/// The accepted survivors. `cargo-mutants` does not compare them with mutants that delete a field.
fn accepted(config: &str) -> Result<regex::RegexSet> {
    let config: toml::Table = toml::from_str(config)?;
    let rows = config.get("exclude_re").and_then(toml::Value::as_array).context("no exclude_re in mutants.toml")?;
    Ok(regex::RegexSet::new(rows.iter().filter_map(toml::Value::as_str))?)
}

/// The names of a list, one per line, without a random sample of those in [`SAMPLED`].
fn not_chosen(list: &str, accepted: &regex::RegexSet, count: usize, seed: u64) -> String {
    let is_candidate = |name: &&str| SAMPLED.iter().any(|path| name.starts_with(path)) && !accepted.is_match(name);
    let candidates = list.lines().filter(is_candidate);
    let mut drawn: Vec<_> = (0_u64..).zip(candidates).map(|(at, name)| (mixed(seed ^ mixed(at)), name)).collect();
    drawn.sort_unstable();
    let chosen: std::collections::BTreeSet<&str> = drawn.iter().take(count).map(|(_, name)| *name).collect();
    list.lines().filter(|name| !chosen.contains(name)).flat_map(|name| [name, "\n"]).collect()
}

/// A number of the generator SplitMix64.
const fn mixed(state: u64) -> u64 {
    let z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// `cargo-mutants`, compiled once.
fn program(repo: &Repo) -> Result<PathBuf> {
    let folder = repo.target.join("tools/cargo-mutants");
    let program = folder.join("bin/cargo-mutants");
    if !program.is_file() {
        execute(repo.cargo("install --quiet --locked cargo-mutants@27.1.0 --root").arg(&folder))?;
    }
    Ok(program)
}

/// One failure if the tests notice too few.
fn judged(outcomes: &str, least: u64) -> Result<(Counts, String)> {
    let outcomes: serde_json::Value = serde_json::from_str(outcomes)?;
    let count = |field: &str| outcomes[field].as_u64().with_context(|| format!("outcomes.json has no number {field}"));
    let (caught, missed, unviable) = (count("caught")? + count("timeout")?, count("missed")?, count("unviable")?);
    let viable = caught + missed;
    let failed = u64::from(viable == 0 || caught * 100 < viable * least);
    let note = format!("{caught} of {viable} noticed (at least {least} %), {unviable} did not compile");
    Ok((Counts { passed: caught, failed, skipped: 0 }, note))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn too_many_survivors_are_one_failure() {
        let of = |caught: u64, missed: u64, timeout: u64| {
            let text = json!({ "caught": caught, "missed": missed, "timeout": timeout, "unviable": 3, "x": [1] });
            judged(&text.to_string(), 50).map(|(counts, _)| (counts.passed, counts.failed)).expect("sound")
        };
        assert_eq!(of(9, 10, 1), (10, 0));
        assert_eq!(of(9, 11, 0), (9, 1));
        assert_eq!(of(0, 0, 0), (0, 1), "nothing was planted");
        assert!(judged("{}", 50).is_err());
    }

    #[test]
    fn a_sample_is_drawn_by_its_seed_from_modules_that_keep_robots_apart() {
        let all: Vec<String> =
            (0..500).map(|n| format!("controller/src/orca/plane.rs:{n}:1: replace + with -")).collect();
        let other = "controller/src/wire/ring.rs:1:1: replace + with -";
        let list = format!("{}\n{other}\n", all.join("\n"));
        let accepted = accepted("exclude_re = [\"plane.rs:7:\"]").expect("sound");
        let chosen = |count, seed| {
            let rest = not_chosen(&list, &accepted, count, seed);
            assert!(rest.contains(other) && rest.contains(&all[7]));
            all.iter().filter(|name| !rest.lines().any(|line| line == *name)).cloned().collect::<Vec<_>>()
        };
        let sample = chosen(50, 55);
        assert_eq!((sample.len(), &chosen(50, 55)), (50, &sample));
        assert_ne!(chosen(50, 56), sample);
        assert!(chosen(20, 55).iter().all(|name| sample.contains(name)), "a smaller one is a part of it");
        assert_eq!(chosen(1000, 55).len(), 499);
        assert_eq!(mixed(0), 0xE220_A839_7B1D_CDAF, "the first number of the published generator");
    }
}
