use super::*;
use RequestKind::{Redirect, Resume, Stop};
use std::vec::Vec as StdVec;

const OWN: RobotId = RobotId(1);
const A: RobotId = RobotId(2);
const B: RobotId = RobotId(3);
/// The clock wraps within each test.
const START: Instant = Instant::from_micros(u32::MAX - 150_000);

fn after(millis: i32) -> Instant {
    START + Duration::from_millis(millis)
}

fn requests<const P: usize>() -> Requests<P> {
    Requests::new(OWN, 0, Retry::default())
}

fn ack(number: u8) -> Ack {
    Ack { to: OWN, boot: 0, number, accepted: true }
}

fn poll<const P: usize>(requests: &mut Requests<P>, now: Instant) -> StdVec<Due> {
    let all: StdVec<_> = core::iter::from_fn(|| requests.poll(now)).collect();
    assert!(all.len() <= 2 * P);
    all
}

fn sent(due: &[Due]) -> StdVec<u8> {
    let number = |due: &Due| match due {
        Due::Send(request) => Some(request.number),
        Due::Expired(_) => None,
    };
    due.iter().filter_map(number).collect()
}

#[test]
fn a_request_is_sent_at_once_and_then_once_per_interval() {
    let mut requests = requests::<2>();
    assert_eq!(requests.poll_at(START), None);
    let number = requests.ask(A, OWN, Stop, 60_000, START).unwrap();
    assert_eq!(requests.poll_at(START), Some(START));
    let expected = Request { to: A, origin: OWN, number, kind: Stop, valid_ms: 60_000 };
    assert_eq!(poll(&mut requests, START), [Due::Send(expected)]);
    for millis in 0..200 {
        assert_eq!(poll(&mut requests, after(millis)), []);
    }
    let again = requests.poll_at(START).unwrap();
    assert!(!again.is_before(after(200)) && again.is_before(after(250)));
    let before = again - Duration::from_micros(1);
    assert_eq!(poll(&mut requests, before), []);
    assert_eq!(poll(&mut requests, again), [Due::Send(expected)]);
}

/// After more than half of the clock's range a past moment seems to lie ahead.
#[test]
fn a_request_is_due_at_once_after_a_long_pause() {
    let mut requests = requests::<2>();
    requests.ask(A, OWN, Stop, 60_000, START).unwrap();
    assert_eq!(poll(&mut requests, START).len(), 1);
    let due = requests.poll_at(START).unwrap();
    for now in [after(100), due - Duration::from_micros(1)] {
        assert_eq!(requests.poll_at(now), Some(due), "not yet");
    }
    assert_eq!(requests.poll_at(after(i32::MAX / 1000)), Some(due), "due long ago");
    let late = after(i32::MAX / 1000) + Duration::from_millis(600_000);
    assert!(late.is_before(due));
    assert_eq!(requests.poll_at(late), Some(late));
    assert!(requests.poll(late).is_some());
}

#[test]
fn an_unacknowledged_request_expires_after_all_attempts() {
    for attempts in [0, 1, 2, 5] {
        let retry = Retry { attempts, ..Retry::default() };
        let mut requests = Requests::<1>::new(OWN, 0, retry);
        requests.ask(A, OWN, Redirect, u16::MAX, START).unwrap();
        let mut all = StdVec::new();
        while let Some(at) = requests.poll_at(START) {
            all.extend(poll(&mut requests, at));
        }
        let (last, sends) = all.split_last().unwrap();
        assert!(matches!(last, Due::Expired(request) if request.kind == Redirect));
        assert_eq!(sent(sends).len(), usize::from(attempts.max(1)));
    }
}

#[test]
fn a_request_expires_with_its_validity_but_not_before_its_first_send() {
    let mut requests = requests::<1>();
    for valid_ms in [0, 300] {
        requests.ask(A, OWN, Stop, valid_ms, START).unwrap();
        let late = poll(&mut requests, after(400));
        assert_eq!(late.len(), 2);
        assert!(matches!(late.as_slice(), [Due::Send(_), Due::Expired(_)]));
        assert!(requests.is_empty());
    }
    requests.ask(A, OWN, Stop, 300, START).unwrap();
    assert_eq!(poll(&mut requests, START).len(), 1);
    assert_eq!(sent(&poll(&mut requests, after(250))).len(), 1);
    assert_eq!(requests.poll_at(after(250)), Some(after(300)));
    assert!(matches!(poll(&mut requests, after(300)).as_slice(), [Due::Expired(_)]));
}

