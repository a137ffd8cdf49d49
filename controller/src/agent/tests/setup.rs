//! Tests of agents that are created from data.

use super::super::*;
use crate::formation::FormationParams;
use crate::geom::{Position, Vec3};
use crate::goal_flock::GoalParams;
use crate::lattice::{LatticeParams, ReferenceMotion};
use crate::neighbor::StalenessInflation;
use crate::orca::AvoidParams;
use crate::push_out::PushOutParams;
use crate::robot::RobotId;
use crate::route::{Replan, RouteParams};
use crate::scalar::{Q16, Scalar};
use crate::shuffle::Sharpness;
use crate::time::{Duration, Instant};
use crate::wire::{Beacon, Format, Header, Message, encode};
use heapless::Vec;

const TICK: Duration = Duration::from_millis(50);

fn guidances() -> [GuidanceSetup; 7] {
    let route = RouteSetup { params: RouteParams::default(), replan: Replan::EachCell, sharpness: Sharpness::Greedy };
    [
        GuidanceSetup::Waypoint { speed_mps: 0.5, tolerance_m: 0.01 },
        GuidanceSetup::Lattice { params: LatticeParams::new(1.0), motion: ReferenceMotion::Dynamic },
        GuidanceSetup::Lattice { params: LatticeParams::new(1.0), motion: ReferenceMotion::Resting(7.0) },
        GuidanceSetup::GoalFlock { params: GoalParams::new(0.5, 0.5), arrival_m: 0.3, seed: 9 },
        GuidanceSetup::Boids {
            params: BoidsSetup { crowded_m: 0.3, closest_m: 1.5, ..BoidsSetup::PAPER },
            speed_mps: 0.5,
        },
        GuidanceSetup::Route { route, speed_mps: None },
        GuidanceSetup::Formation {
            route,
            formation: FormationParams::default(),
            template: crate::template::Template::default(),
            speed_mps: Some(0.4),
        },
    ]
}

fn safeties() -> [SafetySetup; 4] {
    let inflation = StalenessInflation { growth_mps: 0.25, max_m: 0.3 };
    [
        SafetySetup::None,
        SafetySetup::Orca { params: AvoidParams::default(), inflation, source: AnyHalfPlanes::Template2k },
        SafetySetup::Fly { params: AvoidParams::default(), inflation, downwash: 3.0 },
        SafetySetup::PushOut { params: PushOutParams::new(0.4) },
    ]
}

fn setups() -> impl Iterator<Item = Setup> {
    guidances().into_iter().flat_map(|guidance| {
        safeties().into_iter().map(move |safety| Setup {
            agent: AgentConfig { seed: 7, ..AgentConfig::new(RobotId(3), 0.0, TICK) },
            guidance: guidance.clone(),
            safety,
            format: Format::Postcard,
        })
    })
}

fn lived<S: Scalar>(setup: &Setup, steps: u32) -> std::vec::Vec<u64> {
    let agent = setup.agent::<S, CELLS, VISITS, NEIGHBORS, HALF_PLANES, Postcard, 0>();
    let mut agent = agent.unwrap();
    let place = Waypoint::fixed(Position::from_mm([4000, 1000, 0]));
    let task = match setup.guidance {
        GuidanceSetup::Route { .. } | GuidanceSetup::Formation { .. } => Task::Cell(Cell::new(9, 5)),
        GuidanceSetup::Boids { .. } => Task::Waypoints(Vec::new()),
        _ => Task::Waypoints(Vec::from_array([(0, place)])),
    };
    agent.assign(&task).unwrap();
    let land = [1; 121];
    let mut workspace = GridWorkspace::new();
    let mut digests = std::vec![agent.digest()];
    for step in 0..steps {
        let now = Instant::from_micros(step * 50_000);
        let beacon = Beacon {
            position_mm: [900 - 20 * step as i32, 30, 0],
            velocity_mmps: [-400, 0, 0],
            radius_mm: 150,
            ..Beacon::default()
        };
        let header = Header { boot: 0, sender: RobotId(4), sequence: step as u16 };
        let mut inbox = Vec::<u8, 64>::new();
        encode(header, &Message::Beacon(beacon), &mut inbox).unwrap();
        let grid = OnGrid {
            cell: CellState { cell: Cell::new(5, 5), busy: Duration::ZERO },
            window: crate::grid::Window::new(&land, Cell::new(0, 0), 11, 11),
        };
        let inputs = Inputs {
            state: KinematicState {
                position: Position::from_mm([step as i32 * 10, 0, 0]),
                velocity_mps: Vec3::new(S::from_ratio(1, 5), S::ZERO, S::ZERO),
            },
            surroundings: match setup.guidance {
                GuidanceSetup::Route { .. } => AnySurroundings::OnGrid(grid),
                _ => AnySurroundings::InCells(InCells {
                    grid,
                    plane: InPlane { max_speed_mps: S::ONE, obstacles: &[] },
                    in_cell: InCell { offset_m: crate::geom::Vec2::ZERO, cell_m: S::ONE },
                }),
            },
            inbox: &inbox,
        };
        let _ = agent.step(&inputs, now, &mut workspace);
        digests.push(agent.digest());
    }
    digests
}

