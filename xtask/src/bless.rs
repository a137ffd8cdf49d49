//! `cargo xtask bless`: rewrite golden files.

use crate::prelude::*;
use crate::repo::BLESS;

/// Runs the tests whose name contains `name` with the variable that makes them write, runs them
/// again without it, and lists what changed.
pub fn run(s: &mut Session, name: &str) {
    let tests = || s.repo.cargo(&format!("test --workspace --no-fail-fast {name}"));
    s.report.step("rewrite golden files", || execute(tests().env(BLESS, "1")));
    s.report.command("compare again", &mut tests());
    match output_of(s.repo.command("git").args(["status", "--short", "--", "*golden*"])) {
        Some(changed) if changed.is_empty() => println!("\nNo golden file changed."),
        Some(changed) => {
            println!("\nGolden files that differ from the last commit; look at each, and commit them apart:");
            println!("{changed}");
        }
        None => println!("\nNo git here: see for yourself which golden files changed."),
    }
}
