//! The session of a command: the repository, the report, toolchains, and the programs once they
//! are built.

use crate::device::{Toolchain, Toolchains};
use crate::repo::{Repo, output_of};
use crate::report::{Report, skipped};
use anyhow::{Context as _, Result};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The program of the README's first command.
pub const MAIN: &str = "staya";
/// It and the programs that it hands over to, each behind its package.
pub const PROGRAMS: [(&str, &str); 6] = [
    (MAIN, MAIN),
    ("staya-lab", "staya-lab"),
    ("staya-view", "staya-view"),
    ("staya-mav", "staya-mav"),
    ("staya-hil", "staya-hil"),
    ("staya-fvm", "staya-voxel"),
];

/// The session of a command.
pub struct Session {
    pub repo: Repo,
    pub report: Report,
    pub toolchains: Toolchains,
    /// Profiles of which the programs were built, and whether they could be.
    built: BTreeMap<&'static str, bool>,
}

impl Session {
    pub fn new() -> Self {
        let (repo, report) = (Repo::find(), Report::new());
        Self { repo, report, toolchains: Toolchains::default(), built: BTreeMap::new() }
    }

    /// `staya` of a profile, `debug` or `release`, in a folder with the programs that it hands over
    /// to. Builds them unless that was done before. Parts that need them are skipped if that fails.
    pub fn staya(&mut self, profile: &'static str) -> Result<PathBuf> {
        let mut build = self.repo.cargo("build --locked");
        build.args(PROGRAMS.iter().flat_map(|(package, program)| ["--package", package, "--bin", program]));
        build.args((profile == "release").then_some("--release"));
        let build = || self.report.command(&format!("staya, {profile}"), &mut build);
        let is_built = *self.built.entry(profile).or_insert_with(build);
        is_built.then(|| self.repo.program(profile, MAIN)).ok_or_else(|| skipped("the program was not built"))
    }

    /// A step that compiles for a target; skipped without a toolchain for it. Returns whether it
    /// succeeded.
    pub fn with_toolchain(
        &mut self,
        name: &str,
        target: &str,
        work: impl FnOnce(&Repo, &Toolchain) -> Result<()>,
    ) -> bool {
        self.report.step(name, || work(&self.repo, &self.toolchains.find(&self.repo, target)?))
    }
}

/// The packages of the workspace, as `cargo metadata` tells them.
pub fn packages(repo: &Repo) -> Result<Vec<Value>> {
    let metadata = output_of(&mut repo.cargo("metadata --no-deps --format-version 1 --locked"));
    let mut metadata: Value = serde_json::from_str(&metadata.context("cargo metadata fails")?)?;
    Ok(metadata["packages"].as_array_mut().map(std::mem::take).unwrap_or_default())
}

/// The folders of the workspace's packages.
pub fn folders(repo: &Repo) -> Result<Vec<PathBuf>> {
    let packages = packages(repo)?;
    let manifests = packages.iter().filter_map(|package| Path::new(package["manifest_path"].as_str()?).parent());
    Ok(manifests.map(Path::to_path_buf).collect())
}
