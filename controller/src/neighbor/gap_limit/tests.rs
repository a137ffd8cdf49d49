use super::*;
use crate::geom::Vec2;
use crate::neighbor::Ages;
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::scalar::Q16;
use crate::wire::{Beacon, ProtocolId};
use proptest::prelude::*;
use std::vec::Vec as StdVec;

mod clocks;
mod counterexamples;
mod duel;
mod exhaustive;
mod hypotheses;
mod limits;
mod passive;

const STEP: Duration = Duration::from_millis(100);
const RADIUS_M: f64 = 0.15;
const STANDS_AFTER: Duration = Duration::from_millis(60_000);

fn moment(step: i32) -> Instant {
    Instant::from_micros(1) + STEP.saturating_mul(step)
}

/// The rule of a robot without a lag that was at rest.
fn still<S: Scalar>(body: &Body<S>, own: Position, now: Instant) -> GapLimit<'_, S> {
    GapLimit {
        body,
        own,
        own_mps: Vec3::ZERO,
        lag_s: S::ZERO,
        now,
        tick: STEP,
        elapsed: STEP,
        is_synchronous: true,
        latency: STEP,
        inflation: StalenessInflation { growth_mps: S::ONE, max_m: S::from_milli(100) },
        may_be_alone: false,
        stands_after: STANDS_AFTER,
        is_agreed: false,
        is_heard: true,
        downwash: S::ONE,
    }
}

/// A neighbour 0.2 m away, as it told, comes at 1 m/s: 0.1 m in this step, and half of the rest is
/// the own robot's, unless that neighbour does not know it.
#[test]
fn a_robot_that_is_not_heard_leaves_a_neighbour_all_of_its_path() {
    let mover = Mover::<f64>::new(1, [0.0; 3], f64::INFINITY);
    let limit = |is_heard| {
        let mut other = Mover::<f64>::new(2, [0.5, 0.0, 0.0], f64::INFINITY);
        other.body.velocity_mps = Vec3::new(-1.0, 0.0, 0.0);
        let (mut table, now) = (mover.table.clone(), moment(1));
        let _ = table.put(other.news(0), mover.position(), now, |_| false);
        let room = GapLimit { is_heard, ..still(&mover.body, mover.position(), now) };
        room.limit(&mut table, &[], Vec3::new(1.0, 0.0, 0.0)).expect("up to date").x
    };
    assert!((0.4..0.5).contains(&limit(true)), "{}", limit(true));
    assert!(limit(false) <= 0.0, "{}", limit(false));
}

/// One neighbour is fresh, and `lost` ones were last heard `silent` ago.
#[test]
fn lost_robots_that_have_stood_for_long_say_nothing_of_the_radio() {
    let body = Mover::<f64>::new(1, [0.0; 3], f64::INFINITY).body;
    let now = moment(2_000);
    let is_bad = |lost: u32, silent: Duration| {
        let mut table = NeighborTable::<f64, 4>::new(Ages { stale_after: STEP, expire_after: STEP });
        for id in 2..3 + lost {
            let (age, trace) = if id == 2 { (Duration::ZERO, Trace::Heard) } else { (silent, Trace::Lost) };
            let heard = Neighbor::from_beacon(RobotId(id), &Beacon::default(), ProtocolId::NONE, now - age);
            let _ = table.put(Neighbor { trace, ..heard }, Position::ORIGIN, now, |_| false);
        }
        still(&body, Position::ORIGIN, now).is_bad(&table)
    };
    assert_eq!([1, 2].map(|lost| is_bad(lost, STEP.saturating_mul(10))), [false, true]);
    assert_eq!([1, 2].map(|lost| is_bad(lost, STEP.saturating_mul(700))), [false, false]);
}

