//! Summary of a run, as JSON and as text.

mod groups;
mod reasons;

use crate::engine::Outcome;
use crate::metrics::free_formation_s;
use crate::metrics::waits::WaitCount;
use crate::record::PacketCounts;
use crate::scenario::Scenario;
use crate::shown::Shown as _;
use crate::words::because;
use crate::world::plane::Solid;
use groups::GroupFigures;
use reasons::Reasons;
use serde::Serialize;
use staya_controller::agent::Wait;
use staya_controller::grid::UNIT;
use staya_controller::names::Named;
use std::fmt::{Display, Formatter, Write as _};
use std::path::{Path, PathBuf};

/// Results of a run, as in `summary.json` and with `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    scenario: String,
    /// Version of the program, set by the caller.
    pub version: &'static str,
    seed: u64,
    robots: usize,
    ticks: u32,
    sim_seconds: f64,
    /// Duration of the simulation, without file input and plotting.
    pub wall_seconds: f64,
    /// Whether the run was stopped by Ctrl-C.
    pub interrupted: bool,
    arrived: usize,
    /// Robots that have not arrived, by their reason.
    #[serde(skip)]
    absent: Vec<(&'static str, Vec<u32>)>,
    /// Mean and longest travel time, simulated seconds; null if no robot arrived.
    arrival_mean_seconds: Option<f64>,
    arrival_last_seconds: Option<f64>,
    /// Robots in walls or shared cells, or overlapping robots or obstacles, summed over ticks.
    collisions: u64,
    /// Arrival of each robot; null if per-robot data is left out.
    pub arrivals: Option<Vec<Arrival>>,
    packets: PacketCounts,
    is_authenticated: bool,
    packets_throttled: u64,
    waits: Vec<Waited>,
    /// dPhi per robot, cells, with the graph placed on the top leader; null without a formation.
    formation_error_per_agent: Option<f64>,
    /// dPhi per robot, cells, with the graph placed by the best-fitting translation.
    formation_error_per_agent_best_fit: Option<f64>,
    graph_distance_mean: Option<f64>,
    /// In the plane, after the first 10 s; null on the grid or without a formation.
    place_error_mean_m: Option<f64>,
    place_error_worst_m: Option<f64>,
    place_error_worst_robot: Option<u32>,
    place_error_worst_s: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<GroupFigures>,
    /// Over the longest time of a robot alone: straight, with full acceleration and braking.
    time_over_free_time: Option<f64>,
    /// Smallest gap between two bodies, metres; null on the grid, or if none came close.
    least_gap_m: Option<f64>,
    least_obstacle_gap_m: Option<f64>,
    least_intruder_gap_m: Option<f64>,
    /// Robots that overlap an intruder, summed over ticks; not counted as collisions.
    intruder_overlaps: u64,
    /// Robots in the downwash of others, summed over ticks; not counted as collisions.
    washed: u64,
    trace_hash: String,
    /// Fields of the scenario file with the command-line overrides, without defaults.
    parameters: serde_json::Value,
    obstacles: Vec<Obstacle>,
    files: Vec<PathBuf>,
}

/// Arrival of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Arrival {
    /// Id of the robot.
    pub robot: u32,
    /// Simulated seconds after the start; null if it has not arrived.
    pub seconds: Option<f64>,
    /// Why it has not arrived; null if it has.
    pub reason: Option<&'static str>,
}

/// An obstacle in the plane; lengths in metres, as in scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Obstacle {
    Segment { from_m: [f64; 2], to_m: [f64; 2] },
    Ball { center_m: [f64; 3], radius_m: f64 },
    HalfSpace { point_m: [f64; 3], normal: [f64; 3] },
}

impl From<&Solid> for Obstacle {
    fn from(solid: &Solid) -> Self {
        match *solid {
            Solid::Wall([from_m, to_m]) => Self::Segment { from_m, to_m },
            Solid::Ball { center_m, radius_m } => Self::Ball { center_m, radius_m },
            Solid::Plane { point_m, normal } => Self::HalfSpace { point_m, normal },
        }
    }
}

#[derive(Clone, Debug, Serialize)]
struct Waited {
    #[serde(rename = "for")]
    reason: Wait,
    robots: usize,
    at_the_end: usize,
    robot_seconds: f64,
    longest_seconds: f64,
}

