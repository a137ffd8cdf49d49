//! Tests of operator commands and of parameters tuned at run time.

use super::plane::{RADIUS_MM, Robot, STEP, body_at, in_plane, length, orca, place, step_number, waypoint};
use super::*;
use crate::geom::{Position, Vec2};
use crate::parameters::{Parameter, Rejected};
use crate::scalar::Q16;

type Operated<S> = Robot<S, Guided<S, WaypointGuidance<S>>, OrcaSafety<S, 16>>;

fn robot<S: Scalar>(at_m: [f64; 2]) -> Operated<S> {
    let guidance = Guided::new(waypoint(), S::ONE, S::from_milli(10));
    Robot::new(&in_plane(1), guidance, orca(), at_m)
}

fn east(millis: i32) -> Wish<f32> {
    Wish::Velocity { velocity_mps: Vec3::new(0.5, 0.0, 0.0), valid: Duration::from_millis(millis) }
}

#[test]
fn without_a_command_behaviour_is_unchanged() {
    let mut plain = Robot::new(&in_plane::<f32>(1), waypoint(), orca(), [0.0; 2]);
    let mut wrapped = robot([0.0; 2]);
    plain.agent.order(&WaypointOrder::first(place(2000, 500)));
    wrapped.agent.order(&WaypointOrder::first(place(2000, 500)));
    for n in 0..40 {
        let now = step_number(n);
        let other = bytes(2, 0, n as u16, &[body_at([1000, 250], [0, 0], Mode::Cruise)]);
        assert_eq!(plain.step(now, &other), wrapped.step(now, &other), "step {n}");
    }
    assert!(length(wrapped.at_m) > 1.0);
}

#[test]
fn a_velocity_command_expires() {
    let mut robot = robot([0.0; 2]);
    robot.agent.law_mut().command(east(500)).unwrap();
    // Two steps at one time do not age the command.
    let _ = robot.step(step_number(0), &[]);
    for n in 0..5 {
        let _ = robot.step(step_number(n), &[]);
        assert_eq!(robot.velocity_mps, [0.5, 0.0], "step {n}");
        assert_eq!(robot.agent.mode(), Mode::Cruise);
    }
    let _ = robot.step(step_number(5), &[]);
    assert_eq!((robot.velocity_mps, robot.agent.mode()), ([0.0; 2], Mode::Hold));
    assert_eq!(robot.agent.law().wish(), &Wish::Hold);
    robot.agent.law_mut().command(east(500)).unwrap();
    let _ = robot.step(step_number(60), &[]);
    assert_eq!(robot.velocity_mps, [0.5, 0.0]);
}

#[test]
fn an_excessive_velocity_is_limited_and_a_non_finite_one_refused() {
    let mut robot = robot([0.0; 2]);
    let wish = |x: f32| Wish::Velocity { velocity_mps: Vec3::new(x, 0.0, 0.0), valid: Duration::MAX };
    robot.agent.law_mut().command(wish(7.0)).unwrap();
    for (n, bad) in [f32::NAN, f32::INFINITY, 7.0].into_iter().enumerate() {
        let taken = robot.agent.law_mut().command(wish(bad));
        assert_eq!(taken, bad.is_finite().then_some(()).ok_or(WrongTask));
        let _ = robot.step(step_number(n as i32), &[]);
        assert_eq!((robot.velocity_mps, robot.agent.mode()), ([1.0, 0.0], Mode::Cruise));
    }
}

#[test]
fn a_robot_follows_the_operator_and_then_its_own_law() {
    fn check<S: Scalar>() {
        let mut robot = robot::<S>([0.0; 2]);
        robot.agent.order(&WaypointOrder::first(place(-1000, 0)));
        robot
            .agent
            .law_mut()
            .command(Wish::Waypoint { waypoint: Waypoint::fixed(Position::from_mm([1000, 0, 0])), valid: None })
            .unwrap();
        for n in 0..20 {
            let _ = robot.step(step_number(n), &[]);
        }
        assert_eq!(robot.agent.mode(), Mode::Arrived);
        assert!((robot.at_m[0] - 1.0).abs() < 0.02, "{:?}", robot.at_m);
        robot.agent.law_mut().command(Wish::Own).unwrap();
        for n in 20..60 {
            let _ = robot.step(step_number(n), &[]);
        }
        assert!((robot.at_m[0] + 1.0).abs() < 0.02, "{:?}", robot.at_m);
    }
    check::<f32>();
    check::<f64>();
    check::<Q16>();
}

