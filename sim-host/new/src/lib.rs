//! `staya new NAME` creates a tested project from templates, in which `my-swarm` stands for its
//! name and `/STAYA` for this repository.

mod files;
mod source;

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use clap::Args;
use files::{C, File, PARTS, PYTHON, Part, RUST, SAME_BITS};
use source::Source;
use staya_console::{Ended, Global, Shown as _, one_line, print};
use staya_controller::scalar::NumberFormat;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Create a project with your own guidance law: scenario, simulator test, firmware.
#[derive(Args, Clone, Debug)]
#[command(after_help = "The project is in Rust without --c or --python. See the README.md in the new folder.")]
pub struct NewArgs {
    /// Folder to create; its last part is the project's name.
    #[arg(value_name = "NAME", required_unless_present = "list")]
    folder: Option<PathBuf>,
    /// Microcontroller of the robot, see --list [default: stm32f405].
    #[arg(long, value_name = "PART", value_parser = part, conflicts_with = "python")]
    part: Option<&'static Part>,
    /// Number format of the robot's agent: f32, fast32 (approximate functions) or q16 (fixed point)
    /// [default: q16 for parts without an FPU, else f32].
    #[arg(long, value_name = "FORMAT", value_parser = numbers, conflicts_with_all = ["c", "python"])]
    numbers: Option<NumberFormat>,
    /// Use C with the static library.
    #[arg(long, conflicts_with = "python")]
    c: bool,
    /// Use Python: a law over arrays, without firmware.
    #[arg(long)]
    python: bool,
    /// Staya's sources: a folder or a git URL [default: the sources of this program].
    #[arg(long, value_name = "PATH|URL")]
    staya: Option<String>,
    /// List the microcontrollers and exit.
    #[arg(long, conflicts_with = "folder")]
    list: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Rust,
    C,
    Python,
}

impl NewArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// An invalid name, a folder that exists or cannot be created, or missing sources of Staya.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let Some(folder) = self.folder.as_deref().filter(|_| !self.list) else {
            print(&list())?;
            return Ok(Ended::Done);
        };
        let kind = match (self.c, self.python) {
            (true, _) => Kind::C,
            (_, true) => Kind::Python,
            _ => Kind::Rust,
        };
        let part = self.part.unwrap_or(&PARTS[0]);
        let name = name(folder)?;
        let source = Source::find(self.staya.as_deref(), folder)?;
        let files = files(kind, part)?;
        let numbers = Numbers(self.numbers.unwrap_or(part.numbers));
        let files: Vec<(&str, String)> = files.into_iter().map(|(path, text)| (path, numbers.fill(text))).collect();
        let files: Vec<File<'_>> = files.iter().map(|(path, text)| (*path, text.as_str())).collect();
        write(folder, name, &files, &locks(kind, part), &source)?;
        if !global.quiet {
            print(&next(folder, kind, part, numbers.0, &source))?;
        }
        Ok(Ended::Done)
    }
}

fn part(text: &str) -> Result<&'static Part, String> {
    let found = PARTS.iter().find(|part| part.name == text);
    found.ok_or_else(|| format!("unknown part; give one of {}", names(&PARTS)))
}

fn numbers(text: &str) -> Result<NumberFormat, String> {
    const CHOICE: [NumberFormat; 3] = [NumberFormat::F32, NumberFormat::Fast32, NumberFormat::Q16];
    let found = CHOICE.into_iter().find(|numbers| numbers.name() == text);
    found.ok_or_else(|| format!("unknown number format; give one of {}", CHOICE.map(NumberFormat::name).join(", ")))
}

/// Number format of a project's robots.
#[derive(Clone, Copy)]
struct Numbers(NumberFormat);

impl Numbers {
    /// Fills a template's placeholders.
    fn fill(self, template: &str) -> String {
        let (scalar, formats) = match self.0 {
            NumberFormat::Q16 => ("staya_controller::scalar::Q16", ".in_fixed_point()"),
            NumberFormat::Fast32 => ("staya_controller::scalar::Fast32", ".in_fast_floats()"),
            NumberFormat::F32 | NumberFormat::F64 => ("f32", ""),
        };
        template.replace("MY_NUMBER", scalar).replace("MY_FORMATS", formats)
    }
}

fn names<'a>(parts: impl IntoIterator<Item = &'a Part>) -> String {
    let names: Vec<&str> = parts.into_iter().map(|part| part.name).collect();
    names.join(", ")
}

fn list() -> String {
    let mut text = String::from("part       --c  emulator  numbers  target                       description\n");
    for Part { name, title, target, is_emulated, numbers, c, .. } in &PARTS {
        let (c, emulator) = (if c.is_empty() { "no" } else { "yes" }, if *is_emulated { "QEMU" } else { "none" });
        let _ = writeln!(text, "{name:10} {c:4} {emulator:9} {numbers:8} {target:28} {title}");
    }
    text + "The law of any Rust project also runs on the emulated stm32f405, see its folder hil.\n"
}

