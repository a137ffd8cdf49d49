//! The numbers of a limit, by hand.

use super::*;

type V = Vec3<f64>;

const ERROR_M: f64 = OFFSET_ERROR_UM as f64 / 1e6;
const TOLERANCE_M: f64 = TOLERANCE_UM as f64 / 1e6;
/// Both radii and the gap that remains.
const RADII_M: f64 = 2.0 * RADIUS_M + ROUNDING_MM as f64 / 1e3;

fn v(x: f64, y: f64) -> V {
    Vec3::new(x, y, 0.0)
}

fn is_close(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-9
}

fn body(most: f64) -> Body<f64> {
    Mover::new(1, [0.0; 3], most).body
}

/// Towards the east, where the direction is known exactly.
fn east(left_m: f64, growth_mps: f64) -> Limit<f64> {
    Limit { ahead: v(1.0, 0.0), slant: 0.0, cos: 1.0, left_m, growth_mps }
}

#[test]
fn a_shortened_velocity_takes_the_gap_that_is_left() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    for (closing, growth_mps, brake_s, left_m) in
        [(2.0, 0.0, 0.5, 0.3), (2.0, 0.4, 0.5, 0.3), (0.8, 0.7, 1.5, 0.9), (5.0, 1.0, 0.2, 0.01)]
    {
        let share = east(left_m, growth_mps).share(&rule.pace(v(closing, 0.3)), 0.1, brake_s);
        // Half as fast, it brakes in half of the time.
        let brake_s = brake_s * share;
        let taken_m = share * closing * (0.1 + brake_s * 0.5) + growth_mps * brake_s;
        assert!(share < 1.0 && is_close(taken_m, left_m), "{closing} {growth_mps}: {share} takes {taken_m}");
    }
    // A body that stops at once exceeds the gap by the tolerance in the unshortened velocity only.
    let share = |left_m: f64| east(left_m, 9.0).share(&rule.pace(v(2.0, 0.0)), 0.1, 0.0);
    assert!(is_close(share(0.1) * (0.2 - TOLERANCE_M), 0.1));
    assert_eq!([share(0.2 - 0.9 * TOLERANCE_M), share(0.0), share(-0.1)], [1.0, 0.0, 0.0]);
    assert!(share(0.2 - 1.1 * TOLERANCE_M) < 1.0);
    // A velocity that leads away is not shortened.
    assert_eq!(east(0.0, 9.0).share(&rule.pace(v(-0.1, 0.3)), 0.1, 0.5), 1.0);
    assert_eq!(east(-0.1, 0.0).share(&rule.pace(v(0.0, 0.3)), 0.1, 0.0), 1.0);
}

#[test]
fn cosines_leave_room_for_rounding() {
    assert!(is_close(cos_of(3.0, 5.0), 0.8));
    assert_eq!([cos_of(6.0, 5.0), cos_of(5.0, 5.0), cos_of(1.0, 0.0)], [0.0; 3]);
    assert!(is_close(cos_of(0.0, 5.0), 1.0 - 1e-6));
}

#[test]
fn a_pace_is_below_what_twice_its_speed_does_not_exceed() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    for speed in [0.25, 1.0, 3.0] {
        let pace = rule.pace(v(0.0, speed));
        assert!(pace.is_below(2.001 * speed) && !pace.is_below(1.999 * speed), "{speed}");
    }
}

#[test]
fn the_approach_to_a_cone_is_the_largest_in_it() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    let wide = Limit { slant: 0.6, cos: 0.8, ..east(0.0, 0.0) };
    let narrow = Limit { slant: 0.01, ..east(0.0, 0.0) };
    for (velocity, wanted) in [
        (v(2.0, 1.0), v(2.0, 1.0).norm()),
        (v(-1.0, 2.0), 2.0 * 0.6 - 0.8),
        (v(1.0, 2.0), 0.8 + 1.2),
        (v(-1.0, 0.0), -0.8),
    ] {
        let approach = wide.approach(&rule.pace(velocity));
        assert!(is_close(approach, wanted), "{velocity:?}: {approach}");
    }
    assert!(is_close(narrow.approach(&rule.pace(v(0.6, 0.8))), 0.61));
    assert!(is_close(narrow.approach(&rule.pace(v(1.0, 0.0))), 1.0), "no more than the speed");
}

