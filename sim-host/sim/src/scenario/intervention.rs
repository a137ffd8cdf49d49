//! Interventions: changes to a running simulation, made by hand in the viewer or listed as
//! `[[intervention]]` in a scenario.

use super::parameters::parameters;
use super::ranges::short;
use super::source::Checked;
use super::{Draft, Robot, Scenario, nearest};
use crate::world::Refusal;
use crate::world::plane::{FAR_M, Shape};
use crate::{kinds, table};
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;

/// One change to a running simulation. Robots are named by id; places are world metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Intervention {
    /// Gives a robot another goal, as if it had started with it. Without an id, all robots get it,
    /// and a formation keeps its shape around the goal of its first robot.
    Goal {
        /// Id of the robot.
        robot: Option<u32>,
        /// Goal in metres; on the grid, the cell that contains it.
        place_m: [f64; 3],
    },
    /// The operator moves a goal of all robots by radio.
    Waypoint {
        /// Index of the goal, 0 to 3.
        goal: u8,
        /// New position of the goal, which does not move.
        place_m: [f64; 3],
    },
    /// Changes a parameter permanently, in one robot or in all robots that have it.
    Parameter {
        /// Id of the robot; `None`: all.
        robot: Option<u32>,
        /// Name of the parameter.
        name: String,
        /// New value.
        value: f32,
    },
    /// A robot's computer fails.
    Down {
        /// Id of the robot.
        robot: u32,
        /// Duration, seconds; `None`: until the end of the run.
        for_s: Option<f64>,
    },
    /// Changes the radio of all robots.
    Radio {
        /// Probability that a receiver loses a packet, 0 to 1.
        loss: Option<f64>,
        /// Farthest distance at which a packet can be received, metres.
        range_m: Option<f64>,
    },
    /// Adds an obstacle to the plane.
    Solid {
        /// Shape of the obstacle.
        solid: Shape,
    },
    /// Moves an obstacle instantly.
    Move {
        /// Index of the obstacle: walls first, then balls, then half-spaces, then later additions.
        index: usize,
        /// Displacement, metres.
        by_m: [f64; 2],
    },
    /// Removes an obstacle; the indices of later obstacles decrease by one.
    Remove {
        /// Index of the obstacle.
        index: usize,
    },
    /// Changes a terrain cell.
    Cell {
        /// The cell.
        cell: [i16; 2],
        /// Ticks to cross the cell; 0: a wall.
        class: u8,
    },
}

kinds!(Intervention {
    Goal = "goal" { robot, place_m },
    Waypoint = "waypoint" { goal, place_m },
    Parameter = "parameter" { robot, name, value },
    Down = "down" { robot, for_s },
    Radio = "radio" { loss, range_m },
    Solid = "solid" { solid },
    Move = "move" { index, by_m },
    Remove = "remove" { index },
    Cell = "cell" { cell, class },
});

kinds!(Shape {
    Circle = "circle" { center_m, radius_m },
    Segment = "segment" { from_m, to_m },
    Polygon = "polygon" { points_m },
    Ball = "ball" { center_m, radius_m },
});

table! {
    /// `[[intervention]]`.
    pub struct InterventionTable {
        /// Time after the start, seconds.
        pub at_s: f64, 0.0..=14_400_000.0, "seconds";
        /// The intervention, such as `{ kind = "goal", robot = 3, place_m = [4, 5, 0] }`.
        pub r#do: Intervention;
    }
}

impl Intervention {
    /// Id of the robot that it concerns, if it concerns a single one.
    #[must_use]
    pub const fn robot(&self) -> Option<u32> {
        match self {
            Self::Goal { robot, .. } | Self::Parameter { robot, .. } => *robot,
            Self::Down { robot, .. } => Some(*robot),
            _ => None,
        }
    }

