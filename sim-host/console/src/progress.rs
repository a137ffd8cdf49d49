use super::{Global, printable, say};
use anyhow::{Context as _, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const LINE_EVERY: Duration = Duration::from_secs(5);

/// A request to stop early, shared by all clones.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Creates a request that Ctrl-C or a termination signal sets; the second ends the process.
    ///
    /// # Errors
    /// The signal handler cannot be installed, for example on the second call in a process.
    pub fn on_ctrl_c() -> Result<Self> {
        let stop = Self::default();
        let request = stop.clone();
        ctrlc::set_handler(move || {
            if request.0.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        })
        .context("cannot listen for Ctrl-C")?;
        Ok(stop)
    }

    /// Requests an early end.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// The flag itself, for callers without a `Stop`.
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }

    /// Whether an early end was requested.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Progress of long work: a bar with an estimate on a terminal, occasional lines elsewhere.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    label: String,
    lines: Option<Instant>,
}

impl Progress {
    /// Creates progress over `total` steps, shown as `label`.
    #[must_use]
    pub fn new(label: &str, total: u64, global: &Global) -> Self {
        let terminal = io::stderr().is_terminal();
        let target = if terminal && !global.quiet {
            ProgressDrawTarget::stderr_with_hz(10)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        // The message is cut at the last column, so that the line does not wrap.
        let style = "[{bar:10}] {eta} left, {pos}/{len}{wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("=> "));
        }
        let label = in_a_line(label);
        bar.set_message(spaced(&label));
        Self { bar, label, lines: (!terminal && !global.quiet).then(Instant::now) }
    }

    /// Sets the total number of steps.
    pub fn of(&mut self, total: u64) {
        self.bar.set_length(total);
    }

    /// Sets the number of finished steps; `message` returns a short status.
    pub fn set(&mut self, done: u64, message: impl FnOnce() -> String) {
        self.bar.set_position(done);
        if !self.bar.is_hidden() {
            let message = in_a_line(&message());
            self.bar.set_message(spaced(if message.is_empty() { &self.label } else { &message }));
        } else if self.lines.is_some_and(|at| at.elapsed() >= LINE_EVERY) {
            self.lines = Some(Instant::now());
            let (label, total, left) = (&self.label, self.bar.length().unwrap_or(0), self.bar.eta().as_secs());
            let message = spaced(&in_a_line(&message()));
            say(&format!("{label}: {done}/{total}{message}, about {left} s left"));
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn in_a_line(text: &str) -> String {
    printable(text).replace(['\n', '\t'], " ")
}

fn spaced(message: &str) -> String {
    match message {
        "" => String::new(),
        _ => format!(" {message}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_cannot_move_the_cursor() {
        assert_eq!(in_a_line("a\n\tb\r\u{1b}[2J"), "a  b\\r\\u{1b}[2J");
    }

    #[test]
    fn only_a_non_empty_message_is_spaced() {
        assert_eq!(spaced(""), "");
        assert_eq!(spaced("ticks"), " ticks");
    }
}
