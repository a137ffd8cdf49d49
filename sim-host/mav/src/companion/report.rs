//! What came of it.

use super::kind::Kind;
use super::offboard::{OffboardCounters, State};
use crate::Counts;
use serde::Serialize;
use staya_controller::robot::Mode;
use std::fmt::{self, Write as _};

/// A vehicle at the end.
#[derive(Clone, Debug, Serialize)]
pub struct VehicleReport {
    /// Its number in the scenario.
    pub robot: u32,
    /// Its MAVLink system.
    pub system: u8,
    /// What drives it.
    pub autopilot: Kind,
    /// What its companion did last.
    pub state: State,
    /// What its agent did last.
    pub agent: Mode,
    /// Whether it was at its goal when it was last steered.
    pub has_arrived: bool,
    /// Metres east, north, up of the origin; null: it never had a position.
    pub position_m: Option<[f64; 3]>,
    /// What happened.
    #[serde(flatten)]
    pub tally: OffboardCounters,
    /// Packets of others that were heard.
    pub packets_heard: u64,
    /// Packets that were refused: damaged, repeated, replayed, forged or without a seal.
    pub packets_refused: u64,
    /// Other robots that it knows.
    pub neighbors: usize,
}

/// A line to autopilots.
#[derive(Clone, Debug, Serialize)]
pub struct LineReport {
    /// As it was opened.
    pub link: String,
    /// What it carried.
    #[serde(flatten)]
    pub counts: Counts,
    /// Why it has no connection; null: it has one, or needs none.
    pub trouble: Option<String>,
    /// Frames refused for want of a signature that is right and new.
    pub refused: u32,
    /// No timestamp is left to sign with: nothing more was sent on it.
    pub is_exhausted: bool,
}

/// The figures of `staya companion`.
#[derive(Clone, Debug, Serialize)]
pub struct CompanionReport {
    /// Of the scenario.
    pub scenario: String,
    /// How long it ran.
    pub seconds: f64,
    /// Ended by Ctrl-C or a signal.
    pub interrupted: bool,
    /// Nothing was sent.
    pub dry_run: bool,
    /// By rising number.
    pub vehicles: Vec<VehicleReport>,
    /// As opened.
    pub links: Vec<LineReport>,
    /// Why the log is not complete; null: it is, or there is none.
    pub log_error: Option<String>,
}

impl fmt::Display for CompanionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ended = match (self.interrupted, self.dry_run) {
            (_, true) => ", dry run: nothing was sent",
            (true, false) => ", stopped",
            (false, false) => "",
        };
        writeln!(f, "{} ({:.1} s{ended})", self.scenario, self.seconds)?;
        for vehicle in &self.vehicles {
            let VehicleReport { robot, system, .. } = vehicle;
            let mut line = format!("  robot {robot:<4} system {system:<4} ");
            let arrived = if vehicle.has_arrived { ", arrived" } else { "" };
            write!(line, "{}{arrived}", vehicle.state.words())?;
            if let Some([x, y, z]) = vehicle.position_m {
                write!(line, ", at {x:.2} m east, {y:.2} m north, {z:.2} m up")?;
            }
            writeln!(f, "{line}")?;
            let tally = &vehicle.tally;
            writeln!(
                f,
                "             {} positions, {} setpoints, {} hand-overs, {} stops, {} restarts; {} packets heard, {} refused",
                tally.positions,
                tally.setpoints,
                tally.hand_overs,
                tally.stops,
                tally.restarts,
                vehicle.packets_heard,
                vehicle.packets_refused,
            )?;
        }
        for LineReport { link, counts, trouble, refused, is_exhausted } in &self.links {
            let trouble = trouble.as_ref().map_or_else(String::new, |why| format!("; no connection: {why}"));
            let mute = if *is_exhausted { "; no timestamp left to sign with: mute, a new key is needed" } else { "" };
            writeln!(
                f,
                "  {link}: {} frames in, {} out, {} bytes of junk, {} lost, {refused} refused{trouble}{mute}",
                counts.frames_in,
                counts.frames_out,
                counts.junk_bytes,
                counts.lost_in + counts.lost_out,
            )?;
        }
        if let Some(error) = &self.log_error {
            writeln!(f, "  {error}: what is there is not all")?;
        }
        Ok(())
    }
}
