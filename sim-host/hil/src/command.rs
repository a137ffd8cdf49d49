//! `staya hil SCENARIO`: what `staya-hil` does, also by the program of a crate with a guidance law of its own.

use crate::run::HilArgs;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use staya_console::{Ended, Global};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
///
/// The other robots run in this process. For every robot on a device a shadow runs here too: the first step at which both differ
/// by a bit ends the run and is printed. Exit code 1 if that happens, or a device falls silent.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  staya hil scenarios/six-robots.toml --device qemu:stm32f405 --devices 4\n  \
    staya hil scenarios/swap-circle.toml --device qemu:stm32f405 --device qemu:microbit --devices 6\n  \
    staya hil scenarios/six-robots.toml --device serial:/dev/ttyACM0,baud=115200 --real-time\n  \
    staya hil examples/own_part/patrol.toml --crate examples/own_part --device qemu:stm32f405 --devices 4")]
pub struct HilCommand {
    #[command(flatten)]
    hil: HilArgs,
    /// Robots go by the guidance law of the crate in this folder: its program is built, and does the same with these arguments
    /// (docs/project.md says how to write one).
    #[arg(long = "crate", value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl HilCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// Those of [`HilArgs::run`]; a crate that does not build or whose program fails.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.folder {
            Some(folder) => run_crate(folder),
            None => self.hil.run(global),
        }
    }
}

/// Hands this command line on to the program of a crate; what is wrong it says itself.
fn run_crate(folder: &Path) -> Result<Ended> {
    let manifest = folder.join("Cargo.toml");
    if !manifest.is_file() {
        bail!("--crate {}: there is no Cargo.toml; docs/project.md says what such a crate has", folder.display());
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["run", "--release", "--quiet", "--manifest-path"]).arg(manifest).arg("--");
    command.args(handed_on(std::env::args_os().skip(1)));
    let status = command.status().context("cannot start cargo, which builds the crate")?;
    match status.code() {
        Some(0) => Ok(Ended::Done),
        Some(130) => Ok(Ended::Interrupted),
        _ => bail!("the program of {} failed ({status})", folder.display()),
    }
}

/// The same arguments for a program that is nothing else than `staya hil`.
fn handed_on(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let (mut handed_on, mut is_named, mut is_folder) = (Vec::new(), false, false);
    for argument in arguments {
        if std::mem::take(&mut is_folder) {
            continue;
        }
        if !is_named && argument == "hil" {
            is_named = true;
        } else if argument == "--crate" {
            is_folder = true;
        } else if !argument.to_str().is_some_and(|text| text.starts_with("--crate=")) {
            handed_on.push(argument);
        }
    }
    handed_on
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_gets_all_arguments_but_its_own_name() {
        let line = |text: &str| {
            let words = handed_on(text.split(' ').map(OsString::from)).into_iter();
            words.map(|word| word.into_string().expect("text")).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(line("hil hil --crate here --device qemu:riscv32"), "hil --device qemu:riscv32");
        assert_eq!(line("--json hil s.toml --crate=here -q"), "--json s.toml -q");
    }
}
