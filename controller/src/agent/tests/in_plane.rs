//! Guidances of the grid on bodies that move in the plane.

use super::*;
use crate::geom::Vec2;
use crate::wire::RequestKind::Redirect;

const STEP: Duration = Duration::from_millis(100);

/// Wishes to go north-east, and counts how often it is asked.
#[derive(Default)]
struct Counting {
    decisions: u32,
    redirections: u32,
    parts: u32,
}

impl Guidance<f32> for Counting {
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<f32>, BadInput> {
        self.decisions += 1;
        let ask = Ask {
            to: RobotId(9),
            kind: Redirect,
        };
        Ok(Guided {
            moves: [Dir::NorthEast, Dir::South].into_iter().collect(),
            target: view.goal,
            leader: RobotId(4),
            slot: 3,
            asks: [ask].into_iter().collect(),
            ..Guided::default()
        })
    }

    fn goes_to_cells(&self) -> bool {
        true
    }

    fn redirect(&mut self) {
        self.redirections += 1;
    }

    fn assign_template(&mut self, _: &TemplateAssignment, is_anew: bool) -> bool {
        self.parts += 1;
        is_anew
    }

    fn goal_offset(&self) -> Cell {
        Cell::new(-3, 2)
    }

    fn needs(&self, id: RobotId) -> bool {
        id == RobotId(77)
    }
}

/// Looks like what it is: a body in a cell of 2 m, somewhat off its centre.
fn view(cell: Cell, offset_m: [f32; 2], max_speed_mps: f32, n: i32) -> View<'static, f32> {
    View {
        id: RobotId(1),
        now: Instant::from_micros(0) + STEP.saturating_mul(n),
        tick: STEP,
        pose: Pose::default(),
        cell: Some(CellState {
            cell,
            busy: Duration::ZERO,
        }),
        window: None,
        goal: Cell::new(9, 5),
        body: Body {
            id: RobotId(1),
            velocity_mps: Vec3::ZERO,
            radius_m: 0.2,
            max_speed_mps,
            max_acceleration_mps2: f32::MAX,
            step_s: 0.1,
        },
        nearby: &[],
        obstacles: &[],
        in_cell: Some(InCell {
            offset_m: Vec2::new(offset_m[0], offset_m[1]),
            cell_m: 2.0,
        }),
        neighbors: &[],
        ages: config(1).ages,
    }
}

fn counting() -> InPlane<f32, Counting> {
    InPlane::new(Counting::default(), 1.0)
}

/// What it wishes, and how often the guidance inside has been asked by then.
fn ask(guidance: &mut InPlane<f32, Counting>, view: &View<'_, f32>) -> (Guided<f32>, u32) {
    let guided = guidance.decide(view, &mut Rng::new(1), &mut ());
    (guided.expect("a decision"), guidance.inside().decisions)
}

#[test]
fn it_decides_anew_in_another_cell_or_after_the_time_to_cross_one() {
    let mut guidance = counting();
    let mut count = |cell, n| ask(&mut guidance, &view(cell, [0.0; 2], 1.0, n)).1;
    let (here, there) = (Cell::new(5, 5), Cell::new(6, 5));
    // 2 m at 1 m/s are 20 steps.
    assert_eq!([0, 1, 19].map(|n| count(here, n)), [1, 1, 1]);
    assert_eq!([20, 39, 40].map(|n| count(here, n)), [2, 2, 3]);
    assert_eq!([41, 42].map(|n| count(there, n)), [4, 4]);
    assert_eq!(count(here, 43), 5);
    assert_eq!(count(here, 42), 6, "the clock went back");
}

#[test]
fn on_rough_land_it_decides_less_often() {
    let mut guidance = counting();
    let mut count = |n| ask(&mut guidance, &view(Cell::new(5, 5), [0.0; 2], 0.25, n)).1;
    assert_eq!([0, 79, 80].map(&mut count), [1, 1, 2]);
}

#[test]
fn it_asks_others_once_for_each_decision() {
    let mut guidance = counting();
    let mut asks = |n| {
        let view = view(Cell::new(5, 5), [0.0; 2], 1.0, n);
        let (guided, _) = ask(&mut guidance, &view);
        assert_eq!((guided.leader, guided.slot), (RobotId(4), 3));
        guided.asks.len()
    };
    assert_eq!([0, 1, 19, 20].map(&mut asks), [1, 0, 0, 1]);
}

