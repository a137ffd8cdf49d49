//! `staya new NAME`: a project of one's own that compiles and whose test runs. What it is made of are the files in `templates`: those of
//! a project named `my-swarm`, with the folder `/STAYA` for this repository.

mod files;
mod source;

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use clap::Args;
use files::{C, File, PARTS, PYTHON, Part, RUST};
use source::Source;
use staya_console::{Ended, Global, print};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Make a project of your own: a guidance law, its scenario, a test in the simulator, firmware.
#[derive(Args, Clone, Debug)]
#[command(after_help = "In Rust, unless --c or --python is said. Next: the README.md in the new folder.")]
pub struct NewArgs {
    /// Folder to make; its last part is the project's name.
    #[arg(value_name = "NAME", required_unless_present = "list")]
    folder: Option<PathBuf>,
    /// The robot's part: see --list [default: stm32f405].
    #[arg(long, value_name = "PART", value_parser = part, conflicts_with = "python")]
    part: Option<&'static Part>,
    /// In C, over the static library.
    #[arg(long, conflicts_with = "python")]
    c: bool,
    /// In Python: a law over arrays; no firmware.
    #[arg(long)]
    python: bool,
    /// Where Staya's sources are: a folder, or an address for git [default: what this program was built from].
    #[arg(long, value_name = "PATH|URL")]
    staya: Option<String>,
    /// List the parts, and make nothing.
    #[arg(long, conflicts_with = "folder")]
    list: bool,
}

/// What a project is written in.
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
    /// A name that no package can have, a folder that is there or cannot be made, sources of Staya that are not there.
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
        let source = Source::find(self.staya.as_deref())?;
        let files = files(kind, part)?;
        write(folder, name, &files, &locks(kind, part), &source)?;
        if !global.quiet {
            print(&next(folder, kind, part))?;
        }
        Ok(Ended::Done)
    }
}

fn part(text: &str) -> Result<&'static Part, String> {
    let found = PARTS.iter().find(|part| part.name == text);
    found.ok_or_else(|| format!("no such part; there are {}", names(&PARTS)))
}

fn names<'a>(parts: impl IntoIterator<Item = &'a Part>) -> String {
    let names: Vec<&str> = parts.into_iter().map(|part| part.name).collect();
    names.join(", ")
}

/// The parts, as a table.
fn list() -> String {
    let mut text = String::from("part       --c  emulator  target                       is\n");
    for Part { name, title, target, is_emulated, c, .. } in &PARTS {
        let (c, emulator) = (if c.is_empty() { "no" } else { "yes" }, if *is_emulated { "QEMU" } else { "none" });
        let _ = writeln!(text, "{name:10} {c:4} {emulator:9} {target:28} {title}");
    }
    text + "The law of any Rust project also runs on the emulated stm32f405: its folder hil.\n"
}

/// Words that are a project's of its own, or that no crate may be named by.
const TAKEN: [&str; 12] =
    ["alloc", "core", "firmware", "hil", "numpy", "proc-macro", "pytest", "serde", "std", "target", "test", "tests"];
/// Rust's and Python's keywords that consist of small letters.
const KEYWORDS: &str = "abstract and as assert async await become box break class const continue crate def del do dyn elif else enum \
    except extern false final finally fn for from gen global if impl import in is lambda let loop macro match mod move mut nonlocal not \
    or override pass priv pub raise ref return self static struct super trait true try type typeof union unsafe unsized use virtual \
    where while with yield";
/// Longest name, letters.
const LONGEST: usize = 40;

/// The project's name: what cargo, C and Python all take.
fn name(folder: &Path) -> Result<&str> {
    let last = folder.file_name().and_then(|name| name.to_str());
    let name = last.with_context(|| format!("{}: no name; say what the project is to be called", folder.display()))?;
    let is_word = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_')
        && name.len() <= LONGEST;
    ensure!(
        is_word,
        "{name}: not the name of a package; take at most {LONGEST} of a to z, 0 to 9, - and _, a letter first"
    );
    let is_free =
        !TAKEN.contains(&name) && !name.starts_with("staya") && KEYWORDS.split_whitespace().all(|word| word != name);
    ensure!(is_free, "{name}: this name is taken, by a language or by what the project is made of; take another one");
    Ok(name)
}

