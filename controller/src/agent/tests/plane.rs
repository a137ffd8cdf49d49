//! Tests of agents in the plane: waypoints, stopping, neighbours and scalar types.

mod places;

use super::*;
use crate::geom::{Position, Vec2, Vec3};
use crate::laws::any::large;
use crate::neighbor::StalenessInflation;
use crate::orca::AvoidParams;
use crate::scalar::Q16;

pub(super) const STEP: Duration = Duration::from_millis(100);
pub(super) const RADIUS_MM: i32 = 200;

pub(super) fn step_number(n: i32) -> Instant {
    Instant::from_micros(0) + STEP.saturating_mul(n)
}

pub(super) fn in_plane<S: Scalar>(id: u32) -> AgentConfig<S> {
    let contact_loss = ContactLossPolicy { listen: Duration::ZERO, ..ContactLossPolicy::DEFAULT };
    AgentConfig { seed: 1, contact_loss, ..AgentConfig::new(RobotId(id), S::from_milli(RADIUS_MM), STEP) }
}

pub(super) fn one_step_late<S: Scalar>(id: u32) -> AgentConfig<S> {
    AgentConfig { latency: STEP, contact_loss: ContactLossPolicy::DEFAULT, ..in_plane(id) }
}

pub(super) fn orca<S: Scalar>() -> OrcaSafety<S, 16> {
    let inflation = StalenessInflation { growth_mps: S::ONE, max_m: S::from_milli(300) };
    OrcaSafety::new(AvoidParams::default(), inflation)
}

pub(super) fn waypoint<S: Scalar>() -> WaypointGuidance<S> {
    WaypointGuidance::new(S::ONE, S::from_milli(10))
}

pub(super) fn place<S: Scalar>(x_mm: i32, y_mm: i32) -> Waypoint<S> {
    Waypoint::fixed(Position::from_mm([x_mm, y_mm, 0]))
}

pub(super) fn length([x, y]: [f64; 2]) -> f64 {
    Vec2::new(x, y).norm()
}

/// A body that follows commands at once.
pub(super) struct Robot<S: Scalar, G: Law<S>, A, P = RadioOnly> {
    pub(super) agent: Agent<S, G, 8, A, Postcard, P>,
    pub(super) at_m: [f64; 2],
    pub(super) velocity_mps: [f64; 2],
}

impl<S: Scalar, G, A: Safety<S>> Robot<S, G, A>
where
    G: for<'a> Law<S, Surroundings<'a> = InPlane<'a, S>, Workspace = ()>,
{
    pub(super) fn new(config: &AgentConfig<S>, law: G, safety: A, at_m: [f64; 2]) -> Self {
        Self::seeing(config, law, safety, at_m, RadioOnly)
    }
}

impl<S: Scalar, G, A: Safety<S>, P: Perception<S>> Robot<S, G, A, P>
where
    G: for<'a> Law<S, Surroundings<'a> = InPlane<'a, S>, Workspace = ()>,
{
    pub(super) fn seeing(config: &AgentConfig<S>, law: G, safety: A, at_m: [f64; 2], perception: P) -> Self {
        let agent = Agent::with_perception(config, law, safety, Postcard, perception);
        Self { agent, at_m, velocity_mps: [0.0; 2] }
    }

    /// The speed limit is 1 m/s.
    pub(super) fn step(&mut self, now: Instant, inbox: &[u8]) -> Outputs<S> {
        let number = |x: f64| S::from_f64(x).unwrap();
        let [vx, vy] = self.velocity_mps.map(number);
        let [x, y] = self.at_m;
        let inputs = Inputs {
            state: KinematicState {
                position: Position::from_metres([x, y, 0.0]).unwrap(),
                velocity_mps: Vec3::new(vx, vy, S::ZERO),
            },
            surroundings: InPlane { max_speed_mps: S::ONE, obstacles: &[] },
            inbox,
        };
        let out = self.agent.step(&inputs, now, &mut ());
        self.velocity_mps = match &out.command {
            Command::Velocity(v) => [v.x.to_f64(), v.y.to_f64()],
            Command::Hold => [0.0; 2],
            Command::Move(_) => panic!("there are no cells"),
        };
        for (at, v) in self.at_m.iter_mut().zip(self.velocity_mps) {
            *at += v * 0.1;
        }
        out
    }

    pub(super) fn speed(&self) -> f64 {
        length(self.velocity_mps)
    }
}

