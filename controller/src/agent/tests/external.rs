//! Tests of the law that its owner decides.

use super::plane::orca;
use super::*;
use crate::wire::{Bytes, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD};

type Externals = Agent<f32, External<f32>, 4>;

const OWN: ProtocolId = ProtocolId(99);
const VALID: Duration = Duration::from_millis(5000);
const EAST: Vec3<f32> = Vec3::new(0.5, 0.0, 0.0);

fn external(id: u32) -> Externals {
    Agent::new(&config(id), External::new(OWN), Unguarded, Postcard)
}

fn in_plane<'a>(max_speed_mps: f32, inbox: &'a [u8]) -> AnyInputs<'a, f32> {
    let surroundings = InPlane { max_speed_mps, obstacles: &[] };
    Inputs { state: KinematicState::default(), surroundings, inbox }.any()
}

fn step(agent: &mut Externals, n: u32, inbox: &[u8]) -> Outputs<f32> {
    agent.step(&in_plane(1.0, inbox), tick(n), &mut ())
}

fn going(wish_mps: Vec3<f32>) -> Decision<f32> {
    Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going)
}

/// A frame of robot 2 with a message to robot `to`.
fn message(to: u32, number: u8, protocol: ProtocolId, content: &[u8]) -> Vec<u8> {
    let content = Bytes::from_slice(content).unwrap();
    bytes(2, 0, number.into(), &[Message::Law(Addressed { to: RobotId(to), number, protocol, content })])
}

fn received(agent: &mut Externals) -> Vec<(u32, bool, Vec<u8>)> {
    let law = agent.law_mut();
    core::iter::from_fn(|| law.take()).map(|one| (one.from.0, one.is_order, one.bytes.to_vec())).collect()
}

#[test]
fn a_decision_is_used_once_and_then_the_robot_stays() {
    let mut agent = external(1);
    for n in 0..2 {
        let _ = step(&mut agent, n, &[]);
        assert_eq!(agent.mode(), Mode::Idle, "its owner has not decided");
    }
    for n in 2..4 {
        agent.law_mut().set_decision(going(EAST));
        assert_eq!((step(&mut agent, n, &[]).command, agent.mode()), (Command::Velocity(EAST), Mode::Cruise));
    }
    for n in 4..8 {
        assert_eq!(step(&mut agent, n, &[]).command, Command::Velocity(Vec3::ZERO), "its owner hangs");
    }
    agent.law_mut().set_decision(Decision::idle());
    for n in 8..10 {
        let _ = step(&mut agent, n, &[]);
        assert_eq!(agent.mode(), Mode::Idle);
    }
}

#[test]
fn progress_reaches_the_supervisor() {
    let mut agent = external(1);
    let mut mode = |n: u32, progress: Progress| {
        agent.law_mut().set_decision(Decision { progress, ..going(EAST) });
        let out = step(&mut agent, n, &[]);
        (agent.mode(), out.wait)
    };
    assert_eq!(mode(0, Progress::Arrived), (Mode::Arrived, None));
    assert_eq!(mode(1, Progress::Stuck), (Mode::Hold, Some(Wait::Route)));
    let waits = Progress::Waiting(Wait::Team);
    assert_eq!(mode(2, waits), (Mode::Hold, Some(Wait::Team)));
}

#[test]
fn a_robot_that_listens_tells_the_reason_of_its_law_or_the_radio() {
    let contact_loss = ContactLossPolicy { listen: Duration::from_millis(30_000), ..ContactLossPolicy::DEFAULT };
    let config = AgentConfig { contact_loss, ..config(1) };
    let mut agent: Agent<f32, External<f32>, 4, OrcaSafety<f32, 16>> =
        Agent::new(&config, External::new(OWN), orca(), Postcard);
    let mut wait = |n: u32, progress: Progress, wish_mps: Vec3<f32>| {
        agent.law_mut().set_decision(Decision { progress, ..going(wish_mps) });
        let out = agent.step(&in_plane(1.0, &[]), tick(n), &mut ());
        assert_eq!(out.command, Command::Velocity(Vec3::ZERO), "it listens");
        out.wait
    };
    assert_eq!(wait(0, Progress::Waiting(Wait::Team), Vec3::ZERO), Some(Wait::Team));
    assert_eq!(wait(1, Progress::Stuck, Vec3::ZERO), Some(Wait::Route));
    assert_eq!(wait(2, Progress::Going, Vec3::ZERO), None);
    assert_eq!(wait(3, Progress::Going, EAST), Some(Wait::Radio));
}

#[test]
fn without_the_input_that_a_decision_needs_the_robot_is_in_fault() {
    let moves = || Decision::new(Action::Moves([Dir::East].into()), Progress::Going);
    let on_grid = inputs(&FLAT, Cell::new(5, 5), &[]).any();
    let blind = Inputs {
        surroundings: OnGrid { window: None, ..inputs(&FLAT, Cell::new(5, 5), &[]).surroundings },
        ..inputs(&FLAT, Cell::new(5, 5), &[])
    }
    .any();
    for (decision, inputs, command) in [
        (going(EAST), in_plane(0.0, &[]), None),
        (going(EAST), on_grid, None),
        (moves(), in_plane(1.0, &[]), None),
        (moves(), blind, None),
        (moves(), on_grid, Some(Command::Move([Dir::East].into()))),
        (going(EAST), in_plane(1.0, &[]), Some(Command::Velocity(EAST))),
    ] {
        let mut agent = external(1);
        agent.law_mut().set_decision(decision);
        let out = agent.step(&inputs, tick(0), &mut ());
        let is_sound = command.is_some();
        assert_eq!((out.command, agent.mode() == Mode::Fault), (command.unwrap_or(Command::Hold), !is_sound));
        let _ = agent.step(&inputs, tick(1), &mut ());
        assert_ne!(agent.mode(), Mode::Fault, "the decision was used");
    }
}

