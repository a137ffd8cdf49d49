//! Programs from Debian's packages, unpacked into `target/tools` and run from there.
//!
//! That needs no root and changes no installed package. A package of the user's can exclude another
//! one: the `qemu-utils` of backports excludes Debian's emulators. Only Python, and tshark for
//! root, do not work from another folder and are installed, as root.

use crate::repo::{Repo, ended, output_of};
use std::path::PathBuf;

/// Programs, and Debian's packages of them.
pub struct Tools {
    pub packages: &'static [&'static str],
    pub programs: &'static [&'static str],
}

impl Tools {
    /// Makes sure that `starts` says so: unpacks the packages if it does not. The error names the
    /// remedy.
    pub fn prepare(&self, repo: &Repo, starts: impl Fn() -> bool) -> Result<(), String> {
        if starts() {
            return Ok(());
        }
        let failed = |reason: String| {
            let packages = self.packages.join(" ");
            format!(
                "no {} ({reason}); on Debian run, as root, `apt-get update && apt-get install {packages}`",
                self.programs.join(", ")
            )
        };
        self.unpack(repo).map_err(failed)?;
        if starts() { Ok(()) } else { Err(failed(String::from("it does not start"))) }
    }

    /// Unpacks the packages, with all that they need and this machine lacks.
    pub fn unpack(&self, repo: &Repo) -> Result<(), String> {
        script(repo, "unpack", self.packages, self.programs)
    }

    /// Installs the packages, as root, if no installed package has to go or change for it.
    pub fn install(&self, repo: &Repo) -> Result<(), String> {
        script(repo, "install", self.packages, &[])
    }
}

fn script(repo: &Repo, work: &str, packages: &[&str], programs: &[&str]) -> Result<(), String> {
    if output_of(repo.command("apt-get").arg("--version")).is_none() {
        return Err(String::from("no apt-get here"));
    }
    println!("apt: {work} {}", packages.join(" "));
    let mut shell = repo.command("sh");
    shell.args(["-c", include_str!("apt.sh"), "apt.sh", work]).arg(repo.target.join("tools"));
    let status = shell.arg(packages.join(" ")).arg(programs.join(" ")).status();
    ended(status).map_err(|reason| format!("apt: {reason}, see above"))
}

/// A folder by this name among the libraries that were unpacked.
pub fn unpacked(repo: &Repo, name: &str) -> Option<PathBuf> {
    let root = repo.target.join("tools/unpacked");
    let mut find = repo.command("find");
    find.args([root.join("usr/lib"), root.join("lib")]).args([
        "-maxdepth",
        "2",
        "-type",
        "d",
        "-path",
        "*-linux-*",
        "-name",
        name,
    ]);
    // `find` fails if one of both folders is not there.
    let found = find.output().ok()?.stdout;
    String::from_utf8_lossy(&found).lines().next().map(PathBuf::from)
}
