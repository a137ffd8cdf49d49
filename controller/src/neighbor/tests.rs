use super::*;
use crate::wire::{Beacon, Bytes, ProtocolId};
use proptest::prelude::*;
use std::vec::Vec as StdVec;

mod lost;
mod plausibility;

const AGES: Ages = Ages { stale_after: Duration::from_millis(1_000), expire_after: Duration::from_millis(5_000) };

fn at(micros: u32) -> Instant {
    Instant::from_micros(micros)
}

/// `x` metres east of the origin; if `x` is NaN, the velocity is NaN.
fn standing(id: u32, x: f32, heard: Instant) -> Neighbor<f32> {
    let beacon = Beacon::default();
    let mut neighbor = Neighbor::from_beacon(RobotId(id), &beacon, ProtocolId::NONE, heard);
    match place(x, 0.0) {
        Some(place) => neighbor.position = place,
        None => neighbor.velocity_mps.x = x,
    }
    neighbor
}

fn place(x: f32, y: f32) -> Option<Position> {
    Position::ORIGIN.moved(Vec3::new(x, y, 0.0))
}

fn nearest_ids<const N: usize, const K: usize>(table: &NeighborTable<f32, N>, own: Position) -> StdVec<u32> {
    let nearest = nearest::<f32, K>(table.as_slice(), 0, own, 0.0, at(0), &AGES, &INFLATION);
    nearest.iter().map(|near| near.id.0).collect()
}

/// A body that brakes from 1 m/s within half a metre.
const BODY: Body<f32> = Body {
    id: RobotId(100),
    velocity_mps: Vec3 { x: 0.0, y: 0.0, z: 0.0 },
    radius_m: 0.1,
    max_speed_mps: 1.0,
    max_acceleration_mps2: 1.0,
    step_s: 0.1,
};
const INFLATION: StalenessInflation<f32> = StalenessInflation { growth_mps: 1.0, max_m: 1.0 };

fn put<const N: usize>(table: &mut NeighborTable<f32, N>, n: Neighbor<f32>, now: Instant) -> Put {
    table.put(n, Position::ORIGIN, now, |_| false)
}

fn ids<const N: usize>(table: &NeighborTable<f32, N>) -> StdVec<u32> {
    table.iter().map(|n| n.id.0).collect()
}

fn expired<const N: usize>(table: &mut NeighborTable<f32, N>, now: Instant) -> StdVec<u32> {
    let mut lost = StdVec::new();
    table.expire((&BODY, 0.1), now, (Duration::MAX, false), |id| lost.push(id.0));
    lost
}

fn full<const N: usize>(now: Instant) -> NeighborTable<f32, N> {
    let mut table = NeighborTable::new(AGES);
    for i in 1..=N as u32 {
        assert_eq!(put(&mut table, standing(i, i as f32, now), now), Put::Inserted);
    }
    table
}

#[test]
fn table_without_room_refuses() {
    let mut table = NeighborTable::<f32, 0>::new(AGES);
    assert_eq!(put(&mut table, standing(1, 0.0, at(0)), at(0)), Put::Refused);
    assert!(table.is_empty() && nearest_ids::<0, 4>(&table, Position::ORIGIN).is_empty());
}

#[test]
fn table_of_one_keeps_the_nearer_of_two() {
    let mut table = full::<1>(at(0));
    assert_eq!(put(&mut table, standing(2, 0.5, at(0)), at(0)), Put::Evicted(RobotId(1)));
    assert_eq!(put(&mut table, standing(1, 1.0, at(0)), at(0)), Put::Refused);
    assert_eq!(ids(&table), [2]);
}

#[test]
fn the_id_of_no_robot_is_refused() {
    let mut table = NeighborTable::<f32, 4>::new(AGES);
    assert_eq!(put(&mut table, standing(0, 1.0, at(0)), at(0)), Put::Refused);
    assert_eq!(table.get(RobotId::NONE, at(0)), Knowledge::Unknown);
}

