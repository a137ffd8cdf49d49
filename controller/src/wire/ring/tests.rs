use super::*;
use crate::auth::{Master, ReplayGuard};
use crate::robot::RobotId;
use crate::wire::{
    Ack, Addressed, Beacon, DecodeError, Header, KeyHeld, Message, OperatorWire, ProtocolId, Sealed, Wire,
};
use proptest::collection::vec;
use proptest::prelude::*;
use std::vec::Vec;

const OPERATOR: RobotId = RobotId(1000);
type Bytes = heapless::Vec<u8, 64>;

fn master() -> Master {
    Master::new(&Key::of_passphrase(b"the operator's"))
}

fn robot(id: u32, generation: u16, starts: u32) -> Sealed<8> {
    let ring = Ring::of_generation(generation, &master().seed(generation)).with_own(&master().own_key(RobotId(id)));
    Sealed::with_ring(ring, RobotId(id), starts).unwrap()
}

fn operator() -> OperatorWire<8> {
    OperatorWire::at_start(master(), OPERATOR, 0).unwrap()
}

fn key(operator: &mut OperatorWire<8>, to: u32, generation: u16, phase: KeyPhase) -> Bytes {
    let mut out = Bytes::new();
    operator.send_key(RobotId(to), generation, phase, &mut out).unwrap();
    out
}

fn said(by: &mut impl Wire, sender: u32, sequence: u16, message: &Message) -> Bytes {
    let mut out = Bytes::new();
    by.encode(Header { boot: 0, sender: RobotId(sender), sequence }, message, &mut out).unwrap();
    out
}

fn read(by: &mut impl Wire, frame: &[u8]) -> Result<Message, DecodeError> {
    let mut rest = frame;
    let frame = by.next_frame(&mut rest).unwrap();
    by.decode(frame).map(|frame| frame.message)
}

fn beacon() -> Message {
    Message::Beacon(Beacon::default())
}

fn order(to: u32) -> Message {
    let content = heapless::Vec::from_slice(&[0, 1, 0, 2, 0]).unwrap();
    Message::Order(Addressed { to: RobotId(to), number: 1, protocol: ProtocolId(1), content })
}

#[test]
fn a_seed_can_be_unwrapped_only_by_its_robot_and_for_its_generation() {
    let own = |id| Mac::new(&master().own_key(RobotId(id)));
    let wrapped = master().seed(5).wrap(&own(3), 5);
    assert_eq!(Seed::unwrap(&own(3), 5, &wrapped), Some(master().seed(5)));
    assert_eq!(Seed::unwrap(&own(4), 5, &wrapped), None);
    assert_eq!(Seed::unwrap(&own(3), 6, &wrapped), None);
    for at in 0..wrapped.len() {
        for bit in 0..8 {
            let mut damaged = wrapped;
            damaged[at] ^= 1 << bit;
            assert_eq!(Seed::unwrap(&own(3), 5, &damaged), None, "byte {at}");
        }
    }
    let keys =
        [master().own_key(RobotId(1)), master().own_key(RobotId(2)), master().seed(1).key(1), master().seed(2).key(2)];
    for (at, key) in keys.iter().enumerate() {
        assert!(keys.iter().skip(at + 1).all(|other| other != key));
    }
    assert!(!wrapped.windows(16).any(|part| part == master().seed(5).as_bytes()), "it is hidden");
    assert_eq!(std::format!("{:?}", master().seed(1)), "Seed(secret)");
}

#[test]
fn a_robot_without_the_new_key_is_excluded_after_the_change() {
    let mut operator = operator();
    let mut robots = [robot(1, 0, 0), robot(2, 0, 0), robot(3, 0, 0)];
    let mut sequence = 0;
    let mut hears = |robots: &mut [Sealed<8>; 3], by: usize, of: usize| {
        sequence += 1;
        let frame = said(&mut robots[of], of as u32 + 1, sequence, &beacon());
        read(&mut robots[by], &frame).map(drop)
    };
    assert_eq!((hears(&mut robots, 0, 2), hears(&mut robots, 2, 0)), (Ok(()), Ok(())));
    for phase in [KeyPhase::Hear, KeyPhase::Speak, KeyPhase::Forget] {
        for id in [1, 2] {
            let frame = key(&mut operator, id, 1, phase);
            assert!(frame.len() <= 60);
            let at = id as usize - 1;
            assert!(matches!(read(&mut robots[at], &frame), Ok(Message::Key(_))));
            assert_eq!(robots[at].held(), Some((1, phase)));
            assert_eq!(read(&mut robots[1 - at], &frame), Err(DecodeError::Foreign), "of another swarm");
            assert_eq!((hears(&mut robots, 0, 1), hears(&mut robots, 1, 0)), (Ok(()), Ok(())), "{phase:?} {id}");
        }
        let out = Err(DecodeError::Forged);
        let of_third = if phase == KeyPhase::Forget { out } else { Ok(()) };
        assert_eq!(hears(&mut robots, 0, 2), of_third, "{phase:?}");
        let by_third = if phase == KeyPhase::Hear { Ok(()) } else { out };
        assert_eq!(hears(&mut robots, 2, 0), by_third, "{phase:?}");
    }
}