#[test]
fn the_turn_of_a_velocity_that_no_turn_slows_down_is_its_speed() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    let turn = |slant, cos, velocity, most| Limit { slant, cos, ..east(0.0, 0.0) }.turn(&rule.pace(velocity), most);
    assert!(is_close(turn(0.6, 0.8, v(1.0, 2.0), 0.4), (0.4 - 1.2) / 0.8 - 1.0));
    assert!(is_close(turn(0.99, 0.01, v(0.0, 1.0), 0.1), -1.0), "not faster away");
    assert!(is_close(turn(1.0, 0.0, v(0.0, 1.0), 0.1), -1.0), "the neighbour may be anywhere");
    assert!(is_close(turn(0.01, 1.0, v(1.0, 0.5), 0.4), 0.4 - 0.9 * 0.01 - 1.0));
    assert!(is_close(turn(0.6, 0.8, v(1.0, 0.3), 0.5), 0.4 - 1.0), "within the cone the speed counts");
}

#[test]
fn only_with_a_lag_does_the_own_velocity_count_beside_the_command() {
    let body = body(f64::MAX);
    let taken_m = |lag_s, is_synchronous, command: V, own: V| {
        let rule = GapLimit { lag_s, is_synchronous, ..still(&body, Position::ORIGIN, moment(1)) };
        rule.taken_m(&east(0.0, 0.0), &rule.pace(command), &rule.pace(own))
    };
    let (slow, fast, back) = (v(0.2, 0.0), v(0.7, 0.0), v(-0.4, 0.0));
    assert!(is_close(taken_m(0.0, true, slow, fast), 0.02));
    assert!(is_close(taken_m(0.1, true, slow, fast), 0.07));
    assert!(is_close(taken_m(0.1, true, fast, slow), 0.07));
    assert!(is_close(taken_m(0.0, true, back, fast), -0.04));
    assert!(is_close(taken_m(0.0, false, back, fast), 0.0), "the other one may take half of it");
}

#[test]
fn a_robot_decides_once_per_tick_after_its_state_was_first_used() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    for (age_us, steps) in [
        (100_000, 0),
        (112_500, 0),
        (112_501, 1),
        (212_500, 1),
        (212_501, 2),
        (12_501, 0),
        (12_500, -1),
        (-87_499, -1),
        (-87_500, -2),
    ] {
        assert_eq!(rule.silent_steps(age_us), steps, "{age_us}");
    }
    let late = GapLimit { latency: STEP.saturating_mul(3), ..rule };
    assert_eq!(late.silent_steps(112_501), 1, "no later than one tick");
    let early = GapLimit { latency: Duration::ZERO, ..rule };
    assert_eq!([early.silent_steps(12_500), early.silent_steps(12_501)], [0, 1]);
}

/// A robot 2 m to the east that was heard in step 0 and comes at 0.5 m/s.
fn comes(change: impl FnOnce(&mut Neighbor<f64>)) -> Neighbor<f64> {
    let mut other = Mover::<f64>::new(2, [2.0, 0.0, 0.0], f64::MAX).news(0);
    other.velocity_mps.x = -0.5;
    change(&mut other);
    other
}

