//! Runs a whole scenario with the guidance law that it names.

use super::laws::{WrongWorld, agents, own_agents};
use super::state::{Saves, StateError};
use super::{End, Engine, ExternalController};
use crate::metrics::waits::WaitCount;
use crate::metrics::{FormationKept, FormationQuality, PlaceError};
use crate::own_law::OwnLaw;
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::Scenario;
use crate::terrain::Terrain;
use crate::world::Misplaced;
use crate::world::plane::{Clearance, Disc, Solid};
use staya_controller::agent::WAYPOINTS;
use std::ops::ControlFlow;
use thiserror::Error;

/// State of the swarm after a tick, or before the first one (tick 0).
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The swarm's record row.
    pub row: &'a TickRow,
    /// Number of robots that are at their goal and report it.
    pub arrived: usize,
    /// Number of robots that have a goal and do not progress.
    pub waiting: usize,
    /// Collisions of the run so far, as in [`Outcome::collisions`].
    pub collisions: u64,
    /// Current gap of the two closest bodies, metres; `None` on the grid, before the first tick,
    /// and if no two are within three radii.
    pub gap_m: Option<f64>,
    /// Foreign bodies.
    pub intruders: &'a [Disc],
    /// Current terrain, if there is any.
    pub land: Option<&'a Terrain>,
    /// Current obstacles in the plane.
    pub solids: &'a [Solid],
    /// Goals of a goal flock, world coordinates in metres.
    pub goals_m: [Option<[f64; 3]>; WAYPOINTS],
    /// Trace hash of the run so far, as in [`Outcome::trace_hash`].
    pub trace_hash: u64,
    /// The run itself, for checkpoints; `None` if it cannot be saved.
    pub run: Option<&'a dyn Saves>,
}

/// Results of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Number of completed ticks.
    pub ticks: u32,
    /// Simulated time, seconds.
    pub seconds: f64,
    /// Number of robots that are at their goal and report it.
    pub arrived: usize,
    /// End of each robot's last move, [`UNIT`](staya_controller::grid::UNIT)ths of a tick after the
    /// start; `None`: not at its goal.
    pub arrival_times: Vec<Option<u64>>,
    /// State of each robot at the end.
    pub ends: Vec<End>,
    /// Robots in a wall or in another robot's cell, summed over ticks. Must be 0.
    pub collisions: u64,
    /// Packets of the whole run.
    pub packets: PacketCounts,
    /// Packets that exceeded a robot's bandwidth and were not transmitted.
    pub throttled: u64,
    /// Causes of waiting.
    pub waits: Vec<WaitCount>,
    /// Means over the run; `None` without a formation.
    pub formation: Option<FormationQuality>,
    /// Distance of robots in the plane from their formation places, after the time for forming.
    pub place_error: Option<PlaceError>,
    /// Quality of each formation, in the order of [`Scenario::formations`].
    pub formations: Vec<FormationKept>,
    /// Smallest distances between bodies and to obstacles; `None` on the grid.
    pub clearance: Option<Clearance>,
    /// Hash of the trace; equal for equal traces, on any machine and any number of threads.
    pub trace_hash: u64,
}

/// Callback that sees the swarm after each tick and decides whether to continue.
pub type Watch<'a> = dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()> + 'a;

/// Runs a scenario until all robots have arrived, its ticks are used up or `watch` breaks. `watch`
/// sees the start as tick 0, then each tick, with the robots' record rows sorted by id.
///
/// # Errors
/// See [`Grid::new`](super::Grid::new).
pub fn simulate(
    scenario: &Scenario,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    simulate_with(scenario, None, &mut watch)
}

/// Runs [`simulate`] with some controllers outside this process.
///
/// # Errors
/// See [`Grid::new`](super::Grid::new).
pub fn simulate_with(
    scenario: &Scenario,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, Misplaced> {
    let engine = Engine::new(scenario, agents(scenario))?;
    let engine = match external {
        Some(controllers) => engine.with_external(scenario, controllers),
        None => engine,
    };
    Ok(engine.run(scenario.ticks, watch))
}

/// Runs [`simulate`] with `law(i)` as the law of robot `i` in [`Scenario::robots`]; see
/// [`own_agents`]. With external controllers or from a checkpoint, run an [`Engine`].
///
/// # Errors
/// [`StartError::World`], and those of [`Grid::new`](super::Grid::new).
pub fn simulate_own<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, StartError> {
    Ok(Engine::new(scenario, own_agents(scenario, law)?)?.run(scenario.ticks, &mut watch))
}

/// Why a run cannot begin.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StartError {
    /// The robots cannot be placed.
    #[error(transparent)]
    Misplaced(#[from] Misplaced),
    /// The saved state cannot be restored.
    #[error(transparent)]
    State(#[from] StateError),
    /// A law of the caller needs other surroundings.
    #[error(transparent)]
    World(#[from] WrongWorld),
}

/// Resumes a run from the bytes of [`Saves::save`]; the result is identical to that of an
/// uninterrupted [`simulate`]. `watch` sees the later ticks.
///
/// # Errors
/// See [`Grid::new`](super::Grid::new) and [`Engine::restore`].
pub fn simulate_from(scenario: &Scenario, state: &[u8], watch: &mut Watch<'_>) -> Result<Outcome, StartError> {
    Ok(Engine::new(scenario, agents(scenario))?.resume(state, scenario.ticks, watch)?)
}

impl Engine {
    /// Runs until all robots have arrived, `ticks` are completed or `watch` breaks; see
    /// [`simulate`].
    pub fn run(mut self, ticks: u32, watch: &mut Watch<'_>) -> Outcome {
        self.row = self.first_row();
        if watch(&self.moment(&self.row), &mut self.rows()).is_break() {
            return self.outcome();
        }
        self.run_on(ticks, watch)
    }

    /// As [`Engine::run`], from the bytes of [`Saves::save`]; see [`simulate_from`].
    ///
    /// # Errors
    /// See [`Engine::restore`].
    pub fn resume(mut self, state: &[u8], ticks: u32, watch: &mut Watch<'_>) -> Result<Outcome, StateError> {
        self.restore(state)?;
        Ok(self.run_on(ticks, watch))
    }

    /// `watch` has already seen the current state.
    fn run_on(mut self, ticks: u32, watch: &mut Watch<'_>) -> Outcome {
        while !self.is_over() && self.ticks() < ticks {
            self.step();
            if watch(&self.moment(&self.row), &mut self.rows()).is_break() {
                break;
            }
        }
        self.outcome()
    }
}
