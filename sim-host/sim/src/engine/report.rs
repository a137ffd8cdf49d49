//! Reports of a running simulation: record rows, moments for watchers, and results.

use super::{End, EndBody, Engine, Moment, Outcome, Saves, Status, hash};
use crate::metrics::{FormationMeters, FormationQuality};
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::world::plane::Disc;

/// A body that a robot cannot reach within this time, seconds, is not in its way.
const REACH_S: f64 = 3.0;

impl Engine {
    pub(super) fn first_row(&mut self) -> TickRow {
        let members: Vec<_> = self.members().collect();
        let quality = self.formation_quality(&members, false);
        self.row(quality, PacketCounts::default())
    }

    /// The swarm's record row, with the `packets` of the last tick.
    pub fn row(&self, quality: Option<FormationQuality>, packets: PacketCounts) -> TickRow {
        TickRow {
            tick: self.tick,
            time_s: self.seconds(),
            formation_error_per_agent: quality.map_or(f64::NAN, |quality| quality.error_per_agent),
            graph_distance: quality.map_or(f64::NAN, |quality| quality.graph_distance),
            packets,
        }
    }

    /// The robots' record rows, sorted by id.
    pub fn rows(&self) -> impl Iterator<Item = RobotRow> {
        let view = self.ground.view(self.tick);
        self.statuses.iter().enumerate().map(move |(index, status)| RobotRow {
            id: self.id(index).0,
            motion: self.ground.motion(index, self.tick),
            mode: status.mode,
            leader: status.leader.0,
            target: status.target,
            target_m: self.ground.target_m(index, self.tick, status),
            wait: status.wait,
            formation_error_cells: self.formation_error(self.number(index)) as f32,
            radius_m: view.discs.get(index).map(|disc| disc.radius_m),
            has_cells: view.terrain.is_some(),
        })
    }

    /// Distance of a robot from its place at the last measurement, cells; NaN without one.
    pub fn formation_error(&self, number: usize) -> f64 {
        self.meter.as_ref().map_or(f64::NAN, |meter| meter.error_of(number))
    }

    /// State of the swarm for watchers, with its record row.
    pub fn moment<'a>(&'a self, row: &'a TickRow) -> Moment<'a> {
        let view = self.ground.view(self.tick);
        Moment {
            row,
            arrived: self.arrivals.count(),
            waiting: self.waits.now(),
            collisions: self.collisions,
            gap_m: view.gap_m,
            intruders: view.intruders,
            goals_m: view.goals_m,
            land: view.terrain,
            solids: view.solids,
            trace_hash: hash::sum(&self.chains),
            run: self.external.is_none().then_some(self as &dyn Saves),
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

    /// States of the robots, with the barriers of those that have not arrived. O(obstacles^2 +
    /// robots x obstacles).
    #[must_use]
    pub fn ends(&self) -> Vec<End> {
        let times = self.arrivals.times();
        let absent: Vec<usize> = (0..times.len()).filter(|&index| times[index].is_none()).collect();
        let discs = self.ground.view(self.tick).discs;
        let body = |disc: &Disc| EndBody {
            position_m: disc.position_m,
            radius_m: disc.radius_m,
            reach_m: disc.radius_m + REACH_S * disc.abilities.max_speed_mps,
        };
        let end = |(index, status): (usize, &Status)| End {
            mode: status.mode,
            wait: status.wait,
            barrier: None,
            body: discs.get(index).map(body),
        };
        let mut ends: Vec<End> = self.statuses.iter().enumerate().map(end).collect();
        for (index, barrier) in self.ground.barriers(self.tick, &absent) {
            ends[index].barrier = Some(barrier);
        }
        ends
    }

    /// Results of the run so far.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let (meter, clearance) = (self.meter.as_ref(), self.ground.view(self.tick).clearance);
        Outcome {
            ticks: self.tick,
            seconds: self.seconds(),
            arrived: self.arrivals.count(),
            arrival_times: self.arrivals.times().to_vec(),
            ends: self.ends(),
            collisions: self.collisions,
            packets: self.packets,
            throttled: self.throttled,
            waits: self.waits.counts(),
            formation: meter.and_then(FormationMeters::mean),
            place_error: meter.and_then(FormationMeters::place_error).filter(|_| clearance.is_some()),
            formations: meter.map_or_else(Vec::new, |meter| meter.each(clearance.is_some())),
            clearance,
            trace_hash: hash::sum(&self.chains),
        }
    }
}
