//! Data of a run for plots, in bounded memory.

use super::{PacketCounts, RobotRow, TickRow};
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;
use staya_controller::robot::Mode;

/// Largest number of series points; beyond it, neighbouring points are merged.
const SERIES_POINTS: usize = 1 << 14;

/// One robot in one frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// World position, metres.
    pub position_m: [f64; 3],
    /// Id of the robot.
    pub id: u32,
    /// Target cell.
    pub target: Cell,
    /// Mode of the robot.
    pub mode: Mode,
}

impl From<RobotRow> for Sample {
    fn from(row: RobotRow) -> Self {
        Self { id: row.id, position_m: row.motion.position_m, target: row.target, mode: row.mode }
    }
}

/// All robots after one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Number of the tick.
    pub tick: u32,
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Robots in the engine's order.
    pub samples: Vec<Sample>,
}

/// State of the swarm over one or more ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// First tick.
    pub tick: u32,
    /// Simulated time of the first tick, seconds.
    pub time_s: f64,
    /// Number of ticks in this point.
    pub ticks: u32,
    /// Mean over the ticks, cells; NaN if no tick had a value.
    pub formation_error_per_agent: f64,
    /// Mean over the ticks; NaN if no tick had a value.
    pub graph_distance: f64,
    /// Sum over the ticks.
    pub packets: PacketCounts,
}

impl SeriesPoint {
    pub(super) fn merge(&mut self, next: &Self) {
        let weights = [f64::from(self.ticks), f64::from(next.ticks)];
        let mean = |a: f64, b: f64| match (a.is_nan(), b.is_nan()) {
            (true, _) => b,
            (_, true) => a,
            _ => (a * weights[0] + b * weights[1]) / (weights[0] + weights[1]),
        };
        self.formation_error_per_agent = mean(self.formation_error_per_agent, next.formation_error_per_agent);
        self.graph_distance = mean(self.graph_distance, next.graph_distance);
        self.packets += next.packets;
        self.ticks += next.ticks;
    }
}

impl From<&TickRow> for SeriesPoint {
    fn from(row: &TickRow) -> Self {
        Self {
            tick: row.tick,
            time_s: row.time_s,
            ticks: 1,
            formation_error_per_agent: row.formation_error_per_agent,
            graph_distance: row.graph_distance,
            packets: row.packets,
        }
    }
}

/// Data of a run for plots, in bounded memory: every k-th tick of every robot (see
/// [`super::Options::history_samples`]), and the swarm's series of at most 16,384 points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    frames: Vec<Frame>,
    series: Vec<SeriesPoint>,
    totals: PacketCounts,
    ticks: u32,
    /// Samples of all frames; counting them for each frame would take quadratic time.
    samples: usize,
    latest: Frame,
    max_samples: usize,
    frame_every: u32,
    series_every: u32,
}

impl Default for History {
    fn default() -> Self {
        Self::with_capacity(super::Options::default().history_samples)
    }
}

impl History {
    /// Stored frames, oldest first, including the first and the last tick.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The swarm's values over time.
    #[must_use]
    pub fn series(&self) -> &[SeriesPoint] {
        &self.series
    }

    /// Packets of the whole run.
    #[must_use]
    pub const fn totals(&self) -> PacketCounts {
        self.totals
    }

    /// Number of recorded ticks.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.ticks
    }

    pub(super) fn with_capacity(max_samples: usize) -> Self {
        Self {
            frames: Vec::new(),
            series: Vec::new(),
            totals: PacketCounts::default(),
            ticks: 0,
            samples: 0,
            latest: Frame { tick: 0, time_s: 0.0, samples: Vec::new() },
            max_samples,
            frame_every: 1,
            series_every: 1,
        }
    }

    pub(super) fn first_tick(&self) -> Option<u32> {
        self.series.first().map(|point| point.tick)
    }

    pub(super) fn begin_frame(&mut self, row: &TickRow) -> &mut Frame {
        self.ticks += 1;
        self.totals += row.packets;
        let point = SeriesPoint::from(row);
        match self.series.last_mut() {
            Some(last) if last.ticks < self.series_every => last.merge(&point),
            _ => self.series.push(point),
        }
        if self.series.len() > SERIES_POINTS {
            self.series_every *= 2;
            self.series = self
                .series
                .chunks(2)
                .map(|pair| {
                    let mut point = pair[0];
                    pair[1..].iter().for_each(|next| point.merge(next));
                    point
                })
                .collect();
        }
        self.latest.tick = row.tick;
        self.latest.time_s = row.time_s;
        self.latest.samples.clear();
        &mut self.latest
    }

    pub(super) fn end_frame(&mut self) {
        if !self.is_due(self.latest.tick) {
            return;
        }
        self.samples += self.latest.samples.len();
        self.frames.push(self.latest.clone());
        while self.frames.len() > 1 && self.samples > self.max_samples && self.frame_every <= u32::MAX / 2 {
            self.frame_every *= 2;
            let mut frames = std::mem::take(&mut self.frames);
            let (first, every) = (frames[0].tick, self.frame_every);
            frames.retain(|frame| frame.tick.wrapping_sub(first).is_multiple_of(every));
            self.samples = frames.iter().map(|frame| frame.samples.len()).sum();
            self.frames = frames;
        }
    }

    pub(super) fn close(&mut self) {
        let last = self.frames.last().map(|frame| frame.tick);
        if self.ticks > 0 && last != Some(self.latest.tick) {
            self.samples += self.latest.samples.len();
            self.frames.push(std::mem::take(&mut self.latest));
        }
    }

    fn is_due(&self, tick: u32) -> bool {
        let first = self.frames.first().map_or(tick, |frame| frame.tick);
        tick.wrapping_sub(first).is_multiple_of(self.frame_every)
    }
}
