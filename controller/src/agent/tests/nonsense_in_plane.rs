//! Tests of robots in the plane with arbitrary input: commands stay finite and within limits.

use super::nonsense::{frame, noise_and_frames};
use super::*;
use crate::boids::BoidsParams;
use crate::geom::{Position, Vec2, Vec3};
use crate::goal_flock::GoalParams;
use crate::lattice::{LatticeParams, ReferenceMotion};
use crate::laws::any::large;
use crate::neighbor::StalenessInflation;
use crate::obstacle::Obstacle;
use crate::orca::AvoidParams;
use crate::push_out::PushOutParams;
use proptest::collection::vec;
use proptest::prelude::*;

type Any = Agent<f32, AnyLaw<f32, CELLS, VISITS>, NEIGHBORS, AnySafety<f32, 16>>;

fn number() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![
        6 => -5.0..5.0_f32,
        1 => Just(0.0),
        1 => prop_oneof![
            Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(f32::MAX), Just(f32::MIN),
            Just(f32::MIN_POSITIVE), Just(1e-30), Just(1e30),
        ],
        1 => any::<u32>().prop_map(f32::from_bits),
    ]
}

fn vector() -> impl Strategy<Value = Vec3<f32>> + Clone {
    [number(), number(), number()].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn millimetres() -> impl Strategy<Value = i32> + Clone {
    prop_oneof![4 => -5000..5000_i32, 1 => Just(i32::MIN), 1 => Just(i32::MAX), 1 => any::<i32>()]
}

fn obstacle() -> impl Strategy<Value = Obstacle<f32>> {
    prop_oneof![
        [number(), number(), number(), number()]
            .prop_map(|[a, b, c, d]| Obstacle::Wall([Vec2::new(a, b), Vec2::new(c, d)])),
        (vector(), number()).prop_map(|(center_m, radius_m)| Obstacle::Ball { center_m, radius_m }),
        (vector(), number()).prop_map(|(normal, distance_m)| Obstacle::Plane { normal, distance_m }),
    ]
}

fn near() -> impl Strategy<Value = (Header, Message)> {
    let header = (0..2_u8, 1..7_u32, 0..40_u16).prop_map(|(boot, sender, sequence)| Header {
        boot,
        sender: RobotId(sender),
        sequence,
    });
    let numbers = ([millimetres(), millimetres(), millimetres()], any::<[i16; 3]>(), any::<(u16, bool, u8)>());
    let message = numbers.prop_map(|(position_mm, velocity, (radius, is_place, index))| {
        if is_place {
            let velocity_mps = Vec3::from_milli(velocity.map(i32::from));
            let waypoint = Waypoint { velocity_mps, ..Waypoint::fixed(Position::from_mm(position_mm)) };
            let order = WaypointOrder { index: index % 6, waypoint };
            Waypoints::order(RobotId::NONE, radius as u8, &order).unwrap()
        } else {
            Message::Beacon(Beacon {
                position_mm,
                velocity_mmps: velocity.map(|v| v / 8),
                radius_mm: radius / 64,
                mode: if index > 200 { Mode::Fault } else { Mode::Cruise },
                ..beacon_at((index % 9).into(), 2)
            })
        }
    });
    (header, message)
}

#[derive(Clone, Debug)]
struct Step {
    now: Instant,
    inbox: Vec<u8>,
    at_mm: [i32; 3],
    velocity_mps: Vec3<f32>,
    max_speed_mps: f32,
    obstacles: Vec<Obstacle<f32>>,
    in_cell: Option<(f32, f32, f32)>,
    has_land: bool,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let later = prop_oneof![6 => Just(100_000), 1 => Just(0), 1 => any::<u32>()];
    let frames = vec(prop_oneof![4 => near(), 1 => frame()], 0..8);
    let heard = (frames, vec(any::<u8>(), 0..20));
    let at = ([millimetres(), millimetres(), millimetres()], vector(), prop_oneof![4 => 0.01..3.0_f32, 1 => number()]);
    let cell = proptest::option::of((number(), number(), number()));
    let step = (later, heard, at, vec(obstacle(), 0..6), cell, any::<bool>());
    (any::<u32>(), vec(step, 1..20)).prop_map(|(mut now, steps)| {
        let mut all = Vec::new();
        for (later, heard, at, obstacles, in_cell, has_land) in steps {
            now = now.wrapping_add(later);
            let (at_mm, velocity_mps, max_speed_mps) = at;
            all.push(Step {
                now: Instant::from_micros(now),
                inbox: noise_and_frames(&heard.0, &heard.1),
                at_mm,
                velocity_mps,
                max_speed_mps,
                obstacles,
                in_cell,
                has_land,
            });
        }
        all
    })
}

fn guidance(which: u8, speed: f32, length: f32) -> AnyLaw<f32, CELLS, VISITS> {
    match which % 6 {
        0 => AnyLaw::Waypoint(WaypointGuidance::new(speed, length)),
        1 if which < 64 => {
            AnyLaw::Lattice(LatticeGuidance::following(LatticeParams::new(length), ReferenceMotion::Resting(length)))
        }
        1 => AnyLaw::Lattice(LatticeGuidance::new(LatticeParams::new(length), which < 128)),
        2 => {
            let params = GoalParams::new(length, speed);
            AnyLaw::GoalFlock(GoalFlockGuidance::new(params, length, 5))
        }
        3 => {
            let params = BoidsParams::new(length, 3.0 * length, 0.05, 0.02);
            AnyLaw::Boids(BoidsGuidance::new(params, speed))
        }
        4 => {
            let inside = RouteGuidance::new(RouteParams::default());
            AnyLaw::Route(OverCells::InPlane(large(CellFollower::new(inside, speed))))
        }
        _ => {
            let template = Template::from_graph(&[Cell::new(0, 0), Cell::new(-3, 0)], &[(0, 1)], 1, 2);
            let (route, keeping) = (RouteParams::default(), FormationParams::default());
            let inside = FormationGuidance::new(route, keeping, template.unwrap());
            AnyLaw::Formation(OverCells::InPlane(large(FormationInPlane::new(inside, speed))))
        }
    }
}

fn safety(which: u8, length: f32, growth_mps: f32) -> AnySafety<f32, 16> {
    let inflation = StalenessInflation { growth_mps, max_m: length };
    let orca = |source| AnySafety::Orca(OrcaSafety::with_source(AvoidParams::default(), inflation, source));
    match which % 5 {
        0 => AnySafety::None(Unguarded),
        1 => AnySafety::Fly(FlySafety::in_space(AvoidParams::default(), inflation)),
        2 => AnySafety::PushOut(PushOutSafety::new(PushOutParams::new(length))),
        3 => orca(AnyHalfPlanes::Template2k),
        _ => orca(AnyHalfPlanes::Analytic),
    }
}

proptest! {
    #[test]
    fn a_robot_in_the_plane_tolerates_any_input(
        which: (u8, u8), size in prop_oneof![3 => (0.1..2.0_f32, 0.1..2.0_f32), 1 => (number(), number())],
        body in prop_oneof![3 => (0.0..0.5_f32, 0.1..9.0_f32), 1 => (number(), number())],
        tick_us in prop_oneof![4 => Just(100_000), 1 => Just(1), 1 => Just(i32::MAX / 32)],
        steps in steps(),
    ) {
        let (radius_m, max_acceleration_mps2) = body;
        let tick = Duration::from_micros(tick_us);
        let config = AgentConfig { seed: 1, max_acceleration_mps2, ..AgentConfig::new(RobotId(9), radius_m, tick) };
        let (speed, length) = size;
        let mut agent = Any::new(&config, guidance(which.0, speed, length), safety(which.1, length, speed), Postcard);
        let there = (0, Waypoint::fixed(Position::from_mm([9000, 9000, 0])));
        let tasks = [Task::Cell(Cell::new(7, 7)), Task::Waypoints(heapless::Vec::from_array([there]))];
        prop_assert!(tasks.iter().filter(|task| agent.assign(task).is_ok()).count() <= 1);
        let mut ws = workspace();
        for step in &steps {
            let plane = InPlane { max_speed_mps: step.max_speed_mps, obstacles: &step.obstacles };
            let mut grid = inputs(&FLAT, Cell::new(5, 5), &[]).surroundings;
            grid.window = grid.window.filter(|_| step.has_land);
            let inputs = Inputs {
                state: KinematicState {
                    position: Position::from_mm(step.at_mm),
                    velocity_mps: step.velocity_mps,
                },
                surroundings: match step.in_cell {
                    None => AnySurroundings::InPlane(plane),
                    Some((x, y, cell_m)) => {
                        let in_cell = InCell { offset_m: Vec2::new(x, y), cell_m };
                        AnySurroundings::InCells(InCells { grid, plane, in_cell })
                    }
                },
                inbox: &step.inbox,
            };
            let before = agent.mode();
            let out = agent.step(&inputs, step.now, &mut ws);
            let Command::Velocity(v) = out.command else {
                prop_assert!(out.command == Command::Hold && [before, agent.mode()].contains(&Mode::Fault));
                continue;
            };
            prop_assert!(v.is_finite(), "{v:?}");
            // A body with inertia above its speed limit slows down as fast as it can.
            let fast = step.velocity_mps;
            let has_inertia = max_acceleration_mps2 < f32::MAX && (max_acceleration_mps2 * body_step_s(tick)).is_finite() && fast.is_finite();
            let limit = step.max_speed_mps.max(0.0);
            let most = if has_inertia { limit.max(fast.norm()) } else { limit };
            // The squares of still smaller numbers underflow.
            let most = f64::from(most) * 1.0001 + 1e-19;
            prop_assert!(f64::from(v.norm()) <= most, "{v:?} is faster than {most}");
        }
    }
}

fn body_step_s(tick: Duration) -> f32 {
    tick.as_micros() as f32 / 1e6
}