/// A velocity inside the cone, beside it, and one whose direction is known but for rounding.
#[test]
fn a_velocity_is_turned_until_its_approach_is_the_permitted_one() {
    let rule = still::<f64>;
    let body = Mover::new(1, [0.0; 3], f64::INFINITY).body;
    let rule = rule(&body, Position::ORIGIN, moment(1));
    for (sin, side, most_mps) in [(0.6, 0.2, 0.5), (0.6, 0.9, 0.7), (0.001, 0.3, 0.4)] {
        let cos = if sin < 0.01 { 1.0 } else { cos_of(sin, 1.0) };
        let limit = Limit { ahead: Vec3::new(1.0, 0.0, 0.0), slant: sin, cos, left_m: 0.0, growth_mps: 0.0 };
        let fast = Vec3::new(1.0, side, 0.0);
        let turned = fast + limit.ahead * limit.turn(&rule.pace(fast), most_mps);
        let approach = limit.approach(&rule.pace(turned));
        assert!((approach - most_mps).abs() < 1e-3, "{sin} {side}: {approach}");
    }
}

/// From 1 m/s a body with 2 m/s^2 covers half of its braking time, 0.25 s, and a step of 0.1 s.
#[test]
fn a_body_with_inertia_approaches_a_wall_as_fast_as_it_can_brake() {
    let body = Mover::new(1, [0.0; 3], 2.0).body;
    let rule = still::<f64>(&body, Position::ORIGIN, moment(1));
    let (room_m, rounding_m) = (0.14, f64::from(ROUNDING_MM) / 1000.0);
    let x = RADIUS_M + rounding_m + room_m;
    let wall = [Obstacle::Wall([Vec2::new(x, -1.0), Vec2::new(x, 1.0)])];
    let v = rule.before(&wall, Vec3::new(1.0, 0.0, 0.0));
    assert!((v.x - room_m / 0.35).abs() < 1e-6, "{v:?}");
}

/// At 0.4 m/s a body with a lag of 0.25 s rolls on for 0.1 m.
#[test]
fn a_body_with_a_lag_leaves_a_wall_the_way_that_it_rolls_on() {
    let body = Mover::new(1, [0.0; 3], f64::MAX).body;
    let room_m = 0.14;
    let x = RADIUS_M + f64::from(ROUNDING_MM) / 1000.0 + room_m;
    let wall = [Obstacle::Wall([Vec2::new(x, -1.0), Vec2::new(x, 1.0)])];
    let step_m = |lag_s| {
        let own_mps = Vec3::new(0.4, 0.0, 0.0);
        let rule = GapLimit { lag_s, own_mps, ..still(&body, Position::ORIGIN, moment(1)) };
        rule.before(&wall, Vec3::new(9.0, 0.0, 0.0)).x * body.step_s
    };
    assert!((step_m(0.0) - room_m).abs() < 1e-6 && (step_m(0.25) - (room_m - 0.1)).abs() < 1e-6);
}

/// A neighbour that comes at 1 m/s, 0.5 m away after its step. It covers 0.25 m while it brakes at
/// 2 m/s^2, and 0.2 m more with a lag of 0.2 s.
#[test]
fn a_neighbour_that_comes_nearer_is_left_the_way_on_which_it_stops() {
    for (most, lag_s, stops_m) in [(f64::MAX, 0.4, 0.4), (2.0, 0.0, 0.25), (2.0, 0.2, 0.45)] {
        let body = Mover::new(1, [0.0; 3], most).body;
        let mut other = Mover::<f64>::new(2, [0.6 + 2.0 * RADIUS_M, 0.0, 0.0], most);
        other.body.velocity_mps.x = -1.0;
        let rule = GapLimit { lag_s, ..still(&body, Position::ORIGIN, moment(1)) };
        let left_m = rule.limit_of(&mut other.news(0), STANDS_AFTER).0.left_m;
        assert!((left_m - (0.5 - stops_m).min(0.25)).abs() < 0.01, "{left_m} of 0.5 m less {stops_m} m");
    }
}

/// The ball of a lost robot may have moved, and the direction of its centre is as uncertain.
#[test]
fn the_direction_of_a_lost_robot_is_as_uncertain_as_its_place() {
    let body = Mover::new(1, [0.0; 3], f64::INFINITY).body;
    let rule = still::<f64>(&body, Position::ORIGIN, moment(5));
    let slant = |gap_m| {
        let news = Mover::<f64>::new(2, [2.0, 0.0, 0.0], f64::INFINITY).news(0);
        let mut lost = Neighbor { trace: Trace::Lost, gap_m, ..news };
        rule.limit_of(&mut lost, STANDS_AFTER).0.slant
    };
    assert!(((slant(0.3) - slant(0.0)) * 2.0 - 0.3).abs() < 1e-6, "{} {}", slant(0.0), slant(0.3));
}

