//! Tests of robots on the grid with maps beyond their windows: shared, or known before the mission.

use super::*;
use crate::agent::{CELLS, FarMap, GridWorkspace, KnownMap, MAP_TILES, OnGrid, RouteGuidance, SharedMap, VISITS};
use crate::grid::UNIT;
use crate::grid::{BLOCKED, Window};
use crate::land::cost_to_go::Header as Table;
use crate::land::{CostToGo, LandPatch, MapParams, PATCH_TILES, Tile, tile_of};
use crate::route::RouteParams;
use crate::wire::{Broadcast, Header, Message, encode};
use heapless::Vec;

type Planner<H> = Agent<f32, RouteGuidance<CELLS, VISITS, 0, H>, NEIGHBORS>;
type Sharer = Planner<SharedMap<MAP_TILES>>;

const TICK: Duration = Duration::from_millis(1000);

fn sharer(id: u32) -> Sharer {
    let config = AgentConfig::new(RobotId(id), 0.0, TICK);
    let law = RouteGuidance::with_map(RouteParams::default(), SharedMap::new(MapParams::default()));
    Agent::new(&config, law, Unguarded, Postcard)
}

fn said(patch: LandPatch) -> Message {
    let (protocol, content) = GridMessage::Land(patch).encode(Grid::ID).unwrap();
    Message::Broadcast(Broadcast { protocol, content })
}

fn step<H: FarMap>(
    agent: &mut Planner<H>,
    land: &dyn Fn(Cell) -> u8,
    cell: Cell,
    now: Instant,
    inbox: &[u8],
) -> (Cell, Vec<u8, OUTBOX>) {
    let origin = cell - Cell::new(5, 5);
    let cells: std::vec::Vec<u8> =
        (0..11).flat_map(|y| (0..11).map(move |x| (x, y))).map(|(x, y)| land(origin + Cell::new(x, y))).collect();
    let inputs = Inputs {
        state: KinematicState::default(),
        surroundings: OnGrid {
            cell: CellState { cell, busy: Duration::ZERO },
            window: Window::new(&cells, origin, 11, 11),
        },
        inbox,
    };
    let out = agent.step(&inputs, now, &mut GridWorkspace::new());
    let to = match &out.command {
        Command::Move(moves) => cell + moves[0].offset(),
        _ => cell,
    };
    (to, out.outbox)
}

#[test]
fn a_map_patch_follows_each_beacon_and_is_stored_by_receivers() {
    let (mut one, mut two) = (sharer(1), sharer(2));
    one.order(&GridOrder::Goal(Cell::new(50, 5)));
    two.order(&GridOrder::Goal(Cell::new(50, 5)));
    let mut now = Instant::from_micros(0);
    let mut said = Vec::<u8, OUTBOX>::new();
    for _ in 0..6 {
        (_, said) = step(&mut one, &|_| 4, Cell::new(5, 5), now, &[]);
        let _ = step(&mut two, &|_| 1, Cell::new(-40, 5), now, &said);
        now = now + TICK;
    }
    let messages = crate::wire::frames(&said).map(|frame| crate::wire::decode(frame).unwrap().message);
    let kinds: std::vec::Vec<bool> = messages.map(|message| matches!(message, Message::Broadcast(_))).collect();
    assert_eq!(kinds, [false, true]);
    let known = two.law().map().inside().get(tile_of(Cell::new(5, 5)));
    assert_eq!(known.ticks_16(), Some(64));
}

/// While `liar` sends in each tick; `None` if the goal is not reached.
fn moves_among_lies(liar: &dyn Fn(Cell) -> [LandPatch; 3]) -> Option<u32> {
    let land = |cell: Cell| if cell.x == 20 && (-6..7).contains(&cell.y) { BLOCKED } else { 2 };
    let goal = Cell::new(40, 0);
    let mut robot = sharer(1);
    robot.order(&GridOrder::Goal(goal));
    let (mut cell, mut now) = (Cell::new(0, 0), Instant::from_micros(0));
    let mut sequence = 0;
    for moves in 0..1000 {
        let mut inbox = Vec::<u8, OUTBOX>::new();
        for patch in liar(cell) {
            let header = Header { boot: 1, sender: RobotId(9), sequence };
            sequence += 1;
            encode(header, &said(patch), &mut inbox).unwrap();
        }
        (cell, _) = step(&mut robot, &land, cell, now, &inbox);
        now = now + TICK;
        if cell == goal {
            return Some(moves);
        }
    }
    None
}

