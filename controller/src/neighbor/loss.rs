//! Estimates how long a neighbour may be silent before packet loss no longer explains it.

use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// Silent periods that are not yet evidence of a gap.
const SHORT: u16 = 3;
/// All counts are halved here, so that old evidence loses weight.
const MEMORY: u16 = 1 << 14;
/// Accepted false alarms of a robot per minute, over all neighbours: one in 10,000 minutes; Q24.
const FALSE_ALARMS: u64 = 1_677;
const MINUTE_US: i32 = 60_000_000;
const MOST_PERIODS: i32 = 64;

/// Estimate of the packet loss, from gaps in the neighbours' sequence numbers.
///
/// A gap is a loss of more than three consecutive frames of one sender. As in the bad state of E.
/// N. Gilbert's channel ("Capacity of a burst-noise channel", Bell System Technical Journal 39,
/// 1960), it ends with equal probability at each frame: observed ends per lost frame, over all
/// neighbours. A neighbour that was given up contributes lost frames and no end, so long outages
/// are recognised after the first one. Without evidence, gaps begin and end with probability 1/2
/// per frame. 8 bytes; constant work per frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LossEstimate {
    frames: u16,
    gaps: u16,
    ended: u16,
    /// Frames lost beyond the first [`SHORT`] of each gap.
    lost: u16,
}

impl LossEstimate {
    /// Creates an estimate without evidence.
    #[must_use]
    pub const fn new() -> Self {
        Self { frames: 0, gaps: 0, ended: 0, lost: 0 }
    }

    /// Counts a received frame and the `missed` frames of its sender before it.
    pub fn heard(&mut self, missed: u16) {
        self.count(missed, 1);
    }

    /// Counts a sender that was given up after `missed` frames did not arrive.
    pub fn gave_up(&mut self, missed: u16) {
        self.count(missed, 0);
    }

    fn count(&mut self, missed: u16, heard: u16) {
        let missed = missed.min(MEMORY - 1);
        let beyond = missed.saturating_sub(SHORT);
        let is_gap = u16::from(beyond > 0);
        self.frames = self.frames.saturating_add(missed).saturating_add(heard);
        self.gaps = self.gaps.saturating_add(is_gap);
        self.ended = self.ended.saturating_add(is_gap & heard);
        self.lost = self.lost.saturating_add(beyond);
        while self.frames >= MEMORY {
            let Self { frames, gaps, ended, lost } = *self;
            *self = Self { frames: frames >> 1, gaps: gaps >> 1, ended: ended >> 1, lost: lost >> 1 };
        }
    }

