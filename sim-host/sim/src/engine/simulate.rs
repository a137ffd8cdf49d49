//! A whole scenario with the guidance that it asks for.

use super::{Elsewhere, Engine, Grid, Ground, PlaneGround};
use crate::metrics::Keeping;
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::Scenario;
use crate::world::Misplaced;
use crate::world::plane::Clearance;
use staya_controller::agent::{
    AnyGuidance, AnySafety, CELLS, FormationGuidance, Guidance, HALF_PLANES, RouteGuidance, Safety,
    TEMPLATE, Unguarded, VISITS,
};
use std::ops::ControlFlow;

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
pub const WIDE: usize = 1225;
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
    simulate_with(scenario, None, watch)
}

/// The same with some of the robots' controllers elsewhere.
///
/// # Errors
/// See [`Engine::new`].
pub fn simulate_with(
    scenario: &Scenario,
    elsewhere: Option<Box<dyn Elsewhere>>,
    watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    if let Some(setup) = &scenario.plane {
        let ground = PlaneGround::new(scenario, setup);
        let engine = Engine::new(scenario, ground, brains(scenario));
        return Ok(go(scenario, engine, elsewhere, watch));
    }
    match (&scenario.formation, is_narrow(scenario)) {
        (None, true) => drive(scenario, route::<CELLS>(scenario), elsewhere, watch),
        (None, false) => drive(scenario, route::<WIDE>(scenario), elsewhere, watch),
        (Some(_), true) => drive(scenario, formation::<CELLS>(scenario), elsewhere, watch),
        (Some(_), false) => drive(scenario, formation::<WIDE>(scenario), elsewhere, watch),
    }
}

/// Whether searches of the default size are large enough.
pub(super) const fn is_narrow(scenario: &Scenario) -> bool {
    scenario.route.params.radius <= NARROW_RADIUS
}

pub(super) type Brain = (
    AnyGuidance<f32, WIDE, VISITS, TEMPLATE>,
    AnySafety<f32, HALF_PLANES>,
);

/// Guidance and safety layer of each robot in the plane.
pub(super) fn brains(
    scenario: &Scenario,
) -> impl Fn(usize) -> Brain + Send + Sync + 'static + use<> {
    // Only places in a formation differ from robot to robot.
    let kinds = match scenario.formation {
        Some(_) => scenario.robots.len(),
        None => 1,
    };
    let guidances: Vec<_> = (0..kinds).map(|index| scenario.guidance(index)).collect();
    let safety = scenario.safety();
    move |index| (guidances[index % kinds].guidance(), safety.safety())
}

pub(super) fn route<const C: usize>(
    scenario: &Scenario,
) -> impl Fn(usize) -> RouteGuidance<C, VISITS> + use<C> {
    let route = scenario.route;
    move |_| {
        RouteGuidance::new(route.params)
            .replan(route.replan)
            .sharpness(route.sharpness)
    }
}

pub(super) fn formation<const C: usize>(
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
    elsewhere: Option<Box<dyn Elsewhere>>,
    watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, Misplaced> {
    let ground = Grid::new(scenario)?;
    let engine = Engine::new(scenario, ground, move |index| (guidance(index), Unguarded));
    Ok(go(scenario, engine, elsewhere, watch))
}

/// Ticks until the end.
fn go<W, G, A>(
    scenario: &Scenario,
    mut engine: Engine<W, G, A>,
    elsewhere: Option<Box<dyn Elsewhere>>,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Outcome
where
    W: Ground,
    G: Guidance<f32, Workspace: Default> + Send,
    A: Safety<f32> + Send,
{
    if let Some(controllers) = elsewhere {
        engine = engine.with_elsewhere(scenario, controllers);
    }
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