impl Waited {
    fn new(count: &WaitCount, tick_s: f64) -> Self {
        Self {
            reason: count.wait,
            robots: count.robots,
            at_the_end: count.now,
            robot_seconds: count.robot_ticks as f64 * tick_s,
            longest_seconds: f64::from(count.longest_ticks) * tick_s,
        }
    }
}

impl Display for Waited {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { robots, at_the_end, robot_seconds, longest_seconds, .. } = self;
        let why = because(self.reason);
        write!(f, "{why}: {robots} robots, {robot_seconds:.1} s in all, at most {longest_seconds:.1} s")?;
        if *at_the_end > 0 { write!(f, "; {at_the_end} still do") } else { Ok(()) }
    }
}

/// Robots of one reason that the table names.
const SHOWN: usize = 6;

fn absent(scenario: &Scenario, outcome: &Outcome, reasons: &Reasons<'_>) -> Vec<(&'static str, Vec<u32>)> {
    let mut absent = Vec::<(&str, Vec<u32>)>::new();
    let times = scenario.robots.iter().zip(&outcome.arrival_times).enumerate();
    for (index, (robot, _)) in times.filter(|(_, (_, time))| time.is_none()) {
        let reason = reasons.of(index);
        match absent.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, robots)) => robots.push(robot.id.0),
            None => absent.push((reason, vec![robot.id.0])),
        }
    }
    absent
}

/// `None` for numbers that JSON cannot represent.
fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}

impl Summary {
    /// Creates the summary of a run with the written `files`; the caller sets the public fields.
    #[must_use]
    pub fn new(scenario: &Scenario, outcome: &Outcome, files: Vec<PathBuf>) -> Self {
        let units: Vec<u64> = outcome.arrival_times.iter().flatten().copied().collect();
        let seconds = |units: f64| units / f64::from(UNIT) * scenario.tick_s();
        let mean = units.iter().sum::<u64>() as f64 / units.len() as f64;
        let (formation, reasons) = (outcome.formation, Reasons::new(scenario, outcome));
        Self {
            scenario: scenario.name.clone(),
            version: "",
            seed: scenario.seed,
            robots: scenario.robots.len(),
            ticks: outcome.ticks,
            sim_seconds: outcome.seconds,
            wall_seconds: 0.0,
            interrupted: false,
            arrived: outcome.arrived,
            absent: absent(scenario, outcome, &reasons),
            arrival_mean_seconds: (!units.is_empty()).then(|| seconds(mean)),
            arrival_last_seconds: units.iter().max().map(|&last| seconds(last as f64)),
            collisions: outcome.collisions,
            arrivals: Some(
                scenario
                    .robots
                    .iter()
                    .zip(&outcome.arrival_times)
                    .enumerate()
                    .map(|(index, (robot, units))| Arrival {
                        robot: robot.id.0,
                        seconds: units.map(|units| seconds(units as f64)),
                        reason: units.is_none().then(|| reasons.of(index)),
                    })
                    .collect(),
            ),
            packets: outcome.packets,
            is_authenticated: scenario.trust.keys.is_some(),
            packets_throttled: outcome.throttled,
            waits: outcome.waits.iter().map(|count| Waited::new(count, scenario.tick_s())).collect(),
            formation_error_per_agent: formation.map(|f| f.error_per_agent),
            formation_error_per_agent_best_fit: formation.map(|f| f.best_fit_error_per_agent),
            graph_distance_mean: formation.map(|f| f.graph_distance),
            place_error_mean_m: outcome.place_error.map(|error| error.mean_m),
            place_error_worst_m: outcome.place_error.map(|error| error.worst_m),
            place_error_worst_robot: outcome.place_error.map(|error| error.robot),
            place_error_worst_s: outcome.place_error.map(|error| error.at_s),
            groups: scenario.origin.parts.iter().map(|part| GroupFigures::new(part, scenario, outcome)).collect(),
            time_over_free_time: units.iter().max().and_then(|&last| {
                let free_s = free_formation_s(scenario).filter(|_| outcome.arrived == scenario.robots.len())?;
                Some(seconds(last as f64) / free_s)
            }),
            least_gap_m: finite(outcome.clearance.map(|c| c.bodies_m)),
            least_obstacle_gap_m: finite(outcome.clearance.map(|c| c.solids_m)),
            least_intruder_gap_m: finite(outcome.clearance.map(|c| c.intruders_m)),
            intruder_overlaps: outcome.clearance.map_or(0, |c| c.intruder_overlaps),
            washed: outcome.clearance.map_or(0, |c| c.washed),
            trace_hash: format!("{:016x}", outcome.trace_hash),
            parameters: scenario.origin.parameters.clone(),
            obstacles: scenario.plane().into_iter().flat_map(|setup| &setup.solids).map(Obstacle::from).collect(),
            files,
        }
    }

