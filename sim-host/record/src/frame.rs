//! One moment of a run in bytes, for pages and recordings (`PROTOCOL.md`, Frames).

use serde::{Deserialize, Serialize};
use staya_sim::engine::Moment;
use staya_sim::metrics::flock::polarisation;
use staya_sim::record::{PacketCounts, RobotRow};
use staya_sim::scenario::Scenario;

/// First bytes of a frame.
pub const MAGIC: [u8; 4] = *b"STF1";
/// Leader index of a robot without a leader.
pub const NONE: u32 = u32::MAX;
/// Wait number of a robot that does not wait.
pub const NO_WAIT: u8 = u8::MAX;
const PASSIVE: u8 = 6;
const HEAD: usize = 32;
const HAS_Z: u32 = 1;
const HAS_TARGETS: u32 = 2;

/// Why bytes are not a valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// The first bytes are wrong.
    #[error("this frame does not begin with {MAGIC:?}; use the program version that made it")]
    Magic,
    /// The length differs from the one in the header.
    #[error("this frame needs {expected} bytes but has {found}; make the recording again")]
    Length {
        /// By the header.
        expected: u64,
        /// Present.
        found: usize,
    },
    /// The figures are not valid JSON.
    #[error("the figures of this frame are invalid; make the recording again")]
    Figures,
}

/// Figures of the whole swarm at one moment; `None` for figures that the scenario does not have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Figures {
    /// Robots that are at their goals.
    pub arrived: usize,
    /// Robots that have a goal but do not move.
    pub waiting: usize,
    /// Collisions in the run so far.
    pub collisions: u64,
    /// Radio packets of this tick.
    pub packets: PacketCounts,
    /// Mean distance from the formation's places, cells.
    pub formation_error: Option<f64>,
    /// Length of the mean of the robots' directions, 0 to 1; `None` if no robot moves.
    pub order: Option<f64>,
    /// Smallest distance between the surfaces of two bodies, metres.
    pub gap_m: Option<f64>,
    /// Trace hash so far, 16 hex digits.
    pub hash: String,
    /// Goals of the goal flocks 0 to 3, metres from the scene's origin.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub goals: Vec<[f64; 3]>,
}

impl Figures {
    /// The plotted figures, NaN for none: arrived, waiting, collisions, formation error, order,
    /// packets delivered, packets lost, smallest distance.
    #[must_use]
    pub fn plotted(&self) -> [f32; 8] {
        let real = |value: Option<f64>| value.map_or(f32::NAN, |value| value as f32);
        [
            self.arrived as f32,
            self.waiting as f32,
            self.collisions as f32,
            real(self.formation_error),
            real(self.order),
            self.packets.delivered as f32,
            self.packets.lost as f32,
            real(self.gap_m),
        ]
    }
}

/// One moment of a run. Arrays have one entry per body: the robots by number, then the intruders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameData {
    /// Tick number.
    pub tick: u32,
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Whether z is stored; otherwise it is 0.
    pub has_z: bool,
    /// Positions, metres from the scene's origin.
    pub position_m: Vec<[f32; 3]>,
    /// Velocities, m/s.
    pub velocity_mps: Vec<[f32; 3]>,
    /// Goals, metres from the scene's origin, NaN for none; empty if goals are not stored.
    pub target_m: Vec<[f32; 3]>,
    /// Index of the leader, or [`NONE`] for none.
    pub leader: Vec<u32>,
    /// Index of the mode in the scene's words.
    pub mode: Vec<u8>,
    /// Index of the reason to wait in the scene's words, or [`NO_WAIT`].
    pub wait: Vec<u8>,
    /// Figures of the whole swarm.
    pub figures: Figures,
}

/// Converts moments of a run to frames.
#[derive(Clone, Debug)]
pub struct Framer {
    origin_m: [f64; 3],
    has_z: bool,
    ids: Vec<u32>,
}

