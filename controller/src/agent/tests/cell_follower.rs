//! Tests of grid laws on bodies that move in the plane.

use super::*;
use crate::geom::Vec2;
use crate::land::{LandPatch, PATCH_TILES};
use crate::neighbor::Neighbor;

const STEP: Duration = Duration::from_millis(100);
const VALID: Duration = Duration::from_millis(1200);

/// Moves north-east and counts the calls.
#[derive(Default)]
struct Counting {
    decisions: u32,
    redirections: u32,
    orders: u32,
}

impl Law<f32> for Counting {
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Grid;
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, f32, Grid>,
        _: &OnGrid<'_>,
        mut tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        self.decisions += 1;
        tools.radio.send(RobotId(9), &GridMessage::Redirect, tools.radio.valid);
        let action = Action::Moves([Dir::NorthEast, Dir::South].into_iter().collect());
        Ok(Decision::new(action, Progress::Going))
    }

    fn receive(&mut self, _: RobotId, message: &GridMessage, radio: &mut Radio<'_, Grid>) -> bool {
        if *message == GridMessage::Redirect {
            self.redirections += 1;
            radio.decide_at_once();
        }
        true
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        self.orders += 1;
        matches!(order, GridOrder::Goal(_))
    }

    fn needs(&self, id: RobotId) -> bool {
        id == RobotId(77)
    }

    fn report(&self) -> Report {
        let there = Some(Cell::new(9, 5));
        Report { goal: there, target: there, leader: RobotId(4), slot: 3, stopped_until: Some(tick(3)) }
    }
}

type Told = (View<'static, f32, Grid>, InCells<'static, f32>);

/// No robot is known.
const NO_ROBOT: &&[Neighbor<f32, GridPayload>] = &(&[] as &[_]);

fn told(cell: Cell, offset_m: [f32; 2], max_speed_mps: f32, n: i32) -> Told {
    let scene = Scene {
        id: RobotId(1),
        now: Instant::from_micros(0) + STEP.saturating_mul(n),
        tick: STEP,
        state: KinematicState::default(),
        ahead_m: Vec3::ZERO,
        lag_s: 0.0,
        body: Body {
            id: RobotId(1),
            velocity_mps: Vec3::ZERO,
            radius_m: 0.2,
            max_speed_mps,
            max_acceleration_mps2: f32::MAX,
            step_s: 0.1,
        },
        nearby: &[],
        ages: config(1).ages,
        sent_to: None,
        cells: None,
    };
    let here = InCells {
        grid: OnGrid { cell: CellState { cell, busy: Duration::ZERO }, window: None },
        plane: InPlane { max_speed_mps, obstacles: &[] },
        in_cell: InCell { offset_m: Vec2::new(offset_m[0], offset_m[1]), cell_m: 2.0 },
    };
    (View { scene, known: NO_ROBOT }, here)
}

fn counting() -> CellFollower<f32, Counting> {
    CellFollower::new(Counting::default(), 1.0)
}

fn decide<G>(law: &mut G, (input, here): &Told) -> Result<Decision<f32>, BadInput>
where
    G: for<'a> Law<f32, Surroundings<'a> = InCells<'a, f32>, Workspace = (), Protocol = Grid>,
{
    with_messages(law, (input, here)).0
}

fn with_messages<G>(
    law: &mut G,
    (input, here): (&View<'_, f32, Grid>, &InCells<'_, f32>),
) -> (Result<Decision<f32>, BadInput>, usize)
where
    G: for<'a> Law<f32, Surroundings<'a> = InCells<'a, f32>, Workspace = (), Protocol = Grid>,
{
    let mut outgoing = Outgoing::default();
    let radio = Radio::new(input.now, VALID, &mut outgoing);
    let decision = law.decide(input, here, Tools { rng: &mut Rng::new(1), radio, workspace: &mut () });
    (decision, outgoing.messages.len())
}

/// Also returns the number of decisions of the law inside.
fn ask(law: &mut CellFollower<f32, Counting>, told: &Told) -> (Decision<f32>, u32) {
    let decision = decide(law, told).expect("a decision");
    (decision, law.inside().decisions)
}

