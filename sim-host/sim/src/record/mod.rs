//! What happened in a run: two CSV files that grow with it and a bounded [`History`] for pictures.
//!
//! The engine calls [`Recorder::tick`] once per tick, after everybody moved. `series.csv` gets a
//! line each time; `trace.csv` gets a line per robot every [`Options::trace_every`] ticks. Both hold
//! whole ticks only: lines reach the file in blocks that end with a tick, and a block that the disk
//! refuses is cut off again. So a run that is stopped leaves files that can be read.

mod csv;
mod file;
mod folder;
mod history;

pub use file::make_dir;
pub use file::{Error, prepare_dir, write_atomically, write_summary};
pub use folder::Results;
pub use history::{Frame, History, Sample, SeriesPoint};

use file::LineFile;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{Overclaims, Refused, Wait};
use staya_controller::grid::Cell;
use staya_controller::robot::Mode;
use std::io::ErrorKind;
use std::ops::{Add, AddAssign};
use std::path::{Path, PathBuf};

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The cell it stands in.
    pub cell: Cell,
    /// World position, metres (x east, y north, z up).
    pub position_m: [f64; 3],
    /// World velocity, metres per second.
    pub velocity_mps: [f64; 3],
}

/// One robot after one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotRow {
    /// Its number.
    pub id: u32,
    /// Where its body is and how it moves.
    pub motion: Motion,
    /// What it is doing.
    pub mode: Mode,
    /// Its leader, 0 = none.
    pub leader: u32,
    /// The cell it heads for.
    pub target: Cell,
    /// Where in the world it heads for, metres; `None`: nowhere, or that is for its law to choose.
    pub target_m: Option<[f64; 3]>,
    /// What it waits for.
    pub wait: Option<Wait>,
    /// Distance from its place in the formation, cells; NaN when it has no place.
    pub formation_error_cells: f32,
    /// Radius of its body, metres; `None` where bodies have no size.
    pub radius_m: Option<f64>,
    /// Whether there are cells: there are none in the plane without land.
    pub has_cells: bool,
}

/// The whole swarm after one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickRow {
    /// Number of the tick; grows from call to call.
    pub tick: u32,
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Mean distance of the robots from their places, cells; NaN without a formation.
    pub formation_error_per_agent: f64,
    /// Graph distance (KUZ section 6); NaN without a formation.
    pub graph_distance: f64,
    /// What the radio did during this tick.
    pub packets: PacketCounts,
}

/// Packets by their fate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PacketCounts {
    /// Handed to the radio.
    pub sent: u64,
    /// Handed to a receiver.
    pub delivered: u64,
    /// Lost on the way.
    pub lost: u64,
    /// Delivered with flipped bits.
    pub corrupted: u64,
    /// Refused by a receiver: damaged, foreign or replayed; with a key also those that follow.
    pub rejected: u64,
    /// Refused because the tag or signature was missing.
    pub unsigned: u64,
    /// Refused because the tag or signature was of another key or content.
    pub forged: u64,
    /// Refused because it was heard before, or was older than what was; the radio's own repetitions included.
    pub replayed: u64,
    /// Beacons that said what no robot can be.
    pub overclaims: ClaimCounts,
}

/// Beacons that were not believed, or not all of what they said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClaimCounts {
    /// Refused for a number that no robot has.
    pub numbers: u64,
    /// With a radius that was cut.
    pub radii: u64,
    /// With a velocity that was cut.
    pub speeds: u64,
    /// Refused for a place where the robot cannot be yet.
    pub jumps: u64,
}

impl ClaimCounts {
    /// How many in all.
    #[must_use]
    pub const fn sum(&self) -> u64 {
        self.numbers + self.radii + self.speeds + self.jumps
    }
}

impl AddAssign for ClaimCounts {
    fn add_assign(&mut self, other: Self) {
        self.numbers += other.numbers;
        self.radii += other.radii;
        self.speeds += other.speeds;
        self.jumps += other.jumps;
    }
}

impl PacketCounts {
    /// What a robot refused or did not believe in a step, and why, and nothing else.
    #[must_use]
    pub fn refused(rejected: u16, why: Refused, lies: Overclaims) -> Self {
        Self {
            rejected: rejected.into(),
            unsigned: why.unsigned.into(),
            forged: why.forged.into(),
            replayed: why.replayed.into(),
            overclaims: ClaimCounts {
                numbers: lies.numbers.into(),
                radii: lies.radii.into(),
                speeds: lies.speeds.into(),
                jumps: lies.jumps.into(),
            },
            ..Self::default()
        }
    }
}

impl Add for PacketCounts {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl AddAssign for PacketCounts {
    fn add_assign(&mut self, other: Self) {
        self.unsigned += other.unsigned;
        self.forged += other.forged;
        self.replayed += other.replayed;
        self.overclaims += other.overclaims;
        self.sent += other.sent;
        self.delivered += other.delivered;
        self.lost += other.lost;
        self.corrupted += other.corrupted;
        self.rejected += other.rejected;
    }
}

/// How much to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Ticks between two samples in `trace.csv`; 0: one per started thousand robots, so that a
    /// tick adds at most about 1000 lines on average.
    pub trace_every: u32,
    /// Robot samples that [`History`] may hold, 32 bytes each. When they run out, every second frame
    /// goes and the interval doubles; the first and the last frame always stay.
    pub history_samples: usize,
    /// Whether robots are looked at one by one: without, there is neither `trace.csv` nor a frame in the history, and
    /// recording a tick of a million robots costs no more than one of ten.
    pub keeps_robots: bool,
}

