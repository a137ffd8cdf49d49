//! `cargo xtask check`: everything that can be said without running the code.

use crate::device::{PARTS, Part};
use crate::firmware;
use crate::modules;
use crate::python;
use crate::repo::{Repo, ended, output_of};
use crate::session::{Session, folders, packages};
use serde_json::Value;
use std::thread::JoinHandle;

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
    let controller = s.repo.root.join("controller/src");
    s.report.step("layers of the controller", || modules::check_layers(&controller));
    s.report.step_with("no circles between modules", folders(&s.repo), |crates| modules::check_circles(&crates));
    s.report.step(crate::weight::SHARED, || crate::weight::check_shared(&s.repo));
    s.report.step("no log that panics", || crate::plants::check_logs(&s.repo.root));
    crate::minimal::check(s);
    s.report.step("references of the documentation", || crate::documents::check(&s.repo.root));
    s.report.step("language", || crate::language::check(&s.repo.root));
    let feature_checks = begin_feature_checks(s);
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
    end_feature_checks(s, feature_checks);
}

/// Whether a component of the toolchain is there; records a skipped part otherwise.
fn has(s: &mut Session, subcommand: &str, component: &str) -> bool {
    let found = output_of(&mut s.repo.cargo(&[subcommand, "--version"]));
    s.report.need(component, found.ok_or(format!("not installed; run `rustup component add {component}`"))).is_some()
}

/// Checks of the controller for a part with each set of features that its manifest lists: the name
/// of the step, and the thread that runs it while other steps run, or why none does.
type FeatureCheck = (String, Result<JoinHandle<Result<(), String>>, String>);

/// Begins them, one thread a part: the compiler has one thread for one crate. The part with a
/// Cortex-M0 has no FPU and takes the sets with fixed point.
fn begin_feature_checks(s: &mut Session) -> Vec<FeatureCheck> {
    let mut sets = Vec::new();
    s.report.step("list of the controller's feature sets", || {
        sets = feature_sets(&s.repo)?;
        Ok(())
    });
    let parts = PARTS.iter().filter(|part| part.target.starts_with("thumb"));
    let mut check = |part: &Part| {
        let has_fpu = part.target.ends_with("hf");
        let fits = |features: &&String| has_fpu || features.split(',').any(|feature| feature == "fixed");
        let toolchain = s.toolchains.find(&s.repo, part.target)?;
        // Cargo lets one command at a time into a folder.
        let folder = toolchain.target_folder(&s.repo).join("sets").join(part.target);
        let commands = sets.iter().filter(fits).map(|features| {
            let mut check = toolchain.cargo(&s.repo, part.target, "check");
            // Quiet, because other steps run beside it.
            check.args(["--locked", "--quiet", "--package", "staya-controller", "--no-default-features"]);
            check.args(["--features", features]).env("CARGO_TARGET_DIR", &folder).env("RUSTFLAGS", "-Dwarnings");
            (features.clone(), check)
        });
        let mut commands: Vec<_> = commands.collect();
        Ok(std::thread::spawn(move || {
            let mut checks = commands.iter_mut();
            checks.try_for_each(|(set, check)| ended(check.status()).map_err(|reason| format!("`{set}`: {reason}")))
        }))
    };
    let named = |part: &Part| format!("feature sets of the controller for {}", part.target);
    parts.map(|part| (named(part), check(part))).collect()
}

/// Waits for them: one step a part.
fn end_feature_checks(s: &mut Session, checks: Vec<FeatureCheck>) {
    for (name, check) in checks {
        let join = |check: JoinHandle<_>| check.join().unwrap_or_else(|_| Err(String::from("the check panicked")));
        s.report.step_with(&name, check, join);
    }
}

/// The list `feature-sets` in the metadata of the controller's manifest, and the set without any
/// feature.
fn feature_sets(repo: &Repo) -> Result<Vec<String>, String> {
    let packages = packages(repo)?;
    let controller = packages.iter().find(|package| package["name"] == "staya-controller");
    let sets = controller.and_then(|package| package["metadata"]["staya"]["feature-sets"].as_array());
    let sets = sets.ok_or("controller/Cargo.toml has no list package.metadata.staya.feature-sets")?;
    let mut names: Vec<&str> = std::iter::once("").chain(sets.iter().filter_map(Value::as_str)).collect();
    names.dedup();
    Ok(names.into_iter().map(String::from).collect())
}
