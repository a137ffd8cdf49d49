//! What every command of `staya` does alike: the options that all understand, progress, Ctrl-C, printing.
//!
//! Results go to standard output, progress and errors to standard error.

mod progress;

pub use progress::{Progress, Stop};

use anyhow::{Context as _, Result};
use clap::Args;
use serde::Serialize;
use std::io::{self, Write as _};

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
