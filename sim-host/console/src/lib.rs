//! Parts common to all commands of `staya`: shared options, progress, Ctrl-C, output. Results go to
//! standard output, progress and errors to standard error.

pub mod options;
mod progress;
mod scenario;

pub use progress::{Progress, Stop};
pub use scenario::{ScenarioArgs, WatchArgs};
pub use staya_sim::shown::{Shown, one_line, printable};

use anyhow::{Context as _, Result};
use clap::error::{ContextKind, ContextValue};
use clap::{Args, Parser, Subcommand};
use serde::Serialize;
use std::borrow::Cow;
use std::io::{self, ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of every command.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Global {
    /// Print one JSON object on standard output instead of tables.
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub json: bool,
    /// Number of threads, at most one per processor (the default); results do not depend on it.
    #[arg(long, global = true, help_heading = "Options of every command", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Show no progress.
    #[arg(long, short, global = true, help_heading = "Options of every command")]
    pub quiet: bool,
}

impl Global {
    /// Starts the thread pool; call this once, before any parallel work.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn begin(&self) -> Result<()> {
        if let Some(threads) = self.threads {
            let processors = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
            rayon::ThreadPoolBuilder::new()
                .num_threads(usize::from(threads).min(processors))
                .build_global()
                .with_context(|| format!("cannot start {threads} threads"))?;
        }
        Ok(())
    }
}

/// Version in results: `0.1.0+298ef29bca11` with the commit that `build.rs` finds, then a hash of
/// uncommitted changes, as in `0.1.0+298ef29bca11.5f0c2d9a`.
pub const VERSION: &str = env!("STAYA_VERSION");

/// Command line of a program: the options of every command, and the program's own commands `C`.
///
/// Every program calls itself `staya`, because `staya` passes its command line on unchanged.
#[derive(Debug, Parser)]
#[command(name = "staya", bin_name = "staya", version = VERSION, propagate_version = true)]
#[command(about = "Simulate swarms of robots, and run their controllers on hardware", long_about = None)]
pub struct Line<C: Subcommand> {
    /// Options of every command.
    #[command(flatten)]
    pub global: Global,
    /// The command.
    #[command(subcommand)]
    pub command: C,
}

/// Runs a program: parses the command line, runs the command and reports its errors.
#[must_use]
pub fn main<C: Subcommand>(run: impl FnOnce(&C, &Global) -> Result<Ended>) -> ExitCode {
    let Line { global, command } = Line::try_parse().unwrap_or_else(|error| refuse(error));
    exit("staya", global.begin().and_then(|()| run(&command, &global)))
}

/// Reports an error of the command line, and ends the process with clap's exit code. Texts of the
/// standard library are replaced by the values that an option takes; old names get the new one.
/// Control characters of arguments are escaped.
pub fn refuse(error: clap::Error) -> ! {
    const TEXTS: [(&str, &str); 10] = [
        ("invalid digit found in string", "give a whole number, 0 or more"),
        ("number too large to fit in target type", "the number is too large"),
        ("cannot parse integer from empty string", "give a whole number"),
        ("invalid float literal", "give a number"),
        ("invalid socket address syntax", "give ADDRESS:PORT with a port from 0 to 65535, such as 127.0.0.1:8080"),
        ("unexpected argument '--anew' found", "the option --anew is called --restart now"),
        ("unrecognized subcommand 'simulate'", "there is no command 'simulate'; `staya run` simulates a scenario"),
        ("unrecognized subcommand 'sim'", "there is no command 'sim'; `staya run` simulates a scenario"),
        ("unrecognized subcommand 'watch'", "there is no command 'watch'; `staya view` shows a run in the browser"),
        ("unrecognized subcommand 'mavlink'", "there is no command 'mavlink'; `staya bridge` speaks MAVLink"),
    ];
    let error = with_safe_arguments(error);
    let said = error.render().to_string();
    let mut text = printable(&said).into_owned();
    if let Some((old, new)) = TEXTS.iter().find(|(old, _)| text.contains(old)) {
        text = text.replacen(old, new, 1);
    }
    if text != said {
        // Standard error may be closed.
        let _ = io::stderr().write_all(text.as_bytes());
        std::process::exit(error.exit_code());
    }
    error.exit()
}