impl Framer {
    /// Creates a framer for a scenario, with the origin of its [`Scene`](crate::scene::Scene).
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            origin_m: crate::scene::origin_m(scenario),
            has_z: crate::scene::is_in_space(scenario),
            ids: scenario.robots.iter().map(|robot| robot.id.0).collect(),
        }
    }

    /// Origin of all positions, metres.
    #[must_use]
    pub const fn origin_m(&self) -> [f64; 3] {
        self.origin_m
    }

    /// Converts a moment to a frame, reusing the memory of `frame`. O(bodies).
    pub fn fill(&self, frame: &mut FrameData, moment: &Moment<'_>, robots: impl Iterator<Item = RobotRow>) {
        let row = moment.row;
        (frame.tick, frame.time_s, frame.has_z) = (row.tick, row.time_s, self.has_z);
        for rows in [&mut frame.position_m, &mut frame.velocity_mps, &mut frame.target_m] {
            rows.clear();
        }
        frame.leader.clear();
        for bytes in [&mut frame.mode, &mut frame.wait] {
            bytes.clear();
        }
        let mut velocities = Vec::new();
        for robot in robots {
            velocities.push(robot.motion.velocity_mps);
            frame.position_m.push(self.near(robot.motion.position_m));
            frame.velocity_mps.push(self.flat(robot.motion.velocity_mps));
            frame.target_m.push(robot.target_m.map_or([f32::NAN; 3], |target_m| self.near(target_m)));
            let leader = self.ids.binary_search(&robot.leader).ok().filter(|_| robot.leader != 0);
            frame.leader.push(leader.and_then(|index| u32::try_from(index).ok()).unwrap_or(NONE));
            frame.mode.push(robot.mode as u8);
            frame.wait.push(robot.wait.map_or(NO_WAIT, |wait| wait as u8));
        }
        for intruder in moment.intruders {
            frame.position_m.push(self.near(intruder.position_m));
            frame.velocity_mps.push(self.flat(intruder.velocity_mps));
            frame.target_m.push([f32::NAN; 3]);
            frame.leader.push(NONE);
            frame.mode.push(PASSIVE);
            frame.wait.push(NO_WAIT);
        }
        let moves = velocities.iter().any(|velocity| velocity.iter().any(|v| *v != 0.0));
        frame.figures = Figures {
            arrived: moment.arrived,
            waiting: moment.waiting,
            collisions: moment.collisions,
            packets: row.packets,
            formation_error: Some(row.formation_error_per_agent).filter(|error| error.is_finite()),
            order: moves.then(|| polarisation(&velocities)),
            gap_m: moment.gap_m,
            hash: format!("{:016x}", moment.trace_hash),
            goals: moment
                .goals_m
                .iter()
                .flatten()
                .map(|goal| [0, 1, 2].map(|axis| goal[axis] - self.origin_m[axis]))
                .collect(),
        };
    }

    fn near(&self, place_m: [f64; 3]) -> [f32; 3] {
        self.flat([0, 1, 2].map(|axis| place_m[axis] - self.origin_m[axis]))
    }

    fn flat(&self, [x, y, z]: [f64; 3]) -> [f32; 3] {
        [x as f32, y as f32, if self.has_z { z as f32 } else { 0.0 }]
    }
}

impl FrameData {
    /// Number of bodies.
    #[must_use]
    pub const fn bodies(&self) -> usize {
        self.position_m.len()
    }

    /// Writes the bytes of the frame to `out`, cleared first; short arrays are padded. O(bodies).
    pub fn encode(&self, out: &mut Vec<u8>) {
        let figures = serde_json::to_vec(&self.figures).unwrap_or_default();
        let bodies = self.bodies();
        let has_targets = !self.target_m.is_empty();
        let flags = if self.has_z { HAS_Z } else { 0 } | if has_targets { HAS_TARGETS } else { 0 };
        out.clear();
        out.reserve(HEAD + bodies * 48 + figures.len());
        out.extend(MAGIC);
        out.extend(self.tick.to_le_bytes());
        out.extend(self.time_s.to_le_bytes());
        for word in [bodies as u32, flags, figures.len() as u32, 0] {
            out.extend(word.to_le_bytes());
        }
        let axes = if self.has_z { 3 } else { 2 };
        for (rows, missing) in [(&self.position_m, 0.0), (&self.velocity_mps, 0.0), (&self.target_m, f32::NAN)] {
            if rows.is_empty() && missing.is_nan() {
                continue;
            }
            for axis in 0..axes {
                let column = (0..bodies).map(|body| rows.get(body).map_or(missing, |row| row[axis]));
                column.for_each(|value| out.extend(value.to_le_bytes()));
            }
        }
        let leaders = (0..bodies).map(|body| self.leader.get(body).copied().unwrap_or(NONE));
        leaders.for_each(|leader| out.extend(leader.to_le_bytes()));
        for (bytes, missing) in [(&self.mode, 0), (&self.wait, NO_WAIT)] {
            out.extend((0..bodies).map(|body| bytes.get(body).copied().unwrap_or(missing)));
            out.resize(out.len().next_multiple_of(4), 0);
        }
        out.extend(figures);
    }

