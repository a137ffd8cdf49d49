use super::*;
use crate::robot::RobotId;
use proptest::collection::vec;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn frame(boot: u8, sequence: u16) -> Header {
    Header { boot, sender: RobotId(1), sequence }
}

fn after(sequences: &[u16]) -> SequenceWindow {
    let mut window = SequenceWindow::new();
    for sequence in sequences {
        window.check(frame(0, *sequence));
    }
    window
}

#[test]
fn the_first_frame_is_always_new() {
    for (boot, sequence) in [(0, 0), (0, u16::MAX), (255, 0), (255, 1 << 15)] {
        let mut window = SequenceWindow::new();
        assert_eq!(window.check(frame(boot, sequence)), Arrival::New);
        assert_eq!(window.check(frame(boot, sequence)), Arrival::Duplicate);
    }
}

#[test]
fn the_window_has_its_documented_length() {
    for newest in [31, 32, 1000, u16::MAX, 0, 5] {
        let back = |k: u16| frame(0, newest.wrapping_sub(k));
        let mut window = after(&[newest]);
        assert_eq!(window.check(back(SEQUENCE_SPAN - 1)), Arrival::OutOfOrder);
        assert_eq!(window.check(back(SEQUENCE_SPAN - 1)), Arrival::Duplicate);
        assert_eq!(window.check(back(SEQUENCE_SPAN)), Arrival::TooOld);
        assert_eq!(window.check(back(1 << 15)), Arrival::TooOld);
        assert_eq!(window.check(back((1 << 15) + 1)), Arrival::New);
    }
}

#[test]
fn a_jump_clears_only_the_numbers_it_leaves_behind() {
    let numbers: [u16; 3] = [10, 11, 12];
    for jump in [1, 19, 31, 32, 33, 20_000] {
        let mut window = after(&numbers);
        let newest = 12 + jump;
        assert_eq!(window.check(frame(0, newest)), Arrival::New);
        for number in numbers {
            let expected = if newest - number < SEQUENCE_SPAN { Arrival::Duplicate } else { Arrival::TooOld };
            assert_eq!(window.check(frame(0, number)), expected, "jump {jump}");
        }
        if jump > 1 {
            assert_eq!(window.check(frame(0, newest - 1)), Arrival::OutOfOrder);
        }
    }
}

#[test]
fn a_rebooted_sender_is_accepted_at_once_and_its_old_frames_are_refused() {
    let mut window = after(&[500, 501]);
    assert_eq!(window.check(frame(1, 0)), Arrival::Rebooted);
    assert_eq!(window.check(frame(1, 0)), Arrival::Duplicate);
    assert_eq!(window.check(frame(0, 502)), Arrival::PreviousBoot);
    assert_eq!(window.check(frame(1, 1)), Arrival::New);
    assert_eq!(window.check(frame(2, 9)), Arrival::Rebooted);
    assert_eq!(window.check(frame(1, 2)), Arrival::PreviousBoot);
    assert_eq!(window.check(frame(0, 503)), Arrival::Rebooted);
}

#[test]
fn accepted_and_latest_arrivals() {
    use Arrival::{Duplicate, New, OutOfOrder, PreviousBoot, Rebooted, TooOld};
    for (arrival, accepted, latest) in [
        (New, true, true),
        (Rebooted, true, true),
        (OutOfOrder, true, false),
        (Duplicate, false, false),
        (TooOld, false, false),
        (PreviousBoot, false, false),
    ] {
        assert_eq!(arrival.is_accepted(), accepted);
        assert_eq!(arrival.is_latest(), latest);
    }
}

#[derive(Default)]
struct Model {
    seen: BTreeSet<i64>,
}

impl Model {
    fn check(&mut self, number: i64) -> Arrival {
        let newest = self.seen.last().copied();
        let arrival = match newest {
            None => Arrival::New,
            Some(newest) if number > newest => Arrival::New,
            Some(newest) if newest - number >= i64::from(SEQUENCE_SPAN) => Arrival::TooOld,
            Some(_) if self.seen.contains(&number) => Arrival::Duplicate,
            Some(_) => Arrival::OutOfOrder,
        };
        if arrival.is_accepted() {
            self.seen.insert(number);
        }
        arrival
    }
}

proptest! {
    /// Losses, duplicates, reordering up to 99 frames, and any number of wraps.
    #[test]
    fn the_window_agrees_with_an_unlimited_model(
        start in any::<u16>(),
        steps in vec((prop_oneof![4 => 0..3_i64, 1 => 0..40_i64, 1 => 0..30_000_i64], 0..100_i64), 1..300),
    ) {
        let mut window = SequenceWindow::new();
        let mut model = Model::default();
        let mut sent = i64::from(start);
        for (lost, late) in steps {
            sent += lost;
            let number = sent - late;
            let expected = model.check(number);
            prop_assert_eq!(window.check(frame(3, number as u16)), expected, "number {}", number);
        }
    }

    #[test]
    fn each_frame_is_accepted_at_most_once_per_boot(
        deliveries in vec((0..2_u8, 0..200_u16), 0..400),
    ) {
        let mut window = SequenceWindow::new();
        let mut accepted = BTreeSet::new();
        let mut boot = None;
        for (next_boot, sequence) in deliveries {
            let arrival = window.check(frame(next_boot, sequence));
            if arrival.is_accepted() {
                prop_assert!(accepted.insert((next_boot, sequence)));
                prop_assert!(arrival == Arrival::Rebooted || boot.is_none_or(|b| b == next_boot));
                boot = Some(next_boot);
            }
        }
    }
}