#[test]
fn known_robot_is_updated_in_a_full_table() {
    let mut table = full::<4>(at(0));
    assert_eq!(put(&mut table, standing(3, 99.0, at(7)), at(7)), Put::Updated);
    assert_eq!(table.len(), 4);
    let known = table.get(RobotId(3), at(7)).fresh().unwrap();
    assert_eq!((known.position.mm[0], known.heard), (99_000, at(7)));
}

#[test]
fn full_table_evicts_the_farthest_for_a_nearer_one_only() {
    let mut table = full::<4>(at(0));
    assert_eq!(put(&mut table, standing(9, 4.5, at(0)), at(0)), Put::Refused);
    assert_eq!(put(&mut table, standing(9, -4.0, at(0)), at(0)), Put::Refused);
    assert_eq!(put(&mut table, standing(9, -3.5, at(0)), at(0)), Put::Evicted(RobotId(4)));
    assert_eq!(ids(&table), [1, 2, 3, 9]);
}

#[test]
fn distance_counts_from_the_own_position() {
    let mut table = full::<4>(at(0));
    let own = Position::from_mm([5_000, 0, 0]);
    assert_eq!(table.put(standing(9, 6.0, at(0)), own, at(0), |_| false), Put::Evicted(RobotId(1)));
}

#[test]
fn protected_robots_stay_and_come_in() {
    let mut table = full::<3>(at(0));
    let old = at(9_000_000);
    let far = |id| standing(id, 1000.0, old);
    let protect = |id: RobotId| id.0 >= 3;
    assert_eq!(table.put(far(4), Position::ORIGIN, old, protect), Put::Evicted(RobotId(2)));
    assert_eq!(table.put(far(5), Position::ORIGIN, old, protect), Put::Evicted(RobotId(1)));
    assert_eq!(table.put(far(6), Position::ORIGIN, old, protect), Put::Refused);
    assert_eq!(ids(&table), [3, 4, 5]);
}

#[test]
fn protected_newcomer_displaces_a_nearer_one() {
    let mut table = full::<2>(at(0));
    let far = standing(9, 1000.0, at(0));
    assert_eq!(table.put(far, Position::ORIGIN, at(0), |id| id.0 == 9), Put::Evicted(RobotId(2)));
}

#[test]
fn unknown_distance_is_the_largest() {
    let mut table = full::<2>(at(0));
    assert_eq!(put(&mut table, standing(3, f32::NAN, at(0)), at(0)), Put::Refused);
    let _ = put(&mut table, standing(1, f32::NAN, at(0)), at(0));
    assert_eq!(put(&mut table, standing(3, 1e9, at(0)), at(0)), Put::Evicted(RobotId(1)));

    let _ = put(&mut table, standing(2, f32::NAN, at(0)), at(0));
    assert_eq!(nearest_ids::<2, 2>(&table, Position::ORIGIN), [3, 2]);
}

#[test]
fn nearest_returns_all_robots_if_there_are_fewer() {
    let table = full::<3>(at(0));
    assert!(nearest_ids::<3, 0>(&table, Position::ORIGIN).is_empty());
    let far_east = place(10.0, 0.0).unwrap();
    assert_eq!(nearest_ids::<3, 5>(&table, far_east), [3, 2, 1]);
}

#[test]
fn the_ball_of_a_silent_neighbour_grows_until_it_expires() {
    let mut robot = standing(1, 10.0, at(0));
    robot.velocity_mps.x = -2.0;
    robot.radius_m = 0.25;
    let look = |millis: i32, own_radius_m: f32| {
        let now = at(0) + Duration::from_millis(millis);
        let seen = nearest::<_, 1>(&[robot], 0, Position::ORIGIN, own_radius_m, now, &AGES, &INFLATION);
        seen.first().map(|n| (n.offset_m.x, n.velocity_mps.x, n.radius_m, n.gives_way))
    };
    assert_eq!(look(0, 0.5), Some((10.0, -2.0, 0.25, true)));
    assert_eq!(look(1_000, 0.5), Some((8.0, -2.0, 0.25, true)));
    assert_eq!(look(2_000, 0.5), Some((8.0, 0.0, 0.75, false)));
    assert_eq!(look(5_000, 0.5), Some((8.0, 0.0, 1.25, false)));
    assert_eq!(look(5_000, 7.5), Some((8.0, 0.0, 0.5, false)));
    assert_eq!(look(5_000, 9.0), Some((8.0, 0.0, 0.25, false)));
    assert_eq!(look(5_001, 0.5), None);
}

