use super::*;
use crate::rand::Rng;
use crate::wire::{Due, Requests, Retry};
use RequestKind::{Redirect, Resume, Stop};
use proptest::prelude::*;
use std::vec::Vec as StdVec;

const MEMORY: Duration = Duration::from_millis(5_000);
const OWN: RobotId = RobotId(9);
const A: RobotId = RobotId(2);
const B: RobotId = RobotId(3);
/// The clock wraps within each test.
const START: Instant = Instant::from_micros(u32::MAX - 150_000);

fn after(millis: i32) -> Instant {
    START + Duration::from_millis(millis)
}

fn frame(sender: RobotId, boot: u8) -> Header {
    Header { boot, sender, sequence: 0 }
}

fn request(origin: RobotId, number: u8, kind: RequestKind, valid_ms: u16) -> Request {
    Request { to: OWN, origin, number, kind, valid_ms }
}

/// Returns (accepted, new).
fn receive<const S: usize>(
    orders: &mut Orders<S>,
    sender: RobotId,
    number: u8,
    kind: RequestKind,
    now: Instant,
) -> (bool, bool) {
    let request = request(sender, number, kind, 1_000);
    let answer = orders.receive(frame(sender, 0), &request, now);
    assert_eq!((answer.ack.to, answer.ack.boot), (sender, 0));
    assert_eq!(answer.ack.number, number);
    (answer.ack.accepted, answer.is_new)
}

const NEW: (bool, bool) = (true, true);
const REPEATED: (bool, bool) = (true, false);
const REFUSED: (bool, bool) = (false, false);

#[test]
fn a_stop_lasts_for_its_validity_and_repeats_do_not_prolong_it() {
    let mut orders = Orders::<2>::new(MEMORY);
    assert!(!orders.is_stopped(START));
    assert_eq!(receive(&mut orders, A, 7, Stop, START), NEW);
    assert_eq!(receive(&mut orders, A, 7, Stop, after(900)), REPEATED);
    assert_eq!(orders.stopped_until(after(900)), Some(after(1_000)));
    assert!(orders.is_stopped(after(999)));
    assert!(!orders.is_stopped(after(1_000)));
    assert_eq!(receive(&mut orders, A, 7, Stop, after(2_000)), REPEATED);
    assert!(!orders.is_stopped(after(2_000)));
    assert_eq!(receive(&mut orders, A, 8, Stop, after(2_000)), NEW);
    assert!(orders.is_stopped(after(2_999)));
}

#[test]
fn resume_lifts_the_stop_of_its_own_origin_only() {
    let mut orders = Orders::<4>::new(MEMORY);
    // A asks for itself and passes on the stop of B; B also asks directly.
    for (sender, origin, number) in [(A, A, 1), (A, B, 2), (B, B, 1)] {
        let stop = request(origin, number, Stop, 1_000);
        assert!(orders.receive(frame(sender, 0), &stop, START).is_new);
    }
    for (sender, origin, number, stopped) in [(A, B, 3, true), (B, B, 2, true), (A, A, 4, false)] {
        let resume = request(origin, number, Resume, 1_000);
        assert!(orders.receive(frame(sender, 0), &resume, START).is_new);
        assert_eq!(orders.is_stopped(START), stopped);
    }
}

#[test]
fn the_robot_is_stopped_until_the_last_active_stop_ends() {
    let mut orders = Orders::<2>::new(MEMORY);
    let long = request(A, 1, Stop, u16::MAX);
    assert!(orders.receive(frame(A, 0), &long, START).is_new);
    assert_eq!(receive(&mut orders, B, 1, Stop, START), NEW);
    assert_eq!(orders.stopped_until(START), Some(after(65_535)));
    assert!(orders.is_stopped(after(65_534)));
    assert!(!orders.is_stopped(after(65_535)));
    let none = request(B, 2, Stop, 0);
    assert!(orders.receive(frame(B, 0), &none, START).is_new);
    assert!(!orders.is_stopped(after(65_535)));
}

#[test]
fn a_stop_that_comes_after_the_resume_sent_later_is_ignored() {
    for number in [1, 127, 255, 0] {
        let mut orders = Orders::<2>::new(MEMORY);
        let resume = u8::wrapping_add(number, 1);
        assert_eq!(receive(&mut orders, A, resume, Resume, START), NEW);
        assert_eq!(receive(&mut orders, A, number, Stop, after(10)), REFUSED);
        assert!(!orders.is_stopped(after(10)));
        assert_eq!(receive(&mut orders, A, number, Redirect, after(10)), NEW);
        assert_eq!(receive(&mut orders, A, number, Redirect, after(20)), REPEATED);
    }
}

