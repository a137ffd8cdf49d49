//! Tests of a protocol of users: messages to one robot and to all, and orders by radio.

use super::*;
use crate::wire::{Ack, Broadcast, Bytes, MAX_CONTENT, MAX_MESSAGE, MAX_ORDER};

/// One byte on the air for the length, and the text.
type Text = heapless::Vec<u8, 64>;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Call(Text);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Instruction {
    Mark(u8),
    Name(Text),
    Count(u8),
}

impl Content for Call {}
impl Content for Instruction {}

#[derive(Clone, Debug)]
struct Calls<const ID: u8>;

impl<const ID: u8> Protocol for Calls<ID> {
    const ID: ProtocolId = ProtocolId(ID);
    type Payload = ();
    type Message = Call;
    type Order = Instruction;

    fn subject(call: &Call) -> u32 {
        call.0.first().copied().unwrap_or_default().into()
    }

    fn order_subject(order: &Instruction) -> Option<u32> {
        match order {
            Instruction::Mark(_) => Some(0),
            Instruction::Name(_) => Some(1),
            Instruction::Count(_) => None,
        }
    }

    fn received(order: &mut Instruction, _: Instant, is_restarted: bool) {
        if let Instruction::Count(count) = order
            && is_restarted
        {
            *count += 100;
        }
    }
}

/// Sends the messages of the test at its next decision, and remembers those that it receives.
#[derive(Clone, Debug, Default)]
struct Caller<const ID: u8> {
    to_send: Vec<(RobotId, Call)>,
    to_all: Option<Call>,
    answer: Option<Call>,
    has_room: Vec<bool>,
    heard: Vec<(u32, Call)>,
    orders: Vec<Instruction>,
    is_deaf: bool,
}

const VALID: Duration = Duration::from_millis(60_000);

impl<const ID: u8> Law<f32> for Caller<ID> {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Calls<ID>;
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, f32, Calls<ID>>,
        _: &InPlane<'_, f32>,
        mut tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let send = |(to, call): (RobotId, Call)| tools.radio.send(to, &call, VALID);
        self.has_room = self.to_send.drain(..).map(send).collect();
        if let Some(call) = self.to_all.take() {
            tools.radio.broadcast(&call);
        }
        Ok(Decision::default())
    }

    fn receive(&mut self, from: RobotId, call: &Call, radio: &mut Radio<'_, Calls<ID>>) -> bool {
        self.heard.push((from.0, call.clone()));
        if let Some(answer) = self.answer.take() {
            assert!(radio.send(from, &answer, VALID));
            radio.broadcast(&answer);
        }
        true
    }

    fn order(&mut self, order: &Instruction) -> bool {
        self.orders.push(order.clone());
        !self.is_deaf
    }
}

type Robot<const ID: u8 = 64> = Agent<f32, Caller<ID>, NEIGHBORS>;

fn robot<const ID: u8>(id: u32) -> Robot<ID> {
    Agent::new(&config(id), Caller::default(), Unguarded, Postcard)
}

fn call(text: &[u8]) -> Call {
    Call(Text::from_slice(text).unwrap())
}

fn step<G>(agent: &mut Agent<f32, G, NEIGHBORS>, n: u32, inbox: &[u8]) -> Outputs<f32>
where
    G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()>,
{
    let surroundings = InPlane { max_speed_mps: 1.0, obstacles: &[] };
    agent.step(&Inputs { state: KinematicState::default(), surroundings, inbox }, tick(n), &mut ())
}

fn numbers(out: &Outputs<f32>) -> Vec<u8> {
    let law = sent(out).into_iter().filter_map(|frame| match frame.message {
        Message::Law(message) => Some(message.number),
        _ => None,
    });
    law.collect()
}

fn has_acks(out: &Outputs<f32>) -> bool {
    sent(out).iter().any(|frame| matches!(frame.message, Message::Ack(_)))
}

