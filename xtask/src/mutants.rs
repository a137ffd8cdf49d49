//! `cargo xtask mutants`: changes that the tests of the controller must notice.
//!
//! `cargo-mutants` plants them in a copy of the sources. `.cargo/mutants.toml` lists the modules,
//! and the survivors that are accepted, each with its reason.

use crate::prelude::*;

/// The share that `cargo xtask test --all` plants: some 23 of 4,500, in a minute and a half per
/// ten on two processors.
pub const SHARD: &str = "0/200";
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
pub fn run(s: &mut Session, shard: &str) {
    s.report.part(&format!("mutants, shard {shard}"), || planted(&s.repo, shard));
}

fn planted(repo: &Repo, shard: &str) -> Result<(Counts, String)> {
    let folder = repo.target.join("mutants");
    let program = program(repo)?;
    let sources = folder.join("sources");
    // An interrupted run leaves no mutant behind.
    repo.copy(&sources, |_, bytes| bytes)?;
    let mut mutants = repo.command(program);
    mutants.words("mutants --in-place --package staya-controller --features host --cargo-arg=--lib");
    mutants.words("--sharding round-robin --colors never --timeout-multiplier 5 --minimum-test-timeout 60");
    mutants.args(["--shard", shard, "--output"]).arg(&folder).args(["--", "--"]).args(TESTED);
    mutants.args(SKIPPED.iter().flat_map(|name| ["--skip", name]));
    mutants.current_dir(sources).env("CARGO_TARGET_DIR", folder.join("target")).envs(ENVIRONMENT);
    // A survivor is not an error here: the share decides.
    let ended = execute(&mut mutants);
    let outcomes = files::read(&folder.join("mutants.out/outcomes.json"));
    judged(&outcomes.map_err(|error| ended.err().map_or(error, |reason| reason.context("cargo mutants")))?)
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
fn judged(outcomes: &str) -> Result<(Counts, String)> {
    let outcomes: serde_json::Value = serde_json::from_str(outcomes)?;
    let count = |field: &str| outcomes[field].as_u64().with_context(|| format!("outcomes.json has no number {field}"));
    let (caught, missed, unviable) = (count("caught")? + count("timeout")?, count("missed")?, count("unviable")?);
    let viable = caught + missed;
    let failed = u64::from(viable == 0 || caught * 100 < viable * CAUGHT);
    let note = format!("{caught} of {viable} noticed (at least {CAUGHT} %), {unviable} did not compile");
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
            judged(&text.to_string()).map(|(counts, _)| (counts.passed, counts.failed)).expect("sound")
        };
        assert_eq!(of(9, 10, 1), (10, 0));
        assert_eq!(of(9, 11, 0), (9, 1));
        assert_eq!(of(0, 0, 0), (0, 1), "nothing was planted");
        assert!(judged("{}").is_err());
    }
}