/// Remembers the robots that it sees, and decides as the test sets it.
#[derive(Default)]
pub(super) struct Onlooker {
    pub(super) seen: Vec<Nearby<f32>>,
    pub(super) is_broken: bool,
    pub(super) action: Option<Action<f32>>,
}

impl Law<f32> for Onlooker {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = ();
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        self.seen = view.nearby.to_vec();
        if self.is_broken {
            return Err(BadInput);
        }
        let decision = Decision::default();
        Ok(Decision { action: self.action.clone().unwrap_or(decision.action), ..decision })
    }
}

pub(super) fn body_at(position_mm: [i32; 2], velocity_mmps: [i16; 2], mode: Mode) -> Message {
    let ([x, y], [vx, vy]) = (position_mm, velocity_mmps);
    Message::Beacon(Beacon {
        position_mm: [x, y, 0],
        velocity_mmps: [vx, vy, 0],
        radius_mm: RADIUS_MM as u16,
        mode,
        ..Beacon::default()
    })
}

pub(super) fn said<S: Scalar>(outputs: &Outputs<S>) -> Beacon {
    let mut beacons = frames(&outputs.outbox).filter_map(|f| match decode(f).unwrap().message {
        Message::Beacon(beacon) => Some(beacon),
        _ => None,
    });
    beacons.next().expect("a beacon in each step")
}

#[test]
fn a_robot_without_a_waypoint_is_idle_and_sends_its_position() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [3.25, -1.5]);
    let beacon = said(&robot.step(step_number(0), &[]));
    assert_eq!((beacon.mode, robot.agent.mode()), (Mode::Idle, Mode::Idle));
    assert_eq!(beacon.position_mm, [3250, -1500, 0]);
    assert_eq!(beacon.radius_mm, 200);
    assert_eq!(robot.velocity_mps, [0.0; 2]);
}

#[test]
fn a_robot_moves_straight_to_its_waypoint_and_stops_there() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [0.0; 2]);
    assert!(robot.agent.order(&WaypointOrder::first(place(3000, 4000))));
    for n in 0..50 {
        let _ = robot.step(step_number(n), &[]);
        assert!((robot.speed() - 1.0).abs() < 1e-5, "step {n}");
        assert_eq!(robot.agent.mode(), Mode::Cruise);
        let [x, y] = robot.at_m;
        assert!((x * 4.0 - y * 3.0).abs() < 1e-2);
    }
    for n in 50..60 {
        let _ = robot.step(step_number(n), &[]);
    }
    assert_eq!(robot.agent.mode(), Mode::Arrived);
    assert_eq!(robot.velocity_mps, [0.0; 2]);
    let [x, y] = robot.at_m;
    assert!(length([x - 3.0, y - 4.0]) < 0.002, "{x} {y}");
}

#[test]
fn a_robot_follows_a_moving_waypoint() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [1.0, 0.0]);
    let _ =
        robot.agent.order(&WaypointOrder::first(Waypoint { velocity_mps: Vec3::new(0.3, 0.1, 0.0), ..place(1000, 0) }));
    for n in 0..100 {
        let _ = robot.step(step_number(n), &[]);
        let age_s = f64::from(n + 1) * 0.1;
        let [x, y] = robot.at_m;
        let off = length([x - 1.0 - 0.3 * age_s, y - 0.1 * age_s]);
        assert!(off < 0.01, "step {n}: {off} m behind");
        assert_eq!(robot.agent.mode(), Mode::Arrived);
    }
}

#[test]
fn beacons_carry_the_next_velocity() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(-6000, 8000)));
    let beacon = said(&robot.step(step_number(0), &[]));
    assert_eq!(beacon.velocity_mmps, [-600, 800, 0]);
}

