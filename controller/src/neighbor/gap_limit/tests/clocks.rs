//! Robots that decide by clocks of their own, at any wishes and losses.

use super::duel::{Duel, Rules, towards};
use super::*;

/// The losses, delays and clocks of a random duel.
#[derive(Clone, Copy, Debug)]
struct Chances {
    /// Losses of single packets, and the share of time in fades of a link, percent.
    lost: u32,
    fading: u32,
    /// Decisions that come late, percent, by up to three steps.
    late: u32,
    /// Clocks are slow by up to this, millionths.
    drift_ppm: u32,
    /// Longest time that the radio takes beyond the steps that are known, percent of a step.
    delay: u32,
}

/// Wishes to the other robot, to where it was, past it on either side, away, anywhere, or none.
fn wish(duel: &Duel, me: usize, rng: &mut Rng) -> Vec3<f64> {
    let other = (me + 1 + rng.below(duel.robots.len() as u32 - 1) as usize) % duel.robots.len();
    let side = if rng.below(2) == 0 { 1.0 } else { -1.0 };
    let angle = side * f64::from(rng.below(1000)) / 1e3;
    match rng.below(8) {
        0..=2 => towards(duel, me, duel.at_m(other), 0.3 * angle),
        3 => towards(duel, me, duel.begun_m(other), 0.3 * angle),
        4 => towards(duel, me, duel.robots[other].to_m, side * core::f64::consts::FRAC_PI_2 + 0.2 * angle),
        5 => towards(duel, me, duel.at_m(other), core::f64::consts::PI + angle),
        6 => towards(duel, me, duel.at_m(other), core::f64::consts::PI * angle),
        _ => Vec3::ZERO,
    }
}

/// The least gap of random robots in a ring, metres, over a number of decisions.
fn least_gap(rules: Rules, chances: Chances, (robots, gap_m): (usize, f64), decisions: u32, seed: u32) -> f64 {
    let step_us = i64::from(rules.step_ms) * 1000;
    let mut rng = Rng::keyed(u64::from(seed), 1, 0, 0);
    let ring_m = (rules.radius_m + gap_m / 2.0) / libm::sin(core::f64::consts::PI / robots as f64);
    let angle = |index: usize| index as f64 / robots as f64 * core::f64::consts::TAU;
    let places: StdVec<_> =
        (0..robots).map(|index| [ring_m * libm::cos(angle(index)), ring_m * libm::sin(angle(index))]).collect();
    let phases: StdVec<_> =
        (0..robots).map(|_| if rules.is_synchronous { 1 } else { 1 + i64::from(rng.below(step_us as u32)) }).collect();
    let drifts: StdVec<_> = (0..robots).map(|_| i64::from(rng.below(chances.drift_ppm + 1))).collect();
    let mut duel = Duel::new(rules, &places, &phases);
    let mut wishes: StdVec<Vec3<f64>> = std::vec![Vec3::ZERO; robots];
    for turn in 0..decisions {
        let deciding = duel.wait();
        for &me in &deciding {
            // A wish lasts for some steps.
            if rng.below(3) == 0 {
                wishes[me] = wish(&duel, me, &mut rng);
            }
        }
        let wished: StdVec<_> = deciding.iter().map(|&me| wishes[me]).collect();
        let hears = |to: usize, from: usize| {
            let link = (to * 8 + from) as u32;
            let fades = Rng::keyed(u64::from(seed), 2, link, turn / 16).below(100) < chances.fading;
            !fades && Rng::keyed(u64::from(seed), 3, link, turn).below(100) >= chances.lost
        };
        let most = chances.delay + 100 * (rules.latency as u32 - 1);
        let delay_us = step_us * i64::from(rng.below(most + 1)) / 100;
        let is_late = !rules.is_synchronous && rng.below(100) < chances.late;
        // Mostly a little, sometimes by several steps.
        let most_us = if rng.below(4) == 0 { 3 * step_us } else { step_us / 3 };
        let late_us = if is_late { i64::from(rng.below(most_us as u32)) } else { 0 };
        let drift_us = step_us * drifts[deciding[0]] / 1_000_000;
        duel.decide(&deciding, &wished, hears, (delay_us, late_us + drift_us));
    }
    duel.wait();
    duel.least_m
}

fn rules() -> impl Strategy<Value = Rules> {
    let expires = prop_oneof![Just(0), 2..9_i32];
    let steps = prop_oneof![Just(20), Just(50), Just(100), Just(200)];
    let others = (expires, any::<bool>(), prop_oneof![Just(1), 1..5_i32]);
    (steps, 0.1..3.0_f64, 1..10_u32, others).prop_map(|(step_ms, fastest_mps, size, others)| {
        let (expires, is_synchronous, latency) = others;
        // A step covers at most twice the radius.
        let radius_m = (f64::from(size) * 0.05).max(fastest_mps * f64::from(step_ms) / 2e3);
        let radius_m = libm::round(radius_m * 1e3) / 1e3;
        Rules { step_ms, fastest_mps, radius_m, expires, is_synchronous, latency }
    })
}

fn chances() -> impl Strategy<Value = Chances> {
    let some = || prop_oneof![Just(0), 0..100_u32];
    (some(), some(), prop_oneof![Just(0), 0..101_u32], prop_oneof![Just(0), Just(50), Just(500)], 0..26_u32)
        .prop_map(|(lost, fading, late, drift_ppm, delay)| Chances { lost, fading, late, drift_ppm, delay })
}

proptest! {
    #[test]
    fn robots_with_any_clocks_do_not_touch_at_any_wishes_and_losses(
        rules in rules(), chances in chances(), robots in 2..5_usize, gap in 0..1000_u32, seed in any::<u32>(),
    ) {
        // From side by side to two steps apart.
        // Of several robots a lost one counts as standing.
        let rules = Rules { expires: if robots > 2 { 0 } else { rules.expires }, ..rules };
        let step_m = rules.fastest_mps * f64::from(rules.step_ms) / 1e3;
        let gap_m = 0.003 + 2.0 * step_m * libm::pow(f64::from(gap) / 1e3, 3.0);
        let least_m = least_gap(rules, chances, (robots, gap_m), 400, seed);
        prop_assert!(least_m > 0.0, "{least_m}");
    }
}
