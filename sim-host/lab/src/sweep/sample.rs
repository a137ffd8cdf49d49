//! Random samples in 0..1: functions of seed, axis and number only.

use staya_controller::rand::Rng;
use staya_sim::choice;

const PLACE: u32 = u32::from_be_bytes(*b"swpl");
const ORDER: u32 = u32::from_be_bytes(*b"swor");

choice! {
    /// Sampling method.
    pub enum Kind {
        /// Independent values.
        Random = "random",
        /// One sample in each equal part of each axis (McKay, Beckman and Conover 1979).
        LatinHypercube = "latin_hypercube",
    }
}

/// O(count).
pub fn shares(kind: Kind, seed: u64, axis: u32, count: u32) -> Vec<f64> {
    let within = |number: u32| {
        // 53 bits: all multiples of 2^-53 below 1 are equally likely.
        let bits = Rng::keyed(seed, PLACE, axis, number).next_u64() >> 11;
        bits as f64 / (1u64 << 53) as f64
    };
    match kind {
        Kind::Random => (0..count).map(within).collect(),
        Kind::LatinHypercube => {
            let mut parts: Vec<u32> = (0..count).collect();
            let mut random = Rng::keyed(seed, ORDER, axis, count);
            for last in (1..count).rev() {
                parts.swap(last as usize, random.below(last + 1) as usize);
            }
            let share = |(number, part): (u32, u32)| (f64::from(part) + within(number)) / f64::from(count);
            (0..).zip(parts).map(share).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latin_hypercube_has_one_sample_in_each_part_of_each_axis() {
        for count in [1, 2, 7, 100] {
            for axis in 0..4 {
                let mut parts: Vec<u32> = shares(Kind::LatinHypercube, 5, axis, count)
                    .iter()
                    .map(|share| (share * f64::from(count)) as u32)
                    .collect();
                parts.sort_unstable();
                assert_eq!(parts, (0..count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn samples_are_spread_and_differ_between_axes() {
        for kind in [Kind::Random, Kind::LatinHypercube] {
            let [a, b] = [0, 1].map(|axis| shares(kind, 9, axis, 2000));
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            assert!((mean(&a) - 0.5).abs() < 0.03 && (mean(&b) - 0.5).abs() < 0.03);
            let together: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - 0.5) * (b - 0.5)).collect();
            assert!(mean(&together).abs() < 0.01, "{}", mean(&together));
            assert!(a.iter().all(|share| (0.0..1.0).contains(share)));
            assert_eq!(a, shares(kind, 9, 0, 2000));
            assert_ne!(a, shares(kind, 10, 0, 2000));
        }
    }
}