impl Default for Options {
    /// The interval by the number of robots, 32 MB of history.
    fn default() -> Self {
        Self { trace_every: 0, history_samples: 1 << 20, keeps_robots: true }
    }
}

/// What of a [`Recorder`] is in no file.
pub type Saved = (u32, History);

/// Collects a run, tick by tick.
#[derive(Debug)]
pub struct Recorder {
    files: Option<Files>,
    keeps_robots: bool,
    history: History,
}

#[derive(Debug)]
struct Files {
    /// `None`: robots are not kept.
    trace: Option<LineFile>,
    series: LineFile,
    trace_every: u32,
}

/// Writes the schemas of what a recorder leaves.
fn write_schemas(dir: &Path, keeps_robots: bool) -> Result<(), Error> {
    if keeps_robots {
        csv::write_schema(dir, "trace", &csv::TRACE)?;
    }
    csv::write_schema(dir, "series", &csv::SERIES)
}

impl Recorder {
    /// A recorder that writes `trace.csv` (if it keeps robots), `series.csv` and their schemas into `out_dir`, which is
    /// made if needed; files of an earlier run are replaced.
    ///
    /// # Errors
    /// The directory or a file in it cannot be made.
    pub fn new(out_dir: impl AsRef<Path>, options: Options) -> Result<Self, Error> {
        let dir = out_dir.as_ref();
        file::make_dir(dir)?;
        write_schemas(dir, options.keeps_robots)?;
        let trace = options.keeps_robots.then(|| LineFile::create(&dir.join("trace.csv"), &csv::header(&csv::TRACE)));
        Ok(Self {
            keeps_robots: options.keeps_robots,
            files: Some(Files {
                trace: trace.transpose()?,
                series: LineFile::create(&dir.join("series.csv"), &csv::header(&csv::SERIES))?,
                trace_every: options.trace_every,
            }),
            history: History::with_capacity(options.history_samples),
        })
    }

    /// What a recorder was that is gone: `trace.csv` (if it is to keep robots) and `series.csv` are in `out_dir` as
    /// [`Recorder::written`] had them, all else is what [`Recorder::saved`] gave.
    ///
    /// # Errors
    /// A file cannot be opened or made.
    pub fn resumed(out_dir: &Path, keeps_robots: bool, (trace_every, history): Saved) -> Result<Self, Error> {
        write_schemas(out_dir, keeps_robots)?;
        let trace = keeps_robots.then(|| LineFile::resume(&out_dir.join("trace.csv"))).transpose()?;
        let series = LineFile::resume(&out_dir.join("series.csv"))?;
        Ok(Self { files: Some(Files { trace, series, trace_every }), keeps_robots, history })
    }

    /// What is in no file.
    pub fn saved(&self) -> impl Serialize {
        (self.files.as_ref().map_or(0, |files| files.trace_every), &self.history)
    }

    /// `trace.csv` (if it keeps robots) and `series.csv` with their lengths, once all that is in memory is in them.
    ///
    /// # Errors
    /// They cannot be written, or there are none.
    pub fn written(&mut self) -> Result<[Option<(PathBuf, u64)>; 2], Error> {
        let Some(files) = &mut self.files else {
            return Err(Error::new("read", Path::new("series.csv"))(ErrorKind::NotFound.into()));
        };
        let trace = files.trace.as_mut().map(LineFile::written).transpose()?;
        Ok([trace, Some(files.series.written()?)])
    }

    /// A recorder that keeps only the history.
    #[must_use]
    pub fn in_memory(options: Options) -> Self {
        let history = History::with_capacity(options.history_samples);
        Self { files: None, keeps_robots: options.keeps_robots, history }
    }

    /// Takes one tick. Order of `robots` is kept; it should be the same in each tick. O(robots).
    ///
    /// # Errors
    /// A file cannot be written. What was complete before stays readable.
    pub fn tick(&mut self, tick: &TickRow, robots: impl Iterator<Item = RobotRow>) -> Result<(), Error> {
        let first_tick = self.history.first_tick().unwrap_or(tick.tick);
        let frame = self.history.begin_frame(tick);
        let trace = self.files.as_mut().and_then(|files| Some((files.trace.as_mut()?, &mut files.trace_every)));
        match trace {
            _ if !self.keeps_robots => {}
            None => frame.samples.extend(robots.map(Sample::from)),
            Some((trace, trace_every)) => {
                let since = tick.tick.wrapping_sub(first_tick);
                // With a chosen interval the first tick is always due, and tells the number of robots.
                let due = since.checked_rem(*trace_every).is_none_or(|r| r == 0);
                for robot in robots {
                    if due {
                        csv::trace_line(trace.pending(), tick, &robot);
                    }
                    frame.samples.push(Sample::from(robot));
                }
                if *trace_every == 0 {
                    let thousands = frame.samples.len().div_ceil(1000).max(1);
                    *trace_every = u32::try_from(thousands).unwrap_or(u32::MAX);
                }
                trace.end_block()?;
            }
        }
        if let Some(files) = &mut self.files {
            csv::series_line(files.series.pending(), tick);
            files.series.end_block()?;
        }
        if self.keeps_robots {
            self.history.end_frame();
        }
        Ok(())
    }

    /// Writes what is still in memory and hands out the history.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(mut self) -> Result<History, Error> {
        if let Some(files) = &mut self.files {
            if let Some(trace) = &mut files.trace {
                trace.flush()?;
            }
            files.series.flush()?;
        }
        if self.keeps_robots {
            self.history.close();
        }
        Ok(self.history)
    }
}

#[cfg(test)]
mod tests;
