use super::*;
use crate::body::Body;
use crate::formation::FormationParams;
use crate::geom::Vec3;
use crate::grid::{BLOCKED, Window};
use crate::neighbor::Nearby;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::route::RouteParams;
use crate::template::Template;
use crate::time::{Duration, Instant};
use crate::wire::{Addressed, Beacon, Content, Frame, Header, Message, ProtocolId, decode, encode, frames};
use std::boxed::Box;
use std::vec;
use std::vec::Vec;

const TICK: i32 = 1_000_000;
const FLAT: [u8; 121] = [1; 121];

fn tick(n: u32) -> Instant {
    Instant::from_micros(n * TICK as u32)
}

fn config(id: u32) -> AgentConfig<f32> {
    AgentConfig { seed: 1, ..AgentConfig::new(RobotId(id), 0.0, Duration::from_micros(TICK)) }
}

fn route_agent(id: u32) -> RouteAgent {
    let law = RouteGuidance::new(RouteParams::default());
    RouteAgent::new(&config(id), law, Unguarded, Postcard)
}

fn formation_agent(id: u32) -> FormationAgent {
    let places: Vec<Cell> = (0..3).map(|i| Cell::new(-3 * i, 0)).collect();
    let template = Template::from_graph(&places, &[(0, 1), (1, 2)], id as usize - 1, 2).unwrap();
    let guidance = FormationGuidance::new(RouteParams::default(), FormationParams::default(), template);
    FormationAgent::new(&config(id), guidance, Unguarded, Postcard)
}

fn inputs<'a>(cells: &'a [u8], at: Cell, inbox: &'a [u8]) -> Inputs<'a, f32, OnGrid<'a>> {
    let origin = at - Cell::new(5, 5);
    Inputs {
        state: KinematicState::default(),
        surroundings: OnGrid {
            cell: CellState { cell: at, busy: Duration::ZERO },
            window: Window::new(cells, origin, 11, 11),
        },
        inbox,
    }
}

fn workspace() -> Box<GridWorkspace<CELLS>> {
    Box::new(GridWorkspace::new())
}

fn bytes(sender: u32, boot: u8, sequence: u16, messages: &[Message]) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 1024>::new();
    for (message, sequence) in messages.iter().zip(sequence..) {
        let header = Header { boot, sender: RobotId(sender), sequence };
        encode(header, message, &mut out).unwrap();
    }
    out.to_vec()
}

fn sent(outputs: &Outputs<f32>) -> Vec<Frame> {
    frames(&outputs.outbox).map(|f| decode(f).unwrap()).collect()
}

/// The beacon of a moving robot on the grid.
fn on_grid(payload: GridPayload) -> Beacon {
    let (protocol, payload) = payload.encode(Grid::ID).unwrap();
    Beacon { mode: Mode::Cruise, protocol, payload, ..Beacon::default() }
}

fn in_cell(x: i16, y: i16) -> GridPayload {
    GridPayload { cell: Cell::new(x, y), ..GridPayload::default() }
}

fn beacon_at(x: i16, y: i16) -> Beacon {
    on_grid(in_cell(x, y))
}

/// The beacon of a follower of `leader`.
fn behind(leader: u32, x: i16, y: i16) -> Beacon {
    on_grid(GridPayload { leader: RobotId(leader), ..in_cell(x, y) })
}

fn payload_of(beacon: &Beacon) -> GridPayload {
    GridPayload::decode(Grid::ID, beacon.protocol, &beacon.payload).unwrap()
}

fn message(to: u32, number: u8, message: &GridMessage) -> Message {
    let (protocol, content) = message.encode(Grid::ID).unwrap();
    Message::Law(Addressed { to: RobotId(to), number, protocol, content })
}

fn stop(from: u32, to: u32, number: u8) -> Message {
    message(to, number, &GridMessage::Stop { origin: RobotId(from), valid_ms: 12_000 })
}

