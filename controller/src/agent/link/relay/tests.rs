use super::*;
use crate::agent::AgentConfig;
use crate::geom::Vec3;
use crate::neighbor::PlausibilityLimits;
use crate::wire::Postcard;
use std::vec::Vec;

type Radio = Link<f32, 8, Postcard, ()>;

/// An instant after the start, by hundredths of a second.
fn at(cs: i32) -> Instant {
    Instant::from_micros(0) + UNIT.saturating_mul(cs)
}

/// A link of robot 1 with others, by id, place to the east in metres, and when they were heard.
fn knows(others: &[(u32, i32, Instant)], now: Instant) -> Radio {
    let config = AgentConfig::new(RobotId(1), 0.2, Duration::from_millis(100));
    let mut link = Radio::new(&config, Postcard);
    for &(id, x_m, heard) in others {
        let beacon = Beacon { position_mm: [1000 * x_m, 0, 0], radius_mm: 200, ..Beacon::default() };
        let known = Neighbor::from_beacon(RobotId(id), &beacon, <()>::ID, heard);
        let _ = link.table.put(known, Position::ORIGIN, now, |_| false);
    }
    link
}

#[test]
fn a_robot_is_silent_once_its_state_is_older_than_a_fresh_one() {
    let now = at(1000);
    let link = knows(&[], now);
    let heard = now - link.table.ages().stale_after;
    let is_silent = |heard: Instant, trace: Trace| {
        let known = Neighbor::from_beacon(RobotId(2), &Beacon::default(), <()>::ID, heard);
        link.is_silent(&Neighbor { trace, ..known }, now)
    };
    let before = heard - Duration::from_micros(1);
    assert_eq!([heard, before].map(|heard| is_silent(heard, Trace::Heard)), [false, true]);
    assert!(!is_silent(before, Trace::Leaving), "it has left");
    assert!(is_silent(now + Duration::from_micros(1), Trace::Told), "the clock has wrapped");
}

#[test]
fn silent_near_silent_and_any_robots_have_their_turns() {
    let now = at(1000);
    let mut link = knows(&[(3, 10, at(1)), (4, 2, now), (5, 9, now), (6, 3, now)], now);
    let mut next = || link.next_in_turn(Position::ORIGIN, now).unwrap().id.0;
    let told: Vec<u32> = (0..24).map(|_| next()).collect();
    let every_fourth = |first: usize| told.iter().skip(first).step_by(4).copied().collect::<Vec<_>>();
    assert!(every_fourth(0).iter().chain(&every_fourth(2)).all(|id| *id == 3), "{told:?}");
    assert_eq!(every_fourth(3), [3, 4, 5, 6, 3, 4], "{told:?}");
    let near = every_fourth(1);
    assert!(near.iter().all(|id| [4, 6].contains(id)) && near.contains(&4) && near.contains(&6), "{told:?}");
    // Without a silent robot, near ones have its turns too.
    let mut link = knows(&[(4, 2, now), (5, 9, now), (6, 3, now)], now);
    let told: Vec<u32> = (0..8).map(|_| link.next_in_turn(Position::ORIGIN, now).unwrap().id.0).collect();
    assert!([0, 1, 4, 5].iter().all(|turn| told[*turn] != 5), "{told:?}");
    assert_eq!([2, 3, 6, 7].map(|turn: usize| told[turn]), [4, 5, 6, 4]);
}

#[test]
fn half_of_the_distance_of_the_farthest_robot_is_near() {
    let now = at(1000);
    for (x_m, is_near) in [(5, true), (6, false)] {
        let link = knows(&[(3, 10, now), (4, x_m, now)], now);
        let near = link.near(Position::ORIGIN, 0).map(|known| known.id);
        assert_eq!(near, is_near.then_some(RobotId(4)), "{x_m}");
    }
    assert_eq!(knows(&[], now).near(Position::ORIGIN, 0), None);
}

#[test]
fn the_age_of_a_told_state_is_rounded_up() {
    let known = |heard| Neighbor::<f32>::from_beacon(RobotId(3), &Beacon::default(), <()>::ID, heard);
    let age = |micros: i32| tell(&known(at(0)), at(0) + Duration::from_micros(micros)).age_cs;
    assert_eq!([0, 9_999, 10_000, 50_000].map(age), [1, 1, 2, 6]);
    assert_eq!(age(1_800_000_000), u16::MAX);
    let wide = Neighbor { radius_m: 0.25, trace: Trace::Lost, ..known(at(0)) };
    let told = tell(&wide, at(1));
    assert_eq!((told.id, told.is_lost, told.radius_mm), (RobotId(3), true, 250));
    let radius = |radius_m| tell(&Neighbor { radius_m, ..known(at(0)) }, at(1)).radius_mm;
    assert_eq!([-1.0, 99.0].map(radius), [0, u16::MAX]);
}