#[test]
fn a_body_with_a_lag_sends_the_velocity_that_it_will_have() {
    for lag_s in [0.001, 0.1, 0.4, 2.0_f32] {
        let mut robot = Robot::new(&AgentConfig { lag_s, ..in_plane(1) }, waypoint::<f32>(), orca(), [0.0; 2]);
        let _ = robot.agent.order(&WaypointOrder::first(place(-60_000, 80_000)));
        let own = [0.3, 0.25];
        robot.velocity_mps = own;
        let beacon = said(&robot.step(step_number(0), &[]));
        let part = 1.0 - libm::exp(-0.1 / f64::from(lag_s));
        for ((own, command), sent) in own.into_iter().zip(robot.velocity_mps).zip(beacon.velocity_mmps) {
            let next = own + (command - own) * part;
            assert!((command - own).abs() > 0.5, "{command}");
            assert!((f64::from(sent) / 1000.0 - next).abs() < 0.06 * part, "lag {lag_s} s: {sent} mm/s, {next} m/s");
        }
    }
}

#[test]
fn an_invalid_radius_is_sent_as_zero() {
    for radius_m in [-1.0, f32::NAN, f32::NEG_INFINITY] {
        let config = AgentConfig { radius_m, ..in_plane(1) };
        let mut robot = Robot::new(&config, waypoint::<f32>(), orca(), [0.0; 2]);
        assert_eq!(said(&robot.step(step_number(0), &[])).radius_mm, 0);
    }
}

fn evades(mode: Mode) -> bool {
    let guidance = Onlooker { is_broken: mode == Mode::Fault, ..Onlooker::default() };
    let coming = body_at([1000, 50], [-1000, 0], Mode::Cruise);
    let (now, own) = (step_number(0), [0.0; 2]);
    let inbox = bytes(2, 0, 0, core::slice::from_ref(&coming));
    if mode == Mode::Fault {
        let mut robot = Robot::new(&in_plane(1), guidance, orca(), own);
        let out = robot.step(now, &inbox);
        assert_eq!((robot.agent.mode(), &out.command), (mode, &Command::Hold));
        return robot.speed() > 0.0;
    }
    let law = Guided::new(waypoint::<f32>(), 1.0, 0.01);
    let mut robot = Robot::new(&in_plane(1), law, orca(), own);
    match mode {
        Mode::Arrived => drop(robot.agent.order(&WaypointOrder::first(place(0, 0)))),
        Mode::Hold => {
            let _ = robot.agent.order(&WaypointOrder::first(place(0, 9000)));
            robot.agent.law_mut().command(Wish::Hold).unwrap();
        }
        _ => {}
    }
    let _ = robot.step(now, &inbox);
    assert_eq!(robot.agent.mode(), mode);
    robot.speed() > 0.01
}

#[test]
fn a_stationary_robot_gives_way_and_a_robot_in_fault_does_not() {
    let standing = [Mode::Idle, Mode::Arrived, Mode::Hold, Mode::Fault];
    assert_eq!(standing.map(evades), [true, true, true, false]);
}

#[test]
fn a_neighbour_that_does_not_give_way_gets_at_least_the_whole_correction() {
    let correction = |mode| {
        let mut robot = Robot::new(&in_plane(1), Onlooker::default(), orca(), [0.0; 2]);
        let inbox = bytes(2, 0, 0, &[body_at([900, 100], [-600, 0], mode)]);
        let _ = robot.step(step_number(0), &inbox);
        let gives_way = robot.agent.law().seen[0].gives_way;
        assert_eq!(gives_way, mode == Mode::Cruise);
        robot.speed()
    };
    let half = correction(Mode::Cruise);
    assert!(half > 0.01);
    for mode in [Mode::Fault, Mode::Passive] {
        let whole = correction(mode);
        assert!(whole / half > 1.98, "{half} {whole} {mode:?}");
    }
}

#[test]
fn neighbours_are_extrapolated_by_the_latency() {
    for (latency, x_m) in [(0, 5.0), (1, 4.9), (3, 4.7)] {
        let config = AgentConfig { latency: STEP.saturating_mul(latency), ..in_plane(1) };
        let mut robot = Robot::new(&config, Onlooker::default(), orca(), [0.0; 2]);
        let inbox = bytes(2, 0, 0, &[body_at([5000, 0], [-1000, 0], Mode::Cruise)]);
        let _ = robot.step(step_number(0), &inbox);
        let seen = &robot.agent.law().seen;
        assert!((seen[0].offset_m.x - x_m).abs() < 1e-5, "{seen:?}");
    }
}