fn resume(from: u32, to: u32, number: u8) -> Message {
    message(to, number, &GridMessage::Resume { origin: RobotId(from) })
}

fn redirect(to: u32, number: u8) -> Message {
    message(to, number, &GridMessage::Redirect)
}

/// The messages to single robots.
fn asked(out: &Outputs<f32>) -> Vec<(RobotId, GridMessage)> {
    let said = sent(out).into_iter().filter_map(|frame| match frame.message {
        Message::Law(Addressed { to, protocol, content, .. }) => {
            Some((to, GridMessage::decode(Grid::ID, protocol, &content).unwrap()))
        }
        _ => None,
    });
    said.collect()
}

/// An order for the formation, to one robot or to all.
fn goal(to: u32, number: u8, cell: Cell) -> Message {
    Grid::order(RobotId(to), number, &GridOrder::FormationGoal(cell)).unwrap()
}

fn template_orders(to: u32, parts: impl Iterator<Item = TemplatePart>) -> Vec<Message> {
    let order = |part: TemplatePart| {
        let number = part.part;
        Grid::order(RobotId(to), number, &GridOrder::Template { part, is_restarted: false }).unwrap()
    };
    parts.map(order).collect()
}

#[test]
fn a_robot_without_a_goal_is_idle_and_sends_beacons() {
    let out = route_agent(1).step(&inputs(&FLAT, Cell::new(5, 5), &[]), tick(0), &mut workspace());
    assert_eq!(out.command, Command::Hold);
    let [frame] = &sent(&out)[..] else { panic!("one frame") };
    assert!(matches!(&frame.message, Message::Beacon(beacon) if beacon.mode == Mode::Idle));
    let Message::Beacon(beacon) = &frame.message else { panic!("a beacon") };
    assert_eq!((beacon.protocol, payload_of(beacon)), (Grid::ID, in_cell(5, 5)));
}

#[test]
fn a_robot_moves_to_its_goal_and_arrives() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    let (mut at, goal) = (Cell::new(5, 5), Cell::new(12, 7));
    agent.order(&GridOrder::Goal(goal));
    let mut walked = 0;
    for n in 0..20 {
        let out = agent.step(&inputs(&FLAT, at, &[]), tick(n), &mut ws);
        if let Command::Move(moves) = out.command {
            at = at + moves[0].offset();
            walked += 1;
        }
    }
    assert_eq!((at, walked, agent.mode()), (goal, 7, Mode::Arrived));
}

#[test]
fn a_robot_that_crosses_a_cell_keeps_its_mode_and_does_not_decide() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(9, 5)));
    let mut busy = inputs(&FLAT, Cell::new(9, 5), &[]);
    busy.surroundings.cell = CellState { cell: Cell::new(9, 5), busy: Duration::from_micros(1) };
    let out = agent.step(&busy, tick(0), &mut ws);
    assert_eq!((out.command, agent.mode()), (Command::Hold, Mode::Cruise));
    assert_eq!(out.call_again, tick(0) + Duration::from_micros(1));
    let _ = agent.step(&inputs(&FLAT, Cell::new(9, 5), &[]), tick(1), &mut ws);
    assert_eq!(agent.mode(), Mode::Arrived);
}

#[test]
fn a_robot_recovers_from_the_fault_of_missing_terrain() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(9, 5)));
    let mut modes = Vec::new();
    for (n, has_window) in [true, false, false, true, true].into_iter().enumerate() {
        let mut inputs = inputs(&FLAT, Cell::new(5, 5), &[]);
        let seen = &mut inputs.surroundings.window;
        *seen = seen.filter(|_| has_window);
        let out = agent.step(&inputs, tick(n as u32), &mut ws);
        assert_eq!(out.command == Command::Hold, agent.mode() != Mode::Cruise);
        modes.push(agent.mode());
    }
    let expected = [Mode::Cruise, Mode::Fault, Mode::Fault, Mode::Idle, Mode::Cruise];
    assert_eq!(modes, expected);
}