#[test]
fn false_maps_cost_time_but_do_not_trap_a_robot() {
    let nothing = LandPatch { corner: Cell::new(0, 0), tiles: [Tile::UNKNOWN; PATCH_TILES] };
    let honest = moves_among_lies(&|_| [nothing; 3]).expect("arrives");
    // The highest cost for all terrain around the robot, as if just seen.
    let wall = |corner| LandPatch { corner, tiles: [Tile::new(u16::MAX); PATCH_TILES] };
    let among = moves_among_lies(&|cell| {
        let at = tile_of(cell);
        [Cell::new(-4, -6), Cell::new(-4, -2), Cell::new(-4, 2)].map(|corner| wall(at + corner))
    });
    // The highest cost for all terrain ahead, and the lowest for the terrain behind.
    let lure = moves_among_lies(&|cell| {
        let at = tile_of(cell);
        let behind = LandPatch { tiles: [Tile::new(0); PATCH_TILES], ..wall(at + Cell::new(-9, -2)) };
        [wall(at + Cell::new(1, -4)), wall(at + Cell::new(1, 0)), behind]
    });
    for lied in [among, lure] {
        assert!(lied.is_some_and(|moves| moves < 12 * honest), "{lied:?} moves instead of {honest}");
    }
}

const SIDE: i16 = 41;
const GOAL: Cell = Cell::new(30, 20);

/// A bay that is open to the west, deeper than the view.
const fn bay(cell: Cell) -> u8 {
    match (cell.x, cell.y) {
        (5..=20, 8 | 32) | (20, 8..=32) => BLOCKED,
        (0..SIDE, 0..SIDE) => 1,
        _ => BLOCKED,
    }
}

/// Moves from each cell to the goal, by rounds over all cells.
fn moves_to_goal() -> std::vec::Vec<u16> {
    let at = |cell: Cell| (cell.y * SIDE + cell.x) as usize;
    let cells = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| Cell::new(x, y)));
    let mut moves = std::vec![999; at(Cell::new(0, SIDE))];
    moves[at(GOAL)] = 0;
    for _ in 0..100 {
        for cell in cells().filter(|&cell| bay(cell) != BLOCKED && cell != GOAL) {
            let axes = [Cell::new(1, 0), Cell::new(-1, 0), Cell::new(0, 1), Cell::new(0, -1)];
            let beside = axes.map(|way| cell + way).into_iter().filter(|&next| bay(next) != BLOCKED);
            moves[at(cell)] = beside.map(|next| moves[at(next)] + 1).min().unwrap();
        }
    }
    moves
}

/// Moves to `goal` out of the bay, by a table for [`GOAL`] with these ticks to go in each cell.
fn moves_by_table(goal: Cell, ticks_to_go: impl Fn(i16, i16) -> u16) -> Option<u32> {
    let (nodes, cells) = ([SIDE as u8; 2], [SIDE as u16; 2]);
    let header = Table { nodes, cells, origin: Cell::new(0, 0), goal: GOAL, unit: 256 * UNIT };
    let mut bytes = std::vec![0; header.length()];
    header.write(&mut bytes, |x, y| ticks_to_go(x.into(), y.into())).expect("in range");
    let map = KnownMap::new(CostToGo::from_bytes(&bytes[..]).expect("sound"));
    let config = AgentConfig::new(RobotId(1), 0.0, TICK);
    let mut robot = Agent::new(&config, RouteGuidance::with_map(RouteParams::default(), map), Unguarded, Postcard);
    robot.order(&GridOrder::Goal(goal));
    let (mut cell, mut now) = (Cell::new(18, 20), Instant::from_micros(0));
    for moves in 0..2000 {
        if cell == goal {
            return Some(moves);
        }
        (cell, _) = step(&mut robot, &bay, cell, now, &[]);
        now = now + TICK;
    }
    None
}

#[test]
fn a_known_map_leads_out_of_a_bay_that_is_deeper_than_the_view() {
    let moves = moves_to_goal();
    let table = |x: i16, y: i16| moves[(y * SIDE + x) as usize];
    let by_table = moves_by_table(GOAL, table).expect("arrives");
    assert!(by_table <= 52, "{by_table} moves");
    // Another goal has no table: the robot follows the wall.
    let alone = moves_by_table(GOAL + Cell::new(0, 1), table).expect("arrives");
    assert!(alone > by_table + 20, "{alone} moves, {by_table} by the table");
}

#[test]
fn a_wrong_table_costs_time_but_does_not_trap_a_robot() {
    for (name, moves) in [
        ("level", moves_by_table(GOAL, |_, _| 7)),
        ("a pit in the bay", moves_by_table(GOAL, |x, y| 100 + (x - 12).abs().max((y - 20).abs()).cast_unsigned())),
        ("a lure to the east", moves_by_table(GOAL, |x, _| 500 - x.cast_unsigned())),
    ] {
        assert!(moves.is_some_and(|moves| moves < 500), "{name}: {moves:?} moves");
    }
}
