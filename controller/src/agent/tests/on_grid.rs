//! Tests of robots as laws on the grid know them, and of the payload that says it.

use super::*;
use crate::geom::{Position, Vec2};
use crate::neighbor::Neighbor;
use crate::wire::MAX_PAYLOAD;

const CENTER: [i32; 3] = [10_000, -4_000, 700];

fn frame() -> CellFrame {
    CellFrame { cell: Cell::new(5, -2), center: Position::from_mm(CENTER), cell_mm: 2_000 }
}

fn cell_at(frame: &CellFrame, [x, y]: [i32; 2]) -> Cell {
    frame.cell_at(Position::from_mm([CENTER[0].wrapping_add(x), CENTER[1].wrapping_add(y), -99]))
}

#[test]
fn a_place_on_a_border_belongs_to_the_cell_in_the_north_east() {
    let offset = |x, y| cell_at(&frame(), [x, y]) - Cell::new(5, -2);
    assert_eq!(offset(0, 0), Cell::new(0, 0));
    for (mm, cells) in [
        (-3_001, -2),
        (-3_000, -1),
        (-1_001, -1),
        (-1_000, 0),
        (999, 0),
        (1_000, 1),
        (2_999, 1),
        (3_000, 2),
        (200_000, 100),
    ] {
        assert_eq!((offset(mm, 0), offset(0, mm)), (Cell::new(cells, 0), Cell::new(0, cells)), "{mm} mm");
    }
}

#[test]
fn an_odd_side_and_negative_cells_are_exact() {
    let frame = CellFrame { cell: Cell::new(-7, -7), cell_mm: 5, ..frame() };
    for (mm, cells) in [(-8, -2), (-7, -1), (-3, -1), (-2, 0), (2, 0), (3, 1), (7, 1), (8, 2)] {
        assert_eq!(cell_at(&frame, [mm, -mm]), Cell::new(-7 + cells, -7 - cells), "{mm} mm");
    }
    let tiny = CellFrame { cell: Cell::new(0, 0), cell_mm: 1, ..frame };
    for mm in [-3, -1, 0, 1, 3] {
        assert_eq!(cell_at(&tiny, [mm, 0]), Cell::new(mm as i16, 0));
    }
}

#[test]
fn cells_saturate_far_away() {
    let whole = |x, y| CellFrame { cell: Cell::new(0, 0), center: Position::from_mm([x, y, 0]), cell_mm: 1 };
    let at = |frame: CellFrame, x, y| frame.cell_at(Position::from_mm([x, y, 0]));
    assert_eq!(at(whole(0, 0), i32::MAX, i32::MIN), Cell::new(i16::MAX, i16::MIN));
    assert_eq!(at(whole(i32::MIN, i32::MAX), i32::MAX, i32::MIN), Cell::new(i16::MAX, i16::MIN));
    let edge = CellFrame { cell: Cell::new(i16::MAX, i16::MIN), ..whole(0, 0) };
    assert_eq!(at(edge, 5, -5), Cell::new(i16::MAX, i16::MIN));
    assert_eq!(at(edge, -5, 5), Cell::new(i16::MAX - 5, i16::MIN + 5));
    assert_eq!(at(CellFrame { cell_mm: i32::MAX, ..whole(0, 0) }, i32::MAX, i32::MIN), Cell::new(1, -1));
    // The side is above 0; other values do not panic.
    for cell_mm in [0, -1, i32::MIN] {
        let _ = at(CellFrame { cell_mm, ..whole(0, 0) }, i32::MAX, i32::MIN);
    }
}

#[test]
fn the_frame_follows_from_the_place_in_a_cell() {
    let grid = inputs(&FLAT, Cell::new(5, -2), &[]).surroundings;
    let plane = InPlane { max_speed_mps: 1.0_f32, obstacles: &[] };
    let in_cell = InCell { offset_m: Vec2::new(0.25, -0.5), cell_m: 2.0 };
    let own = Position::from_mm([CENTER[0] + 250, CENTER[1] - 500, CENTER[2]]);
    let cells = InCells { grid, plane, in_cell };
    assert_eq!(cells.cell_frame(own), Some(frame()));
    assert_eq!(AnySurroundings::InCells(cells).cell_frame(own), Some(frame()));
    for cell_m in [0.0, -2.0, f32::NAN, 0.0004] {
        assert_eq!(InCells { in_cell: InCell { cell_m, ..in_cell }, ..cells }.cell_frame(own), None, "{cell_m}");
    }
    let on_grid: [AnySurroundings<'_, f32>; 2] = [grid.into(), plane.into()];
    assert_eq!(on_grid.map(|here| here.cell_frame(own)), [None, None]);
}

/// Notes the robots that it knows on the grid.
#[derive(Default)]
struct Watcher(Vec<GridNeighbor>);

impl Law<f32> for Watcher {
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Grid;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Grid>,
        _: &OnGrid<'_>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        self.0 = view.on_grid().collect();
        for robot in &self.0 {
            assert_eq!(view.grid_neighbor(robot.id), Some(*robot));
        }
        let unknown = view.neighbors().filter(|other| view.grid_neighbor(other.id).is_none()).count();
        assert_eq!(unknown + self.0.len(), view.neighbors().count());
        Ok(Decision::default())
    }
}