#[test]
fn an_enclosed_robot_holds_and_reports_once() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(50, 5)));
    let mut cells = [BLOCKED; 121];
    cells[60] = 1;
    let events: Vec<Event> =
        (0..3).flat_map(|n| agent.step(&inputs(&cells, Cell::new(5, 5), &[]), tick(n), &mut ws).events).collect();
    assert_eq!(agent.mode(), Mode::Hold);
    assert_eq!(events.iter().filter(|e| **e == Event::NoRoute).count(), 1);
}

#[test]
fn a_goal_in_a_wall_moves_to_the_nearest_free_cell() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    let goal = Cell::new(8, 5);
    agent.order(&GridOrder::Goal(goal));
    let mut cells = FLAT;
    cells[5 * 11 + 8] = BLOCKED;
    let out = agent.step(&inputs(&cells, Cell::new(5, 5), &[]), tick(0), &mut ws);
    let to = agent.target().unwrap();
    assert_eq!(goal.chebyshev(to), 1);
    assert!(out.events.contains(&Event::TargetMoved { from: goal, to }));
}

#[test]
fn any_received_bytes_are_tolerated_and_counted() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    let mut rng = Rng::new(3);
    for n in 0..200 {
        let noise: Vec<u8> = (0..rng.below(400)).map(|_| rng.next_u32() as u8).collect();
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &noise), tick(n), &mut ws);
        assert_eq!(out.received, 0);
        let parts = frames(&noise).count();
        assert_eq!(usize::from(out.rejected), parts);
    }
    assert!(agent.neighbors().is_empty());
}

#[test]
fn repeated_replayed_and_own_frames_are_refused() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    let mut own = Vec::new();
    let mut hear = |inbox: &[u8], n| {
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), inbox), tick(n), &mut ws);
        own.push(out.outbox.to_vec());
        (out.received, out.rejected)
    };
    let beacon = |x| Message::Beacon(beacon_at(x, 3));
    assert_eq!(hear(&bytes(2, 0, 7, &[beacon(1)]), 0), (1, 0));
    assert_eq!(hear(&bytes(2, 0, 7, &[beacon(2)]), 1), (0, 1), "a duplicate");
    assert_eq!(hear(&bytes(2, 0, 9, &[beacon(3)]), 2), (1, 0));
    assert_eq!(hear(&bytes(2, 0, 8, &[beacon(4)]), 3), (1, 0), "late, but not seen yet");
    assert_eq!(hear(&bytes(2, 1, 0, &[beacon(6)]), 4), (1, 0), "it restarted");
    assert_eq!(hear(&bytes(2, 0, 10, &[beacon(7)]), 5), (0, 1), "from before its start");
    let own = core::mem::take(&mut own);
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &own.concat()), tick(6), &mut ws);
    assert_eq!((out.received, out.rejected), (0, 6), "its own");
    assert_eq!(agent.neighbors()[0].payload, Some(in_cell(6, 3)));
}

#[test]
fn neighbours_are_found_lost_and_evicted() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    for id in 2..19 {
        let mut beacon = beacon_at(0, 0);
        beacon.position_mm = [1000 * id as i32, 0, 0];
        let inbox = bytes(id, 0, 0, &[Message::Beacon(beacon)]);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
        let expected = (id < 18).then_some(Event::NeighborFound(RobotId(id)));
        assert_eq!(out.events.first(), expected.as_ref(), "the farthest finds no room");
    }
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), tick(31), &mut ws);
    assert_eq!(out.events[0], Event::NeighborLost(RobotId(2)));
    assert!(agent.neighbors().is_empty());
}

#[test]
fn goals_are_assigned_by_packet_and_older_ones_ignored() {
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    let goal = |to, number, x| goal(to, number, Cell::new(x, 0));
    let orders = [goal(0, 5, 40), goal(2, 4, 50), goal(3, 6, 60), goal(2, 7, 70), goal(2, 7, 80)];
    let inbox = bytes(99, 0, 0, &orders);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
    assert_eq!(agent.target(), Some(Cell::new(67, 0)));
}