#[test]
fn a_number_more_than_32_behind_counts_as_new() {
    for (behind, expected) in [(0, REPEATED), (1, REFUSED), (32, REFUSED), (33, NEW)] {
        let mut orders = Orders::<1>::new(MEMORY);
        receive(&mut orders, A, 20, Resume, START);
        let number = u8::wrapping_sub(20, behind);
        assert_eq!(receive(&mut orders, A, number, Resume, START), expected);
    }
}

#[test]
fn a_request_is_remembered_until_its_repeats_cease() {
    let mut orders = Orders::<1>::new(MEMORY);
    assert_eq!(receive(&mut orders, A, 1, Redirect, START), NEW);
    assert_eq!(receive(&mut orders, A, 1, Redirect, after(4_999)), REPEATED);
    assert_eq!(receive(&mut orders, A, 1, Redirect, after(9_998)), REPEATED);
    assert_eq!(receive(&mut orders, A, 1, Redirect, after(14_998)), NEW);
}

#[test]
fn a_restarted_sender_may_use_any_number_and_its_old_requests_can_be_dropped() {
    let mut orders = Orders::<3>::new(MEMORY);
    let stop = request(A, 5, Stop, 1_000);
    assert!(orders.receive(frame(A, 0), &stop, START).is_new);
    assert!(orders.receive(frame(A, 1), &stop, START).is_new);
    assert!(!orders.receive(frame(A, 1), &stop, START).is_new);
    assert_eq!(receive(&mut orders, B, 5, Stop, START), NEW);
    orders.forget(A);
    assert!(orders.is_stopped(START));
    orders.forget(B);
    assert!(!orders.is_stopped(START));
}

#[test]
fn entries_without_a_stop_are_evicted_when_the_table_is_full() {
    let mut none = Orders::<0>::new(MEMORY);
    assert_eq!(receive(&mut none, A, 1, Stop, START), REFUSED);
    assert_eq!(receive(&mut none, A, 2, Resume, START), REPEATED);
    assert!(!none.is_stopped(START));

    let mut orders = Orders::<2>::new(MEMORY);
    assert_eq!(receive(&mut orders, A, 1, Stop, START), NEW);
    assert_eq!(receive(&mut orders, A, 2, Redirect, after(1)), NEW);
    // The redirection is evicted, although it was received last.
    assert_eq!(receive(&mut orders, B, 1, Stop, after(2)), NEW);
    let full = orders.clone();
    let third = RobotId(4);
    assert_eq!(receive(&mut orders, third, 1, Stop, after(3)), REFUSED);
    assert_eq!(receive(&mut orders, third, 2, Redirect, after(3)), REFUSED);
    assert_eq!(receive(&mut orders, third, 3, Resume, after(3)), REPEATED);
    assert_eq!(orders, full);
    assert_eq!(receive(&mut orders, A, 3, Resume, after(3)), NEW);
    assert_eq!(receive(&mut orders, third, 4, Stop, after(3)), NEW);
    assert_eq!(receive(&mut orders, B, 2, Resume, after(3)), NEW);
    assert_eq!(orders.stopped_until(after(3)), Some(after(1_003)));
}

#[test]
fn of_two_entries_without_a_stop_the_staler_is_evicted() {
    let mut orders = Orders::<2>::new(MEMORY);
    receive(&mut orders, A, 1, Resume, START);
    receive(&mut orders, B, 1, Resume, after(1));
    receive(&mut orders, A, 1, Resume, after(2));
    receive(&mut orders, RobotId(4), 1, Stop, after(3));
    assert_eq!(receive(&mut orders, A, 1, Resume, after(4)), REPEATED);
    assert_eq!(receive(&mut orders, B, 1, Resume, after(5)), NEW);
}

/// Loses, duplicates and delays packets, so that they overtake each other.
struct Radio {
    rng: Rng,
    loss_percent: u32,
    longest_ms: u32,
}

impl Radio {
    fn carry<T: Copy>(&mut self, packet: T, now: i32, air: &mut StdVec<(i32, T)>) {
        for _ in 0..1 + self.rng.below(2) {
            if self.rng.below(100) >= self.loss_percent {
                air.push((now + 1 + self.rng.below(self.longest_ms) as i32, packet));
            }
        }
    }

