//! Benchmarks of one whole step of an agent, which decides in every step.
//!
//! On the grid: the middle robot of a formation of nine receives eight beacons, searches its window
//! of radius 5 (with reflexive prediction also once per visible neighbour), and encodes its beacon.
//! In the plane: a disc with ORCA on its way to a waypoint, among eight moving robots.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::agent::{
    AgentConfig, CELLS, CellState, FormationAgent, FormationGuidance, Grid, GridOrder, GridPayload, GridWorkspace,
    InPlane, Inputs, KinematicState, OnGrid, OrcaAgent, OrcaSafety, Protocol as _, RouteAgent, RouteGuidance,
    Unguarded, Waypoint, WaypointGuidance, WaypointOrder,
};
use staya_controller::formation::{FormationParams, Prediction};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::{Cell, Dir, Window};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::route::RouteParams;
use staya_controller::template::Template;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Content as _, Header, Message, Postcard, encode};

/// Rows 1 2 3, 4 5 6, 7 8 9, with robot 1 in front.
const PLACES: [Cell; 9] = [
    Cell::new(0, 0),
    Cell::new(-3, 0),
    Cell::new(-6, 0),
    Cell::new(0, -3),
    Cell::new(-3, -3),
    Cell::new(-6, -3),
    Cell::new(0, -6),
    Cell::new(-3, -6),
    Cell::new(-6, -6),
];
const EDGES: [(u16, u16); 12] =
    [(0, 1), (1, 2), (3, 4), (4, 5), (6, 7), (7, 8), (0, 3), (1, 4), (2, 5), (3, 6), (4, 7), (5, 8)];
const LEADERS: [u32; 9] = [0, 1, 2, 1, 2, 3, 4, 5, 6];
/// All eight neighbours are within two steps of the graph.
const OWN: usize = 4;
const TICK: Duration = Duration::from_millis(100);
/// Alternating windows keep the branch predictor from learning a single one.
const LANDSCAPES: usize = 32;
const TOP: Cell = Cell::new(50, 50);

/// One per sequence number, to be repeated cyclically.
fn inboxes() -> Vec<Vec<u8>> {
    let beacon = |robot: usize| {
        let payload = GridPayload {
            // Off its place, so that prediction must search its route.
            cell: TOP + PLACES[robot] + Cell::new(i16::from(robot != 0), 0),
            target: Cell::new(98, 98) + PLACES[robot],
            busy_ms: 0,
            heading: Dir::NorthEast,
            slot: robot as u8,
            leader: RobotId(LEADERS[robot]),
        };
        let (protocol, payload) = payload.encode(Grid::ID).unwrap();
        Beacon { mode: Mode::Cruise, protocol, payload, ..Beacon::default() }
    };
    (0..=u16::MAX)
        .map(|sequence| {
            let mut bytes = heapless::Vec::<u8, 512>::new();
            for robot in (0..PLACES.len()).filter(|&robot| robot != OWN) {
                let header = Header { boot: 0, sender: RobotId(robot as u32 + 1), sequence };
                encode(header, &Message::Beacon(beacon(robot)), &mut bytes).unwrap();
            }
            bytes.to_vec()
        })
        .collect()
}