#[test]
fn it_goes_to_the_centre_of_the_next_cell_and_knows_its_whole_way() {
    let mut guidance = counting();
    let (guided, _) = ask(&mut guidance, &view(Cell::new(5, 5), [0.5, -0.25], 9.0, 0));
    // North-east: 2 m each way, less what it is off.
    let (ahead, length) = ([1.5, 2.25], Vec2::new(1.5_f32, 2.25).norm());
    let v = guided.velocity_mps;
    assert!((v.x - ahead[0] / length).abs() < 1e-6 && (v.y - ahead[1] / length).abs() < 1e-6);
    // Four cells to the east.
    assert_eq!(guided.way_m, Some(Vec3::new(7.5, 0.25, 0.0)));
    // The centre is reached, not passed.
    let (guided, _) = ask(
        &mut guidance,
        &view(Cell::new(6, 6), [-1.97, -1.96], 9.0, 1),
    );
    let _ = guided;
    let near = Guided {
        moves: heapless::Vec::new(),
        ..Guided::default()
    };
    let mut stays = InPlane::new(Stays(near), 1.0);
    let view = view(Cell::new(5, 5), [0.03, 0.04], 9.0, 0);
    let guided = stays.decide(&view, &mut Rng::new(1), &mut ()).unwrap();
    let v = guided.velocity_mps;
    assert!(
        (v.x + 0.3).abs() < 1e-6 && (v.y + 0.4).abs() < 1e-6,
        "{v:?}"
    );
}

/// Always decides the same.
struct Stays(Guided<f32>);

impl Guidance<f32> for Stays {
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, f32>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<f32>, BadInput> {
        Ok(self.0.clone())
    }
}

#[test]
fn it_passes_on_what_it_is_told() {
    let mut guidance = counting();
    let there = view(Cell::new(5, 5), [0.0; 2], 1.0, 0);
    assert_eq!(ask(&mut guidance, &there).1, 1);
    guidance.redirect();
    assert_eq!(ask(&mut guidance, &there).1, 2, "at once");
    let part = TemplateAssignment::split(RobotId(1), 1, 0, Cell::new(0, 0), &[]);
    let part = part.unwrap().next().unwrap();
    assert!(guidance.assign_template(&part, true));
    assert!(!guidance.assign_template(&part, false));
    let inside = guidance.inside();
    assert_eq!((inside.redirections, inside.parts), (1, 2));
    assert_eq!(guidance.goal_offset(), Cell::new(-3, 2));
    assert_eq!(
        [76, 77].map(|id| guidance.needs(RobotId(id))),
        [false, true]
    );
    assert!(!guidance.has_own_goal());
    assert!(!guidance.assign_place(0, &Place::fixed(crate::geom::Position::ORIGIN)));
}

#[test]
fn without_a_cell_or_without_speed_it_cannot_decide() {
    let good = view(Cell::new(5, 5), [0.0; 2], 1.0, 0);
    let mut stuck = good;
    stuck.body.max_speed_mps = 0.0;
    let mut backwards = good;
    backwards.body.max_speed_mps = -1.0;
    let mut dizzy = good;
    dizzy.body.max_speed_mps = f32::NAN;
    let off_the_map = View { cell: None, ..good };
    let nowhere = View {
        in_cell: None,
        ..good
    };
    for view in [stuck, backwards, dizzy, off_the_map, nowhere] {
        let guided = counting().decide(&view, &mut Rng::new(1), &mut ());
        assert_eq!(guided, Err(BadInput));
    }
}

/// A robot by the grid's routing on flat land of cells of 2 m, from cell to cell to its goal.
#[test]
fn it_walks_to_the_cell_of_its_goal() {
    let config = AgentConfig {
        radius_m: 0.2,
        ..AgentConfig::new(RobotId(1), 1, STEP)
    };
    let guidance = RouteGuidance::<CELLS, VISITS>::new(RouteParams::default());
    let guidance = InPlane::new(guidance, 1.0);
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&config, guidance);
    let (mut ws, mut at_m) = (workspace(), [11.0_f32, 11.0]);
    agent.assign_goal(Cell::new(12, 8));
    let mut cells = Vec::new();
    for n in 0..200 {
        let [x, y] = at_m.map(|x| (x / 2.0).floor());
        let cell = Cell::new(x as i16, y as i16);
        cells.push(cell);
        let inputs = Inputs {
            surroundings: Some(Surroundings {
                max_speed_mps: 1.0,
                obstacles: &[],
                in_cell: Some(InCell {
                    offset_m: Vec2::new(at_m[0] - 2.0 * x - 1.0, at_m[1] - 2.0 * y - 1.0),
                    cell_m: 2.0,
                }),
            }),
            ..inputs(&FLAT, cell, &[])
        };
        let now = Instant::from_micros(0) + STEP.saturating_mul(n);
        let Command::Velocity(v) = agent.step(&inputs, now, &mut ws).command else {
            panic!("it moves by velocities")
        };
        at_m = [at_m[0] + v.x * 0.1, at_m[1] + v.y * 0.1];
    }
    cells.dedup();
    assert_eq!(agent.mode(), Mode::Arrived);
    // Seven cells, three of them aslant; a corner may be cut on the way.
    assert_eq!(cells.last(), Some(&Cell::new(12, 8)));
    assert!((8..=11).contains(&cells.len()), "{cells:?}");
    assert!(cells.windows(2).all(|pair| pair[0].chebyshev(pair[1]) == 1));
}