    /// Trace hash as 16 hex digits; equal for equal traces.
    #[must_use]
    pub fn trace_hash(&self) -> &str {
        &self.trace_hash
    }

    /// Numeric results in a fixed order, named as in `summary.json`: `packets.sent`, or
    /// `waits.radio.robots` for a cause of waiting. `None`: the run has no such value.
    #[must_use]
    pub fn figures(&self) -> Vec<(String, Option<f64>)> {
        let packets = &self.packets;
        let mut figures: Vec<_> = [
            ("robots", Some(self.robots as f64)),
            ("ticks", Some(f64::from(self.ticks))),
            ("sim_seconds", Some(self.sim_seconds)),
            ("arrived", Some(self.arrived as f64)),
            ("arrival_mean_seconds", self.arrival_mean_seconds),
            ("arrival_last_seconds", self.arrival_last_seconds),
            ("collisions", Some(self.collisions as f64)),
            ("packets.sent", Some(packets.sent as f64)),
            ("packets.delivered", Some(packets.delivered as f64)),
            ("packets.lost", Some(packets.lost as f64)),
            ("packets.damaged", Some(packets.damaged as f64)),
            ("packets.rejected", Some(packets.rejected as f64)),
            ("packets.unsigned", Some(packets.unsigned as f64)),
            ("packets.forged", Some(packets.forged as f64)),
            ("packets.replayed", Some(packets.replayed as f64)),
            ("packets.implausible.numbers", Some(packets.implausible.numbers as f64)),
            ("packets.implausible.radii", Some(packets.implausible.radii as f64)),
            ("packets.implausible.speeds", Some(packets.implausible.speeds as f64)),
            ("packets.implausible.jumps", Some(packets.implausible.jumps as f64)),
            ("is_authenticated", Some(f64::from(u8::from(self.is_authenticated)))),
            ("packets_throttled", Some(self.packets_throttled as f64)),
            ("formation_error_per_agent", self.formation_error_per_agent),
            ("formation_error_per_agent_best_fit", self.formation_error_per_agent_best_fit),
            ("graph_distance_mean", self.graph_distance_mean),
            ("place_error_mean_m", self.place_error_mean_m),
            ("place_error_worst_m", self.place_error_worst_m),
            ("place_error_worst_robot", self.place_error_worst_robot.map(f64::from)),
            ("place_error_worst_s", self.place_error_worst_s),
            ("time_over_free_time", self.time_over_free_time),
            ("least_gap_m", self.least_gap_m),
            ("least_obstacle_gap_m", self.least_obstacle_gap_m),
            ("least_intruder_gap_m", self.least_intruder_gap_m),
            ("intruder_overlaps", Some(self.intruder_overlaps as f64)),
            ("washed", Some(self.washed as f64)),
        ]
        .map(|(name, value)| (name.to_owned(), finite(value)))
        .into();
        for &(name, reason) in Wait::NAMES {
            // Causes without waiting robots are not in the list.
            let waited = self.waits.iter().find(|waited| waited.reason == reason);
            let of = |figure: fn(&Waited) -> f64| Some(waited.map_or(0.0, figure));
            figures.extend(
                [
                    ("robots", of(|w| w.robots as f64)),
                    ("at_the_end", of(|w| w.at_the_end as f64)),
                    ("robot_seconds", of(|w| w.robot_seconds)),
                    ("longest_seconds", of(|w| w.longest_seconds)),
                ]
                .map(|(figure, value)| (format!("waits.{name}.{figure}"), value)),
            );
        }
        figures
    }

    /// Formats the results as a text table.
    #[must_use]
    pub fn table(&self, out: &Path) -> String {
        let mut text = String::new();
        // Cannot fail: a string accepts all text.
        let _ = self.write_table(out, &mut text);
        text
    }