#[test]
fn a_moving_waypoint_is_followed_until_the_command_expires() {
    let mut robot = robot::<f32>([0.0; 2]);
    let mut moving = place(0, 0);
    moving.velocity_mps = Vec3::new(0.0, 0.5, 0.0);
    robot
        .agent
        .law_mut()
        .command(Wish::Waypoint { waypoint: moving, valid: Some(Duration::from_millis(1000)) })
        .unwrap();
    for n in 100..130 {
        let _ = robot.step(step_number(n), &[]);
    }
    assert_eq!(robot.agent.mode(), Mode::Hold);
    assert!((robot.at_m[1] - 0.5).abs() < 0.06, "{:?}", robot.at_m);
}

#[test]
fn a_released_robot_is_passive_and_a_holding_robot_gives_way() {
    let crowding = body_at([2 * RADIUS_MM + 60, 0], [-900, 0], Mode::Cruise);
    let mut moved = [0.0; 2];
    for (moved, wish) in moved.iter_mut().zip([Wish::Off, Wish::Hold]) {
        let mut robot = robot::<f32>([0.0; 2]);
        robot.agent.law_mut().command(wish).unwrap();
        for n in 0..3 {
            let out = robot.step(step_number(n), &bytes(2, 0, n as u16, std::slice::from_ref(&crowding)));
            let mode = match &sent(&out)[..] {
                [Frame { message: Message::Beacon(beacon), .. }, ..] => beacon.mode,
                other => panic!("{other:?}"),
            };
            let expected = match wish {
                Wish::Off => Mode::Passive,
                _ => Mode::Hold,
            };
            assert_eq!(mode, expected);
        }
        *moved = length(robot.at_m);
    }
    assert_eq!(moved[0], 0.0);
    assert!(moved[1] > 0.01, "{moved:?}");
}

#[test]
fn a_stop_does_not_override_the_operator() {
    type Steered = Guided<f32, CellFollower<f32, RouteGuidance<CELLS, VISITS>>>;
    let law: Steered = Guided::new(CellFollower::new(RouteGuidance::new(RouteParams::default()), 1.0), 1.0, 0.01);
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&in_plane(1), law, Unguarded, Postcard);
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    agent.law_mut().command(east(5000)).unwrap();
    let mut workspace = workspace();
    let mut step = |agent: &mut Agent<f32, Steered, NEIGHBORS>, n, inbox: &[u8]| {
        let surroundings = InCells {
            grid: inputs(&FLAT, Cell::new(5, 5), &[]).surroundings,
            plane: InPlane { max_speed_mps: 1.0, obstacles: &[] },
            in_cell: InCell { offset_m: Vec2::ZERO, cell_m: 1.0 },
        };
        let inputs = Inputs { state: KinematicState::default(), surroundings, inbox };
        (agent.step(&inputs, step_number(n), &mut *workspace).command, agent.mode())
    };
    let commanded = (Command::Velocity(Vec3::new(0.5, 0.0, 0.0)), Mode::Cruise);
    assert_eq!(step(&mut agent, 0, &bytes(2, 0, 0, &[stop(2, 1, 1)])), commanded);
    assert_eq!(step(&mut agent, 1, &[]), commanded);
    agent.law_mut().command(Wish::Own).unwrap();
    assert_eq!(step(&mut agent, 2, &[]), (Command::Velocity(Vec3::ZERO), Mode::Hold), "its own law obeys");
}