#[test]
fn an_up_to_date_robot_is_at_the_end_of_its_path() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    let gap_m = 1.95 - RADII_M;
    let mut other = comes(|_| {});
    let (limit, is_here) = rule.limit_of(&mut other, STANDS_AFTER);
    assert!(is_close(limit.left_m, gap_m / 2.0) && limit.growth_mps == 0.0 && !is_here);
    assert!(is_close(limit.slant, ERROR_M / (1.95 - ERROR_M / 2.0)) && limit.cos == 1.0, "{}", limit.slant);
    assert!((limit.ahead - v(1.0, 0.0)).norm() < 1e-12 && is_close(other.gap_m, gap_m));
    // Out of phase it may take half of the gap before the own decision.
    let out_of_phase = GapLimit { is_synchronous: false, ..rule };
    let _ = out_of_phase.limit_of(&mut other, STANDS_AFTER);
    assert!(is_close(other.gap_m, gap_m / 2.0));
    // One that does not give way may take all of it, and goes on.
    let (limit, _) = rule.limit_of(&mut comes(|other| other.mode = Mode::Fault), STANDS_AFTER);
    assert!(is_close(limit.left_m, gap_m - 0.05) && is_close(limit.growth_mps, 0.5));
    let leaves = |other: &mut Neighbor<f64>| (other.mode, other.velocity_mps.x) = (Mode::Fault, 0.5);
    let (limit, _) = rule.limit_of(&mut comes(leaves), STANDS_AFTER);
    assert!(is_close(limit.left_m, 2.05 - RADII_M + 0.05) && limit.growth_mps == 0.0);
    // A body with a lag still covers the way on which it rolls.
    let rolls = GapLimit { lag_s: 0.2, own_mps: v(0.4, 0.0), ..rule };
    let (limit, _) = rolls.limit_of(&mut comes(|other| other.velocity_mps.x = 0.0), STANDS_AFTER);
    assert!(is_close(limit.left_m, (2.0 - RADII_M) / 2.0 - 0.4 * 0.2), "{}", limit.left_m);
    // Only an agreed motion leaves it the way on which it brakes.
    let heavy = super::Body { max_acceleration_mps2: 2.0, ..body };
    let left_m = |is_agreed, mps: f64| {
        let rule = GapLimit { is_agreed, body: &heavy, ..rule };
        rule.limit_of(&mut comes(|other| other.velocity_mps.x = mps), STANDS_AFTER).0.left_m
    };
    assert!(is_close(left_m(true, 0.5) - left_m(false, 0.5), heavy.braking_m(0.5)) && heavy.braking_m(0.5) > 0.0);
}

