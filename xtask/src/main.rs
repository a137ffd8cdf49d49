//! `cargo xtask`: the project's own commands, the same on a desk and in CI.
//!
//! One file per command or kind of command; they share [`session`]: the repository
//! ([`repo`]), what passed ([`report`]), and the programs that are built.

mod apt;
mod autopilots;
mod bench;
mod bless;
mod c;
mod check;
mod device;
mod documents;
mod emulate;
mod emulated;
mod files;
mod firmware;
mod fuzz;
mod install;
mod language;
mod minimal;
mod modules;
mod mpi;
mod mutants;
mod options;
mod plants;
mod project;
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

use options::Options;
use session::Session;
use std::process::ExitCode;

/// How a command is called, what it does, and what does it.
type Command = (&'static str, &'static str, fn(&mut Session, &Options<'_>));

/// The commands. Of lines that begin with the same word, the first that fits counts.
#[rustfmt::skip]
const COMMANDS: [Command; 32] = [
    ("check", "what can be judged without running the code; warnings are errors", |s, _| check::run(s)),
    ("test", "tests on the host, by MAVLink clients, on two emulated parts", |s, _| test::run(s, false)),
    ("test [--all]", "also long tests, all parts and programs, sweeps, peers, goals", |s, _| test::run(s, true)),
    ("autopilots [--rover PATH] [--copter PATH] [--defaults FOLDER] [NAME]", "flights with your build of ArduPilot",
        autopilots::run_command),
    ("bench [NAME]", "benchmarks: medians, ratios, goals", |s, o| bench::run(s, o.name())),
    ("bless [NAME]", "rewrite golden files by tests named NAME (golden)", |s, o| bless::run(s, o.name())),
    ("book", "the pages as a book with search: target/book/index.html", |s, _| python::book(s)),
    ("browser", "the page of `staya view` in Chromium", |s, _| python::browser(s)),
    ("c", "the library for C, on this machine and on an emulated STM32F405", |s, _| c::run(s)),
    ("clients [NAME]", "MAVLink clients against staya", |s, o| python::clients(s, o.name(), true)),
    ("cluster", "sweeps on Slurm and GNU parallel, on this machine", |s, _| python::cluster(s)),
    ("example", "the example firmware of examples/stm32f4", |s, _| firmware::example(s)),
    ("faults [stm32f405|nrf51|riscv32...]", "firmware that fails restarts", |s, o| swarms::faults(s, &o.names)),
    ("figures [--out FILE] [--against FILE]", "figures of scenarios and experiments: target/figures.csv, or as before a change",
        python::figures),
    ("firmware [--debug] [--bin NAME] [stm32f405|nrf51|riscv32...]", "programs of hil/firmware: target/firmware/PART",
        firmware::run_command),
    ("firmware [--crate DIR] [stm32f405|nrf51|riscv32...]", "firmware of a crate with a law of its own",
        firmware::run_command),
    ("fuzz [--seconds N]", "each fuzz target for N seconds (60)", |s, o| fuzz::run(s, o.value("--seconds"))),
    ("install [--prefix DIR] [--debug]", "programs, firmware, manual, completions below DIR (~/.local)",
        install::run_command),
    ("mpi", "one world over ranks of OpenMPI, on this machine", |s, _| mpi::run(s)),
    ("mpi [--scaling]", "times of 200,000 robots on 1, 2 and 4 ranks", |s, _| mpi::run_scaling(s)),
    ("mutants [--shard K/N]", "changes of the controller that its tests must notice",
        |s, o| mutants::run_shard(s, o.value("--shard"))),
    ("new", "what `staya new` makes, compiled and tested", |s, _| project::run(s, true)),
    ("plants", "panics planted in the firmware's sources: the linker refuses each", |s, _| plants::run(s, true)),
    ("pogema", "robots that negotiate on all maps of POGEMA's tables", |s, _| python::pogema(s, true)),
    ("python", "the package for Python: its wheel, types and tests", |s, _| python::package(s)),
    ("qemu", "fetches the emulators of the parts", |s, _| emulate::fetch(s)),
    ("size [--json]", "flash, RAM, stack, instructions against budgets", |s, o| size::run(s, o.has("--json"))),
    ("size [--search] [--seed N] [--scenes N]", "the longest step behind ORCA that a search finds", size::search),
    ("soak [--minutes N] [--json FILE] [flood|key|companion|hil...]", "everything at once among hostile clients",
        soak::run_command),
    ("swarms", "the canned swarms give one hash on the host and on each part", |s, _| swarms::run(s)),
    ("weight [--peer] [--record]", "the cost of the README's first command", weight::run_command),
    ("help", "this text", |_, _| {}),
];

const NOTES: &str = "
Programs that this machine lacks are unpacked into target/tools from Debian's packages. A part that cannot run
is skipped, with the reason; with CI=true in the environment it has failed.

The last line counts tests and steps: `N passed, N failed, N skipped`. The exit code is 1 if
anything failed, 2 if the command line is wrong.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (name, rest) = arguments.split_first().map_or(("", &[][..]), |(name, rest)| (*name, rest));
    if ["help", "-h", "--help"].contains(&name) || rest.contains(&"--help") {
        print!("{}", help());
        return ExitCode::SUCCESS;
    }
    let mut reason = format!("no command `{name}`");
    for (usage, _, run) in COMMANDS.iter().filter(|(usage, ..)| usage.split(' ').next() == Some(name)) {
        match Options::read(usage, rest) {
            Ok(options) => {
                let mut session = Session::new();
                run(&mut session, &options);
                return session.report.close();
            }
            Err(wrong) => reason = wrong,
        }
    }
    eprint!("xtask: {reason}\n\n{}", help());
    ExitCode::from(2)
}

fn help() -> String {
    let line = |(usage, about, _): &Command| format!("  {usage}\n        {about}\n");
    let lines: String = COMMANDS.iter().map(line).collect();
    format!("The project's own commands.\n\nUsage: cargo xtask COMMAND\n\n{lines}{NOTES}")
}
