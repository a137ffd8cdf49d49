//! Helpers shared by the cross-crate tests.

pub mod mutants;
pub mod scenes;
mod story;

pub use story::gaps;

use staya_sim::engine::{Outcome, simulate};
use staya_sim::record::{RobotRow, TickRow};
use staya_sim::scenario::{Overrides, Scenario};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const BLESS: &str = "STAYA_BLESS";

/// The repository's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The program `staya` in the profile of this test.
///
/// # Panics
/// If it has not been built: cargo builds no program of another package for a test.
#[must_use]
pub fn program() -> PathBuf {
    let own = std::env::current_exe().expect("a test knows its file");
    let folder = own.ancestors().nth(2).expect("a target folder");
    let program = folder.join(format!("staya{}", std::env::consts::EXE_SUFFIX));
    assert!(program.is_file(), "{} is missing; `cargo build --workspace` builds it", program.display());
    program
}

/// A scenario of `scenarios/` by its name, with at most `ticks` ticks.
///
/// # Panics
/// If it cannot be read.
#[must_use]
pub fn scenario(name: &str, ticks: Option<u32>) -> Scenario {
    let path = root().join("scenarios").join(format!("{name}.toml"));
    let overrides = Overrides { seed: None, ticks };
    Scenario::load(&path, &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The outcome of a run, and the swarm and its robots at the start and after each tick.
///
/// # Panics
/// If the scenario's robots cannot be placed.
#[must_use]
pub fn run(scenario: &Scenario) -> (Outcome, Vec<(TickRow, Vec<RobotRow>)>) {
    let mut rows = Vec::new();
    let outcome = simulate(scenario, |moment, robots| {
        rows.push((*moment.row, robots.collect()));
        ControlFlow::Continue(())
    });
    let outcome = outcome.unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
    (outcome, rows)
}

/// Compares `actual` with the file `tests/golden/<name>.txt`, or writes it for `cargo xtask bless`.
/// `gaps` are the parts of the story that the run lacks ([`gaps`]); the file names each of them
/// with its reason.
///
/// # Panics
/// If they differ, a gap has no reason or a reason no gap, or the file cannot be read or written.
pub fn golden(name: &str, actual: &str, gaps: &[String]) {
    printed(&format!("tests/golden/{name}.txt"), &format!("{actual}{}", story::exceptions(name, gaps)));
}

/// Like [`printed`], for the part `part` of a page between its marks.
///
/// # Panics
/// See [`printed`]; also if the page lacks the marks.
pub fn printed_part(page: &str, part: &str, actual: &str) {
    let path = root().join(page);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let begin = format!("<!-- {part}: written by cargo xtask bless -->\n");
    let parts = text.split_once(&begin).and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let (before, after) = parts.unwrap_or_else(|| panic!("{page} needs the lines {begin}and {END}"));
    printed(page, &format!("{before}{begin}\n{actual}\n{END}{after}"));
}

/// The end of a part of a page that is printed.
pub const END: &str = "<!-- end -->\n";

/// Compares `actual` with the file `name` of the repository, or writes it for `cargo xtask bless`.
///
/// # Panics
/// If they differ, or the file cannot be read or written.
pub fn printed(name: &str, actual: &str) {
    let path = root().join(name);
    if std::env::var_os(BLESS).is_some() {
        fs::write(&path, actual).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        return;
    }
    let wanted = fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; `cargo xtask bless` writes it", path.display()));
    let first = wanted.lines().zip(actual.lines()).position(|(wanted, actual)| wanted != actual);
    let at = first.unwrap_or(wanted.lines().count().min(actual.lines().count()));
    assert!(
        wanted == actual,
        "{name} differs in line {}\nwanted: {}\n   got: {}\nif the change is meant: cargo xtask bless golden",
        at + 1,
        wanted.lines().nth(at).unwrap_or("(end)"),
        actual.lines().nth(at).unwrap_or("(end)"),
    );
}