fn addressed(to: u32, number: u8, protocol: u8, content: &[u8]) -> Message {
    let content = Bytes::from_slice(content).unwrap();
    Message::Law(Addressed { to: RobotId(to), number, protocol: ProtocolId(protocol), content })
}

#[test]
fn a_message_arrives_once_although_its_acknowledgement_was_lost() {
    let (mut one, mut two) = (robot::<64>(1), robot::<64>(2));
    one.law_mut().to_send.push((RobotId(2), call(b"help")));
    let (mut said, mut answered) = (vec![], vec![]);
    let (mut sends, mut acks) = (vec![], 0);
    for n in 0..60 {
        let out = step(&mut one, n, &answered);
        sends.extend(numbers(&out).into_iter().map(|number| (n, number)));
        assert!(!out.events.iter().any(|event| matches!(event, Event::MessageExpired(_))), "step {n}");
        let answer = step(&mut two, n, &said);
        said = out.outbox.to_vec();
        // The first acknowledgement is lost, with all other frames of the step.
        acks += usize::from(has_acks(&answer));
        answered = if has_acks(&answer) && acks == 1 { vec![] } else { answer.outbox.to_vec() };
    }
    assert_eq!((sends.len(), acks), (2, 2), "{sends:?}");
    assert_eq!((sends[0], sends[1].1), ((0, 0), 0), "with one number");
    assert_eq!(two.law().heard, [(1, call(b"help"))]);
    assert!(one.law().heard.is_empty() && one.link.is_quiet());
}

#[test]
fn the_sender_reports_a_message_that_is_never_acknowledged() {
    let mut one = robot::<64>(1);
    one.law_mut().to_send.push((RobotId(2), call(b"help")));
    let (mut sends, mut expired) = (0, vec![]);
    for n in 0..60 {
        let out = step(&mut one, n, &[]);
        sends += numbers(&out).len();
        expired.extend(out.events.iter().filter(|event| matches!(event, Event::MessageExpired(_))).copied());
    }
    assert_eq!((sends, &expired[..]), (5, &[Event::MessageExpired(RobotId(2))][..]));
}

#[test]
fn a_broadcast_is_sent_once_and_arrives_at_all_robots_with_its_protocol() {
    let (mut one, mut two, mut three, mut other) = (robot::<64>(1), robot::<64>(2), robot::<64>(3), robot::<65>(4));
    one.law_mut().to_all = Some(call(b"here"));
    for n in 0..5 {
        let said = step(&mut one, n, &[]);
        let broadcasts = sent(&said).iter().filter(|frame| matches!(frame.message, Message::Broadcast(_))).count();
        assert_eq!(broadcasts, usize::from(n == 0));
        for out in
            [step(&mut two, n, &said.outbox), step(&mut three, n, &said.outbox), step(&mut other, n, &said.outbox)]
        {
            assert_eq!((out.received, has_acks(&out)), (1 + u16::from(n == 0), false));
        }
    }
    let heard = [(1, call(b"here"))];
    assert_eq!((&two.law().heard[..], &three.law().heard[..]), (&heard[..], &heard[..]));
    assert!(other.law().heard.is_empty());
}

/// Steps a robot with another protocol that hears a message to it, and one to all.
fn hears_nothing<G>(law: G) -> Agent<f32, G, NEIGHBORS>
where
    G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()>,
{
    let mut agent = Agent::new(&config(2), law, Unguarded, Postcard);
    let (protocol, content) = call(b"help").encode(ProtocolId(64)).unwrap();
    let to_all = Message::Broadcast(Broadcast { protocol, content });
    let (protocol, content) = call(b"help").encode(protocol).unwrap();
    let to_it = Message::Law(Addressed { to: RobotId(2), number: 0, protocol, content });
    let out = step(&mut agent, 0, &bytes(1, 0, 0, &[to_it, to_all]));
    assert_eq!((out.received, sent(&out).len()), (2, 1), "the beacon alone");
    agent
}

