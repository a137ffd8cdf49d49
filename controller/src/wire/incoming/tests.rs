use super::*;
use crate::rand::Rng;
use crate::wire::{Ack, Addressed, Due, OutgoingMessages, ProtocolId, Retry};
use proptest::prelude::*;
use std::vec::Vec as StdVec;

const MEMORY: Duration = Duration::from_millis(5_000);
const OWN: RobotId = RobotId(9);
const A: RobotId = RobotId(2);
const B: RobotId = RobotId(3);
const THIRD: RobotId = RobotId(4);
/// The clock wraps within each test.
const START: Instant = Instant::from_micros(u32::MAX - 150_000);

fn after(millis: i32) -> Instant {
    START + Duration::from_millis(millis)
}

fn frame(sender: RobotId, boot: u8) -> Header {
    Header { boot, sender, sequence: 0 }
}

/// Takes a message, unless it is a repeat.
fn receive_in<const C: usize>(
    messages: &mut IncomingMessages<C>,
    header: Header,
    number: u8,
    subject: u32,
    now: Instant,
) -> bool {
    let is_repeat = messages.is_repeat(header, number, subject, now);
    if !is_repeat {
        messages.note(header, number, subject, now);
    }
    !is_repeat
}

/// The same for the first start of `sender`.
fn receive<const C: usize>(
    messages: &mut IncomingMessages<C>,
    sender: RobotId,
    number: u8,
    subject: u32,
    now: Instant,
) -> bool {
    receive_in(messages, frame(sender, 0), number, subject, now)
}

#[test]
fn a_message_is_new_once_and_its_repeats_are_not() {
    let mut messages = IncomingMessages::<2>::new(MEMORY);
    assert!(receive(&mut messages, A, 7, 1, START));
    for millis in [0, 900, 2_000] {
        assert!(!receive(&mut messages, A, 7, 1, after(millis)));
    }
    assert!(receive(&mut messages, A, 8, 1, after(2_000)));
    assert!(receive(&mut messages, B, 8, 1, after(2_000)), "of another robot");
}

#[test]
fn a_message_that_comes_after_one_sent_later_is_ignored_unless_its_subject_differs() {
    for number in [1, 127, 255, 0] {
        let mut messages = IncomingMessages::<2>::new(MEMORY);
        let later = u8::wrapping_add(number, 1);
        assert!(receive(&mut messages, A, later, 1, START));
        assert!(!receive(&mut messages, A, number, 1, after(10)));
        assert!(receive(&mut messages, A, number, 0, after(10)));
        assert!(!receive(&mut messages, A, number, 0, after(20)));
    }
}

#[test]
fn a_number_more_than_32_behind_counts_as_new() {
    for (behind, is_new) in [(0, false), (1, false), (32, false), (33, true)] {
        let mut messages = IncomingMessages::<1>::new(MEMORY);
        assert!(receive(&mut messages, A, 20, 1, START));
        let number = u8::wrapping_sub(20, behind);
        assert_eq!(receive(&mut messages, A, number, 1, START), is_new);
    }
}

#[test]
fn a_message_is_remembered_until_its_repeats_cease() {
    let mut messages = IncomingMessages::<1>::new(MEMORY);
    assert!(receive(&mut messages, A, 1, 0, START));
    assert!(!receive(&mut messages, A, 1, 0, after(4_999)));
    assert!(!receive(&mut messages, A, 1, 0, after(9_998)));
    assert!(receive(&mut messages, A, 1, 0, after(14_998)));
}

#[test]
fn a_restarted_sender_may_use_any_number_and_its_old_messages_can_be_dropped() {
    let mut messages = IncomingMessages::<3>::new(MEMORY);
    assert!(receive_in(&mut messages, frame(A, 0), 5, 1, START));
    assert!(receive_in(&mut messages, frame(A, 1), 5, 1, START));
    assert!(!receive_in(&mut messages, frame(A, 1), 5, 1, START));
    assert!(receive(&mut messages, B, 5, 1, START));
    messages.forget(A);
    assert!(!receive(&mut messages, B, 5, 1, START));
    assert!(receive_in(&mut messages, frame(A, 1), 5, 1, START));
    messages.forget(A);
    messages.forget(B);
    assert_eq!(messages, IncomingMessages::new(MEMORY));
}

#[test]
fn a_full_table_drops_the_entry_that_was_heard_longest_ago() {
    let mut none = IncomingMessages::<0>::new(MEMORY);
    assert!([0, 1].into_iter().all(|_| receive(&mut none, A, 1, 1, START)), "without room repeats count as new");
    let mut messages = IncomingMessages::<2>::new(MEMORY);
    assert!(receive(&mut messages, A, 1, 1, START));
    assert!(receive(&mut messages, B, 1, 1, after(1)));
    // A repeat counts.
    assert!(!receive(&mut messages, A, 1, 1, after(2)));
    assert!(receive(&mut messages, THIRD, 1, 1, after(3)));
    assert!(!receive(&mut messages, A, 1, 1, after(4)));
    assert!(receive(&mut messages, B, 1, 1, after(5)));
    assert!(receive(&mut messages, THIRD, 1, 1, after(6)));
}

