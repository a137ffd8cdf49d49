//! `cargo xtask`: the project's own commands, the same on a desk and in CI.
//!
//! One file per command; what they share is [`repo`] (where things are and how a child process is
//! started) and [`report`] (what passed, and the closing line).

mod apt;
mod autopilots;
mod bare;
mod bench;
mod bless;
mod browser;
mod c;
mod check;
mod circles;
mod clients;
mod cluster;
mod debian;
mod device;
mod documents;
mod emulate;
mod emulated;
mod example;
mod extent;
mod faults;
mod firmware;
mod fuzz;
mod install;
mod layers;
mod minimal;
mod mpi;
mod part;
mod plants;
mod project;
mod python;
mod python_package;
mod qemu;
mod repo;
mod report;
mod size;
mod soak;
mod source;
mod swarms;
mod tally;
mod test;
mod weight;

use device::Toolchains;
use extent::Extent;
use repo::Repo;
use report::Report;
use std::process::ExitCode;

const HELP: &str = "\
The project's own commands.

Usage: cargo xtask COMMAND

  check           formatting, layers, what documents name, clippy and rustdoc, warnings denied
  test [--all]    the tests: on the host, by MAVLink clients, on emulated parts; with --all also the long proofs: each program
                  on each part, debug builds, budgets, ten parts for 1000 steps, pages in a browser, sweeps on Slurm, peers, fuzz targets on random bytes
  ci              check, then test --all
  autopilots [--rover PATH] [--copter PATH] [--defaults FOLDER] [NAME]
                  flights of `staya companion` with the simulation of ArduPilot that you have built (docs/autopilots.md); never part of `ci`
  bare            emulators, compiler, emulated parts and a browser in a bare Debian of its own; needs root
  bench [NAME]    benchmarks, also beside peer crates (those whose name contains NAME): medians, ratios, goals
  bless [NAME]    rewrite golden files by running the tests whose name contains NAME (default: golden)
  fuzz [--seconds N]
                  each fuzz target for N seconds (default: 60), if nightly Rust and cargo-fuzz are there
  c               the library for C: its programs on this machine, the canned swarms through it on an emulated STM32F405
  browser         the page of `staya view` in Chromium, driven from Python
  clients [NAME]  MAVLink clients (pymavlink, MAVSDK, MAVProxy, tshark) against staya, from Python: all tests or those whose names contain NAME
  cluster         sweeps on Slurm and GNU parallel, on this machine: the same rows as without them
  python          the package for Python: its wheel, its types, its tests, its notebook
  mpi             one world over ranks of OpenMPI, on this machine: the trace hash of one process; a rank that dies
  mpi --scaling   times of 200,000 robots on 1, 2 and 4 ranks; on a machine that does nothing else
  faults [PART...]
                  firmware that goes wrong on purpose says why and starts anew, on each part (default: all)
  example         the example firmware of examples/stm32f4
  firmware [--debug] [--bin NAME] [PART...]
                  the programs of hil/firmware, or one of them, for stm32f405, nrf51, riscv32 (default: all): target/firmware/PART/BIN
  firmware --crate DIR [PART...]
                  the program `firmware` of the crate in DIR, a guidance law of its own: DIR/target/firmware/PART/lockstep
  install [--prefix DIR] [--debug]
                  staya, firmware of all parts, manual pages and completions below DIR (default: ~/.local)
  size [--json]   what the firmware takes on each part: flash, RAM, stack, instructions a step; against hil/budgets.toml
  soak [--minutes N] [--json FILE] [PART...]
                  bridges, companions and firmware at once among clients that mean no good (default: 3 minutes), or some of
                  flood, key, companion, hil: memory, deadlines, every frame accounted for
  swarms          the canned swarms give the same hashes on the host and on every part
  new             what `staya new` makes, of each kind: compiled, tested, its law on the emulated STM32F405
  plants          panics planted in a copy of the firmware's sources, one at a time: the linker must refuse each
  qemu            the emulators of the parts; fetches them on Debian
  weight [--peer] [--record]
                  the cost of the README's first command beside the last record in xtask/weight.csv; --peer also builds ripgrep
  help            this text

`test` builds for microcontrollers with rustup's targets if they are installed, otherwise with
Debian's packages, which it unpacks into target/tools if they are not installed; what it cannot do it
reports as skipped, with the reason.

