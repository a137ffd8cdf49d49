//! `cargo xtask check`: everything that can be said without running the code.

use crate::device::FeatureChecks;
use crate::repo::{Repo, output_of};
use crate::report::Report;

/// Workspaces of their own, and how to leave out what needs more than a stable compiler.
const OTHERS: [(&str, &[&str]); 2] = [("tests/peers", &[]), ("tests/fuzz", &["--no-default-features"])];

/// What a user's own firmware depends on.
const PACKAGES: [&str; 4] = ["staya-controller", "staya-mavlink", "staya-robot", "staya-voxel"];

/// Formatting, layers, lints, documentation; the quick ones first, and beside the lints what has folders of its own.
pub fn run(repo: &Repo, report: &mut Report) {
    if has(repo, "fmt", "rustfmt", report) {
        let check = ["fmt", "--all", "--check"];
        report.command("formatting", repo.cargo(&check));
        let others = OTHERS.map(|(folder, _)| folder);
        for folder in others.into_iter().chain([crate::example::FOLDER]) {
            let name = format!("formatting of {folder}");
            report.command(&name, repo.cargo_in(folder, &check));
        }
    }
    report.step("layers of the controller", || crate::layers::check(&repo.root.join("controller/src")));
    report.step("no circles between modules", || crate::circles::check(&repo.root));
    report.step(crate::weight::SHARED, || crate::weight::check_shared(repo));
    report.step("no log that panics", || crate::plants::check_logs(&repo.root));
    crate::minimal::check(repo, report);
    report.step("what the documentation names", || crate::documents::check(&repo.root));
    let feature_checks = FeatureChecks::begin(repo);
    if has(repo, "clippy", "clippy", report) {
        let deny = ["--", "-D", "warnings"];
        let arguments = |arguments: &[&'static str]| [&["clippy", "--locked"], arguments, &deny].concat();
        let own = ["--workspace", "--all-targets", "--features", crate::python_package::FEATURE];
        let mut clippy = repo.cargo(&arguments(&own));
        clippy.envs(crate::python_package::WITHOUT_PYTHON);
        report.command("clippy", clippy);
        let packages = PACKAGES.iter().flat_map(|name| ["--package", name]);
        let defmt: Vec<_> = packages.chain(["--features", "staya-controller/defmt"]).collect();
        report.command("clippy with defmt", repo.cargo(&arguments(&defmt)));
        for (folder, features) in OTHERS {
            let clippy = arguments(&[&["--all-targets"], features].concat());
            let name = format!("clippy of {folder}");
            report.command(&name, repo.cargo_in(folder, &clippy));
        }
    }
    let bare = ["clippy", "--locked", "--package", "staya-c", "--no-default-features", "--", "-D", "warnings"];
    report.command("clippy of the library for C without features", repo.cargo(&bare));
    let mut package = repo.cargo(&["package", "--locked", "--allow-dirty", "--no-verify"]);
    package.args(PACKAGES.iter().flat_map(|name| ["--package", name]));
    report.command("packages that users depend on", package);
    let mut doc = repo.cargo(&["doc", "--locked", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    report.command("rustdoc", doc);
    feature_checks.end(report);
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
