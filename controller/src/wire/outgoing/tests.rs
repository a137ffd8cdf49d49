use super::*;
use std::vec::Vec as StdVec;

const OWN: RobotId = RobotId(1);
const A: RobotId = RobotId(2);
const B: RobotId = RobotId(3);
const PROTOCOL: ProtocolId = ProtocolId(70);
/// The clock wraps within each test.
const START: Instant = Instant::from_micros(u32::MAX - 150_000);

/// Subject and content.
type Said = (u32, [u8; 1]);
const STOP: Said = (2, [0]);
const RESUME: Said = (2, [1]);
const REDIRECT: Said = (0, [2]);

fn after(millis: i32) -> Instant {
    START + Duration::from_millis(millis)
}

fn messages<const C: usize>() -> OutgoingMessages<C> {
    OutgoingMessages::new(OWN, 0, Retry::default())
}

fn send<const C: usize>(
    messages: &mut OutgoingMessages<C>,
    to: RobotId,
    (subject, content): Said,
    valid_ms: i32,
    now: Instant,
) -> Result<(), SendError> {
    messages.send(to, subject, (PROTOCOL, &content.into()), Duration::from_millis(valid_ms), now)
}

fn ack(number: u8) -> Ack {
    Ack { to: OWN, boot: 0, number }
}

fn poll<const C: usize>(messages: &mut OutgoingMessages<C>, now: Instant) -> StdVec<Due> {
    let all: StdVec<_> = core::iter::from_fn(|| messages.poll(now)).collect();
    assert!(all.len() <= 2 * C);
    all
}

/// Addressees and numbers.
fn sent(due: &[Due]) -> StdVec<(RobotId, u8)> {
    let number = |due: &Due| match due {
        Due::Send(message) => Some((message.to, message.number)),
        Due::Expired(_) => None,
    };
    due.iter().filter_map(number).collect()
}

#[test]
fn a_message_is_sent_at_once_and_then_once_per_interval() {
    let mut messages = messages::<2>();
    assert_eq!(messages.poll_at(START), None);
    send(&mut messages, A, STOP, 60_000, START).unwrap();
    assert_eq!(messages.poll_at(START), Some(START));
    let expected = || Addressed { to: A, number: 0, protocol: PROTOCOL, content: STOP.1.into() };
    assert_eq!(poll(&mut messages, START), [Due::Send(expected())]);
    for millis in 0..200 {
        assert_eq!(poll(&mut messages, after(millis)), []);
    }
    let again = messages.poll_at(START).unwrap();
    assert!(!again.is_before(after(200)) && again.is_before(after(250)));
    let before = again - Duration::from_micros(1);
    assert_eq!(poll(&mut messages, before), []);
    assert_eq!(poll(&mut messages, again), [Due::Send(expected())]);
}

#[test]
fn a_message_of_the_greatest_length_is_sent_unchanged() {
    let mut messages = messages::<1>();
    let content: Bytes<MAX_MESSAGE> = (0..MAX_MESSAGE as u8).collect();
    messages.send(A, u32::MAX, (PROTOCOL, &content), Duration::from_millis(1), START).unwrap();
    let Some(Due::Send(message)) = messages.poll(START) else { panic!("a message") };
    assert_eq!(message.content, content);
}

/// After more than half of the clock's range a past moment seems to lie ahead.
#[test]
fn a_message_is_due_at_once_after_a_long_pause() {
    let mut messages = messages::<2>();
    send(&mut messages, A, STOP, 60_000, START).unwrap();
    assert_eq!(poll(&mut messages, START).len(), 1);
    let due = messages.poll_at(START).unwrap();
    for now in [after(100), due - Duration::from_micros(1)] {
        assert_eq!(messages.poll_at(now), Some(due), "not yet");
    }
    assert_eq!(messages.poll_at(after(i32::MAX / 1000)), Some(due), "due long ago");
    let late = after(i32::MAX / 1000) + Duration::from_millis(600_000);
    assert!(late.is_before(due));
    assert_eq!(messages.poll_at(late), Some(late));
    assert!(messages.poll(late).is_some());
}

#[test]
fn an_unacknowledged_message_expires_after_all_attempts() {
    for attempts in [0, 1, 2, 5] {
        let retry = Retry { attempts, ..Retry::default() };
        let mut messages = OutgoingMessages::<1>::new(OWN, 0, retry);
        send(&mut messages, A, REDIRECT, 65_535, START).unwrap();
        let mut all = StdVec::new();
        while let Some(at) = messages.poll_at(START) {
            all.extend(poll(&mut messages, at));
        }
        let (last, sends) = all.split_last().unwrap();
        assert_eq!(last, &Due::Expired(A));
        assert_eq!(sent(sends).len(), usize::from(attempts.max(1)));
    }
}

#[test]
fn a_message_expires_with_its_validity_but_not_before_its_first_send() {
    let mut messages = messages::<1>();
    for valid_ms in [0, 300] {
        send(&mut messages, A, STOP, valid_ms, START).unwrap();
        let late = poll(&mut messages, after(400));
        assert_eq!(late.len(), 2);
        assert!(matches!(late.as_slice(), [Due::Send(_), Due::Expired(A)]));
        assert!(messages.is_empty());
    }
    send(&mut messages, A, STOP, 300, START).unwrap();
    assert_eq!(poll(&mut messages, START).len(), 1);
    assert_eq!(sent(&poll(&mut messages, after(250))).len(), 1);
    assert_eq!(messages.poll_at(after(250)), Some(after(300)));
    assert!(matches!(poll(&mut messages, after(300)).as_slice(), [Due::Expired(A)]));
}

