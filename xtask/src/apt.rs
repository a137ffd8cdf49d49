//! Programs from Debian's packages, unpacked into `target/tools` and run from there.
//!
//! That needs no root and changes no installed package. A package of the user's can exclude another
//! one: the `qemu-utils` of backports excludes Debian's emulators. Only Python, and tshark for
//! root, do not work from another folder and are installed, as root.

use crate::repo::{Repo, ended};

/// Programs, and Debian's packages of them.
pub struct Tools {
    pub packages: &'static [&'static str],
    pub programs: &'static [&'static str],
    /// A command of the shell that succeeds if all of them start.
    pub question: &'static str,
}

impl Tools {
    /// Makes sure that the programs start: unpacks the packages if they do not. The error names
    /// the remedy.
    pub fn prepare(&self, repo: &Repo) -> Result<(), String> {
        self.prepare_with(repo, Self::unpack)
    }

    /// The same by another way to get the packages.
    pub fn prepare_with(&self, repo: &Repo, get: fn(&Self, &Repo) -> Result<(), String>) -> Result<(), String> {
        if repo.says(self.question) {
            return Ok(());
        }
        let starts = || if repo.says(self.question) { Ok(()) } else { Err(String::from("it does not start")) };
        get(self, repo).and_then(|()| starts()).map_err(|reason| {
            let (packages, programs) = (self.packages.join(" "), self.programs.join(", "));
            format!("no {programs} ({reason}); on Debian run, as root, `apt-get update && apt-get install {packages}`")
        })
    }

    /// Unpacks the packages, with all that they need and this machine lacks.
    pub fn unpack(&self, repo: &Repo) -> Result<(), String> {
        self.script(repo, "unpack")
    }

    /// Installs the packages, as root, if no installed package has to go or change for it.
    pub fn install(&self, repo: &Repo) -> Result<(), String> {
        self.script(repo, "install")
    }

    fn script(&self, repo: &Repo, work: &str) -> Result<(), String> {
        if !repo.says("apt-get --version") {
            return Err(String::from("no apt-get here"));
        }
        let packages = self.packages.join(" ");
        println!("apt: {work} {packages}");
        let mut shell = repo.command("sh");
        shell.args(["-c", include_str!("apt.sh"), "apt.sh", work]).arg(repo.target.join("tools"));
        let status = shell.args([packages, self.programs.join(" ")]).status();
        ended(status).map_err(|reason| format!("apt: {reason}, see above"))
    }
}
