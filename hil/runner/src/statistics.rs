//! What is known of a device after a run.

use serde::Serialize;

/// Of many values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spread {
    /// Half of them are at most this.
    pub median: u64,
    /// 99 of 100 are at most this.
    pub p99: u64,
    /// The greatest.
    pub max: u64,
}

impl Spread {
    /// Of these values; `None` if there are none. O(n log n).
    #[must_use]
    pub fn of(values: &[u32]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_unstable();
        // The least value that so many in a hundred do not exceed.
        let quantile = |percent: usize| {
            let rank = (sorted.len() * percent).div_ceil(100).max(1);
            sorted.get(rank - 1).copied().map(u64::from)
        };
        Some(Self { median: quantile(50)?, p99: quantile(99)?, max: quantile(100)? })
    }

    /// In another unit.
    fn scaled(self, numerator: u64, denominator: u64) -> Self {
        let scale = |value: u64| {
            let scaled = u128::from(value) * u128::from(numerator) / u128::from(denominator.max(1));
            u64::try_from(scaled).unwrap_or(u64::MAX)
        };
        Self { median: scale(self.median), p99: scale(self.p99), max: scale(self.max) }
    }
}

/// What is known of a device after a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Statistics {
    /// Which robot it is.
    pub robot: u32,
    /// As people wrote it.
    pub device: String,
    /// As it calls itself.
    pub part: String,
    /// What it runs.
    pub firmware: String,
    /// Steps that it decided.
    pub steps: u64,
    /// Steps in which it and its shadow differed.
    pub mismatches: u64,
    /// From a request to its answer, microseconds.
    pub round_trip_us: Option<Spread>,
    /// Ticks of the device's clock per step.
    pub ticks: Option<Spread>,
    /// Rate of that clock, per second.
    pub ticks_per_second: u32,
    /// Instructions per step; of emulated devices, where an instruction takes a nanosecond of their clock.
    pub instructions: Option<Spread>,
    /// The most stack that a step touched, bytes.
    pub stack_bytes: u32,
    /// Requests sent again.
    pub resent: u64,
    /// Frames from the device that were damaged on the way.
    pub damaged: u64,
    /// Times that it started anew.
    pub resets: u64,
    /// Bytes of inboxes for which it had no room.
    pub cut_inbox_bytes: u64,
    /// Obstacles for which it had no room.
    pub cut_obstacles: u64,
    /// Bytes sent to it.
    pub sent_bytes: u64,
    /// Bytes received from it.
    pub received_bytes: u64,
}

/// What is collected on the way there.
#[derive(Clone, Debug, Default)]
pub struct Collector {
    pub steps: u64,
    pub mismatches: u64,
    pub round_trip_us: Vec<u32>,
    pub ticks: Vec<u32>,
    pub stack_bytes: u32,
    pub resets: u64,
    pub cut_inbox_bytes: u64,
    pub cut_obstacles: u64,
}

impl Collector {
    /// Instructions of an emulated device.
    pub fn instructions(&self, ticks_per_second: u32) -> Option<Spread> {
        let ticks = Spread::of(&self.ticks)?;
        Some(ticks.scaled(1_000_000_000, ticks_per_second.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_there() {
        assert_eq!(Spread::of(&[]), None);
        let one = Spread::of(&[7]);
        let all = Spread { median: 7, p99: 7, max: 7 };
        assert_eq!(one, Some(all));
        let hundred: Vec<u32> = (1..=100).rev().collect();
        let spread = Spread { median: 50, p99: 99, max: 100 };
        assert_eq!(Spread::of(&hundred), Some(spread));
    }

    #[test]
    fn ticks_of_168_mhz_become_instructions() {
        let tally = Collector { ticks: vec![168, 336, 16_800], ..Collector::default() };
        let spread = tally.instructions(168_000_000).expect("three steps");
        assert_eq!((spread.median, spread.max), (2000, 100_000));
    }
}
