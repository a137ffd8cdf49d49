//! `cargo xtask bless`: rewrite golden files.

use crate::repo::{self, BLESS, Repo, output_of};
use crate::report::Report;

/// Runs the tests whose name contains `name` with the variable that makes them write, runs them
/// again without it, and lists what changed.
pub fn run(repo: &Repo, report: &mut Report, name: &str) {
    let tests = || repo.cargo(&["test", "--workspace", "--no-fail-fast", name]);
    report.step("rewrite golden files", || repo::run(tests().env(BLESS, "1")));
    report.command("compare again", tests());
    let status = ["status", "--short", "--", "*golden*"];
    match output_of(repo.command("git").args(status)) {
        Some(changed) if changed.is_empty() => println!("\nNo golden file changed."),
        Some(changed) => {
            println!("\nGolden files that differ from the last commit; look at each, and commit them apart:");
            println!("{changed}");
        }
        None => println!("\nNo git here: see for yourself which golden files changed."),
    }
}
