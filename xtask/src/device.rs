//! The controller built for microcontrollers, with whatever toolchain there is.

use crate::debian;
use crate::repo::{Repo, output_of};
use crate::report::Report;
use std::path::Path;
use std::process::Command;

/// Cortex-M4F and Cortex-M0: with and without an FPU, with and without compare-and-swap.
const TARGETS: [&str; 2] = ["thumbv7em-none-eabihf", "thumbv6m-none-eabi"];

/// Where `core` for a microcontroller comes from.
enum Toolchain {
    /// The toolchain that runs this program has the target.
    Own,
    /// Debian's packages build it from source.
    Debian,
}

/// Builds the controller for each target, plain and with every feature.
pub fn run(repo: &Repo, report: &mut Report) {
    // Debian's packages are looked for (and installed) once, and only if a target needs them.
    let mut debian = None;
    for target in TARGETS {
        let toolchain = if has_target(repo, target) {
            Ok(Toolchain::Own)
        } else {
            let ready = debian.get_or_insert_with(|| debian::prepare(repo));
            ready.clone().map(|()| Toolchain::Debian)
        };
        for features in ["", "defmt"] {
            let mut name = format!("controller for {target}");
            if !features.is_empty() {
                name = format!("{name}, {features}");
            }
            match &toolchain {
                Ok(toolchain) => {
                    report.command(&name, toolchain.build(repo, target, features));
                }
                Err(reason) => report.skip(&name, reason),
            }
        }
    }
}

impl Toolchain {
    /// A release build of the controller: code for generic functions and constants is only made
    /// (and can only fail) in a build, not in a check.
    fn build(&self, repo: &Repo, target: &str, features: &str) -> Command {
        let mut command = match self {
            Self::Own => repo.cargo(&["build"]),
            Self::Debian => debian::cargo(repo, &["build", "-Zbuild-std=core"]),
        };
        command.args(["--locked", "--release", "--package", "staya-controller"]);
        command.args(["--target", target, "--features", features]);
        command
    }
}

/// Whether the toolchain that runs this program ships `core` for a target.
fn has_target(repo: &Repo, target: &str) -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut question = repo.command(rustc);
    question.args(["--print", "target-libdir", "--target", target]);
    output_of(&mut question).is_some_and(|folder| Path::new(&folder).is_dir())
}
