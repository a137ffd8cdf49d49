use crate::grid::{Route, workspace};
use crate::land::Land;
use crate::medium::Faults;
use crate::plane::{Mover, PlaneAgent, STEP, Scene, Solid, run};
use crate::{Probe, Summary};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    AgentConfig, CellFollower, FlySafety, GridOrder, Law, OrcaSafety, PushOutSafety, Safety, Waypoint,
    WaypointGuidance, WaypointOrder,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::Cell;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::{Analytic, AvoidParams, HalfSpaces};
use staya_controller::push_out::PushOutParams;
use staya_controller::robot::RobotId;
use staya_controller::route::RouteParams;
use staya_controller::scalar::Scalar;
use staya_controller::wire::Postcard;

const RADIUS_MM: i32 = 150;
const PLANES: usize = 16;

/// Radius 1.5 m, slightly irregular to avoid symmetry.
const PENTAGON: [[i32; 3]; 5] = [[1500, 0, 0], [464, 1427, 0], [-1214, 882, 0], [-1214, -885, 0], [464, -1420, 0]];

pub(super) fn config<S: Scalar>(index: usize) -> AgentConfig<S> {
    AgentConfig {
        seed: 11,
        latency: STEP,
        ..AgentConfig::new(RobotId(index as u32 + 1), S::from_milli(RADIUS_MM), STEP)
    }
}

fn inflation<S: Scalar>() -> StalenessInflation<S> {
    StalenessInflation { growth_mps: S::HALF, max_m: S::from_milli(300) }
}

/// Fills the caller's vector because a small part has no memory for two.
#[inline(never)]
pub(super) fn add_movers<S: Scalar, G: Law<S>, A: Safety<S>, const R: usize>(
    movers: &mut Vec<Mover<S, G, A>, R>,
    starts: &[[i32; 3]; R],
    guidance: impl Fn(usize) -> G,
    safety: impl Fn() -> A,
) {
    for (index, start) in starts.iter().enumerate() {
        let _ = movers.push(Mover {
            agent: PlaneAgent::new(&config(index), guidance(index), safety(), Postcard),
            position: Position::from_mm(*start),
            velocity_mps: Vec3::ZERO,
        });
    }
}

fn scene<S: Scalar>(solids: &'static [Solid]) -> Scene<S> {
    Scene { solids, land: None, max_speed_mps: S::HALF, apart_mm: 2 * RADIUS_MM, faults: Faults::default(), ticks: 400 }
}

fn waypoint<S: Scalar>() -> WaypointGuidance<S> {
    WaypointGuidance::new(S::HALF, S::from_milli(30))
}

fn to_places<S: Scalar, A: Safety<S> + Serialize, P: Probe<S>, const R: usize>(
    scene: &Scene<S>,
    starts: &[[i32; 3]; R],
    goals: &[[i32; 3]; R],
    safety: impl Fn() -> A,
    probe: &mut P,
) -> Summary {
    let mut movers = Vec::new();
    add_movers(&mut movers, starts, |_| waypoint(), safety);
    for (mover, goal) in movers.iter_mut().zip(goals) {
        mover.agent.order(&WaypointOrder::first(Waypoint::fixed(Position::from_mm(*goal))));
    }
    run(scene, &mut movers, &mut (), probe)
}

#[inline(never)]
pub(super) fn swap<S: Scalar, H: HalfSpaces<S> + Clone + Serialize, P: Probe<S>>(source: H, probe: &mut P) -> Summary {
    let params = AvoidParams::default();
    to_places(
        &scene(&[]),
        &PENTAGON,
        &PENTAGON.map(|place| place.map(|mm: i32| -mm)),
        || OrcaSafety::<S, PLANES, H>::with_source(params, inflation(), source.clone()),
        probe,
    )
}

#[inline(never)]
pub(super) fn doorway<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    const WALLS: [Solid; 2] = [Solid::Wall([[0, -9000], [0, -250]]), Solid::Wall([[0, 250], [0, 9000]])];
    let starts = [[-1500, 0, 0], [-2500, 300, 0], [1500, 100, 0], [2500, -300, 0]];
    let goals = [[2500, 300, 0], [1500, 0, 0], [-2500, -300, 0], [-1500, 100, 0]];
    let safety = || OrcaSafety::<S, PLANES>::new(AvoidParams::default(), inflation());
    let faults = Faults { seed: 7, fade: u32::MAX / 5, loss: u32::MAX >> 4, ..Faults::default() };
    to_places(&Scene { faults, ..scene(&WALLS) }, &starts, &goals, safety, probe)
}

#[inline(never)]
pub(super) fn fly<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    const SOLIDS: [Solid; 2] = [Solid::Floor(0), Solid::Ball([0, 0, 1500], 200)];
    let heights = [1000, 1400, 1800, 1200, 1600];
    let at = |sign: i32| {
        let mut places = PENTAGON;
        for (place, height) in places.iter_mut().zip(heights) {
            let [x, y, z] = place;
            (*x, *y) = (*x * sign, *y * sign);
            *z = 1400 + sign * (height - 1400);
        }
        places
    };
    let safety = || FlySafety::<S, PLANES>::in_space(AvoidParams::default(), inflation());
    to_places(&scene(&SOLIDS), &at(1), &at(-1), safety, probe)
}

#[inline(never)]
pub(super) fn push_out<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    const SOLIDS: [Solid; 2] = [Solid::Ball([0, 0, 0], 300), Solid::Wall([[-3000, 1900], [3000, 1900]])];
    let starts = [[-2000, 150, 0], [2000, 900, 0], [-300, -2000, 0]];
    let goals = [[2000, 100, 0], [-2000, 1100, 0], [400, 1300, 0]];
    let safety = || PushOutSafety::new(PushOutParams::new(S::from_milli(400)));
    to_places(&scene(&SOLIDS), &starts, &goals, safety, probe)
}

#[inline(never)]
pub(super) fn route_in_plane<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    let land = Land { size: 16, roughness_log2: 1, walls: &[(7, 3, 10)] };
    let starts = [[3500, 3500, 0], [12_500, 3500, 0], [3500, 12_500, 0]];
    let goals = [Cell::new(12, 11), Cell::new(3, 12), Cell::new(12, 4)];
    let guidance = |_| CellFollower::new(Route::new(RouteParams::default()), S::HALF);
    let safety = || OrcaSafety::<S, PLANES>::with_source(AvoidParams::default(), inflation(), Analytic);
    let mut movers = Vec::new();
    add_movers(&mut movers, &starts, guidance, safety);
    for (mover, goal) in movers.iter_mut().zip(goals) {
        mover.agent.order(&GridOrder::Goal(goal));
    }
    let scene = Scene { land: Some(land), ticks: 700, ..scene(&[]) };
    run(&scene, &mut movers, &mut workspace(), probe)
}
