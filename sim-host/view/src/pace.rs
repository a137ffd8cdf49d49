//! The clock that decides when the next tick is due.

use std::time::{Duration, Instant};

/// Longest time for ticks between two checks of the pages.
pub const SLICE: Duration = Duration::from_millis(15);
/// A larger delay is not made up for.
const LATE: Duration = Duration::from_millis(250);
const TICKS_A_SECOND: f64 = 10.0;

/// A clock that runs at a multiple of real time, or is paused.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    tick_s: f64,
    speed: Option<f64>,
    is_paused: bool,
    due: Instant,
}

impl Pace {
    /// Creates a clock at real time, or at ten ticks of `tick_s` per second if that is faster.
    pub fn new(tick_s: f64, is_paused: bool) -> Self {
        let speed = Some((tick_s * TICKS_A_SECOND).max(1.0));
        Self { tick_s, speed, is_paused, due: Instant::now() }
    }

    /// Simulated seconds per second; `None` for no limit.
    pub const fn speed(&self) -> Option<f64> {
        self.speed
    }

    /// Whether the clock is paused.
    pub const fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Pauses the clock.
    pub const fn pause(&mut self) {
        self.is_paused = true;
    }

    /// Continues after a pause.
    pub fn play(&mut self) {
        self.is_paused = false;
        self.due = Instant::now();
    }

    /// Sets simulated seconds per second, 0.001 to 1e6; `None`, NaN and infinity: no limit.
    pub fn set_speed(&mut self, speed: Option<f64>) {
        self.speed = speed.filter(|speed| speed.is_finite()).map(|speed| speed.clamp(0.001, 1e6));
        self.due = Instant::now();
    }

    /// Time until the next tick, zero if it is due; `None` while paused.
    pub fn until_due(&self, now: Instant) -> Option<Duration> {
        (!self.is_paused).then(|| self.speed.map_or(Duration::ZERO, |_| self.due.saturating_duration_since(now)))
    }

    /// Records that a tick was done.
    pub fn done(&mut self, now: Instant) {
        if let Some(speed) = self.speed {
            self.due += Duration::from_secs_f64((self.tick_s / speed).min(1e6));
            if self.due + LATE < now {
                self.due = now;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_due_on_time_and_a_long_delay_is_not_made_up() {
        let mut pace = Pace::new(0.05, false);
        assert_eq!(pace.speed(), Some(1.0));
        assert_eq!(Pace::new(2.0, false).speed(), Some(20.0));
        pace.set_speed(Some(2.0));
        let start = pace.due;
        assert_eq!(pace.until_due(start), Some(Duration::ZERO));
        pace.done(start);
        assert_eq!(pace.until_due(start), Some(Duration::from_millis(25)));
        let late = start + Duration::from_secs(60);
        pace.done(late);
        pace.done(late);
        assert_eq!(pace.until_due(late), Some(Duration::from_millis(25)));
        pace.pause();
        assert_eq!(pace.until_due(late), None);
        pace.set_speed(None);
        pace.play();
        pace.done(late);
        assert_eq!(pace.until_due(late), Some(Duration::ZERO));
        for nonsense in [0.0, -1.0, 1e300, f64::NAN] {
            pace.set_speed(Some(nonsense));
            pace.done(late);
        }
    }
}