    /// The bytes of the positions of a frame: `f32` x of all bodies, y, and z in space. O(1).
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn positions_of(bytes: &[u8]) -> Result<(u32, &[u8]), FrameError> {
        let Some((head, rest)) = bytes.split_at_checked(HEAD).filter(|(head, _)| head.starts_with(&MAGIC)) else {
            return Err(FrameError::Magic);
        };
        let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let axes = if word(20) & HAS_Z != 0 { 3 } else { 2 };
        let length = u64::from(word(16)) * 4 * axes;
        let positions = usize::try_from(length).ok().and_then(|length| rest.get(..length));
        let missing = FrameError::Length { expected: HEAD as u64 + length, found: bytes.len() };
        Ok((word(4), positions.ok_or(missing)?))
    }

    /// Reads only the tick and the figures. O(1).
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn figures_of(bytes: &[u8]) -> Result<(u32, Figures), FrameError> {
        let Some(head) = bytes.get(..HEAD).filter(|head| head.starts_with(&MAGIC)) else {
            return Err(FrameError::Magic);
        };
        let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let figures = usize::try_from(word(24)).ok().and_then(|length| bytes.len().checked_sub(length));
        let figures = figures.filter(|at| *at >= HEAD).and_then(|at| serde_json::from_slice(&bytes[at..]).ok());
        Ok((word(4), figures.ok_or(FrameError::Figures)?))
    }

    /// Reads a frame. O(bytes). Memory is limited by the number of bytes, not by the header.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        let Some((head, mut rest)) = bytes.split_at_checked(HEAD).filter(|(head, _)| head.starts_with(&MAGIC)) else {
            return Err(FrameError::Magic);
        };
        let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let (bodies, flags, figures) = (u64::from(word(16)), word(20), u64::from(word(24)));
        let has_z = flags & HAS_Z != 0;
        let axes = if has_z { 3 } else { 2 };
        let columns = if flags & HAS_TARGETS != 0 { 3 } else { 2 };
        let expected = HEAD as u64 + bodies * 4 * (axes * columns + 1) + 2 * bodies.next_multiple_of(4) + figures;
        if expected != bytes.len() as u64 {
            return Err(FrameError::Length { expected, found: bytes.len() });
        }
        let bodies = bodies as usize;
        let mut take = |count: usize| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken
        };
        let mut axes_of = || {
            let mut rows = vec![[0.0_f32; 3]; bodies];
            for axis in 0..axes as usize {
                for (row, value) in rows.iter_mut().zip(take(bodies * 4).chunks_exact(4)) {
                    row[axis] = f32::from_le_bytes([value[0], value[1], value[2], value[3]]);
                }
            }
            rows
        };
        let (position_m, velocity_mps) = (axes_of(), axes_of());
        let target_m = if columns == 3 { axes_of() } else { Vec::new() };
        let leaders = take(bodies * 4).chunks_exact(4);
        let leader = leaders.map(|value| u32::from_le_bytes([value[0], value[1], value[2], value[3]])).collect();
        let mut words = || take(bodies.next_multiple_of(4))[..bodies].to_vec();
        let (mode, wait) = (words(), words());
        let figures = serde_json::from_slice(rest).map_err(|_| FrameError::Figures)?;
        let time_s = f64::from_le_bytes([head[8], head[9], head[10], head[11], head[12], head[13], head[14], head[15]]);
        Ok(Self { tick: word(4), time_s, has_z, position_m, velocity_mps, target_m, leader, mode, wait, figures })
    }
}

#[cfg(test)]
pub(crate) mod tests;
