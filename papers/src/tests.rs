//! Tests of KUZ algorithm 2: a column of three on flat terrain, robot 1 in front.

use crate::PublishedFormation;
use crate::criteria::PublishedParams;
use staya_controller::agent::*;
use staya_controller::grid::{Cell, Dir, UNIT, Window};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::route::RouteParams;
use staya_controller::template::Template;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Addressed, Beacon, Content, Header, Message, Postcard, decode, encode, frames};
use std::vec;
use std::vec::Vec;

type Law = PublishedFormation<CELLS, VISITS, TEMPLATE>;
type Published = Agent<f32, Law, NEIGHBORS>;

const TICK: Duration = Duration::from_millis(1000);

/// Lost above four cells in total, kept again within one.
fn agent(id: u32) -> Published {
    let places: Vec<Cell> = (0..3).map(|i| Cell::new(-3 * i, 0)).collect();
    let template = Template::from_graph(&places, &[(0, 1), (1, 2)], id as usize - 1, 1).unwrap();
    let params = PublishedParams { halt: 4 * UNIT as u16, resume: UNIT as u16, ..PublishedParams::default() };
    let config = AgentConfig { seed: 1, ..AgentConfig::new(RobotId(id), 0.0, TICK) };
    let mut agent = Published::new(&config, Law::new(RouteParams::default(), params, template), Unguarded, Postcard);
    agent.order(&GridOrder::Goal(Cell::new(100 - 3 * (id as i16 - 1), 50)));
    agent
}

fn cell(id: u32, off: i16) -> Cell {
    Cell::new(50 - 3 * (id as i16 - 1) + off, 50)
}

/// `off` cells east of its place.
fn at(id: u32, off: i16, leader: u32) -> Beacon {
    let payload = GridPayload {
        cell: cell(id, off),
        target: Cell::new(90, 50),
        leader: RobotId(leader),
        heading: Dir::East,
        ..GridPayload::default()
    };
    let (protocol, payload) = payload.encode(Grid::ID).unwrap();
    Beacon { mode: Mode::Cruise, protocol, payload, ..Beacon::default() }
}

/// From robot 3 to robot 2.
fn asking(message: &GridMessage) -> (u32, Message) {
    let (protocol, content) = message.encode(Grid::ID).unwrap();
    (3, Message::Law(Addressed { to: RobotId(2), number: 0, protocol, content }))
}

struct Told {
    moves: Vec<Dir>,
    asks: Vec<(u32, GridMessage)>,
    mode: Mode,
}

fn step(agent: &mut Published, n: u16, id: u32, off: i16, heard: &[(u32, Message)]) -> Told {
    let mut inbox = heapless::Vec::<u8, 512>::new();
    for (sequence, (sender, message)) in (10 * n..).zip(heard) {
        encode(Header { boot: 0, sender: RobotId(*sender), sequence }, message, &mut inbox).unwrap();
    }
    let here = cell(id, off);
    let inputs = Inputs {
        state: KinematicState::default(),
        surroundings: OnGrid {
            cell: CellState { cell: here, busy: Duration::ZERO },
            window: Window::new(&[1; 121], here - Cell::new(5, 5), 11, 11),
        },
        inbox: &inbox,
    };
    let now = Instant::from_micros(0) + TICK.saturating_mul(n.into());
    let out = agent.step(&inputs, now, &mut GridWorkspace::new());
    let asks = frames(&out.outbox).filter_map(|frame| match decode(frame).unwrap().message {
        Message::Law(Addressed { to, protocol, content, .. }) => {
            Some((to.0, GridMessage::decode(Grid::ID, protocol, &content).unwrap()))
        }
        _ => None,
    });
    let moves = match &out.command {
        Command::Move(moves) => moves.to_vec(),
        Command::Hold | Command::Velocity(_) => Vec::new(),
    };
    Told { moves, asks: asks.collect(), mode: agent.mode() }
}

fn stop(origin: u32) -> GridMessage {
    // The default for a tick of 1 s.
    GridMessage::Stop { origin: RobotId(origin), valid_ms: 12_000 }
}

fn hears(beacons: &[(u32, Beacon)]) -> Vec<(u32, Message)> {
    beacons.iter().map(|(id, beacon)| (*id, Message::Beacon(beacon.clone()))).collect()
}

