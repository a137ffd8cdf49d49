//! Runs a whole scenario with the guidance law that it names.

use super::laws::{Papers, ScenarioLaw};
use super::state::{Saves, State, StateError};
use super::witness::Witness;
use super::{Engine, ExternalController, Grid, Ground, HostLaw, PlaneGround, WrongWorld};
use crate::metrics::waits::WaitCount;
use crate::metrics::{FormationKept, FormationQuality, PlaceError};
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::{NamedLaw, Scenario};
use crate::terrain::Terrain;
use crate::world::Misplaced;
use crate::world::plane::{Clearance, Disc, Solid};
use staya_controller::agent::{AnySafety, Guided, HALF_PLANES, Safety, SharedMap, WAYPOINTS, Wait};
use staya_controller::robot::Mode;
use std::collections::HashMap;
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
    /// Mode of each robot at the end, and why it waits.
    pub ends: Vec<(Mode, Option<Wait>)>,
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
/// See [`Grid::new`].
pub fn simulate(
    scenario: &Scenario,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    simulate_with(scenario, None, &mut watch)
}

/// Runs [`simulate`] with some controllers outside this process.
///
/// # Errors
/// See [`Grid::new`].
pub fn simulate_with(
    scenario: &Scenario,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, Misplaced> {
    Ok(AnyEngine::new(scenario)?.go(scenario, external, watch))
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
/// See [`Grid::new`] and [`Engine::restore`].
pub fn simulate_from(scenario: &Scenario, state: &[u8], watch: &mut Watch<'_>) -> Result<Outcome, StartError> {
    Ok(AnyEngine::new(scenario)?.resume(scenario, state, watch)?)
}

/// Law of an agent: any law of scenario files, which an operator may override.
pub type LawOf = Guided<f32, ScenarioLaw>;
#[doc(hidden)]
pub type SafetyOf = Witness<AnySafety<f32, HALF_PLANES>>;

/// Engines of both worlds; instantiated only here, to compile the generic code once.
pub(super) enum AnyEngine {
    Plane(Box<Engine<PlaneGround, LawOf, SafetyOf>>),
    Cells(Box<Engine<Grid, LawOf, SafetyOf>>),
}

impl AnyEngine {
    pub(super) fn new(scenario: &Scenario) -> Result<Self, Misplaced> {
        Self::with(scenario, agents(scenario))
    }

    pub(super) fn with(
        scenario: &Scenario,
        agents: impl Fn(usize) -> (LawOf, SafetyOf) + Send + Sync + 'static,
    ) -> Result<Self, Misplaced> {
        Ok(if let Some(setup) = &scenario.plane {
            let ground = PlaneGround::new(scenario, setup);
            Self::Plane(Box::new(Engine::new(scenario, ground, agents)))
        } else {
            let ground = Grid::new(scenario)?;
            Self::Cells(Box::new(Engine::new(scenario, ground, agents)))
        })
    }

    pub(super) fn go(
        self,
        scenario: &Scenario,
        external: Option<Box<dyn ExternalController>>,
        watch: &mut Watch<'_>,
    ) -> Outcome {
        match self {
            Self::Plane(engine) => go(scenario, *engine, external, watch),
            Self::Cells(engine) => go(scenario, *engine, external, watch),
        }
    }

    pub(super) fn resume(
        self,
        scenario: &Scenario,
        state: &[u8],
        watch: &mut Watch<'_>,
    ) -> Result<Outcome, StateError> {
        match self {
            Self::Plane(engine) => resume(scenario, *engine, state, watch),
            Self::Cells(engine) => resume(scenario, *engine, state, watch),
        }
    }
}

/// Returns a function that creates the law and the safety layer of a robot.
pub fn agents(scenario: &Scenario) -> impl Fn(usize) -> (LawOf, SafetyOf) + Send + Sync + 'static + use<> {
    let kind = |index| {
        let group = scenario.plane.as_ref().map(|setup| setup.group(index));
        let [speed_mps, tolerance_m] =
            group.map_or([0.0; 2], |group| [group.cruise_mps, group.tolerance_m].map(|x| x as f32));
        (scenario.guidance(index), scenario.safety(index), speed_mps, tolerance_m)
    };
    // Members of formations differ individually, others only by group; each kind is created once.
    let groups = scenario.plane.as_ref().map_or(0, |plane| plane.groups.len());
    let group_of = |index: usize| match (scenario.formation_of(index), &scenario.plane) {
        (Some(_), _) => groups + 1 + index,
        (None, Some(plane)) => plane.starts[index].group.map_or(0, |group| group + 1),
        (None, None) => 0,
    };
    let (mut kinds, mut known) = (Vec::new(), HashMap::new());
    let of_robots = (0..scenario.robots.len()).map(|index| {
        *known.entry(group_of(index)).or_insert_with(|| {
            kinds.push(kind(index));
            kinds.len() - 1
        })
    });
    let of_robots: Vec<usize> = of_robots.collect();
    let (maps, papers, own) = (scenario.maps, Papers::of(scenario), scenario.law.as_ref().map(NamedLaw::law));
    move |index| {
        let (guidance, safety, speed_mps, tolerance_m) = &kinds[of_robots[index]];
        // Robots that do not plan on terrain have no map to share.
        let map = maps.filter(|_| guidance.kind().is_on_grid()).map(|params| Box::new(SharedMap::new(params)));
        let law = own.as_ref().map_or_else(|| papers.law(guidance, map), |own| ScenarioLaw::Own(own.clone()));
        (Guided::new(law, *speed_mps, *tolerance_m), Witness::new(safety.safety()))
    }
}

fn go<W, G, A>(
    scenario: &Scenario,
    mut engine: Engine<W, G, A>,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Outcome
where
    W: Ground,
    G: HostLaw + State,
    A: Safety<f32> + Send + State,
{
    let is_here = external.is_none();
    if let Some(controllers) = external {
        engine = engine.with_external(scenario, controllers);
    }
    let row = engine.first_row();
    let moment = Moment { run: is_here.then_some(&engine as &dyn Saves), ..engine.moment(&row) };
    if watch(&moment, &mut engine.rows()).is_break() {
        return engine.outcome();
    }
    ticks(scenario, engine, watch)
}

fn resume<W, G, A>(
    scenario: &Scenario,
    mut engine: Engine<W, G, A>,
    state: &[u8],
    watch: &mut Watch<'_>,
) -> Result<Outcome, StateError>
where
    W: Ground,
    G: HostLaw + State,
    A: Safety<f32> + Send + State,
{
    engine.restore(state)?;
    Ok(ticks(scenario, engine, watch))
}

/// The current state was already passed to the watcher.
fn ticks<W, G, A>(scenario: &Scenario, mut engine: Engine<W, G, A>, watch: &mut Watch<'_>) -> Outcome
where
    W: Ground,
    G: HostLaw + State,
    A: Safety<f32> + Send + State,
{
    let is_here = engine.external.is_none();
    while !engine.is_over() && engine.ticks() < scenario.ticks {
        let row = engine.step();
        let moment = Moment { run: is_here.then_some(&engine as &dyn Saves), ..engine.moment(&row) };
        if watch(&moment, &mut engine.rows()).is_break() {
            break;
        }
    }
    engine.outcome()
}
