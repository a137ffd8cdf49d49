//! What every command of `staya` does alike: the options that all understand, progress, Ctrl-C, printing.
//!
//! Results go to standard output, progress and errors to standard error.

pub mod options;
mod progress;
mod scenario;

pub use progress::{Progress, Stop};
pub use scenario::{ScenarioArgs, WatchArgs};

use anyhow::{Context as _, Result};
use clap::{Args, Parser, Subcommand};
use serde::Serialize;
use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

/// Options that every command understands.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Global {
    /// Print one JSON object on standard output instead of tables.
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub json: bool,
    /// Threads to use, at most one per processor, which is the default; results never depend on it.
    #[arg(long, global = true, help_heading = "Options of every command", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Show no progress.
    #[arg(long, short, global = true, help_heading = "Options of every command")]
    pub quiet: bool,
}

impl Global {
    /// Makes the pool of as many threads as are wanted; once, before the first of them works.
    ///
    /// # Errors
    /// They cannot be started.
    pub fn begin(&self) -> Result<()> {
        if let Some(threads) = self.threads {
            // More than one for each processor only cost time.
            let processors = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
            rayon::ThreadPoolBuilder::new()
                .num_threads(usize::from(threads).min(processors))
                .build_global()
                .with_context(|| format!("cannot start {threads} threads"))?;
        }
        Ok(())
    }
}

/// The version of this program, as results have it: `0.1.0`, and what `build.rs` knows of the commit, as in
/// `0.1.0+298ef29bca11` or, for sources that differ from that commit, `0.1.0+298ef29bca11.5f0c2d9a`.
pub const VERSION: &str = env!("STAYA_VERSION");

/// The command line of each program: the options of every command, and the commands `C` of this program.
///
/// Every program calls itself `staya`, since `staya` hands its own command line over unchanged.
#[derive(Debug, Parser)]
#[command(name = "staya", bin_name = "staya", version = VERSION, propagate_version = true)]
pub struct Line<C: Subcommand> {
    /// The options of every command.
    #[command(flatten)]
    pub global: Global,
    /// The command.
    #[command(subcommand)]
    pub command: C,
}

/// The whole of a program: parses the command line, runs the command and reports its errors.
#[must_use]
pub fn main<C: Subcommand>(run: impl FnOnce(&C, &Global) -> Result<Ended>) -> ExitCode {
    let Line { global, command } = Line::parse();
    exit("staya", global.begin().and_then(|()| run(&command, &global)))
}

/// How a command that did not fail came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// By itself.
    Done,
    /// By Ctrl-C or a termination signal; what was done until then is kept.
    Interrupted,
}

impl Ended {
    /// `Interrupted` when `stop` was requested.
    #[must_use]
    pub fn by(stop: &Stop) -> Self {
        if stop.is_requested() { Self::Interrupted } else { Self::Done }
    }
}

/// Writes text to standard output.
///
/// # Errors
/// When standard output is closed or full.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).context("cannot write to standard output")
}

/// Writes one JSON object and a line feed to standard output.
///
/// # Errors
/// When standard output is closed or full, or `value` has no JSON form.
pub fn print_json(value: &impl Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    print(&text)
}

/// The exit code of a command of `program`: 0 done, 1 failed, with the reason on standard error, 130 stopped by Ctrl-C.
#[must_use]
pub fn exit(program: &str, ended: Result<Ended>) -> ExitCode {
    match ended {
        Ok(Ended::Done) => ExitCode::SUCCESS,
        Ok(Ended::Interrupted) => ExitCode::from(130),
        // The reader of a pipe (`staya ... | head`) went away: nothing to tell anybody.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // Standard error may be closed as well; the exit code still tells.
            let _ = writeln!(io::stderr(), "{program}: {}", in_one_line(&error));
            ExitCode::FAILURE
        }
    }
}

/// An error and its causes; a cause that the message before it quotes is not said again.
#[must_use]
pub fn in_one_line(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| cause.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe))
}
