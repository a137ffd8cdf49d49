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

    /// Each value otherwise.
    fn map(self, of: impl Fn(u64) -> u64) -> Self {
        Self { median: of(self.median), p99: of(self.p99), max: of(self.max) }
    }
}

/// What the last steps cost a device, while it runs. O(1) to ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Load {
    /// Steps that it decided.
    pub steps: u64,
    /// Steps in which it and its shadow differed.
    pub mismatches: u64,
    /// Ticks of the device's clock in the last step; `None` before the first one.
    pub ticks: Option<u32>,
    /// Instructions of the last step; of emulated devices.
    pub instructions: Option<u64>,
    /// Those of the step that took most.
    pub most_instructions: Option<u64>,
    /// The most stack that a step touched, bytes.
    pub stack_bytes: u32,
    /// Times that it started anew.
    pub resets: u64,
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
    pub most_ticks: u32,
    pub stack_bytes: u32,
    pub resets: u64,
    pub cut_inbox_bytes: u64,
    pub cut_obstacles: u64,
}

impl Collector {
    /// Notes what a step took of the device's clock.
    pub fn took(&mut self, ticks: u32) {
        self.ticks.push(ticks);
        self.most_ticks = self.most_ticks.max(ticks);
    }

    /// Instructions of an emulated device.
    pub fn instructions(&self, ticks_per_second: u32) -> Option<Spread> {
        Some(Spread::of(&self.ticks)?.map(|ticks| instructions(ticks, ticks_per_second)))
    }

    /// What the last steps cost; instructions where an emulated device's clock has so many ticks per second.
    pub fn load(&self, emulated_ticks_per_second: Option<u32>) -> Load {
        let ticks = self.ticks.last().copied();
        let of = |ticks: u32| Some(instructions(ticks.into(), emulated_ticks_per_second?));
        Load {
            steps: self.steps,
            mismatches: self.mismatches,
            ticks,
            instructions: ticks.and_then(of),
            most_instructions: ticks.and_then(|_| of(self.most_ticks)),
            stack_bytes: self.stack_bytes,
            resets: self.resets,
        }
    }
}

/// Ticks of an emulated device's clock as instructions, of which each takes a nanosecond.
fn instructions(ticks: u64, ticks_per_second: u32) -> u64 {
    let scaled = u128::from(ticks) * 1_000_000_000 / u128::from(ticks_per_second.max(1));
    u64::try_from(scaled).unwrap_or(u64::MAX)
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

    #[test]
    fn the_load_is_that_of_the_last_step_and_of_the_worst() {
        let mut tally = Collector { stack_bytes: 900, mismatches: 1, ..Collector::default() };
        assert_eq!(tally.load(Some(168_000_000)).instructions, None);
        [168, 16_800, 336].into_iter().for_each(|ticks| tally.took(ticks));
        let load = tally.load(Some(168_000_000));
        assert_eq!((load.ticks, load.instructions, load.most_instructions), (Some(336), Some(2000), Some(100_000)));
        assert_eq!((load.stack_bytes, load.mismatches), (900, 1));
        // Of a board only its clock is known.
        let load = tally.load(None);
        assert_eq!((load.ticks, load.instructions, load.most_instructions), (Some(336), None, None));
    }
}
