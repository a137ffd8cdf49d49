mod kalman;

use super::*;
use crate::neighbor::Ages;
use crate::rand::Rng;
use crate::scalar::Q16;
use proptest::prelude::*;

const STEP: Duration = Duration::from_millis(50);
const OWN: RobotId = RobotId(1);
const AGES: Ages = Ages { stale_after: STEP.saturating_mul(4), expire_after: STEP.saturating_mul(30) };

type Table<S> = NeighborTable<S, 16>;

fn params<S: Scalar>() -> TrackParams<S> {
    let params = TrackParams {
        acceleration_mps2: 2.0_f64,
        speed_mps: 0.5,
        heard_m: 0.002,
        heard_mps: 0.01,
        gate: 4.0,
        margin: 2.0,
        forget: STEP.saturating_mul(4),
    };
    params.cast()
}

fn at(step: i32) -> Instant {
    Instant::from_micros(0) + STEP.saturating_mul(step)
}

/// (x, y) in metres, with a deviation of 5 cm.
fn sighting<S: Scalar>(x: f64, y: f64) -> Sighting<S> {
    let s = |x: f64| S::from_f64(x).unwrap();
    Sighting {
        offset_m: Vec3::new(s(x), s(y), S::ZERO),
        deviation_m: s(0.05),
        age: Duration::ZERO,
        radius_m: s(0.15),
        id: None,
        velocity_mps: None,
    }
}

fn named<S: Scalar>(id: u32, x: f64, y: f64) -> Sighting<S> {
    Sighting { id: Some(RobotId(id)), ..sighting(x, y) }
}

fn see<S: Scalar>(tracker: &mut Tracker<S>, sightings: &[Sighting<S>], step: i32) -> Sighted {
    tracker.see(sightings, OWN, Position::ORIGIN, Vec3::ZERO, at(step))
}

fn heard<S: Scalar>(id: u32, x: f64, y: f64, step: i32) -> Neighbor<S> {
    let position = Position::from_metres([x, y, 0.0]).unwrap();
    let track = Track::new(RobotId(id), at(step), position, S::ONE, &params());
    Neighbor { velocity_mps: Vec3::ZERO, radius_m: S::from_milli(150), ..stranger(&track, 0) }
}

fn merge<S: Scalar>(tracker: &mut Tracker<S>, table: &mut Table<S>, step: i32) -> std::vec::Vec<RobotId> {
    let mut gone = std::vec::Vec::new();
    tracker.hear(table, Position::ORIGIN);
    tracker.forget(table, at(step), |id| gone.push(id));
    for &neighbor in &tracker.seen(table, 0, at(step)) {
        let _ = table.put(neighbor, Position::ORIGIN, at(step), |_| false);
    }
    gone
}

fn ids<S: Scalar>(tracker: &Tracker<S>) -> std::vec::Vec<RobotId> {
    tracker.tracks().iter().map(|track| track.id).collect()
}

fn goes_with_even_speed<S: Scalar>() -> (f64, f64) {
    let mut tracker = Tracker::<S>::new(params());
    let mut rng = Rng::keyed(7, 0, 0, 0);
    let mut error = || (0..12).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
    let mut off = (0.0_f64, 0.0_f64);
    for step in 0..200 {
        let x = 0.5 * 0.05 * f64::from(step) - 2.0;
        let seen = see(&mut tracker, &[sighting(x + 0.05 * error(), 1.0 + 0.05 * error())], step);
        assert_eq!(
            seen,
            if step == 0 { Sighted { new: 1, ..seen } } else { Sighted { known: 1, ..Sighted::default() } }
        );
        if step >= 50 {
            let track = tracker.tracks()[0];
            let place = track.offset_m(Position::ORIGIN);
            let [dx, dy] = [place.x.to_f64() - x, place.y.to_f64() - 1.0];
            let [vx, vy] = [track.velocity_mps.x.to_f64() - 0.5, track.velocity_mps.y.to_f64()];
            off = (off.0 + dx * dx + dy * dy, off.1 + vx * vx + vy * vy);
        }
    }
    assert_eq!(tracker.tracks().len(), 1);
    ((off.0 / 300.0).sqrt(), (off.1 / 300.0).sqrt())
}

