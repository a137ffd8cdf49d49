//! A small seeded random generator on integers, with one sequence on every target. Not for secrets.
//!
//! [`Rng::keyed`] gives each (seed, purpose, robot, tick) its own generator instead of a shared
//! stream, so neither the order of robots nor the number of threads changes a result.
//!
//! Source: SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators",
//! with Stafford's variant 13 of the mixing function).

use crate::scalar::integer::log2_q32;
use core::num::NonZeroU64;

/// The odd integer nearest to 2^64 / golden ratio, so that steps of the state do not form patterns.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// A bijection of 64-bit words in which each input bit affects all output bits.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A generator of random numbers; 8 bytes of state, period 2^64. Not `Copy`, because two copies
/// would silently repeat each other.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// Creates the generator of a seed; any seed is valid, including 0.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Creates the generator of a key. `purpose` separates the caller's uses. If three of the
    /// inputs are fixed, different values of the fourth give different generators.
    #[must_use]
    pub const fn keyed(seed: u64, purpose: u32, robot: u32, tick: u32) -> Self {
        let who = ((purpose as u64) << 32) | robot as u64;
        let h = mix(seed.wrapping_add(GOLDEN));
        let h = mix((h ^ who).wrapping_add(GOLDEN));
        Self::new(mix((h ^ tick as u64).wrapping_add(GOLDEN)))
    }

    /// 64 random bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix(self.state)
    }

    /// 32 random bits.
    pub const fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// Uniform in `0..n`; 0 if `n` is 0. Always one draw: it multiplies in 64 bits instead of
    /// rejecting draws. The relative error of each probability is below 2^-32.
    pub const fn below(&mut self, n: u32) -> u32 {
        let bits = self.next_u64();
        let low = (bits & 0xFFFF_FFFF) * n as u64;
        let high = (bits >> 32) * n as u64;
        ((high + (low >> 32)) >> 32) as u32
    }

    /// Uniform in [0, 1) as Q0.32.
    pub const fn unit_q32(&mut self) -> u32 {
        self.next_u32()
    }

    /// True with probability `p` (Q0.32): never for 0, always for `u32::MAX`. Always one draw.
    pub const fn chance_q32(&mut self, p: u32) -> bool {
        let drawn = self.unit_q32();
        p == u32::MAX || drawn < p
    }

    /// A sample of the exponential distribution with mean 1 in Q16.16, from 2^-16 (so that it can
    /// be divided by a weight) to 44.37, off by less than 3e-5.
    pub fn exponential_q16(&mut self) -> u32 {
        let draw = NonZeroU64::new(self.next_u64()).unwrap_or(NonZeroU64::MIN);
        negative_ln_q16(draw).max(1)
    }
}

