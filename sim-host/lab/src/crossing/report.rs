//! Tables of swap and doorway.

use super::{Conditions, doorway, swap};
use crate::experiment::Maybe;
use std::fmt::{Display, Formatter, Result};

fn milli(gap_m: Option<f64>) -> Maybe {
    Maybe(gap_m.map(|gap| gap * 1000.0), 1)
}

pub(super) fn headline(f: &mut Formatter<'_>, what: &str, conditions: &Conditions, noise_m: f64) -> Result {
    let Conditions { step_s, speed_mps, range_m, loss, safety } = conditions;
    writeln!(
        f,
        "{what}: dt {step_s} s, {speed_mps} m/s, starts off by up to {noise_m} m, radio {range_m} m with {:.0} % lost, safety {safety:?}",
        loss * 100.0
    )
}

impl Display for swap::Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        headline(f, "swap over a circle", &self.conditions, self.noise_m)?;
        writeln!(f, "robots  circle (m)  clean runs   arrived  worst time / free  least gap (mm)  overlaps")?;
        for row in &self.rows {
            let all = row.robots as usize * row.runs;
            writeln!(
                f,
                "{:6}  {:10.1}  {:>10}  {:>8}  {:>17}  {:>14}  {:8}",
                row.robots,
                row.circle_m,
                format!("{}/{}", row.clean, row.runs),
                format!("{}/{all}", row.arrived),
                Maybe(row.worst_time_ratio, 3),
                milli(row.least_gap_m),
                row.overlaps,
            )?;
        }
        Ok(())
    }
}

impl Display for doorway::Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        headline(f, "doorway", &self.conditions, self.noise_m)?;
        writeln!(
            f,
            "width (m)  seed  arrived  through (W+E)  last (s)  time / free  turns  least gap (mm)  to wall (mm)  overlaps"
        )?;
        for run in &self.runs {
            let [west, east] = run.through;
            writeln!(
                f,
                "{:9.2}  {:4}  {:>7}  {:>13}  {:>8}  {:>11}  {:5}  {:>14}  {:>12}  {:8}",
                run.width_m,
                run.seed,
                format!("{}/{}", run.arrived, run.robots),
                format!("{west}+{east}"),
                Maybe(run.last_s, 1),
                Maybe(run.time_ratio, 2),
                run.turns,
                milli(run.least_gap_m),
                milli(run.least_wall_gap_m),
                run.overlaps,
            )?;
        }
        Ok(())
    }
}