With CI=true in the environment all that is skipped has failed.

The last line counts tests and steps: `N passed, N failed, N skipped`. The exit code is 1 if
anything failed, 2 if the command line is wrong.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let repo = Repo::find();
    let mut report = Report::new();
    match arguments.as_slice() {
        ["help" | "-h" | "--help"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        ["check"] => check::run(&repo, &mut report),
        ["test"] => test::run(&repo, &mut report, Extent::Short),
        ["test", "--all"] => test::run(&repo, &mut report, Extent::All),
        ["ci"] => {
            check::run(&repo, &mut report);
            test::run(&repo, &mut report, Extent::All);
        }
        ["autopilots", arguments @ ..] => match autopilots::Request::read(arguments) {
            Some(request) => autopilots::run_command(&repo, &mut report, &request),
            None => {
                eprint!("xtask: autopilots takes --rover PATH, --copter PATH, --defaults FOLDER and a NAME\n\n{HELP}");
                return ExitCode::from(2);
            }
        },
        ["bare"] => bare::run_command(&repo, &mut report),
        ["bench"] => bench::run(&repo, &mut report, None),
        ["bench", name] if !name.starts_with('-') => bench::run(&repo, &mut report, Some(name)),
        ["bless"] => bless::run(&repo, &mut report, "golden"),
        ["bless", name] if !name.starts_with('-') => bless::run(&repo, &mut report, name),
        ["clients"] => clients::run_command(&repo, &mut report, None, Extent::All),
        ["clients", name] if !name.starts_with('-') => {
            clients::run_command(&repo, &mut report, Some(name), Extent::All);
        }
        ["c"] => c::run_command(&repo, &mut report),
        ["browser"] => browser::run_command(&repo, &mut report),
        ["cluster"] => cluster::run_command(&repo, &mut report),
        ["python"] => python_package::run_command(&repo, &mut report),
        ["mpi"] => mpi::run_command(&repo, &mut report),
        ["mpi", "--scaling"] => mpi::run_scaling(&repo, &mut report),
        ["example"] => example::run(&repo, &mut report),
        ["fuzz"] => fuzz::run(&repo, &mut report, fuzz::SECONDS),
        ["fuzz", "--seconds", n] if n.parse().is_ok_and(|n: u32| n > 0) => {
            fuzz::run(&repo, &mut report, n);
        }
        ["faults", names @ ..] if names.iter().all(|name| part::part(name).is_some()) => {
            let parts: Vec<_> = names.iter().filter_map(|name| part::part(name)).collect();
            faults::run_command(&repo, &mut report, &parts);
        }
        ["firmware", arguments @ ..] => match firmware::Request::read(arguments) {
            Some(request) => firmware::run_command(&repo, &mut report, &request),
            None => {
                eprint!("xtask: no such part or option\n\n{HELP}");
                return ExitCode::from(2);
            }
        },
        ["install", arguments @ ..] => match install::Request::read(arguments) {
            Ok(request) => install::run_command(&repo, &mut report, &request),
            Err(reason) => {
                eprint!("xtask: {reason}\n\n{HELP}");
                return ExitCode::from(2);
            }
        },
        ["new"] => project::run_command(&repo, &mut report),
        ["plants"] => plants::run_command(&repo, &mut report),
        ["qemu"] => qemu::run(&repo, &mut report),
        ["size"] => size::run(&repo, &mut report, &mut Toolchains::default(), false),
        ["size", "--json"] => size::run(&repo, &mut report, &mut Toolchains::default(), true),
        ["soak", arguments @ ..] => match soak::Request::read(arguments) {
            Some(request) => soak::run_command(&repo, &mut report, &request),
            None => {
                eprint!("xtask: no such part or option\n\n{HELP}");
                return ExitCode::from(2);
            }
        },
        ["swarms"] => swarms::run(&repo, &mut report, &mut Toolchains::default()),
        ["weight", options @ ..] if options.iter().all(|option| ["--record", "--peer"].contains(option)) => {
            let has = |name: &str| options.contains(&name);
            weight::run_command(&repo, &mut report, has("--record"), has("--peer"));
        }
        [] => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
        _ => {
            eprint!("xtask: cannot understand `{}`\n\n{HELP}", arguments.join(" "));
            return ExitCode::from(2);
        }
    }
    report.close()
}