/// Rounded to nearest.
fn negative_ln_q16(k: NonZeroU64) -> u32 {
    const LN_2_Q24: u64 = 11_629_080;
    // log2 stays below 64 (tested at the ends), and 64 * 2^32 * LN_2_Q24 < 2^62.
    let log2 = (64 << 32) - log2_q32(k);
    ((log2 * LN_2_Q24 + (1 << 39)) >> 40) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn sequence_is_the_published_one() {
        let mut rng = Rng::new(1_234_567);
        let drawn: Vec<u64> = (0..3).map(|_| rng.next_u64()).collect();
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!(drawn, expected);
        assert_eq!(Rng::new(0).next_u32(), 0xE220_A839);
    }

    #[test]
    fn keyed_sequences_are_pinned() {
        let golden = |seed, purpose, robot, tick| {
            let mut rng = Rng::keyed(seed, purpose, robot, tick);
            [rng.next_u32(), rng.below(100), rng.exponential_q16()]
        };
        assert_eq!(golden(0, 0, 0, 0), [556_823_690, 4, 26214]);
        assert_eq!(golden(1, 2, 3, 4), [1_663_603_925, 27, 12336]);
        assert_eq!(golden(u64::MAX, u32::MAX, u32::MAX, u32::MAX), [519_683_194, 32, 31381]);
    }

    #[test]
    fn each_bit_of_the_key_changes_half_of_the_output() {
        let first = |seed, who: u64, tick| Rng::keyed(seed, (who >> 32) as u32, who as u32, tick).next_u64();
        let mut flipped = 0;
        let keys = 200u64;
        for k in 0..keys {
            let (seed, who, tick) = (k * 7, (k << 32) | (k + 1), k as u32 * 3);
            let base = first(seed, who, tick);
            for bit in 0..64 {
                for other in [first(seed ^ (1 << bit), who, tick), first(seed, who ^ (1 << bit), tick)] {
                    let distance = (base ^ other).count_ones();
                    assert!((8..=56).contains(&distance), "{distance} bits differ");
                    flipped += distance;
                }
            }
            for bit in 0..32 {
                flipped += (base ^ first(seed, who, tick ^ (1 << bit))).count_ones();
            }
        }
        let mean = f64::from(flipped) / (keys as f64 * 160.0);
        assert!((mean - 32.0).abs() < 0.2, "mean {mean}");
    }

    #[test]
    fn generators_of_neighbouring_keys_do_not_repeat_each_other() {
        let mut drawn = Vec::new();
        for robot in 0..50 {
            for tick in 0..50 {
                let mut rng = Rng::keyed(1, 1, robot, tick);
                drawn.extend((0..8).map(|_| rng.next_u64()));
            }
        }
        let count = drawn.len();
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), count);
    }

    #[test]
    fn below_covers_its_range_evenly() {
        let mut rng = Rng::new(7);
        for n in [1u32, 2, 3, 8, 10, 97] {
            let per_bin = 2_000.0;
            let mut counts = std::vec![0u32; n as usize];
            for _ in 0..n * 2_000 {
                counts[rng.below(n) as usize] += 1;
            }
            let chi_square: f64 =
                counts.iter().map(|&c| (f64::from(c) - per_bin) * (f64::from(c) - per_bin) / per_bin).sum();
            // Five deviations.
            let freedom = f64::from(n - 1);
            assert!(chi_square <= freedom + 5.0 * (2.0 * freedom).sqrt(), "n {n}: {chi_square}");
        }
    }

    #[test]
    fn below_stays_in_range_at_the_ends() {
        let mut rng = Rng::new(3);
        assert_eq!(rng.below(0), 0);
        assert_eq!(rng.below(1), 0);
        let highest = (0..1000).map(|_| rng.below(u32::MAX)).max().unwrap();
        assert!(highest < u32::MAX && highest > u32::MAX / 100 * 99);
    }

    #[test]
    fn chance_follows_its_probability() {
        let mut rng = Rng::new(11);
        let hits = (0..100_000).filter(|_| rng.chance_q32(u32::MAX / 10 * 3)).count();
        assert!((29_300..30_700).contains(&hits), "{hits}");
        assert!((0..1000).all(|_| !rng.chance_q32(0)));
        assert!((0..1000).all(|_| rng.chance_q32(u32::MAX)));
    }

    #[test]
    fn logarithm_agrees_with_libm() {
        let mut rng = Rng::new(5);
        let mut worst: f64 = 0.0;
        let ends = [1, 2, 3, u64::MAX, u64::MAX - 1, 1 << 63, (1 << 63) - 1, 1 << 32];
        let random = (0..200_000).map(|i| (rng.next_u64() >> (i % 64)).max(1));
        for k in random.chain(ends) {
            let exact = -libm::log(k as f64 / 18_446_744_073_709_551_616.0);
            let got = f64::from(negative_ln_q16(NonZeroU64::new(k).unwrap())) / 65_536.0;
            worst = worst.max((got - exact).abs());
        }
        assert!(worst < 3e-5, "worst error {worst}");
    }

    #[test]
    fn logarithm_is_exact_at_its_ends() {
        assert_eq!(negative_ln_q16(NonZeroU64::MAX), 0);
        // 64 ln 2 = 44.361419
        assert_eq!(negative_ln_q16(NonZeroU64::MIN), 2_907_270);
    }

    #[test]
    fn exponential_has_mean_and_variance_one() {
        let mut rng = Rng::new(9);
        let n = 200_000u32;
        let samples: Vec<f64> = (0..n).map(|_| f64::from(rng.exponential_q16()) / 65_536.0).collect();
        let mean = samples.iter().sum::<f64>() / f64::from(n);
        let variance = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / f64::from(n);
        assert!(samples.iter().all(|&x| x > 0.0));
        assert!((mean - 1.0).abs() < 0.01, "mean {mean}");
        assert!((variance - 1.0).abs() < 0.03, "variance {variance}");
        let below = samples.iter().filter(|&&x| x < core::f64::consts::LN_2).count();
        assert!((99_000..101_000).contains(&below), "{below}");
    }
}
