//! `cargo xtask fuzz`: a fuzzer looks for bytes that break what must hold for any bytes.

use crate::prelude::*;
use std::num::NonZeroU64;

const FOLDER: &str = "tests/fuzz";

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

/// Runs each target for some seconds; libFuzzer takes 0 for ever. New inputs stay in
/// `tests/fuzz/corpus`, those that break something in `tests/fuzz/artifacts`.
pub fn run(s: &mut Session, seconds: NonZeroU64) {
    let mut targets = Vec::new();
    s.report.step("requirements of the fuzzer", || {
        let missing = NEEDS.iter().find(|(question, _)| !s.repo.says(question));
        missing.map_or(Ok(()), |(_, remedy)| Err(skipped(*remedy)))?;
        targets = files::entries(&s.repo.root.join(FOLDER).join("fuzz_targets"))?;
        Ok(())
    });
    for target in targets.iter().map(|file| files::stem(file)) {
        s.report.command(&target, &mut fuzz(&s.repo, &target, seconds));
    }
}

fn fuzz(repo: &Repo, target: &str, seconds: NonZeroU64) -> Command {
    let mut fuzz = repo.command("rustup");
    fuzz.words("run nightly cargo fuzz run --fuzz-dir").arg(FOLDER);
    fuzz.words(if STORIES.contains(&target) { "--sanitizer none --no-trace-compares" } else { "" });
    // Stories need some length from the start; one that takes longer than 10 s is a fault.
    fuzz.arg(target).words("-- -len_control=0 -max_len=512 -timeout=10").arg(format!("-max_total_time={seconds}"));
    fuzz.env("CARGO_TARGET_DIR", &repo.target);
    fuzz
}
