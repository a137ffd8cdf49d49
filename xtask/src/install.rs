//! `cargo xtask install`: the program, the firmware that it runs on emulated parts and boards, the
//! figures of papers, its manual and what shells complete it by.

use crate::device::PARTS;
use crate::files;
use crate::firmware::{self, Profile};
use crate::options::Options;
use crate::repo::{Repo, run};
use crate::session::{MAIN, Session, programs};
use std::fs;
use std::path::Path;

/// The command. Firmware for a part that no toolchain here builds is skipped, and was not there
/// before.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    let home = std::env::var_os("HOME").map(|home| Path::new(&home).join(".local"));
    let prefix = options.value("--prefix").and_then(|folder| std::path::absolute(folder).ok()).or(home);
    let prefix = prefix.ok_or_else(|| String::from("there is no HOME to install into: give --prefix DIR"));
    let Some(prefix) = s.report.need("install", prefix) else { return };
    for part in &PARTS {
        firmware::build(s, part, Profile::Firmware, &["lockstep"]);
    }
    let profile = if options.has("--debug") { "debug" } else { "release" };
    if s.staya(profile).is_ok() {
        put_step(s, &prefix, profile);
    }
}

/// Copies what was built before to below the prefix, as one step; whether it is there.
pub fn put_step(s: &mut Session, prefix: &Path, profile: &str) -> bool {
    s.report.step(&format!("installed in {}", prefix.display()), || put(&s.repo, prefix, profile))
}

fn put(repo: &Repo, prefix: &Path, profile: &str) -> Result<(), String> {
    for (_, name) in programs(repo)? {
        let program = repo.program(profile, name);
        // Tests do not build each program.
        if name == MAIN || program.is_file() {
            files::copy(&program, &prefix.join("bin").join(files::name(&program)))?;
        }
    }
    for part in &PARTS {
        let elf = Profile::Firmware.elf(repo, part, "lockstep");
        let to = prefix.join("share/staya/firmware").join(part.name).join("lockstep");
        if elf.is_file() {
            files::copy(&elf, &to)?;
        } else if to.is_file() {
            // It would be of another version than the program.
            fs::remove_file(&to).map_err(|error| format!("{}: {error}", to.display()))?;
        }
    }
    put_figures(repo, &prefix.join("share/staya"))?;
    let program = prefix.join("bin").join(files::name(&repo.program(profile, MAIN)));
    let mut shell = repo.cargo(&["run", "--quiet", "--locked", "--package", "staya-shell"]);
    run(shell.args((profile == "release").then_some("--release")).arg("--").arg(prefix))?;
    println!("{}; is {} in PATH?", program.display(), prefix.join("bin").display());
    Ok(())
}

/// Copies the data of figures, and the maps that they name. Removes those of another version.
fn put_figures(repo: &Repo, share: &Path) -> Result<(), String> {
    for folder in ["papers", "maps"] {
        files::remove(&share.join(folder))?;
        let source = repo.root.join(folder);
        let is_data = |path: &Path| path != source.join("src") && files::name(path) != "Cargo.toml";
        for file in files::below(&source, &is_data)? {
            let name = file.strip_prefix(&repo.root).map_err(|error| error.to_string())?;
            files::copy(&file, &share.join(name))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_installed_without_the_code_beside_them() {
        let repo = Repo::find();
        let share = repo.target.join("tmp/installed-figures");
        put_figures(&repo, &share).expect("a folder to write to");
        assert!(share.join("papers/orca/swap/figure.toml").is_file());
        assert!(!share.join("papers/src").exists() && !share.join("papers/Cargo.toml").exists());
        files::remove(&share).expect("removed");
    }
}
