//! What `staya new` makes compiles, and its tests run: a project of each kind in `target/new`, in the target folder that all share.

use crate::apt;
use crate::c;
use crate::device::Toolchains;
use crate::extent::Extent;
use crate::firmware::build_own;
use crate::part::part;
use crate::python_package;
use crate::repo::{Repo, output_of, run as run_command_line};
use crate::report::Report;
use crate::{emulate, python};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Parts of `staya new`, and what their code is compiled for.
const PARTS: [(&str, &str); 4] = [
    ("stm32f405", "thumbv7em-none-eabihf"),
    ("rp2350", "thumbv8m.main-none-eabihf"),
    ("nrf52840", "thumbv7em-none-eabihf"),
    ("esp32c3", "riscv32imc-unknown-none-elf"),
];
/// The part that is emulated.
const EMULATED: &str = "stm32f405";

/// The command: all of it, with the program built first.
pub fn run_command(repo: &Repo, report: &mut Report) {
    let build = repo.cargo(&["build", "--locked", "--package", "staya"]);
    let is_compiled = report.command("staya", build);
    run(repo, report, &mut Toolchains::default(), Extent::All, is_compiled);
}

/// Rust on this machine; of all extent also C, firmware for each part, the law on the emulated one, Python. `is_compiled`: the program
/// has been built.
pub fn run(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains, extent: Extent, is_compiled: bool) {
    if !is_compiled {
        return report.skip("new projects", "`staya` is not compiled");
    }
    let rust = "a new project in Rust";
    let is_made = report.step(rust, || {
        let folder = make(repo, EMULATED, &[])?;
        run_command_line(repo.cargo(&["test", "--quiet"]).current_dir(&folder))?;
        let mut keep = repo.cargo(&["run", "--quiet", "--example", "run", "--", "run.staya"]);
        run_command_line(keep.current_dir(folder))
    });
    if extent == Extent::Short {
        return;
    }
    match make_is_there(repo) {
        Err(reason) => report.skip(C, &reason),
        Ok(()) => {
            report.step(C, || {
                let folder = make(repo, "c", &["--c"])?;
                run_command_line(make_in(repo, &folder).arg("test"))
            });
        }
    }
    for (name, target) in PARTS {
        firmware(repo, report, toolchains, name, target);
    }
    firmware_in_c(repo, report, toolchains);
    if is_made {
        on_emulated_part(repo, report, toolchains);
    }
    in_python(repo, report);
}

const C: &str = "a new project in C";

/// Makes sure that there is what projects in C are compiled by; `make` is unpacked on Debian.
fn make_is_there(repo: &Repo) -> Result<(), String> {
    let is_there = |program: &str| output_of(repo.command(program).arg("--version")).is_some();
    if !is_there("cc") {
        return Err(String::from("no cc; on Debian run, as root, `apt-get install gcc libc6-dev`"));
    }
    if is_there("make") {
        return Ok(());
    }
    apt::unpack(repo, &["make"], &["make"])
        .map_err(|reason| format!("no make ({reason}); on Debian run, as root, `apt-get install make`"))
}

/// The folder of a project that was just made.
fn make(repo: &Repo, kind: &str, options: &[&str]) -> Result<PathBuf, String> {
    let folder = repo.target.join("new").join(format!("pack-{kind}"));
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let parent = folder.parent().unwrap_or(&folder);
    fs::create_dir_all(parent).map_err(|error| format!("{}: {error}", parent.display()))?;
    let mut new = repo.command(repo.target.join("debug/staya"));
    run_command_line(new.args(["new", "--quiet"]).args(options).arg("--staya").arg(&repo.root).arg(&folder))?;
    Ok(folder)
}

/// Its Makefile, with this repository's target folder.
fn make_in(repo: &Repo, folder: &Path) -> Command {
    let mut make = repo.command("make");
    make.arg("--directory").arg(folder).arg("--no-print-directory").env("CARGO_TARGET_DIR", &repo.target);
    make
}

/// The robot's firmware: that it links is the test, since no emulator has the parts' clocks.
fn firmware(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains, name: &str, target: &str) {
    let step = format!("a new robot's firmware for {name}");
    match toolchains.find(repo, target) {
        Ok(toolchain) => {
            report.step(&step, || {
                let folder = make(repo, &format!("robot-{name}"), &["--part", name])?;
                let mut build = toolchain.cargo(repo, target, "build");
                // As quick to compile as can be linked; the part that `cargo xtask example` has compiled for release is that.
                if name == EMULATED {
                    build.arg("--release");
                }
                run_command_line(build.arg("--quiet").current_dir(folder.join("firmware")))
            });
        }
        Err(reason) => report.skip(&step, &reason),
    }
}

fn firmware_in_c(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    let step = "a new robot's firmware in C";
    let Some(part) = part(EMULATED) else {
        return;
    };
    match make_is_there(repo).and_then(|()| c::compilers(repo)).and_then(|()| toolchains.find(repo, part.target)) {
        Ok(toolchain) => {
            report.step(step, || {
                let library = c::library(repo, &toolchain, part)?;
                for name in [EMULATED, "nrf52840"] {
                    let folder = make(repo, &format!("c-{name}"), &["--c", "--part", name])?;
                    let mut build = make_in(repo, &folder);
                    run_command_line(
                        build.arg("build/firmware.elf").arg(format!("LIBRARY_FIRMWARE={}", library.display())),
                    )?;
                }
                Ok(())
            });
        }
        Err(reason) => report.skip(step, &reason),
    }
}

/// `staya hil` with the project's law.
fn on_emulated_part(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    let step = "a new law on the emulated stm32f405";
    let Some(part) = part(EMULATED) else {
        return;
    };
    let folder = repo.target.join("new").join(format!("pack-{EMULATED}")).join("hil");
    if let Err(reason) = emulate::prepare(repo, part) {
        return report.skip(step, &reason);
    }
    if !build_own(repo, report, toolchains, part, &folder) {
        return report.skip(step, "no firmware of it");
    }
    report.step(step, || {
        let mut hil =
            repo.cargo(&["run", "--quiet", "--", "../scenario.toml", "--device", "qemu:stm32f405", "--devices", "2"]);
        hil.args(["--quiet", "--ticks", "100", "--firmware", "target/firmware"]);
        run_command_line(hil.current_dir(&folder))
    });
}

/// In the environment in which the package for Python has been tested.
fn in_python(repo: &Repo, report: &mut Report) {
    let step = "a new project in Python";
    let python = match python_package::installed(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(step, &reason),
    };
    report.part(step, || {
        let made = make(repo, "python", &["--python"]).and_then(|folder| {
            let mut install = repo.command(&python);
            install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--editable"]);
            run_command_line(install.arg(&folder))?;
            run_command_line(repo.command(&python).arg("show.py").current_dir(&folder))?;
            Ok(folder)
        });
        match made {
            Ok(folder) => {
                let mut tests = repo.command(&python);
                tests.args(["-m", "pytest", "-q", "--color", "no", "-p", "no:cacheprovider"]);
                python::pytest(tests.current_dir(folder), "")
            }
            Err(reason) => (crate::report::Counts { failed: 1, ..Default::default() }, reason),
        }
    });
}