/// The state of robot 3, 4 m to the east, that robot 2 tells.
fn told() -> LostRobot {
    LostRobot { id: RobotId(3), is_lost: false, age_cs: 0, position_mm: [4000, 0, 0], radius_mm: 300 }
}

fn listener<'a>(heard_at: Instant, latency: Duration) -> ReceiveContext<'a, f32> {
    ReceiveContext {
        position: Position::ORIGIN,
        velocity_mps: Vec3::ZERO,
        heard_at,
        fastest_mps: Some(100.0),
        period: Duration::from_millis(100),
        relays: 0,
        latency,
        plausibility: &PlausibilityLimits::ANY,
        needs: &|_| false,
    }
}

fn hear(link: &mut Radio, told: &LostRobot, now: Instant) -> Outputs<f32> {
    let mut out = Outputs::default();
    link.hear_told(RobotId(2), told, None, now, &listener(now, Duration::from_millis(50)), &mut out);
    out
}

#[test]
fn a_newer_state_renews_all_that_it_tells_and_keeps_the_rest() {
    let now = at(1000);
    let mut link = knows(&[(3, 5, at(800))], now);
    let before = link.table.as_slice()[0];
    let _ = hear(&mut link, &LostRobot { age_cs: 30, ..told() }, now);
    let known = link.table.as_slice()[0];
    // It may have decided once more since: a period.
    let heard = now - UNIT.saturating_mul(30) - Duration::from_millis(100);
    let wanted = Neighbor { position: Position::from_mm([4000, 0, 0]), heard, radius_m: 0.3, ..before };
    assert_eq!((known.position, known.heard, known.radius_m), (wanted.position, heard, 0.3));
    assert_eq!((known.mode, known.velocity_mps, known.flock), (before.mode, before.velocity_mps, before.flock));
    assert_eq!(link.relay.urgent, RobotId::NONE);
}

#[test]
fn a_state_that_is_no_newer_changes_nothing_and_an_outdated_one_is_answered() {
    let now = at(1000);
    // Told states are one period older than their age: 10 units.
    for (heard_cs, is_newer) in [(988, true), (989, false), (990, false), (995, false)] {
        let mut link = knows(&[(3, 5, at(heard_cs))], now);
        let _ = hear(&mut link, &told(), now);
        assert_eq!(link.table.as_slice()[0].position.mm[0] == 4000, is_newer, "{heard_cs}");
        assert_eq!(link.relay.urgent, RobotId::NONE);
    }
    let stale = knows(&[], now).table.ages().stale_after;
    for (more_us, is_urgent) in [(0, false), (1, true)] {
        let heard = now - Duration::from_millis(100) + stale + Duration::from_micros(more_us);
        let mut link = knows(&[(3, 5, heard)], now);
        let _ = hear(&mut link, &told(), now);
        assert_eq!(link.relay.urgent == RobotId(3), is_urgent, "{more_us}");
    }
}

#[test]
fn only_states_that_arrive_in_time_say_that_the_own_robot_is_heard() {
    let now = at(1000);
    let stale = knows(&[], now).table.ages().stale_after;
    for (late_us, hearing) in [(0, Hearing::Heard), (1, Hearing::Unclear)] {
        let mut link = knows(&[], now);
        link.relay.audience.tells_of_farther();
        let latency = Duration::from_millis(50);
        let heard_at = now - latency - stale - Duration::from_micros(late_us);
        let listener = listener(heard_at, latency);
        link.note_audience(RobotId(2), &LostRobot { id: RobotId(1), ..told() }, now, &listener);
        assert_eq!(link.hearing(), hearing, "{late_us}");
    }
}

/// A robot near the eastern border of a torus tells of one beyond it.
#[cfg(feature = "host")]
#[test]
fn on_a_torus_a_told_place_is_the_nearest_of_its_images() {
    for (width_m, expected_mm) in [(None, 9_000), (Some(10.0), -1_000)] {
        let now = at(1000);
        let mut link = knows(&[], now);
        if let Some(width_m) = width_m {
            link.set_torus(crate::geom::Torus { size_m: [width_m; 2] });
        }
        link.table.note_reception(
            &mut Neighbor::from_beacon(
                RobotId(2),
                &Beacon { position_mm: [9_000, 0, 0], ..Beacon::default() },
                <()>::ID,
                now,
            ),
            Position::ORIGIN,
            Vec3::ZERO,
        );
        let _ = hear(&mut link, &LostRobot { position_mm: [9_000, 0, 0], is_lost: true, ..told() }, now);
        let place = link.table.lost().first().map(|known| known.position.mm[0]);
        assert_eq!(place, Some(expected_mm));
    }
}
