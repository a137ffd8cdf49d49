//! What came of a bridge.

use serde::Serialize;
use std::collections::BTreeMap;

/// A line's part of the figures.
#[derive(Clone, Debug, Serialize)]
pub struct LineReport {
    /// As it was opened.
    pub endpoint: String,
    /// Frames, and their bytes, that came in.
    pub frames_in: u64,
    /// See there.
    pub bytes_in: u64,
    /// Frames that went out, once for each peer, and their bytes.
    pub frames_out: u64,
    /// See there.
    pub bytes_out: u64,
    /// Frames that could not be sent.
    pub lost_out: u64,
    /// Frames for which there was no room when they came in.
    pub lost_in: u64,
    /// Bytes that belong to no frame.
    pub junk_bytes: u64,
    /// Bytes that went out in a second, on average.
    pub bytes_out_per_s: f64,
}

/// Frames that were refused, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// Without a signature.
    pub unsigned: u64,
    /// Signed with another key, or changed on the way.
    pub forged: u64,
    /// Heard before, or too old.
    pub replayed: u64,
    /// With a timestamp too far ahead of the clock.
    pub ahead: u64,
    /// Of a sender that is not known, when there was no room for another one.
    pub no_room: u64,
    /// Signed and new, but no timestamp was left to sign an answer with.
    pub unanswerable: u64,
}

impl Refused {
    /// All of them.
    #[must_use]
    pub const fn total(&self) -> u64 {
        let Self { unsigned, forged, replayed, ahead, no_room, unanswerable } = *self;
        unsigned + forged + replayed + ahead + no_room + unanswerable
    }
}

/// What came of it. Of the frames that came in over all lines, each is counted once: `frames_in` is `frames_heard`, `frames_ignored`,
/// `frames_refused`, `lost_in` and `frames_waiting` together.
#[derive(Clone, Debug, Serialize)]
pub struct BridgeReport {
    /// Robots, each a vehicle.
    pub vehicles: usize,
    /// Ticks done.
    pub ticks: u32,
    /// Simulated time, seconds.
    pub sim_seconds: f64,
    /// Time on the wall, seconds.
    pub wall_seconds: f64,
    /// Ticks that were due by the clock on the wall while an earlier one was not done; the simulation is behind by as many.
    pub deadlines_missed: u32,
    /// The longest from when a tick was due until its work was done, seconds.
    pub slowest_seconds: f64,
    /// Frames for one or more of the vehicles, and heartbeats.
    pub frames_heard: u64,
    /// Frames for vehicles that there are none of, or of messages that are not known here.
    pub frames_ignored: u64,
    /// Frames refused for their signature, or for having none; those of the future among them.
    pub frames_refused: u64,
    /// Why they were.
    pub refused: Refused,
    /// Frames refused for a timestamp too far ahead of the clock.
    pub frames_ahead: u64,
    /// Frames that had come in and whose turn had not come at the end.
    pub frames_waiting: u64,
    /// Whether too few timestamps are left to sign with, so that nothing is obeyed any more: a new key is needed.
    pub is_exhausted: bool,
    /// Answers to commands, by result.
    pub commands: BTreeMap<&'static str, u64>,
    /// What each line carried.
    pub lines: Vec<LineReport>,
    /// Overlaps of bodies, summed over ticks.
    pub collisions: u64,
    /// Least distance between the surfaces of two bodies, metres; null: on the grid, or nobody came near.
    pub least_gap_m: Option<f64>,
    /// 16 hex digits; that of `staya run` when nobody commanded.
    pub trace_hash: String,
}

/// A result's name.
pub(super) const fn name(result: u8) -> &'static str {
    use staya_mavlink::constants::*;
    match result {
        MAV_RESULT_ACCEPTED => "accepted",
        MAV_RESULT_TEMPORARILY_REJECTED => "temporarily rejected",
        MAV_RESULT_DENIED => "denied",
        MAV_RESULT_UNSUPPORTED => "unsupported",
        MAV_RESULT_COMMAND_INT_ONLY => "as COMMAND_INT only",
        _ => "unsupported frame",
    }
}