    /// Returns the silence beyond which a neighbour counts as lost.
    ///
    /// With `neighbors` robots that each send once per `period`, a working robot is mistaken for a
    /// lost one less than once in 10,000 minutes. The result is between four periods and `longest`,
    /// which also replaces more than 64 periods.
    #[must_use]
    pub fn patience(&self, neighbors: usize, period: Duration, longest: Duration) -> Duration {
        let chance = |part: u16, whole: u16| {
            ((u32::from(part) + 1) << 16).checked_div(u32::from(whole) + 2).map_or(1 << 16, u64::from)
        };
        let (begins, ends) = (chance(self.gaps, self.frames), chance(self.ended, self.lost));
        let continues = (1_u64 << 16).saturating_sub(ends);
        let per_minute = MINUTE_US.checked_div(period.as_micros()).map_or(0, i32::unsigned_abs);
        let neighbors = u16::try_from(neighbors).unwrap_or(u16::MAX);
        // Expected gaps of at least this many periods in a minute, Q24.
        let mut alarms = (begins << 8).saturating_mul(per_minute.into()).saturating_mul(neighbors.into());
        for periods in i32::from(SHORT) + 1..=MOST_PERIODS {
            let silence = period.saturating_mul(periods);
            if alarms <= FALSE_ALARMS || silence >= longest {
                return silence.min(longest);
            }
            alarms = alarms.saturating_mul(continues) >> 16;
        }
        longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rand::Rng;
    use proptest::prelude::*;

    const PERIOD: Duration = Duration::from_millis(1_000);
    const LONGEST: Duration = Duration::from_millis(60_000);

    struct Radio {
        rng: Rng,
        begins: f64,
        continues: f64,
        is_lost: bool,
    }

    impl Radio {
        fn new(seed: u64, begins: f64, continues: f64) -> Self {
            Self { rng: Rng::keyed(seed, 0, 0, 0), begins, continues, is_lost: false }
        }

        fn loses(&mut self) -> bool {
            let chance = if self.is_lost { self.continues } else { self.begins };
            self.is_lost = f64::from(self.rng.next_u32()) < chance * f64::from(u32::MAX);
            self.is_lost
        }
    }

    /// Gaps of one neighbour above the patience, and the final patience in periods.
    fn false_alarms(radio: &mut Radio, frames: u32, estimate: &mut LossEstimate) -> (u32, i32) {
        let (mut missed, mut alarms, mut patience) = (0, 0, LONGEST);
        let mut is_given_up = false;
        for _ in 0..frames {
            if radio.loses() {
                missed += 1;
                if !is_given_up && PERIOD.saturating_mul(missed) >= patience {
                    estimate.gave_up(u16::try_from(missed).unwrap());
                    (alarms, is_given_up) = (alarms + 1, true);
                }
            } else {
                // The number of frames that a lost sender sent meanwhile is unknown.
                estimate.heard(if is_given_up { 0 } else { u16::try_from(missed).unwrap() });
                (missed, is_given_up) = (0, false);
                patience = estimate.patience(1, PERIOD, LONGEST);
            }
        }
        (alarms, patience.as_micros() / PERIOD.as_micros())
    }

    #[test]
    fn patience_grows_with_loss_and_bursts() {
        let patiences = [(0.0, 0.0), (0.1, 0.1), (0.3, 0.3), (0.05, 0.7)].map(|(begins, continues)| {
            let mut estimate = LossEstimate::new();
            false_alarms(&mut Radio::new(1, begins, continues), 20_000, &mut estimate).1
        });
        assert!(patiences[0] <= 10 && patiences[1] <= 11 && (9..=13).contains(&patiences[2]), "{patiences:?}");
        assert!((20..=40).contains(&patiences[3]), "{patiences:?}");
    }

    #[test]
    fn a_working_robot_is_not_taken_for_lost() {
        for (seed, (begins, continues)) in (0..).zip([(0.01, 0.01), (0.1, 0.1), (0.3, 0.3), (0.02, 0.6), (0.4, 0.4)]) {
            let mut radio = Radio::new(seed, begins, continues);
            let mut estimate = LossEstimate::new();
            // 16,700 robot-minutes with one neighbour; the limit allows 1.7 alarms.
            let (alarms, patience) = false_alarms(&mut radio, 1_000_000, &mut estimate);
            assert!(alarms <= 8, "{alarms} alarms at {begins} {continues}, patience {patience}");
            assert!(patience < 60);
        }
    }

    #[test]
    fn long_outages_are_recognised_after_the_first_ones() {
        // One frame in ten is lost independently; every 500 frames about 30 are lost in a row.
        let (mut thin, mut spells) = (Radio::new(1, 0.1, 0.1), Radio::new(2, 0.002, 1.0 - 1.0 / 30.0));
        let mut estimate = LossEstimate::new();
        let (mut missed, mut given_up) = (0_u16, 0);
        for _ in 0..100_000 {
            let is_lost = thin.loses() | spells.loses();
            if !is_lost {
                estimate.heard(if missed == u16::MAX { 0 } else { missed });
                missed = 0;
            } else if missed < u16::MAX {
                missed += 1;
                if PERIOD.saturating_mul(missed.into()) >= estimate.patience(1, PERIOD, LONGEST) {
                    estimate.gave_up(missed);
                    (missed, given_up) = (u16::MAX, given_up + 1);
                }
            }
        }
        assert_eq!(estimate.patience(1, PERIOD, LONGEST), LONGEST);
        // About 190 outages, of which one in seven exceeds the longest patience.
        assert!(given_up < 50, "{given_up}");
    }

    #[test]
    fn without_evidence_the_patience_is_long_but_bounded() {
        let estimate = LossEstimate::new();
        let longest = Duration::from_millis(30_000);
        let waits = estimate.patience(8, PERIOD, longest);
        assert!(waits > Duration::from_millis(15_000) && waits <= longest, "{waits:?}");
        assert_eq!(estimate.patience(8, PERIOD, PERIOD), PERIOD);
        assert_eq!(estimate.patience(0, PERIOD, longest), PERIOD.saturating_mul(4));
        assert!(estimate.patience(8, Duration::ZERO, longest) <= longest);
    }

    proptest! {
        /// Chances as fractions instead of fixed point.
        #[test]
        fn patience_is_the_least_silence_with_less_than_one_false_alarm_in_10_000_minutes(
            events in proptest::collection::vec((0..40_u16, any::<bool>()), 0..60),
            neighbors in 0..20_usize, period_ms in 50..2_000_i32, longest_s in 1..200_i32,
        ) {
            let mut estimate = LossEstimate::new();
            let [mut frames, mut gaps, mut ended, mut lost] = [0_u16; 4];
            for (missed, is_heard) in events {
                if is_heard { estimate.heard(missed) } else { estimate.gave_up(missed) }
                frames += missed + u16::from(is_heard);
                gaps += u16::from(missed > 3);
                ended += u16::from(missed > 3 && is_heard);
                lost += missed.saturating_sub(3);
            }
            prop_assert_eq!(estimate, LossEstimate { frames, gaps, ended, lost });
            let (period, longest) = (Duration::from_millis(period_ms), Duration::from_millis(longest_s * 1000));
            let got = estimate.patience(neighbors, period, longest);
            let chance = |part: u16, whole: u16| (f64::from(part) + 1.0) / (f64::from(whole) + 2.0);
            let per_minute = f64::from(60_000 / period_ms) * neighbors as f64 * chance(gaps, frames);
            let alarms = |periods: i32| per_minute * libm::pow(1.0 - chance(ended, lost), f64::from(periods - 4));
            prop_assert!(got <= longest);
            let periods = got.as_micros() / period.as_micros();
            if got < longest {
                prop_assert!(got == period.saturating_mul(periods) && (4..=64).contains(&periods));
                prop_assert!(alarms(periods) < 1.05e-4, "{periods}: {}", alarms(periods));
            }
            let before = (periods - 1).min(63);
            prop_assert!(before < 4 || alarms(before) > 0.95e-4, "{before}: {}", alarms(before));
        }
    }

    #[test]
    fn all_counts_are_halved_when_the_frames_reach_the_memory() {
        let mut estimate = LossEstimate { frames: MEMORY - 2, gaps: 101, ended: 51, lost: 1001 };
        estimate.heard(0);
        assert_eq!(estimate, LossEstimate { frames: MEMORY - 1, gaps: 101, ended: 51, lost: 1001 });
        estimate.heard(0);
        assert_eq!(estimate, LossEstimate { frames: MEMORY / 2, gaps: 50, ended: 25, lost: 500 });
        let mut long = LossEstimate::new();
        long.heard(u16::MAX);
        assert_eq!(long, LossEstimate { frames: MEMORY / 2, gaps: 0, ended: 0, lost: (MEMORY - 4) / 2 });
    }

    #[test]
    fn counts_never_overflow() {
        let mut estimate = LossEstimate::new();
        for missed in [u16::MAX, 0, u16::MAX, 3, u16::MAX] {
            estimate.heard(missed);
            estimate.gave_up(missed);
            let LossEstimate { frames, gaps, ended, lost } = estimate;
            assert!(ended <= gaps && gaps <= frames && lost <= frames && frames < MEMORY);
            let _ = estimate.patience(usize::MAX, Duration::from_micros(1), LONGEST);
        }
    }
}
