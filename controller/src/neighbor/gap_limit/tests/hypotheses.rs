//! Decisions of the code against the hypotheses of the proof (`controller/proof`), computed again
//! in double precision: a random table and a random wish, one call of the rule.

use super::*;
use crate::neighbor::Trace;
use crate::robot::Mode;

const MARGIN_M: f64 = 0.003;
const SLACK_M: f64 = 0.0002;
/// Error of an offset; the code counts a little more, for rounding in single precision.
const ERROR_M: f64 = 0.00207;
/// Rounding of the operations in single precision.
const FLOAT_M: f64 = 2e-6;

/// A known robot, as the proof describes it.
struct Known {
    /// End of its last told path, as the own robot computes it, and its told motion in a step.
    seen_m: Vec3<f64>,
    told_m: Vec3<f64>,
    /// Steps in which it may have decided unheard.
    silent: i32,
    is_lost: bool,
    gives_way: bool,
    /// The stored bound, or how far a lost robot may have been from its place.
    kept_m: f64,
}

/// The world of one decision.
struct Case {
    step_s: f64,
    fastest_m: f64,
    keep_m: f64,
    is_synchronous: bool,
}

/// Violations of the hypotheses by the own motion, metres; at most 0 if there are none.
#[derive(Debug)]
struct Excess {
    /// Motion beyond what the gap allows.
    taken_m: f64,
    /// Stored bound beyond what both robots leave.
    kept_m: f64,
    /// Motion of a robot that may be inside the ball of another one.
    hidden_m: f64,
}

/// The largest approach of a motion to any place in a ball (`cone` in `controller/proof`).
fn approach(motion: Vec3<f64>, ahead: Vec3<f64>, sin: f64) -> f64 {
    let (closing, cos) = (motion.dot(ahead), (1.0 - sin * sin).max(0.0).sqrt());
    let side = (motion - ahead * closing).norm();
    if side * cos <= closing * sin { motion.norm() } else { closing * cos + side * sin }
}

impl Case {
    fn excess(&self, known: &Known, motion: Vec3<f64>, kept_m: f64) -> Excess {
        let distance_m = known.seen_m.norm();
        let ahead = known.seen_m * (1.0 / distance_m);
        let grown_m = self.fastest_m * f64::from(known.silent);
        let lost_m = if known.is_lost { known.kept_m } else { 0.0 };
        let reach_m = if known.silent > 0 { grown_m + lost_m + ERROR_M } else { 0.0 };
        if reach_m >= distance_m {
            return Excess { taken_m: 0.0, kept_m: 0.0, hidden_m: motion.norm() };
        }
        let ball_m = distance_m - self.keep_m - grown_m;
        let mut gap_m = ball_m;
        if known.silent > 0 && known.gives_way && !known.is_lost {
            gap_m = gap_m.max(known.kept_m - 2.0 * SLACK_M);
        }
        // The direction of an exactly known place is wrong by rounding only.
        let taken_m = approach(motion, ahead, reach_m.max(ERROR_M) / distance_m);
        let comes_m = if known.silent > 0 { self.fastest_m } else { -known.told_m.dot(ahead) };
        let allowed_m = if known.gives_way { gap_m / 2.0 } else { gap_m - comes_m };
        let mut over_m = taken_m - (allowed_m + SLACK_M).max(0.0);
        if known.silent == 0 && !self.is_synchronous {
            // The nearest point of the path that the other robot may still be on.
            let back = known.seen_m.dot(known.told_m) / known.told_m.dot(known.told_m).max(1e-12);
            let (begun_m, seen_m) = (known.seen_m - known.told_m, known.seen_m);
            let nearest_m = seen_m - known.told_m * back.clamp(0.0, 1.0);
            let beyond_m = nearest_m.norm() - self.keep_m;
            let toward_m = motion.dot(nearest_m) / nearest_m.norm();
            let away = |from_m: Vec3<f64>| motion.dot(from_m) + ERROR_M * motion.norm();
            let aside_m = toward_m - (beyond_m + SLACK_M).max(0.0);
            let retreat_m = away(begun_m).max(away(seen_m)) / self.keep_m;
            over_m = over_m.max(if beyond_m < -2.0 * SLACK_M { retreat_m } else { aside_m });
        }
        // Out of phase, receding does not count, and the first bound is halved twice.
        let (counted_m, halved) = match self.is_synchronous {
            true => (taken_m, 0.5),
            false => (taken_m.max(0.0), if gap_m <= ball_m { 0.25 } else { 0.5 }),
        };
        let left_m = if known.is_lost { known.kept_m } else { gap_m * halved - counted_m };
        Excess { taken_m: over_m, kept_m: kept_m - left_m, hidden_m: 0.0 }
    }
}

struct Draw(Rng);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.below(1_000_001)) / 1e6
    }

    fn direction(&mut self) -> Vec3<f64> {
        let angle = self.within(0.0, core::f64::consts::TAU);
        Vec3::new(libm::cos(angle), libm::sin(angle), 0.0)
    }

    fn is(&mut self, percent: u32) -> bool {
        self.0.below(100) < percent
    }
}

