/// Wait between the first two greetings. It doubles up to the time between two attempts.
const FIRST_WAIT_US: u64 = 10_000;

/// A start of a device: from its first greeting until it is configured. The port greets a device at
/// once that reports a restart, which alone would be thousands of times in a second.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    pub since_us: u64,
    /// Restarts of the device after its greeting was answered.
    pub restarts: u32,
    wait_us: u64,
    next_us: u64,
}

impl Start {
    pub const fn new(now_us: u64) -> Self {
        Self { since_us: now_us, restarts: 0, wait_us: FIRST_WAIT_US, next_us: now_us }
    }

    /// When the next greeting may be sent.
    pub const fn next_us(&self) -> u64 {
        self.next_us
    }

    pub fn greeted(&mut self, now_us: u64, most_us: u64) {
        self.next_us = now_us.saturating_add(self.wait_us.min(most_us));
        self.wait_us = self.wait_us.saturating_mul(2).min(most_us);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_between_greetings_double_up_to_the_longest() {
        let mut start = Start::new(7);
        let mut waits = Vec::new();
        for _ in 0..8 {
            let now_us = start.next_us();
            start.greeted(now_us, 500_000);
            waits.push((start.next_us() - now_us) / 1000);
        }
        assert_eq!(waits, [10, 20, 40, 80, 160, 320, 500, 500]);
        start.greeted(u64::MAX, u64::MAX);
        assert_eq!(start.next_us(), u64::MAX);
    }
}
