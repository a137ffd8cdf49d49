//! Integer time: wrapping microseconds, compared by difference.

use core::ops::{Add, Sub};
use serde::{Deserialize, Serialize};

/// A time on the robot's clock in microseconds; wraps after 71.6 minutes. Instants compare by their
/// wrapped difference, so they are ordered only if less than 35.8 minutes apart: use
/// [`Instant::is_before`] instead of `Ord`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct Instant(u32);

/// A signed span of time in microseconds, at most +-35.8 minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct Duration(i32);

impl Instant {
    /// The instant `micros` microseconds after the zero of the clock (modulo 2^32).
    #[must_use]
    pub const fn from_micros(micros: u32) -> Self {
        Self(micros)
    }

    /// Microseconds since the zero of the clock (modulo 2^32).
    #[must_use]
    pub const fn as_micros(self) -> u32 {
        self.0
    }

    /// The span from `earlier` to `self`; negative if `earlier` is later.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Duration {
        Duration(self.0.wrapping_sub(earlier.0).cast_signed())
    }

    /// Whether `self` lies strictly before `other`.
    #[must_use]
    pub const fn is_before(self, other: Self) -> bool {
        self.since(other).0 < 0
    }

    /// Whether the deadline `due`, which was at most `longest` ahead when it was set, has passed.
    ///
    /// Unlike `!self.is_before(due)`, this also holds after a pause of more than half of the
    /// clock's range, when a past instant seems to lie ahead.
    #[must_use]
    pub const fn has_reached(self, due: Self, longest: Duration) -> bool {
        let left = due.since(self).0;
        left <= 0 || left > longest.0
    }
}

impl Duration {
    /// A span of length 0.
    pub const ZERO: Self = Self(0);
    /// The longest span between two ordered instants.
    pub const MAX: Self = Self(i32::MAX);

    /// A span of `micros` microseconds.
    #[must_use]
    pub const fn from_micros(micros: i32) -> Self {
        Self(micros)
    }

    /// A span of `millis` milliseconds, saturating at [`Duration::MAX`].
    #[must_use]
    pub const fn from_millis(millis: i32) -> Self {
        Self(millis.saturating_mul(1000))
    }

    /// The span in microseconds.
    #[must_use]
    pub const fn as_micros(self) -> i32 {
        self.0
    }

    /// `self * factor`, saturating.
    #[must_use]
    pub const fn saturating_mul(self, factor: i32) -> Self {
        Self(self.0.saturating_mul(factor))
    }
}

impl Add<Duration> for Instant {
    type Output = Self;
    fn add(self, span: Duration) -> Self {
        Self(self.0.wrapping_add_signed(span.0))
    }
}

impl Sub<Duration> for Instant {
    type Output = Self;
    fn sub(self, span: Duration) -> Self {
        Self(self.0.wrapping_sub(span.0.cast_unsigned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_survives_the_wrap() {
        let before = Instant::from_micros(u32::MAX - 10);
        let after = before + Duration::from_micros(20);
        assert_eq!(after.as_micros(), 9);
        assert!(before.is_before(after));
        assert!(!after.is_before(before));
        assert!(!before.is_before(before));
        assert_eq!(after.since(before), Duration::from_micros(20));
        assert_eq!(after - Duration::from_micros(20), before);
    }

    #[test]
    fn a_passed_deadline_stays_passed_until_the_clock_has_wrapped() {
        let longest = Duration::from_millis(10);
        for start in [0, u32::MAX - 5_000] {
            let due = Instant::from_micros(start) + longest;
            let reached = |later: u32| {
                let now = Instant::from_micros(start.wrapping_add(later));
                now.has_reached(due, longest)
            };
            assert!(!reached(0) && !reached(9_999));
            assert!(reached(10_000) && reached(1 << 31) && reached((1 << 31) + 20_000));
            assert!(reached(u32::MAX), "up to a whole turn of the clock");
        }
    }

    #[test]
    fn spans_saturate() {
        assert_eq!(Duration::from_millis(i32::MAX), Duration::MAX);
        assert_eq!(Duration::from_millis(3).saturating_mul(i32::MAX), Duration::MAX);
    }
}