#[test]
fn only_generations_before_the_one_in_use_are_forgotten() {
    let seed = |generation| master().seed(generation);
    let made = |ring: &Ring, generation: u16| {
        let of = Mac::new(&seed(generation).key(generation));
        ring.signer(|mac| mac.of(&[b"any"]) == of.of(&[b"any"])) == Some(Signer::Swarm(generation))
    };
    let accepts = |ring: &Ring| [4, 5, 6].map(|generation| made(ring, generation));
    let mut ring = Ring::of_generation(5, &seed(5));
    ring.hear(4, &seed(4));
    ring.hear(u16::MAX, &seed(6));
    assert_eq!((accepts(&ring), ring.held()), ([false, true, false], (5, KeyPhase::Forget)));
    ring.hear(6, &seed(6));
    for generation in [4, 5, 6, 7] {
        ring.forget_before(generation);
        assert_eq!((accepts(&ring), ring.held()), ([false, true, true], (6, KeyPhase::Hear)), "{generation}");
    }
    for generation in [4, 5, 7] {
        ring.speak(generation);
        assert_eq!(ring.generation(), 5);
    }
    ring.speak(6);
    ring.speak(5);
    for generation in [4, 5, 7] {
        ring.forget_before(generation);
        assert_eq!((accepts(&ring), ring.held()), ([false, true, true], (6, KeyPhase::Speak)), "{generation}");
    }
    ring.forget_before(6);
    assert_eq!((accepts(&ring), ring.held()), ([false, false, true], (6, KeyPhase::Forget)));
}

#[test]
fn only_the_operator_can_give_orders() {
    let mut operator = operator();
    let (mut insider, mut listener) = (robot(1, 0, 0), robot(2, 0, 0));
    for (n, to) in [2, 0].into_iter().enumerate() {
        let frame = said(&mut insider, OPERATOR.0, n as u16, &order(to));
        assert_eq!(read(&mut listener, &frame), Err(DecodeError::Forged), "to {to}");
    }
    let mut out = Bytes::new();
    operator.say(RobotId(2), &order(2), &mut out).unwrap();
    assert_eq!(read(&mut listener, &out), Ok(order(2)));
    assert_eq!(read(&mut listener, &out), Err(DecodeError::Replayed));
    let ack = Message::Ack(Ack { to: RobotId(2), boot: 0, number: 1 });
    let frame = said(&mut insider, 1, 7, &ack);
    assert_eq!(read(&mut listener, &frame), Ok(ack));
}

#[test]
fn counters_used_up_by_an_insider_are_free_with_the_next_key() {
    let mut operator = operator();
    let (mut sender, mut listener) = (robot(1, 0, 0), robot(2, 0, 0));
    let mut insider = robot(3, 0, 1000);
    let lie = said(&mut insider, 1, 0, &beacon());
    assert!(read(&mut listener, &lie).is_ok());
    assert_eq!(read(&mut listener, &said(&mut sender, 1, 1, &beacon())), Err(DecodeError::Replayed), "shut out");
    for (id, robot) in [(1, &mut sender), (2, &mut listener)] {
        assert!(read(robot, &key(&mut operator, id, 1, KeyPhase::Forget)).is_ok());
    }
    assert!(read(&mut listener, &said(&mut sender, 1, 2, &beacon())).is_ok());
}

