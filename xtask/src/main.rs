//! `cargo xtask`: the project's own commands, the same on a desk and in CI.
//!
//! One file per command; what they share is [`repo`] (where things are and how a child process is
//! started) and [`report`] (what passed, and the closing line).

mod bench;
mod bless;
mod check;
mod debian;
mod device;
mod fuzz;
mod layers;
mod repo;
mod report;
mod test;

use repo::Repo;
use report::Report;
use std::process::ExitCode;

const HELP: &str = "\
The project's own commands.

Usage: cargo xtask COMMAND

  check           formatting, layers, clippy and rustdoc, warnings denied
  test            every test, and the controller built for microcontrollers
  ci              check, then test
  bench [NAME]    benchmarks, also beside peer crates (those whose name contains NAME): medians, ratios, goals
  bless [NAME]    rewrite golden files by running the tests whose name contains NAME (default: golden)
  fuzz [--seconds N]
                  each fuzz target for N seconds (default: 60), if nightly Rust and cargo-fuzz are there
  help            this text

`test` builds for microcontrollers with rustup's targets if they are installed, otherwise with
Debian's packages, which it installs by itself when run as root on Debian; what it cannot do it
reports as skipped, with the reason.

The last line counts tests and steps: `N passed, N failed, N skipped`. The exit code is 1 if
anything failed, 2 if the command line is wrong.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let repo = Repo::find();
    let mut report = Report::default();
    match arguments.as_slice() {
        ["help" | "-h" | "--help"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        ["check"] => check::run(&repo, &mut report),
        ["test"] => test::run(&repo, &mut report),
        ["ci"] => {
            check::run(&repo, &mut report);
            test::run(&repo, &mut report);
        }
        ["bench"] => bench::run(&repo, &mut report, None),
        ["bench", name] if !name.starts_with('-') => bench::run(&repo, &mut report, Some(name)),
        ["bless"] => bless::run(&repo, &mut report, "golden"),
        ["bless", name] if !name.starts_with('-') => bless::run(&repo, &mut report, name),
        ["fuzz"] => fuzz::run(&repo, &mut report, fuzz::SECONDS),
        ["fuzz", "--seconds", n] if n.parse().is_ok_and(|n: u32| n > 0) => {
            fuzz::run(&repo, &mut report, n);
        }
        [] => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
        _ => {
            eprint!(
                "xtask: cannot understand `{}`\n\n{HELP}",
                arguments.join(" ")
            );
            return ExitCode::from(2);
        }
    }
    report.close()
}
