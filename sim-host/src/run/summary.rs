//! The figures of a run, for programs and for readers.

use serde::Serialize;
use staya_controller::agent::Wait;
use staya_controller::grid::UNIT;
use staya_sim::engine::Outcome;
use staya_sim::metrics::free_formation_s;
use staya_sim::metrics::waits::WaitCount;
use staya_sim::record::PacketCounts;
use staya_sim::scenario::Scenario;
use std::fmt::{Display, Formatter, Write as _};
use std::path::{Path, PathBuf};

/// The figures of a run, as in `summary.json` and with `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    scenario: String,
    seed: u64,
    robots: usize,
    /// Ticks done.
    ticks: u32,
    sim_seconds: f64,
    /// Of the simulation itself, without reading and drawing.
    pub wall_seconds: f64,
    /// Stopped by Ctrl-C.
    pub interrupted: bool,
    /// Robots that stand at their targets and know it.
    arrived: usize,
    /// Mean and last of their travel times, simulated seconds; null: nobody arrived.
    arrival_mean_seconds: Option<f64>,
    arrival_last_seconds: Option<f64>,
    /// Robots in a wall, in another one's cell, or overlapping another one or an obstacle, summed over ticks.
    collisions: u64,
    packets: PacketCounts,
    /// Whether the robots have a key.
    is_authenticated: bool,
    /// Packets beyond a robot's bandwidth, never on the air.
    packets_throttled: u64,
    /// What robots waited for that did not get on; empty: all did.
    waits: Vec<Waited>,
    /// dPhi per robot, cells, graph placed on the top leader; null: no formation.
    formation_error_per_agent: Option<f64>,
    /// The same, graph placed by the best-fitting translation.
    formation_error_per_agent_best_fit: Option<f64>,
    graph_distance_mean: Option<f64>,
    /// Robots of a formation in the plane off their places by robot 1, metres, after the first 10 s: the mean, the largest, and
    /// whose and when that was; null: on the grid, or no formation.
    place_error_mean_m: Option<f64>,
    place_error_worst_m: Option<f64>,
    place_error_worst_robot: Option<u32>,
    place_error_worst_s: Option<f64>,
    /// The time until the last one arrived over what the slowest would need by itself: straight to its goal on easy land,
    /// getting going and braking as hard as it can; null: no formation in the plane, or not all arrived.
    time_over_free_time: Option<f64>,
    /// Least distance between the surfaces of two bodies, metres; null: on the grid, or nobody came near.
    least_gap_m: Option<f64>,
    /// Least distance between a body and an obstacle, metres.
    least_obstacle_gap_m: Option<f64>,
    /// Least distance between a robot's surface and an intruder's, metres; null: without intruders.
    least_intruder_gap_m: Option<f64>,
    /// Robots that overlap an intruder, summed over ticks; they are no collisions.
    intruder_overlaps: u64,
    /// Robots in the downwash of others, summed over ticks; they are no collisions.
    washed: u64,
    /// 16 hex digits; equal for equal traces.
    trace_hash: String,
    /// What was written.
    files: Vec<PathBuf>,
}

/// One reason to wait, over the run.
#[derive(Clone, Debug, Serialize)]
struct Waited {
    #[serde(rename = "for")]
    reason: Wait,
    /// Robots that did so at some time.
    robots: usize,
    /// Those of them that do so at the end.
    at_the_end: usize,
    /// All their times together.
    robot_seconds: f64,
    /// The longest time on end.
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

    /// For what, as a sentence goes on.
    const fn words(&self) -> &'static str {
        match self.reason {
            Wait::Formation => "for their formation",
            Wait::Request => "since they were asked to",
            Wait::Way => "for a way",
            Wait::Radio => "for news by radio",
            Wait::Turn => "for their turn at a door",
            Wait::Others => "for others in the way",
            Wait::Place => "beside a place that is taken",
        }
    }
}

impl Display for Waited {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { robots, at_the_end, robot_seconds, longest_seconds, .. } = self;
        write!(f, "{robots} {}: {robot_seconds:.1} s in all, at most {longest_seconds:.1} s", self.words())?;
        if *at_the_end > 0 { write!(f, "; {at_the_end} still do") } else { Ok(()) }
    }
}

/// What JSON has a form for.
fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}

impl Summary {
    /// Of a run that left these files; how long it took and whether it was stopped is for the caller to add.
    pub fn new(scenario: &Scenario, outcome: &Outcome, files: Vec<PathBuf>) -> Self {
        let units: Vec<u64> = outcome.arrival_times.iter().flatten().copied().collect();
        let seconds = |units: f64| units / f64::from(UNIT) * scenario.tick_s();
        let mean = units.iter().sum::<u64>() as f64 / units.len() as f64;
        let formation = outcome.formation;
        Self {
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            robots: scenario.robots.len(),
            ticks: outcome.ticks,
            sim_seconds: outcome.seconds,
            wall_seconds: 0.0,
            interrupted: false,
            arrived: outcome.arrived,
            arrival_mean_seconds: (!units.is_empty()).then(|| seconds(mean)),
            arrival_last_seconds: units.iter().max().map(|&last| seconds(last as f64)),
            collisions: outcome.collisions,
            packets: outcome.packets,
            is_authenticated: scenario.key.is_some(),
            packets_throttled: outcome.throttled,
            waits: outcome.waits.iter().map(|count| Waited::new(count, scenario.tick_s())).collect(),
            formation_error_per_agent: formation.map(|f| f.error_per_agent),
            formation_error_per_agent_best_fit: formation.map(|f| f.best_fit_error_per_agent),
            graph_distance_mean: formation.map(|f| f.graph_distance),
            place_error_mean_m: outcome.place_error.map(|error| error.mean_m),
            place_error_worst_m: outcome.place_error.map(|error| error.worst_m),
            place_error_worst_robot: outcome.place_error.map(|error| error.robot),
            place_error_worst_s: outcome.place_error.map(|error| error.at_s),
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
            files,
        }
    }

    /// The figures for a reader.
    pub fn table(&self, out: &Path) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
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
            line("off their places", format!("after 10 s, {worst}, {mean:.3} m on average"))?;
        }
        if let Some(ratio) = self.time_over_free_time {
            line("time", format!("{ratio:.3} times of what the slowest needs by itself, straight"))?;
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
        line("bad frames", format!("{} damaged, {} refused", packets.corrupted, packets.rejected))?;
        if self.is_authenticated {
            line(
                "of them, by the key",
                format!("{} unsigned, {} forged, {} replayed", packets.unsigned, packets.forged, packets.replayed),
            )?;
        }
        line("trace hash", self.trace_hash.clone())?;
        writeln!(text, "written to {}", out.display())?;
        for file in &self.files {
            let name = file.strip_prefix(out).unwrap_or(file);
            writeln!(text, "  {}", name.display())?;
        }
        Ok(text)
    }
}
