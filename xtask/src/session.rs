//! The session of a command: the repository, the report, toolchains, and the programs once they
//! are built.

use crate::device::{Toolchain, Toolchains};
use crate::repo::{Repo, output_of};
use crate::report::Report;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The program of the README's first command.
pub const MAIN: &str = "staya";
/// It and the programs that it hands over to; those that the workspace does not have are left out.
const PROGRAMS: [&str; 6] = [MAIN, "staya-lab", "staya-view", "staya-mav", "staya-hil", "staya-voxel"];

/// The session of a command.
pub struct Session {
    pub repo: Repo,
    pub report: Report,
    pub toolchains: Toolchains,
    /// Profiles of which the programs were built, and whether they could be.
    built: Vec<(&'static str, bool)>,
}

impl Session {
    pub fn new() -> Self {
        let (repo, report) = (Repo::find(), Report::new());
        Self { repo, report, toolchains: Toolchains::default(), built: Vec::new() }
    }

    /// `staya` of a profile, `debug` or `release`, in a folder with the programs that it hands over
    /// to. Builds them unless that was done before; the error says that they cannot be built.
    pub fn staya(&mut self, profile: &'static str) -> Result<PathBuf, String> {
        if !self.built.iter().any(|(known, _)| *known == profile) {
            let is_built = self.report.step(&format!("staya, {profile}"), || {
                let mut build = self.repo.cargo(&["build", "--locked"]);
                for (package, program) in programs(&self.repo)? {
                    build.args(["--package", &package, "--bin", program]);
                }
                crate::repo::run(build.args((profile == "release").then_some("--release")))
            });
            self.built.push((profile, is_built));
        }
        let is_built = self.built.contains(&(profile, true));
        is_built.then(|| self.repo.program(profile, MAIN)).ok_or_else(|| String::from("the program was not built"))
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

/// The packages of the workspace, as `cargo metadata` tells them.
pub fn packages(repo: &Repo) -> Result<Vec<Value>, String> {
    let metadata = output_of(&mut repo.cargo(&["metadata", "--no-deps", "--format-version", "1", "--locked"]));
    let metadata: Result<Value, _> = serde_json::from_str(&metadata.ok_or("cargo metadata fails")?);
    let packages = metadata.map_err(|error| format!("cargo metadata: {error}"))?["packages"].take();
    Ok(packages.as_array().cloned().unwrap_or_default())
}

/// The folders of the workspace's packages.
pub fn folders(repo: &Repo) -> Result<Vec<PathBuf>, String> {
    let manifests =
        packages(repo)?.into_iter().filter_map(|package| Some(package["manifest_path"].as_str()?.to_owned()));
    Ok(manifests.filter_map(|manifest| Some(Path::new(&manifest).parent()?.to_path_buf())).collect())
}

/// The programs of the workspace that users start, each with the package that it is in.
pub fn programs(repo: &Repo) -> Result<Vec<(String, &'static str)>, String> {
    let packages = packages(repo)?;
    let find = |program: &'static str| {
        let is_it = |target: &Value| target["name"] == program && target["kind"][0] == "bin";
        let has_it = |package: &&Value| package["targets"].as_array().is_some_and(|all| all.iter().any(is_it));
        Some((packages.iter().find(has_it)?["name"].as_str()?.to_string(), program))
    };
    Ok(PROGRAMS.into_iter().filter_map(find).collect())
}
