//! The session of a command: the repository, the report, toolchains, and the programs once they
//! are built.

use crate::device::{Toolchain, Toolchains};
use crate::repo::{Repo, output_of};
use crate::report::Report;
use std::path::PathBuf;

/// The program of the README's first command.
pub const MAIN: &str = "staya";
/// Programs that it hands over to; those that the workspace does not have are left out.
const OTHERS: [&str; 5] = ["staya-lab", "staya-view", "staya-mav", "staya-hil", "staya-voxel"];

/// The session of a command.
pub struct Session {
    pub repo: Repo,
    pub report: Report,
    pub toolchains: Toolchains,
    /// Profiles of which the programs were built, and whether they could be.
    pub built: Vec<(&'static str, bool)>,
}

impl Session {
    pub fn new() -> Self {
        let (repo, report) = (Repo::find(), Report::new());
        Self { repo, report, toolchains: Toolchains::default(), built: Vec::new() }
    }

    /// `staya` of a profile, `debug` or `release`, in a folder with the programs that it hands over
    /// to. Builds them unless that was done before; none if they cannot be built.
    pub fn staya(&mut self, profile: &'static str) -> Option<PathBuf> {
        let before = self.built.iter().find(|(known, _)| *known == profile).map(|(_, is_built)| *is_built);
        let is_built = before.unwrap_or_else(|| {
            let is_built = self.report.step(&format!("staya, {profile}"), || {
                let mut build = self.repo.cargo(&["build", "--locked"]);
                for (package, program) in programs(&self.repo)? {
                    build.args(["--package", &package, "--bin", program]);
                }
                build.args((profile == "release").then_some("--release"));
                crate::repo::run(&mut build)
            });
            self.built.push((profile, is_built));
            is_built
        });
        is_built.then(|| self.repo.program(profile, MAIN))
    }

    /// A step that compiles for a target; skipped without a toolchain for it. Returns whether it
    /// succeeded.
    pub fn with_toolchain(
        &mut self,
        name: &str,
        target: &str,
        work: impl FnOnce(&Repo, &Toolchain) -> Result<(), String>,
    ) -> bool {
        let toolchain = self.toolchains.find(&self.repo, target);
        self.report.step_with(name, toolchain, |toolchain| work(&self.repo, &toolchain))
    }
}

/// The programs of the workspace that users start, each with the package that it is in.
pub fn programs(repo: &Repo) -> Result<Vec<(String, &'static str)>, String> {
    let metadata = output_of(&mut repo.cargo(&["metadata", "--no-deps", "--format-version", "1", "--locked"]));
    let metadata = serde_json::from_str(&metadata.ok_or("cargo metadata fails")?);
    let metadata: serde_json::Value = metadata.map_err(|error| format!("cargo metadata: {error}"))?;
    let packages = || metadata["packages"].as_array().into_iter().flatten();
    let find = |program: &'static str| {
        let is_it = |target: &serde_json::Value| target["name"] == program && target["kind"][0] == "bin";
        let package =
            packages().find(|package| package["targets"].as_array().is_some_and(|all| all.iter().any(is_it)))?;
        Some((package["name"].as_str()?.to_string(), program))
    };
    Ok(std::iter::once(MAIN).chain(OTHERS).filter_map(find).collect())
}
