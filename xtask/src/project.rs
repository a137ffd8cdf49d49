//! Projects that `staya new` makes compile, and their tests run: a project of each kind in
//! `target/new`, in the target folder that all share.

use crate::apt::Tools;
use crate::c;
use crate::device::STM32F405;
use crate::emulate::QEMU;
use crate::firmware::{FIRMWARE, build_own};
use crate::prelude::*;
use crate::python;

const MAKE: Tools = Tools { packages: "make", programs: "make", question: "make --version", ways: "unpack" };
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
    let is_made = s.report.step("a new project in Rust", || {
        let folder = program.and_then(|_| make(&s.repo, STM32F405.name, ""))?;
        for line in ["test --quiet", "run --quiet --example run -- run.staya"] {
            execute(s.repo.cargo(line).current_dir(&folder))?;
        }
        Ok(())
    });
    if !is_all {
        return;
    }
    s.report.step("a new project in C", || {
        make_is_there(&s.repo)?;
        let folder = make(&s.repo, "c", "--c")?;
        execute(make_in(&s.repo, &folder).arg("test"))
    });
    for (name, target) in PARTS {
        firmware(s, name, target);
    }
    s.with_toolchain("a new robot's firmware in C", STM32F405.target, |repo, toolchain| {
        make_is_there(repo)?;
        c::COMPILER.prepare(repo)?;
        let library = format!("LIBRARY_FIRMWARE={}", c::library(repo, toolchain)?.display());
        [STM32F405.name, "nrf52840"].into_iter().try_for_each(|name| {
            let folder = make(repo, &format!("c-{name}"), &format!("--c --part {name}"))?;
            execute(make_in(repo, &folder).args(["build/firmware.elf", &library]))
        })
    });
    if is_made {
        on_emulated_part(s);
    }
    // In the environment in which the package for Python has been tested.
    s.report.part("a new project in Python", || {
        let python = python::with_wheel(&s.repo)?;
        let folder = make(&s.repo, "python", "--python")?;
        python::pip(&s.repo, &python, "--no-deps --editable", &[&folder])?;
        execute(s.repo.command(&python).arg("show.py").current_dir(&folder))?;
        Ok(counted(python::pytest(&s.repo, &python, &[]).current_dir(folder)))
    });
}

/// Makes sure that there is what projects in C are compiled by; `make` is unpacked on Debian.
fn make_is_there(repo: &Repo) -> Result<()> {
    let remedy = "no cc; on Debian run, as root, `apt-get install gcc libc6-dev`";
    ensure!(repo.says("cc --version"), skipped(remedy));
    MAKE.prepare(repo)
}

/// The folder of a project that was just made.
fn make(repo: &Repo, kind: &str, options: &str) -> Result<PathBuf> {
    let parent = repo.target.join("new");
    let folder = parent.join(format!("pack-{kind}"));
    files::make(&parent)?;
    // `staya new` makes the folder itself.
    files::remove(&folder)?;
    let mut new = repo.command(repo.program("debug", MAIN));
    execute(new.words("new --quiet").words(options).arg("--staya").arg(&repo.root).arg(&folder))?;
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
        let folder = make(repo, &format!("robot-{name}"), &format!("--part {name}"))?;
        // As quick to compile as can be linked; the part that `cargo xtask example` has compiled
        // for release is that.
        let line = if name == STM32F405.name { "build --quiet --release" } else { "build --quiet" };
        execute(toolchain.cargo(repo, target, line).current_dir(folder.join("firmware")))
    });
}

/// `staya hil` with the project's law.
fn on_emulated_part(s: &mut Session) {
    let folder = s.repo.target.join("new").join(format!("pack-{}", STM32F405.name)).join("hil");
    let is_built = build_own(s, STM32F405, FIRMWARE, &folder);
    s.report.step("a new law on the emulated stm32f405", || {
        ensure!(is_built, skipped("there is no firmware of it"));
        QEMU.prepare(&s.repo)?;
        let line = "run --quiet -- ../scenario.toml --device qemu:stm32f405 --devices 2 --quiet --ticks 100 \
            --firmware target/firmware";
        execute(s.repo.cargo(line).current_dir(&folder))
    });
}
