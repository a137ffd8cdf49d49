//! `cargo xtask`: the project's own commands, the same on a desk and in CI.
//!
//! One file per command or kind of command; they share [`session`]: the repository
//! ([`repo`]), what passed ([`report`]), and the programs that are built.

mod apt;
mod autopilots;
mod bench;
mod c;
mod check;
mod claims;
mod device;
mod documents;
mod emulate;
mod files;
mod firmware;
mod fuzz;
mod install;
mod language;
mod law;
mod modules;
mod mpi;
mod mutants;
mod plants;
mod prelude;
mod project;
mod proof;
mod python;
mod repo;
mod report;
mod session;
mod size;
mod soak;
mod swarms;
mod tally;
mod test;
mod weight;

use clap::Parser as _;
use device::{NAMES, Part};
use session::Session;
use std::num::NonZeroU64;
use std::process::ExitCode;

const NOTES: &str = "\
Programs that this machine lacks are unpacked into target/tools from Debian's packages. A part that
cannot run is skipped, with the reason; with CI=true in the environment it has failed.

The last line counts tests and steps: `N passed, N failed, N skipped`. The exit code is 1 if
anything failed, 2 if the command line is wrong.";

/// The project's own commands.
#[derive(clap::Parser)]
#[command(bin_name = "cargo xtask", after_help = NOTES)]
enum Command {
    /// Checks that run no program of the project; warnings are errors
    Check,
    /// Tests on the host, by MAVLink clients, on two emulated parts
    Test {
        /// Also long tests, all parts and programs, sweeps, peers, goals
        #[arg(long)]
        all: bool,
    },
    /// Flights with your build of ArduPilot
    Autopilots(autopilots::Options),
    /// Benchmarks: medians, ratios, goals
    Bench(bench::Options),
    /// Rewrite golden files by tests named NAME
    Bless {
        /// Part of the tests' names
        #[arg(default_value = "golden")]
        name: String,
    },
    /// The pages as a book with search: target/book/index.html
    Book,
    /// The page of `staya view` in Chromium
    Browser,
    /// The library for C, on this machine and on an emulated STM32F405
    C,
    /// Figures of papers with all their seeds, for the claims in docs/results.md
    Claims {
        /// Only figures with these short names
        names: Vec<String>,
        /// Plant a wrong constant in each law: a figure must show it
        #[arg(long, conflicts_with = "names")]
        planted: bool,
    },
    /// MAVLink clients against staya
    Clients {
        /// Only tests whose name contains this
        name: Option<String>,
    },
    /// Sweeps on Slurm and GNU parallel, on this machine
    Cluster,
    /// The example firmware of examples/stm32f4
    Example,
    /// Firmware that fails restarts
    Faults {
        #[arg(value_name = "PART", value_parser = device::part, default_values = NAMES)]
        parts: Vec<&'static Part>,
    },
    /// Figures of scenarios and experiments, or their comparison with those before a change
    Figures(python::Figures),
    /// Programs of hil/firmware, or of a crate with a law of its own: target/firmware/PART
    Firmware(firmware::Options),
    /// Each fuzz target for some seconds
    Fuzz {
        /// Seconds for each target
        #[arg(long, value_name = "N", default_value = "60")]
        seconds: NonZeroU64,
    },
    /// Programs, firmware, manual, completions below a folder
    Install(install::Options),
    /// The law of docs/laws.md in host programs
    Law {
        /// Also in C, Python, ranks and firmware
        #[arg(long)]
        all: bool,
    },
    /// One world over ranks of OpenMPI, on this machine
    Mpi {
        /// Only times of 200,000 robots on 1, 2 and 4 ranks
        #[arg(long)]
        scaling: bool,
    },
    /// Changes of the controller that its tests must notice
    Mutants(mutants::Options),
    /// What `staya new` makes, compiled and tested
    New,
    /// Panics planted in the firmware's sources: the linker refuses each
    Plants,
    /// Robots that negotiate on all maps of POGEMA's tables
    Pogema,
    /// The proof that robots never touch, and errors planted in it: Coq refuses each
    Proof,
    /// The package for Python: its wheel, types and tests
    Python,
    /// Fetch the emulators of the parts
    Qemu,
    /// Flash, RAM, stack, instructions against budgets
    Size(size::Options),
    /// Everything at once among hostile clients
    Soak(soak::Options),
    /// The canned swarms give one hash on the host and on each part
    Swarms,
    /// The cost of the README's first command
    Weight(weight::Options),
}

fn main() -> ExitCode {
    let command = Command::parse();
    let s = &mut Session::new();
    match command {
        Command::Check => check::run(s),
        Command::Test { all } => test::run(s, all),
        Command::Autopilots(options) => autopilots::run(s, &options),
        Command::Bench(options) => bench::run(s, &options),
        Command::Bless { name } => test::bless(s, &name),
        Command::Book => python::book(s),
        Command::Browser => python::browser(s),
        Command::C => c::run(s),
        Command::Claims { planted: true, .. } => claims::planted::run(s),
        Command::Claims { names, .. } => claims::run(s, &names),
        Command::Clients { name } => python::clients(s, name.as_deref(), true),
        Command::Cluster => python::cluster(s),
        Command::Example => firmware::example(s),
        Command::Faults { parts } => swarms::faults(s, parts),
        Command::Figures(options) => python::figures(s, &options),
        Command::Firmware(options) => firmware::run_command(s, &options),
        Command::Fuzz { seconds } => fuzz::run(s, seconds),
        Command::Install(options) => install::run(s, &options),
        Command::Law { all } => law::run(s, all),
        Command::Mpi { scaling } => mpi::run(s, scaling),
        Command::Mutants(options) => mutants::run(s, &options),
        Command::New => project::run(s, true),
        Command::Plants => plants::run(s, true),
        Command::Pogema => python::pogema(s, true),
        Command::Proof => proof::run(s),
        Command::Python => python::package(s),
        Command::Qemu => emulate::fetch(s),
        Command::Size(options) => size::run(s, &options),
        Command::Soak(options) => soak::run_command(s, &options),
        Command::Swarms => swarms::run(s),
        Command::Weight(options) => weight::run(s, &options),
    }
    std::mem::take(&mut s.report).close()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(line: &str) -> bool {
        Command::try_parse_from(line.split(' ')).is_err()
    }

    #[test]
    fn options_of_all_commands_are_consistent() {
        <Command as clap::CommandFactory>::command().debug_assert();
        for sound in [
            "firmware --debug --bin lockstep --bin bench stm32f405 nrf51",
            "firmware --crate examples/own_part",
            "soak --minutes 0.5 hil key",
            "faults nrf51",
            "size --json",
            "size --search --seed 2",
            "bench rvo2 --seed 2 --set radio.loss=0.3 --set plane.orca.horizon_s=0.7",
        ] {
            assert!(!refused(&format!("xtask {sound}")), "{sound}");
        }
    }

    #[test]
    fn wrong_numbers_and_names_are_refused() {
        for wrong in [
            "soak --minutes 0",
            "soak --minutes x",
            "soak flod",
            "faults stm32",
            "size --seed 1",
            "bench --seed 2",
            "check orca",
            "firmware --crate a --debug",
        ] {
            assert!(refused(&format!("xtask {wrong}")), "{wrong}");
        }
    }
}