#[test]
fn a_silent_robot_is_in_a_ball_that_grows() {
    let body = body(f64::MAX);
    // Three steps beyond the one of its path.
    let rule = still(&body, Position::ORIGIN, moment(4));
    let ball_m = 1.95 - RADII_M - 0.3;
    let cone = |limit: &Limit<f64>, reach_m: f64, distance_m: f64| {
        is_close(limit.slant, reach_m / distance_m) && is_close(limit.cos, cos_of(reach_m, distance_m))
    };
    let (limit, is_here) = rule.limit_of(&mut comes(|_| {}), STANDS_AFTER);
    assert!(is_close(limit.left_m, ball_m / 2.0) && is_close(limit.growth_mps, 0.5) && !is_here);
    assert!(cone(&limit, ERROR_M + 0.3, 1.95), "{} {}", limit.slant, limit.cos);
    // A bound of the last gap holds, less the tolerance of both, unless it decided twice since.
    let kept_m = 1.5 - 2.0 * TOLERANCE_M;
    for (gap_m, elapsed, left_m) in [(1.5, 1, kept_m), (0.9, 1, ball_m), (1.5, 2, ball_m)] {
        let mut other = comes(|other| other.gap_m = gap_m);
        let rule = GapLimit { elapsed: STEP.saturating_mul(elapsed), ..rule };
        let (limit, _) = rule.limit_of(&mut other, STANDS_AFTER);
        assert!(is_close(limit.left_m, left_m / 2.0), "{gap_m} {elapsed}: {}", limit.left_m);
        assert!(is_close(other.gap_m, left_m));
    }
    // One that does not give way takes all that it can.
    let (limit, _) = rule.limit_of(&mut comes(|other| other.mode = Mode::Fault), STANDS_AFTER);
    assert!(is_close(limit.left_m, ball_m - 0.1) && is_close(limit.growth_mps, 1.0));
    // A lost one stands once its ball has its full size; its place is as uncertain as its gap.
    for (parked_after, grown_m, growth_mps) in [(STANDS_AFTER, 0.3, 0.5), (STEP, 0.1, 0.0)] {
        let mut lost = comes(|other| (other.trace, other.gap_m) = (Trace::Lost, 0.4));
        let (limit, _) = rule.limit_of(&mut lost, parked_after);
        assert!(is_close(limit.left_m, (1.95 - RADII_M - grown_m) / 2.0), "{}", limit.left_m);
        assert!(is_close(limit.growth_mps, growth_mps) && cone(&limit, ERROR_M + grown_m + 0.4, 1.95));
        assert!(is_close(lost.gap_m, 0.4), "its gap is not a bound any more");
    }
    // Its age is four steps.
    let growth_mps =
        |parked_after| rule.limit_of(&mut comes(|other| other.trace = Trace::Lost), parked_after).0.growth_mps;
    assert_eq!(growth_mps(STEP.saturating_mul(4)), 0.5);
    assert_eq!(growth_mps(Duration::from_micros(4 * STEP.as_micros() - 1)), 0.0);
    let (limit, _) = rule.limit_of(&mut comes(|_| {}), STEP);
    assert!(is_close(limit.left_m, ball_m / 2.0), "one that is not lost never stands");
    // No velocity is known of one that another robot has told of.
    let (limit, _) = rule.limit_of(&mut comes(|other| other.trace = Trace::Told), STANDS_AFTER);
    assert!(is_close(limit.left_m, (ball_m + 0.05) / 2.0));
    // Its ball reaches the own place.
    let here = |x_m: f64| {
        let near = |other: &mut Neighbor<f64>| {
            (other.position, other.velocity_mps) = (Position::from_metres([x_m, 0.0, 0.0]).unwrap(), V::ZERO);
        };
        rule.limit_of(&mut comes(near), STANDS_AFTER).1
    };
    assert!(here(0.302) && !here(0.303));
}

#[test]
fn a_silent_body_with_inertia_leaves_its_course_gradually() {
    let body = body(2.0);
    let rule = still(&body, Position::ORIGIN, moment(4));
    // In 0.3 s and a step it swerves by 0.8 m/s.
    let (limit, _) = rule.limit_of(&mut comes(|_| {}), STANDS_AFTER);
    assert!(is_close(limit.left_m, (1.8 - RADII_M - 0.12) / 2.0), "{}", limit.left_m);
    assert!(is_close(limit.growth_mps, (0.5 + 0.8) / 2.0) && is_close(limit.slant, (ERROR_M + 0.12) / 1.8));
    // A lost one that stands, one without a known course, and one that turns fast do not.
    let lost = |other: &mut Neighbor<f64>| other.trace = Trace::Lost;
    let (limit, _) = rule.limit_of(&mut comes(lost), STEP);
    assert!(is_close(limit.left_m, (1.95 - RADII_M - 0.1) / 2.0) && limit.growth_mps == 0.0);
    let (limit, _) = rule.limit_of(&mut comes(|other| other.trace = Trace::Told), STANDS_AFTER);
    assert!(is_close(limit.left_m, (2.0 - RADII_M - 0.3) / 2.0) && is_close(limit.growth_mps, 0.5));
    let agile = super::Body { max_acceleration_mps2: 5.1, ..body };
    let (limit, _) = GapLimit { body: &agile, ..rule }.limit_of(&mut comes(|_| {}), STANDS_AFTER);
    assert!(is_close(limit.left_m, (1.95 - RADII_M - 0.3) / 2.0) && is_close(limit.growth_mps, 0.5));
}