#[test]
fn messages_are_sent_at_the_next_decision() {
    let mut agent = external(1);
    let law = agent.law_mut();
    let to_one = |law: &mut External<f32>, to: u32, bytes: &[u8]| law.send(RobotId(to), bytes, VALID);
    assert!(!to_one(law, 2, &[0; 13]) && !to_one(law, 0, &[1]) && !law.broadcast(&[0; MAX_CONTENT + 1]));
    assert_eq!([2, 3, 4, 5, 6].map(|to| to_one(law, to, &[to as u8; 12])), [true, true, true, true, false]);
    assert!(law.broadcast(&[7; MAX_CONTENT]) && !law.broadcast(&[8]));
    let said = sent(&step(&mut agent, 0, &[]));
    let addressed = |frame: &Frame| match &frame.message {
        Message::Law(law) if law.protocol == OWN => Some((law.to.0, law.content[0], law.content.len())),
        Message::Broadcast(all) if all.protocol == OWN => Some((0, all.content[0], all.content.len())),
        _ => None,
    };
    let said: Vec<_> = said.iter().filter_map(addressed).collect();
    assert_eq!(said, [(0, 7, MAX_CONTENT), (2, 2, 12), (3, 3, 12), (4, 4, 12), (5, 5, 12)]);
    assert!(to_one(agent.law_mut(), 2, &[]) && agent.law_mut().broadcast(&[]), "it has room again");
}

#[test]
fn the_oldest_messages_are_dropped_and_counted() {
    let mut agent = external(1);
    for number in 0..6 {
        let _ = step(&mut agent, u32::from(number), &message(1, number, OWN, &[number, 100]));
    }
    assert_eq!(agent.law().dropped(), 2);
    assert_eq!(received(&mut agent), [2, 3, 4, 5].map(|number| (2, false, vec![number, 100])));
    assert_eq!((received(&mut agent), agent.law().dropped()), (vec![], 2));
}

#[test]
fn only_messages_and_orders_of_its_protocol_are_stored() {
    let mut agent = external(1);
    let order = |number: u8, protocol: ProtocolId, content: &[u8]| {
        let content = Bytes::from_slice(content).unwrap();
        Message::Order(Addressed { to: RobotId::NONE, number, protocol, content })
    };
    let all = |protocol, content: &[u8]| {
        Message::Broadcast(crate::wire::Broadcast { protocol, content: Bytes::from_slice(content).unwrap() })
    };
    let other = ProtocolId(98);
    let said = [
        order(1, other, &[1]),
        order(1, OWN, &[2; MAX_ORDER]),
        order(1, OWN, &[2; MAX_ORDER]),
        all(other, &[3]),
        all(OWN, &[]),
    ];
    let inbox = [&message(1, 0, other, &[4])[..], &message(9, 1, OWN, &[5]), &bytes(3, 0, 0, &said)].concat();
    let out = step(&mut agent, 0, &inbox);
    assert_eq!((out.received, out.rejected), (7, 0));
    assert_eq!(received(&mut agent), [(0, true, vec![2; MAX_ORDER]), (3, false, vec![])]);
    assert!(agent.assign(&Task::Cell(Cell::new(1, 1))).is_err());
}

#[test]
fn beacons_carry_the_payload_until_it_changes() {
    let (mut one, mut two) = (external(1), external(2));
    assert!(!one.law_mut().set_payload(&[0; MAX_PAYLOAD + 1]));
    let contents: [&[u8]; 3] = [&[], &[7; MAX_PAYLOAD], &[]];
    for (n, content) in (0..).zip(contents) {
        assert!(one.law_mut().set_payload(content));
        for n in [2 * n, 2 * n + 1] {
            let _ = step(&mut two, n, &step(&mut one, n, &[]).outbox);
            let payload = two.neighbors()[0].payload.unwrap();
            let (id, bytes) = payload.encode::<MAX_PAYLOAD>(ProtocolId::NONE).unwrap();
            assert_eq!((id, &bytes[..]), (OWN, content));
        }
    }
}

#[test]
fn two_halves_are_a_step() {
    let (mut whole, mut halves) = (external(1), external(1));
    let (mut one, mut two) = (Outputs::default(), Outputs::default());
    let mut other = external(2);
    for n in 0..10 {
        let inbox = step(&mut other, n, &[]).outbox;
        for agent in [&mut whole, &mut halves] {
            agent.law_mut().set_decision(going(EAST));
            assert!(agent.law_mut().send(RobotId(2), &[n as u8], VALID));
        }
        let inputs = in_plane(1.0, &inbox);
        whole.step_into(&inputs, tick(n), &mut (), &mut one);
        halves.hear_into(&inputs, tick(n), &mut two);
        assert_eq!((two.received, two.outbox.len()), (1, 0));
        halves.act_into(&in_plane(1.0, &[]), tick(n), &mut (), &mut two);
        assert_eq!((&one, whole.digest()), (&two, halves.digest()));
        assert!(one.outbox.len() > 20);
    }
}