const TAKEN: [&str; 12] =
    ["alloc", "core", "firmware", "hil", "numpy", "proc-macro", "pytest", "serde", "std", "target", "test", "tests"];
const KEYWORDS: &str = "abstract and as assert async await become box break class const continue crate def del do dyn elif else enum \
    except extern false final finally fn for from gen global if impl import in is lambda let loop macro match mod move mut nonlocal not \
    or override pass priv pub raise ref return self static struct super trait true try type typeof union unsafe unsized use virtual \
    where while with yield";
const LONGEST: usize = 40;

/// The name is valid for cargo, C and Python.
fn name(folder: &Path) -> Result<&str> {
    let last = folder.file_name().and_then(|name| name.to_str());
    let name = last.with_context(|| format!("{}: no project name; give a folder name", folder.shown()))?;
    let is_word = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_')
        && name.len() <= LONGEST;
    ensure!(
        is_word,
        "{}: not a valid project name; give at most {LONGEST} of a to z, 0 to 9, - and _, starting with a letter",
        one_line(name)
    );
    let is_free =
        !TAKEN.contains(&name) && !name.starts_with("staya") && KEYWORDS.split_whitespace().all(|word| word != name);
    ensure!(is_free, "{name}: this name is reserved by a language or by the project; give another one");
    Ok(name)
}

fn files(kind: Kind, part: &Part) -> Result<Vec<File<'static>>> {
    let files = match kind {
        Kind::Rust => [RUST, &[SAME_BITS], part.rust].concat(),
        Kind::C if part.c.is_empty() => {
            let parts = names(PARTS.iter().filter(|part| !part.c.is_empty()));
            bail!("no C firmware for {}; give one of {parts} with --c (see docs/c.md for ESP-IDF)", part.name)
        }
        Kind::C => [C, part.c].concat(),
        Kind::Python => PYTHON.to_vec(),
    };
    Ok(files)
}

/// Projects start with tested versions, and Cargo removes unused entries.
fn locks(kind: Kind, part: &Part) -> Vec<(&'static str, &'static str)> {
    let firmware = part.lock.map(|lock| ("firmware/Cargo.lock", lock));
    match kind {
        Kind::Rust => {
            [("Cargo.lock", "Cargo.lock"), ("hil/Cargo.lock", "Cargo.lock")].into_iter().chain(firmware).collect()
        }
        Kind::C | Kind::Python => Vec::new(),
    }
}

/// The folder must not exist, and is removed after an error.
fn write(folder: &Path, name: &str, files: &[File<'_>], locks: &[(&str, &str)], source: &Source) -> Result<()> {
    let shown = folder.shown();
    if let Some(parent) = folder.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        ensure!(parent.is_dir(), "{}: no such folder; create it first", parent.shown());
    }
    fs::create_dir(folder).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => anyhow!("{shown} already exists; give another name"),
        _ => anyhow!("{shown}: {error}; give a writable folder"),
    })?;
    // Names in paths are replaced too, for the Python module.
    let filled =
        files.iter().map(|(path, text)| (folder.join(source.fill("", path, name)), source.fill(path, text, name)));
    let locks = locks.iter().filter_map(|(path, own)| Some((folder.join(path), source.lock(own)?)));
    for (path, text) in filled.chain(locks) {
        if let Err(error) = write_file(&path, &text) {
            let _ = fs::remove_dir_all(folder);
            bail!("{}: {error}; nothing was created", path.shown());
        }
    }
    Ok(())
}

fn write_file(path: &Path, text: &str) -> std::io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::write(path, text)
}

fn next(folder: &Path, kind: Kind, part: &Part, numbers: NumberFormat, source: &Source) -> String {
    let folder = folder.shown();
    let place = source.fill("", "/STAYA_PIP", "");
    let rest = match kind {
        Kind::Rust => format!(
            "  cargo test                     test the law in the simulator: src/lib.rs, scenario.toml\n  \
             cargo run --example run -- run.staya && staya view run.staya\n  \
             cd hil && cargo run -- ../scenario.toml --device qemu:stm32f405{} --devices 2   run the law on emulated parts\n  \
             cd firmware && cargo build --release   build the firmware ({}): src/robot.rs, src/main.rs\n",
            if numbers == NumberFormat::F32 { String::new() } else { format!(",numbers={numbers}") },
            part.name
        ),
        Kind::C => format!(
            "  make test                      test several robots on this computer: src/robot.c\n  \
             make firmware                  build the firmware ({}): complete firmware/board.c first\n",
            part.name
        ),
        Kind::Python => format!(
            "  python3 -m venv .venv && .venv/bin/pip install {place} -e '.[test]'\n  \
             .venv/bin/pytest               test the law in the simulator\n  \
             .venv/bin/python show.py       make a page of a run\n",
        ),
    };
    format!(
        "{folder} created. Next:\n  cd {folder}\n{rest}The project uses Staya at {place}: make it again with --staya PATH or --staya URL \
         for another place.\nSee README.md there.\n"
    )
}

#[cfg(test)]
mod tests;
