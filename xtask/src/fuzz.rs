//! `cargo xtask fuzz`: a fuzzer looks for bytes that break what must hold for any bytes.

use crate::repo::{Repo, output_of};
use crate::report::Report;
use std::fs;
use std::process::Command;

const FOLDER: &str = "tests/fuzz";
/// How long each target runs unless the command line says otherwise; libFuzzer takes 0 for ever.
pub const SECONDS: &str = "60";

/// What the fuzzer needs: the question whether it is there, and what to do if not.
const NEEDS: [(&[&str], &str); 3] = [
    (&["rustup", "run", "nightly", "cargo", "--version"], "no nightly Rust; run `rustup toolchain install nightly`"),
    (&["rustup", "run", "nightly", "cargo", "fuzz", "--version"], "no cargo-fuzz; run `cargo install cargo-fuzz`"),
    (&["c++", "--version"], "no C++ compiler, which libFuzzer needs; on Debian run, as root, `apt-get install g++`"),
];

/// Targets whose bytes are choices and no words to be guessed, in code without `unsafe`: what the fuzzer otherwise follows (each comparison, each
/// access to memory) finds nothing there and takes nine tenths of the time.
const STORIES: [&str; 1] = ["requests_model"];

/// Runs each target for some seconds. New inputs stay in `tests/fuzz/corpus`, those that break
/// something in `tests/fuzz/artifacts`.
pub fn run(repo: &Repo, report: &mut Report, seconds: &str) {
    let missing = NEEDS.iter().find(|(question, _)| {
        let [program, arguments @ ..] = *question else {
            return false;
        };
        output_of(repo.command(program).args(arguments)).is_none()
    });
    let targets = targets(repo);
    if targets.is_empty() {
        report.step("fuzz targets", || Err(format!("none in {FOLDER}")));
    }
    for target in targets {
        match missing {
            None => {
                report.command(&target, fuzz(repo, &target, seconds));
            }
            Some((_, reason)) => report.skip(&target, reason),
        }
    }
}

/// The names of the targets, sorted.
fn targets(repo: &Repo) -> Vec<String> {
    let folder = repo.root.join(FOLDER).join("fuzz_targets");
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = files
        .filter_map(|file| {
            let name = file.file_name().into_string().ok()?;
            name.strip_suffix(".rs").map(String::from)
        })
        .collect();
    names.sort();
    names
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
