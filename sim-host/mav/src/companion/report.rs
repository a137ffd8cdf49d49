use super::kind::Kind;
use super::offboard::{OffboardCounters, State};
use crate::Counts;
use crate::tlog::Missing;
use serde::Serialize;
use staya_controller::robot::Mode;
use std::fmt::{self, Write as _};

/// One vehicle at the end of the run.
#[derive(Clone, Debug, Serialize)]
pub struct VehicleReport {
    /// Robot number in the scenario.
    pub robot: u32,
    /// MAVLink system id.
    pub system: u8,
    /// Autopilot.
    pub autopilot: Kind,
    /// State of the companion.
    pub state: State,
    /// Mode of the agent.
    pub agent: Mode,
    /// Whether the vehicle was at its goal when it was last controlled.
    pub has_arrived: bool,
    /// Metres east, north, up of the origin; null if no position ever arrived.
    pub position_m: Option<[f64; 3]>,
    /// Counters.
    #[serde(flatten)]
    pub tally: OffboardCounters,
    /// Packets accepted from other robots.
    pub packets_heard: u64,
    /// Packets rejected: damaged, repeated, replayed, forged or unencrypted.
    pub packets_refused: u64,
    /// Number of known neighbours.
    pub neighbors: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct LineReport {
    pub link: String,
    #[serde(flatten)]
    pub counts: Counts,
    /// Why the link is not connected; null if it is, or needs no connection.
    pub trouble: Option<String>,
    pub refused: u32,
    /// Whether the signing timestamps are used up, so that the link sends no more.
    pub is_exhausted: bool,
}

/// Report of `staya companion`.
#[derive(Clone, Debug, Serialize)]
pub struct CompanionReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Duration of the run, seconds.
    pub seconds: f64,
    /// Whether Ctrl-C or a signal ended the run.
    pub interrupted: bool,
    /// Whether nothing was sent.
    pub dry_run: bool,
    /// Whether the vehicles were simulated; then there are no links.
    pub demo: bool,
    /// Vehicles sorted by robot number.
    pub vehicles: Vec<VehicleReport>,
    /// Links in the order of the configuration.
    pub links: Vec<LineReport>,
    /// Why the log is incomplete; null if it is complete or there is none.
    pub log_error: Option<String>,
    /// Frames and bytes that the log lacks.
    #[serde(flatten)]
    pub log_missing: Missing,
}

impl fmt::Display for CompanionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.demo { ", simulated vehicles" } else { "" };
        let ended = match (self.interrupted, self.dry_run) {
            (_, true) => ", dry run: nothing was sent",
            (true, false) => ", stopped",
            (false, false) => "",
        };
        writeln!(f, "{} ({:.1} s{kind}{ended})", self.scenario, self.seconds)?;
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
                "             {} positions, {} setpoints, {} hand-overs, {} stops, {} restarts; {} packets received, {} rejected",
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
            let mute = if *is_exhausted { "; timestamps used up, nothing is sent; give a new key" } else { "" };
            writeln!(
                f,
                "  {link}: {} frames in, {} out, {} junk bytes, {} lost, {refused} rejected{trouble}{mute}",
                counts.frames_in,
                counts.frames_out,
                counts.junk_bytes,
                counts.lost_in + counts.lost_out,
            )?;
        }
        if let Some(error) = &self.log_error {
            writeln!(f, "  {error}; {}", self.log_missing)?;
        }
        Ok(())
    }
}