#[test]
fn a_robot_in_fault_does_not_give_way() {
    let mut robot = standing(1, 1.0, at(0));
    robot.mode = Mode::Fault;
    let seen = nearest::<_, 1>(&[robot], 0, Position::ORIGIN, 0.0, at(0), &AGES, &INFLATION);
    assert!(!seen[0].gives_way);
}

#[test]
fn knowledge_ages_from_fresh_to_stale_to_unknown() {
    let mut table = NeighborTable::<f32, 4>::new(AGES);
    let heard = at(u32::MAX - 500_000); // The clock wraps before the first limit.
    let _ = put(&mut table, standing(1, 0.0, heard), heard);
    let get = |micros: i32| table.get(RobotId(1), heard + Duration::from_micros(micros));
    assert!(matches!(get(0), Knowledge::Fresh(_)));
    assert!(matches!(get(1_000_000), Knowledge::Fresh(_)));
    assert!(matches!(get(1_000_001), Knowledge::Stale(_)));
    assert!(get(1_000_001).fresh().is_none() && get(1_000_001).known().is_some());
    assert!(matches!(get(5_000_000), Knowledge::Stale(_)));
    assert_eq!(get(5_000_001), Knowledge::Unknown);
    assert_eq!(get(i32::MAX), Knowledge::Unknown);
    assert_eq!(get(i32::MIN), Knowledge::Unknown);
    assert_eq!(table.get(RobotId(2), heard), Knowledge::Unknown);
}

#[test]
fn expiry_reports_each_lost_robot_once_in_order() {
    let mut table = full::<4>(at(0));
    let _ = put(&mut table, standing(2, 2.0, at(3_000_000)), at(3_000_000));
    assert!(expired(&mut table, at(5_000_000)).is_empty());
    assert_eq!(expired(&mut table, at(5_000_001)), [1, 3, 4]);
    assert!(expired(&mut table, at(5_000_001)).is_empty());
    assert_eq!(ids(&table), [2]);
}

fn lost<const N: usize>(table: &NeighborTable<f32, N>) -> StdVec<u32> {
    table.lost().iter().map(|robot| robot.id.0).collect()
}

#[test]
fn lost_robots_block_their_places_until_they_are_received() {
    let mut table = full::<4>(at(0));
    let _ = put(&mut table, standing(2, 2.0, at(3_000_000)), at(3_000_000));
    let expire = |table: &mut NeighborTable<f32, 4>, now| {
        let mut told = StdVec::new();
        table.expire((&BODY, 0.1), at(now), (Duration::MAX, true), |id| told.push(id.0));
        told
    };
    assert_eq!(expire(&mut table, 5_000_001), [1, 3, 4]);
    assert_eq!((ids(&table), lost(&table)), ([2].into(), [1, 3, 4].into()));
    assert!(expire(&mut table, 5_100_000).is_empty(), "each once");
    assert_eq!(table.get(RobotId(3), at(5_100_000)), Knowledge::Unknown);
    let now = at(6_000_000);
    assert_eq!(put(&mut table, standing(3, 3.0, now), now), Put::Inserted, "found again");
    assert_eq!((ids(&table), lost(&table)), ([2, 3].into(), [1, 4].into()));
    // Lost robots take half of the table: a farther robot makes way, they do not.
    assert_eq!(put(&mut table, standing(9, 1.5, now), now), Put::Evicted(RobotId(3)));
    assert_eq!((ids(&table), lost(&table)), ([2, 9].into(), [1, 4].into()));
    table.clear_lost(RobotId(4));
    assert_eq!((ids(&table), lost(&table)), ([2, 9].into(), [1].into()));
    // The 32-bit clock wraps twice.
    for minutes in 1..150_u32 {
        let _ = expire(&mut table, minutes.wrapping_mul(60_000_000));
        let ages = table.lost().iter().map(|robot| robot.age(at(minutes.wrapping_mul(60_000_000))));
        assert!(ages.into_iter().all(|age| age.is_some_and(|age| age <= OLDEST)));
    }
    assert_eq!(lost(&table), [1, 2, 9]);
}