/// A peer in cell (9, 9) that stands in (5, -3) by its position, and a robot of another protocol
/// in cell (6, -4).
fn others() -> Vec<u8> {
    let at = |x_mm, y_mm| [CENTER[0] + x_mm, CENTER[1] + y_mm, 0];
    let payload = GridPayload {
        cell: Cell::new(9, 9),
        target: Cell::new(8, 8),
        busy_ms: 1_500,
        heading: Dir::SouthWest,
        slot: 3,
        leader: RobotId(1),
    };
    let peer = Beacon { position_mm: at(0, -2_000), ..on_grid(payload) };
    let place = Beacon { position_mm: at(2_999, -3_001), velocity_mmps: [1_000, 0, 0], ..Beacon::default() };
    let stranger = Beacon { mode: Mode::Arrived, protocol: Waypoints::ID, ..place };
    [bytes(2, 0, 0, &[Message::Beacon(peer)]), bytes(3, 0, 0, &[Message::Beacon(stranger)])].concat()
}

fn peer(heard: Instant) -> GridNeighbor {
    GridNeighbor {
        id: RobotId(2),
        heard,
        busy_until: heard + Duration::from_millis(1_500),
        cell: Cell::new(9, 9),
        target: Cell::new(8, 8),
        leader: RobotId(1),
        heading: Dir::SouthWest,
        slot: 3,
        mode: Mode::Cruise,
        is_peer: true,
    }
}

#[test]
fn in_the_plane_strangers_are_in_the_cells_of_their_positions() {
    let law = CellFollower::new(Watcher::default(), 1.0);
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&config(1), law, Unguarded, Postcard);
    let inbox = others();
    let surroundings = InCells {
        grid: inputs(&FLAT, Cell::new(5, -2), &[]).surroundings,
        plane: InPlane { max_speed_mps: 1.0, obstacles: &[] },
        in_cell: InCell { offset_m: Vec2::new(0.25, -0.5), cell_m: 2.0 },
    };
    let position = Position::from_mm([CENTER[0] + 250, CENTER[1] - 500, CENTER[2]]);
    let state = KinematicState { position, ..KinematicState::default() };
    let _ = agent.step(&Inputs { state, surroundings, inbox: &inbox }, tick(1), &mut ());
    let stranger = GridNeighbor {
        id: RobotId(3),
        heard: tick(1),
        busy_until: tick(1),
        cell: Cell::new(6, -4),
        target: Cell::new(6, -4),
        leader: RobotId::NONE,
        heading: Dir::Stay,
        slot: 0,
        mode: Mode::Arrived,
        is_peer: false,
    };
    assert_eq!(agent.law().inside().0, [peer(tick(1)), stranger]);
}

#[test]
fn on_the_grid_strangers_are_left_out() {
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&config(1), Watcher::default(), Unguarded, Postcard);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, -2), &others()), tick(1), &mut ());
    assert_eq!(agent.law().0, [peer(tick(1))]);
    assert_eq!(agent.neighbors().len(), 2);
    let told: Vec<_> = agent.neighbors().iter().filter_map(GridNeighbor::told).collect();
    assert_eq!(told, agent.law().0);
}

/// A robot with a stranger in the way goes round it, and does not ask it to redirect.
#[test]
fn a_stranger_in_the_way_is_avoided_and_not_asked() {
    type Follower = Agent<f32, CellFollower<f32, RouteGuidance<CELLS, VISITS>>, NEIGHBORS>;
    let law = CellFollower::new(RouteGuidance::new(RouteParams::default()), 1.0);
    let mut agent = Follower::new(&config(1), law, Unguarded, Postcard);
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut ws = workspace();
    let mut cells = [BLOCKED; 121];
    cells[55..66].fill(1);
    let mut goes = |agent: &mut Follower, cells: &[u8], n: u16, has_payload: bool| {
        let beacon =
            Beacon { position_mm: [2_000, 0, 0], ..if has_payload { beacon_at(6, 5) } else { Beacon::default() } };
        let inbox = bytes(2, 0, n, &[Message::Beacon(beacon)]);
        let surroundings = InCells {
            grid: inputs(cells, Cell::new(5, 5), &[]).surroundings,
            plane: InPlane { max_speed_mps: 1.0, obstacles: &[] },
            in_cell: InCell { offset_m: Vec2::ZERO, cell_m: 2.0 },
        };
        let inputs = Inputs { state: KinematicState::default(), surroundings, inbox: &inbox };
        // Each step is a decision: crossing a cell takes two ticks.
        let out = agent.step(&inputs, tick(2 * u32::from(n)), &mut *ws);
        let Command::Velocity(velocity_mps) = out.command else { panic!("{:?}", out.command) };
        (velocity_mps, asked(&out))
    };
    let (round, _) = goes(&mut agent, &FLAT, 0, false);
    assert!(round.y != 0.0, "{round:?}");
    for n in 1..20 {
        assert_eq!(goes(&mut agent, &cells, n, false).1, [], "step {n}");
    }
    let said: Vec<_> = (20..30).flat_map(|n| goes(&mut agent, &cells, n, true).1).collect();
    assert!(said.contains(&(RobotId(2), GridMessage::Redirect)), "{said:?}");
}

