/// A rate limit with a burst of a tenth of a second (the leaky bucket as a meter, also called
/// GCRA). Times are microseconds of any monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    each_us: u64,
    /// Time at which all units taken so far are paid for.
    even_us: u64,
}

const AT_ONCE_US: u64 = 100_000;

impl Budget {
    /// A limit of `count` units per second; 0 counts as 1.
    pub fn per_second(count: u32) -> Self {
        Self { each_us: 1_000_000 / u64::from(count.max(1)), even_us: 0 }
    }

    pub fn take(&mut self, now_us: u64) -> bool {
        let even_us = self.even_us.max(now_us);
        if even_us - now_us > AT_ONCE_US {
            return false;
        }
        self.even_us = even_us + self.each_us;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn so_many_a_second_and_a_tenth_of_that_at_once() {
        for (count, at_once) in [(1000, 101), (10, 2), (1, 1), (0, 1)] {
            let mut budget = Budget::per_second(count);
            let taken = |budget: &mut Budget, now_us| (0..10_000).filter(|_| budget.take(now_us)).count();
            assert_eq!(taken(&mut budget, 5), at_once, "{count}");
            let later: usize = (1..=1000).map(|ms| taken(&mut budget, 5 + ms * 1000)).sum();
            assert!(later.abs_diff(count.max(1) as usize) <= 1, "{count}: {later}");
        }
    }
}