#[test]
fn estimates_are_more_accurate_than_single_detections() {
    for (place_m, velocity_mps) in
        [goes_with_even_speed::<f64>(), goes_with_even_speed::<f32>(), goes_with_even_speed::<Q16>()]
    {
        assert!(place_m < 0.035 && velocity_mps < 0.2, "{place_m} {velocity_mps}");
    }
}

#[test]
fn two_robots_apart_keep_their_tracks_in_any_order_of_detections() {
    let mut tracker = Tracker::<f32>::new(params());
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), sighting(2.0, 0.0)], 0);
    let before = ids(&tracker);
    for step in 1..20 {
        let seen = see(&mut tracker, &[sighting(2.03, 0.0), sighting(0.97, 0.0)], step);
        assert_eq!(seen, Sighted { known: 2, ..Sighted::default() });
    }
    assert_eq!(ids(&tracker), before);
    assert!(before.iter().all(|id| id.is_local() && id.duplicate_of().is_none()));
    assert!(tracker.tracks()[0].position.mm[0] < 1100 && tracker.tracks()[1].position.mm[0] > 1900);
}

#[test]
fn a_jump_beyond_the_gate_starts_a_new_track() {
    let mut tracker = Tracker::<f32>::new(params());
    for step in 0..10 {
        let _ = see(&mut tracker, &[sighting(1.0, 0.0)], step);
    }
    assert_eq!(see(&mut tracker, &[sighting(2.0, 0.0)], 10).new, 1);
    assert_eq!(tracker.tracks().len(), 2);
}

#[test]
fn each_id_and_each_body_has_one_track() {
    let mut tracker = Tracker::<f32>::new(params());
    let seen = see(&mut tracker, &[named(7, 1.0, 0.0), named(7, 1.0, 0.1)], 0);
    assert_eq!(seen, Sighted { new: 1, repeated: 1, ..Sighted::default() });
    // Two cameras: one detection matches the track, the other lies within the body.
    let seen = see(&mut tracker, &[sighting(1.0, 0.0), sighting(1.02, 0.0)], 1);
    assert_eq!(seen, Sighted { known: 1, repeated: 1, ..Sighted::default() });
    // A UWB detection with an id and a camera detection without one belong to one robot.
    let seen = see(&mut tracker, &[sighting(1.0, 0.0), named(7, 1.0, 0.0)], 2);
    assert_eq!(seen, Sighted { known: 2, ..Sighted::default() });
    assert_eq!(ids(&tracker), [RobotId(7)]);
}

#[test]
fn an_anonymous_track_adopts_an_id_that_arrives_later() {
    let mut tracker = Tracker::<f32>::new(params());
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), sighting(3.0, 0.0)], 0);
    assert_eq!(see(&mut tracker, &[named(9, 1.0, 0.0), sighting(3.0, 0.0)], 1).known, 2);
    let mut table = Table::new(AGES);
    let _ = table.put(heard(4, 3.0, 0.0, 1), Position::ORIGIN, at(1), |_| false);
    assert_eq!(merge(&mut tracker, &mut table, 1), []);
    assert_eq!(ids(&tracker), [RobotId(9), RobotId(4)]);
    assert_eq!(table.iter().map(|known| known.id).collect::<std::vec::Vec<_>>(), [RobotId(4), RobotId(9)]);
}

#[test]
fn a_track_that_adopts_an_id_leaves_no_anonymous_entry() {
    let (mut tracker, mut table) = (Tracker::<f32>::new(params()), Table::new(AGES));
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), sighting(3.0, 0.0)], 0);
    assert_eq!(merge(&mut tracker, &mut table, 0), []);
    assert_eq!(table.len(), 2);
    let _ = see(&mut tracker, &[named(9, 1.0, 0.0), sighting(3.0, 0.0)], 1);
    let _ = table.put(heard(4, 3.0, 0.0, 1), Position::ORIGIN, at(1), |_| false);
    let gone = merge(&mut tracker, &mut table, 1);
    assert!(gone.len() == 2 && gone.iter().all(|id| id.is_local()));
    assert_eq!(table.iter().map(|known| known.id).collect::<std::vec::Vec<_>>(), [RobotId(4), RobotId(9)]);
}

#[test]
fn a_robot_known_from_beacons_alone_is_stored_unchanged() {
    let (mut tracker, mut table) = (Tracker::<f32>::new(params()), Table::new(AGES));
    let said = heard(4, 3.0, 0.0, 1);
    let _ = table.put(said, Position::ORIGIN, at(1), |_| false);
    let _ = merge(&mut tracker, &mut table, 1);
    assert_eq!(table.as_slice(), [said]);
}