fn agent_step(c: &mut Criterion) {
    let mut rng = Rng::new(1);
    let landscapes: Vec<Vec<u8>> =
        (0..LANDSCAPES).map(|_| (0..121).map(|_| 1 + rng.below(9) as u8).collect()).collect();
    let inboxes = inboxes();
    let config = AgentConfig { seed: 1, ..AgentConfig::new(RobotId(OWN as u32 + 1), 0.0, TICK) };
    let goal = Cell::new(98, 98) + PLACES[OWN];
    let cell = TOP + PLACES[OWN];
    let inputs = |step: usize| Inputs {
        state: KinematicState::default(),
        surroundings: OnGrid {
            cell: CellState { cell, busy: Duration::ZERO },
            window: Window::new(&landscapes[step % LANDSCAPES], cell - Cell::new(5, 5), 11, 11),
        },
        inbox: &inboxes[step % inboxes.len()],
    };
    let mut workspace = GridWorkspace::<CELLS>::new();
    let mut group = c.benchmark_group("agent_step");
    for (name, prediction) in [("constant_velocity", Prediction::Constant), ("reflexive", Prediction::Reflexive)] {
        let formation = FormationParams { prediction, ..FormationParams::default() };
        let template = Template::from_graph(&PLACES, &EDGES, OWN, 2).unwrap();
        let guidance = FormationGuidance::new(RouteParams::default(), formation, template);
        let mut agent = FormationAgent::new(&config, guidance, Unguarded, Postcard);
        agent.order(&GridOrder::Goal(goal));
        let mut step = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                step += 1;
                black_box(agent.step(black_box(&inputs(step)), now(step), &mut workspace))
            });
        });
        // A filter may have skipped the benchmark.
        assert!(step == 0 || agent.neighbors().len() == 8);
    }
    let law = RouteGuidance::new(RouteParams::default());
    let mut alone = RouteAgent::new(&config, law, Unguarded, Postcard);
    alone.order(&GridOrder::Goal(goal));
    let mut step = 0;
    group.bench_function("route_only", |bencher| {
        bencher.iter(|| {
            step += 1;
            black_box(alone.step(black_box(&inputs(step)), now(step), &mut workspace))
        });
    });
    group.finish();
}

const ROUND: usize = 256;

/// Eight discs on small circles 1 to 3 m away, at 0.5 m/s.
fn in_plane_inboxes() -> Vec<Vec<u8>> {
    let turn = |step: usize, robot: usize| (step % ROUND) as f64 / ROUND as f64 * core::f64::consts::TAU + robot as f64;
    let milli = |metres: f64| libm::round(metres * 1e3) as i32;
    let beacon = |step: usize, robot: usize| {
        let (bearing, turn) = (robot as f64 * 0.785, turn(step, robot));
        let (far_m, wide_m) = (1.0 + robot as f64 * 0.28, 0.3);
        let place = |out: f64, around: f64| milli(far_m * out + wide_m * around);
        let pace = |along: f64| milli(0.5 * along) as i16;
        Beacon {
            position_mm: [place(libm::cos(bearing), libm::cos(turn)), place(libm::sin(bearing), libm::sin(turn)), 0],
            velocity_mmps: [pace(-libm::sin(turn)), pace(libm::cos(turn)), 0],
            radius_mm: 200,
            mode: Mode::Cruise,
            ..Beacon::default()
        }
    };
    (0..=u16::MAX)
        .map(|sequence| {
            let mut bytes = heapless::Vec::<u8, 512>::new();
            for robot in 0..8 {
                let header = Header { boot: 0, sender: RobotId(robot as u32 + 2), sequence };
                encode(header, &Message::Beacon(beacon(sequence.into(), robot)), &mut bytes).unwrap();
            }
            bytes.to_vec()
        })
        .collect()
}

fn now(step: usize) -> Instant {
    Instant::from_micros((step as u32).wrapping_mul(TICK.as_micros().cast_unsigned()))
}

fn agent_step_in_plane(c: &mut Criterion) {
    let inboxes = in_plane_inboxes();
    let config = AgentConfig { seed: 1, latency: TICK, ..AgentConfig::new(RobotId(1), 0.2, TICK) };
    let inflation = StalenessInflation { growth_mps: 0.5, max_m: 0.2 };
    let safety = OrcaSafety::new(AvoidParams::default(), inflation);
    let mut agent = OrcaAgent::new(&config, WaypointGuidance::new(0.5, 0.02), safety, Postcard);
    let goal = Waypoint::fixed(Position::from_mm([20_000, 3_000, 0]));
    assert!(agent.order(&WaypointOrder::first(goal)));
    // The robot stays in place, so that the scene is identical in each round.
    let inputs = |step: usize| Inputs {
        state: KinematicState { velocity_mps: Vec3::new(0.3, 0.1, 0.0), ..KinematicState::default() },
        surroundings: InPlane { max_speed_mps: 0.5, obstacles: &[] },
        inbox: &inboxes[step % inboxes.len()],
    };
    let mut step = 0;
    c.bench_function("agent_step_in_plane", |bencher| {
        bencher.iter(|| {
            step += 1;
            black_box(agent.step(black_box(&inputs(step)), now(step), &mut ()))
        });
    });
    assert!(step == 0 || agent.neighbors().len() == 8);
}

criterion_group!(benches, agent_step, agent_step_in_plane);
criterion_main!(benches);
