use crate::Tlog;
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
