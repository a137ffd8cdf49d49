//! Records of a run: two CSV files that grow with it, and a bounded [`History`] for plots.
//!
//! [`Recorder::tick`] adds a row to `series.csv`, and every [`Options::trace_every`] ticks a row
//! per robot to `trace.csv`. Rows are written in blocks that end with a tick, and a block that
//! cannot be written completely is truncated. A stopped run therefore leaves readable files.

mod csv;
mod file;
mod folder;
mod history;
mod output;

pub use file::make_dir;
pub use file::{Error, prepare_dir, write_summary};
pub use folder::Results;
pub use history::{Frame, History, Sample, SeriesPoint};
pub use output::{Access, Files, Output, remove_stale, write_atomically};

use file::LineFile;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{ImplausibleCounts, Refused, Wait};
use staya_controller::grid::Cell;
use staya_controller::robot::Mode;
use std::io::ErrorKind;
use std::ops::{Add, AddAssign};
use std::path::{Path, PathBuf};

/// Position and velocity of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Cell of the body.
    pub cell: Cell,
    /// World position, metres (x east, y north, z up).
    pub position_m: [f64; 3],
    /// World velocity, metres per second.
    pub velocity_mps: [f64; 3],
}

/// State of one robot after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotRow {
    /// Id of the robot.
    pub id: u32,
    /// Position and velocity of its body.
    pub motion: Motion,
    /// Mode of the robot.
    pub mode: Mode,
    /// Id of its leader, 0 = none.
    pub leader: u32,
    /// Target cell.
    pub target: Cell,
    /// World position of its target, metres; `None` if it has none or its law chooses it.
    pub target_m: Option<[f64; 3]>,
    /// Cause of waiting.
    pub wait: Option<Wait>,
    /// Distance from its place in the formation, cells; NaN if it has no place.
    pub formation_error_cells: f32,
    /// Radius of its body, metres; `None` if bodies have no size.
    pub radius_m: Option<f64>,
    /// Whether the world has cells; false in the plane without terrain.
    pub has_cells: bool,
}

/// State of the swarm after a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickRow {
    /// Number of the tick; increases from call to call.
    pub tick: u32,
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Mean distance of the robots from their places, cells; NaN without a formation.
    pub formation_error_per_agent: f64,
    /// Graph distance (KUZ section 6); NaN without a formation.
    pub graph_distance: f64,
    /// Packets of this tick.
    pub packets: PacketCounts,
}

/// Packets by their fate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PacketCounts {
    /// Packets passed to the radio.
    pub sent: u64,
    /// Packets delivered to a receiver.
    pub delivered: u64,
    /// Packets lost in transmission.
    pub lost: u64,
    /// Packets delivered with flipped bits.
    pub damaged: u64,
    /// Frames refused as damaged, foreign or replayed; with a key, also the three counts below.
    pub rejected: u64,
    /// Frames refused because the tag or signature was missing.
    pub unsigned: u64,
    /// Frames refused because the tag or signature was made with another key or for other content.
    pub forged: u64,
    /// Frames refused as received before or older than the latest; includes radio duplicates.
    pub replayed: u64,
    /// Beacons with implausible content.
    pub implausible: ClaimCounts,
}

/// Beacons that were refused or corrected as implausible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClaimCounts {
    /// Refused: no robot has this id.
    pub numbers: u64,
    /// Accepted with a reduced radius.
    pub radii: u64,
    /// Accepted with a reduced velocity.
    pub speeds: u64,
    /// Refused: the robot cannot have reached this position.
    pub jumps: u64,
}

impl ClaimCounts {
    /// Sum of all counts.
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
    /// Counts only the frames and beacons that a robot refused or corrected in a step.
    #[must_use]
    pub fn refused(rejected: u16, why: Refused, lies: ImplausibleCounts) -> Self {
        Self {
            rejected: rejected.into(),
            unsigned: why.unsigned.into(),
            forged: why.forged.into(),
            replayed: why.replayed.into(),
            implausible: ClaimCounts {
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
        self.implausible += other.implausible;
        self.sent += other.sent;
        self.delivered += other.delivered;
        self.lost += other.lost;
        self.damaged += other.damaged;
        self.rejected += other.rejected;
    }
}

/// Amount of recorded data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Ticks between samples in `trace.csv`; 0: robots / 1000, rounded up.
    pub trace_every: u32,
    /// Largest number of robot samples in the [`History`], 32 bytes each. When it is reached, every
    /// second frame is dropped and the interval doubles; the first and the last frame always stay.
    pub history_samples: usize,
    /// Whether single robots are recorded. Without them, there are no `trace.csv` and no frames in
    /// the history, and recording a tick takes the same time for any number of robots.
    pub keeps_robots: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { trace_every: 0, history_samples: 1 << 20, keeps_robots: true }
    }
}

