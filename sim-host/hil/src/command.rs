use crate::run::HilArgs;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use staya_console::{Ended, Global};
use staya_sim::shown::Shown as _;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
///
/// The other robots run in this process. Each robot on a device also has a shadow here: the run
/// ends at the first step whose results differ in any bit, and prints that step. Exit code 1 if a
/// step differs or a device stops answering.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  staya hil scenarios/six-robots.toml --device qemu:stm32f405 --devices 4\n  \
    staya hil scenarios/swap-circle.toml --device qemu:stm32f405 --device qemu:microbit --devices 6\n  \
    staya hil scenarios/six-robots.toml --device serial:/dev/ttyACM0,baud=115200 --real-time\n  \
    staya hil examples/own_part/patrol.toml --crate examples/own_part --device qemu:stm32f405 --devices 4")]
pub struct HilCommand {
    #[command(flatten)]
    hil: HilArgs,
    /// Use the guidance law of the crate in this folder: builds its program and runs it with these
    /// arguments (see docs/project.md).
    #[arg(long = "crate", value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl HilCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the run, or the crate cannot be built.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.folder {
            Some(folder) => run_crate(folder),
            None => self.hil.run(global),
        }
    }
}

/// The program of the crate reports its own errors.
fn run_crate(folder: &Path) -> Result<Ended> {
    let manifest = folder.join("Cargo.toml");
    if !manifest.is_file() {
        bail!("--crate {}: Cargo.toml is missing; give the folder of a crate as in docs/project.md", folder.shown());
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["run", "--release", "--quiet", "--manifest-path"]).arg(manifest).arg("--");
    command.args(handed_on(std::env::args_os().skip(1)));
    let status = command.status().context("cannot start cargo, which builds the crate; install Rust")?;
    match status.code() {
        Some(0) => Ok(Ended::Done),
        Some(130) => Ok(Ended::Interrupted),
        _ => bail!("the program of {} failed ({status})", folder.shown()),
    }
}

/// The arguments without `hil` and `--crate`, for a program whose only command is `hil`.
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
    fn a_crate_gets_all_arguments_except_crate() {
        let line = |text: &str| {
            let words = handed_on(text.split(' ').map(OsString::from)).into_iter();
            words.map(|word| word.into_string().expect("text")).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(line("hil hil --crate here --device qemu:riscv32"), "hil --device qemu:riscv32");
        assert_eq!(line("--json hil s.toml --crate=here -q"), "--json s.toml -q");
    }
}