#[test]
fn the_second_owner_of_an_id_enters_a_full_table_if_it_is_nearer() {
    let double = |id: u32, x: f32| Neighbor { id: RobotId(id).duplicate(), ..standing(id, x, at(0)) };
    let after = |newcomers: &[Neighbor<f32>], is_needed: bool| {
        let mut table = full::<4>(at(0));
        for newcomer in newcomers {
            let _ = table.put(*newcomer, Position::ORIGIN, at(0), |id| is_needed && id == newcomer.id);
        }
        table
            .iter()
            .map(|known| known.id.duplicate_of().map_or(known.id.0 as i32, |id| -(id.0 as i32)))
            .collect::<StdVec<_>>()
    };
    assert_eq!(after(&[double(3, 2.5)], false), [1, 2, 4, -3]);
    assert_eq!(after(&[double(3, 3.5)], false), [1, 2, 3, 4], "its first owner is nearer");
    assert_eq!(after(&[double(3, 2.5), double(4, 2.6)], false), [1, 2, 4, -3], "the other one is nearer");
    assert_eq!(after(&[double(3, 2.5), double(4, 2.4)], false), [1, 2, 4, -4], "instead of the other one");
    assert_eq!(after(&[double(9, 0.5)], false), [1, 2, 3, 4], "of none that is known");
    assert_eq!(after(&[double(9, 0.5)], true), [1, 2, 3, -9], "of the own id");
}

#[test]
fn robots_of_another_flock_are_strangers() {
    let own = standing(1, 1.0, at(0));
    let other = Neighbor { flock: 3, ..standing(2, 2.0, at(0)) };
    let strangers = |flock: u8| {
        let seen = nearest::<_, 4>(&[own, other], flock, Position::ORIGIN, 0.0, at(0), &AGES, &INFLATION);
        seen.iter().map(|near| near.is_stranger).collect::<StdVec<_>>()
    };
    assert_eq!((strangers(0), strangers(3)), ([false, true].into(), [true, false].into()));
}

/// Receives one robot at `x` metres with a velocity, and returns its trace.
fn trace(table: &mut NeighborTable<f32, 4>, x: f32, velocity: f32, own_mps: f32) -> Trace {
    let mut robot = Neighbor { velocity_mps: Vec3::new(velocity, 0.0, 0.0), ..standing(1, x, at(0)) };
    table.note_reception(&mut robot, Position::ORIGIN, Vec3::new(own_mps, 0.0, 0.0));
    robot.trace
}

#[test]
fn a_robot_leaves_only_if_it_recedes_near_the_greatest_distance() {
    let mut table = NeighborTable::<f32, 4>::new(AGES).with_reach(10.0);
    assert_eq!(trace(&mut table, 8.9, 0.05, 0.0), Trace::Heard);
    assert_eq!(trace(&mut table, 9.1, 0.05, 0.0), Trace::Leaving);
    assert_eq!(trace(&mut table, 8.1, 1.0, 0.0), Trace::Leaving, "at 9.1 m within a second");
    assert_eq!(trace(&mut table, 9.1, -0.05, 0.0), Trace::Heard, "it comes nearer");
    assert_eq!(trace(&mut table, 9.1, 0.0, 0.0), Trace::Heard);
    assert_eq!(trace(&mut table, 9.1, 0.5, 1.0), Trace::Heard, "the own robot follows faster");
    assert_eq!(trace(&mut table, 9.1, 0.0, -0.1), Trace::Leaving, "the own robot recedes");
    assert_eq!(trace(&mut table, 20.0, 0.0, 0.0), Trace::Heard);
    assert_eq!(trace(&mut table, 17.9, 0.05, 0.0), Trace::Heard, "the radio reaches farther than was known");
    assert_eq!(trace(&mut table, 18.1, 0.05, 0.0), Trace::Leaving);
}