/// One random decision. Returns what it violates for each known robot, and whether the robot moves.
fn decision(number: u32) -> (StdVec<Excess>, bool) {
    let mut draw = Draw(Rng::keyed(55, number, 0, 0));
    let step_ms = [20, 50, 100, 250][draw.0.below(4) as usize];
    let (step, step_s) = (Duration::from_millis(step_ms), f64::from(step_ms) / 1e3);
    let radius_m = 0.05 * f64::from(1 + draw.0.below(12));
    let fastest_mps = f64::from(draw.within(0.1, 2.0) as f32);
    let case = Case {
        step_s,
        fastest_m: fastest_mps * step_s,
        keep_m: 2.0 * f64::from(radius_m as f32) + MARGIN_M,
        is_synchronous: draw.is(40),
    };
    let body = Body::<f32> {
        id: RobotId(1),
        velocity_mps: Vec3::ZERO,
        radius_m: radius_m as f32,
        max_speed_mps: fastest_mps as f32,
        max_acceleration_mps2: f32::MAX,
        step_s: step_s as f32,
    };
    let own = Position::from_metres([draw.within(-1e3, 1e3), draw.within(-1e3, 1e3), 0.0]).unwrap();
    let now = Instant::from_micros(u32::MAX / 2);
    let ages = Ages { stale_after: step.saturating_mul(2000), expire_after: step.saturating_mul(2000) };
    let mut table = NeighborTable::<f32, 4>::new(ages);
    let mut knowns = StdVec::new();
    let others = 1 + draw.0.below(3);
    for id in 2..2 + others {
        let silent = if draw.is(40) { 0 } else { 1 + draw.0.below(20) as i32 };
        // Mostly about as far away as the ball is large.
        let away_m = case.keep_m + draw.within(-0.01, 2.0) * case.fastest_m * f64::from(silent + 1) + 0.01;
        let offset = draw.direction() * if draw.is(20) { draw.within(0.05, 5.0) } else { away_m };
        let told = draw.direction() * draw.within(0.0, fastest_mps);
        let (mode, is_lost) = (if draw.is(15) { Mode::Fault } else { Mode::Cruise }, silent > 0 && draw.is(20));
        let [x, y] = [offset.x, offset.y].map(|at: f64| libm::round(at * 1e3) as i32);
        let mmps = |at: f64| libm::round(at * 1e3) as i32;
        let told_mmps = if is_lost { [0; 3] } else { [mmps(told.x), mmps(told.y), 0] };
        let least_m = if is_lost { 0.0 } else { -0.0005 };
        let kept_m = if draw.is(50) { 0.0 } else { draw.within(least_m, 2.0 * case.fastest_m) as f32 };
        // Late by less than an eighth of a step is not late.
        let jitter_us = if silent > 0 { draw.0.below(125 * step_ms as u32) as i32 } else { 0 };
        let heard = now - step.saturating_mul(silent + 1) - Duration::from_micros(jitter_us);
        let news = Neighbor::from_beacon(RobotId(id), &Beacon::default(), ProtocolId::NONE, heard);
        let known = Neighbor {
            position: Position::from_mm([own.mm[0] + x, own.mm[1] + y, own.mm[2]]),
            velocity_mps: Vec3::from_milli(told_mmps),
            radius_m: radius_m as f32,
            mode,
            trace: if is_lost { Trace::Lost } else { Trace::Heard },
            gap_m: kept_m,
            ..news
        };
        let _ = table.put(known, own, now, |_| false);
        let told_m = Vec3::<f64>::from_milli(told_mmps) * step_s;
        let seen_m = Vec3::new(f64::from(x) / 1e3, f64::from(y) / 1e3, 0.0) + told_m;
        let gives_way = mode.gives_way();
        knowns.push(Known { seen_m, told_m, silent, is_lost, gives_way, kept_m: kept_m.into() });
    }
    let rule = GapLimit {
        tick: step,
        elapsed: step,
        latency: step,
        is_synchronous: case.is_synchronous,
        inflation: StalenessInflation { growth_mps: fastest_mps as f32, max_m: 0.0 },
        // All lost robots may be moving.
        stands_after: Duration::MAX,
        ..still(&body, own, now)
    };
    if rule.is_bad(&table) != knowns.iter().any(|known| known.is_lost) {
        return (StdVec::new(), false);
    }
    let wish = draw.direction() * draw.within(0.2, 1.0) * fastest_mps;
    let got = rule.limit(&mut table, &[], wish.cast()).unwrap_or(Vec3::ZERO);
    let motion = got.cast() * case.step_s;
    let excess = |(id, known): (u32, &Known)| {
        let entry = table.entries.iter().find(|entry| entry.id == RobotId(id)).unwrap();
        case.excess(known, motion, entry.gap_m.into())
    };
    ((2..).zip(&knowns).map(excess).collect(), motion.norm() > 0.0)
}

#[test]
fn a_million_decisions_satisfy_the_hypotheses_of_the_proof() {
    // Fewer where random cases are few, too.
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok());
    let count = cases.map_or(1_000_000, |cases: u32| cases.min(1000) * 1000);
    let (mut moved, mut judged) = (0, 0);
    for number in 0..count {
        let (all, moves) = decision(number);
        moved += u32::from(moves);
        for excess in all {
            judged += 1;
            let Excess { taken_m, kept_m, hidden_m } = excess;
            assert!(taken_m <= FLOAT_M && kept_m <= FLOAT_M && hidden_m == 0.0, "decision {number}: {excess:?}");
        }
    }
    assert!(moved > count / 5 * 2 && judged > count, "{moved} motions, {judged} judged");
}