#[test]
fn a_robot_with_another_protocol_neither_acknowledges_nor_receives() {
    assert!(hears_nothing(Caller::<65>::default()).law().heard.is_empty());
    let _ = hears_nothing(WaypointGuidance::new(1.0, 0.01));
    let mut on_grid = route_agent(2);
    let (protocol, content) = call(b"help").encode(ProtocolId(64)).unwrap();
    let to_it = Message::Law(Addressed { to: RobotId(2), number: 0, protocol, content });
    let out = on_grid.step(&inputs(&FLAT, Cell::new(5, 5), &bytes(1, 0, 0, &[to_it])), tick(0), &mut workspace());
    assert_eq!((out.received, sent(&out).len()), (1, 1));

    let (mut one, mut other) = (robot::<64>(1), robot::<65>(2));
    one.law_mut().to_send.push((RobotId(2), call(b"help")));
    let (mut answered, mut expired) = (vec![], 0);
    for n in 0..60 {
        let out = step(&mut one, n, &answered);
        expired += out.events.iter().filter(|event| **event == Event::MessageExpired(RobotId(2))).count();
        answered = step(&mut other, n, &out.outbox).outbox.to_vec();
    }
    assert_eq!((expired, one.neighbors().len(), other.law().heard.len()), (1, 1, 0));
}

#[test]
fn a_stop_is_neither_acknowledged_nor_obeyed_by_a_robot_with_waypoints() {
    let mut agent = Agent::<f32, _, NEIGHBORS>::new(&config(1), WaypointGuidance::new(1.0, 0.01), Unguarded, Postcard);
    agent.order(&WaypointOrder::first(Waypoint::fixed(crate::geom::Position::from_mm([9_000, 0, 0]))));
    let out = step(&mut agent, 0, &bytes(2, 0, 0, &[stop(2, 1, 0)]));
    assert_eq!((has_acks(&out), agent.mode()), (false, Mode::Cruise));
}

type AnyRobot = Agent<f32, AnyLaw<f32, CELLS, VISITS>, NEIGHBORS>;

/// Whether an `AnyLaw` with waypoints acknowledges the message.
fn any_acknowledges(message: Message) -> bool {
    let law = AnyLaw::Waypoint(WaypointGuidance::new(1.0, 0.01));
    let mut agent = AnyRobot::new(&config(1), law, Unguarded, Postcard);
    let surroundings = AnySurroundings::InPlane(InPlane { max_speed_mps: 1.0, obstacles: &[] });
    let inbox = bytes(2, 0, 0, &[message]);
    let inputs = Inputs { state: KinematicState::default(), surroundings, inbox: &inbox };
    has_acks(&agent.step(&inputs, tick(0), &mut workspace()))
}

#[test]
fn an_enum_of_laws_acknowledges_as_the_law_inside_does() {
    assert!(!any_acknowledges(stop(2, 1, 0)), "a stop to a robot with waypoints");
    assert!(!any_acknowledges(addressed(1, 0, 64, b"\x01x")), "of a protocol of users");
}

#[test]
fn messages_to_others_and_bytes_that_do_not_decode_are_ignored() {
    let mut two = robot::<64>(2);
    let right = b"\x04help";
    for (n, wrong) in (0..).zip([
        addressed(3, 0, 64, right),
        addressed(0, 0, 64, right),
        addressed(2, 0, 64, b"\x05help"),
        addressed(2, 0, 64, b"\x03help"),
        addressed(2, 0, 64, b""),
        addressed(2, 0, 0, right),
    ]) {
        let out = step(&mut two, n, &bytes(1, 0, n as u16, &[wrong]));
        assert_eq!((out.received, has_acks(&out), two.law().heard.len()), (1, false, 0));
    }
    let out = step(&mut two, 9, &bytes(1, 3, 9, &[addressed(2, 7, 64, right)]));
    let acks: Vec<_> = sent(&out).into_iter().map(|frame| frame.message).collect();
    assert_eq!(acks[0], Message::Ack(Ack { to: RobotId(1), boot: 3, number: 7 }));
    assert_eq!(two.law().heard, [(1, call(b"help"))]);
}

