//! Cases in which earlier forms of the rule let robots touch.

use super::duel::{Duel, Rules, towards};
use super::*;

/// Two robots, side by side and 3 mm apart, that decide at the same instants.
fn side_by_side(rules: Rules) -> Duel {
    Duel::new(rules, &[[0.0, 0.0], [2.0 * rules.radius_m + 0.003, 0.0]], &[1, 1])
}

/// Drives side by side for `silent` steps in which nothing is heard, then at an angle towards the
/// other robot for ten more. Returns the least gap, metres.
fn side_by_side_then_inwards(rules: Rules, silent: usize, angle: f64) -> f64 {
    let mut duel = side_by_side(rules);
    let up = Vec3::new(0.0, rules.fastest_mps, 0.0);
    for step in 0..silent + 13 {
        let deciding = duel.wait();
        let at_m = [duel.at_m(0), duel.at_m(1)];
        let wishes = match step {
            0 => [Vec3::ZERO; 2],
            _ if step < silent + 3 => [up; 2],
            _ => [towards(&duel, 0, at_m[1], angle), towards(&duel, 1, at_m[0], -angle)],
        };
        duel.decide(&deciding, &wishes, |_, _| step < 3, (1, 0));
    }
    duel.wait();
    duel.least_m
}

/// A robot that recedes from the last known place of a silent one can approach the silent one. With
/// the sine of the angle alone the robots drive through each other.
#[test]
fn robots_that_fall_silent_side_by_side_may_turn_inwards() {
    for expires in [0, 5] {
        for (radius_m, fastest_mps, step_ms) in [(0.15, 1.0, 100), (0.5, 1.0, 50), (0.5, 0.3, 50)] {
            let rules = Rules { step_ms, fastest_mps, radius_m, expires, ..Rules::COMMON };
            for silent in (1..20).chain([30]) {
                for angle in 0..16 {
                    let least_m = side_by_side_then_inwards(rules, silent, f64::from(angle) * 0.1);
                    assert!(least_m > 0.0, "{least_m} {rules:?}, {silent} silent steps, angle {angle}");
                }
            }
        }
    }
}

/// Robots that are received in each step drive side by side at full speed.
#[test]
fn robots_side_by_side_are_not_slowed_down() {
    let mut duel = side_by_side(Rules::COMMON);
    for _ in 0..20 {
        let deciding = duel.wait();
        duel.decide(&deciding, &[Vec3::new(0.0, 1.0, 0.0); 2], |_, _| true, (1, 0));
    }
    let apart_m = (duel.robots[1].to_m - duel.robots[0].to_m).norm();
    assert!(duel.robots.iter().all(|robot| robot.to_m.y > 1.98) && apart_m < 0.306, "{apart_m}");
}

/// Silent robots side by side drive on, and a little apart.
#[test]
fn silent_robots_side_by_side_drive_on() {
    let mut duel = side_by_side(Rules::COMMON);
    for step in 0..20 {
        let deciding = duel.wait();
        duel.decide(&deciding, &[Vec3::new(0.0, 1.0, 0.0); 2], |_, _| step < 3, (1, 0));
    }
    let apart_m = (duel.robots[1].to_m - duel.robots[0].to_m).norm();
    assert!(duel.robots.iter().all(|robot| robot.to_m.y > 1.98) && apart_m < 0.34, "{apart_m}");
}

/// One robot is silent and the other, which hears everything, drives around it. The silent one
/// takes the accepted excess in each step: small motions to the side on which the other robot is.
#[test]
fn the_accepted_excess_does_not_add_up() {
    for (radius_m, fastest_mps, step_ms) in [(0.5, 0.1, 50), (0.5, 0.3, 20), (0.15, 0.2, 20)] {
        let rules = Rules { step_ms, fastest_mps, radius_m, ..Rules::COMMON };
        let mut duel = side_by_side(rules);
        let start = duel.at_m(1);
        let hidden = (2.0 * radius_m / fastest_mps * 1e3 / f64::from(step_ms)) as usize;
        for step in 0..hidden {
            let deciding = duel.wait();
            let at_m = [duel.at_m(0), duel.at_m(1)];
            let around = towards(&duel, 1, at_m[0], core::f64::consts::FRAC_PI_2 - 0.2);
            let side = towards(&duel, 0, start, core::f64::consts::FRAC_PI_2);
            let side = if side.dot(at_m[1] - at_m[0]) >= 0.0 { side } else { -side };
            let slant = fastest_mps * f64::from(step_ms) / 1e3 * step as f64 / (2.0 * radius_m);
            let slow = side * (0.99e-4 / slant.max(1e-3) / (f64::from(step_ms) / 1e3) / fastest_mps);
            let wishes = if step < hidden / 3 { [Vec3::ZERO, around] } else { [slow, Vec3::ZERO] };
            duel.decide(&deciding, &wishes, |to, _| to == 1 || step == 0, (1, 0));
        }
        assert!(duel.least_m > 0.0, "{} {rules:?}", duel.least_m);
    }
}

/// Nothing is lost, but one robot decides half a step after the other, and sometimes stands.
#[test]
fn robots_out_of_phase_drive_towards_each_other() {
    for (fastest_mps, step_ms) in [(1.0, 100), (2.0, 100), (1.0, 50)] {
        let rules = Rules { step_ms, fastest_mps, is_synchronous: false, ..Rules::COMMON };
        let step_us = i64::from(step_ms) * 1000;
        for gap in 1..20 {
            for stands in 0..64_u32 {
                let gap_m = f64::from(gap) / 10.0 * fastest_mps * f64::from(step_ms) / 1e3;
                let places = [[0.0, 0.0], [2.0 * RADIUS_M + gap_m, 0.0]];
                let mut duel = Duel::new(rules, &places, &[1, 1 + step_us / 2]);
                for turn in 0..24 {
                    let deciding = duel.wait();
                    let ahead = if deciding[0] == 0 { fastest_mps } else { -fastest_mps };
                    let wish = if turn < 6 && stands >> turn & 1 == 1 { 0.0 } else { ahead };
                    duel.decide(&deciding, &[Vec3::new(wish, 0.0, 0.0)], |_, _| true, (1, 0));
                }
                assert!(duel.least_m > 0.0, "{} {rules:?}, gap {gap}, {stands:b}", duel.least_m);
            }
        }
    }
}

/// A robot passes another one, which decides just after it and heads for where it still is. The
/// ends of both paths are far enough apart, the paths are not.
#[test]
fn a_robot_keeps_off_the_path_that_another_one_is_still_on() {
    for fastest_mps in [1.0, 3.0] {
        let rules = Rules { fastest_mps, is_synchronous: false, ..Rules::COMMON };
        let mut duel = Duel::new(rules, &[[0.0, 0.0], [2.0 * RADIUS_M + 0.004, 0.0]], &[1, 1001]);
        for _ in 0..2 {
            let deciding = duel.wait();
            let wish = if deciding[0] == 1 { Vec3::new(0.0, fastest_mps, 0.0) } else { Vec3::ZERO };
            duel.decide(&deciding, &[wish], |_, _| true, (1, 0));
        }
        // Robot 1 was first asked to stand, robot 2 to pass; both decide again.
        duel.robots[0].due_us = 1001 + 2000;
        let deciding = duel.wait();
        let wish = Vec3::new(fastest_mps, 0.0, 0.0);
        duel.decide(&deciding, &[wish], |_, _| true, (1, 0));
        duel.wait();
        assert!(duel.least_m > 0.0, "{} at {fastest_mps} m/s", duel.least_m);
    }
}
