//! How long a neighbour's silence may last before it is more than bad luck.

use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// Periods of silence that say nothing yet.
const SHORT: u16 = 3;
/// At this count all counts are halved, so that what is long past weighs little.
const MEMORY: u16 = 1 << 14;
/// False alarms that a robot may raise in a minute, over all of its neighbours: one in 10,000 minutes; Q24.
const FALSE_ALARMS: u64 = 1_677;
const MINUTE_US: i32 = 60_000_000;
/// The most periods of silence that are looked at one by one.
const MOST_PERIODS: i32 = 64;

/// What the gaps in the others' sequence numbers tell of the radio.
///
/// How often more than three frames of one sender are lost in a row is counted, over all neighbours, and how long such gaps go on: like
/// the bad state of E. N. Gilbert's channel ("Capacity of a burst-noise channel", Bell System Technical Journal 39, 1960) they
/// end with the same chance at each frame. That chance is estimated as a hazard is: ends seen over frames lost; a neighbour
/// that was given up counts with the frames lost until then and no end, so that a radio with long bad spells is
/// known after the first one. Without evidence a gap is taken to begin at one frame in two and to end at one frame in two.
///
/// 8 bytes; constant work per frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LossEstimate {
    /// Frames of theirs, heard or not.
    frames: u16,
    /// Gaps of more than [`SHORT`] frames.
    gaps: u16,
    /// Those of them that ended.
    ended: u16,
    /// Frames lost in them beyond [`SHORT`].
    lost: u16,
}

impl LossEstimate {
    /// Without evidence.
    #[must_use]
    pub const fn new() -> Self {
        Self { frames: 0, gaps: 0, ended: 0, lost: 0 }
    }

    /// Takes note of a frame that was heard after `missed` others of its sender were not.
    pub fn heard(&mut self, missed: u16) {
        self.count(missed, 1);
    }

    /// Takes note of a sender that was given up when `missed` frames of it had not come.
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

    /// The longest silence that `neighbors` robots, who each speak once in a `period`, can still come back from: beyond it,
    /// one that is well would be taken for lost less than once in 10,000 minutes. From four periods to `longest`; `longest`
    /// too when 64 periods are not enough, which bounds the work.
    #[must_use]
    pub fn patience(&self, neighbors: usize, period: Duration, longest: Duration) -> Duration {
        // Q16.
        let chance = |part: u16, whole: u16| {
            ((u32::from(part) + 1) << 16).checked_div(u32::from(whole) + 2).map_or(1 << 16, u64::from)
        };
        let (begins, ends) = (chance(self.gaps, self.frames), chance(self.ended, self.lost));
        let goes_on = (1_u64 << 16).saturating_sub(ends);
        let per_minute = MINUTE_US.checked_div(period.as_micros()).map_or(0, i32::unsigned_abs);
        let neighbors = u16::try_from(neighbors).unwrap_or(u16::MAX);
        // Gaps in a minute of at least so many periods, Q24.
        let mut alarms = (begins << 8).saturating_mul(per_minute.into()).saturating_mul(neighbors.into());
        for periods in i32::from(SHORT) + 1..=MOST_PERIODS {
            let silence = period.saturating_mul(periods);
            if alarms <= FALSE_ALARMS || silence >= longest {
                return silence.min(longest);
            }
            alarms = alarms.saturating_mul(goes_on) >> 16;
        }
        longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rand::Rng;

    const PERIOD: Duration = Duration::from_millis(1_000);
    const LONGEST: Duration = Duration::from_millis(60_000);

    /// A radio that loses frames in bursts, and what was learned of it.
    struct Radio {
        rng: Rng,
        begins: f64,
        goes_on: f64,
        is_lost: bool,
    }

    impl Radio {
        fn new(seed: u64, begins: f64, goes_on: f64) -> Self {
            Self { rng: Rng::keyed(seed, 0, 0, 0), begins, goes_on, is_lost: false }
        }

        /// Whether the next frame is lost.
        fn loses(&mut self) -> bool {
            let chance = if self.is_lost { self.goes_on } else { self.begins };
            self.is_lost = f64::from(self.rng.next_u32()) < chance * f64::from(u32::MAX);
            self.is_lost
        }
    }

    /// Gaps longer than the patience among frames of one neighbour, and the patience at the end, periods.
    fn false_alarms(radio: &mut Radio, frames: u32, estimate: &mut LossEstimate) -> (u32, i32) {
        let (mut missed, mut alarms, mut patience) = (0, 0, LONGEST);
        let mut is_given_up = false;
        for _ in 0..frames {
            if radio.loses() {
                missed += 1;
                // Lost at the first step at which it is older than that.
                if !is_given_up && PERIOD.saturating_mul(missed) >= patience {
                    estimate.gave_up(u16::try_from(missed).unwrap());
                    (alarms, is_given_up) = (alarms + 1, true);
                }
            } else {
                // Who was given up is found anew, and nobody knows how many frames it had sent meanwhile.
                estimate.heard(if is_given_up { 0 } else { u16::try_from(missed).unwrap() });
                (missed, is_given_up) = (0, false);
                patience = estimate.patience(1, PERIOD, LONGEST);
            }
        }
        (alarms, patience.as_micros() / PERIOD.as_micros())
    }

    #[test]
    fn patience_grows_with_loss_and_bursts() {
        let patiences = [(0.0, 0.0), (0.1, 0.1), (0.3, 0.3), (0.05, 0.7)].map(|(begins, goes_on)| {
            let mut estimate = LossEstimate::new();
            false_alarms(&mut Radio::new(1, begins, goes_on), 20_000, &mut estimate).1
        });
        assert!(patiences[0] <= 10 && patiences[1] <= 11 && (9..=13).contains(&patiences[2]), "{patiences:?}");
        assert!((20..=40).contains(&patiences[3]), "{patiences:?}");
    }

    #[test]
    fn who_is_well_is_not_taken_for_lost() {
        for (seed, (begins, goes_on)) in (0..).zip([(0.01, 0.01), (0.1, 0.1), (0.3, 0.3), (0.02, 0.6), (0.4, 0.4)]) {
            let mut radio = Radio::new(seed, begins, goes_on);
            let mut estimate = LossEstimate::new();
            // A million frames, one a second: 16,700 robot-minutes with one neighbour; 1.7 alarms are meant.
            let (alarms, patience) = false_alarms(&mut radio, 1_000_000, &mut estimate);
            assert!(alarms <= 8, "{alarms} alarms at {begins} {goes_on}, patience {patience}");
            assert!(patience < 60);
        }
    }

    #[test]
    fn a_radio_with_long_bad_spells_is_known_after_the_first_ones() {
        // One frame in ten is lost by itself; once in 500 frames nothing comes for 30 periods or so.
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
        // Some 190 spells, of which one in seven lasts for longer than the longest patience.
        assert!(given_up < 50, "{given_up}");
    }

    #[test]
    fn without_evidence_it_waits_and_never_beyond_the_longest() {
        let estimate = LossEstimate::new();
        let longest = Duration::from_millis(30_000);
        let waits = estimate.patience(8, PERIOD, longest);
        assert!(waits > Duration::from_millis(15_000) && waits <= longest, "{waits:?}");
        assert_eq!(estimate.patience(8, PERIOD, PERIOD), PERIOD);
        assert_eq!(estimate.patience(0, PERIOD, longest), PERIOD.saturating_mul(4));
        assert!(estimate.patience(8, Duration::ZERO, longest) <= longest);
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
