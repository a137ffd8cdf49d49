//! All losses and wishes of two robots in a few decisions.

use super::duel::{Duel, Rules, towards};
use super::*;
use core::f64::consts::{FRAC_PI_2, PI};

/// Wishes: towards the other robot, to either side, away, or none.
const WISHES: [Option<f64>; 5] = [Some(0.0), Some(FRAC_PI_2), Some(-FRAC_PI_2), Some(PI), None];

/// Lets all robots that decide next have all wishes and hear or not hear the other one; in the last
/// decision each drives towards the other. Returns the least gap, metres, and the number of ends.
fn search(duel: &Duel, decisions: u32) -> (f64, u64) {
    let mut duel = duel.clone();
    let deciding = duel.wait();
    let is_last = decisions <= deciding.len() as u32;
    let wishes = if is_last { &WISHES[..1] } else { &WISHES };
    let (mut least_m, mut ends) = (f64::MAX, 0);
    let choices = wishes.len() * 2;
    for choice in 0..choices.pow(deciding.len() as u32) {
        let of = |turn: usize| choice / choices.pow(turn as u32) % choices;
        let wish = |(turn, &me): (usize, &usize)| {
            let angle = wishes[of(turn) / 2];
            angle.map_or(Vec3::ZERO, |angle| towards(&duel, me, duel.at_m(1 - me), angle))
        };
        let wished: StdVec<_> = deciding.iter().enumerate().map(wish).collect();
        let hears = |to: usize, _| of(deciding.iter().position(|&me| me == to).unwrap()) % 2 == 0;
        let mut next = duel.clone();
        next.decide(&deciding, &wished, hears, (1, 0));
        let (found_m, found) = if is_last {
            next.wait();
            (next.least_m, 1)
        } else {
            search(&next, decisions - deciding.len() as u32)
        };
        (least_m, ends) = (least_m.min(found_m), ends + found);
    }
    (least_m, ends)
}

fn all(rules: Rules, first_us: [i64; 2], decisions: u32) {
    for gap_m in [0.003, 0.05, 0.25] {
        let mut duel = Duel::new(rules, &[[0.0, 0.0], [2.0 * rules.radius_m + gap_m, 0.0]], &first_us);
        for _ in 0..if first_us[0] == first_us[1] { 1 } else { 2 } {
            let deciding = duel.wait();
            let wishes = std::vec![Vec3::ZERO; deciding.len()];
            duel.decide(&deciding, &wishes, |_, _| true, (1, 0));
        }
        let (least_m, ends) = search(&duel, decisions);
        assert!(least_m > 0.0, "{least_m} of {ends} ends from {gap_m} m, {rules:?}");
        assert!(ends > 10_000, "{ends}");
    }
}

#[test]
fn no_losses_and_wishes_of_six_decisions_let_two_robots_touch() {
    all(Rules::COMMON, [1, 1], 6);
    all(Rules { is_synchronous: false, ..Rules::COMMON }, [1, 50_001], 6);
}

#[test]
#[ignore = "takes minutes"]
fn no_losses_and_wishes_of_eight_decisions_let_two_robots_touch() {
    all(Rules::COMMON, [1, 1], 8);
    for phase_us in [1000, 25_000, 50_000, 99_000] {
        all(Rules { is_synchronous: false, ..Rules::COMMON }, [1, 1 + phase_us], 7);
    }
}
