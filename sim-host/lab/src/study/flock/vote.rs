//! Votes of robots that choose one of several goals together, by the votes of the robots in range.

use staya_controller::agent::GOALS;
use staya_controller::rand::Rng;
use staya_sim::choice;

const VOTES: u32 = 0x0046_0401;

choice! {
    /// Rule by which a robot changes its vote in each step.
    pub enum Rule {
        /// Robots do not vote: each chooses a goal at random.
        None = "none",
        /// Each takes the most frequent vote among the robots in range and itself. It keeps its own
        /// in a tie.
        Majority = "majority",
        /// Each keeps shares of all goals, moves them towards those of the robots in range, and
        /// votes for the goal with the largest one. The mean shares of a connected crowd tend to
        /// those of the first votes.
        Shares = "shares",
    }
}

/// Shares of the goals in a robot's opinion; their sum is 1.
pub(super) type Shares = [f64; GOALS];

/// First vote of a robot among `goals` ones: the first goal with probability `first`, otherwise one
/// of the others.
pub(super) fn first(goals: usize, first: f64, seed: u64, robot: u32) -> Shares {
    let mut rng = Rng::keyed(seed, VOTES, robot, 0);
    let others = u32::try_from(goals).unwrap_or(u32::MAX).saturating_sub(1);
    let is_first = others == 0 || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 <= first;
    of(if is_first { 0 } else { 1 + rng.below(others) as usize })
}

/// The goal with the largest share, the earlier one of equals.
pub(super) fn choice(shares: &Shares) -> usize {
    (1..GOALS).fold(0, |best, goal| if shares[goal] > shares[best] { goal } else { best })
}

/// Opinion after a step, from that of this robot and those of the robots in range. Shares converge
/// with a `weight` below the reciprocal of the largest number of these. As it is the same for all
/// robots, the mean is kept. O(others).
pub(super) fn next<'a>(
    rule: Rule,
    own: &Shares,
    others: impl Iterator<Item = &'a Shares> + Clone,
    weight: f64,
) -> Shares {
    match rule {
        Rule::None => *own,
        Rule::Majority => {
            let mut counts = [0_u32; GOALS];
            others.map(choice).chain([choice(own)]).for_each(|goal| counts[goal] += 1);
            let most = counts.into_iter().max().unwrap_or(0);
            let kept = Some(choice(own)).filter(|goal| counts[*goal] == most);
            of(kept.or_else(|| counts.iter().position(|count| *count == most)).unwrap_or(0))
        }
        Rule::Shares => {
            let change = |goal: usize| others.clone().map(|other| other[goal] - own[goal]).sum::<f64>();
            std::array::from_fn(|goal| own[goal] + weight * change(goal))
        }
    }
}

fn of(goal: usize) -> Shares {
    std::array::from_fn(|other| f64::from(u8::from(other == goal)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn majority_follows_the_most_and_keeps_its_own_vote_in_a_tie() {
        let [a, b, c] = [0, 1, 2].map(of);
        assert_eq!(choice(&next(Rule::Majority, &c, [a, b, b].iter(), 0.1)), 1);
        assert_eq!(choice(&next(Rule::Majority, &b, [a, b, a].iter(), 0.1)), 1);
        assert_eq!(choice(&next(Rule::Majority, &c, [].iter(), 0.1)), 2);
        assert_eq!(next(Rule::None, &c, [a, a].iter(), 0.1), c);
    }

    #[test]
    fn shares_of_a_chain_tend_to_those_of_the_first_votes() {
        let mut all: Vec<Shares> = (0..20).map(|robot| first(3, 0.8, 7, robot)).collect();
        let mean = |all: &[Shares]| -> Shares {
            std::array::from_fn(|goal| all.iter().map(|shares| shares[goal]).sum::<f64>() / all.len() as f64)
        };
        let before = mean(&all);
        for _ in 0..4000 {
            let others = |robot: usize| [robot.checked_sub(1), Some(robot + 1)].into_iter().flatten();
            all = (0..20)
                .map(|robot| next(Rule::Shares, &all[robot], others(robot).filter_map(|other| all.get(other)), 0.4))
                .collect();
        }
        for shares in &all {
            assert!(shares.iter().zip(before).all(|(share, mean)| (share - mean).abs() < 1e-2), "{shares:?}");
        }
        assert!(all.iter().all(|shares| choice(shares) == choice(&before)));
    }

    #[test]
    fn first_votes_are_for_the_first_goal_with_its_probability() {
        let share = |first_share: f64| {
            (0..1000).filter(|robot| choice(&first(3, first_share, 5, *robot)) == 0).count() as f64 / 1000.0
        };
        assert!((share(0.4) - 0.4).abs() < 0.05 && share(1.0) == 1.0);
        assert!((0..100).all(|robot| choice(&first(1, 0.0, 5, robot)) == 0));
    }
}
