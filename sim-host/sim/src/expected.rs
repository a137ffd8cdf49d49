//! Predicts the number of ticks of a run, since most runs end long before their limit.

use crate::record::RobotRow;
use staya_controller::robot::Mode;

/// Share of the longest distance that must be done before a prediction is made.
const BEGUN: f64 = 0.05;

/// Predicts the end of a run from the decrease of the longest remaining distance.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    ticks: u32,
    longest: Option<(f64, u32)>,
    left_m: Option<f64>,
}

impl Expected {
    /// Creates a predictor for a run of at most `ticks`.
    #[must_use]
    pub const fn new(ticks: u32) -> Self {
        Self { ticks, longest: None, left_m: None }
    }

    /// Records a robot in the current tick. O(1).
    pub fn see(&mut self, robot: &RobotRow) {
        let Some(target_m) = robot.target_m.filter(|_| robot.mode != Mode::Arrived) else {
            return;
        };
        let off = [0, 1, 2].map(|axis| target_m[axis] - robot.motion.position_m[axis]);
        let way_m = libm::sqrt(off.iter().map(|m| m * m).sum());
        self.left_m = Some(self.left_m.map_or(way_m, |left_m| left_m.max(way_m)));
    }

    /// Predicted number of ticks, once all robots of `tick` were recorded; else the run's limit.
    pub fn ticks(&mut self, tick: u32) -> u32 {
        let left_m = self.left_m.take();
        let Some(left_m) = left_m else {
            // All have arrived, or no robot has a goal.
            return if self.longest.is_some() { tick.min(self.ticks) } else { self.ticks };
        };
        let (longest_m, since) = match self.longest {
            Some((longest_m, since)) if longest_m >= left_m => (longest_m, since),
            // The run begins, or a robot got another goal.
            _ => {
                self.longest = Some((left_m, tick));
                return self.ticks;
            }
        };
        let done_m = longest_m - left_m;
        if done_m < BEGUN * longest_m {
            return self.ticks;
        }
        let left = left_m / done_m * f64::from(tick.saturating_sub(since));
        tick.saturating_add(libm::ceil(left) as u32).clamp(tick, self.ticks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::simulate;
    use crate::scenario::{Overrides, Scenario};
    use std::ops::ControlFlow;

    #[test]
    fn the_end_is_predicted_early() {
        let text = "name = 'duel'\nticks = 700\ntick_s = 0.1\n[plane]\nradius_m = 0.3\nmax_speed_mps = 1\n\
            [plane.robots.circle]\ncount = 6\nradius_m = 6\n";
        let scenario = Scenario::parse(text, "duel.toml".as_ref(), &Overrides::default()).expect("a scenario");
        let (mut expected, mut seen) = (Expected::new(scenario.ticks), Vec::new());
        let outcome = simulate(&scenario, |moment, robots| {
            robots.for_each(|robot| expected.see(&robot));
            seen.push((moment.row.tick, expected.ticks(moment.row.tick)));
            ControlFlow::Continue(())
        });
        let end = outcome.expect("room").ticks;
        assert!(end * 4 < scenario.ticks, "{end}");
        assert_eq!(seen[0].1, scenario.ticks);
        for (tick, foreseen) in seen {
            assert!((tick..=scenario.ticks).contains(&foreseen), "{tick}: {foreseen}");
            if tick > end / 3 {
                let off = f64::from(foreseen.abs_diff(end)) / f64::from(end);
                assert!(off < 0.34, "{tick}: {foreseen} of {end}");
            }
        }
    }
}
