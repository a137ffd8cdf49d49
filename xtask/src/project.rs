//! Projects that `staya new` makes compile, and their tests run: a project of each kind in
//! `target/new`, in the target folder that all share.

use crate::apt::Tools;
use crate::c;
use crate::device::STM32F405;
use crate::emulate;
use crate::extent::Extent;
use crate::files;
use crate::firmware::build_own;
use crate::python;
use crate::repo::{Repo, output_of, run as run_command_line};
use crate::report::Counts;
use crate::session::{MAIN, Session};
use crate::tally::counted;
use std::path::{Path, PathBuf};
use std::process::Command;

const MAKE: Tools = Tools { packages: &["make"], programs: &["make"] };
/// Parts of `staya new`, and the targets of their code.
const PARTS: [(&str, &str); 4] = [
    ("stm32f405", "thumbv7em-none-eabihf"),
    ("rp2350", "thumbv8m.main-none-eabihf"),
    ("nrf52840", "thumbv7em-none-eabihf"),
    ("esp32c3", "riscv32imc-unknown-none-elf"),
];
/// Rust on this machine; of all extent also C, firmware for each part, the law on the emulated one,
/// Python.
pub fn run(s: &mut Session, extent: Extent) {
    if s.staya("debug").is_none() {
        return s.report.skip("new projects", "`staya` is not compiled");
    }
    let is_made = s.report.step("a new project in Rust", || {
        let folder = make(&s.repo, STM32F405.name, &[])?;
        run_command_line(s.repo.cargo(&["test", "--quiet"]).current_dir(&folder))?;
        let mut keep = s.repo.cargo(&["run", "--quiet", "--example", "run", "--", "run.staya"]);
        run_command_line(keep.current_dir(folder))
    });
    if extent == Extent::Short {
        return;
    }
    s.report.step_with("a new project in C", make_is_there(&s.repo), |()| {
        let folder = make(&s.repo, "c", &["--c"])?;
        run_command_line(make_in(&s.repo, &folder).arg("test"))
    });
    for (name, target) in PARTS {
        firmware(s, name, target);
    }
    firmware_in_c(s);
    if is_made {
        on_emulated_part(s);
    }
    in_python(s);
}

/// Makes sure that there is what projects in C are compiled by; `make` is unpacked on Debian.
fn make_is_there(repo: &Repo) -> Result<(), String> {
    let is_there = |program: &str| output_of(repo.command(program).arg("--version")).is_some();
    if !is_there("cc") {
        return Err(String::from("no cc; on Debian run, as root, `apt-get install gcc libc6-dev`"));
    }
    MAKE.prepare(repo, || is_there("make"))
}

/// The folder of a project that was just made.
fn make(repo: &Repo, kind: &str, options: &[&str]) -> Result<PathBuf, String> {
    let folder = repo.target.join("new").join(format!("pack-{kind}"));
    // `staya new` makes the folder itself.
    files::make_empty(&folder)?;
    files::remove_empty(&folder)?;
    let mut new = repo.command(repo.program("debug", MAIN));
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
fn firmware(s: &mut Session, name: &str, target: &str) {
    s.with_toolchain(&format!("a new robot's firmware for {name}"), target, |repo, toolchain| {
        let folder = make(repo, &format!("robot-{name}"), &["--part", name])?;
        let mut build = toolchain.cargo(repo, target, "build");
        // As quick to compile as can be linked; the part that `cargo xtask example` has compiled
        // for release is that.
        build.args((name == STM32F405.name).then_some("--release"));
        run_command_line(build.arg("--quiet").current_dir(folder.join("firmware")))
    });
}

fn firmware_in_c(s: &mut Session) {
    let step = "a new robot's firmware in C";
    if let Err(reason) = make_is_there(&s.repo).and_then(|()| c::compilers(&s.repo)) {
        return s.report.skip(step, &reason);
    }
    s.with_toolchain(step, STM32F405.target, |repo, toolchain| {
        let library = c::library(repo, toolchain)?;
        [STM32F405.name, "nrf52840"].into_iter().try_for_each(|name| {
            let folder = make(repo, &format!("c-{name}"), &["--c", "--part", name])?;
            let mut build = make_in(repo, &folder);
            run_command_line(build.arg("build/firmware.elf").arg(format!("LIBRARY_FIRMWARE={}", library.display())))
        })
    });
}

/// `staya hil` with the project's law.
fn on_emulated_part(s: &mut Session) {
    let step = "a new law on the emulated stm32f405";
    let folder = s.repo.target.join("new").join(format!("pack-{}", STM32F405.name)).join("hil");
    if let Err(reason) = emulate::prepare(&s.repo, STM32F405) {
        return s.report.skip(step, &reason);
    }
    if !build_own(s, STM32F405, &folder) {
        return s.report.skip(step, "there is no firmware of it");
    }
    let mut hil = s.repo.cargo(&["run", "--quiet", "--", "../scenario.toml", "--device", "qemu:stm32f405"]);
    hil.args(["--devices", "2", "--quiet", "--ticks", "100", "--firmware", "target/firmware"]).current_dir(&folder);
    s.report.command(step, hil);
}

/// In the environment in which the package for Python has been tested.
fn in_python(s: &mut Session) {
    let step = "a new project in Python";
    let python = match python::with_wheel(&s.repo) {
        Ok(python) => python,
        Err(reason) => return s.report.skip(step, &reason),
    };
    s.report.part(step, || {
        let made = make(&s.repo, "python", &["--python"]).and_then(|folder| {
            python::pip(&s.repo, &python, &["--no-deps", "--editable", &folder.display().to_string()])?;
            run_command_line(s.repo.command(&python).arg("show.py").current_dir(&folder))?;
            Ok(folder)
        });
        match made {
            Ok(folder) => counted(python::pytest(&s.repo, &python, &[]).current_dir(folder), ""),
            Err(reason) => (Counts { failed: 1, ..Default::default() }, reason),
        }
    });
}