    fn write_table(&self, out: &Path, text: &mut String) -> std::fmt::Result {
        let robot_ticks = self.robots as f64 * f64::from(self.ticks);
        let cost_us = self.wall_seconds * 1e6 / robot_ticks.max(1.0);
        let stopped = if self.interrupted { ", stopped" } else { "" };
        writeln!(text, "{} (seed {}{stopped})", self.scenario, self.seed)?;
        let mut line = |name: &str, value: String| writeln!(text, "  {name:<22}{value}");
        line("simulated", format!("{} s in {} ticks", self.sim_seconds, self.ticks))?;
        line("took", format!("{:.2} s, {cost_us:.2} us per robot and tick", self.wall_seconds))?;
        let mut arrived = format!("{} of {} robots", self.arrived, self.robots);
        if let (Some(mean), Some(last)) = (self.arrival_mean_seconds, self.arrival_last_seconds) {
            write!(arrived, ", on average after {mean:.1} s, the last after {last:.1} s")?;
        }
        line("arrived", arrived)?;
        for (index, (reason, robots)) in self.absent.iter().enumerate() {
            let ids: Vec<_> = robots.iter().take(SHOWN).map(ToString::to_string).collect();
            let more = if robots.len() > SHOWN { ", ..." } else { "" };
            let name = if index == 0 { "not arrived" } else { "" };
            line(name, format!("{}: {reason} (robot {}{more})", robots.len(), ids.join(", ")))?;
        }
        for (index, waited) in self.waits.iter().enumerate() {
            line(if index == 0 { "waited" } else { "" }, waited.to_string())?;
        }
        line("collisions", self.collisions.to_string())?;
        if let Some(gap) = self.least_gap_m {
            line("least gap", format!("{gap:.4} m between two robots"))?;
        }
        if let Some(gap) = self.least_obstacle_gap_m {
            line("", format!("{gap:.4} m to an obstacle"))?;
        }
        if let Some(gap) = self.least_intruder_gap_m {
            let overlaps = self.intruder_overlaps;
            line("", format!("{gap:.4} m to an intruder, {overlaps} overlaps with it"))?;
        }
        if let (Some(error), Some(best_fit), Some(distance)) =
            (self.formation_error_per_agent, self.formation_error_per_agent_best_fit, self.graph_distance_mean)
        {
            line("formation error", format!("{error:.3} cells per robot ({best_fit:.3} by best fit)"))?;
            line("graph distance", format!("{distance:.3}"))?;
        }
        if let (Some(mean), Some(worst), Some(robot), Some(at_s)) =
            (self.place_error_mean_m, self.place_error_worst_m, self.place_error_worst_robot, self.place_error_worst_s)
        {
            let worst = format!("at most {worst:.3} m (robot {robot} after {at_s:.1} s)");
            line("place error", format!("after 10 s, {worst}, {mean:.3} m on average"))?;
        }
        for (index, group) in self.groups.iter().enumerate() {
            line(if index == 0 { "groups" } else { "" }, group.to_string())?;
        }
        if let Some(ratio) = self.time_over_free_time {
            line("time", format!("{ratio:.3} times the straight-line time of the slowest robot"))?;
        }
        if self.washed > 0 {
            line("in downwash", self.washed.to_string())?;
        }
        let packets = &self.packets;
        let share = |part: u64, whole: u64| match whole {
            0 => String::new(),
            _ => format!(" ({:.1} %)", 100.0 * part as f64 / whole as f64),
        };
        let receptions = packets.delivered + packets.lost;
        let (sent, throttled) = (packets.sent, self.packets_throttled);
        line(
            "packets",
            match throttled {
                0 => format!("{sent} sent"),
                _ => format!("{sent} sent, {throttled} held back by bandwidth"),
            },
        )?;
        line(
            "receptions",
            format!("{} delivered, {} lost{}", packets.delivered, packets.lost, share(packets.lost, receptions)),
        )?;
        line("bad frames", format!("{} damaged, {} rejected", packets.damaged, packets.rejected))?;
        if self.is_authenticated {
            line(
                "of them, by the key",
                format!("{} unsigned, {} forged, {} replayed", packets.unsigned, packets.forged, packets.replayed),
            )?;
        }
        let lies = &packets.implausible;
        if lies.sum() > 0 {
            line(
                "implausible",
                format!("{} numbers, {} radii, {} speeds, {} jumps", lies.numbers, lies.radii, lies.speeds, lies.jumps),
            )?;
        }
        line("trace hash", self.trace_hash.clone())?;
        writeln!(text, "written to {}", out.shown())?;
        for file in &self.files {
            let name = file.strip_prefix(out).unwrap_or(file);
            writeln!(text, "  {}", name.shown())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::simulate;
    use crate::scenario::Overrides;
    use serde_json::Value;
    use std::collections::BTreeMap;
    use std::ops::ControlFlow;

    const DUEL: &str = "name = 'duel'\nticks = 40\ntick_s = 0.1\n[plane]\nradius_m = 0.3\nmax_speed_mps = 1\n\
        [plane.robots.circle]\ncount = 4\nradius_m = 3\n";

    fn flat(prefix: &str, value: &Value, found: &mut BTreeMap<String, Option<f64>>) {
        let dotted = |name: &str| if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
        match value {
            Value::Object(fields) => fields.iter().for_each(|(name, value)| flat(&dotted(name), value, found)),
            Value::Array(waits) => waits.iter().for_each(|wait| {
                if let Some(reason) = wait["for"].as_str() {
                    flat(&dotted(reason), wait, found);
                }
            }),
            Value::Number(number) => drop(found.insert(prefix.to_owned(), number.as_f64())),
            Value::Bool(truth) => drop(found.insert(prefix.to_owned(), Some(f64::from(u8::from(*truth))))),
            Value::Null => drop(found.insert(prefix.to_owned(), None)),
            Value::String(_) => {}
        }
    }

    #[test]
    fn figures_contain_all_numbers_of_the_summary() {
        let scenario = Scenario::parse(DUEL, "duel.toml".as_ref(), &Overrides::default()).expect("a scenario");
        let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("room for four");
        let summary = Summary::new(&scenario, &outcome, Vec::new());
        let mut written = BTreeMap::new();
        flat("", &serde_json::to_value(&summary).expect("JSON"), &mut written);
        // Parameters and the speed of the machine are not results.
        written.retain(|name, _| !name.starts_with("parameters."));
        for name in ["seed", "wall_seconds", "interrupted"] {
            assert!(written.remove(name).is_some(), "{name}");
        }
        let figures: BTreeMap<_, _> = summary.figures().into_iter().collect();
        for (name, value) in &written {
            assert_eq!(figures.get(name), Some(value), "{name}");
        }
        for (name, value) in figures.iter().filter(|(name, _)| !written.contains_key(*name)) {
            assert!(name.starts_with("waits.") && *value == Some(0.0), "{name} is not in summary.json");
        }
    }

    #[test]
    fn the_summary_contains_the_scenario_and_all_arrivals() {
        let text = format!(
            "{DUEL}[[plane.ball]]\ncenter_m = [9, 9, 0]\nradius_m = 0.5\n\
            [authentication]\nkey = '{}'\n",
            "ab".repeat(32)
        );
        let overrides = Overrides { seed: Some(7), ticks: Some(200) };
        let scenario = Scenario::parse(&text, "duel.toml".as_ref(), &overrides).expect("a scenario");
        let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("room for four");
        let summary = serde_json::to_value(Summary::new(&scenario, &outcome, Vec::new())).expect("JSON");
        let parameters = &summary["parameters"];
        assert_eq!((&parameters["seed"], &parameters["ticks"]), (&Value::from(7), &Value::from(200)));
        assert_eq!(parameters["plane"]["max_speed_mps"], 1);
        assert_eq!(parameters["authentication"]["key"], "(left out)");
        let obstacle = serde_json::json!({ "kind": "ball", "center_m": [9.0, 9.0, 0.0], "radius_m": 0.5 });
        assert_eq!(summary["obstacles"], Value::from(vec![obstacle]));
        let arrivals = summary["arrivals"].as_array().expect("a list");
        assert_eq!(arrivals.len(), 4);
        let times: Vec<f64> = arrivals.iter().filter_map(|arrival| arrival["seconds"].as_f64()).collect();
        assert_eq!(Value::from(times.len()), summary["arrived"]);
        assert_eq!(times.iter().copied().reduce(f64::max), summary["arrival_last_seconds"].as_f64());
        assert!(times[0] > 5.0, "{times:?}");
    }
}
