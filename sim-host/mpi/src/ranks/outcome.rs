//! Results of ranks, and their sum.

use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::grid::Cell;
use staya_controller::names::Named;
use staya_controller::robot::Mode;
use staya_sim::engine::{Engine, Outcome, hash};
use staya_sim::metrics::waits::WaitCount;
use staya_sim::record::{Motion, PacketCounts, RobotRow};
use staya_sim::world::plane::Clearance;

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Sums {
    pub(super) arrived: u64,
    pub(super) waiting: u64,
    pub(super) collisions: u64,
    pub(super) packets: PacketCounts,
    pub(super) hash: u64,
    pub(super) gap_m: Option<f64>,
    pub(super) load: f64,
    pub(super) stops: bool,
    pub(super) saves: bool,
}

impl Sums {
    pub(super) fn of(all: &[Self]) -> Self {
        all.iter().fold(Self::default(), |sum, one| Self {
            arrived: sum.arrived + one.arrived,
            waiting: sum.waiting + one.waiting,
            collisions: sum.collisions + one.collisions,
            packets: sum.packets + one.packets,
            hash: sum.hash.wrapping_add(one.hash),
            gap_m: [sum.gap_m, one.gap_m].into_iter().flatten().reduce(f64::min),
            load: sum.load.max(one.load),
            stops: sum.stops || one.stops,
            saves: sum.saves || one.saves,
        })
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Part {
    collisions: u64,
    packets: PacketCounts,
    throttled: u64,
    waits: Vec<(u8, u64, u64, u64, u32)>,
    /// Gaps to bodies, obstacles, intruders; overlaps, intrusions, intruder overlaps, downwash.
    clearance: Option<([f64; 3], [u64; 4])>,
    hash: u64,
    arrived: u64,
}

impl Part {
    pub(super) fn of(engine: &Engine) -> Self {
        let waits = engine.waits.all().iter().map(|count| {
            let WaitCount { wait, robots, now, robot_ticks, longest_ticks } = *count;
            (number_of(wait), robots as u64, now as u64, robot_ticks, longest_ticks)
        });
        Self {
            collisions: engine.collisions,
            packets: engine.packets,
            throttled: engine.throttled,
            waits: waits.collect(),
            clearance: engine.view().clearance.map(|c| {
                let gaps = [c.bodies_m, c.solids_m, c.intruders_m];
                (gaps, [c.overlaps, c.intrusions, c.intruder_overlaps, c.washed])
            }),
            hash: hash::sum(&engine.chains),
            arrived: engine.arrivals.count() as u64,
        }
    }

    pub(super) fn add_to(&self, outcome: &mut Outcome) {
        outcome.collisions += self.collisions;
        outcome.packets += self.packets;
        outcome.throttled += self.throttled;
        outcome.trace_hash = outcome.trace_hash.wrapping_add(self.hash);
        outcome.arrived += self.arrived as usize;
        for &(wait, robots, now, robot_ticks, longest_ticks) in &self.waits {
            let Some(wait) = reason(wait) else { continue };
            let at = match outcome.waits.iter().position(|count| count.wait == wait) {
                Some(at) => at,
                None => {
                    outcome.waits.push(WaitCount { wait, robots: 0, now: 0, robot_ticks: 0, longest_ticks: 0 });
                    outcome.waits.len() - 1
                }
            };
            let count = &mut outcome.waits[at];
            count.robots += robots as usize;
            count.now += now as usize;
            count.robot_ticks += robot_ticks;
            count.longest_ticks = count.longest_ticks.max(longest_ticks);
        }
        outcome.waits.sort_by_key(|count| number_of(count.wait));
        if let (Some(([bodies_m, solids_m, intruders_m], counts)), Some(whole)) =
            (self.clearance, &mut outcome.clearance)
        {
            let [overlaps, intrusions, intruder_overlaps, washed] = counts;
            whole.add(&Clearance { bodies_m, solids_m, intruders_m, overlaps, intrusions, intruder_overlaps, washed });
        }
    }
}

pub(super) fn nothing(has_clearance: bool) -> Outcome {
    Outcome {
        ticks: 0,
        seconds: 0.0,
        arrived: 0,
        arrival_times: Vec::new(),
        ends: Vec::new(),
        collisions: 0,
        packets: PacketCounts::default(),
        throttled: 0,
        waits: Vec::new(),
        formation: None,
        place_error: None,
        formations: Vec::new(),
        clearance: has_clearance.then_some(Clearance::FREE),
        trace_hash: 0,
    }
}

fn number_of(wait: Wait) -> u8 {
    let at = Wait::NAMES.iter().position(|&(_, named)| named == wait);
    at.and_then(|at| u8::try_from(at).ok()).unwrap_or(u8::MAX)
}

fn reason(number: u8) -> Option<Wait> {
    Wait::NAMES.get(usize::from(number)).map(|&(_, wait)| wait)
}

/// A robot's line of the record, in a form that other ranks can decode.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    id: u32,
    cell: Cell,
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    mode: Mode,
    leader: u32,
    target: Cell,
    target_m: Option<[f64; 3]>,
    wait: Option<u8>,
    radius_m: Option<f64>,
    has_cells: bool,
}

impl From<RobotRow> for Row {
    fn from(row: RobotRow) -> Self {
        let Motion { cell, position_m, velocity_mps } = row.motion;
        let RobotRow { id, mode, leader, target, target_m, radius_m, has_cells, .. } = row;
        let wait = row.wait.map(number_of);
        Self { id, cell, position_m, velocity_mps, mode, leader, target, target_m, wait, radius_m, has_cells }
    }
}

impl Row {
    pub(super) const fn id(&self) -> u32 {
        self.id
    }

    /// Only rank 0 knows the formation error.
    pub(super) fn with_error(self, formation_error_cells: f32) -> RobotRow {
        let Self { id, cell, position_m, velocity_mps, mode, leader, target, target_m, wait, radius_m, has_cells } =
            self;
        let motion = Motion { cell, position_m, velocity_mps };
        let wait = wait.and_then(reason);
        RobotRow { id, motion, mode, leader, target, target_m, wait, formation_error_cells, radius_m, has_cells }
    }
}
