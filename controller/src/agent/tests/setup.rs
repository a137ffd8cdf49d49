//! Tests of agents that are created from data.

use super::super::*;
use crate::geom::{Position, Vec3};
use crate::goal_flock::GoalParams;
use crate::neighbor::StalenessInflation;
use crate::orca::AvoidParams;
use crate::push_out::PushOutParams;
use crate::robot::RobotId;
use crate::scalar::{Q16, Scalar};
use crate::time::{Duration, Instant};
use crate::wire::{Beacon, Format, Header, Message, encode};
use heapless::Vec;

const TICK: Duration = Duration::from_millis(50);

fn laws() -> [LawSettings; 7] {
    let route = RouteSettings::default();
    let lattice = LatticeSettings::default();
    [
        LawSettings::Waypoint(WaypointSettings { speed_mps: 0.5, tolerance_m: 0.01 }),
        LawSettings::Lattice(lattice),
        LawSettings::Lattice(LatticeSettings { goal_moves: false, goal_rest_m: 7.0, ..lattice }),
        LawSettings::GoalFlock(GoalFlockSettings { params: GoalParams::new(0.5, 0.5), arrival_m: 0.3, seed: 9 }),
        LawSettings::Boids(BoidsSettings {
            crowded_m: 0.3,
            closest_m: 1.5,
            speed_mps: 0.5,
            ..BoidsSettings::default()
        }),
        LawSettings::Route(route),
        LawSettings::Formation(FormationSettings {
            route: RouteSettings { speed_mps: Some(0.4), ..route },
            ..FormationSettings::default()
        }),
    ]
}

fn safeties() -> [LayerSettings; 4] {
    let inflation = StalenessInflation { growth_mps: 0.25, max_m: 0.3 };
    let orca = OrcaSettings { params: AvoidParams::default(), inflation };
    [
        LayerSettings::None(UnguardedSettings),
        LayerSettings::Template2k(TableSettings(orca)),
        LayerSettings::Fly(FlySettings { orca, downwash: 3.0 }),
        LayerSettings::PushOut(PushOutSettings { params: PushOutParams::new(0.4) }),
    ]
}

fn setups() -> impl Iterator<Item = Setup> {
    laws().into_iter().flat_map(|law| {
        safeties().into_iter().map(move |safety| Setup {
            agent: AgentConfig { seed: 7, ..AgentConfig::new(RobotId(3), 0.0, TICK) },
            law: law.clone(),
            safety,
            format: Format::Postcard,
        })
    })
}

fn lived<S: Scalar>(setup: &Setup, steps: u32) -> std::vec::Vec<u64> {
    let agent = setup.agent::<S, CELLS, VISITS, NEIGHBORS, HALF_PLANES, Postcard, 0>();
    let mut agent = agent.unwrap();
    let place = Waypoint::fixed(Position::from_mm([4000, 1000, 0]));
    let task = match setup.law {
        LawSettings::Route(_) | LawSettings::Formation(_) => Task::Cell(Cell::new(9, 5)),
        LawSettings::Boids(_) => Task::Waypoints(Vec::new()),
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
            surroundings: match setup.law {
                LawSettings::Route(_) => AnySurroundings::OnGrid(grid),
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
fn each_law_takes_the_goals_that_its_settings_name() {
    for settings in laws() {
        let mut law: AnyLaw<f32, CELLS, VISITS> = settings.law(());
        let waypoint = WaypointOrder::first(Waypoint::fixed(crate::geom::Position::ORIGIN));
        let orders = [AnyOrder::Grid(GridOrder::Goal(Cell::new(3, 4))), AnyOrder::Waypoint(waypoint)];
        let expected = match settings.goals() {
            Goals::None => [false, false],
            Goals::Cell => [true, false],
            Goals::Waypoints | Goals::Shared(_) => [false, true],
        };
        assert_eq!(orders.map(|order| law.order(&order)), expected, "{}", settings.name());
    }
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
    let [waypoint, _, _, _, _, route, formation] = laws();
    assert_eq!([waypoint, route, formation].map(|law| law.cells()), [0, CELLS, CELLS]);
}
