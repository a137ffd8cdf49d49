//! Division of the world into blocks of equal load by recursive bisection (M. J. Berger, S. H.
//! Bokhari, A Partitioning Strategy for Nonuniform Problems on Multiprocessors, 1987). Cuts
//! influence the load but not the results, so samples of robots suffice.

use serde::{Deserialize, Serialize};

/// A robot that represents several, with their load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sample {
    pub(super) place_m: [f64; 2],
    pub(super) load: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cut {
    Rank(usize),
    At { axis: usize, place_m: f64, below: Box<Cut>, above: Box<Cut> },
}

impl Cut {
    pub(super) fn new(samples: &mut [Sample], ranks: usize) -> Self {
        Self::bisect(samples, 0, ranks.max(1))
    }

    fn bisect(samples: &mut [Sample], first: usize, ranks: usize) -> Self {
        if ranks == 1 {
            return Self::Rank(first);
        }
        let extent = |axis: usize| {
            let places = samples.iter().map(|sample| sample.place_m[axis]);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        // Map rows are contiguous in memory: for equal extents, blocks consist of whole rows.
        let axis = usize::from(extent(0) <= extent(1));
        samples.sort_by(|a, b| a.place_m[axis].total_cmp(&b.place_m[axis]));
        let lower = ranks / 2;
        let half = samples.iter().map(|sample| sample.load).sum::<f64>() * lower as f64 / ranks as f64;
        let mut load = 0.0;
        let split = samples.iter().position(|sample| {
            load += sample.load;
            load > half
        });
        let split = split.unwrap_or(samples.len());
        let place_m = match (split.checked_sub(1).and_then(|at| samples.get(at)), samples.get(split)) {
            (Some(low), Some(high)) => (low.place_m[axis] + high.place_m[axis]) / 2.0,
            (Some(one), None) | (None, Some(one)) => one.place_m[axis],
            (None, None) => 0.0,
        };
        let (low, high) = samples.split_at_mut(split);
        Self::At {
            axis,
            place_m,
            below: Box::new(Self::bisect(low, first, lower)),
            above: Box::new(Self::bisect(high, first + lower, ranks - lower)),
        }
    }

    pub(super) fn rank(&self, at_m: [f64; 2]) -> usize {
        match self {
            Self::Rank(rank) => *rank,
            Self::At { axis, place_m, below, above } => {
                if at_m[*axis] < *place_m {
                    below.rank(at_m)
                } else {
                    above.rank(at_m)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::rand::Rng;

    #[test]
    fn blocks_have_equal_loads_for_any_number_of_ranks() {
        let mut draws = Rng::new(1);
        let mut unit = || f64::from(draws.below(1_000_000)) / 1e6;
        let places = (0..20_000).map(|_| [unit() * unit() * 300.0, unit() * unit() * 200.0]);
        let samples: Vec<_> =
            places.map(|at| Sample { place_m: at, load: if at[0] < 50.0 { 2.0 } else { 1.0 } }).collect();
        let whole: f64 = samples.iter().map(|sample| sample.load).sum();
        for ranks in [1, 2, 3, 4, 7, 8, 64] {
            let cut = Cut::new(&mut samples.clone(), ranks);
            let mut loads = vec![0.0; ranks];
            for sample in &samples {
                loads[cut.rank(sample.place_m)] += sample.load;
            }
            for load in loads {
                let share = load * ranks as f64 / whole;
                assert!((0.95..1.05).contains(&share), "{share} with {ranks} ranks");
            }
        }
    }

    #[test]
    fn coincident_robots_and_no_robots_can_be_cut() {
        let one = Sample { place_m: [3.0, 4.0], load: 1.0 };
        for samples in [vec![], vec![one], vec![one; 9]] {
            let cut = Cut::new(&mut samples.clone(), 4);
            assert!(cut.rank([3.0, 4.0]) < 4);
        }
    }
}
