//! The `staya` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    staya_sim::cli::main()
}
