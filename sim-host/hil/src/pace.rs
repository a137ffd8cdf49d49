//! Runs in real time.

use serde::Serialize;
use staya_console::Stop;
use std::time::{Duration, Instant};

/// How a run kept up with the clock.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct RealTime {
    pub(crate) tick_seconds: f64,
    /// Ticks whose work was not done when the next one was due.
    pub(crate) deadlines_missed: u32,
    /// The longest that a tick's work took, seconds.
    pub(crate) slowest_seconds: f64,
}

/// Keeps a run to the clock.
pub(crate) struct Pace {
    pub(crate) report: RealTime,
    /// When tick 0 began, and since when the present one is at work.
    began: Option<(Instant, Instant)>,
}

impl Pace {
    pub(crate) const fn new(tick_seconds: f64) -> Self {
        Self { report: RealTime { tick_seconds, deadlines_missed: 0, slowest_seconds: 0.0 }, began: None }
    }

    /// Waits until the tick after `ticks` ticks is due. Those that came late are not made up for: the clock starts anew with them.
    /// The first tick does not count: it starts the devices.
    pub(crate) fn wait(&mut self, ticks: u32, stop: &Stop) {
        let now = Instant::now();
        let tick = Duration::from_secs_f64(self.report.tick_seconds);
        let due = match self.began {
            Some((due, since)) if ticks > 1 => {
                let took = now.duration_since(since).as_secs_f64();
                self.report.slowest_seconds = self.report.slowest_seconds.max(took);
                let next = due + tick;
                if now > next {
                    self.report.deadlines_missed += 1;
                }
                next.max(now)
            }
            _ => now,
        };
        while !stop.is_requested() {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            // Looks at the request to stop now and then.
            std::thread::sleep(left.min(Duration::from_millis(100)));
        }
        self.began = Some((due, Instant::now()));
    }
}
