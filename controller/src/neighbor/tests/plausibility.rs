//! Tests of the limits on the values that other robots report.

use super::*;

const LIMITS: PlausibilityLimits<f64> = PlausibilityLimits {
    max_radius_m: 0.5,
    max_speed_mps: 2.0,
    slack_m: 0.5,
    settle: Duration::from_millis(300),
    last: RobotId(20),
};

#[test]
fn values_at_their_limit_are_plausible() {
    let beacon = Beacon::default();
    let said = |radius_m: f64, speed: f64| Neighbor {
        radius_m,
        velocity_mps: Vec3::new(0.0, speed, 0.0),
        ..Neighbor::<f64>::from_beacon(RobotId(1), &beacon, ProtocolId::NONE, at(0))
    };
    let cut = |limits: &PlausibilityLimits<f64>, radius_m, speed| {
        let mut said = said(radius_m, speed);
        (limits.cut(&mut said), said.radius_m, said.velocity_mps.y)
    };
    assert_eq!(cut(&LIMITS, 0.5, 2.0), ((false, false), 0.5, 2.0));
    assert_eq!(cut(&LIMITS, 0.5001, 2.0), ((true, false), 0.5, 2.0));
    assert_eq!(cut(&LIMITS, 0.1, -2.01), ((false, true), 0.1, -2.0));
    let any = PlausibilityLimits::<f64>::ANY;
    assert_eq!(cut(&any, 1e9, 1e9), ((false, false), 1e9, 1e9));
    assert_eq!(cut(&any, 0.1, f64::INFINITY).0, (false, false), "without a limit, no speed is too fast");
    assert_eq!(any.cast::<f32>().max_speed_mps, f32::MAX);
    assert_eq!(LIMITS.cast::<f32>().max_speed_mps, 2.0);
    let place = |mm: i32| Position::from_mm([0, mm, 0]);
    for (mm, millis, can_go) in [
        (2500, 1000, true),
        (-2500, 1000, true),
        (2501, 1000, false),
        (500, 0, true),
        (501, 0, false),
        (500, -900, true),
    ] {
        assert_eq!(LIMITS.can_go(place(7), place(7 + mm), Duration::from_millis(millis)), can_go, "{mm} {millis}");
    }
    assert!(any.can_go(place(0), place(i32::MAX), Duration::ZERO) && any.believes_all_places());
    assert!(!LIMITS.believes_all_places());
}

#[test]
fn limits_keep_their_values_in_other_numbers() {
    let cast = LIMITS.cast::<f32>();
    assert_eq!((cast.max_radius_m, cast.max_speed_mps, cast.slack_m), (0.5, 2.0, 0.5));
    assert_eq!((cast.settle, cast.last), (LIMITS.settle, LIMITS.last));
    assert_eq!(PlausibilityLimits::<f64>::ANY.cast::<f32>().max_speed_mps, f32::MAX);
    assert!(PlausibilityLimits::<f32>::ANY.cast::<crate::scalar::Q16>().believes_all_places());
}

#[test]
fn a_suspect_settles_by_consistent_places_and_is_removed_when_believed() {
    let mut filter = PlausibilityFilter::new();
    let longest = Duration::from_millis(1_000);
    let judge = |filter: &mut PlausibilityFilter, id: u32, mm: i32, millis: u32| {
        filter.judge(RobotId(id), Position::from_mm([mm, 0, 0]), at(millis * 1000), &LIMITS, longest)
    };
    assert_eq!(judge(&mut filter, 1, 0, 0), Verdict::Begins);
    assert_eq!(judge(&mut filter, 1, 100, 200), Verdict::Stands);
    assert_eq!(judge(&mut filter, 1, 9000, 299), Verdict::Stands, "a jump starts again");
    assert_eq!(judge(&mut filter, 1, 9000, 598), Verdict::Stands);
    assert_eq!(judge(&mut filter, 1, 9000, 599), Verdict::Settled);
    assert_eq!(judge(&mut filter, 1, 9000, 600), Verdict::Begins, "removed when it settled");
    let _ = judge(&mut filter, 2, 0, 600);
    filter.clear(RobotId(1));
    assert_eq!(judge(&mut filter, 2, 0, 700), Verdict::Stands, "another one stays");
    assert_eq!(judge(&mut filter, 1, 9000, 700), Verdict::Begins);
    assert_eq!(judge(&mut filter, 1, 9000, 1_701), Verdict::Begins, "silent for too long");
    // All four entries are in use: a fifth robot stays in doubt.
    let _ = [3, 4, 5].map(|id| judge(&mut filter, id, 0, 1_701));
    assert_eq!([1_702, 2_002].map(|millis| judge(&mut filter, 6, 0, millis)), [Verdict::Begins; 2]);
    assert_eq!(judge(&mut filter, 5, 0, 2_002), Verdict::Settled, "the last that found an entry");
}