#[test]
fn a_newer_message_about_a_subject_replaces_the_older_one() {
    let (mut one, mut two) = (robot::<64>(1), robot::<64>(2));
    one.law_mut().to_send = vec![(RobotId(2), call(b"a1")), (RobotId(2), call(b"b1")), (RobotId(3), call(b"a1"))];
    let _ = step(&mut one, 0, &[]);
    one.law_mut().to_send = vec![(RobotId(2), call(b"a2")), (RobotId(2), call(b"b1"))];
    let mut said = vec![];
    for n in 1..10 {
        said.extend(step(&mut one, n, &[]).outbox.to_vec());
    }
    let _ = step(&mut two, 10, &said);
    let mut heard = two.law().heard.clone();
    heard.sort_by(|(_, one), (_, other)| one.0.cmp(&other.0));
    assert_eq!(heard, [(1, call(b"a2")), (1, call(b"b1"))]);
}

#[test]
fn an_answer_is_sent_in_the_same_step() {
    let mut two = robot::<64>(2);
    two.law_mut().answer = Some(call(b"yes"));
    let out = step(&mut two, 0, &bytes(1, 0, 0, &[addressed(2, 0, 64, b"\x01?")]));
    let messages: Vec<_> = sent(&out).into_iter().map(|frame| frame.message).collect();
    let answer = addressed(1, 0, 64, b"\x03yes");
    assert!(messages.contains(&answer), "{messages:?}");
}

#[test]
fn an_answer_to_all_is_sent_in_the_same_step() {
    let mut two = robot::<64>(2);
    two.law_mut().answer = Some(call(b"yes"));
    let out = step(&mut two, 0, &bytes(1, 0, 0, &[addressed(2, 0, 64, b"\x01?")]));
    assert!(sent(&out).iter().any(|frame| matches!(frame.message, Message::Broadcast(_))));
}

#[test]
fn a_message_of_12_bytes_fits_and_one_of_13_is_refused() {
    assert_eq!((MAX_MESSAGE, MAX_CONTENT, MAX_ORDER), (12, 38, 34));
    let mut one = robot::<64>(1);
    one.law_mut().to_send = vec![(RobotId(2), call(&[7; 11])), (RobotId(2), call(&[8; 12]))];
    let out = step(&mut one, 0, &[]);
    assert_eq!((&one.law().has_room[..], numbers(&out).len()), (&[true, false][..], 1));
    let mut two = robot::<64>(2);
    let _ = step(&mut two, 0, &out.outbox);
    assert_eq!(two.law().heard, [(1, call(&[7; 11]))]);
}

#[test]
fn a_law_sends_at_most_four_messages_in_a_step() {
    let mut one = robot::<64>(1);
    one.law_mut().to_send = (2..8).map(|to| (RobotId(to), call(b"help"))).collect();
    let out = step(&mut one, 0, &[]);
    assert_eq!(one.law().has_room, [true, true, true, true, false, false]);
    assert_eq!(numbers(&out), [0, 1, 2, 3]);
}

#[test]
fn a_broadcast_of_38_bytes_fits_and_one_of_39_is_not_sent() {
    for (len, fits) in [(37, true), (38, false)] {
        let mut one = robot::<64>(1);
        one.law_mut().to_all = Some(Call((0..len).collect()));
        let out = step(&mut one, 0, &[]);
        assert_eq!(sent(&out).iter().any(|frame| matches!(frame.message, Message::Broadcast(_))), fits);
    }
}

fn mark(to: u32, number: u8, value: u8) -> Message {
    Calls::<64>::order(RobotId(to), number, &Instruction::Mark(value)).unwrap()
}

/// Sends each order in its own step, by operator 99 with a boot number.
fn orders(robot: &mut Robot, first: u16, said: &[(u8, Message)]) -> Vec<Instruction> {
    for ((boot, message), n) in said.iter().zip(first..) {
        let out = step(robot, n.into(), &bytes(99, *boot, n, core::slice::from_ref(message)));
        assert!(!has_acks(&out), "orders are not acknowledged");
    }
    core::mem::take(&mut robot.law_mut().orders)
}