#[test]
fn an_acknowledgement_ends_its_request_and_no_other() {
    let mut requests = requests::<3>();
    let a = requests.ask(A, OWN, Stop, 1_000, START).unwrap();
    let b = requests.ask(B, OWN, Stop, 1_000, START).unwrap();
    assert_ne!(a, b);
    assert_eq!(requests.acknowledged(A, &ack(b)), None);
    assert_eq!(requests.acknowledged(OWN, &ack(a)), None);
    assert_eq!(requests.len(), 2);
    assert_eq!(requests.acknowledged(A, &ack(a)).map(|r| r.to), Some(A));
    assert_eq!(requests.acknowledged(A, &ack(a)), None);
    assert_eq!(sent(&poll(&mut requests, START)), [b]);
}

#[test]
fn a_repeated_request_changes_nothing_and_its_opposite_replaces_it() {
    let mut requests = requests::<3>();
    let stop = requests.ask(A, OWN, Stop, 1_000, START).unwrap();
    poll(&mut requests, START);
    assert_eq!(requests.ask(A, OWN, Stop, 9, after(50)), Ok(stop));
    assert_eq!(poll(&mut requests, after(50)), []);
    let resume = requests.ask(A, OWN, Resume, 1_000, after(60)).unwrap();
    assert_ne!(resume, stop);
    assert_eq!(requests.len(), 1);
    assert_eq!(sent(&poll(&mut requests, after(60))), [resume]);
    assert_eq!(requests.acknowledged(A, &ack(stop)), None);
    requests.ask(A, OWN, Redirect, 1_000, after(60)).unwrap();
    requests.ask(A, B, Stop, 1_000, after(60)).unwrap();
    assert_eq!(requests.len(), 3);
}

#[test]
fn a_full_table_refuses_new_matters_but_still_replaces() {
    let mut none = requests::<0>();
    assert_eq!(none.ask(A, OWN, Stop, 1, START), Err(AskError::Full));
    assert_eq!(none.poll(START), None);
    let mut one = requests::<1>();
    one.ask(A, OWN, Stop, 1_000, START).unwrap();
    let before = one.clone();
    assert_eq!(one.ask(B, OWN, Stop, 1_000, START), Err(AskError::Full));
    assert_eq!(one, before);
    assert!(one.ask(A, OWN, Resume, 1_000, START).is_ok());
    let refused = one.ask(RobotId::NONE, OWN, Stop, 1_000, START);
    assert_eq!(refused, Err(AskError::NoAddressee));
}

#[test]
fn a_pending_number_is_not_reused_when_numbers_wrap() {
    let mut requests = requests::<2>();
    let kept = requests.ask(A, OWN, Stop, 1_000, START).unwrap();
    let mut previous = kept;
    for round in 0..600 {
        let kind = if round & 1 == 0 { Stop } else { Resume };
        let number = requests.ask(B, OWN, kind, 1_000, START).unwrap();
        assert!(number != kept && number != previous);
        previous = number;
    }
}

#[test]
fn an_acknowledgement_for_another_boot_or_robot_ends_nothing() {
    for boot in [1, 0, u8::MAX] {
        let mut requests = Requests::<1>::new(OWN, boot, Retry::default());
        let number = requests.ask(A, OWN, Stop, 1, START).unwrap();
        let right = Ack { boot, ..ack(number) };
        for wrong in [Ack { to: B, ..right }, Ack { boot: boot.wrapping_sub(1), ..right }] {
            assert_eq!(requests.acknowledged(A, &wrong), None);
        }
        assert!(requests.acknowledged(A, &right).is_some());
    }
}

#[test]
fn the_maximum_number_of_requests_have_different_numbers() {
    let mut requests = requests::<128>();
    let mut numbers: StdVec<u8> =
        (1..=128).map(|to| requests.ask(RobotId(to), OWN, Stop, 1_000, START).unwrap()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), 128);
    let one_more = requests.ask(RobotId(200), OWN, Stop, 1_000, START);
    assert_eq!(one_more, Err(AskError::Full));
}

#[test]
fn polling_ends_with_an_extreme_retry_policy() {
    for interval in [Duration::ZERO, Duration::from_micros(-5), Duration::MAX] {
        let retry = Retry { attempts: 255, interval };
        let mut requests = Requests::<1>::new(OWN, 0, retry);
        requests.ask(A, OWN, Stop, 1_000, START).unwrap();
        let sends = core::iter::from_fn(|| requests.poll(START)).count();
        assert!((1..=256).contains(&sends));
        let end = core::iter::from_fn(|| requests.poll(after(1_000))).last();
        assert!(requests.is_empty() || matches!(end, Some(Due::Expired(_))));
    }
}