struct Mover<S> {
    table: NeighborTable<S, 4>,
    body: Body<S>,
    at_m: Vec3<f64>,
    downwash: f64,
}

impl<S: Scalar> Mover<S> {
    fn new(id: u32, at_m: [f64; 3], max_acceleration_mps2: f64) -> Self {
        let ages = Ages { stale_after: STEP.saturating_mul(4), expire_after: STEP.saturating_mul(30) };
        let body = Body {
            id: RobotId(id),
            velocity_mps: Vec3::ZERO,
            radius_m: S::from_f64(RADIUS_M).unwrap(),
            max_speed_mps: S::ONE,
            max_acceleration_mps2: S::from_f64(max_acceleration_mps2).unwrap_or(S::MAX),
            step_s: S::from_micro(STEP.as_micros()),
        };
        Self { table: NeighborTable::new(ages), body, at_m: Vec3::new(at_m[0], at_m[1], at_m[2]), downwash: 1.0 }
    }

    fn position(&self) -> Position {
        Position::from_metres([self.at_m.x, self.at_m.y, self.at_m.z]).unwrap()
    }

    fn news(&self, step: i32) -> Neighbor<S> {
        let heard = Neighbor::from_beacon(self.body.id, &Beacon::default(), ProtocolId::NONE, moment(step));
        let Body { radius_m, velocity_mps, .. } = self.body;
        Neighbor { position: self.position(), velocity_mps, radius_m, ..heard }
    }

    fn decide(&self, step: i32, wish: Vec3<f64>, heard: &[Neighbor<S>]) -> Self {
        let Self { mut table, mut body, at_m, downwash } = Self { table: self.table.clone(), ..*self };
        let (own, now) = (self.position(), moment(step));
        table.expire((&self.body, self.body.step_s), now, (Duration::MAX, true), |_| {});
        for &neighbor in heard {
            let _ = table.put(neighbor, own, now, |_| false);
        }
        let inflation = StalenessInflation { growth_mps: S::ONE, max_m: body.radius_m };
        // With robots of both kinds.
        let (is_agreed, high) = (body.id.0 % 2 == 0, S::from_f64(downwash).unwrap());
        let room = GapLimit { inflation, is_agreed, downwash: high, ..still(&body, own, now) };
        let wish = wish.cast().clamp_norm(body.max_speed_mps);
        let velocity_mps = body.reach(room.limit(&mut table, &[], wish).unwrap_or(Vec3::ZERO));
        body.velocity_mps = velocity_mps;
        Self { table, body, at_m, downwash }
    }
}

/// The least gap at any wishes; `is_lost` drops packets by step, sender and receiver.
fn least_gap<S: Scalar>(
    mut movers: StdVec<Mover<S>>,
    steps: i32,
    wish: impl Fn(i32, usize) -> Vec3<f64>,
    mut is_lost: impl FnMut(i32, usize, usize) -> bool,
) -> f64 {
    let mut least = f64::MAX;
    let mut said: StdVec<_> = movers.iter().map(|mover| mover.news(0)).collect();
    for step in 1..=steps {
        let decided = movers.iter().enumerate().map(|(to, mover)| {
            let from =
                said.iter().enumerate().filter(|&(from, _)| from != to && (step == 1 || !is_lost(step, from, to)));
            mover.decide(step, wish(step, to), &from.map(|(_, news)| *news).collect::<StdVec<_>>())
        });
        movers = decided.collect();
        said = movers.iter().map(|mover| mover.news(step)).collect();
        for mover in &mut movers {
            mover.at_m += mover.body.velocity_mps.cast() * 0.1;
        }
        for (i, one) in movers.iter().enumerate() {
            for other in &movers[..i] {
                let offset_m = one.at_m - other.at_m;
                let lowered_m = Vec3::new(offset_m.x, offset_m.y, offset_m.z / one.downwash);
                least = least.min(lowered_m.norm() - 2.0 * RADIUS_M);
            }
        }
    }
    least
}

