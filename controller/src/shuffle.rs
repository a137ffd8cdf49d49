//! The weighted shuffle: moves in random order, cheap ones likelier in front.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 7, item 3; Efraimidis and Spirakis 2006, "Weighted random sampling with
//! a reservoir", algorithm A: sort by key = Exp(1) / w'. The paper leaves open how a cost w becomes a priority w'; here
//! w' = 2^(-(w - least) / h): the priority halves with every h of extra cost, so that only differences between moves
//! matter and h says what difference is noticed. Keys are compared by their logarithm, log2 Exp(1) + (w - least) / h,
//! in integers.
//!
//! What the paper asks of the shuffle holds: equal moves come first equally often, and "the probability
//! of a direction that breaks the formation is close to zero" (item 4), since a move that is k halvings
//! worse comes before the best one in 1 of 2^k + 1 draws. A w' like 1 / w would not do: on a long way all
//! w are large and nearly equal, and the robot would walk at random. Small h gives the greedy order
//! with ties drawn; the larger h, the oftener robots leave the best way, and the sooner two that block
//! each other part.

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
    /// Cheapest first, equals in the order of [`Dir::MOVES`]: no randomness. Two robots in each
    /// other's way can stay there for ever.
    #[default]
    Greedy,
    /// A move that costs so many ticks more than another one is half as likely to come first. 0 is
    /// the same as `Greedy`; large values walk at random.
    HalvedPer(Gain),
}

/// The moves that are not excluded, in the order in which they should be tried. O(1); always eight
/// draws, unless `Greedy`.
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
            // Eight moves, eight places.
            let _ = keyed.push((key, dir));
            // Equals stay in the order of the moves.
            sink_last(&mut keyed, |before, after| before.0 > after.0);
        }
    }
    list::collect(keyed.iter().map(|&(_, dir)| dir))
}

/// log2 Exp(1) + extra / half in Q.32, moved up so that it is never negative.
fn key(extra: Cost, half: Cost, rng: &mut Rng) -> u64 {
    let Some(halvings) = (u64::from(extra) << 32).checked_div(u64::from(half)) else {
        return u64::from(extra);
    };
    // At least 2^-16 as Q16.16, hence at least 1.
    let sample = NonZeroU64::new(u64::from(rng.exponential_q16())).unwrap_or(NonZeroU64::MIN);
    log2_q32(sample).saturating_add(halvings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::TICK;

    const TWO: Weights = Weights::new([3 * TICK, EXCLUDED, EXCLUDED, TICK, EXCLUDED, EXCLUDED, EXCLUDED, EXCLUDED]);

    #[test]
    fn greedy_sorts_by_cost_and_leaves_out_what_is_excluded() {
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