#[test]
fn a_silent_neighbour_is_extrapolated_then_grows_then_expires() {
    let mut robot = Robot::new(&in_plane(1), Onlooker::default(), orca(), [0.0; 2]);
    let inbox = bytes(2, 0, 0, &[body_at([5000, 0], [-1000, 0], Mode::Cruise)]);
    let mut sights = Vec::new();
    for n in 0..32 {
        let inbox = if n == 0 { &inbox[..] } else { &[] };
        let _ = robot.step(step_number(n), inbox);
        sights.push(robot.agent.law().seen.first().copied());
    }
    // Stale after 4 steps, expired after 30; the ball grows by 0.05 m per step, at most by 0.3 m.
    for (n, x_m, radius_m, is_fresh) in [
        (0, 5.0, 0.2, true),
        (4, 4.6, 0.2, true),
        (5, 4.6, 0.25, false),
        (8, 4.6, 0.4, false),
        (12, 4.6, 0.5, false),
        (30, 4.6, 0.5, false),
    ] {
        let seen = sights[n].expect("not forgotten yet");
        assert!((seen.offset_m.x - x_m).abs() < 1e-5, "{n}: {seen:?}");
        assert!((seen.radius_m - radius_m).abs() < 1e-5, "{n}: {seen:?}");
        assert_eq!((seen.gives_way, seen.velocity_mps == Vec3::ZERO), (is_fresh, !is_fresh));
    }
    assert_eq!(sights[31], None);
}

/// Two robots swap places head on. Returns their positions after each step.
fn swap<S: Scalar>() -> Vec<[[f64; 2]; 2]> {
    let mut one = Robot::new(&one_step_late(1), waypoint::<S>(), orca(), [-2.0, 0.0]);
    let mut two = Robot::new(&one_step_late(2), waypoint::<S>(), orca(), [2.0, 0.0]);
    let _ = one.agent.order(&WaypointOrder::first(place(2000, 0)));
    let _ = two.agent.order(&WaypointOrder::first(place(-2000, 0)));
    let mut heard = [Vec::new(), Vec::new()];
    let mut track = Vec::new();
    for n in 0..80 {
        let now = step_number(n);
        let [to_one, to_two] = &heard;
        let said = [two.step(now, to_two).outbox, one.step(now, to_one).outbox];
        heard = said.map(|bytes| bytes.to_vec());
        track.push([one.at_m, two.at_m]);
    }
    assert_eq!([one.agent.mode(), two.agent.mode()], [Mode::Arrived; 2]);
    track
}

#[test]
fn robots_swap_places_alike_in_all_scalar_types() {
    let gap = |[one, two]: &[[f64; 2]; 2]| length([one[0] - two[0], one[1] - two[1]]) - 0.4;
    let (track, fine, fixed) = (swap::<f32>(), swap::<f64>(), swap::<Q16>());
    for (name, other, tolerance) in [("f64", &fine, 0.02), ("Q16", &fixed, 0.1)] {
        for (n, (a, b)) in track.iter().zip(other).enumerate() {
            let off = (0..2).map(|i| length([a[i][0] - b[i][0], a[i][1] - b[i][1]]));
            let off = off.fold(0.0, f64::max);
            assert!(off < tolerance, "{name}, step {n}: {off} m apart");
        }
    }
    for track in [track, fine, fixed] {
        let least = track.iter().map(gap).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0 && least < 0.5, "{least} m between them");
    }
}

#[test]
fn a_desired_velocity_of_nan_is_ignored() {
    struct Mad;
    impl Law<f32> for Mad {
        type Surroundings<'a> = InPlane<'a, f32>;
        type Protocol = ();
        type Workspace = ();
        fn decide(
            &mut self,
            _: &View<'_, f32>,
            _: &InPlane<'_, f32>,
            _: Tools<'_, f32, Self>,
        ) -> Result<Decision<f32>, BadInput> {
            let wish_mps = Vec2::new(f32::NAN, 1.0).extend(0.0);
            let way_m = Some(Vec3::new(f32::NAN, 1.0, 0.0));
            Ok(Decision::new(Action::Velocity { wish_mps, way_m }, Progress::Going))
        }
    }
    let mut robot = Robot::new(&in_plane(1), Mad, orca(), [0.0; 2]);
    let out = robot.step(step_number(0), &[]);
    assert_eq!(out.command, Command::Velocity(Vec3::ZERO));
}