#[test]
fn on_the_grid_a_cell_replaces_the_own_goal_and_velocities_are_refused() {
    type GridAgent = Agent<f32, Guided<f32, RouteGuidance<CELLS, VISITS>>, NEIGHBORS>;
    let guidance = Guided::new(RouteGuidance::new(RouteParams::default()), 0.0, 0.0);
    let mut agent = GridAgent::new(&config(1), guidance, Unguarded, Postcard);
    agent.order(&GridOrder::Goal(Cell::new(9, 5)));
    let mut workspace = workspace();
    let mut heading = |agent: &mut GridAgent, n: u32| {
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), tick(n), &mut workspace);
        match out.command {
            Command::Move(moves) => moves.first().copied(),
            Command::Hold => None,
            Command::Velocity(_) => panic!("there are no velocities"),
        }
    };
    assert_eq!(heading(&mut agent, 0), Some(Dir::East));
    agent.law_mut().command(Wish::Cell(Cell::new(5, 9))).unwrap();
    assert_eq!(heading(&mut agent, 1), Some(Dir::North));
    assert_eq!(agent.target(), Some(Cell::new(5, 9)));
    let there = Wish::Waypoint { waypoint: place(1000, 0), valid: None };
    for wrong in [east(1000), there] {
        assert_eq!(agent.law_mut().command(wrong), Err(WrongTask));
    }
    assert_eq!(heading(&mut agent, 2), Some(Dir::North));
    agent.law_mut().command(Wish::Own).unwrap();
    assert_eq!(heading(&mut agent, 3), Some(Dir::East));
}

#[test]
fn a_cell_is_refused_by_a_law_with_waypoints() {
    let mut robot = robot::<f32>([0.0; 2]);
    robot.agent.order(&WaypointOrder::first(place(1000, 0)));
    let cell = Wish::Cell(Cell::new(3, 4));
    assert_eq!(robot.agent.law_mut().command(cell), Err(WrongTask));
    let _ = robot.step(step_number(0), &[]);
    assert_eq!(robot.agent.mode(), Mode::Cruise);
}

#[test]
fn the_passive_mode_is_left_through_idle() {
    for has_place in [false, true] {
        let mut robot = robot::<f32>([0.0; 2]);
        if has_place {
            robot.agent.order(&WaypointOrder::first(place(1000, 0)));
        }
        let mut modes = Vec::new();
        for (n, wish) in [Wish::Off, Wish::Own, Wish::Own].into_iter().enumerate() {
            robot.agent.law_mut().command(wish).unwrap();
            let _ = robot.step(step_number(n as i32), &[]);
            modes.push(robot.agent.mode());
        }
        let last = if has_place { Mode::Cruise } else { Mode::Idle };
        assert_eq!(modes, [Mode::Passive, Mode::Idle, last]);
    }
}

#[test]
fn parameters_keep_their_values_and_reject_values_out_of_range() {
    let mut robot = robot::<f32>([0.0; 2]);
    let mut rows = std::vec::Vec::new();
    robot.agent.parameters(&mut |table| rows.extend(table.table()));
    // Speed and tolerance of the law are also the operator's.
    assert_eq!(rows.len(), 12);
    assert_eq!(robot.agent.set_parameter("k1", 1.0), Err(Rejected::Unknown));
    for &Parameter { name, range, .. } in rows {
        let [least, greatest] = range;
        let before = robot.agent.parameter(name).expect(name);
        assert!((least..=greatest).contains(&before), "{name}");
        for bad in [least - 1.0, greatest + 1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(robot.agent.set_parameter(name, bad), Err(Rejected::OutOfRange(range)), "{name}");
            assert_eq!(robot.agent.parameter(name), Some(before));
        }
        for good in [least, greatest, 0.5] {
            assert_eq!(robot.agent.set_parameter(name, good), Ok(()), "{name}");
            let after = robot.agent.parameter(name).expect("still");
            assert!((after - good).abs() <= 1e-6 * good.max(1.0), "{name} {after}");
        }
    }
    let mut other = route_agent(1);
    assert_eq!(other.parameter("speed_mps"), None);
    assert!(other.set_parameter("speed_mps", 1.0).is_err());
    assert!(other.set_parameter("beacon_period_s", 2.0).is_ok());
}

#[test]
fn a_new_speed_and_beacon_period_apply_from_the_next_step() {
    let mut robot = robot::<f32>([0.0; 2]);
    robot.agent.order(&WaypointOrder::first(place(9000, 0)));
    let _ = robot.step(step_number(0), &[]);
    assert_eq!(robot.velocity_mps, [1.0, 0.0]);
    assert!(robot.agent.set_parameter("speed_mps", 0.25).is_ok());
    assert!(robot.agent.set_parameter("beacon_period_s", 1.0).is_ok());
    let mut beacons = 0;
    for n in 1..=20 {
        let out = robot.step(step_number(n), &[]);
        assert_eq!(robot.velocity_mps, [0.25, 0.0]);
        beacons += sent(&out).len();
    }
    assert_eq!((beacons, STEP.saturating_mul(10)), (2, Duration::from_millis(1000)));
}