/// State of a [`Recorder`] that is not in its files.
pub type Saved = (u32, History);

/// Records a run, tick by tick.
#[derive(Debug)]
pub struct Recorder {
    files: Option<Tables>,
    keeps_robots: bool,
    history: History,
}

#[derive(Debug)]
struct Tables {
    trace: Option<LineFile>,
    series: LineFile,
    trace_every: u32,
}

fn write_schemas(dir: &Path, keeps_robots: bool) -> Result<(), Error> {
    if keeps_robots {
        csv::write_schema(dir, "trace", &csv::TRACE)?;
    }
    csv::write_schema(dir, "series", &csv::SERIES)
}

impl Recorder {
    /// Creates a recorder that writes `trace.csv` (if it records robots), `series.csv` and their
    /// schemas to `out_dir`. Creates the directory; replaces earlier files.
    ///
    /// # Errors
    /// The directory or a file in it cannot be created.
    pub fn new(out_dir: impl AsRef<Path>, options: Options) -> Result<Self, Error> {
        let dir = out_dir.as_ref();
        file::make_dir(dir)?;
        write_schemas(dir, options.keeps_robots)?;
        let trace = options.keeps_robots.then(|| LineFile::create(&dir.join("trace.csv"), &csv::header(&csv::TRACE)));
        Ok(Self {
            keeps_robots: options.keeps_robots,
            files: Some(Tables {
                trace: trace.transpose()?,
                series: LineFile::create(&dir.join("series.csv"), &csv::header(&csv::SERIES))?,
                trace_every: options.trace_every,
            }),
            history: History::with_capacity(options.history_samples),
        })
    }

    /// Restores a recorder. `out_dir` contains `trace.csv` (if `keeps_robots` is set) and
    /// `series.csv` as left by [`Recorder::written`]; the rest comes from [`Recorder::saved`].
    ///
    /// # Errors
    /// A file cannot be opened or created.
    pub fn resumed(out_dir: &Path, keeps_robots: bool, (trace_every, history): Saved) -> Result<Self, Error> {
        write_schemas(out_dir, keeps_robots)?;
        let trace = keeps_robots.then(|| LineFile::resume(&out_dir.join("trace.csv"))).transpose()?;
        let series = LineFile::resume(&out_dir.join("series.csv"))?;
        Ok(Self { files: Some(Tables { trace, series, trace_every }), keeps_robots, history })
    }

    /// State that is not in a file.
    pub fn saved(&self) -> impl Serialize {
        (self.files.as_ref().map_or(0, |files| files.trace_every), &self.history)
    }

    /// Writes all buffered rows, and returns `trace.csv` (if it records robots) and `series.csv`
    /// with their lengths.
    ///
    /// # Errors
    /// The files cannot be written, or there are none.
    pub fn written(&mut self) -> Result<[Option<(PathBuf, u64)>; 2], Error> {
        let Some(files) = &mut self.files else {
            return Err(Error::new("read", Path::new("series.csv"))(ErrorKind::NotFound.into()));
        };
        let trace = files.trace.as_mut().map(LineFile::written).transpose()?;
        Ok([trace, Some(files.series.written()?)])
    }

    /// Creates a recorder without files, only with a history.
    #[must_use]
    pub fn in_memory(options: Options) -> Self {
        let history = History::with_capacity(options.history_samples);
        Self { files: None, keeps_robots: options.keeps_robots, history }
    }

    /// Records one tick. `robots` should have the same order each time. O(robots).
    ///
    /// # Errors
    /// A file cannot be written. All earlier complete ticks stay readable.
    pub fn tick(&mut self, tick: &TickRow, robots: impl Iterator<Item = RobotRow>) -> Result<(), Error> {
        let first_tick = self.history.first_tick().unwrap_or(tick.tick);
        let frame = self.history.begin_frame(tick);
        let trace = self.files.as_mut().and_then(|files| Some((files.trace.as_mut()?, &mut files.trace_every)));
        match trace {
            _ if !self.keeps_robots => {}
            None => frame.samples.extend(robots.map(Sample::from)),
            Some((trace, trace_every)) => {
                let since = tick.tick.wrapping_sub(first_tick);
                // The first tick is always due; its robots give the default interval.
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

    /// Writes all buffered rows and returns the history.
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
