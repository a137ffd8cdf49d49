//! `cargo xtask mutants`: changes that the tests of the controller must notice.
//!
//! `cargo-mutants` plants them in a copy of the sources. `.cargo/mutants.toml` lists the modules,
//! and the survivors that are accepted, each with its reason.

use crate::files;
use crate::repo::{Repo, run};
use crate::report::{Counts, failure};
use crate::session::Session;
use std::path::PathBuf;

/// The share that `cargo xtask test --all` plants: some 23 of 4,500, in a minute and a half per
/// ten on two processors.
const SHARD: &str = "0/200";
/// Least share of viable mutants that the tests notice, percent. 95 is wanted.
const CAUGHT: u64 = 50;
/// Long simulations and random bytes, which take most of the time: the other tests must suffice.
const SKIPPED: [&str; 2] = ["simulation", "tests::nonsense"];
const TESTED: [&str; 6] = ["agent::", "auth::", "laws::cells::", "neighbor::", "orca::", "wire::"];
/// Without optimisation a mutant compiles in a fifth of the time; its tests need more stack.
const ENVIRONMENT: [(&str, &str); 5] = [
    ("CARGO_PROFILE_DEV_INCREMENTAL", "true"),
    ("CARGO_PROFILE_DEV_OPT_LEVEL", "0"),
    ("PROPTEST_CASES", "64"),
    ("PROPTEST_RNG_SEED", "1"),
    ("RUST_MIN_STACK", "16000000"),
];

/// Plants the mutants of a shard, `K/N`: every N-th one from the K-th on.
pub fn run_shard(s: &mut Session, shard: Option<&str>) {
    let shard = shard.unwrap_or(SHARD);
    let name = format!("mutants, shard {shard}");
    let repo = &s.repo;
    s.report.part(&name, || planted(repo, shard).unwrap_or_else(failure));
}

fn planted(repo: &Repo, shard: &str) -> Result<(Counts, String), String> {
    let folder = repo.target.join("mutants");
    let program = program(repo)?;
    let sources = folder.join("sources");
    // An interrupted run leaves no mutant behind.
    repo.copy(&sources, |_, bytes| bytes)?;
    let mut command = repo.command(program);
    command
        .args(["mutants", "--in-place", "--package", "staya-controller", "--features", "host"])
        .args(["--cargo-arg=--lib", "--sharding", "round-robin", "--shard", shard, "--colors", "never"])
        .args(["--timeout-multiplier", "5", "--minimum-test-timeout", "60", "--output"])
        .arg(&folder)
        .args(["--", "--"])
        .args(TESTED)
        .args(SKIPPED.iter().flat_map(|name| ["--skip", name]))
        .current_dir(sources)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .envs(ENVIRONMENT);
    // A survivor is not an error here: the share decides.
    let ended = run(&mut command);
    let outcomes = files::read(&folder.join("mutants.out/outcomes.json")).map_err(|error| match &ended {
        Err(reason) => format!("cargo mutants: {reason}"),
        Ok(()) => error,
    })?;
    judged(&outcomes)
}

/// `cargo-mutants`, compiled once.
fn program(repo: &Repo) -> Result<PathBuf, String> {
    let folder = repo.target.join("tools/cargo-mutants");
    let program = folder.join("bin/cargo-mutants");
    if !program.is_file() {
        run(repo.cargo(&["install", "--quiet", "--locked", "cargo-mutants@27.1.0", "--root"]).arg(&folder))?;
    }
    Ok(program)
}

/// One failure if the tests notice too few.
fn judged(outcomes: &str) -> Result<(Counts, String), String> {
    let outcomes: serde_json::Value = serde_json::from_str(outcomes).map_err(|error| error.to_string())?;
    let count = |field: &str| outcomes[field].as_u64().ok_or_else(|| format!("outcomes.json has no number {field}"));
    let (caught, missed, unviable) = (count("caught")? + count("timeout")?, count("missed")?, count("unviable")?);
    let viable = caught + missed;
    let failed = u64::from(viable == 0 || caught * 100 < viable * CAUGHT);
    let note = format!("{caught} of {viable} noticed (at least {CAUGHT} %), {unviable} did not compile");
    Ok((Counts { passed: caught, failed, skipped: 0 }, note))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_survivors_are_one_failure() {
        let of = |caught, missed, timeout| {
            let text = format!(
                "{{\"caught\": {caught}, \"missed\": {missed}, \"timeout\": {timeout}, \"unviable\": 3, \"x\": [1]}}"
            );
            judged(&text).map(|(counts, _)| (counts.passed, counts.failed))
        };
        assert_eq!(of(9, 10, 1), Ok((10, 0)));
        assert_eq!(of(9, 11, 0), Ok((9, 1)));
        assert_eq!(of(0, 0, 0), Ok((0, 1)), "nothing was planted");
        assert!(judged("{}").is_err());
    }
}
