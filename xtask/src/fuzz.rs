//! `cargo xtask fuzz`: a fuzzer looks for bytes that break what must hold for any bytes.

use crate::files;
use crate::repo::Repo;
use crate::session::Session;
use std::process::Command;

const FOLDER: &str = "tests/fuzz";
/// How long each target runs unless the command line says otherwise; libFuzzer takes 0 for ever.
const SECONDS: &str = "60";

/// Requirements of the fuzzer: a command that shows each, and the remedy without it.
const NEEDS: [(&str, &str); 3] = [
    ("rustup run nightly cargo --version", "no nightly Rust; run `rustup toolchain install nightly`"),
    ("rustup run nightly cargo fuzz --version", "no cargo-fuzz; run `cargo install cargo-fuzz`"),
    ("c++ --version", "no C++ compiler, which libFuzzer needs; on Debian run, as root, `apt-get install g++`"),
];

/// Targets whose bytes are choices, not words to be guessed, in code without `unsafe`: what the
/// fuzzer otherwise follows (each comparison, each access to memory) finds nothing there and takes
/// nine tenths of the time.
const STORIES: [&str; 1] = ["messages_model"];

/// Runs each target for some seconds. New inputs stay in `tests/fuzz/corpus`, those that break
/// something in `tests/fuzz/artifacts`.
pub fn run(s: &mut Session, seconds: Option<&str>) {
    let missing = NEEDS.iter().find(|(question, _)| !s.repo.says(question));
    let targets = files::entries(&s.repo.root.join(FOLDER).join("fuzz_targets"));
    let Some(targets) = s.report.need("fuzz targets", targets) else { return };
    for target in targets.iter().map(|file| files::stem(file)) {
        match missing {
            None => drop(s.report.command(&target, fuzz(&s.repo, &target, seconds.unwrap_or(SECONDS)))),
            Some((_, reason)) => s.report.skip(&target, reason),
        }
    }
}

fn fuzz(repo: &Repo, target: &str, seconds: &str) -> Command {
    let mut command = repo.command("rustup");
    command
        .args(["run", "nightly", "cargo", "fuzz", "run", "--fuzz-dir", FOLDER])
        .args(if STORIES.contains(&target) { &["--sanitizer", "none", "--no-trace-compares"][..] } else { &[] })
        .args([target, "--"])
        .arg(format!("-max_total_time={seconds}"))
        // Stories need some length from the start; one that takes longer than 10 s is a fault.
        .args(["-len_control=0", "-max_len=512", "-timeout=10"])
        .env("CARGO_TARGET_DIR", &repo.target);
    command
}
