//! Boot numbers of programs that store nothing.

use crate::tlog::micros_since_1970;
use std::time::Duration;

/// A boot number lasts a quarter of a second, and returns after a minute.
const UNIT_BITS: u32 = 18;
const UNIT_US: u64 = 1 << UNIT_BITS;

/// A boot number that the previous start of this program did not have, however soon it was.
///
/// The number counts quarters of a second of the computer's clock. This waits for the next quarter:
/// a program that began to send in one is over before a later start gets the number of the next.
/// The clock must not be set back between the two starts. Takes a quarter of a second at most.
pub(crate) fn fresh_boot() -> u8 {
    after_the_unit(micros_since_1970, std::thread::sleep)
}

fn after_the_unit(clock: impl Fn() -> u64, mut pause: impl FnMut(Duration)) -> u8 {
    let unit = |micros: u64| micros >> UNIT_BITS;
    let first = clock();
    let mut now = first;
    // A pause may end early; a clock that stands still must not block the start.
    for _ in 0..4 {
        if unit(now) != unit(first) {
            break;
        }
        pause(Duration::from_micros(UNIT_US - now % UNIT_US));
        now = clock();
    }
    unit(now) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;
    use std::cell::Cell;

    proptest! {
        /// Receivers remember the last two boot numbers. A pause may end too early.
        #[test]
        fn a_program_that_restarts_at_any_time_has_a_new_boot_number(
            start_us in 0..u64::MAX / 2,
            runs_us in vec((0..2_000_000_u64, 0..1000_u64), 3..40),
        ) {
            let now = Cell::new(start_us);
            let boots = runs_us.into_iter().map(|(run_us, early_us)| {
                let began = now.get();
                let mut early_us = early_us;
                let boot = after_the_unit(|| now.get(), |time| {
                    let pause_us = time.as_micros() as u64;
                    now.set(now.get() + pause_us.saturating_sub(early_us).max(1));
                    early_us = 0;
                });
                assert!(now.get() - began <= UNIT_US);
                now.set(now.get() + run_us);
                boot
            });
            let boots: Vec<u8> = boots.collect();
            for three in boots.windows(3) {
                prop_assert!(three[2] != three[1] && three[2] != three[0], "{:?}", boots);
            }
        }
    }

    #[test]
    fn starts_within_a_second_have_different_numbers() {
        let now = Cell::new(1_764_000_000_000_000);
        let boots = [(); 5].map(|()| {
            let boot = after_the_unit(|| now.get(), |time| now.set(now.get() + time.as_micros() as u64));
            now.set(now.get() + 1000);
            boot
        });
        let first = boots[0];
        assert_eq!(boots, [0, 1, 2, 3, 4].map(|later: u8| first.wrapping_add(later)));
    }

    #[test]
    fn a_clock_that_stands_still_or_goes_back_does_not_block_the_start() {
        let mut pauses = 0;
        assert_eq!(after_the_unit(|| 5 << UNIT_BITS, |_| pauses += 1), 5);
        assert_eq!(pauses, 4);
        let now = Cell::new(9_u64 << UNIT_BITS);
        assert_eq!(after_the_unit(|| now.get(), |_| now.set(7 << UNIT_BITS)), 7);
    }
}
