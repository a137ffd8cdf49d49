//! A whole scenario with the guidance that it asks for.

use super::{Engine, Grid, Ground, PlaneGround};
use crate::metrics::Keeping;
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::{GuidanceName, PlaneSetup, SafetyName, Scenario};
use crate::world::Misplaced;
use crate::world::plane::Clearance;
use staya_controller::agent::{
    AnyGuidance, AnyHalfPlanes, AnySafety, BoidsGuidance, CELLS, FlySafety, FormationGuidance,
    GoalFlockGuidance, Guidance, InPlane, LatticeGuidance, NEIGHBORS, OrcaSafety, PushOutSafety,
    RouteGuidance, Safety, TEMPLATE, Unguarded, VISITS, WaypointGuidance,
};
use staya_controller::orca::FlyParams;
use std::ops::ControlFlow;

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
const WIDE: usize = 1225;
/// The largest radius for which [`CELLS`] suffices.
const NARROW_RADIUS: u8 = 5;

/// The swarm after a tick, or (tick 0) before the first one.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The swarm's line of the record.
    pub row: &'a TickRow,
    /// Robots that stand at their targets and know it.
    pub arrived: usize,
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
    /// Means over the run; `None` without a formation.
    pub formation: Option<Keeping>,
    /// How near bodies came to each other and to obstacles; `None` on the grid, where bodies have no size.
    pub clearance: Option<Clearance>,
    /// The same for equal traces, on any machine and any number of threads.
    pub trace_hash: u64,
}

/// Runs a scenario until all robots have arrived, its ticks are used up or `watch` breaks. `watch`
/// sees the start as tick 0, then each tick, with the robots' lines by rising number.
///
/// # Errors
/// See [`Engine::new`].
pub fn simulate(
    scenario: &Scenario,
    watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    if let Some(setup) = &scenario.plane {
        let ground = PlaneGround::new(scenario, setup);
        let engine = Engine::new(scenario, ground, brains(scenario, setup));
        return Ok(go(scenario, engine, watch));
    }
    let is_narrow = scenario.route.params.radius <= NARROW_RADIUS;
    match (&scenario.formation, is_narrow) {
        (None, true) => drive(scenario, route::<CELLS>(scenario), watch),
        (None, false) => drive(scenario, route::<WIDE>(scenario), watch),
        (Some(_), true) => drive(scenario, formation::<CELLS>(scenario), watch),
        (Some(_), false) => drive(scenario, formation::<WIDE>(scenario), watch),
    }
}

/// Half-planes that a robot in the plane reckons with: those of its neighbours and as many obstacles.
const HALF_PLANES: usize = 2 * NEIGHBORS;

type Brain = (
    AnyGuidance<f32, WIDE, VISITS, TEMPLATE>,
    AnySafety<f32, HALF_PLANES>,
);

/// Guidance and safety layer of each robot in the plane.
fn brains(
    scenario: &Scenario,
    setup: &PlaneSetup,
) -> impl Fn(usize) -> Brain + Send + Sync + 'static + use<> {
    let (cruise_mps, tolerance_m) = (setup.cruise_mps as f32, setup.tolerance_m as f32);
    let (route, formation) = (route::<WIDE>(scenario), formation::<WIDE>(scenario));
    let (guidance, safety) = (setup.guidance, setup.safety);
    let (orca, doubt) = (setup.orca, setup.doubt);
    let (lattice, goal_flock, boids) = (setup.lattice, setup.goal_flock, setup.boids);
    let (seed, push_out) = (scenario.seed, setup.push_out);
    let fly = FlyParams {
        horizon_s: orca.horizon_s,
        obstacle_horizon_s: orca.wall_horizon_s,
        share: orca.share,
        margin_m: orca.margin_m,
    };
    move |index| {
        let guidance = match guidance {
            GuidanceName::Waypoint => {
                AnyGuidance::Waypoint(WaypointGuidance::new(cruise_mps, tolerance_m))
            }
            GuidanceName::Lattice => {
                AnyGuidance::Lattice(LatticeGuidance::new(lattice.0, lattice.1))
            }
            GuidanceName::GoalFlock => {
                AnyGuidance::GoalFlock(GoalFlockGuidance::new(goal_flock.0, goal_flock.1, seed))
            }
            GuidanceName::Boids => AnyGuidance::Boids(BoidsGuidance::new(boids, cruise_mps)),
            GuidanceName::Route => AnyGuidance::Route(InPlane::new(route(index), cruise_mps)),
            GuidanceName::Formation => {
                AnyGuidance::Formation(InPlane::new(formation(index), cruise_mps))
            }
        };
        let from = |source| AnySafety::Orca(OrcaSafety::with_source(orca, doubt, source));
        let safety = match safety {
            SafetyName::None => AnySafety::Unguarded(Unguarded),
            SafetyName::Orca => from(AnyHalfPlanes::Analytic),
            SafetyName::Template2k => from(AnyHalfPlanes::Template2k),
            SafetyName::Template8k => from(AnyHalfPlanes::Template8k),
            SafetyName::Template16k => from(AnyHalfPlanes::Template16k),
            SafetyName::Template64k => from(AnyHalfPlanes::Template64k),
            SafetyName::Fly => AnySafety::Fly(FlySafety::new(fly, doubt)),
            SafetyName::PushOut => AnySafety::PushOut(PushOutSafety::new(push_out)),
        };
        (guidance, safety)
    }
}

fn route<const C: usize>(
    scenario: &Scenario,
) -> impl Fn(usize) -> RouteGuidance<C, VISITS> + use<C> {
    let route = scenario.route;
    move |_| {
        RouteGuidance::new(route.params)
            .replan(route.replan)
            .sharpness(route.sharpness)
    }
}

fn formation<const C: usize>(
    scenario: &Scenario,
) -> impl Fn(usize) -> FormationGuidance<C, VISITS, TEMPLATE> + use<C> {
    let (route, params) = (scenario.route, scenario.formation_params);
    let templates = match &scenario.formation {
        Some(formation) => formation.templates.clone(),
        None => Vec::new(),
    };
    move |index| {
        let template = templates.get(index).cloned().unwrap_or_default();
        FormationGuidance::new(route.params, params, template).sharpness(route.sharpness)
    }
}

fn drive<G: Guidance<f32, Workspace: Default> + Send>(
    scenario: &Scenario,
    guidance: impl Fn(usize) -> G + Send + Sync + 'static,
    watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    let ground = Grid::new(scenario)?;
    let engine = Engine::new(scenario, ground, move |index| (guidance(index), Unguarded));
    Ok(go(scenario, engine, watch))
}

/// Ticks until the end.
fn go<W, G, A>(
    scenario: &Scenario,
    mut engine: Engine<W, G, A>,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Outcome
where
    W: Ground,
    G: Guidance<f32, Workspace: Default> + Send,
    A: Safety<f32> + Send,
{
    let mut row = engine.first_row();
    loop {
        let moment = Moment {
            row: &row,
            arrived: engine.arrivals.count(),
        };
        let flow = watch(&moment, &mut engine.rows());
        if flow.is_break() || engine.is_over() || engine.ticks() >= scenario.ticks {
            return engine.outcome();
        }
        row = engine.step();
    }
}