fn motion(decision: &Decision<f32>) -> (Vec3<f32>, Option<Vec3<f32>>) {
    match &decision.action {
        Action::Velocity { wish_mps, way_m } => (*wish_mps, *way_m),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_law_decides_again_in_another_cell_or_after_the_time_to_cross_one() {
    let mut guidance = counting();
    let mut count = |cell, n| ask(&mut guidance, &told(cell, [0.0; 2], 1.0, n)).1;
    let (here, there) = (Cell::new(5, 5), Cell::new(6, 5));
    // 2 m at 1 m/s are 20 steps.
    assert_eq!([0, 1, 19].map(|n| count(here, n)), [1, 1, 1]);
    assert_eq!([20, 39, 40].map(|n| count(here, n)), [2, 2, 3]);
    assert_eq!([41, 42].map(|n| count(there, n)), [4, 4]);
    assert_eq!(count(here, 43), 5);
    assert_eq!(count(here, 42), 6, "the clock went back");
}

#[test]
fn on_rough_terrain_the_law_decides_less_often() {
    let mut guidance = counting();
    let mut count = |n| ask(&mut guidance, &told(Cell::new(5, 5), [0.0; 2], 0.25, n)).1;
    assert_eq!([0, 79, 80].map(&mut count), [1, 1, 2]);
}

#[test]
fn messages_are_sent_once_per_decision() {
    let mut guidance = counting();
    let mut asks = |n| {
        let (view, here) = told(Cell::new(5, 5), [0.0; 2], 1.0, n);
        with_messages(&mut guidance, (&view, &here)).1
    };
    assert_eq!([0, 1, 19, 20].map(&mut asks), [1, 0, 0, 1]);
}

#[test]
fn the_law_does_not_decide_again_on_a_border() {
    let mut guidance = counting();
    let mut count = |cell, x| ask(&mut guidance, &told(cell, [x, 0.0], 1.0, 0)).1;
    let (here, there) = (Cell::new(5, 5), Cell::new(6, 5));
    // Cells of 2 m: over the border and back, then 1.6 m from the centre.
    let counts =
        [(here, 0.9), (there, -0.9), (here, 0.9), (there, -0.6), (there, -0.4)].map(|(cell, x)| count(cell, x));
    assert_eq!(counts, [1, 1, 1, 1, 2]);
    let counts = [(there, -0.9), (here, 0.9), (here, 0.4)].map(|(cell, x)| count(cell, x));
    assert_eq!(counts, [2, 2, 3]);
}

#[test]
fn the_law_does_not_decide_again_while_the_robot_advances_in_its_cell() {
    let mut guidance = counting();
    let mut count = |velocity: [f32; 2], n| {
        let mut told = told(Cell::new(5, 5), [0.0; 2], 1.0, n);
        told.0.scene.body.velocity_mps = Vec3::new(velocity[0], velocity[1], 0.0);
        ask(&mut guidance, &told).1
    };
    // North-east at more and at less than half of 1 m/s, then in another direction.
    assert_eq!([(0.5, 0), (0.5, 25), (0.3, 26), (0.3, 45)].map(|(v, n)| count([v, v], n)), [1, 1, 2, 2]);
    assert_eq!(count([-0.9, 0.1], 50), 3);
}

/// The slowest robot of a formation on rough land sets the pace of its leader.
#[test]
fn a_robot_that_goes_at_a_slower_pace_advances_too() {
    let decisions = |pace_mps: f32| {
        let mut guidance = counting();
        [0, 25, 50].map(|n| {
            let mut told = told(Cell::new(5, 5), [0.0; 2], 1.0, n);
            told.0.scene.body.velocity_mps = Vec3::new(0.2, 0.2, 0.0);
            let mut outgoing = Outgoing::default();
            let radio = Radio::new(told.0.now, VALID, &mut outgoing);
            let tools = Tools { rng: &mut Rng::new(1), radio, workspace: &mut () };
            let _ = guidance.decide_at(pace_mps, &told.0, &told.1, tools).expect("a decision");
            guidance.inside().decisions
        })
    };
    assert_eq!(decisions(1.0), [1, 2, 3]);
    assert_eq!(decisions(0.3), [1, 1, 1]);
    assert_eq!(decisions(0.6), [1, 2, 3], "less than half");
}

#[test]
fn the_robot_heads_for_the_centre_of_the_next_cell() {
    let mut guidance = counting();
    let (decision, _) = ask(&mut guidance, &told(Cell::new(5, 5), [0.5, -0.25], 9.0, 0));
    // North-east: 2 m along each axis, minus its offset.
    let (ahead, length) = ([1.5, 2.25], Vec2::new(1.5_f32, 2.25).norm());
    let (v, way_m) = motion(&decision);
    assert!((v.x - ahead[0] / length).abs() < 1e-6 && (v.y - ahead[1] / length).abs() < 1e-6);
    assert_eq!(way_m, None);
    let (beside, _) = ask(&mut guidance, &told(Cell::new(6, 5), [-0.75, -0.25], 9.0, 0));
    let (v, _) = motion(&beside);
    assert!((v.x / v.y - 0.75 / 2.25).abs() < 1e-6, "{v:?}");
    let near = told(Cell::new(5, 5), [0.03, 0.04], 9.0, 0);
    let (v, _) = motion(&decide(&mut CellFollower::new(Stays, 1.0), &near).unwrap());
    assert!((v.x + 0.3).abs() < 1e-6 && (v.y + 0.4).abs() < 1e-6, "{v:?}");
}

struct Stays;

impl Law<f32> for Stays {
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Grid;
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, f32, Grid>,
        _: &OnGrid<'_>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        Ok(Decision::default())
    }
}

#[test]
fn messages_orders_and_reports_are_forwarded() {
    let mut law = counting();
    let there = told(Cell::new(5, 5), [0.0; 2], 1.0, 0);
    assert_eq!(ask(&mut law, &there).1, 1);
    let patch = LandPatch::from_bytes(Cell::new(0, 0), [0; PATCH_TILES]);
    let receive = |law: &mut CellFollower<f32, Counting>, message| {
        let mut outgoing = Outgoing::default();
        law.receive(RobotId(2), &message, &mut Radio::new(there.0.now, VALID, &mut outgoing));
    };
    receive(&mut law, GridMessage::Land(patch));
    assert_eq!(ask(&mut law, &there).1, 1, "a patch changes no decision");
    receive(&mut law, GridMessage::Redirect);
    assert_eq!([ask(&mut law, &there).1, ask(&mut law, &there).1], [2, 2], "at once, and once");
    assert!(law.order(&GridOrder::Goal(Cell::new(1, 1))));
    assert!(!law.order(&GridOrder::FormationGoal(Cell::new(1, 1))));
    assert_eq!((law.inside().redirections, law.inside().orders), (1, 2));
    assert_eq!([76, 77].map(|id| law.needs(RobotId(id))), [false, true]);
    let shown = law.report();
    assert_eq!(shown.stopped_until, Some(tick(3)));
    // The target is that of the last decision.
    assert_eq!((shown.leader, shown.slot, shown.target), (RobotId(4), 3, Some(Cell::new(9, 5))));
}

#[test]
fn without_a_speed_or_a_cell_size_there_is_no_decision() {
    let at = |speed_mps| told(Cell::new(5, 5), [0.0; 2], speed_mps, 0);
    let mut flat = at(1.0);
    flat.1.in_cell.cell_m = 0.0;
    for told in [at(0.0), at(-1.0), at(f32::NAN), flat] {
        assert_eq!(decide(&mut counting(), &told), Err(BadInput));
    }
}

#[test]
fn a_robot_in_the_plane_moves_to_its_goal_cell() {
    let config = AgentConfig::new(RobotId(1), 0.2, STEP);
    let law = RouteGuidance::<CELLS, VISITS>::new(RouteParams::default());
    let law = CellFollower::new(law, 1.0);
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&config, law, Unguarded, Postcard);
    let (mut ws, mut at_m) = (workspace(), [11.0_f32, 11.0]);
    agent.order(&GridOrder::Goal(Cell::new(12, 8)));
    let mut cells = Vec::new();
    for n in 0..200 {
        let [x, y] = at_m.map(|x| (x / 2.0).floor());
        let cell = Cell::new(x as i16, y as i16);
        cells.push(cell);
        let inputs = Inputs {
            state: KinematicState::default(),
            surroundings: InCells {
                grid: inputs(&FLAT, cell, &[]).surroundings,
                plane: InPlane { max_speed_mps: 1.0, obstacles: &[] },
                in_cell: InCell { offset_m: Vec2::new(at_m[0] - 2.0 * x - 1.0, at_m[1] - 2.0 * y - 1.0), cell_m: 2.0 },
            },
            inbox: &[],
        };
        let now = Instant::from_micros(0) + STEP.saturating_mul(n);
        let Command::Velocity(v) = agent.step(&inputs, now, &mut ws).command else { panic!("it moves by velocities") };
        at_m = [at_m[0] + v.x * 0.1, at_m[1] + v.y * 0.1];
    }
    cells.dedup();
    assert_eq!(agent.mode(), Mode::Arrived);
    assert_eq!(cells.last(), Some(&Cell::new(12, 8)));
    assert!((8..=11).contains(&cells.len()), "{cells:?}");
    assert!(cells.windows(2).all(|pair| pair[0].chebyshev(pair[1]) == 1));
}
