//! A whole scenario with the guidance that it asks for.

use super::state::{Saves, State, StateError};
use super::witness::Witness;
use super::{Engine, ExternalController, Grid, Ground, HostLaw, PlaneGround};
use crate::metrics::waits::WaitCount;
use crate::metrics::{FormationKept, Keeping, PlaceError};
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::Scenario;
use crate::terrain::Terrain;
use crate::world::Misplaced;
use crate::world::plane::{Clearance, Disc, Solid};
use staya_controller::agent::{
    AnyGuidance, AnySafety, Commanded, HALF_PLANES, LEARNED, MAP_TILES, MapSharing, NeighborTracking, Safety, TEMPLATE,
    VISITS, WAYPOINTS,
};
use std::collections::HashMap;
use std::ops::ControlFlow;
use thiserror::Error;

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
pub const WIDE: usize = 1225;

/// The swarm after a tick, or (tick 0) before the first one.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The swarm's line of the record.
    pub row: &'a TickRow,
    /// Robots that stand at their targets and know it.
    pub arrived: usize,
    /// Robots that have somewhere to go and do not get on.
    pub waiting: usize,
    /// Collisions of the run so far, as in [`Outcome::collisions`].
    pub collisions: u64,
    /// Least distance between the surfaces of two bodies now, metres; `None` on the grid, before the first tick, and where
    /// nobody is within three radii of another one.
    pub gap_m: Option<f64>,
    /// Bodies that are no robots.
    pub intruders: &'a [Disc],
    /// The land as it is now, if there is any.
    pub land: Option<&'a Terrain>,
    /// What stands in the plane now.
    pub solids: &'a [Solid],
    /// The goals of a goal flock, world coordinates in metres.
    pub goals_m: [Option<[f64; 3]>; WAYPOINTS],
    /// Of the run so far, as in [`Outcome::trace_hash`].
    pub trace_hash: u64,
    /// The run itself, to be saved; `None` where it is none that could be.
    pub run: Option<&'a dyn Saves>,
}

/// What came of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Ticks done.
    pub ticks: u32,
    /// Simulated time, seconds.
    pub seconds: f64,
    /// Robots that stand at their targets and know it.
    pub arrived: usize,
    /// When each robot's last move was over, [`UNIT`](staya_controller::grid::UNIT)ths of a tick
    /// after the start; `None`: not at its target.
    pub arrival_times: Vec<Option<u64>>,
    /// Robots in a wall or in another one's cell, summed over ticks. The world allows none.
    pub collisions: u64,
    /// Packets of the whole run.
    pub packets: PacketCounts,
    /// Packets beyond a robot's bandwidth, never on the air.
    pub throttled: u64,
    /// What robots waited for.
    pub waits: Vec<WaitCount>,
    /// Means over the run; `None` without a formation.
    pub formation: Option<Keeping>,
    /// How far robots in the plane were from their places once they had had time to form.
    pub place_error: Option<PlaceError>,
    /// The same of each formation, in the order of [`Scenario::formations`](crate::scenario::Scenario::formations).
    pub formations: Vec<FormationKept>,
    /// How near bodies came to each other and to obstacles; `None` on the grid, where bodies have no size.
    pub clearance: Option<Clearance>,
    /// The same for equal traces, on any machine and any number of threads.
    pub trace_hash: u64,
}

/// Looks at the swarm after each tick, and says whether to go on.
pub type Watch<'a> = dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()> + 'a;

/// Runs a scenario until all robots have arrived, its ticks are used up or `watch` breaks. `watch`
/// sees the start as tick 0, then each tick, with the robots' lines by rising number.
///
/// # Errors
/// See [`Grid::new`].
pub fn simulate(
    scenario: &Scenario,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    simulate_with(scenario, None, &mut watch)
}

