//! Reports of a running simulation: record rows, moments for watchers, and results.

use super::{Engine, HostLaw, Moment, Outcome, hash};
use crate::engine::Ground;
use crate::metrics::FormationQuality;
use crate::record::{PacketCounts, RobotRow, TickRow};
use staya_controller::agent::Safety;

impl<W, G, A> Engine<W, G, A>
where
    W: Ground,
    G: HostLaw,
    A: Safety<f32> + Send,
{
    pub(super) fn first_row(&mut self) -> TickRow {
        let keeping = self.keeping(false);
        self.row(keeping, PacketCounts::default())
    }

    /// The swarm's record row, with the `packets` of the last tick.
    pub fn row(&self, keeping: Option<FormationQuality>, packets: PacketCounts) -> TickRow {
        TickRow {
            tick: self.tick,
            time_s: self.seconds(),
            formation_error_per_agent: keeping.map_or(f64::NAN, |k| k.error_per_agent),
            graph_distance: keeping.map_or(f64::NAN, |k| k.graph_distance),
            packets,
        }
    }

    /// The robots' record rows, sorted by id.
    pub fn rows(&self) -> impl Iterator<Item = RobotRow> {
        let has_cells = self.ground.terrain().is_some();
        self.statuses.iter().enumerate().map(move |(index, status)| RobotRow {
            id: self.id(index).0,
            motion: self.ground.motion(index, self.tick),
            mode: status.mode,
            leader: status.leader.0,
            target: status.target,
            target_m: self.ground.target_m(index, self.tick, status),
            wait: status.wait,
            formation_error_cells: self.ground.formation_error(self.number(index)) as f32,
            radius_m: self.ground.radius_m(index),
            has_cells,
        })
    }

    /// State of the swarm for watchers, with its record row.
    pub fn moment<'a>(&'a self, row: &'a TickRow) -> Moment<'a> {
        Moment {
            row,
            arrived: self.arrivals.count(),
            waiting: self.waits.now(),
            collisions: self.collisions,
            gap_m: self.ground.gap_m(),
            intruders: self.ground.intruders(),
            goals_m: self.ground.goals_m(self.tick),
            land: self.ground.terrain(),
            solids: self.ground.solids(),
            trace_hash: hash::sum(&self.chains),
            run: None,
        }
    }

    /// Number of completed ticks.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.tick
    }

    /// Simulated time, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        f64::from(self.tick) * f64::from(self.tick_us) / 1e6
    }

    /// Whether all robots have arrived and no intervention is pending.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.interventions.is_empty() && self.arrivals.is_complete()
    }

    /// The world with its bodies.
    #[must_use]
    pub const fn ground(&self) -> &W {
        &self.ground
    }

    /// Results of the run so far.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let (formation, place_error, formations) = self.ground.kept();
        Outcome {
            ticks: self.tick,
            seconds: self.seconds(),
            arrived: self.arrivals.count(),
            arrival_times: self.arrivals.times().to_vec(),
            ends: self.statuses.iter().map(|status| (status.mode, status.wait)).collect(),
            collisions: self.collisions,
            packets: self.packets,
            throttled: self.throttled,
            waits: self.waits.counts(),
            formation,
            place_error,
            formations,
            clearance: self.ground.clearance(),
            trace_hash: hash::sum(&self.chains),
        }
    }
}
