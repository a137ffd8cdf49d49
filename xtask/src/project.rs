//! Projects that `staya new` makes compile, and their tests run: a project of each kind in
//! `target/new`, in the target folder that all share.

use crate::apt::Tools;
use crate::c;
use crate::device::STM32F405;
use crate::emulate::QEMU;
use crate::files;
use crate::firmware::build_own;
use crate::python;
use crate::repo::{Repo, run as run_command};
use crate::report::failure;
use crate::session::{MAIN, Session};
use crate::tally::counted;
use std::path::{Path, PathBuf};
use std::process::Command;

const MAKE: Tools = Tools { packages: &["make"], programs: &["make"], question: "make --version" };
/// Parts of `staya new`, and the targets of their code.
const PARTS: [(&str, &str); 4] = [
    ("stm32f405", "thumbv7em-none-eabihf"),
    ("rp2350", "thumbv8m.main-none-eabihf"),
    ("nrf52840", "thumbv7em-none-eabihf"),
    ("esp32c3", "riscv32imc-unknown-none-elf"),
];

/// Rust on this machine; with `is_all` also C, firmware for each part, the law on the emulated one,
/// Python.
pub fn run(s: &mut Session, is_all: bool) {
    let program = s.staya("debug");
    if s.report.need("new projects", program).is_none() {
        return;
    }
    let is_made = s.report.step("a new project in Rust", || {
        let folder = make(&s.repo, STM32F405.name, &[])?;
        run_command(s.repo.cargo(&["test", "--quiet"]).current_dir(&folder))?;
        let mut keep = s.repo.cargo(&["run", "--quiet", "--example", "run", "--", "run.staya"]);
        run_command(keep.current_dir(folder))
    });
    if !is_all {
        return;
    }
    s.report.step_with("a new project in C", make_is_there(&s.repo), |()| {
        let folder = make(&s.repo, "c", &["--c"])?;
        run_command(make_in(&s.repo, &folder).arg("test"))
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
    if !repo.says("cc --version") {
        return Err(String::from("no cc; on Debian run, as root, `apt-get install gcc libc6-dev`"));
    }
    MAKE.prepare(repo)
}

/// The folder of a project that was just made.
fn make(repo: &Repo, kind: &str, options: &[&str]) -> Result<PathBuf, String> {
    let parent = repo.target.join("new");
    let folder = parent.join(format!("pack-{kind}"));
    files::make(&parent)?;
    // `staya new` makes the folder itself.
    files::remove(&folder)?;
    let mut new = repo.command(repo.program("debug", MAIN));
    run_command(new.args(["new", "--quiet"]).args(options).arg("--staya").arg(&repo.root).arg(&folder))?;
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
        run_command(build.arg("--quiet").current_dir(folder.join("firmware")))
    });
}

fn firmware_in_c(s: &mut Session) {
    let step = "a new robot's firmware in C";
    let tools = make_is_there(&s.repo).and_then(|()| c::COMPILER.prepare(&s.repo));
    if s.report.need(step, tools).is_none() {
        return;
    }
    s.with_toolchain(step, STM32F405.target, |repo, toolchain| {
        let library = format!("LIBRARY_FIRMWARE={}", c::library(repo, toolchain)?.display());
        [STM32F405.name, "nrf52840"].into_iter().try_for_each(|name| {
            let folder = make(repo, &format!("c-{name}"), &["--c", "--part", name])?;
            run_command(make_in(repo, &folder).args(["build/firmware.elf", &library]))
        })
    });
}

/// `staya hil` with the project's law.
fn on_emulated_part(s: &mut Session) {
    let step = "a new law on the emulated stm32f405";
    let folder = s.repo.target.join("new").join(format!("pack-{}", STM32F405.name)).join("hil");
    if s.report.need(step, QEMU.prepare(&s.repo)).is_none() {
        return;
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
    let Some(python) = s.report.need(step, python::with_wheel(&s.repo)) else { return };
    s.report.part(step, || {
        let made = make(&s.repo, "python", &["--python"]).and_then(|folder| {
            python::pip(&s.repo, &python, &["--no-deps", "--editable", &folder.display().to_string()])?;
            run_command(s.repo.command(&python).arg("show.py").current_dir(&folder))?;
            Ok(counted(python::pytest(&s.repo, &python, &[]).current_dir(folder)))
        });
        made.unwrap_or_else(failure)
    });
}