/// The path of a robot ends at a place, and its vector leads there.
#[test]
fn the_whole_gap_to_a_path_is_left() {
    let body = body(f64::MAX);
    let rule = still(&body, Position::ORIGIN, moment(1));
    let kept_off = |end: V, told: V, radii_m: f64| {
        let mut limit = Limit { ahead: end.normalized().unwrap(), ..east(9.0, 0.0) };
        rule.keep_off_path(&mut limit, end, told, radii_m);
        limit
    };
    let rounded = |distance: f64| ERROR_M / (distance - ERROR_M);
    for (end, told, radii_m, left_m, sin, distance) in [
        // The start, a place between, and the end are nearest.
        (v(0.4, 0.3), v(0.4, 0.0), 0.25, 0.05, 0.8, 0.3),
        (v(0.3, 0.3), v(0.4, 0.0), 0.25, 0.05, core::f64::consts::FRAC_1_SQRT_2, 0.3),
        (v(0.1, 0.3), v(-0.4, 0.0), 0.25, v(0.1, 0.3).norm() - 0.25, 0.0, v(0.1, 0.3).norm()),
        (v(0.6, 0.3), v(0.4, 0.1), 0.25, v(0.2, 0.2).norm() - 0.25, 0.316_227_766_016_838, v(0.2, 0.2).norm()),
        // Without a gap the farthest place counts.
        (v(0.2, 0.3), v(0.4, 0.0), 0.35, -0.05, 12.0 / 13.0, 0.3),
    ] {
        let limit = kept_off(end, told, radii_m);
        assert!(is_close(limit.left_m, left_m), "{end:?} {told:?}: {}", limit.left_m);
        assert!(is_close(limit.slant, (sin + rounded(distance)).min(1.0)), "{end:?} {told:?}: {}", limit.slant);
        assert!(is_close(limit.cos, cos_of(limit.slant, 1.0)) && limit.ahead.norm() > 0.9);
    }
    // One that no step reaches changes nothing; one that leads past the own place counts whole.
    assert_eq!(kept_off(v(0.4, 0.3), v(0.4, 0.0), 0.199).left_m, 9.0);
    assert!(is_close(kept_off(v(0.4, 0.3), v(0.4, 0.0), 0.201).left_m, 0.099));
    let past = kept_off(v(0.2, 0.1), v(0.4, 0.0), 0.35);
    assert_eq!((past.ahead, past.slant), (V::ZERO, 1.0));
}

#[test]
fn heights_count_divided_by_the_downwash() {
    let body = body(f64::MAX);
    let rule = GapLimit { downwash: 2.0, ..still(&body, Position::ORIGIN, moment(1)) };
    let up = Vec3::new(0.0, 0.0, 1.0);
    let pace = rule.pace(Vec3::new(0.3, 0.0, 0.8));
    assert!(is_close(pace.speed_mps, 0.5) && (pace.velocity_mps - Vec3::new(0.3, 0.0, 0.4)).norm() < 1e-12);
    // Along the shortest change, the closing speed changes by 1 m/s.
    for ahead in [up, v(1.0, 0.0), Vec3::new(0.6, 0.0, 0.8)] {
        let change = rule.along(ahead);
        assert!(is_close(rule.lowered(change).dot(ahead), 1.0), "{change:?}");
        assert!(change.cross(rule.lowered(ahead)).norm() < 1e-12, "the shortest one");
    }
    let plain = still(&body, Position::ORIGIN, moment(1));
    assert_eq!((plain.along(up), plain.lowered(up)), (up, up));
}

#[test]
fn obstacles_are_considered_with_a_lag_inertia_or_agreed_motions() {
    let (light, heavy) = (body(f64::MAX), body(2.0));
    let plain = still(&light, Position::ORIGIN, moment(1));
    assert!(!plain.brakes_for_walls());
    assert!(GapLimit { lag_s: 0.1, ..plain }.brakes_for_walls());
    assert!(GapLimit { is_agreed: true, ..plain }.brakes_for_walls());
    assert!(GapLimit { body: &heavy, ..plain }.brakes_for_walls());
    assert_eq!(plain.brake_s(v(1.0, 0.0)), 0.0);
    assert!(is_close(GapLimit { body: &heavy, ..plain }.brake_s(v(0.6, 0.8)), 0.5));
}
