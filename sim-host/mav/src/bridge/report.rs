use crate::Counts;
use crate::tlog::Missing;
use serde::Serialize;
use std::collections::BTreeMap;

/// Statistics of one link.
#[derive(Clone, Debug, Serialize)]
pub struct LineReport {
    /// The endpoint, as opened.
    pub endpoint: String,
    /// Traffic.
    #[serde(flatten)]
    pub counts: Counts,
    /// Average send rate, bytes per second.
    pub bytes_out_per_s: f64,
}

/// Rejected frames by reason; counts of 32 bits saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// Without a signature.
    pub unsigned: u32,
    /// With the signature of another key, or damaged.
    pub forged: u32,
    /// Received before, or too old.
    pub replayed: u32,
    /// With a timestamp too far ahead of the clock.
    pub ahead: u32,
    /// From an unknown sender while the table of senders was full.
    pub no_room: u32,
    /// Valid, but no timestamp is left to sign an answer with.
    pub unanswerable: u64,
}

/// Statistics of a bridge run. The `frames_in` of all links are `frames_heard` + `frames_ignored` +
/// `frames_refused` + `lost_in` + `frames_waiting`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BridgeReport {
    /// Number of vehicles, one for each robot.
    pub vehicles: usize,
    /// Simulated ticks.
    pub ticks: u32,
    /// Simulated time, seconds.
    pub sim_seconds: f64,
    /// Real time, seconds.
    pub wall_seconds: f64,
    /// Ticks that became due before the previous one was finished, by which the simulation is late.
    pub deadlines_missed: u32,
    /// Longest time from when a tick was due to the end of its work, seconds.
    pub slowest_seconds: f64,
    /// Heartbeats, and frames for at least one vehicle.
    pub frames_heard: u64,
    /// Frames for unknown vehicles or with unknown messages.
    pub frames_ignored: u64,
    /// Frames rejected for a missing or invalid signature or a future timestamp.
    pub frames_refused: u64,
    /// Rejected frames by reason.
    pub refused: Refused,
    /// Frames rejected for a timestamp too far ahead of the clock.
    pub frames_ahead: u32,
    /// Frames still queued at the end.
    pub frames_waiting: u64,
    /// Whether the signing timestamps are used up; the bridge then needs a new key.
    pub is_exhausted: bool,
    /// Answers to commands, by result.
    pub commands: BTreeMap<&'static str, u64>,
    /// Statistics of each link.
    pub lines: Vec<LineReport>,
    /// Overlaps between bodies, summed over ticks.
    pub collisions: u64,
    /// Smallest gap between the surfaces of two bodies, metres; null on a grid or if all kept away.
    pub least_gap_m: Option<f64>,
    /// Why the log is incomplete; null if it is complete or there is none.
    pub log_error: Option<String>,
    /// Frames and bytes that the log lacks.
    #[serde(flatten)]
    pub log_missing: Missing,
    /// Trace hash, 16 hex digits; equal to that of `staya run` if no command arrived.
    pub trace_hash: String,
}
