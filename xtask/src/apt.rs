//! Programs from Debian's packages, unpacked into `target/tools` and run from there.
//!
//! That needs no root and changes no installed package. A package of the user's can exclude another
//! one: the `qemu-utils` of backports excludes Debian's emulators. Only Python, and tshark for
//! root, do not work from another folder and are installed, as root.

use crate::repo::{Repo, ended};
use crate::report::skipped;
use anyhow::{Context as _, Result, ensure};

/// Programs, and Debian's packages of them; all are words of a line.
pub struct Tools {
    pub packages: &'static str,
    pub programs: &'static str,
    /// A command of the shell that succeeds if all of them start.
    pub question: &'static str,
    /// The ways to get the packages, in the order in which they are tried: `unpack` them with all
    /// that they need and this machine lacks, or `install` them as root, if no installed package
    /// has to go or change for it.
    pub ways: &'static str,
}

impl Tools {
    /// Makes sure that the programs start, and gets the packages if they do not. A part that needs
    /// them is skipped otherwise; the error names the remedy.
    pub fn prepare(&self, repo: &Repo) -> Result<()> {
        if repo.says(self.question) {
            return Ok(());
        }
        let mut reason = String::new();
        for way in self.ways.split(' ') {
            match self.get(repo, way) {
                Ok(()) => return Ok(()),
                Err(error) => reason = format!("{error:#}"),
            }
        }
        let Self { packages, programs, .. } = self;
        let remedy = format!("on Debian run, as root, `apt-get update && apt-get install {packages}`");
        Err(skipped(format!("no {programs} ({reason}); {remedy}")))
    }

    fn get(&self, repo: &Repo, way: &str) -> Result<()> {
        ensure!(repo.says("apt-get --version"), "no apt-get here");
        println!("apt: {way} {}", self.packages);
        let mut shell = repo.command("sh");
        shell.args(["-c", include_str!("apt.sh"), "apt.sh", way]).arg(repo.target.join("tools"));
        ended(shell.args([self.packages, self.programs]).status()).context("apt, see above")?;
        ensure!(repo.says(self.question), "it does not start");
        Ok(())
    }
}