/// Up to twice the highest speed, mostly towards the middle.
fn wishes(seed: u32, size: f64, movers: usize) -> impl Fn(i32, usize) -> Vec3<f64> {
    move |step, robot| {
        let mut rng = Rng::keyed(7, seed, robot as u32, (step / 3) as u32);
        let mut draw = || f64::from(rng.below(4001)) / 1e3 - 2.0;
        let angle = robot as f64 / movers as f64 * core::f64::consts::TAU;
        let inwards = Vec3::new(-libm::cos(angle), -libm::sin(angle), 0.0);
        inwards + Vec3::new(draw(), draw(), draw() * size)
    }
}

fn circle<S: Scalar>(movers: usize, radius_m: f64, most: f64) -> StdVec<Mover<S>> {
    let at = |i: usize| i as f64 / movers as f64 * core::f64::consts::TAU;
    let mover = |i| Mover::new(i as u32 + 1, [radius_m * libm::cos(at(i)), radius_m * libm::sin(at(i)), 0.0], most);
    (0..movers).map(mover).collect()
}

fn lossy(seed: u32, percent: u32) -> impl FnMut(i32, usize, usize) -> bool {
    move |step, from, to| Rng::keyed(3, seed, (from * 8 + to) as u32, step as u32).below(100) < percent
}

proptest! {
    /// Losses from 60 to 100 % are excluded: a robot that only others receive is taken to stand.
    #[test]
    fn no_robots_touch_at_any_wishes_and_losses(
        seed in any::<u32>(), percent in prop_oneof![0..=60_u32, Just(100)], movers in 2..5_usize, radius_m in 0.25..1.5_f64, height in 0..2_u8,
    ) {
        let wish = || wishes(seed, height.into(), movers);
        let gap = least_gap(circle::<f32>(movers, radius_m, f64::MAX), 60, wish(), lossy(seed, percent));
        prop_assert!(gap > -1e-4, "{}", gap);
        let gap = least_gap(circle::<Q16>(movers, radius_m, f64::MAX), 60, wish(), lossy(seed, percent));
        prop_assert!(gap > -1e-3, "fixed: {}", gap);
    }

    /// Several robots at once: braking for one leaves less for the others.
    #[test]
    fn several_bodies_with_inertia_brake_for_all(
        seed in any::<u32>(), most in 0.3..4.0_f64, movers in 3..5_usize, radius_m in 0.6..4.0_f64,
    ) {
        let gap = least_gap(circle::<f64>(movers, radius_m, most), 150, wishes(seed, 0.0, movers), |_, _, _| false);
        prop_assert!(gap > -5e-3, "{}", gap);
    }

    /// Bodies fly into the columns below and above others, not only towards the others.
    #[test]
    fn flyers_with_inertia_keep_out_of_ellipsoids(
        seed in any::<u32>(), most in 0.3..6.0_f64, movers in 2..5_usize, radius_m in 0.4..3.0_f64, downwash in 1.0..6.0_f64,
        percent in 0..61_u32, rises_m in 0.0..2.0_f64,
    ) {
        let mut flyers = circle::<f64>(movers, radius_m, most);
        for (index, flyer) in flyers.iter_mut().enumerate() {
            flyer.downwash = downwash;
            flyer.at_m.z = rises_m * index as f64;
        }
        let loss = lossy(seed, if most < 1.0 { 0 } else { percent });
        let gap = least_gap(flyers, 150, wishes(seed, 1.0, movers), loss);
        prop_assert!(gap > -5e-3, "{}", gap);
    }

    #[test]
    fn bodies_with_inertia_brake_for_each_other_at_any_loss(
        seed in any::<u32>(), percent in 0..101_u32, most in 0.3..4.0_f64, apart_m in 0.4..6.0_f64,
    ) {
        let wish = |step: i32, robot: usize| {
            let back = Rng::keyed(5, seed, robot as u32, (step / 5) as u32).below(4) == 0;
            Vec3::new(if (robot == 0) == back { 1.0 } else { -1.0 }, 0.0, 0.0)
        };
        let movers = std::vec![Mover::new(1, [apart_m, 0.0, 0.0], most), Mover::<f32>::new(2, [0.0; 3], most)];
        let gap = least_gap(movers, 150, wish, lossy(seed, percent));
        // One case in some thousands exceeds it by 3 mm.
        prop_assert!(gap > -5e-3, "{}", gap);
    }
}