    /// Checks the intervention against the robots, which are sorted by id. Errors that depend on
    /// the terrain or the obstacles appear when the intervention is applied. O(log robots).
    ///
    /// # Errors
    /// Names the field, the error and the remedy.
    pub fn check(&self, robots: &[Robot]) -> Result<(), Refusal> {
        if let Some(number) = self.robot()
            && robots.binary_search_by_key(&RobotId(number), |robot| robot.id).is_err()
        {
            let what = format!("there is no robot {number}");
            return Err(Refusal::new("robot", what, "give the number of a robot of this scenario"));
        }
        let require = |holds: bool, field, what: &dyn Fn() -> String, remedy: &str| {
            if holds { Ok(()) } else { Err(Refusal::new(field, what(), remedy)) }
        };
        let is_near = |x: &f64| x.abs() <= FAR_M;
        let out_of_range = |value: f64| format!("{} is out of range", short(value));
        let metres = format!("give metres within {FAR_M}");
        match self {
            Self::Goal { place_m, .. } | Self::Waypoint { place_m, .. } => {
                let what = || "a coordinate is out of range".to_owned();
                require(place_m.iter().all(is_near), "place_m", &what, &metres)
            }
            Self::Parameter { name, value, .. } => {
                let rows = parameters();
                let Some(row) = rows.iter().find(|row| row.name == name) else {
                    let remedy = match nearest(name, rows.iter().map(|row| row.name)) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => "give a name of tests/golden/parameters.txt".to_owned(),
                    };
                    return Err(Refusal::new("name", format!("unknown value `{name}`"), remedy));
                };
                let [least, greatest] = row.range;
                let (is_in, remedy) = ((least..=greatest).contains(value), format!("give {least} to {greatest}"));
                require(is_in, "value", &|| out_of_range((*value).into()), &remedy)
            }
            Self::Down { for_s, .. } => {
                let for_s = for_s.unwrap_or_default();
                let is_time = (0.0..=1e9).contains(&for_s);
                require(is_time, "for_s", &|| out_of_range(for_s), "give seconds, 0 to 1e9")
            }
            Self::Radio { loss, range_m } => {
                let (loss, range_m) = (loss.unwrap_or_default(), range_m.unwrap_or_default());
                let what = || format!("{} is not a probability", short(loss));
                require((0.0..=1.0).contains(&loss), "loss", &what, "give a number from 0 to 1")?;
                let what = || format!("{} is not a distance", short(range_m));
                require(range_m >= 0.0, "range_m", &what, "give metres, 0 or more, or inf")
            }
            Self::Solid { solid } => solid.check(),
            Self::Move { by_m, .. } => {
                let what = || "the displacement is out of range".to_owned();
                require(by_m.iter().all(is_near), "by_m", &what, &metres)
            }
            Self::Remove { .. } | Self::Cell { .. } => Ok(()),
        }
    }
}

pub(super) fn interventions(draft: &Draft<'_>, robots: &[Robot]) -> Checked<Vec<(u32, Intervention)>> {
    let mut interventions = Vec::with_capacity(draft.file.intervention.len());
    for (index, InterventionTable { at_s, r#do }) in draft.file.intervention.iter().enumerate() {
        let field = |refusal: &Refusal| format!("intervention[{index}].do.{}", refusal.field);
        r#do.check(robots).map_err(|refusal| draft.error(&field(&refusal), refusal.what, refusal.remedy))?;
        interventions.push((draft.tick(*at_s), r#do.clone()));
    }
    interventions.sort_by_key(|(tick, _)| *tick);
    Ok(interventions)
}

impl Scenario {
    /// Tick of the last event that begins at a given time: fault, intervention, order, change of
    /// the terrain, key rotation, attack. 0 without any. O(events).
    #[must_use]
    pub fn last_event(&self) -> u32 {
        let faults = self.events.faults.iter().map(|fault| fault.from_tick);
        let interventions = self.events.interventions.iter().map(|(tick, _)| *tick);
        let orders = self.plane().into_iter().flat_map(|plane| &plane.orders).map(|order| order.tick);
        let changes = self.land.changes.iter().map(|change| change.first);
        let rolls = self.key_rotation().into_iter().flat_map(|keeping| &keeping.rolls).map(|roll| roll.tick);
        let attacks = self.events.attacks.iter().map(|attack| attack.from_tick);
        let all = faults.chain(interventions).chain(orders).chain(changes).chain(rolls).chain(attacks);
        all.max().unwrap_or_default()
    }
}

/// Appends the applied interventions to a scenario's text, so that parsing it reproduces the run.
#[must_use]
pub fn with_interventions(text: &str, tick_us: u32, done: &[(u32, Intervention)]) -> String {
    let mut text = text.trim_end().to_owned();
    text.push('\n');
    for (tick, what) in done {
        let micros = u64::from(*tick) * u64::from(tick_us);
        let (seconds, micros) = (micros / 1_000_000, micros % 1_000_000);
        let mut fields = serde_json::to_value(what).expect("an intervention is a table of numbers, words and lists");
        if let Intervention::Radio { range_m: Some(f64::INFINITY), .. } = what {
            fields["range_m"] = INFINITE.into();
        }
        text.push_str(&format!("\n[[intervention]]\nat_s = {seconds}.{micros:06}\ndo = {}\n", inline(&fields)));
    }
    text
}

/// In JSON, infinity is null like an absent field.
const INFINITE: &str = "inf";

/// Fields as TOML in one line.
fn inline(fields: &serde_json::Value) -> String {
    match fields {
        serde_json::Value::Object(fields) => {
            let given = fields.iter().filter(|(_, value)| !value.is_null());
            let given: Vec<_> = given.map(|(name, value)| format!("{name} = {}", inline(value))).collect();
            format!("{{ {} }}", given.join(", "))
        }
        serde_json::Value::String(text) if text == INFINITE => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests;