#[test]
fn an_order_is_given_once_per_number_to_one_robot_and_to_all() {
    for to in [2, 0] {
        let mut robot = robot::<64>(2);
        let said = [(0, 5, 50), (0, 5, 50), (0, 5, 51), (0, 4, 40), (0, 6, 60), (0, 5, 50), (0, 134, 70), (0, 133, 80)];
        // 134 is 128 ahead of 6, and so older.
        let said = said.map(|(boot, number, value)| (boot, mark(to, number, value)));
        assert_eq!(orders(&mut robot, 0, &said), [50, 60, 80].map(Instruction::Mark), "to {to}");
    }
}

#[test]
fn orders_to_one_robot_and_to_all_share_their_numbers() {
    let mut robot = robot::<64>(2);
    let said = [(0, 5), (2, 5), (3, 7), (2, 6), (0, 6)].map(|(to, number)| (0, mark(to, number, number)));
    assert_eq!(orders(&mut robot, 0, &said), [5, 6].map(Instruction::Mark));
}

#[test]
fn orders_of_other_protocols_or_to_other_robots_are_not_given() {
    let mut robot = robot::<64>(2);
    let other = Calls::<65>::order(RobotId(2), 0, &Instruction::Mark(1)).unwrap();
    let grid = goal(0, 0, Cell::new(1, 1));
    assert_eq!(orders(&mut robot, 0, &[(0, other), (0, grid), (0, mark(3, 0, 1))]), []);
}

#[test]
fn subjects_are_independent_and_a_restarted_operator_counts_anew() {
    let mut robot = robot::<64>(2);
    let name = |number| {
        let order = Instruction::Name(Text::from_slice(&[number]).unwrap());
        (Calls::<64>::order(RobotId(2), number, &order).unwrap(), order)
    };
    let said =
        [(0, mark(2, 9, 1)), (0, name(3).0), (0, name(2).0), (0, mark(2, 9, 2)), (1, mark(2, 0, 3)), (1, name(2).0)];
    let given = [Instruction::Mark(1), name(3).1, Instruction::Mark(3), name(2).1];
    assert_eq!(orders(&mut robot, 0, &said), given);
}

#[test]
fn an_order_that_was_of_no_use_is_given_again_when_it_is_repeated() {
    let mut robot = robot::<64>(2);
    robot.law_mut().is_deaf = true;
    let again = || [(0, mark(2, 5, 50)), (0, mark(2, 5, 50))];
    assert_eq!(orders(&mut robot, 0, &again()), [50, 50].map(Instruction::Mark));
    robot.law_mut().is_deaf = false;
    assert_eq!(orders(&mut robot, 10, &again()), [Instruction::Mark(50)]);
}

#[test]
fn an_order_without_a_subject_is_always_given_and_tells_a_restarted_operator() {
    let mut robot = robot::<64>(2);
    let count = || Calls::<64>::order(RobotId(0), 0, &Instruction::Count(1)).unwrap();
    let said = [(0, count()), (0, count()), (0, mark(2, 0, 7)), (0, count()), (1, count()), (1, count())];
    let given = [101, 1].map(Instruction::Count).into_iter().chain([Instruction::Mark(7)]);
    let given: Vec<_> = given.chain([1, 101, 1].map(Instruction::Count)).collect();
    assert_eq!(orders(&mut robot, 0, &said), given);
}

#[test]
fn an_order_of_34_bytes_fits_and_one_of_35_has_no_frame() {
    let name = |len: u8| Instruction::Name((0..len).collect());
    let order = Calls::<64>::order(RobotId(2), 0, &name(32)).unwrap();
    assert!(matches!(&order, Message::Order(Addressed { content, .. }) if content.len() == MAX_ORDER));
    assert_eq!(orders(&mut robot::<64>(2), 0, &[(0, order)]), [name(32)]);
    assert_eq!(Calls::<64>::order(RobotId(2), 0, &name(33)), None);
}
