use serde::Serialize;

/// Quantiles of a set of values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spread {
    /// 50th percentile.
    pub median: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Largest value.
    pub max: u64,
}

impl Spread {
    /// Computes the quantiles; `None` if there are no values. O(n log n).
    #[must_use]
    pub fn of(values: &[u32]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_unstable();
        // The smallest value with at least `percent` % of the values at or below it.
        let quantile = |percent: usize| {
            let rank = (sorted.len() * percent).div_ceil(100).max(1);
            sorted.get(rank - 1).copied().map(u64::from)
        };
        Some(Self { median: quantile(50)?, p99: quantile(99)?, max: quantile(100)? })
    }

    fn map(self, of: impl Fn(u64) -> u64) -> Self {
        Self { median: of(self.median), p99: of(self.p99), max: of(self.max) }
    }
}

/// Cost of the last steps of a device, readable during a run in O(1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Load {
    /// Steps decided.
    pub steps: u64,
    /// Steps in which device and shadow differed.
    pub mismatches: u64,
    /// Ticks of the device's clock in the last step; `None` before the first step.
    pub ticks: Option<u32>,
    /// Instructions of the last step; for emulated devices.
    pub instructions: Option<u64>,
    /// Instructions of the most expensive step.
    pub most_instructions: Option<u64>,
    /// Most stack that a step touched, bytes.
    pub stack_bytes: u32,
    /// Restarts.
    pub resets: u64,
}

/// Statistics of a device after a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Statistics {
    /// Id of its robot.
    pub robot: u32,
    /// The device as written in the configuration.
    pub device: String,
    /// The part's name in its hello.
    pub part: String,
    /// The firmware's name in its hello.
    pub firmware: String,
    /// Steps decided.
    pub steps: u64,
    /// Steps in which device and shadow differed.
    pub mismatches: u64,
    /// Time from a request to its answer, microseconds.
    pub round_trip_us: Option<Spread>,
    /// Ticks of the device's clock per step.
    pub ticks: Option<Spread>,
    /// Rate of that clock, per second.
    pub ticks_per_second: u32,
    /// Instructions per step, for emulated devices (1 ns each).
    pub instructions: Option<Spread>,
    /// Most stack that a step touched, bytes.
    pub stack_bytes: u32,
    /// Requests resent.
    pub resent: u64,
    /// Frames from the device that were damaged in transit.
    pub damaged: u64,
    /// Restarts.
    pub resets: u64,
    /// Inbox bytes removed because they did not fit.
    pub cut_inbox_bytes: u64,
    /// Obstacles removed because they did not fit.
    pub cut_obstacles: u64,
    /// Bytes sent to the device.
    pub sent_bytes: u64,
    /// Bytes received from the device.
    pub received_bytes: u64,
}

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
    pub fn took(&mut self, ticks: u32) {
        self.ticks.push(ticks);
        self.most_ticks = self.most_ticks.max(ticks);
    }

    pub fn instructions(&self, ticks_per_second: u32) -> Option<Spread> {
        Some(Spread::of(&self.ticks)?.map(|ticks| instructions(ticks, ticks_per_second)))
    }

    /// Instructions only for an emulated device, whose clock rate is known.
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

fn instructions(ticks: u64, ticks_per_second: u32) -> u64 {
    let scaled = u128::from(ticks) * 1_000_000_000 / u128::from(ticks_per_second.max(1));
    u64::try_from(scaled).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_among_the_values() {
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
    fn load_covers_the_last_and_the_most_expensive_step() {
        let mut tally = Collector { stack_bytes: 900, mismatches: 1, ..Collector::default() };
        assert_eq!(tally.load(Some(168_000_000)).instructions, None);
        [168, 16_800, 336].into_iter().for_each(|ticks| tally.took(ticks));
        let load = tally.load(Some(168_000_000));
        assert_eq!((load.ticks, load.instructions, load.most_instructions), (Some(336), Some(2000), Some(100_000)));
        assert_eq!((load.stack_bytes, load.mismatches), (900, 1));
        let load = tally.load(None);
        assert_eq!((load.ticks, load.instructions, load.most_instructions), (Some(336), None, None));
    }
}
