//! `cargo xtask check`: everything that can be said without running the code.

use crate::device::FeatureChecks;
use crate::firmware;
use crate::python;
use crate::repo::output_of;
use crate::session::Session;

/// Workspaces of their own, and how to leave out what needs more than a stable compiler.
const OTHERS: [(&str, &[&str]); 2] = [("tests/peers", &[]), ("tests/fuzz", &["--no-default-features"])];

/// Packages that a user's own firmware depends on.
const PACKAGES: [&str; 4] = ["staya-controller", "staya-mavlink", "staya-robot", "staya-voxel"];

/// Formatting, layers, lints, documentation; the quick ones first, and beside the lints what has
/// folders of its own.
pub fn run(s: &mut Session) {
    if has(s, "fmt", "rustfmt") {
        let check = ["fmt", "--all", "--check"];
        s.report.command("formatting", s.repo.cargo(&check));
        let others = OTHERS.map(|(folder, _)| folder);
        for folder in others.into_iter().chain([firmware::EXAMPLE]) {
            let name = format!("formatting of {folder}");
            s.report.command(&name, s.repo.cargo_in(folder, &check));
        }
    }
    s.report.step("layers of the controller", || crate::layers::check(&s.repo.root.join("controller/src")));
    s.report.step("no circles between modules", || crate::circles::check(&s.repo.root));
    s.report.step(crate::weight::SHARED, || crate::weight::check_shared(&s.repo));
    s.report.step("no log that panics", || crate::plants::check_logs(&s.repo.root));
    crate::minimal::check(s);
    s.report.step("what the documentation names", || crate::documents::check(&s.repo.root));
    let feature_checks = FeatureChecks::begin(&s.repo);
    if has(s, "clippy", "clippy") {
        let deny = ["--", "-D", "warnings"];
        let arguments = |arguments: &[&'static str]| [&["clippy", "--locked"], arguments, &deny].concat();
        let own = ["--workspace", "--all-targets", "--features", python::FEATURE];
        let mut clippy = s.repo.cargo(&arguments(&own));
        clippy.envs(python::WITHOUT_PYTHON);
        s.report.command("clippy", clippy);
        let packages = PACKAGES.iter().flat_map(|name| ["--package", name]);
        let defmt: Vec<_> = packages.chain(["--features", "staya-controller/defmt"]).collect();
        s.report.command("clippy with defmt", s.repo.cargo(&arguments(&defmt)));
        for (folder, features) in OTHERS {
            let clippy = arguments(&[&["--all-targets"], features].concat());
            let name = format!("clippy of {folder}");
            s.report.command(&name, s.repo.cargo_in(folder, &clippy));
        }
    }
    let bare = ["clippy", "--locked", "--package", "staya-c", "--no-default-features", "--", "-D", "warnings"];
    s.report.command("clippy of the library for C without features", s.repo.cargo(&bare));
    let mut package = s.repo.cargo(&["package", "--locked", "--allow-dirty", "--no-verify"]);
    package.args(PACKAGES.iter().flat_map(|name| ["--package", name]));
    s.report.command("packages that users depend on", package);
    let mut doc = s.repo.cargo(&["doc", "--locked", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    s.report.command("rustdoc", doc);
    feature_checks.end(&mut s.report);
}

/// Whether a component of the toolchain is there; records a skipped part otherwise.
fn has(s: &mut Session, subcommand: &str, component: &str) -> bool {
    let found = output_of(&mut s.repo.cargo(&[subcommand, "--version"])).is_some();
    if !found {
        let reason = format!("not installed; run `rustup component add {component}`");
        s.report.skip(component, &reason);
    }
    found
}