#[test]
fn a_robot_turned_aside_is_not_turned_into_a_wall() {
    use crate::geom::Vec2;
    let other = Mover::<f32>::new(2, [0.25, 0.25, 0.0], f64::MAX);
    let mover = Mover::<f32>::new(1, [0.0; 3], f64::MAX);
    let wall = [Obstacle::Wall([Vec2::new(-1.0, -0.16), Vec2::new(1.0, -0.16)])];
    let mut table = mover.table.clone();
    let _ = table.put(other.news(0), Position::ORIGIN, moment(1), |_| false);
    let room = still(&mover.body, Position::ORIGIN, moment(1));
    let east = Vec3::new(1.0, 0.0, 0.0);
    let open = room.limit(&mut table, &[], east).unwrap();
    assert!(open.y < -0.2 && open.x > 0.4, "{open:?}: aside");
    let beside = room.limit(&mut table, &wall, east).unwrap();
    assert!((0.0..=0.0101).contains(&(-beside.y * 0.1)), "{beside:?}");
}

#[test]
fn a_robot_pressed_against_a_wall_does_not_creep_into_it() {
    use crate::geom::Vec2;
    let other = Mover::<f32>::new(2, [0.25, 0.25, 0.0], f64::MAX);
    let mut mover = Mover::<f32>::new(1, [0.0; 3], f64::MAX);
    for step in 1..500 {
        let y = (-0.155 - mover.at_m.y) as f32;
        let wall = [Obstacle::Wall([Vec2::new(-9.0, y), Vec2::new(9.0, y)])];
        let (own, now) = (mover.position(), moment(step));
        let _ = mover.table.put(other.news(step - 1), own, now, |_| false);
        let room = still(&mover.body, own, now);
        let v = room.limit(&mut mover.table, &wall, Vec3::new(1.0, 0.0, 0.0)).unwrap();
        mover.at_m += v.cast() * 0.1;
        let gaps = (0.155 + mover.at_m.y - RADIUS_M, (other.at_m - mover.at_m).norm() - 2.0 * RADIUS_M);
        assert!(gaps.0 > 1e-3 && gaps.1 > 1e-3, "{gaps:?} in step {step}");
    }
}

/// A late beacon of a robot that gives way does not end the bound of the gap, unless that robot may
/// have decided twice since the own last decision.
#[test]
fn a_kept_gap_outlives_a_late_beacon_but_no_missed_decision() {
    let other = Mover::<f32>::new(2, [2.0 * RADIUS_M + 0.1, 0.0, 0.0], f64::MAX);
    let speed = |mode, steps, late_ms| {
        let mut mover = Mover::<f32>::new(1, [0.0; 3], f64::MAX);
        let own = Position::ORIGIN;
        let _ = mover.table.put(Neighbor { mode, ..other.news(0) }, own, moment(1), |_| false);
        still(&mover.body, own, moment(1)).limit(&mut mover.table, &[], Vec3::ZERO).unwrap();
        let late = Duration::from_millis(late_ms);
        // In a step beyond that of its beacon, it can have covered the gap.
        let (now, latency) = (moment(2) + late, STEP.saturating_mul(steps));
        let news = Neighbor { heard: now - latency - late, ..other.news(0) };
        let _ = mover.table.put(news, own, now, |_| false);
        let room = GapLimit { elapsed: now.since(moment(1)), latency, ..still(&mover.body, own, now) };
        room.limit(&mut mover.table, &[], Vec3::new(1.0, 0.0, 0.0)).unwrap().x
    };
    assert!(speed(Mode::Cruise, 3, 0) > 0.2);
    for (mode, steps, late_ms) in [(Mode::Cruise, 3, 60), (Mode::Cruise, 1, 60), (Mode::Fault, 3, 0)] {
        let speed = speed(mode, steps, late_ms);
        assert!(speed.abs() < 0.01, "{speed}: {mode:?}, {steps} steps, {late_ms} ms late");
    }
}