#[test]
fn a_robot_that_was_off_needs_one_message() {
    let mut operator = operator();
    let mut late = robot(1, 0, 4);
    assert!(read(&mut late, &key(&mut operator, 1, 7, KeyPhase::Forget)).is_ok());
    assert_eq!((late.held(), late.ring().generation()), (Some((7, KeyPhase::Forget)), 7));
    let [Some((generation, seed)), None] = late.ring().seeds() else {
        panic!("one seed");
    };
    let again = Ring::of_generation(generation, seed).with_own(&master().own_key(RobotId(1)));
    let mut again = Sealed::<8>::with_ring(again, RobotId(1), 5).unwrap();
    assert!(read(&mut again, &said(&mut late, 1, 9, &beacon())).is_ok());
    assert!(read(&mut again, &key(&mut operator, 1, 3, KeyPhase::Forget)).is_ok(), "it is the operator's");
    assert_eq!(again.held(), Some((7, KeyPhase::Forget)), "and changes nothing");
}

#[test]
fn the_operator_accepts_a_report_only_under_the_robots_own_key() {
    let mut operator = operator();
    let mut first = robot(1, 3, 0);
    let held = |to| Message::KeyHeld(KeyHeld { to, generation: 3, phase: KeyPhase::Forget });
    let frame = |wire: &mut Sealed<8>, sender, n, to| said(wire, sender, n, &held(to));
    let good = frame(&mut first, 1, 0, OPERATOR);
    let sent = |frame: &Bytes| frame[..frame.len() - 1].to_vec();
    assert_eq!(operator.hear(&sent(&good)).map(|(id, held)| (id, held.generation)), Ok((RobotId(1), 3)));
    assert_eq!(operator.hear(&sent(&good)), Err(DecodeError::Replayed));
    assert_eq!(
        operator.hear(&sent(&frame(&mut first, 2, 1, OPERATOR))),
        Err(DecodeError::Forged),
        "for another addressee"
    );
    assert_eq!(operator.hear(&sent(&frame(&mut first, 1, 2, RobotId(9)))), Err(DecodeError::Foreign));
    assert_eq!(operator.hear(&sent(&said(&mut first, 1, 3, &beacon()))), Err(DecodeError::Foreign));
    assert!(operator.hear(b"junk").is_err());
    assert!(ReplayGuard::<1>::new().newest(1).is_none());
}

proptest! {
    /// Robots also restart with their stored keys or with none.
    #[test]
    fn a_key_change_completes_despite_faults(steps in vec((0_u32..3, 1_u16..4, 0_u8..3, any::<u8>(), 0_usize..400), 0..60)) {
        let mut operator = operator();
        let mut robots: Vec<Sealed<8>> = (1..=3).map(|id| robot(id, 0, 0)).collect();
        let mut recorded = Vec::<Bytes>::new();
        let mut starts = 0;
        for (index, generation, phase, fate, at) in steps {
            let phase = [KeyPhase::Hear, KeyPhase::Speak, KeyPhase::Forget][usize::from(phase)];
            if index < 2 {
                recorded.push(key(&mut operator, index + 1, generation, phase));
            }
            let wire = &mut robots[index as usize];
            let before = wire.held().unwrap().0;
            match fate % 8 {
                0 => {}
                1 | 2 => {
                    starts += 1;
                    let [stored, _] = wire.ring().seeds();
                    let stored = stored.filter(|_| fate % 8 == 1).map_or(0, |(generation, _)| generation);
                    *wire = robot(index + 1, stored, starts);
                    continue;
                }
                3 => {
                    if let Some(frame) = recorded.last() {
                        let mut frame = frame.clone();
                        let at = at % (frame.len() - 1);
                        frame[at] = frame[at].wrapping_add(1).max(1);
                        prop_assert!(read(wire, &frame).is_err());
                        prop_assert_eq!(wire.held().unwrap().0, before);
                    }
                }
                _ => {
                    if let Some(frame) = recorded.get(recorded.len().saturating_sub(1 + at % 8)) {
                        let _ = read(wire, frame);
                    }
                }
            }
            let held = wire.held().unwrap().0;
            prop_assert!(held >= before);
            prop_assert!(index < 2 || held == 0, "the one that was left out");
        }
        for id in 1..=2 {
            let frame = key(&mut operator, id, 4, KeyPhase::Forget);
            prop_assert!(read(&mut robots[id as usize - 1], &frame).is_ok());
        }
        let frames: Vec<Bytes> = (0..3).map(|at| said(&mut robots[at], at as u32 + 1, 99, &beacon())).collect();
        prop_assert!(read(&mut robots[0], &frames[1]).is_ok() && read(&mut robots[1], &frames[0]).is_ok());
        prop_assert_eq!(read(&mut robots[0], &frames[2]), Err(DecodeError::Forged));
        prop_assert_eq!(read(&mut robots[2], &frames[0]), Err(DecodeError::Forged));
    }
}