#[test]
fn a_detection_outweighs_an_old_beacon() {
    let (mut tracker, mut table) = (Tracker::<f64>::new(params()), Table::new(AGES));
    let said = heard(4, 1.0, 0.0, 0);
    let _ = table.put(said, Position::ORIGIN, at(0), |_| false);
    let _ = merge(&mut tracker, &mut table, 0);
    // The beacon gives 1 m with an error of 2 mm, the detection 1.2 m with an error of 5 cm.
    let place_m = |table: &Table<f64>| f64::from(table.as_slice()[0].position.mm[0]) / 1000.0;
    let mut soon = (tracker.clone(), table.clone());
    let _ = see(&mut soon.0, &[named(4, 1.2, 0.0)], 1);
    let _ = merge(&mut soon.0, &mut soon.1, 1);
    let _ = see(&mut tracker, &[named(4, 1.2, 0.0)], 20);
    let _ = merge(&mut tracker, &mut table, 20);
    assert!(place_m(&soon.1) < 1.01 && place_m(&table) > 1.19, "{} {}", place_m(&soon.1), place_m(&table));
    let known = table.as_slice()[0];
    assert_eq!((known.heard, known.mode), (at(20), said.mode));
    assert!(known.radius_m > 0.15 && known.radius_m < 0.15 + 2.0 * 0.051);
}

#[test]
fn a_robot_without_beacons_out_of_sight_is_forgotten_and_not_lost() {
    let (mut tracker, mut table) = (Tracker::<f32>::new(params()), Table::new(AGES));
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), named(5, 2.0, 0.0)], 0);
    for step in 0..=4 {
        assert_eq!(merge(&mut tracker, &mut table, step), []);
        assert_eq!(table.len(), 2, "{step}");
    }
    assert_eq!(merge(&mut tracker, &mut table, 5).len(), 2);
    assert!(table.is_empty() && table.lost().is_empty() && tracker.tracks().is_empty());
}

#[test]
fn a_robot_with_a_recent_beacon_stays_when_out_of_sight() {
    let (mut tracker, mut table) = (Tracker::<f32>::new(params()), Table::new(AGES));
    let _ = table.put(heard(4, 1.0, 0.0, 0), Position::ORIGIN, at(0), |_| false);
    let _ = see(&mut tracker, &[named(4, 1.0, 0.0)], 0);
    let _ = merge(&mut tracker, &mut table, 0);
    assert_eq!(merge(&mut tracker, &mut table, 10), []);
    assert_eq!(table.as_slice()[0].heard, at(0));
}

#[test]
fn of_seventeen_robots_the_sixteen_nearest_are_tracked() {
    let mut tracker = Tracker::<f32>::new(params());
    let crowd: std::vec::Vec<_> = (0..17).map(|n| sighting(17.0 - f64::from(n), 0.0)).collect();
    assert_eq!(see(&mut tracker, &crowd, 0), Sighted { new: 17, ..Sighted::default() });
    assert_eq!(tracker.tracks().len(), TRACKS);
    assert!(tracker.tracks().iter().all(|track| track.position.mm[0] < 16_500));
    assert_eq!(see(&mut tracker, &[sighting(30.0, 0.0)], 1).no_room, 1);
    let many: std::vec::Vec<_> = (0..SIGHTINGS + 3).map(|_| sighting(1.0, 0.0)).collect();
    assert_eq!(see(&mut tracker, &many, 2).no_room, 3);
}

