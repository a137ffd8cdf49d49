//! `cargo xtask check`: everything that can be said without running the code.

use crate::repo::{Repo, output_of};
use crate::report::Report;

/// Formatting, layers, lints, documentation; the quick ones first.
pub fn run(repo: &Repo, report: &mut Report) {
    let peers = repo.root.join("tests/peers/Cargo.toml");
    let peers = peers.display().to_string();
    if has(repo, "fmt", "rustfmt", report) {
        report.command("formatting", repo.cargo(&["fmt", "--all", "--check"]));
        report.command(
            "formatting of tests/peers",
            repo.cargo(&["fmt", "--all", "--check", "--manifest-path", &peers]),
        );
    }
    report.step("layers of the controller", || {
        crate::layers::check(&repo.root.join("controller/src"))
    });
    if has(repo, "clippy", "clippy", report) {
        let deny = ["--", "-D", "warnings"];
        let clippy =
            |arguments: &[&str]| repo.cargo(&[&["clippy", "--locked"], arguments, &deny].concat());
        report.command("clippy", clippy(&["--workspace", "--all-targets"]));
        report.command(
            "clippy with defmt",
            clippy(&["--workspace", "--features", "staya-controller/defmt"]),
        );
        report.command(
            "clippy of tests/peers",
            repo.cargo_in(
                "tests/peers",
                &[&["clippy", "--locked", "--all-targets"], deny.as_slice()].concat(),
            ),
        );
    }
    let mut doc = repo.cargo(&["doc", "--locked", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    report.command("rustdoc", doc);
}

/// Whether a component of the toolchain is there; records a skipped part otherwise.
fn has(repo: &Repo, subcommand: &str, component: &str, report: &mut Report) -> bool {
    let found = output_of(&mut repo.cargo(&[subcommand, "--version"])).is_some();
    if !found {
        let reason = format!("not installed; run `rustup component add {component}`");
        report.skip(component, &reason);
    }
    found
}
