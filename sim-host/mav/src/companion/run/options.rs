//! Options of companions, and why they cannot start or continue.

use crate::companion::medium::MediumError;
use crate::companion::seal::SealError;
use crate::{OpenError, Tlog};
use staya_sim::key::KeyError;
use std::io;
use std::time::Duration;

/// Longest demo, seconds.
pub(super) const DEMO_S: f64 = 600.0;

/// Options of the command line.
#[derive(Debug, Default)]
pub struct Options {
    /// Show the messages that would be sent, and send nothing.
    pub dry_run: bool,
    /// Do not show changes of state.
    pub quiet: bool,
    /// Duration in seconds; `None` runs until stopped.
    pub seconds: Option<f64>,
    /// Simulated autopilots in place of the configured links; the run ends when all vehicles have
    /// arrived, or after ten minutes.
    pub demo: bool,
    /// Runs the demo in real time.
    pub is_real_time: bool,
    /// Ends with an error if no autopilot is heard within this time; `None` waits forever.
    pub wait: Option<Duration>,
    /// Log of all sent and accepted messages.
    pub tlog: Option<Tlog>,
}

/// Why companions cannot start or continue.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A link cannot be opened.
    #[error(transparent)]
    Line(#[from] OpenError),
    /// The LAN is unavailable.
    #[error(transparent)]
    Medium(#[from] MediumError),
    /// The key of packets is unusable.
    #[error(transparent)]
    Seal(#[from] SealError),
    /// The key of links is unusable.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// No autopilot was heard.
    #[error(
        "no autopilot heard within {seconds} s on {links}; start the vehicles or correct `link`, wait longer with --wait N \
         (0: forever), or try --demo, which simulates the vehicles"
    )]
    NoAutopilot {
        /// The time, seconds.
        seconds: f64,
        /// The links, with the reason where one has no connection.
        links: String,
    },
    /// Standard output cannot be written during a dry run.
    #[error("cannot write to standard output: {0}")]
    Output(io::Error),
}