#[test]
fn a_restarted_commander_is_obeyed_at_any_number() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    let mut target_after = |boot, number, x| {
        let inbox = bytes(99, boot, 0, &[goal(1, number, Cell::new(x, 5))]);
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
        agent.target().map(|cell| cell.x)
    };
    assert_eq!(target_after(0, 100, 40), Some(40));
    assert_eq!(target_after(0, 99, 50), Some(40));
    assert_eq!(target_after(1, 0, 60), Some(60));
    assert_eq!(target_after(1, 0, 70), Some(60));
}

#[test]
fn templates_are_assigned_by_packet() {
    let (mut agent, mut ws) = (formation_agent(1), workspace());
    let entries = formation_agent(3).law.template().entries.clone();
    let parts = TemplatePart::split(1, 2, Cell::new(-6, 0), &entries).unwrap();
    let inbox = bytes(99, 0, 0, &template_orders(1, parts));
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
    assert_eq!(agent.law.template(), formation_agent(3).law.template());
}

#[test]
fn a_stop_holds_until_it_is_resumed_or_expires() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut mode_after = |inbox: &[u8], n| {
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), inbox), tick(n), &mut ws);
        let acks = sent(&out).iter().filter(|f| matches!(f.message, Message::Ack(_))).count();
        assert_eq!(acks, usize::from(!inbox.is_empty()), "every message is acknowledged");
        agent.mode()
    };
    assert_eq!(mode_after(&[], 0), Mode::Cruise);
    assert_eq!(mode_after(&bytes(2, 0, 0, &[stop(2, 1, 0)]), 1), Mode::Hold);
    assert_eq!(mode_after(&bytes(2, 0, 1, &[resume(2, 1, 1)]), 2), Mode::Cruise);
    assert_eq!(mode_after(&bytes(2, 0, 2, &[stop(2, 1, 2)]), 3), Mode::Hold);
    assert_eq!(mode_after(&bytes(2, 0, 3, &[stop(2, 1, 2)]), 10), Mode::Hold, "a repeat does not prolong it");
    assert_eq!(mode_after(&[], 14), Mode::Hold);
    assert_eq!(mode_after(&[], 16), Mode::Cruise, "the lost resume costs 12 ticks");
}

#[test]
fn stops_are_passed_up_the_leader_chain_hop_by_hop() {
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let leader = bytes(1, 0, 0, &[Message::Beacon(beacon_at(8, 5))]);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &leader), tick(0), &mut ws);
    assert_eq!(agent.leader(), RobotId(1));
    let inbox = bytes(3, 0, 0, &[stop(3, 2, 9)]);
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(1), &mut ws);
    assert_eq!(asked(&out), [(RobotId(1), GridMessage::Stop { origin: RobotId(3), valid_ms: 12_000 })]);
    assert_ne!(agent.mode(), Mode::Hold, "a follower continues");
}

#[test]
fn a_robot_that_falls_behind_requests_a_stop_and_later_a_resume() {
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut said = Vec::new();
    for (n, (leader_x, own_x)) in [(8, 5), (20, 5), (20, 16)].into_iter().enumerate() {
        let beacon = on_grid(GridPayload { heading: Dir::East, ..in_cell(leader_x, 5) });
        let inbox = bytes(1, 0, n as u16, &[Message::Beacon(beacon)]);
        // Far enough apart for the first message to be acknowledged or given up.
        let out = agent.step(&inputs(&FLAT, Cell::new(own_x, 5), &inbox), tick(20 * n as u32), &mut ws);
        said.extend(asked(&out));
    }
    let (leader, origin) = (RobotId(1), RobotId(2));
    assert_eq!(
        said,
        [(leader, GridMessage::Stop { origin, valid_ms: 12_000 }), (leader, GridMessage::Resume { origin })]
    );
}