#[test]
fn invalid_detections_are_counted_and_change_nothing() {
    let mut tracker = Tracker::<f32>::new(params());
    let good = sighting::<f32>(1.0, 0.0);
    let bad = [
        Sighting { offset_m: Vec3::new(f32::NAN, 0.0, 0.0), ..good },
        Sighting { offset_m: Vec3::new(f32::INFINITY, 0.0, 0.0), ..good },
        Sighting { deviation_m: -0.05, ..good },
        Sighting { deviation_m: 0.0, ..good },
        Sighting { deviation_m: f32::NAN, ..good },
        Sighting { deviation_m: f32::INFINITY, ..good },
        Sighting { radius_m: -1.0, ..good },
        Sighting { radius_m: f32::INFINITY, ..good },
        Sighting { velocity_mps: Some((Vec3::ZERO, f32::INFINITY)), ..good },
        Sighting { velocity_mps: Some((Vec3::ZERO, f32::NAN)), ..good },
        Sighting { age: Duration::from_millis(-1), ..good },
        Sighting { id: Some(RobotId::NONE), ..good },
        Sighting { id: Some(OWN), ..good },
        Sighting { id: Some(RobotId(3).duplicate()), ..good },
        Sighting { id: Some(RobotId::local(3)), ..good },
        Sighting { velocity_mps: Some((Vec3::new(0.0, f32::NAN, 0.0), 0.1)), ..good },
        Sighting { velocity_mps: Some((Vec3::ZERO, -0.1)), ..good },
    ];
    assert_eq!(usize::from(see(&mut tracker, &bad, 0).refused), bad.len());
    assert!(tracker.tracks().is_empty());
}

#[test]
fn a_late_detection_has_less_weight_than_a_prompt_one() {
    let variance = |age_ms: i32| {
        let mut tracker = Tracker::<f64>::new(params());
        let _ = see(&mut tracker, &[sighting(1.0, 0.0)], 10);
        let late = Sighting { age: Duration::from_millis(age_ms), ..sighting(1.0, 0.0) };
        let _ = see(&mut tracker, &[late], 10);
        (tracker.tracks().len(), tracker.tracks()[0].position_variance, tracker.tracks()[0].at)
    };
    let (prompt, late) = (variance(0), variance(300));
    assert_eq!((prompt.0, late.0, late.2), (1, 1, at(10)));
    assert!(prompt.1 < late.1 && late.1 < 0.05 * 0.05, "{prompt:?} {late:?}");
}

#[test]
fn values_at_their_limit_are_valid() {
    let good = sighting::<f32>(1.0, 0.0);
    let limits = [
        Sighting { radius_m: 0.0, ..good },
        Sighting { deviation_m: 1e-6, ..good },
        Sighting { velocity_mps: Some((Vec3::ZERO, 0.0)), ..good },
        Sighting { id: Some(RobotId(2)), ..good },
    ];
    assert!(limits.iter().all(|limit| limit.is_sound(OWN)));
}

#[test]
fn anonymous_numbers_follow_each_other_and_skip_those_in_use() {
    let mut tracker = Tracker::<f32>::new(params());
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), sighting(3.0, 0.0)], 0);
    assert_eq!(ids(&tracker), [1, 2].map(RobotId::local));
    tracker.nameless = 0;
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), sighting(3.0, 0.0), sighting(5.0, 0.0)], 1);
    assert_eq!(ids(&tracker), [1, 2, 3].map(RobotId::local));
    tracker.nameless = u16::MAX;
    let _ = see(&mut tracker, &[sighting(7.0, 0.0)], 2);
    assert_eq!(ids(&tracker), [1, 2, 3, 0].map(RobotId::local));
}

#[test]
fn a_late_detection_is_relative_to_where_the_own_robot_was() {
    let mut tracker = Tracker::<f64>::new(params());
    let late = Sighting { age: Duration::from_millis(200), ..sighting(1.0, 0.5) };
    let own = Position::from_mm([4_000, 0, 0]);
    let _ = tracker.see(&[late], OWN, own, Vec3::new(1.0, -2.0, 0.0), at(10));
    let track = tracker.tracks()[0];
    assert_eq!(track.position.mm, [4_800, 900, 0]);
    assert_eq!((track.at, track.seen), (at(6), Some(at(6))));
}

#[test]
fn a_detection_inside_a_body_seen_at_one_time_starts_no_track() {
    let first = sighting::<f32>(1.0, 0.0);
    let large = |x: f64, radius: f32, age_ms: i32| Sighting {
        radius_m: radius,
        age: Duration::from_millis(age_ms),
        deviation_m: 0.001,
        ..sighting(x, 0.0)
    };
    // The first detection takes the track, the second one does not find another.
    for (x, radius, age_ms, is_repeated) in
        [(1.14, 0.1, 0, true), (1.16, 0.1, 0, false), (1.3, 0.4, 0, true), (1.3, 0.2, 0, false), (1.14, 0.1, 10, false)]
    {
        let mut tracker = Tracker::<f32>::new(params());
        let _ = see(&mut tracker, &[first], 0);
        let count = see(&mut tracker, &[first, large(x, radius, age_ms)], 1);
        assert_eq!(
            (count.known, count.repeated, count.new),
            (1, u16::from(is_repeated), u16::from(!is_repeated)),
            "{x}"
        );
    }
}