#[test]
fn an_acknowledgement_ends_its_message_and_no_other() {
    let mut messages = messages::<3>();
    send(&mut messages, A, STOP, 1_000, START).unwrap();
    send(&mut messages, B, STOP, 1_000, START).unwrap();
    let [(A, a), (B, b)] = sent(&poll(&mut messages, START))[..] else { panic!("two messages") };
    assert_ne!(a, b);
    assert!(!messages.acknowledged(A, &ack(b)));
    assert!(!messages.acknowledged(OWN, &ack(a)));
    assert_eq!(messages.len(), 2);
    assert!(messages.acknowledged(A, &ack(a)));
    assert!(!messages.acknowledged(A, &ack(a)));
    assert_eq!(sent(&poll(&mut messages, after(250))), [(B, b)]);
}

#[test]
fn a_repeated_message_changes_nothing_and_its_opposite_replaces_it() {
    let mut messages = messages::<5>();
    send(&mut messages, A, STOP, 1_000, START).unwrap();
    let [(_, stop)] = sent(&poll(&mut messages, START))[..] else { panic!("a message") };
    let before = messages.clone();
    assert_eq!(send(&mut messages, A, STOP, 9, after(50)), Ok(()));
    assert_eq!((poll(&mut messages, after(50)).len(), &messages), (0, &before));
    send(&mut messages, A, RESUME, 1_000, after(60)).unwrap();
    assert_eq!(messages.len(), 1);
    let [(A, resume)] = sent(&poll(&mut messages, after(60)))[..] else { panic!("a message") };
    assert_ne!(resume, stop);
    assert!(!messages.acknowledged(A, &ack(stop)));
    send(&mut messages, A, REDIRECT, 1_000, after(60)).unwrap();
    send(&mut messages, A, (3, STOP.1), 1_000, after(60)).unwrap();
    send(&mut messages, B, STOP, 1_000, after(60)).unwrap();
    let other = (ProtocolId(71), &RESUME.1.into());
    messages.send(A, RESUME.0, other, Duration::from_millis(1_000), after(60)).unwrap();
    assert_eq!(messages.len(), 5, "other subjects, robots and protocols");
}

#[test]
fn a_full_table_refuses_new_subjects_but_still_replaces() {
    let mut none = messages::<0>();
    assert_eq!(send(&mut none, A, STOP, 1, START), Err(SendError::Full));
    assert_eq!(none.poll(START), None);
    let mut one = messages::<1>();
    send(&mut one, A, STOP, 1_000, START).unwrap();
    let before = one.clone();
    assert_eq!(send(&mut one, B, STOP, 1_000, START), Err(SendError::Full));
    assert_eq!(one, before);
    assert!(send(&mut one, A, RESUME, 1_000, START).is_ok());
    assert_eq!(send(&mut one, RobotId::NONE, STOP, 1_000, START), Err(SendError::NoAddressee));
}

#[test]
fn a_pending_number_is_not_reused_when_numbers_wrap() {
    let mut messages = messages::<2>();
    send(&mut messages, A, STOP, 1_000, START).unwrap();
    let [(_, kept)] = sent(&poll(&mut messages, START))[..] else { panic!("a message") };
    let mut previous = kept;
    for round in 0..600 {
        let said = if round & 1 == 0 { STOP } else { RESUME };
        send(&mut messages, B, said, 1_000, START).unwrap();
        let [(B, number)] = sent(&poll(&mut messages, START))[..] else { panic!("a message") };
        assert!(number != kept && number != previous);
        previous = number;
    }
}

#[test]
fn an_acknowledgement_for_another_boot_or_robot_ends_nothing() {
    for boot in [1, 0, u8::MAX] {
        let mut messages = OutgoingMessages::<1>::new(OWN, boot, Retry::default());
        send(&mut messages, A, STOP, 1, START).unwrap();
        let right = Ack { boot, ..ack(0) };
        for wrong in [Ack { to: B, ..right }, Ack { boot: boot.wrapping_sub(1), ..right }] {
            assert!(!messages.acknowledged(A, &wrong));
        }
        assert!(messages.acknowledged(A, &right));
        messages.set_boot(boot.wrapping_add(1));
        send(&mut messages, A, STOP, 1, START).unwrap();
        assert!(!messages.acknowledged(A, &Ack { number: 1, ..right }));
        assert!(messages.acknowledged(A, &Ack { boot: boot.wrapping_add(1), ..ack(1) }));
    }
}

#[test]
fn the_maximum_number_of_messages_have_different_numbers() {
    let mut messages = messages::<128>();
    for to in 1..=128 {
        send(&mut messages, RobotId(to), STOP, 1_000, START).unwrap();
    }
    let mut numbers: StdVec<u8> = sent(&poll(&mut messages, START)).into_iter().map(|(_, number)| number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), 128);
    assert_eq!(send(&mut messages, RobotId(200), STOP, 1_000, START), Err(SendError::Full));
}

#[test]
fn polling_ends_with_an_extreme_retry_policy() {
    for interval in [Duration::ZERO, Duration::from_micros(-5), Duration::MAX] {
        let retry = Retry { attempts: 255, interval };
        let mut messages = OutgoingMessages::<1>::new(OWN, 0, retry);
        send(&mut messages, A, STOP, 1_000, START).unwrap();
        let sends = core::iter::from_fn(|| messages.poll(START)).count();
        assert!((1..=256).contains(&sends));
        let end = core::iter::from_fn(|| messages.poll(after(1_000))).last();
        assert!(messages.is_empty() || matches!(end, Some(Due::Expired(_))));
    }
}