/// The error with every quoted argument on one line.
fn with_safe_arguments(mut error: clap::Error) -> clap::Error {
    let safe = |(kind, value): (ContextKind, &ContextValue)| match value {
        ContextValue::String(text) => Some((kind, ContextValue::String(one_line(text).into_owned()))),
        ContextValue::Strings(texts) => {
            let texts = texts.iter().map(|text| one_line(text).into_owned());
            Some((kind, ContextValue::Strings(texts.collect())))
        }
        // A tip repeats the argument. Without its control characters it would mislead.
        ContextValue::StyledStrs(tips) => {
            let is_harmful = tips.iter().map(ToString::to_string).any(|tip| one_line(&tip) != tip);
            is_harmful.then_some((kind, ContextValue::None))
        }
        _ => None,
    };
    let safe: Vec<_> = error.context().filter_map(safe).collect();
    for (kind, value) in safe {
        error.insert(kind, value);
    }
    error
}

/// Parses a file name with one of these endings, without the dot.
///
/// # Errors
/// The name has another ending; the text names those that are allowed.
pub fn file_ending(name: &str, endings: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    let is_allowed = path.extension().is_some_and(|ending| endings.iter().any(|one| ending.eq_ignore_ascii_case(one)));
    if is_allowed { Ok(path) } else { Err(format!("the file name must end in .{}", endings.join(" or ."))) }
}

/// How a successful command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It completed.
    Done,
    /// Ctrl-C or a termination signal stopped it; results so far are kept.
    Interrupted,
}

impl Ended {
    /// `Interrupted` if `stop` was requested.
    #[must_use]
    pub fn by(stop: &Stop) -> Self {
        if stop.is_requested() { Self::Interrupted } else { Self::Done }
    }
}

/// Writes text to standard output; control characters other than line feeds and tabs are
/// [escaped](printable).
///
/// # Errors
/// Standard output is closed or full.
pub fn print(text: &str) -> Result<()> {
    write_out(&printable(text))
}

fn write_out(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).context("cannot write to standard output")
}

/// Writes a remark and a line feed to standard error; control characters other than line feeds and
/// tabs are [escaped](printable). Standard error may be closed or full, which ends no program.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", printable(text));
}

/// Writes one JSON object and a line feed to standard output.
///
/// # Errors
/// Standard output is closed or full, or `value` cannot be encoded as JSON.
pub fn print_json(value: &impl Serialize) -> Result<()> {
    let mut text = safe_json(&serde_json::to_string_pretty(value)?).into_owned();
    text.push('\n');
    write_out(&text)
}

/// JSON escapes control characters up to 31 only; terminals obey others too.
fn safe_json(text: &str) -> Cow<'_, str> {
    let is_harmful = |letter: char| letter.is_control() && letter > '~';
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        match letter {
            harmful if is_harmful(harmful) => safe.extend(format!("\\u{:04x}", u32::from(harmful)).chars()),
            other => safe.push(other),
        }
    }
    Cow::Owned(safe)
}

/// Exit code of a command: 0 for success, 1 for a printed error, 130 for Ctrl-C.
#[must_use]
pub fn exit(program: &str, ended: Result<Ended>) -> ExitCode {
    match ended {
        Ok(Ended::Done) => ExitCode::SUCCESS,
        Ok(Ended::Interrupted) => ExitCode::from(130),
        // The reader of a pipe (`staya ... | head`) may close it.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // The exit code reports the failure even if standard error is closed.
            say(&format!("{program}: {}", in_one_line(&error)));
            ExitCode::FAILURE
        }
    }
}

/// An error with its causes, without causes that the message already contains.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_in_texts_of_clap_are_on_one_line() {
        let evil = "--a\n\u{1b}[2Jb";
        let command = clap::Command::new("staya").arg(clap::arg!(--seed <N>).value_parser(clap::value_parser!(u64)));
        for arguments in [vec!["staya", evil], vec!["staya", "--seed", &evil[2..]], vec!["staya", "--seed=1\r\u{7}"]] {
            let error = command.clone().try_get_matches_from(arguments).expect_err("no such argument");
            let text = with_safe_arguments(error).render().to_string();
            let harmful = |letter: char| letter.is_control() && letter != '\n';
            assert!(text.contains("\\u{1b}") || text.contains("\\r"), "{text:?}");
            assert!(!text.contains(harmful) && !text.contains("a\n"), "{text:?}");
        }
    }

    #[test]
    fn json_has_no_control_characters_and_the_same_value() {
        let value = ["\u{1b}[2J", "\u{7f}", "\u{9b}0m", "\u{e9}"];
        let text = serde_json::to_string_pretty(&value).expect("texts");
        let safe = safe_json(&text);
        assert!(!safe.contains(|letter: char| letter.is_control() && letter != '\n'), "{safe}");
        assert_eq!(serde_json::from_str::<[String; 4]>(&safe).expect("JSON"), value);
    }
}
