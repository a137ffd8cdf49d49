//! What somebody does to a run while it goes on: by hand in a view, or as `[[intervention]]` in a scenario.

use super::ranges::micros;
use super::source::{ScenarioError, Source};
use super::{Robot, ScenarioFile};
use crate::world::Refusal;
use crate::world::plane::{FAR_M, Shape};
use serde::{Deserialize, Serialize};
use staya_controller::agent::Parameter;
use staya_controller::robot::RobotId;

/// One thing that somebody does. Robots are named by their numbers, places are world coordinates in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Intervention {
    /// A robot gets another goal, as if it had started with it; without a number all do, and a formation keeps its shape
    /// around the goal of its first robot.
    Goal {
        /// The robot.
        robot: Option<u32>,
        /// Where it should go; on the grid the cell there.
        place_m: [f64; 3],
    },
    /// The operator moves a goal of all robots, by packet.
    Waypoint {
        /// Which of the goals, 0 to 3.
        goal: u8,
        /// Where it is now, at rest.
        place_m: [f64; 3],
    },
    /// A parameter changes, in one robot or in all that have it, for good.
    Parameter {
        /// The robot.
        robot: Option<u32>,
        /// Which one.
        name: Parameter,
        /// Its value.
        value: f32,
    },
    /// A robot's computer goes down.
    Down {
        /// The robot.
        robot: u32,
        /// For how long, seconds; without it for good.
        for_s: Option<f64>,
    },
    /// The radio changes for everybody.
    Radio {
        /// Probability that a packet is lost at a receiver, 0 to 1.
        loss: Option<f64>,
        /// Farthest distance at which a packet can be received, metres.
        range_m: Option<f64>,
    },
    /// Something stands in the plane from now on.
    Solid {
        /// What.
        solid: Shape,
    },
    /// An obstacle moves at once.
    Move {
        /// Its place in the list of walls, then balls, then half-spaces, then those that came later.
        index: usize,
        /// How far, metres.
        by_m: [f64; 2],
    },
    /// An obstacle goes; those behind it in the list move up.
    Remove {
        /// Its place in the list.
        index: usize,
    },
    /// A cell of the land changes.
    Cell {
        /// Which one.
        cell: [i16; 2],
        /// Ticks that it takes to cross it; 0: a wall.
        class: u8,
    },
}

/// `[[intervention]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterventionTable {
    /// When, seconds after the start.
    pub at_s: f64,
    /// What, as `{ kind = "goal", robot = 3, place_m = [4, 5, 0] }`.
    #[serde(rename = "do")]
    pub what: Intervention,
}

impl Intervention {
    /// The robot that it is for, if it is for one.
    #[must_use]
    pub const fn robot(&self) -> Option<u32> {
        match self {
            Self::Goal { robot, .. } | Self::Parameter { robot, .. } => *robot,
            Self::Down { robot, .. } => Some(*robot),
            _ => None,
        }
    }

    /// Whether it makes sense for these robots, by rising number; what the ground has no use for shows when it is done.
    ///
    /// # Errors
    /// The field, what is wrong with it, and what to give instead.
    pub fn check(&self, robots: &[Robot]) -> Result<(), Refusal> {
        if let Some(number) = self.robot()
            && robots.binary_search_by_key(&RobotId(number), |robot| robot.id).is_err()
        {
            let what = format!("there is no robot {number}");
            return Err(Refusal::new("robot", what, "give the number of a robot of this scenario"));
        }
        match self {
            Self::Goal { place_m, .. } | Self::Waypoint { place_m, .. } => {
                let is_far = |x: &f64| x.is_nan() || x.abs() > FAR_M;
                if place_m.iter().any(is_far) {
                    let remedy = format!("give metres within {FAR_M}");
                    return Err(Refusal::new("place_m", "this is no place", remedy));
                }
            }
            Self::Parameter { name, value, .. } => {
                let [least, greatest] = name.range();
                if !(least..=greatest).contains(value) {
                    let what = format!("{value} is out of range");
                    return Err(Refusal::new("value", what, format!("give {least} to {greatest}")));
                }
            }
            Self::Down { for_s: Some(for_s), .. } if !(0.0..=1e9).contains(for_s) => {
                return Err(Refusal::new("for_s", format!("{for_s} is no time"), "give seconds, 0 to 1e9"));
            }
            Self::Radio { loss: Some(loss), .. } if !(0.0..=1.0).contains(loss) => {
                let what = format!("{loss} is no probability");
                return Err(Refusal::new("loss", what, "give a number from 0 to 1"));
            }
            Self::Radio { range_m: Some(range_m), .. } if range_m.is_nan() || *range_m < 0.0 => {
                let what = format!("{range_m} is no distance");
                return Err(Refusal::new("range_m", what, "give metres, 0 or more, or inf"));
            }
            Self::Solid { solid } => solid.check()?,
            Self::Move { by_m, .. } if by_m.iter().any(|x| x.is_nan() || x.abs() > FAR_M) => {
                return Err(Refusal::new("by_m", "this is no way", format!("give metres within {FAR_M}")));
            }
            _ => {}
        }
        Ok(())
    }
}

