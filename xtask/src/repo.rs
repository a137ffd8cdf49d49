//! Where things are, and how a child process is started.

use crate::files;
use anyhow::{Context as _, Result, ensure};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Set by `bless` for tests that compare with golden files: write instead of compare.
pub const BLESS: &str = "STAYA_BLESS";

/// Arguments as on a command line.
pub trait Words {
    /// Adds the words of a line, which blanks separate.
    fn words(&mut self, line: &str) -> &mut Self;
}

impl Words for Command {
    fn words(&mut self, line: &str) -> &mut Self {
        self.args(line.split_whitespace())
    }
}

/// An error that a command plants in a copy of a file: something else must notice it.
pub struct Plant {
    /// A name of the error.
    pub name: &'static str,
    pub file: &'static str,
    /// Stands there once.
    pub right: &'static str,
    pub wrong: &'static str,
}

impl Plant {
    /// The text of the file with the error in it.
    pub fn planted(&self, text: &str) -> Result<String> {
        let Self { file, right, wrong, .. } = self;
        let times = text.matches(right).count();
        ensure!(times == 1, "{file}: {times} times `{right}`: bring the list of errors up to date");
        ensure!(right != wrong, "{file}: the error changes nothing");
        Ok(text.replace(right, wrong))
    }
}

/// The repository that this program was built from.
pub struct Repo {
    /// Its top folder.
    pub root: PathBuf,
    /// Cargo's target folder.
    pub target: PathBuf,
    /// Where programs are that were fetched for this repository alone.
    tools: PathBuf,
}

impl Repo {
    /// Finds the repository. Cargo names the folder of this crate when it runs it, so a copied or
    /// moved repository is found as well.
    pub fn find() -> Self {
        let here = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        let root = Path::new(&here).parent().unwrap_or(Path::new(&here)).to_path_buf();
        // Cargo reads a relative one from where it was started, as does `absolute`.
        let target = std::env::var_os("CARGO_TARGET_DIR").and_then(|folder| std::path::absolute(folder).ok());
        let target = target.unwrap_or_else(|| root.join("target"));
        Self { tools: target.join("tools/bin"), target, root }
    }

    /// Where programs are that were fetched for this repository alone.
    pub fn tools(&self) -> &Path {
        &self.tools
    }

    /// A copy of the repository below a folder of the target folder, with a target folder and the
    /// same tools; [`Repo::copy`] fills it.
    pub fn in_target(&self, folder: &str) -> Self {
        let target = self.target.join(folder);
        Self { root: target.join("sources"), tools: self.tools.clone(), target }
    }

    /// A program to run at the top of the repository, without standard input; it and its children
    /// find [`Repo::tools`] as well.
    pub fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::env::split_paths(&path).chain([self.tools.clone()]);
        if let Ok(path) = std::env::join_paths(folders) {
            command.env("PATH", path);
        }
        command
            .current_dir(&self.root)
            .stdin(Stdio::null())
            // Only `bless` may rewrite golden files, whatever the caller's environment says.
            .env_remove(BLESS);
        command
    }

    /// The output of a command of the shell, whose `$1` is [`Repo::tools`]; `None` unless it
    /// succeeds.
    pub fn answer(&self, question: &str) -> Option<String> {
        output_of(self.command("sh").args(["-c", question, "sh"]).arg(self.tools()))
    }

    /// Whether a command of the shell succeeds.
    pub fn says(&self, question: &str) -> bool {
        self.answer(question).is_some()
    }

    /// Copies the sources, without what git ignores, to a folder: `change` gives the bytes of each
    /// file by its path. Unchanged files are not written, so that cargo builds only the difference.
    pub fn copy(&self, to: &Path, mut change: impl FnMut(&Path, Vec<u8>) -> Vec<u8>) -> Result<()> {
        let listed = self.answer("git ls-files --cached --others --exclude-standard");
        for file in listed.context("git ls-files fails")?.lines().map(Path::new) {
            let (from, to) = (self.root.join(file), to.join(file));
            if from.is_file() {
                files::update(&to, &change(file, files::bytes(&from)?))?;
            }
        }
        Ok(())
    }

    /// A copy with the error.
    pub fn plant(&self, to: &Path, plant: &Plant) -> Result<()> {
        let text = plant.planted(&files::read(&self.root.join(plant.file))?)?;
        self.copy(to, |path, bytes| if path == Path::new(plant.file) { text.clone().into_bytes() } else { bytes })
    }

    /// A program that was built by the profile `debug` or `release`.
    pub fn program(&self, profile: &str, name: &str) -> PathBuf {
        self.target.join(profile).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// The cargo that runs this program, with the arguments of this line.
    pub fn cargo(&self, line: &str) -> Command {
        let mut command = self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.words(line).env("CARGO_TARGET_DIR", &self.target);
        command
    }

    /// The same in a folder of the repository, which may be a workspace of its own. It builds in
    /// the same folder: with the same profiles it finds there what it shares with the others.
    pub fn cargo_in(&self, folder: &str, line: &str) -> Command {
        let mut command = self.cargo(line);
        command.current_dir(self.root.join(folder));
        command
    }
}

/// The command line as a person would type it, without folders in front of the program's name.
pub fn shown(command: &Command) -> String {
    let program = files::name(Path::new(command.get_program()));
    let arguments = command.get_args().map(|argument| argument.to_string_lossy().into_owned());
    [program].into_iter().chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Runs a command with its output passed through. The error says why it did not succeed.
pub fn execute(command: &mut Command) -> Result<()> {
    println!("$ {}", shown(command));
    ended(command.status())
}

/// Runs a command, passes its standard output on line by line as it comes, and shows each line to
/// `seen`. The error says why it did not succeed.
pub fn run_reading(command: &mut Command, mut seen: impl FnMut(&str)) -> Result<()> {
    println!("$ {}", shown(command));
    let mut child = command.stdout(Stdio::piped()).spawn().context("cannot start")?;
    if let Some(output) = child.stdout.take() {
        let mut output = BufReader::new(output);
        let mut line = Vec::new();
        // Bytes, not a string: a test may print anything.
        while output.read_until(b'\n', &mut line).is_ok_and(|n| n > 0) {
            let text = String::from_utf8_lossy(&line);
            print!("{text}");
            seen(text.trim_end());
            line.clear();
        }
    }
    ended(child.wait())
}

/// The output of a quiet command; `None` unless it succeeds.
pub fn output_of(command: &mut Command) -> Option<String> {
    let output = command.stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim_end().to_string())
}

/// The reason why a command did not succeed.
pub fn ended(status: std::io::Result<std::process::ExitStatus>) -> Result<()> {
    let status = status.context("cannot start")?;
    ensure!(status.success(), "{status}");
    Ok(())
}
