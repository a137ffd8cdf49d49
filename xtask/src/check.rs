//! `cargo xtask check`: everything that can be said without running the code.

use crate::device::{PARTS, Part};
use crate::prelude::*;
use crate::python::{FEATURE, WITHOUT_PYTHON};
use crate::repo::ended;
use crate::session::{folders, packages};
use crate::{documents, firmware, language, modules, plants, weight};
use serde_json::Value;
use std::thread::{JoinHandle, spawn};

/// Workspaces of their own, and how to leave out what needs more than a stable compiler.
const OTHERS: [(&str, &str); 2] = [("tests/peers", ""), ("tests/fuzz", "--no-default-features")];

/// Packages that a user's own firmware depends on.
const PACKAGES: &str = "--package staya-controller --package staya-mavlink --package staya-robot --package staya-voxel";

/// Formatting, layers, lints, documentation; the quick ones first, and beside the lints what has
/// folders of its own.
pub fn run(s: &mut Session) {
    for folder in ["", OTHERS[0].0, OTHERS[1].0, firmware::EXAMPLE] {
        cargo(s, &named("formatting", folder), folder, "fmt --all --check");
    }
    let root = s.repo.root.clone();
    s.report.step("layers of the controller", || modules::check_layers(&root.join("controller/src")));
    s.report.step("no circles between modules", || modules::check_circles(&folders(&s.repo)?));
    s.report.step(weight::SHARED, || weight::check_shared(&s.repo));
    s.report.step("no log that panics", || plants::check_logs(&root));
    s.report.step("the declared minimal Rust", || compiles_by_the_oldest_rust(&s.repo));
    s.report.step("references of the documentation", || documents::check(&root));
    s.report.step("language", || language::check(&root));
    let feature_checks = begin_feature_checks(s);
    cargo(s, "clippy", "", &format!("clippy --locked --workspace --all-targets --features {FEATURE} -- -D warnings"));
    let defmt = format!("clippy --locked {PACKAGES} --features staya-controller/defmt -- -D warnings");
    cargo(s, "clippy with defmt", "", &defmt);
    for (folder, features) in OTHERS {
        let line = format!("clippy --locked --all-targets {features} -- -D warnings");
        cargo(s, &named("clippy", folder), folder, &line);
    }
    let bare = "clippy --locked --package staya-c --no-default-features -- -D warnings";
    cargo(s, "clippy of the library for C without features", "", bare);
    let package = format!("package --locked --allow-dirty --no-verify {PACKAGES}");
    cargo(s, "packages that users depend on", "", &package);
    cargo(s, "rustdoc", "", "doc --locked --workspace --no-deps");
    for (name, check) in feature_checks {
        s.report.step(&name, || check?.join().map_err(|_| anyhow!("the check panicked"))?);
    }
}

fn named(step: &str, folder: &str) -> String {
    if folder.is_empty() { step.to_string() } else { format!("{step} of {folder}") }
}

/// A step of cargo in a folder; skipped without the component of the toolchain that it needs.
fn cargo(s: &mut Session, name: &str, folder: &str, line: &str) {
    s.report.step(name, || {
        for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
            let is_there = || output_of(&mut s.repo.cargo(&format!("{subcommand} --version"))).is_some();
            if line.starts_with(subcommand) && !is_there() {
                return Err(skipped(format!("not installed; run `rustup component add {component}`")));
            }
        }
        execute(s.repo.cargo_in(folder, line).envs(WITHOUT_PYTHON).env("RUSTDOCFLAGS", "-D warnings"))
    });
}

/// The oldest Rust that the workspace declares (`rust-version`) compiles it. If the toolchain here
/// is that Rust, all that is compiled shows it; else rustup's of that version has to check the
/// workspace.
fn compiles_by_the_oldest_rust(repo: &Repo) -> Result<()> {
    const DECLARED: &str = env!("CARGO_PKG_RUST_VERSION");
    let here = repo.answer("rustc --version").unwrap_or_default();
    if here.starts_with(concat!("rustc ", env!("CARGO_PKG_RUST_VERSION"), ".")) {
        println!("{here} compiles everything here");
        return Ok(());
    }
    let remedy = format!("run `rustup toolchain install {DECLARED}`, or declare another rust-version in Cargo.toml");
    ensure!(repo.says(&format!("rustup run {DECLARED} rustc --version")), skipped(format!("this is {here}; {remedy}")));
    let mut check = repo.command("rustup");
    check.args(["run", DECLARED, "cargo", "check", "--locked", "--workspace", "--target-dir"]);
    execute(check.arg(repo.target.join("minimal")))
}

/// Checks of the controller for a part with each set of features that its manifest lists: the name
/// of the step, and the thread that runs it while other steps run, or why none does.
type FeatureCheck = (String, Result<JoinHandle<Result<()>>>);

/// Begins them, one thread a part: the compiler has one thread for one crate. The part with a
/// Cortex-M0 has no FPU and takes the sets with fixed point.
fn begin_feature_checks(s: &mut Session) -> Vec<FeatureCheck> {
    let sets = feature_sets(&s.repo);
    let mut check = |part: &Part| {
        let has_fpu = part.target.ends_with("hf");
        let fits = |features: &&String| has_fpu || features.split(',').any(|feature| feature == "fixed");
        let toolchain = s.toolchains.find(&s.repo, part.target)?;
        // Cargo lets one command at a time into a folder.
        let folder = toolchain.target_folder(&s.repo).join("sets").join(part.target);
        let sets = sets.as_ref().map_err(|error| anyhow!("{error}"))?;
        let commands = sets.iter().filter(fits).map(|features| {
            // Quiet, because other steps run beside it.
            let line = "check --locked --quiet --package staya-controller --no-default-features --features";
            let mut check = toolchain.cargo(&s.repo, part.target, line);
            check.arg(features).env("CARGO_TARGET_DIR", &folder).env("RUSTFLAGS", "-Dwarnings");
            (features.clone(), check)
        });
        let mut commands: Vec<_> = commands.collect();
        let run =
            move || commands.iter_mut().try_for_each(|(set, check)| ended(check.status()).context(format!("`{set}`")));
        Ok(spawn(run))
    };
    let parts = PARTS.iter().filter(|part| part.target.starts_with("thumb"));
    let named = |part: &Part| format!("feature sets of the controller for {}", part.target);
    parts.map(|part| (named(part), check(part))).collect()
}

/// The list `feature-sets` in the metadata of the controller's manifest.
fn feature_sets(repo: &Repo) -> Result<Vec<String>> {
    let packages = packages(repo)?;
    let controller = packages.iter().find(|package| package["name"] == "staya-controller");
    let sets = controller.and_then(|package| package["metadata"]["staya"]["feature-sets"].as_array());
    let sets = sets.context("controller/Cargo.toml has no list package.metadata.staya.feature-sets")?;
    Ok(sets.iter().filter_map(Value::as_str).map(String::from).collect())
}
