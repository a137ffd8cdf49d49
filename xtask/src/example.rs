//! The example firmware, a workspace of its own, built with whatever toolchain there is.

use crate::device::Toolchains;
use crate::repo::Repo;
use crate::report::Report;

/// Where it is.
pub const FOLDER: &str = "examples/stm32f4";
const TARGET: &str = "thumbv7em-none-eabihf";

/// A release build: that it links is the test, since no emulator has the part's clocks.
pub fn run(repo: &Repo, report: &mut Report) {
    let name = "example firmware for the STM32F405";
    match Toolchains::default().find(repo, TARGET) {
        Ok(toolchain) => {
            let mut build = toolchain.cargo(repo, TARGET, "build");
            build.args(["--locked", "--release"]);
            build.current_dir(repo.root.join(FOLDER));
            report.command(name, build);
        }
        Err(reason) => report.skip(name, &reason),
    }
}