#[test]
fn a_redirected_robot_chooses_another_direction_even_when_arrived() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(9, 5)));
    let first = |out: &Outputs<f32>| match &out.command {
        Command::Move(moves) => Some(moves[0]),
        Command::Hold | Command::Velocity(_) => None,
    };
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), tick(0), &mut ws);
    assert_eq!(first(&out), Some(Dir::East));
    let inbox = bytes(2, 0, 0, &[redirect(1, 0)]);
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(1), &mut ws);
    assert!(first(&out).is_some_and(|dir| dir != Dir::East), "{out:?}");
    let inbox = bytes(2, 0, 1, &[redirect(1, 1)]);
    let out = agent.step(&inputs(&FLAT, Cell::new(9, 5), &inbox), tick(2), &mut ws);
    assert_eq!(agent.mode(), Mode::Arrived);
    assert!(first(&out).is_some());
    let out = agent.step(&inputs(&FLAT, Cell::new(9, 5), &[]), tick(3), &mut ws);
    assert_eq!(first(&out), None, "once is enough");
}

#[test]
fn a_blocked_robot_asks_the_robot_in_its_way_to_redirect() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut cells = [BLOCKED; 121];
    cells[55..66].fill(1);
    let mut first = None;
    for n in 0..8 {
        let inbox = bytes(2, 0, n, &[Message::Beacon(beacon_at(6, 5))]);
        let out = agent.step(&inputs(&cells, Cell::new(5, 5), &inbox), tick(n.into()), &mut ws);
        first = first.or(asked(&out).pop().map(|(to, message)| (n, to, message)));
    }
    assert_eq!(first, Some((4, RobotId(2), GridMessage::Redirect)));
}

#[test]
fn outboxes_hold_whole_frames_and_the_beacon_at_any_load() {
    let (mut agent, mut ws) = (formation_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    for n in 0..40_u16 {
        let crowd: Vec<u8> = (2..60).flat_map(|id| bytes(id, 0, n, &[stop(id, 1, n as u8)])).collect();
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &crowd), tick(n.into()), &mut ws);
        let frames = sent(&out);
        assert!(frames.len() > 1);
        assert!(matches!(frames.last().unwrap().message, Message::Beacon(_)));
    }
}

#[test]
fn equal_agents_give_equal_bytes() {
    let run = || {
        let (mut agent, mut ws) = (formation_agent(1), workspace());
        agent.order(&GridOrder::Goal(Cell::new(40, 9)));
        let mut at = Cell::new(5, 5);
        let mut said = vec![];
        for n in 0..30 {
            let inbox = bytes(2, 0, n, &[Message::Beacon(beacon_at(at.x - 3, at.y))]);
            let out = agent.step(&inputs(&FLAT, at, &inbox), tick(n.into()), &mut ws);
            if let Command::Move(moves) = &out.command {
                at = at + moves[0].offset();
            }
            said.extend_from_slice(&out.outbox);
        }
        (at, said)
    };
    assert_eq!(run(), run());
}

#[test]
fn the_clock_may_wrap() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let start = Instant::from_micros(u32::MAX - 2_500_000);
    let mut beacons = 0;
    for n in 0..6 {
        let now = start + Duration::from_micros(n * TICK);
        let inbox = bytes(2, 0, n as u16, &[Message::Beacon(beacon_at(6, 9))]);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), now, &mut ws);
        beacons += sent(&out).len();
        assert_eq!(agent.neighbors().len(), 1);
        assert!(now.is_before(out.call_again));
    }
    assert_eq!(beacons, 6);
}

mod any_law;
mod cell_follower;
mod claims;
mod commanded;
mod contact_loss;
mod crossing;
mod duplicate_id;
mod external;
mod faults;
mod flocks;
mod make_way;
mod map_sharing;
mod nonsense;
mod nonsense_in_plane;
mod on_grid;
mod payload;
mod plane;
mod protocol;
mod relay;
mod relayed;
mod sealed;
mod setup;
mod sighted;
mod silence;
mod stops;
mod trust;
mod waits;