#[test]
fn a_goal_on_the_grid_changes_nothing_for_a_law_with_waypoints() {
    let crowding = body_at([2 * RADIUS_MM + 60, 0], [-900, 0], Mode::Cruise);
    let goal = goal(0, 1, Cell::new(3, 4));
    let after_three = |is_told: bool, hears: &[Message]| {
        let mut robot = Robot::new(&in_plane::<f32>(1), waypoint(), orca(), [0.0; 2]);
        if is_told {
            assert_eq!(robot.agent.assign(&Task::Cell(Cell::new(3, 4))), Err(WrongTask));
        }
        for n in 0..3 {
            let _ = robot.step(step_number(n), &bytes(2, 0, 2 * n as u16, hears));
        }
        (robot.agent.mode(), robot.at_m)
    };
    let idle = after_three(false, std::slice::from_ref(&crowding));
    assert_eq!(idle.0, Mode::Idle);
    assert!(length(idle.1) > 0.01, "it gives way");
    assert_eq!(after_three(true, std::slice::from_ref(&crowding)), idle);
    assert_eq!(after_three(false, &[crowding, goal]), idle);
}

#[test]
fn a_robot_without_a_speed_is_in_fault_and_stands() {
    use crate::{boids::BoidsParams, goal_flock::GoalParams, lattice::LatticeParams};
    fn check<G>(mut law: G)
    where
        G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()>,
        G::Protocol: InAny,
    {
        let order = AnyOrder::Waypoint(WaypointOrder::first(place(1000, 0)));
        let _ = G::Protocol::order_in(&order).map(|order| law.order(&order));
        let config = one_step_late(1);
        let mut agent = Agent::<f32, _, NEIGHBORS, _, _>::new(&config, law, orca(), Postcard);
        let inputs = Inputs {
            state: KinematicState::default(),
            surroundings: InPlane { max_speed_mps: 0.0, obstacles: &[] },
            inbox: &[],
        };
        let out = agent.step(&inputs, step_number(0), &mut ());
        assert_eq!((agent.mode(), out.command), (Mode::Fault, Command::Hold));
    }
    check(WaypointGuidance::new(0.5, 0.02));
    check(LatticeGuidance::new(LatticeParams::new(1.0), true));
    check(GoalFlockGuidance::new(GoalParams::new(0.2, 0.5), 0.5, 1));
    check(BoidsGuidance::new(BoidsParams::new(0.3, 1.5, 0.05, 0.02), 0.5));
}

#[test]
fn the_input_of_another_law_is_a_fault() {
    type Any = AnyLaw<f32, CELLS, VISITS>;
    let route = || RouteGuidance::new(RouteParams::default());
    let plane = InPlane { max_speed_mps: 1.0, obstacles: &[] };
    let grid = inputs(&FLAT, Cell::new(5, 5), &[]).surroundings;
    let in_cell = InCell { offset_m: Vec2::ZERO, cell_m: 1.0 };
    let cells = InCells { grid, plane, in_cell };
    let surroundings =
        [AnySurroundings::OnGrid(grid), AnySurroundings::InPlane(plane), AnySurroundings::InCells(cells)];
    let modes = |law: Any, task: Task| {
        surroundings.map(|surroundings| {
            let config = in_plane(1);
            let mut agent = Agent::<f32, _, NEIGHBORS, _, _>::new(&config, law.clone(), Unguarded, Postcard);
            agent.assign(&task).unwrap();
            let inputs = Inputs { state: KinematicState::default(), surroundings, inbox: &[] };
            let _ = agent.step(&inputs, step_number(0), &mut workspace());
            agent.mode()
        })
    };
    let east = heapless::Vec::from_array([(0, place(9000, 0))]);
    use Mode::{Cruise, Fault};
    assert_eq!(modes(Any::Waypoint(waypoint()), Task::Waypoints(east)), [Fault, Cruise, Cruise]);
    let goal = || Task::Cell(Cell::new(9, 5));
    assert_eq!(modes(Any::Route(OverCells::OnGrid(route())), goal()), [Cruise, Fault, Fault]);
    let follower = CellFollower::new(route(), 1.0);
    assert_eq!(modes(Any::Route(OverCells::InPlane(large(follower))), goal()), [Fault, Fault, Cruise]);
}