/// Whether an order is given to the law, which has a use for it.
fn gives<const C: usize>(orders: &mut IncomingOrders<C>, header: Header, number: u8, subject: u32) -> bool {
    let is_news = orders.is_news(header, number, Some(subject));
    if is_news {
        orders.note(header, number, subject);
    }
    is_news
}

#[test]
fn an_order_counts_once_and_older_ones_about_its_subject_do_not() {
    for first in [0, 100, 255] {
        let number = |ahead: u8| u8::wrapping_add(first, ahead);
        let mut orders = IncomingOrders::<2>::new();
        assert!(gives(&mut orders, frame(A, 0), first, 0));
        for (ahead, is_news) in [(0, false), (255, false), (128, false), (1, true), (0, false), (128, true), (1, false)]
        {
            assert_eq!(gives(&mut orders, frame(A, 0), number(ahead), 0), is_news, "{first} + {ahead}");
        }
        assert!(gives(&mut orders, frame(A, 0), first, 1), "another subject");
    }
}

#[test]
fn an_order_that_was_of_no_use_stays_news() {
    let orders = IncomingOrders::<2>::new();
    for _ in 0..3 {
        assert!(orders.is_news(frame(A, 0), 5, Some(0)));
    }
}

#[test]
fn orders_of_another_or_of_a_restarted_operator_count_at_any_number() {
    let mut orders = IncomingOrders::<2>::new();
    assert!(gives(&mut orders, frame(A, 0), 100, 0));
    for by in [frame(A, 1), frame(B, 1), frame(A, 0)] {
        assert!(gives(&mut orders, by, 7, 0));
        assert!(!gives(&mut orders, by, 7, 0));
        assert!(!gives(&mut orders, by, 6, 0));
    }
}

#[test]
fn an_order_without_a_subject_is_always_news_and_tells_a_change_of_its_operator() {
    let mut orders = IncomingOrders::<2>::new();
    assert!(gives(&mut orders, frame(A, 0), 3, 0));
    for (by, is_restarted) in [(A, true), (A, false), (B, true), (B, false), (A, true)] {
        for _ in 0..2 {
            assert!(orders.is_news(frame(by, 0), 3, None));
        }
        assert_eq!(orders.is_restarted(frame(by, 0)), is_restarted);
    }
    assert!(orders.is_restarted(frame(A, 1)));
    assert!(!gives(&mut orders, frame(A, 0), 3, 0), "the others are unchanged");
}

#[test]
fn a_full_table_of_orders_drops_the_subject_that_it_met_first() {
    let mut none = IncomingOrders::<0>::default();
    assert!(gives(&mut none, frame(A, 0), 1, 0) && gives(&mut none, frame(A, 0), 1, 0));
    let mut orders = IncomingOrders::<2>::default();
    for (number, subject) in [(1, 0), (1, 1), (2, 0), (1, 2)] {
        assert!(gives(&mut orders, frame(A, 0), number, subject));
    }
    assert!(!gives(&mut orders, frame(A, 0), 1, 1) && !gives(&mut orders, frame(A, 0), 1, 2));
    assert!(gives(&mut orders, frame(A, 0), 2, 0));
}

/// Loses, duplicates and delays packets, so that they overtake each other.
struct Radio {
    rng: Rng,
    loss_percent: u32,
    longest_ms: u32,
}

impl Radio {
    fn carry<T: Clone>(&mut self, packet: &T, now: i32, air: &mut StdVec<(i32, T)>) {
        for _ in 0..1 + self.rng.below(2) {
            if self.rng.below(100) >= self.loss_percent {
                air.push((now + 1 + self.rng.below(self.longest_ms) as i32, packet.clone()));
            }
        }
    }

    fn arrived<T: Clone>(air: &mut StdVec<(i32, T)>, now: i32) -> StdVec<T> {
        let packets = air.iter().filter(|p| p.0 <= now).map(|p| p.1.clone()).collect();
        air.retain(|p| p.0 > now);
        packets
    }
}

const SUBJECTS: usize = 3;
const PROTOCOL: ProtocolId = ProtocolId(70);

struct Asked {
    subject: usize,
    value: u8,
    number: Option<u8>,
    sends: u32,
    is_delivered: bool,
    /// Acknowledged, replaced or expired.
    ends: u32,
    expired: bool,
}

impl Asked {
    fn is_pending(&self) -> bool {
        self.ends == 0
    }