/// The same with some of the robots' controllers outside of this process.
///
/// # Errors
/// See [`Grid::new`].
pub fn simulate_with(
    scenario: &Scenario,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, Misplaced> {
    Ok(match AnyEngine::new(scenario)? {
        AnyEngine::Plane(engine) => go(scenario, *engine, external, watch),
        AnyEngine::Cells(engine) => go(scenario, *engine, external, watch),
    })
}

/// Why a run cannot begin.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unable {
    /// Its robots cannot be placed.
    #[error(transparent)]
    Misplaced(#[from] Misplaced),
    /// It cannot go on from this state.
    #[error(transparent)]
    State(#[from] StateError),
}

/// Goes on with a run from what [`Saves::save`] gave, as [`simulate`] would have; `watch` sees the ticks after that.
///
/// # Errors
/// See [`Grid::new`] and [`Engine::restore`].
pub fn simulate_from(scenario: &Scenario, state: &[u8], watch: &mut Watch<'_>) -> Result<Outcome, Unable> {
    Ok(match AnyEngine::new(scenario)? {
        AnyEngine::Plane(engine) => go_on(scenario, *engine, state, watch)?,
        AnyEngine::Cells(engine) => go_on(scenario, *engine, state, watch)?,
    })
}

/// What a robot's agent is made of: any guidance law, which an operator may take over, and any safety layer.
pub type GuidanceOf =
    Commanded<f32, NeighborTracking<f32, MapSharing<AnyGuidance<f32, WIDE, VISITS, TEMPLATE, LEARNED>, MAP_TILES>>>;
#[doc(hidden)]
pub type SafetyOf = Witness<AnySafety<f32, HALF_PLANES>>;

/// The engines that there are. Only here are they made of generic code, so that it is compiled once.
pub(super) enum AnyEngine {
    /// In the plane or in space.
    Plane(Box<Engine<PlaneGround, GuidanceOf, SafetyOf>>),
    /// Cell by cell.
    Cells(Box<Engine<Grid, GuidanceOf, SafetyOf>>),
}

impl AnyEngine {
    /// A scenario before its first tick.
    pub(super) fn new(scenario: &Scenario) -> Result<Self, Misplaced> {
        Ok(if let Some(setup) = &scenario.plane {
            let ground = PlaneGround::new(scenario, setup);
            Self::Plane(Box::new(Engine::new(scenario, ground, agents(scenario))))
        } else {
            let ground = Grid::new(scenario)?;
            Self::Cells(Box::new(Engine::new(scenario, ground, agents(scenario))))
        })
    }
}

/// Guidance and safety layer of each robot.
pub fn agents(scenario: &Scenario) -> impl Fn(usize) -> (GuidanceOf, SafetyOf) + Send + Sync + 'static + use<> {
    let kind = |index| {
        // Cell by cell there is neither speed nor distance.
        let group = scenario.plane.as_ref().map(|setup| setup.group(index));
        let [speed_mps, tolerance_m] =
            group.map_or([0.0; 2], |group| [group.cruise_mps, group.tolerance_m].map(|x| x as f32));
        (scenario.guidance(index), scenario.safety(index), speed_mps, tolerance_m)
    };
    // Places in a formation differ from robot to robot, otherwise groups at most: each is made once.
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
    let (maps, tracking) = (scenario.maps, scenario.eyes.map(|eyes| eyes.tracking));
    move |index| {
        let (guidance, safety, speed_mps, tolerance_m) = &kinds[of_robots[index]];
        // Who goes by no land has none to tell of.
        let maps = maps.filter(|_| guidance.kind().is_on_grid());
        let law = NeighborTracking::new(MapSharing::new(guidance.guidance(), maps), tracking);
        (Commanded::new(law, *speed_mps, *tolerance_m), Witness::new(safety.safety()))
    }
}

/// Ticks until the end.
pub(super) fn go<W, G, A>(
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

/// Ticks until the end, from another moment than the first.
fn go_on<W, G, A>(
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

/// Ticks until the end; the moment before the first of them has been seen.
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