/// Another robot tells no course, so the third one may have turned at once.
#[test]
fn a_told_robot_may_have_left_its_course() {
    let mut other = Mover::<f32>::new(2, [1.2, 0.0, 0.0], 1.0);
    other.body.velocity_mps = Vec3::new(0.0, 1.0, 0.0);
    let ahead = |trace| {
        let mut mover = Mover::<f32>::new(1, [0.0; 3], f64::MAX);
        mover.body.max_acceleration_mps2 = 1.0;
        let _ = mover.table.put(Neighbor { trace, ..other.news(0) }, Position::ORIGIN, moment(1), |_| false);
        let room = still(&mover.body, Position::ORIGIN, moment(7));
        room.limit(&mut mover.table, &[], Vec3::new(1.0, 0.0, 0.0)).unwrap().x
    };
    let [heard, told] = [Trace::Heard, Trace::Told].map(ahead);
    assert!(told < 0.7 * heard, "{told}, heard {heard}");
}

/// 0.2 m behind a robot at 1 m/s, which brakes at 2 m/s^2 at most.
#[test]
fn a_robot_follows_closely_only_if_its_motion_is_agreed() {
    let speed = |is_agreed, other_mps: f32| {
        let (mut mover, mut other) = (Mover::<f32>::new(1, [0.0; 3], 2.0), Mover::<f32>::new(2, [0.0; 3], 2.0));
        other.at_m.x = 2.0 * RADIUS_M + 0.2;
        other.body.velocity_mps.x = other_mps;
        let (own, now) = (mover.position(), moment(1));
        let _ = mover.table.put(other.news(1), own, now, |_| false);
        mover.body.velocity_mps.x = 1.0;
        let room = GapLimit { is_agreed, ..still(&mover.body, own, now) };
        room.limit(&mut mover.table, &[], Vec3::new(1.0, 0.0, 0.0)).unwrap().x
    };
    assert!(speed(true, 1.0) > 0.99);
    assert_eq!(speed(false, 1.0), 0.0, "it brakes");
    assert_eq!(speed(true, 0.0), 0.0);
}

/// The place of a silent robot is uncertain, so a body that slides past it may slide towards it.
#[test]
fn a_body_with_a_lag_that_slides_past_a_silent_robot_takes_no_more_of_the_gap() {
    let other = Mover::<f32>::new(2, [2.0, 0.0, 0.0], f64::MAX);
    let speed_ahead = |own_mps, lag_s| {
        let mut mover = Mover::<f32>::new(1, [0.0; 3], f64::MAX);
        mover.body.max_speed_mps = 9.0;
        let _ = mover.table.put(other.news(0), Position::ORIGIN, moment(1), |_| false);
        let room = GapLimit { own_mps, lag_s, ..still(&mover.body, Position::ORIGIN, moment(11)) };
        room.limit(&mut mover.table, &[], Vec3::new(9.0, 0.0, 0.0)).unwrap().x
    };
    let without = speed_ahead(Vec3::ZERO, 0.0);
    let past = speed_ahead(Vec3::new(-1.0, 4.0, 0.0), 0.3);
    assert!(without > 1.0 && past < without, "{past}, without a lag {without}");
}