#[test]
fn bodies_that_only_touch_do_not_overlap() {
    let params = TrackParams { gate: 0.5, ..params::<f64>() };
    let mut track = Track::new(RobotId(2), at(0), Position::ORIGIN, 0.005, &params);
    track.radius_m = 0.25;
    let fits = |mm: i32| track.fit(Position::from_mm([mm, 0, 0]), 0.005, 0.25, at(0), &params).is_some();
    assert_eq!([499, 500, 501].map(fits), [true, false, false]);
}

#[test]
fn each_detection_takes_the_track_that_fits_it_best() {
    for swapped in [false, true] {
        let mut tracker = Tracker::<f64>::new(params());
        let mut pair = [sighting(1.0, 0.0), sighting(1.25, 0.0)];
        let _ = see(&mut tracker, &pair.map(|one| Sighting { radius_m: 0.05, ..one }), 0);
        pair = [sighting(1.05, 0.0), sighting(1.3, 0.0)].map(|one| Sighting { radius_m: 0.05, ..one });
        if swapped {
            pair.swap(0, 1);
        }
        assert_eq!(see(&mut tracker, &pair, 1), Sighted { known: 2, ..Sighted::default() });
        let places = [0, 1].map(|at| tracker.tracks()[at].position.mm[0]);
        assert!((1_000..1_060).contains(&places[0]) && (1_250..1_310).contains(&places[1]), "{places:?}");
    }
}

#[test]
fn an_anonymous_track_is_kept_for_the_closest_detection_with_an_id() {
    let mut tracker = Tracker::<f64>::new(params());
    let _ = see(&mut tracker, &[sighting(1.0, 0.0), named(5, 1.8, 0.0), sighting(2.6, 0.0)], 0);
    assert_eq!(ids(&tracker), [RobotId(5), RobotId::local(1), RobotId::local(2)]);
    let _ = see(&mut tracker, &[named(9, 2.6, 0.0)], 1);
    assert_eq!(ids(&tracker), [RobotId(5), RobotId::local(1), RobotId(9)], "not another robot's track");
}

/// Robots 2 to 17, as many metres to the east, with and without beacons; then robot 18 at 1 m.
fn displaced(has_beacons: bool) -> (Tracker<f64>, Table<f64>) {
    let (mut tracker, mut table) = (Tracker::new(params()), NeighborTable::new(AGES));
    let robots = 2..18_u32;
    if has_beacons {
        for id in robots.clone() {
            let _ = table.put(heard(id, id.into(), 0.0, 0), Position::ORIGIN, at(0), |_| false);
        }
    }
    let all: std::vec::Vec<_> = robots.map(|id| named(id, id.into(), 0.0)).collect();
    assert_eq!(see(&mut tracker, &all, 0).new, 16);
    assert_eq!(merge(&mut tracker, &mut table, 0), []);
    assert_eq!(see(&mut tracker, &[named(18, 1.0, 0.0)], 1).new, 1);
    assert!(!ids(&tracker).contains(&RobotId(17)));
    (tracker, table)
}

#[test]
fn a_robot_whose_track_was_replaced_is_gone_unless_its_beacons_are_recent() {
    for has_beacons in [false, true] {
        let (mut tracker, mut table) = displaced(has_beacons);
        tracker.hear(&table, Position::ORIGIN);
        let mut gone = std::vec::Vec::new();
        tracker.forget(&mut table, at(1), |id| gone.push(id));
        assert_eq!(gone.contains(&RobotId(17)), !has_beacons);
        assert_eq!(table.get(RobotId(17), at(1)).known().is_some(), has_beacons);
    }
}

#[test]
fn a_beacon_of_a_robot_whose_track_was_replaced_begins_another_track() {
    let (mut tracker, mut table) = displaced(false);
    let _ = table.put(heard(17, 0.5, 0.0, 1), Position::ORIGIN, at(1), |_| false);
    assert!(!merge(&mut tracker, &mut table, 1).contains(&RobotId(17)));
    assert!(ids(&tracker).contains(&RobotId(17)) && table.get(RobotId(17), at(1)).known().is_some());
}
