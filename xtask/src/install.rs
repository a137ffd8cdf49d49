//! `cargo xtask install`: the program, the firmware that it runs on emulated parts and boards, its manual and what shells complete it by.

use crate::device::Toolchains;
use crate::firmware::{Profile, build_some};
use crate::part::PARTS;
use crate::repo::{Repo, run};
use crate::report::Report;
use std::fs;
use std::path::{Path, PathBuf};

/// What `cargo xtask install` is asked for.
pub struct Request {
    /// The folder that gets `bin` and `share`.
    prefix: PathBuf,
    /// Whether the program is as tests build it: sooner there, and slower.
    is_debug: bool,
}

impl Request {
    /// Reads the command line: `[--debug] [--prefix DIR]`. The error says what is wrong with it.
    pub fn read(arguments: &[&str]) -> Result<Self, String> {
        let (mut prefix, mut is_debug) = (None, false);
        let mut arguments = arguments.iter().copied();
        while let Some(argument) = arguments.next() {
            match argument {
                "--debug" => is_debug = true,
                "--prefix" => prefix = Some(arguments.next().ok_or("--prefix needs a folder")?),
                other => return Err(format!("install takes --prefix DIR and --debug, not `{other}`")),
            }
        }
        let prefix = match prefix {
            Some(folder) => std::path::absolute(folder).map_err(|error| format!("--prefix {folder}: {error}"))?,
            None => {
                let home = std::env::var_os("HOME").ok_or("there is no HOME to install into: give --prefix DIR")?;
                Path::new(&home).join(".local")
            }
        };
        Ok(Self { prefix, is_debug })
    }

    /// The same into this folder, with the program that tests have built.
    pub const fn of_tests(prefix: PathBuf) -> Self {
        Self { prefix, is_debug: true }
    }
}

/// Where completions of a shell are looked for below a prefix.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "share/bash-completion/completions/staya"),
    ("zsh", "share/zsh/site-functions/_staya"),
    ("fish", "share/fish/vendor_completions.d/staya.fish"),
];

/// The command. Firmware for a part that no toolchain here builds is skipped, and was not there before.
pub fn run_command(repo: &Repo, report: &mut Report, request: &Request) {
    let mut toolchains = Toolchains::default();
    for part in &PARTS {
        build_some(repo, report, &mut toolchains, part, Profile::Firmware, &["lockstep"]);
    }
    let profile = if request.is_debug { "dev" } else { "release" };
    let name = format!("the program, by the profile {profile}");
    let build = repo.cargo(&["build", "--locked", "--package", "staya", "--profile", profile]);
    if report.command(&name, build) {
        put_step(repo, report, request);
    }
}

/// Copies what was built before to below the prefix, as one step; whether it is there.
pub fn put_step(repo: &Repo, report: &mut Report, request: &Request) -> bool {
    report.step(&format!("installed in {}", request.prefix.display()), || put(repo, request))
}

fn put(repo: &Repo, Request { prefix, is_debug }: &Request) -> Result<(), String> {
    let folder = if *is_debug { "debug" } else { "release" };
    let name = format!("staya{}", std::env::consts::EXE_SUFFIX);
    let program = prefix.join("bin").join(&name);
    copy(&repo.target.join(folder).join(&name), &program)?;
    for part in &PARTS {
        let elf = Profile::Firmware.elf(repo, part, "lockstep");
        let to = prefix.join("share/staya/firmware").join(part.name).join("lockstep");
        if elf.is_file() {
            copy(&elf, &to)?;
        } else if to.is_file() {
            // It would be of another version than the program.
            fs::remove_file(&to).map_err(|error| format!("{}: {error}", to.display()))?;
        }
    }
    run(repo.command(&program).arg("man").arg(prefix.join("share/man/man1")))?;
    for (shell, file) in COMPLETIONS {
        let output = repo.command(&program).args(["completions", shell]).output();
        let output = output.map_err(|error| format!("{}: {error}", program.display()))?;
        if !output.status.success() {
            return Err(format!("`staya completions {shell}` failed"));
        }
        write(&prefix.join(file), &output.stdout)?;
    }
    println!("{}; is {} in PATH?", program.display(), prefix.join("bin").display());
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let made = || {
        fs::create_dir_all(to.parent().unwrap_or(to))?;
        // A program that runs cannot be written to, but another one can take its name.
        let beside = to.with_extension("new");
        fs::copy(from, &beside)?;
        fs::rename(&beside, to)
    };
    made().map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}

fn write(to: &Path, bytes: &[u8]) -> Result<(), String> {
    let made = || {
        fs::create_dir_all(to.parent().unwrap_or(to))?;
        fs::write(to, bytes)
    };
    made().map_err(|error| format!("{}: {error}", to.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prefix_is_given_or_the_users_own() {
        let request = Request::read(&["--debug", "--prefix", "/opt/staya"]).unwrap();
        assert_eq!((request.prefix, request.is_debug), (PathBuf::from("/opt/staya"), true));
        for (wrong, why) in [(&["--prefix"][..], "needs a folder"), (&["/opt"], "`/opt`")] {
            assert!(Request::read(wrong).err().unwrap().contains(why));
        }
    }
}