const PAYLOAD: GridPayload = GridPayload {
    cell: Cell::new(3, -2),
    target: Cell::new(98, 98),
    busy_ms: 400,
    heading: Dir::NorthWest,
    slot: 4,
    leader: RobotId(1),
};

#[test]
fn the_payload_has_the_golden_bytes_and_fits_with_a_leader_below_2_to_the_28() {
    let (id, bytes) = PAYLOAD.encode::<MAX_PAYLOAD>(Grid::ID).unwrap();
    let golden = [3, 0, 0xFE, 0xFF, 98, 0, 98, 0, 0x90, 0x01, 3, 4, 1];
    assert_eq!((id, &bytes[..]), (ProtocolId(1), &golden[..]));
    assert_eq!(GridPayload::decode(Grid::ID, id, &bytes), Some(PAYLOAD));
    for (leader, len) in [((1 << 21) - 1, 15), ((1 << 28) - 1, 16)] {
        let payload = GridPayload { leader: RobotId(leader), ..PAYLOAD };
        let (id, bytes) = payload.encode::<MAX_PAYLOAD>(Grid::ID).unwrap();
        assert_eq!((bytes.len(), GridPayload::decode(Grid::ID, id, &bytes)), (len, Some(payload)));
    }
}

#[test]
fn a_leader_with_a_larger_number_is_not_told() {
    let here = OnGrid { cell: CellState::default(), window: None };
    for (leader, told) in [((1 << 28) - 1, (1 << 28) - 1), (1 << 28, 0), (u32::MAX, 0)] {
        let mut task = GridTask::NEW;
        task.shown.leader = RobotId(leader);
        let payload = task.payload(&here, Dir::Stay);
        assert_eq!(payload.leader, RobotId(told));
        assert!(payload.encode::<MAX_PAYLOAD>(Grid::ID).is_some());
    }
}

#[test]
fn a_robot_is_busy_from_the_time_its_beacon_was_sent_also_across_a_wrap() {
    let beacon = on_grid(GridPayload { busy_ms: u16::MAX, ..PAYLOAD });
    let heard = Instant::from_micros(u32::MAX);
    let robot = Neighbor::<f32, GridPayload>::from_beacon(RobotId(5), &beacon, Grid::ID, heard);
    let known = GridNeighbor::told(&robot).unwrap();
    assert_eq!((known.heard, known.busy_until), (heard, Instant::from_micros(65_534_999)));
    assert_eq!((known.cell, known.target, known.heading), (PAYLOAD.cell, PAYLOAD.target, PAYLOAD.heading));
    let silent = Beacon { payload: heapless::Vec::new(), ..beacon };
    let robot = Neighbor::<f32, GridPayload>::from_beacon(RobotId(5), &silent, Grid::ID, heard);
    assert_eq!(GridNeighbor::told(&robot), None);
}

#[test]
fn a_beacon_tells_cell_target_and_the_time_to_cross_the_cell() {
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    agent.order(&GridOrder::FormationGoal(Cell::new(60, 5)));
    let leader = bytes(1, 0, 0, &[Message::Beacon(beacon_at(8, 5))]);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &leader), tick(0), &mut ws);
    let busy = [(Duration::from_millis(1_410), 1_410), (Duration::MAX, u16::MAX), (Duration::ZERO, 0)];
    for ((busy, busy_ms), n) in busy.into_iter().zip(1..) {
        let mut inputs = inputs(&FLAT, Cell::new(6, 5), &[]);
        inputs.surroundings.cell.busy = busy;
        let out = agent.step(&inputs, tick(n), &mut ws);
        let [Frame { message: Message::Beacon(beacon), .. }] = &sent(&out)[..] else { panic!("a beacon") };
        let told = payload_of(beacon);
        assert_eq!((told.cell, told.busy_ms, told.leader, told.slot), (Cell::new(6, 5), busy_ms, RobotId(1), 1));
        assert_eq!(told.target, Cell::new(57, 5));
    }
}
