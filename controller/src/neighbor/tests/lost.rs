//! Tests of lost robots in the table.

use super::*;

/// A table whose robots 1, 3 and 4 are lost at 5 s, and whose robot 2 is known.
fn three_of_four_lost() -> NeighborTable<f32, 4> {
    let mut table = full::<4>(at(0));
    let _ = put(&mut table, standing(2, 2.0, at(3_000_000)), at(3_000_000));
    table.expire((&BODY, 0.1), at(5_000_001), (Duration::MAX, true), |_| {});
    assert_eq!((ids(&table), lost(&table)), ([2].into(), [1, 3, 4].into()));
    assert!(!table.is_empty() && table.len() == 1 && (&table).into_iter().count() == 1);
    table
}

#[test]
fn lost_robots_that_fill_more_than_half_of_the_table_displace_only_each_other() {
    let now = at(5_100_000);
    let gone = |id, x| Neighbor { trace: Trace::Lost, ..standing(id, x, now) };
    let mut table = three_of_four_lost();
    assert_eq!(put(&mut table, gone(9, 2.5), now), Put::Inserted, "the farthest lost robot makes way unreported");
    assert_eq!((ids(&table), lost(&table)), ([2].into(), [1, 3, 9].into()));
    assert_eq!(put(&mut table, gone(8, 90.0), now), Put::Refused, "a known one does not make way");
    let mut known = full::<4>(now);
    assert_eq!(put(&mut known, gone(9, 0.5), now), Put::Evicted(RobotId(4)));
    assert_eq!((ids(&known), lost(&known)), ([1, 2, 3].into(), [9].into()));
}

#[test]
fn a_known_robot_that_is_farther_than_too_many_lost_ones_stays() {
    let now = at(5_100_000);
    let mut table = three_of_four_lost();
    assert_eq!(put(&mut table, standing(2, 50.0, now), now), Put::Updated);
    let gone = Neighbor { trace: Trace::Lost, ..standing(9, 0.5, now) };
    assert_eq!(put(&mut table, gone, now), Put::Inserted);
    assert_eq!((ids(&table), lost(&table)), ([2].into(), [1, 3, 9].into()));
}

#[test]
fn four_fifths_of_the_reach_are_within_it() {
    let table = NeighborTable::<f64, 4>::new(AGES).with_reach(10.0);
    let is_within = |x: f64| table.is_within_reach(Vec3::new(0.6 * x, 0.8 * x, 0.0));
    assert!(is_within(7.99) && !is_within(8.01));
}

#[test]
fn the_state_of_a_lost_robot_ages_until_the_oldest_age() {
    let mut table = three_of_four_lost();
    let mut ages = |micros: u32| {
        table.expire((&BODY, 0.1), at(micros), (Duration::MAX, true), |_| {});
        let ages = table.lost().iter().map(|robot| robot.age(at(micros)).map_or(-1, Duration::as_micros));
        ages.collect::<StdVec<_>>()
    };
    assert_eq!(ages(6_000_000), [6_000_000; 3]);
    // Robot 2, received at 3 s, is lost too by now.
    assert_eq!(ages(650_000_000), [650_000_000, 647_000_000, 650_000_000, 650_000_000]);
    assert_eq!(ages(651_000_000), [650_000_000, 648_000_000, 650_000_000, 650_000_000]);
    assert_eq!(ages(900_000_000), [OLDEST.as_micros(); 4]);
}

#[test]
fn a_robot_that_was_moved_is_not_remembered_where_it_was() {
    for (micros, is_remembered) in [(4_200_000, false), (3_000_000, true)] {
        for (silent, other) in [(RobotId(3), RobotId(3).duplicate()), (RobotId(3).duplicate(), RobotId(3))] {
            let mut table = NeighborTable::<f32, 4>::new(AGES);
            for (id, heard) in [(silent, 0), (other, micros), (RobotId(5), 4_500_000)] {
                let _ = put(&mut table, standing(id.0, 1.0, at(heard)), at(heard));
            }
            let mut told = StdVec::new();
            table.expire((&BODY, 0.1), at(5_000_001), (Duration::MAX, true), |id| told.push(id));
            assert_eq!(
                (told, lost(&table).len()),
                ([silent].into(), usize::from(is_remembered)),
                "{silent:?} {micros}"
            );
        }
    }
}