    /// Whether the sender still waits for its acknowledgement.
    fn is_in(&self, messages: &OutgoingMessages<4>) -> bool {
        self.number.is_none_or(|number| messages.clone().acknowledged(OWN, &Ack { to: A, boot: 3, number }))
    }
}

/// Random messages about three subjects for 20 s, compared with a model. Their content is the
/// subject and one of two values. Returns how many expired.
fn converse(mut radio: Radio, start: Instant) -> u32 {
    let retry = Retry::default();
    let mut outgoing = OutgoingMessages::<4>::new(A, 3, retry);
    let mut incoming = IncomingMessages::<4>::new(MEMORY);
    let mut asked: StdVec<Asked> = StdVec::new();
    let mut places = [usize::MAX; 256];
    let (mut to_b, mut to_a) = (StdVec::<(i32, Addressed)>::new(), StdVec::<(i32, Ack)>::new());
    let mut prevails = [None; SUBJECTS];

    for millis in (0..40_000).step_by(10) {
        let now = start + Duration::from_millis(millis);
        if millis < 20_000 && radio.rng.below(25) == 0 {
            let (subject, value) = (radio.rng.below(SUBJECTS as u32) as usize, radio.rng.below(2) as u8);
            let valid = Duration::from_millis(300 + radio.rng.below(5_000) as i32);
            let older = outgoing.clone();
            let content = [subject as u8, value].into();
            outgoing.send(OWN, subject as u32, (PROTOCOL, &content), valid, now).unwrap();
            let pending = asked.iter_mut().rfind(|a| a.subject == subject && a.is_pending());
            assert_eq!(outgoing == older, pending.as_ref().is_some_and(|a| a.value == value));
            if outgoing != older {
                if let Some(replaced) = pending {
                    replaced.ends += 1;
                }
                let number = None;
                asked.push(Asked { subject, value, number, sends: 0, is_delivered: false, ends: 0, expired: false });
            }
        }
        while let Some(due) = outgoing.poll(now) {
            match due {
                Due::Send(message) => {
                    let [subject, value] = message.content[..] else { panic!("{message:?}") };
                    let is_it = |a: &Asked| a.subject == usize::from(subject) && a.is_pending();
                    let place = asked.iter().rposition(is_it).unwrap();
                    let known = &mut asked[place];
                    assert_eq!((message.to, message.protocol, value), (OWN, PROTOCOL, known.value));
                    assert_eq!(*known.number.get_or_insert(message.number), message.number);
                    known.sends += 1;
                    places[usize::from(message.number)] = place;
                    radio.carry(&message, millis, &mut to_b);
                }
                Due::Expired(to) => {
                    assert_eq!(to, OWN);
                    let gone = asked.iter_mut().find(|a| a.is_pending() && !a.is_in(&outgoing)).unwrap();
                    gone.ends += 1;
                    gone.expired = true;
                }
            }
        }
        for message in Radio::arrived(&mut to_b, millis) {
            let place = places[usize::from(message.number)];
            let subject = asked[place].subject;
            let is_new = receive_in(&mut incoming, frame(A, 3), message.number, subject as u32, now);
            let is_latest = !asked[place + 1..].iter().any(|a| a.subject == subject && a.is_delivered);
            assert_eq!(is_new, !asked[place].is_delivered && is_latest, "message {place}");
            asked[place].is_delivered = true;
            if is_new {
                prevails[subject] = Some(place);
            }
            radio.carry(&Ack { to: A, boot: 3, number: message.number }, millis, &mut to_a);
        }
        for ack in Radio::arrived(&mut to_a, millis) {
            if outgoing.acknowledged(OWN, &ack) {
                let place = places[usize::from(ack.number)];
                assert!(asked[place].is_delivered);
                asked[place].ends += 1;
            }
        }
        for (subject, place) in prevails.into_iter().enumerate() {
            let last = asked.iter().rposition(|a| a.subject == subject && a.is_delivered);
            assert_eq!(place, last, "at {millis} ms");
        }
    }
    assert!(outgoing.is_empty() && asked.len() > 10);
    for message in &asked {
        assert_eq!(message.ends, 1);
        assert!(message.sends <= u32::from(retry.attempts));
    }
    asked.iter().map(|message| u32::from(message.expired)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn over_any_radio_each_message_acts_once_and_the_last_one_prevails(
        seed in any::<u64>(), start in any::<u32>(), loss_percent in 0..=100_u32,
        longest_ms in 1..600_u32,
    ) {
        let radio = Radio { rng: Rng::new(seed), loss_percent, longest_ms };
        converse(radio, Instant::from_micros(start));
    }

    #[test]
    fn over_a_lossless_radio_no_message_expires(
        seed in any::<u64>(), longest_ms in 1..90_u32,
    ) {
        let radio = Radio { rng: Rng::new(seed), loss_percent: 0, longest_ms };
        prop_assert_eq!(converse(radio, START), 0);
    }
}
