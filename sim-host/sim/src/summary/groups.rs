//! Results by group of robots.

use crate::engine::Outcome;
use crate::scenario::{Part, Scenario};
use serde::Serialize;
use staya_controller::grid::UNIT;
use std::fmt::{Display, Formatter};

#[derive(Clone, Debug, Serialize)]
pub(super) struct GroupFigures {
    /// Table of the scenario file that describes the group.
    table: String,
    /// Ids of the first and the last robot; all ids between them belong to the group.
    first_robot: u32,
    last_robot: u32,
    robots: usize,
    law: String,
    #[serde(skip)]
    has_goals: bool,
    safety: &'static str,
    arrived: usize,
    arrival_mean_seconds: Option<f64>,
    arrival_last_seconds: Option<f64>,
    /// As for all formations together; null without a formation.
    formation_error_per_agent: Option<f64>,
    formation_error_per_agent_best_fit: Option<f64>,
    graph_distance_mean: Option<f64>,
    place_error_mean_m: Option<f64>,
    place_error_worst_m: Option<f64>,
    place_error_worst_robot: Option<u32>,
    place_error_worst_s: Option<f64>,
}

impl GroupFigures {
    pub(super) fn new(part: &Part, scenario: &Scenario, outcome: &Outcome) -> Self {
        let times = outcome.arrival_times.get(part.members.clone()).unwrap_or_default();
        let times: Vec<u64> = times.iter().flatten().copied().collect();
        let seconds = |units: f64| units / f64::from(UNIT) * scenario.tick_s();
        let number = |index: usize| scenario.robots.get(index).map_or(0, |robot| robot.id.0);
        let kept = outcome.formations.iter().find(|kept| kept.members == part.members);
        let (keeping, place) = (kept.and_then(|kept| kept.keeping), kept.and_then(|kept| kept.place_error));
        Self {
            table: part.table.clone(),
            first_robot: number(part.members.start),
            last_robot: number(part.members.end - 1),
            robots: part.members.len(),
            law: scenario.law_of(part.members.start).name().to_owned(),
            has_goals: scenario.law_of(part.members.start).goals().are_own(),
            safety: scenario.safety(part.members.start).name(),
            arrived: times.len(),
            arrival_mean_seconds: (!times.is_empty())
                .then(|| seconds(times.iter().sum::<u64>() as f64 / times.len() as f64)),
            arrival_last_seconds: times.iter().max().map(|&last| seconds(last as f64)),
            formation_error_per_agent: keeping.map(|kept| kept.error_per_agent),
            formation_error_per_agent_best_fit: keeping.map(|kept| kept.best_fit_error_per_agent),
            graph_distance_mean: keeping.map(|kept| kept.graph_distance),
            place_error_mean_m: place.map(|error| error.mean_m),
            place_error_worst_m: place.map(|error| error.worst_m),
            place_error_worst_robot: place.map(|error| error.robot),
            place_error_worst_s: place.map(|error| error.at_s),
        }
    }
}

impl Display for GroupFigures {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { table, first_robot, last_robot, robots, law, safety, arrived, .. } = self;
        write!(f, "robots {first_robot} to {last_robot} ({table}): {law}, safety {safety}")?;
        if self.has_goals || *arrived > 0 {
            write!(f, "; {arrived} of {robots} arrived")?;
        }
        if let Some(last) = self.arrival_last_seconds {
            write!(f, ", the last after {last:.1} s")?;
        }
        match (self.place_error_mean_m, self.place_error_worst_m, self.formation_error_per_agent) {
            (Some(mean), Some(worst), _) => {
                write!(f, "; place error {mean:.3} m on average, {worst:.3} m at most")
            }
            (_, _, Some(error)) => write!(f, "; formation error {error:.3} cells per robot"),
            _ => Ok(()),
        }
    }
}