#[test]
fn a_robot_that_left_is_not_remembered() {
    let mut table = full::<4>(at(0));
    let mut gone = Neighbor { trace: Trace::Leaving, ..standing(3, 3.0, at(0)) };
    let _ = put(&mut table, gone, at(0));
    gone.id = RobotId(4);
    gone.trace = Trace::Heard;
    let _ = put(&mut table, gone, at(0));
    let mut told = StdVec::new();
    table.expire((&BODY, 0.1), at(5_000_001), (Duration::MAX, true), |id| told.push(id.0));
    assert_eq!((told, lost(&table)), ([1, 2, 3, 4].into(), [1, 2, 4].into()));
}

#[test]
fn a_lost_robot_may_have_stopped_at_once_or_after_braking() {
    let mut table = NeighborTable::<f32, 4>::new(AGES);
    let robot = Neighbor { velocity_mps: Vec3::new(0.0, -1.0, 0.0), ..standing(1, 3.0, at(0)) };
    let radius_m = robot.radius_m;
    let _ = put(&mut table, robot, at(0));
    table.expire((&BODY, 0.1), at(5_000_001), (Duration::MAX, true), |_| {});
    let [lost] = table.lost() else { panic!("lost") };
    assert_eq!((lost.position.mm, lost.velocity_mps), ([3000, -300, 0], Vec3::ZERO));
    assert_eq!(lost.radius_m, radius_m + 0.3);
}

#[test]
fn silence_beyond_half_the_clock_expires() {
    let mut table = full::<2>(at(0));
    assert_eq!(expired(&mut table, at(2_400_000_000)), [1, 2]);
}

#[test]
fn position_is_extrapolated_for_a_bounded_time() {
    let mut neighbor = standing(1, 10.0, at(u32::MAX));
    neighbor.velocity_mps = Vec3::new(2.0, -1.0, 0.5);
    let longest = Duration::from_millis(1_500);
    let after = |micros: i32| {
        let now = neighbor.heard + Duration::from_micros(micros);
        neighbor.offset_at(Position::ORIGIN, now, longest)
    };
    assert_eq!(after(0), Vec3::new(10.0, 0.0, 0.0));
    assert_eq!(after(500_000), Vec3::new(11.0, -0.5, 0.25));
    assert_eq!(after(1_500_000), Vec3::new(13.0, -1.5, 0.75));
    assert_eq!(after(i32::MAX), after(1_500_000));
    assert_eq!(after(i32::MIN), after(1_500_000));
}

#[test]
fn a_beacon_is_converted_to_metres_and_the_own_clock() {
    let beacon = Beacon {
        position_mm: [1_500, -2_250, i32::MAX],
        velocity_mmps: [500, i16::MIN, 0],
        radius_mm: 150,
        mode: Mode::Cruise,
        flock: 3,
        protocol: ProtocolId(64),
        payload: Bytes::from_slice(&[7]).unwrap(),
    };
    let n = Neighbor::<f64, u8>::from_beacon(RobotId(5), &beacon, ProtocolId(64), at(u32::MAX));
    assert_eq!(n.position, Position::from_mm([1_500, -2_250, i32::MAX]));
    assert_eq!(n.velocity_mps, Vec3::new(0.5, -32.768, 0.0));
    assert_eq!((n.radius_m, n.id, n.flock), (0.15, RobotId(5), 3));
    assert_eq!((n.heard, n.mode, n.trace, n.gap_m), (at(u32::MAX), Mode::Cruise, Trace::Heard, 0.0));
    assert_eq!(n.payload, Some(7));
}