    fn arrived<T: Copy>(air: &mut StdVec<(i32, T)>, now: i32) -> StdVec<T> {
        let packets = air.iter().filter(|p| p.0 <= now).map(|p| p.1).collect();
        air.retain(|p| p.0 > now);
        packets
    }
}

struct Asked {
    kind: RequestKind,
    valid_ms: i32,
    sends: u32,
    delivered: Option<i32>,
    /// Acknowledged, replaced or expired.
    ends: u32,
    expired: bool,
}

/// Random requests for 20 s, compared with a model. Returns how many expired.
fn converse(mut radio: Radio, start: Instant) -> u32 {
    let retry = Retry::default();
    let mut requests = Requests::<4>::new(A, 3, retry);
    let mut orders = Orders::<4>::new(MEMORY);
    let mut asked: StdVec<Asked> = StdVec::new();
    let mut places = [usize::MAX; 256];
    let (mut to_b, mut to_a) = (StdVec::new(), StdVec::new());
    let mut decisive: Option<usize> = None;

    for millis in (0..40_000).step_by(10) {
        let now = start + Duration::from_millis(millis);
        if millis < 20_000 && radio.rng.below(25) == 0 {
            let kind = [Stop, Resume, Redirect][radio.rng.below(3) as usize];
            let valid_ms = 300 + radio.rng.below(5_000) as u16;
            let older = requests.clone();
            let number = requests.ask(OWN, A, kind, valid_ms, now).unwrap();
            if requests != older {
                if kind.is_standing() && requests.len() == older.len() {
                    let replaced = asked.iter_mut().rfind(|a| a.kind.is_standing() && a.ends == 0);
                    replaced.unwrap().ends += 1;
                }
                places[usize::from(number)] = asked.len();
                asked.push(Asked {
                    kind,
                    valid_ms: valid_ms.into(),
                    sends: 0,
                    delivered: None,
                    ends: 0,
                    expired: false,
                });
            }
        }
        while let Some(due) = requests.poll(now) {
            match due {
                Due::Send(request) => {
                    let place = places[usize::from(request.number)];
                    asked[place].sends += 1;
                    radio.carry((place, request), millis, &mut to_b);
                }
                Due::Expired(request) => {
                    let place = places[usize::from(request.number)];
                    asked[place].ends += 1;
                    asked[place].expired = true;
                }
            }
        }
        for (place, request) in Radio::arrived(&mut to_b, millis) {
            let answer = orders.receive(frame(A, 3), &request, now);
            let standing = request.kind.is_standing();
            let is_latest =
                !asked[place + 1..].iter().any(|a| a.kind.is_standing() == standing && a.delivered.is_some());
            let first = asked[place].delivered.is_none();
            assert_eq!(answer.is_new, first && is_latest, "request {place}");
            assert_eq!(answer.ack.accepted, is_latest);
            asked[place].delivered.get_or_insert(millis);
            if answer.is_new && standing {
                decisive = Some(place);
            }
            radio.carry(answer.ack, millis, &mut to_a);
        }
        for ack in Radio::arrived(&mut to_a, millis) {
            if requests.acknowledged(OWN, &ack).is_some() {
                let place = places[usize::from(ack.number)];
                assert!(asked[place].delivered.is_some());
                asked[place].ends += 1;
            }
        }
        let stopped = decisive.is_some_and(|place| {
            let stop = &asked[place];
            stop.kind == Stop && millis < stop.delivered.unwrap() + stop.valid_ms
        });
        assert_eq!(orders.is_stopped(now), stopped, "at {millis} ms");
    }
    assert!(requests.is_empty() && asked.len() > 10);
    for request in &asked {
        assert_eq!(request.ends, 1);
        assert!(request.sends <= u32::from(retry.attempts));
    }
    asked.iter().map(|request| u32::from(request.expired)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn over_any_radio_each_request_acts_once_and_the_last_one_prevails(
        seed in any::<u64>(), start in any::<u32>(), loss_percent in 0..=100_u32,
        longest_ms in 1..600_u32,
    ) {
        let radio = Radio { rng: Rng::new(seed), loss_percent, longest_ms };
        converse(radio, Instant::from_micros(start));
    }

    #[test]
    fn over_a_lossless_radio_no_request_expires(
        seed in any::<u64>(), longest_ms in 1..90_u32,
    ) {
        let radio = Radio { rng: Rng::new(seed), loss_percent: 0, longest_ms };
        prop_assert_eq!(converse(radio, START), 0);
    }
}
