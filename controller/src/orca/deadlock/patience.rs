//! A robot that makes no progress for long backs off.
//!
//! Robots that push against each other can stand still forever, since each takes at most half of a
//! gap ([`GapLimit`](crate::neighbor::GapLimit)). A stuck robot moves a random short distance back
//! or aside: two equal moves would meet again. RVO2's examples disturb all wishes instead (J. van
//! den Berg et al., "Reciprocal n-body collision avoidance", ISRR 2009).

use crate::geom::Vec2;
use crate::orca::dimension::Situation;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A robot is stuck if its progress is below this share of its wish, thousandths.
const STUCK: i32 = 150;
/// Shortest distance to back off, thousandths of the own radius. Less does not let a robot pass.
const BACK: i32 = 2_000;

/// A robot's recent progress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Patience<S> {
    /// Recent mean velocity, or the one to back off with, m/s.
    course_mps: Vec2<S>,
    left: S,
}

impl<S: Scalar> Patience<S> {
    pub(in crate::orca) const NEW: Self = Self { course_mps: Vec2::ZERO, left: S::ZERO };

    /// The wish, or a velocity to back off with if the robot made no progress in the time in which
    /// it could have moved about four times `patience` own radii.
    pub(in crate::orca) fn wish(
        &mut self,
        situation: &Situation<'_, Vec2<S>>,
        wish: Vec2<S>,
        patience: S,
        rng: &mut Rng,
    ) -> Vec2<S> {
        let body = situation.body;
        let step = (body.max_speed_mps * body.step_s).checked_div(body.radius_m).unwrap_or(S::ZERO);
        if self.left > S::ZERO {
            let way = self.course_mps;
            self.left -= step;
            if self.left <= S::ZERO {
                *self = Self::NEW;
            }
            return way;
        }
        if wish == Vec2::ZERO {
            *self = Self::NEW;
            return wish;
        }
        if self.course_mps == Vec2::ZERO {
            self.course_mps = wish;
        }
        let mut rate = step.checked_div(patience * S::TWO).unwrap_or(S::ONE).min(S::ONE);
        if body.has_inertia() {
            // A body that speeds up at its full acceleration is not stuck.
            let change_mps = body.max_acceleration_mps2 * body.step_s;
            rate = rate.min(change_mps.checked_div(wish.norm()).unwrap_or(S::ONE));
        }
        self.course_mps += (body.velocity_mps.xy() - self.course_mps) * rate;
        if self.course_mps.norm() >= wish.norm() * S::from_milli(STUCK) {
            return wish;
        }
        let mut share = || S::from_ratio(rng.below(1000).cast_signed(), 1000);
        let (sin, cos) = (S::PI * (S::HALF + share())).sin_cos();
        let left = S::from_milli(BACK) * (S::ONE + share());
        *self = Self { course_mps: wish.rotate(cos, sin), left };
        self.course_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::orca::fixtures::{STEP_S, body};
    use crate::scalar::Q16;
    use std::vec::Vec;

    /// The wishes in 1000 steps of a robot that wants to move east and achieves this share of it.
    fn wishes<S: Scalar>(share: S) -> Vec<Vec2<S>> {
        let (mut patience, mut rng) = (Patience::NEW, Rng::keyed(1, 2, 3, 4));
        let east = Vec2::new(S::HALF, S::ZERO);
        let mut body = body::<S, 2>(1, [0.0, 0.0]);
        let mut wish = || {
            let situation = Situation { body: &body, wish: east, goal: Some(east), nearby: &[], obstacles: &[] };
            let wish = patience.wish(&situation, east, S::from_i32(5), &mut rng);
            body.velocity_mps = Vec3::new(wish.x * share, wish.y * share, S::ZERO);
            wish
        };
        (0..1000).map(|_| wish()).collect()
    }

    fn backs_off<S: Scalar>() {
        let east = Vec2::new(S::HALF, S::ZERO);
        let got = wishes(S::ZERO);
        let first = got.iter().position(|wish| *wish != east).unwrap();
        // The mean falls to 15 % within 19 radii: 2.85 m.
        assert!((100..130).contains(&first), "{first}");
        let back = got[first..].iter().take_while(|wish| **wish != east).count();
        let radii = back as f64 * 0.5 * STEP_S / 0.15;
        assert!((2.0..4.2).contains(&radii), "{radii}");
        assert!(got[first].x < S::from_milli(2) && got[first..first + back].iter().all(|wish| *wish == got[first]));
        let speeds = got.iter().map(|wish| wish.norm().to_f64());
        assert!(speeds.into_iter().all(|speed| (speed - 0.5).abs() < 1e-3));
        assert!(got[first + back..].iter().any(|wish| *wish != east), "again and again");
        assert!(wishes(S::from_milli(200)).iter().all(|wish| *wish == east), "a slowly moving robot continues");
    }

    #[test]
    fn stuck_robots_back_off_by_two_to_four_radii_in_any_direction_but_ahead() {
        let east = Vec2::new(0.5, 0.0);
        let body = body::<f64, 2>(1, [0.0, 0.0]);
        let situation = Situation { body: &body, wish: east, goal: Some(east), nearby: &[], obstacles: &[] };
        let back = |seed: u32| {
            // One step before its mean falls to 15 %.
            let mut patience = Patience { course_mps: east * 0.15, left: 0.0 };
            let way = patience.wish(&situation, east, 5.0, &mut Rng::keyed(1, 2, 3, seed));
            (way, patience.left)
        };
        let all: Vec<_> = (0..200).map(back).collect();
        let within = |values: Vec<f64>, low: f64, high: f64| {
            let (least, most) = values.into_iter().fold((9.0, -9.0), |(a, b), x| (x.min(a), x.max(b)));
            assert!((low..low + 0.1).contains(&least) && (high - 0.1..=high).contains(&most), "{least} {most}");
        };
        within(all.iter().map(|(way, _)| way.x).collect(), -0.5, 0.001);
        within(all.iter().map(|(way, _)| way.y).collect(), -0.5, 0.5);
        within(all.iter().map(|(_, left)| *left).collect(), 2.0, 4.0);
    }

    #[test]
    fn a_stuck_robot_backs_off_and_tries_again() {
        backs_off::<f64>();
        backs_off::<f32>();
        backs_off::<Q16>();
    }
}