/// The files of a project.
fn files(kind: Kind, part: &Part) -> Result<Vec<File>> {
    let files = match kind {
        Kind::Rust => [RUST, part.rust].concat(),
        Kind::C if part.c.is_empty() => {
            let parts = names(PARTS.iter().filter(|part| !part.c.is_empty()));
            bail!("no firmware in C for {}; with --c there are {parts} (docs/c.md has ESP-IDF)", part.name)
        }
        Kind::C => [C, part.c].concat(),
        Kind::Python => PYTHON.to_vec(),
    };
    Ok(files)
}

/// Lock files of a project, and those of this repository that they are: the versions of dependencies that are tested here. They hold more
/// than a project needs; cargo drops the rest.
fn locks(kind: Kind, part: &Part) -> Vec<(&'static str, &'static str)> {
    let firmware = part.lock.map(|lock| ("firmware/Cargo.lock", lock));
    match kind {
        Kind::Rust => {
            [("Cargo.lock", "Cargo.lock"), ("hil/Cargo.lock", "Cargo.lock")].into_iter().chain(firmware).collect()
        }
        Kind::C | Kind::Python => Vec::new(),
    }
}

/// Makes the folder, which must not be there, and writes the files and the lock files into it. If that fails the folder is gone again.
fn write(folder: &Path, name: &str, files: &[File], locks: &[(&str, &str)], source: &Source) -> Result<()> {
    let shown = folder.display();
    if let Some(parent) = folder.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        ensure!(parent.is_dir(), "{}: no such folder; make it first", parent.display());
    }
    fs::create_dir(folder).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => anyhow!("{shown} is there already; take another name"),
        _ => anyhow!("{shown}: {error}; take a folder that can be written to"),
    })?;
    // A module in Python is called as the project is, in files as in texts.
    let filled = files.iter().map(|(path, text)| (folder.join(source.fill(path, name)), source.fill(text, name)));
    let locks = locks.iter().filter_map(|(path, own)| Some((folder.join(path), source.lock(own)?)));
    for (path, text) in filled.chain(locks) {
        if let Err(error) = write_file(&path, &text) {
            // It was made above, so all that is in it is this program's.
            let _ = fs::remove_dir_all(folder);
            bail!("{}: {error}; nothing was made", path.display());
        }
    }
    Ok(())
}

fn write_file(path: &Path, text: &str) -> std::io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::write(path, text)
}

/// What to do now.
fn next(folder: &Path, kind: Kind, part: &Part) -> String {
    let folder = folder.display();
    let rest = match kind {
        Kind::Rust => format!(
            "  cargo test                     the law in the simulator: src/lib.rs, scenario.toml\n  \
             cargo run --example run -- run.staya && staya view run.staya\n  \
             cd hil && cargo run -- ../scenario.toml --device qemu:stm32f405 --devices 2   the law on emulated parts\n  \
             cd firmware && cargo build --release   the robot ({}): src/robot.rs, src/main.rs\n",
            part.name
        ),
        Kind::C => format!(
            "  make test                      the robot, several times, on this computer: src/robot.c\n  \
             make firmware                  for the {}: fill in firmware/board.c\n",
            part.name
        ),
        Kind::Python => String::from(
            "  python3 -m venv .venv && .venv/bin/pip install -e '.[test]'\n  \
             .venv/bin/pytest               the law in the simulator\n  \
             .venv/bin/python show.py       a page of a run\n",
        ),
    };
    format!("{folder} is made. Next:\n  cd {folder}\n{rest}README.md there has the rest.\n")
}

#[cfg(test)]
mod tests;