/// A body that follows each command exactly with its lag, with a wish at an angle to two walls; the
/// angle of the second one is to the first. Returns the least room, the last room and velocity.
fn into_a_corner(lag_s: f64, [speed, most, room_m]: [f64; 3], angles: [f64; 2]) -> (f64, f64, Vec3<f64>) {
    use crate::geom::Vec2;
    let mut mover = Mover::<f64>::new(1, [0.0; 3], most);
    mover.body.max_speed_mps = speed;
    let step_s = mover.body.step_s;
    let towards = |angle: f64| Vec2::new(libm::sin(angle), libm::cos(angle));
    let (wish, left) = (towards(angles[0]).extend(0.0) * speed, libm::exp(-step_s / lag_s));
    let (mut at_m, mut own_mps) = (Vec3::ZERO, Vec3::<f64>::ZERO);
    let (mut least_m, mut last_m) = (f64::MAX, 0.0);
    for step in 1..1500 {
        let walls = [0.0, angles[1]].map(towards);
        let away_m = walls.map(|ahead| RADIUS_M + room_m - at_m.xy().dot(ahead));
        last_m = away_m[0].min(away_m[1]) - RADIUS_M;
        least_m = least_m.min(last_m);
        let room = GapLimit { own_mps, lag_s, ..still(&mover.body, Position::ORIGIN, moment(step)) };
        let wall = |one: usize| [-99.0, 99.0].map(|along| walls[one] * away_m[one] + walls[one].perp() * along);
        let walls = [0, 1].map(|one| Obstacle::Wall(wall(one)));
        let command = mover.body.reach(room.limit(&mut mover.table, &walls, wish).unwrap());
        at_m += command * step_s + (own_mps - command) * (lag_s * (1.0 - left));
        own_mps = command + (own_mps - command) * left;
        mover.body.velocity_mps = command;
    }
    (least_m, last_m, own_mps)
}

#[test]
fn a_body_with_a_lag_that_leaves_one_wall_does_not_drift_into_another() {
    let (least_m, ..) = into_a_corner(
        0.02,
        [3.9868672048254665, 4.059969165583248, 4.521906200311978],
        [-0.34857750415964317, -0.6211719813638684],
    );
    assert!(least_m > 0.0, "{least_m}");
}

proptest! {
    #[test]
    fn a_body_with_inertia_or_a_lag_stops_before_walls(
        lag_s in prop_oneof![Just(0.0), 0.02..2.0_f64], speed in 0.2..4.0_f64, most in 0.3..5.0_f64,
        room_m in 0.01..9.0_f64, angle in -1.2..1.2_f64, corner in prop_oneof![Just(0.0), -1.4..1.4_f64],
    ) {
        let (least_m, last_m, own_mps) = into_a_corner(lag_s, [speed, most, room_m], [angle, corner]);
        prop_assert!(least_m > 0.0 && last_m < 0.02, "{least_m} {last_m}");
        // Along a single wall nothing holds it up.
        let along_mps = libm::sin(angle).abs() * speed;
        prop_assert!(corner != 0.0 || own_mps.x.abs() >= 0.9 * along_mps, "{own_mps:?} of {along_mps}");
    }

    #[test]
    fn a_body_with_inertia_does_not_touch_the_corners_of_a_block(
        most in 0.3..5.0_f64, turn in 0.0..6.3_f64, wishes in proptest::collection::vec(-1.5..1.5_f64, 40),
    ) {
        use crate::geom::Vec2;
        let corners = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]].map(|[x, y]| Vec2::new(x, y));
        let mut mover = Mover::<f64>::new(1, [0.0; 3], most);
        let towards = |angle: f64| Vec2::new(libm::cos(angle), libm::sin(angle));
        let mut at_m = towards(turn) * 2.0;
        for step in 0..800 {
            let walls = [0, 1, 2, 3].map(|one| Obstacle::Wall([one, (one + 1) % 4].map(|end| corners[end] - at_m)));
            let least_m = walls.iter().filter_map(Obstacle::nearest_point).map(|(_, away_m)| away_m).fold(9.0, f64::min);
            prop_assert!(least_m >= RADIUS_M, "{least_m} at {at_m:?}, step {step}");
            // Wishes towards the block, and past it.
            let to_block = libm::atan2(-at_m.y, -at_m.x);
            let wish = towards(to_block + wishes[(step / 20) as usize]) * mover.body.max_speed_mps;
            let room = still(&mover.body, Position::ORIGIN, moment(step + 1));
            let command = room.limit(&mut mover.table, &walls, wish.extend(0.0)).unwrap();
            mover.body.velocity_mps = mover.body.reach(command);
            at_m += mover.body.velocity_mps.xy() * mover.body.step_s;
        }
    }
}