#[test]
fn a_robot_in_its_place_takes_its_shortest_route_and_sends_no_messages() {
    let mut two = agent(2);
    let told = step(&mut two, 0, 2, 0, &hears(&[(1, at(1, 0, 0)), (3, at(3, 0, 2))]));
    assert_eq!((told.moves[0], told.mode), (Dir::East, Mode::Cruise));
    assert!(told.asks.is_empty(), "{:?}", told.asks);
    assert_eq!(two.leader(), RobotId(1));
}

#[test]
fn the_leader_found_first_stays_the_leader() {
    let mut three = agent(3);
    let _ = step(&mut three, 0, 3, 0, &[]);
    assert_eq!(three.leader(), RobotId::NONE, "no robot was heard yet");
    let _ = step(&mut three, 1, 3, 0, &hears(&[(2, at(2, 0, 1))]));
    assert_eq!(three.leader(), RobotId(2));
    // Outside eps it is not found, but line 4 chooses the leader only at t = 0.
    let _ = step(&mut three, 2, 3, 0, &hears(&[(2, at(2, 20, 1))]));
    assert_eq!(three.leader(), RobotId(2));
}

#[test]
fn a_robot_too_far_behind_requests_a_stop_and_heads_for_its_place() {
    let mut three = agent(3);
    let _ = step(&mut three, 0, 3, 0, &hears(&[(2, at(2, 0, 1))]));
    let told = step(&mut three, 1, 3, 0, &hears(&[(2, at(2, 7, 1))]));
    assert_eq!(told.asks, [(2, stop(3))]);
    assert_eq!((told.moves[0], told.mode), (Dir::East, Mode::Forming));
    let told = step(&mut three, 2, 3, 5, &hears(&[(2, at(2, 7, 1))]));
    assert_eq!(told.mode, Mode::Forming);
    let told = step(&mut three, 3, 3, 7, &hears(&[(2, at(2, 7, 1))]));
    assert_eq!(told.mode, Mode::Cruise);
    assert!(told.asks.contains(&(2, GridMessage::Resume { origin: RobotId(3) })), "{:?}", told.asks);
}

#[test]
fn a_leader_with_a_distant_follower_heads_for_def_and_requests_a_stop() {
    let mut two = agent(2);
    let _ = step(&mut two, 0, 2, 0, &hears(&[(1, at(1, 0, 0)), (3, at(3, 0, 2))]));
    let told = step(&mut two, 1, 2, 0, &hears(&[(1, at(1, 0, 0)), (3, at(3, -8, 2))]));
    assert_eq!((told.asks, told.mode), (vec![(1, stop(2))], Mode::Forming));
    let told = step(&mut two, 2, 2, 0, &hears(&[(1, at(1, 0, 0)), (3, at(3, -8, 2))]));
    assert_eq!(told.moves[0], Dir::West, "towards them");
}

#[test]
fn a_stop_request_is_obeyed_and_passed_on_unless_the_own_sum_is_small() {
    let mut two = agent(2);
    let asked = GridMessage::Stop { origin: RobotId(3), valid_ms: 30_000 };
    // Three cells off in total: neither lost nor kept.
    let off = || hears(&[(1, at(1, 0, 0)), (3, at(3, -2, 2))]);
    let _ = step(&mut two, 0, 2, 0, &off());
    let told = step(&mut two, 1, 2, 0, &[off(), vec![asking(&asked)]].concat());
    assert_eq!((told.mode, told.moves.len()), (Mode::Hold, 0));
    assert!(told.asks.contains(&(1, asked)), "{:?}", told.asks);
    let told = step(&mut two, 2, 2, 0, &hears(&[(1, at(1, 0, 0)), (3, at(3, 0, 2))]));
    assert_eq!(told.mode, Mode::Cruise, "line 15: continue");
}

#[test]
fn a_redirected_robot_excludes_its_last_direction() {
    let mut two = agent(2);
    let column = || hears(&[(1, at(1, 0, 0)), (3, at(3, 0, 2))]);
    let told = step(&mut two, 0, 2, 0, &column());
    assert_eq!(told.moves[0], Dir::East);
    let told = step(&mut two, 1, 2, 0, &[column(), vec![asking(&GridMessage::Redirect)]].concat());
    assert!(!told.moves.is_empty() && !told.moves.contains(&Dir::East), "{:?}", told.moves);
}