/// Checks the tables; by rising tick, those of one tick as in the file.
pub(super) fn interventions(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
) -> Result<Vec<(u32, Intervention)>, ScenarioError> {
    let mut interventions = Vec::with_capacity(file.intervention.len());
    for (index, table) in file.intervention.iter().enumerate() {
        let field = |name: &str| format!("intervention[{index}].{name}");
        super::ranges::within(source, &field("at_s"), table.at_s, 0.0, 4000.0 * 3600.0, "seconds")?;
        table
            .what
            .check(robots)
            .map_err(|refusal| source.error(&field(&format!("do.{}", refusal.field)), refusal.what, refusal.remedy))?;
        interventions.push((tick(table.at_s, file.tick_s), table.what.clone()));
    }
    interventions.sort_by_key(|(tick, _)| *tick);
    Ok(interventions)
}

/// The first tick that does not begin before a time; exact for times that are whole ticks, whatever their decimals.
pub(super) fn tick(at_s: f64, tick_s: f64) -> u32 {
    let tick_us = f64::from(micros(tick_s).max(1));
    libm::ceil(libm::round(at_s * 1e6) / tick_us) as u32
}

/// A scenario's text with what was done to its run: what [`Scenario::parse`](super::Scenario::parse) reads as the same run.
#[must_use]
pub fn with_interventions(text: &str, tick_us: u32, done: &[(u32, Intervention)]) -> String {
    let mut text = text.trim_end().to_owned();
    text.push('\n');
    for (tick, what) in done {
        let micros = u64::from(*tick) * u64::from(tick_us);
        let (seconds, micros) = (micros / 1_000_000, micros % 1_000_000);
        let what = toml::Value::try_from(what).expect("an intervention is a table of numbers, words and lists");
        text.push_str(&format!("\n[[intervention]]\nat_s = {seconds}.{micros:06}\ndo = {what}\n"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_are_whole_ticks_are_those_ticks() {
        for tick_s in [0.1, 0.05, 0.3, 1.0, 0.007, 60.0] {
            for number in [0_u32, 1, 3, 7, 1001, 70_000] {
                let micros = u64::from(number) * u64::from(super::micros(tick_s));
                assert_eq!(tick(micros as f64 / 1e6, tick_s), number, "{tick_s} {number}");
            }
        }
        assert_eq!(tick(0.15, 0.1), 2);
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_a_remedy() {
        let robots = [Robot { id: RobotId(3), start: Default::default(), goal: Default::default() }];
        let polygon = |points_m| Intervention::Solid { solid: Shape::Polygon { points_m } };
        let wrong = [
            Intervention::Goal { robot: Some(2), place_m: [0.0; 3] },
            Intervention::Goal { robot: Some(3), place_m: [f64::NAN, 0.0, 0.0] },
            Intervention::Parameter { robot: None, name: Parameter::Share, value: 2.0 },
            Intervention::Down { robot: 3, for_s: Some(-1.0) },
            Intervention::Radio { loss: Some(1.5), range_m: None },
            Intervention::Radio { loss: None, range_m: Some(f64::NAN) },
            polygon(vec![[0.0; 2]; 2]),
            polygon(vec![[f64::INFINITY, 0.0]; 3]),
            Intervention::Solid { solid: Shape::Circle { center_m: [0.0; 2], radius_m: 0.0 } },
            Intervention::Move { index: 0, by_m: [f64::NAN, 0.0] },
        ];
        for intervention in wrong {
            let refusal = intervention.check(&robots).unwrap_err();
            assert!(!refusal.remedy.is_empty(), "{intervention:?}");
        }
        assert_eq!(Intervention::Goal { robot: Some(3), place_m: [1.0; 3] }.check(&robots), Ok(()));
    }
}