#[test]
fn a_payload_of_another_protocol_or_with_other_bytes_is_unknown() {
    let told = |protocol, bytes: &[u8]| {
        let payload = Bytes::from_slice(bytes).unwrap();
        let beacon = Beacon { protocol: ProtocolId(protocol), payload, ..Beacon::default() };
        Neighbor::<f32, u8>::from_beacon(RobotId(5), &beacon, ProtocolId(64), at(0)).payload
    };
    assert_eq!([told(64, &[7]), told(65, &[7]), told(64, &[]), told(64, &[7, 7])], [Some(7), None, None, None]);
    let silent = |protocol| {
        let beacon = Beacon { protocol, ..Beacon::default() };
        Neighbor::<f32>::from_beacon(RobotId(5), &beacon, ProtocolId::NONE, at(0)).payload
    };
    assert_eq!([silent(ProtocolId::NONE), silent(ProtocolId(1))], [Some(()), None]);
}

/// Small whole distances, so that ties occur.
fn robots() -> impl Strategy<Value = StdVec<(u32, i8, i8)>> {
    proptest::collection::btree_map(1..60u32, (-4..4i8, -4..4i8), 0..40)
        .prop_map(|map| map.into_iter().map(|(id, (x, y))| (id, x, y)).collect())
}

fn fill(robots: &[(u32, i8, i8)], protect: impl Fn(RobotId) -> bool) -> NeighborTable<f32, 8> {
    let mut table = NeighborTable::new(AGES);
    for &(id, x, y) in robots {
        let mut robot = standing(id, x.into(), at(0));
        robot.position = place(x.into(), y.into()).unwrap();
        let _ = table.put(robot, Position::ORIGIN, at(0), &protect);
    }
    table
}

fn expected(robots: &[(u32, i8, i8)], protect: impl Fn(RobotId) -> bool, k: usize) -> StdVec<u32> {
    let mut sorted = robots.to_vec();
    sorted.sort_by_key(|&(id, x, y)| {
        let squared = i32::from(x) * i32::from(x) + i32::from(y) * i32::from(y);
        (!protect(RobotId(id)), squared, id)
    });
    sorted.truncate(k);
    sorted.iter().map(|robot| robot.0).collect()
}

proptest! {
    #[test]
    fn content_is_the_nearest_robots_in_any_order_of_arrival(
        (robots, shuffled) in robots().prop_flat_map(|r| (Just(r.clone()), Just(r).prop_shuffle())),
    ) {
        let protect = |id: RobotId| [3, 30, 50].contains(&id.0);
        let mut kept = expected(&robots, protect, 8);
        kept.sort_unstable();
        prop_assert_eq!(ids(&fill(&shuffled, protect)), kept);
    }

    #[test]
    fn nearest_are_the_head_of_a_full_sort(robots in robots()) {
        let table = fill(&robots, |_| false);
        for entry in &table {
            prop_assert!(table.get(entry.id, at(0)).fresh() == Some(entry));
        }
        prop_assert_eq!(nearest_ids::<8, 5>(&table, Position::ORIGIN), expected(&robots, |_| false, 5));
    }

    #[test]
    fn any_input_keeps_the_table_sorted_and_bounded(
        news in proptest::collection::vec((any::<u32>(), any::<u32>(), any::<f32>()), 0..40),
        own in any::<f32>(),
    ) {
        let mut table = NeighborTable::<f32, 5>::new(AGES);
        for (id, now, x) in news {
            let before = ids(&table);
            let answer = put_from(&mut table, standing(id, x, at(now)), own, at(now));
            let after = ids(&table);
            prop_assert!(after.is_sorted_by(|a, b| a < b) && after.len() <= 5);
            prop_assert_eq!(after.contains(&id), answer != Put::Refused);
            match answer {
                Put::Inserted => prop_assert_eq!(after.len(), before.len() + 1),
                Put::Updated | Put::Refused => prop_assert_eq!(after, before),
                Put::Evicted(gone) => {
                    prop_assert!(before.contains(&gone.0) && !after.contains(&gone.0));
                }
            }
        }
    }
}

fn put_from(table: &mut NeighborTable<f32, 5>, newcomer: Neighbor<f32>, own: f32, now: Instant) -> Put {
    let own = place(own, 0.0).unwrap_or_default();
    table.put(newcomer, own, now, |id| id.0 < 1 << 30)
}
