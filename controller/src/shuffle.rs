//! The weighted shuffle: moves in random order, with cheap moves more likely to come first (A. V.
//! Kuznetsov 2017, KUZ, section 7, item 3).
//!
//! Moves are sorted by key = Exp(1) / w' (Efraimidis and Spirakis 2006, "Weighted random sampling
//! with a reservoir", algorithm A). The paper does not define how a cost w becomes a priority w'.
//! Here w' = 2^(-(w - least) / h): the priority halves with every h of extra cost, so only
//! differences between moves matter. With 1 / w a robot on a long route, where all w are nearly
//! equal, would move at random.
//!
//! Equal moves come first equally often, and a move that is k halvings worse comes before the best
//! one in 1 of 2^k + 1 draws, so "the probability of a direction that breaks the formation is close
//! to zero" (item 4).
//!
//! A small h gives the greedy order with random ties. The larger h is, the more often robots leave
//! the best route, and the sooner two robots that block each other separate.

use crate::cost::{Cost, EXCLUDED, Gain, Weights};
use crate::grid::{Dir, UNIT};
use crate::list::{self, sink_last};
use crate::rand::Rng;
use crate::scalar::integer::log2_q32;
use core::num::NonZeroU64;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// How strictly the order follows the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sharpness {
    /// Cheapest first, equals in the order of [`Dir::MOVES`]. Two robots can block each other for
    /// ever.
    #[default]
    Greedy,
    /// A move that costs this many ticks more is half as likely to come first. 0 equals `Greedy`;
    /// large values give a random walk.
    HalvedPer(Gain),
}

/// Returns the open moves in the order in which to try them. O(1); eight draws, none with `Greedy`.
#[must_use]
pub fn weighted_shuffle(weights: &Weights, sharpness: Sharpness, rng: &mut Rng) -> Vec<Dir, 8> {
    let least = weights.iter().map(|(_, cost)| cost).min().unwrap_or(0);
    let half = match sharpness {
        Sharpness::Greedy => 0,
        Sharpness::HalvedPer(gain) => gain.of(UNIT),
    };
    let mut keyed = Vec::<(u64, Dir), 8>::new();
    for (dir, cost) in weights.iter() {
        let key = key(cost - least, half, rng);
        if cost != EXCLUDED {
            let _ = keyed.push((key, dir));
            sink_last(&mut keyed, |before, after| before.0 > after.0);
        }
    }
    list::collect(keyed.iter().map(|&(_, dir)| dir))
}

/// log2 Exp(1) + extra / half in Q.32, shifted so that it is never negative.
fn key(extra: Cost, half: Cost, rng: &mut Rng) -> u64 {
    let Some(halvings) = (u64::from(extra) << 32).checked_div(u64::from(half)) else {
        return u64::from(extra);
    };
    // At least 2^-16 in Q16.16, so at least 1 as an integer.
    let sample = NonZeroU64::new(u64::from(rng.exponential_q16())).unwrap_or(NonZeroU64::MIN);
    log2_q32(sample).saturating_add(halvings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::TICK;

    const TWO: Weights = Weights::new([3 * TICK, EXCLUDED, EXCLUDED, TICK, EXCLUDED, EXCLUDED, EXCLUDED, EXCLUDED]);

    #[test]
    fn greedy_sorts_by_cost_without_excluded_moves() {
        let order = weighted_shuffle(&TWO, Sharpness::Greedy, &mut Rng::new(1));
        assert_eq!(order, [Dir::NorthWest, Dir::East]);
        let none = weighted_shuffle(&Weights::CLOSED, Sharpness::Greedy, &mut Rng::new(1));
        assert!(none.is_empty());
        let even = weighted_shuffle(&Weights::new([5; 8]), Sharpness::Greedy, &mut Rng::new(1));
        assert_eq!(even, Dir::MOVES);
    }

    #[test]
    fn first_place_follows_the_priorities() {
        // Two ticks more at one halving per tick: priorities 1 and 1/4, so first in 1 of 5 cases.
        let sharpness = Sharpness::HalvedPer(Gain::ONE);
        let mut rng = Rng::new(2);
        let firsts = (0..20_000).filter(|_| weighted_shuffle(&TWO, sharpness, &mut rng)[0] == Dir::East).count();
        // Five standard deviations of a binomial(20000, 0.2) are 283.
        assert!(firsts.abs_diff(4_000) < 283, "{firsts}");
    }

    #[test]
    fn extreme_costs_keep_their_order() {
        let mut weights = Weights::CLOSED;
        weights.set(Dir::South, EXCLUDED - 1);
        weights.set(Dir::North, 0);
        let finest = Sharpness::HalvedPer(Gain::from_sixteenths(1));
        let order = weighted_shuffle(&weights, finest, &mut Rng::new(3));
        assert_eq!(order, [Dir::North, Dir::South]);
    }
}