#[test]
fn each_law_takes_either_a_cell_or_a_waypoint() {
    let takes = guidances().map(|setup| {
        let mut law: AnyLaw<f32, CELLS, VISITS, TEMPLATE> = setup.law(());
        let waypoint = WaypointOrder::first(Waypoint::fixed(crate::geom::Position::ORIGIN));
        [AnyOrder::Grid(GridOrder::Goal(Cell::new(3, 4))), AnyOrder::Waypoint(waypoint)].map(|order| law.order(&order))
    });
    let (waypoint, none, cell) = ([false, true], [false, false], [true, false]);
    assert_eq!(takes, [waypoint, waypoint, waypoint, waypoint, none, cell, cell]);
}

#[test]
fn a_setup_sent_over_a_link_creates_an_identical_robot() {
    for setup in setups() {
        let bytes = {
            let mut buffer = [0; 512];
            postcard::to_slice(&setup, &mut buffer).map(|used| used.to_vec())
        }
        .expect("fits a frame");
        let copy: Setup = postcard::from_bytes(&bytes).unwrap();
        assert_eq!(copy, setup);
        assert_eq!(lived::<f32>(&copy, 4), lived::<f32>(&setup, 4));
    }
}

#[test]
fn each_step_leaves_a_distinct_state() {
    for setup in setups() {
        for digests in [lived::<f32>(&setup, 5), lived::<Q16>(&setup, 5)] {
            for (step, digest) in digests.iter().enumerate() {
                assert!(!digests[..step].contains(digest), "{setup:?} at {step}");
            }
        }
    }
}

#[test]
fn the_digest_covers_the_whole_state() {
    let base = setups().next().unwrap();
    let other = |change: &dyn Fn(&mut Setup)| {
        let mut setup = base.clone();
        change(&mut setup);
        lived::<f32>(&setup, 0)[0]
    };
    let same = other(&|_| ());
    assert_eq!(same, lived::<f32>(&base, 0)[0]);
    assert_ne!(same, other(&|setup| setup.agent.id = RobotId(4)));
    assert_ne!(same, other(&|setup| setup.agent.seed = 8));
    assert_ne!(same, other(&|setup| setup.agent.boot = 1));
    assert_ne!(same, other(&|setup| setup.agent.radius_m = 0.1));
    assert_ne!(same, other(&|setup| setup.safety = safeties()[3]));
}

#[test]
fn a_format_that_the_wire_type_lacks_is_refused() {
    let setup = Setup { format: Format::Mavlink, ..setups().next().unwrap() };
    let agent = setup.agent::<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, Postcard, 0>();
    assert!(agent.is_none());
}

#[test]
fn cells_returns_the_size_of_the_search() {
    let cells = |guidance: &GuidanceSetup| {
        let setup = Setup { guidance: guidance.clone(), ..setups().next().unwrap() };
        setup.cells()
    };
    let [waypoint, _, _, _, _, route, formation] = guidances();
    assert_eq!(cells(&waypoint), 0);
    assert_eq!((cells(&route), cells(&formation)), (CELLS, CELLS));
}