/// Half a second at up to 2 m/s, in any direction.
#[test]
fn a_told_robot_is_lost_in_a_ball_around_its_place() {
    let mut table = NeighborTable::<f32, 4>::new(AGES);
    let told = Neighbor { trace: Trace::Told, velocity_mps: Vec3::new(1.0, 0.0, 0.0), ..standing(2, 2.0, at(0)) };
    let _ = put(&mut table, told, at(0));
    table.expire((&BODY, 0.5), at(9_000_000), (AGES.expire_after, true), |_| {});
    let lost = table.lost()[0];
    assert_eq!((lost.position, lost.trace), (told.position, Trace::Lost));
    let wider_m = lost.radius_m - told.radius_m;
    let most_m = BODY.max_speed_mps * 0.5 + BODY.braking_m(BODY.max_speed_mps);
    assert!((wider_m - most_m).abs() < 1e-5, "{wider_m} {most_m}");
}

#[test]
fn robots_are_forgotten_one_at_a_time() {
    let mut table = three_of_four_lost();
    let now = at(5_100_000);
    assert!(!table.forget(RobotId(3)) && !table.forget(RobotId(7)), "lost, and unknown");
    assert_eq!((ids(&table), lost(&table)), ([2].into(), [1, 3, 4].into()));
    let _ = put(&mut table, standing(3, 3.0, now), now);
    table.clear_lost(RobotId(3));
    table.clear_lost(RobotId(2));
    assert_eq!((ids(&table), lost(&table), table.len()), ([2, 3].into(), [1, 4].into(), 2), "not lost");
    assert!(table.forget(RobotId(2)));
    assert_eq!((ids(&table), lost(&table)), ([3].into(), [1, 4].into()));
    assert!(table.forget(RobotId(3)) && table.is_empty());
    assert_eq!(lost(&table), [1, 4]);
}

#[test]
fn all_robots_are_moved_to_their_images_and_lose_their_gaps() {
    let mut table = three_of_four_lost();
    let now = at(5_100_000);
    table.entries[0].gap_m = 0.5;
    assert_eq!(put(&mut table, standing(2, 2.0, now), now), Put::Updated, "news leave the gap");
    table.see_at(|place| Position::from_mm(place.mm.map(|mm| mm + 7)));
    let places = |robots: &[Neighbor<f32>]| robots.iter().map(|robot| robot.position.mm[1]).collect::<StdVec<_>>();
    assert_eq!((places(table.as_slice()), places(table.lost())), ([7].into(), [7; 3].into()));
    assert_eq!(table.as_slice()[0].gap_m, 0.5);
    table.forget_gaps();
    assert_eq!(table.as_slice()[0].gap_m, 0.0);
}

#[test]
fn lost_robots_are_appended_as_obstacles_that_grow() {
    let table = three_of_four_lost();
    let mut nearby = nearest::<f32, 3>(table.as_slice(), 0, Position::ORIGIN, 0.1, at(7_000_000), &AGES, &INFLATION);
    assert_eq!(nearby.len(), 1);
    add_lost(&mut nearby, table.lost(), Position::ORIGIN, 0.1, at(7_000_000), &AGES, &INFLATION);
    let got: StdVec<_> = nearby.iter().map(|near| (near.id.0, near.gives_way, near.offset_m.x)).collect();
    assert_eq!(got, [(2, false, 2.0), (1, false, 1.0), (3, false, 3.0)], "up to the capacity");
    let grown = nearby[2].radius_m - table.lost()[1].radius_m;
    assert_eq!(grown, INFLATION.max_m, "six seconds at half a metre per second are more");
}
