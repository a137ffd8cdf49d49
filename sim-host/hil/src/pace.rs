use serde::Serialize;
use staya_console::Stop;
use std::time::{Duration, Instant};

#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct RealTime {
    pub(crate) tick_seconds: f64,
    pub(crate) deadlines_missed: u32,
    pub(crate) slowest_seconds: f64,
}

pub(crate) struct Pace {
    pub(crate) report: RealTime,
    /// Starts of tick 0 and of the present tick.
    began: Option<(Instant, Instant)>,
}

impl Pace {
    pub(crate) const fn new(tick_seconds: f64) -> Self {
        Self { report: RealTime { tick_seconds, deadlines_missed: 0, slowest_seconds: 0.0 }, began: None }
    }

    /// After a late tick the clock restarts. The first tick starts the devices and does not count.
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
            // Sleeps in short parts to notice a request to stop.
            std::thread::sleep(left.min(Duration::from_millis(100)));
        }
        self.began = Some((due, Instant::now()));
    }
}
