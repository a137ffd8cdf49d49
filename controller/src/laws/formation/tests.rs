use super::*;
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::robot::{Mode, RobotId};
use crate::template::{Template, TemplateEntry, TemplateError, rotated};
use proptest::prelude::*;
use std::vec::Vec;

/// Figure 5: rows 1 2 3 and 4 5 6, three cells apart.
const PLACES: [Cell; 6] =
    [Cell::new(0, 0), Cell::new(-3, 0), Cell::new(-6, 0), Cell::new(0, -3), Cell::new(-3, -3), Cell::new(-6, -3)];
const EDGES: [(u16, u16); 7] = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)];

fn template(robot: usize, rho: u8) -> Template<8> {
    Template::from_graph(&PLACES, &EDGES, robot - 1, rho).unwrap()
}

fn seen(id: u32, x: i16, y: i16) -> Seen {
    let cell = Cell::new(x, y);
    Seen { id: RobotId(id), cell, predicted: cell, heading: Dir::Stay, leader: RobotId::NONE, mode: Mode::Cruise }
}

fn in_place(top: Cell) -> Vec<Seen> {
    (1..).zip(PLACES).map(|(id, place)| seen(id, top.x + place.x, top.y + place.y)).collect()
}

fn found(robot: usize, rho: u8, eps: u8, robots: &[Seen]) -> Found<8> {
    let own = robots.iter().find(|r| r.id == RobotId(robot as u32)).unwrap();
    let others = robots.iter().copied().filter(|r| r.id != own.id);
    find_neighbors(&template(robot, rho), own.cell, eps, others)
}

#[test]
fn leaders_of_figure_5_are_those_of_the_paper() {
    let robots = in_place(Cell::new(10, 10));
    let leaders: Vec<u32> =
        (1..=6).map(|id| find_leader(RobotId(id), &found(id as usize, 1, 2, &robots).members).0).collect();
    assert_eq!(leaders, [0, 1, 2, 1, 2, 3]);
    let leader_without = |dead: &[u32]| {
        let living: Vec<Seen> = robots.iter().copied().filter(|seen| !dead.contains(&seen.id.0)).collect();
        find_leader(RobotId(6), &found(6, 3, 2, &living).members).0
    };
    assert_eq!([leader_without(&[]), leader_without(&[3])], [3, 5]);
    assert_eq!([leader_without(&[3, 5]), leader_without(&[3, 5, 1, 2, 4])], [1, 0]);
}

#[test]
fn templates_hold_all_robots_within_the_geodesic_radius() {
    let ids = |robot, rho| -> Vec<(u32, u8)> {
        let template = template(robot, rho);
        template.entries.iter().map(|e| (e.id.0, e.hops)).collect()
    };
    assert_eq!(ids(1, 1), [(2, 1), (4, 1)]);
    assert_eq!(ids(1, 3), [(2, 1), (4, 1), (3, 2), (5, 2), (6, 3)]);
    assert_eq!(ids(1, 0), []);
    let own = template(6, 1);
    assert_eq!((own.slot, own.offset), (5, Cell::new(-6, -3)));
    assert_eq!(own.entries[0].offset, Cell::new(0, 3));
}

#[test]
fn invalid_graphs_are_refused() {
    let of = |edges: &[(u16, u16)], own| Template::<1>::from_graph(&PLACES, edges, own, 1);
    assert_eq!(of(&EDGES, 6), Err(TemplateError::NoSuchPlace));
    assert_eq!(of(&[(0, 6)], 0), Err(TemplateError::BadEdge));
    assert_eq!(of(&[(2, 2)], 0), Err(TemplateError::BadEdge));
    assert_eq!(of(&EDGES, 0), Err(TemplateError::TooMany));
    assert_eq!(of(&[], 0).unwrap().entries.len(), 0);
    let none = Template::<1>::from_graph(&[], &[], 0, 1);
    assert_eq!(none, Err(TemplateError::NoSuchPlace));
}

#[test]
fn straying_beyond_eps_counts_as_missing_and_a_stranger_in_the_place_as_surplus() {
    let mut robots = in_place(Cell::new(10, 10));
    robots[1].cell = Cell::new(10, 10);
    let all = found(1, 1, 3, &robots);
    assert_eq!((all.members.len(), all.less, all.more), (2, 0, 0));
    let strict = found(1, 1, 2, &robots);
    assert_eq!((strict.members.len(), strict.less, strict.more), (1, 1, 0));
    robots.push(seen(9, 7, 10));
    let crowded = found(1, 1, 2, &robots);
    assert_eq!((crowded.more, crowded.surplus), (1, RobotId(9)));
}

#[test]
fn a_place_without_a_number_takes_the_nearest_unnamed_robot() {
    let entry = |x, id| TemplateEntry { offset: Cell::new(x, 0), id: RobotId(id), hops: 1 };
    let anyone = Template::<3> {
        slot: 0,
        offset: Cell::default(),
        entries: [entry(2, 7), entry(2, 0), entry(3, 0)].into_iter().collect(),
    };
    let robots = [seen(5, 4, 0), seen(7, 2, 0), seen(8, 3, 0)];
    let found = find_neighbors(&anyone, Cell::default(), 3, robots.into_iter());
    let ids: Vec<u32> = found.members.iter().map(|m| m.seen.id.0).collect();
    assert_eq!(ids, [7, 8, 5]);
    assert_eq!(found.less, 0);
}

#[test]
fn costs_restart_for_each_direction_and_point_to_the_place() {
    let params = FormationParams::default();
    let mut robots = in_place(Cell::new(10, 10));
    robots[1].cell = Cell::new(5, 10);
    let found = found(2, 1, 5, &robots);
    let price = distances(&params, Cell::new(5, 10), None, &found.members);
    assert_eq!(price.best(), Some(Dir::East));
    assert_eq!(price.get(Dir::East), crate::cost::TICK);
    let by_top = distances(&params, Cell::new(5, 10), Some(Cell::new(7, 10)), &[]);
    assert_eq!(by_top.get(Dir::East), crate::cost::TICK);
    // Half of each: 3 cells from the top leader's place, 1 cell from the member's.
    let by_both = distances(&params, Cell::new(5, 10), Some(Cell::new(9, 10)), &found.members);
    assert_eq!(by_both.get(Dir::East), 2 * crate::cost::TICK);
    let alone = distances(&params, Cell::new(5, 10), None, &[]);
    assert_eq!(alone, crate::cost::Weights::new([0; 8]));
}

#[test]
fn places_out_of_reach_close_no_move() {
    let params = FormationParams { gain: crate::cost::Gain::from_sixteenths(u16::MAX), ..FormationParams::default() };
    let far = Cell::new(i16::MAX, i16::MIN);
    assert!(distances(&params, Cell::default(), Some(far), &[]).best().is_some());
}

#[test]
fn lag_counts_the_distance_behind_in_full_and_the_rest_by_half() {
    let at = |x, y| Cell::new(x, y);
    assert_eq!(lag(at(-4, 0), Dir::East), 280);
    assert_eq!(lag(at(4, 0), Dir::East), 140);
    assert_eq!(lag(at(0, 4), Dir::East), 140);
    assert_eq!(lag(at(-3, 4), Dir::Stay), 350);
    // Three cells back along the diagonal are 3 sqrt 2 long.
    assert_eq!(lag(at(-3, -3), Dir::NorthEast), 297);
    assert_eq!(lag(at(0, 0), Dir::NorthEast), 0);
    assert!(lag(at(i16::MIN, i16::MIN), Dir::NorthEast) > 3_000_000);
}

#[test]
fn waiting_has_hysteresis() {
    let params = FormationParams { halt_lag: 300, resume_lag: 200, ..FormationParams::default() };
    let mut pace = PaceControl::new();
    let waits = [300, 301, 250, 201, 200, 250].map(|lag| pace.update(&params, lag));
    assert_eq!(waits, [false, true, true, true, false, false]);
}

#[test]
fn def_points_in_the_direction_of_the_others_displacement() {
    let cell = Cell::new(10, 10);
    let with = |x: i16, y: i16| {
        let mut robots = in_place(cell);
        robots[1].cell = robots[1].cell + Cell::new(x, y);
        def(cell, &found(1, 1, 100, &robots).members)
    };
    assert_eq!(with(0, 0), Dir::Stay);
    for dir in Dir::MOVES {
        assert_eq!(with(7 * dir.offset().x, 7 * dir.offset().y), dir);
    }
    assert_eq!(with(5, 2), Dir::East, "21.8 degrees");
    assert_eq!(with(5, 3), Dir::NorthEast, "31 degrees");
}

#[test]
fn land_is_priced_for_all_robots_that_would_cross_it() {
    let cells = [1, 1, 9, BLOCKED];
    let window = Window::new(&cells, Cell::new(20, 5), 4, 1).unwrap();
    let entry = TemplateEntry { offset: Cell::new(2, 0), id: RobotId(2), hops: 1 };
    let mut out = [0; 4];
    let mut price =
        |footprint| blended(&window, (Cell::new(20, 5), 3), &[entry], footprint, &mut out).unwrap().cells().to_vec();
    assert_eq!(price(Footprint::Mean(0)), cells);
    // West: half of 1 and 9. Second: the wall behind does not count.
    assert_eq!(price(Footprint::Mean(8)), [5, 1, 9, BLOCKED]);
    assert_eq!(price(Footprint::Mean(16)), [9, 1, 9, BLOCKED]);
    assert_eq!(price(Footprint::Dearest), [9, 1, 9, BLOCKED]);
    // Sixteenths are rounded to the nearest class: 3, 3.5, 4, 8.5 and 9.
    for (share, wanted) in [(4, 3), (5, 4), (6, 4), (15, 9), (16, 9)] {
        assert_eq!(price(Footprint::Mean(share))[0], wanted, "{share}");
    }
    let around = (Cell::new(20, 5), 1);
    assert!(blended(&window, around, &[entry], Footprint::Dearest, &mut [0; 1]).is_none());
    let mut near = [0; 2];
    let near = blended(&window, around, &[entry], Footprint::Mean(16), &mut near).unwrap();
    assert_eq!((near.origin(), near.cells()), (Cell::new(20, 5), &[9, 1][..]));
}

#[test]
fn a_robot_near_its_place_stays_rather_than_leave_it() {
    let place = Cell::new(3, 3);
    assert!(should_stay(Cell::new(3, 3), place, Dir::East));
    assert!(!should_stay(Cell::new(2, 3), place, Dir::East));
    assert!(!should_stay(Cell::new(1, 3), place, Dir::West), "too far away to rest");
}

#[test]
fn graph_distance_is_the_paper_s_sum() {
    let mut robots = in_place(Cell::new(10, 10));
    robots[1].cell = Cell::new(4, 14);
    robots.remove(3);
    let at = graph_distance(Cell::new(10, 10), &found(1, 1, 10, &robots));
    assert_eq!((at.less, at.more, at.offsets), (1, 0, 350));
    assert_eq!(at.units(100), 70 + 3);
    assert_eq!(at.units(0), 70 + 350);
}

#[test]
fn formation_error_is_a_mean_over_robots_and_ticks() {
    let mut error = FormationError::new();
    assert_eq!(error.mean(), 0);
    error.add(Cell::new(0, 0), Cell::new(3, 4));
    error.add(Cell::new(0, 0), Cell::new(0, 0));
    assert_eq!(error.mean(), 175);
}

proptest! {
    #[test]
    fn four_quarter_turns_change_nothing_and_length_stays(x in -100_i16..100, y in -100_i16..100) {
        let offset = Cell::new(x, y);
        let turned = (0..4).fold(offset, |o, _| rotated(o, Dir::North));
        prop_assert_eq!(turned, offset);
        prop_assert_eq!(rotated(offset, Dir::East), offset);
        let norm = |o: Cell| libm::sqrt(Cell::default().distance_squared(o) as f64);
        for dir in Dir::MOVES {
            prop_assert!((norm(rotated(offset, dir)) - norm(offset)).abs() <= 0.72, "{:?}", dir);
        }
    }

    #[test]
    fn everything_is_relative(
        shift in (-500_i16..500, -500_i16..500),
        off in proptest::array::uniform6((-4_i16..5, -4_i16..5)),
        eps in 0_u8..8,
    ) {
        let build = |top: Cell| -> Vec<Seen> {
            in_place(top)
                .into_iter()
                .zip(off)
                .map(|(s, (x, y))| seen(s.id.0, s.cell.x + x, s.cell.y + y))
                .collect()
        };
        let (here, there) = (build(Cell::new(0, 0)), build(Cell::new(shift.0, shift.1)));
        let params = FormationParams::default();
        for robot in 1..=6 {
            let [a, b] = [&here, &there].map(|robots| found(robot, 2, eps, robots));
            prop_assert_eq!(a.members.len() + usize::from(a.less), template(robot, 2).entries.len());
            prop_assert_eq!((a.less, a.more), (b.less, b.more));
            let own = |robots: &[Seen]| robots[robot - 1].cell;
            prop_assert_eq!(
                distances(&params, own(&here), None, &a.members),
                distances(&params, own(&there), None, &b.members)
            );
            prop_assert_eq!(def(own(&here), &a.members), def(own(&there), &b.members));
        }
    }

    #[test]
    fn any_lag_is_bounded_by_the_distance(x in any::<i16>(), y in any::<i16>(), dir in 0_u8..9) {
        let off = Cell::new(x, y);
        let length = Cell::default().distance(off, crate::grid::Norm::Euclidean);
        let lag = lag(off, Dir::from_index(dir));
        // sqrt 2 as a rational is 5e-5 too long.
        prop_assert!(lag <= length + length / 10_000 + 2);
        prop_assert!(lag >= length / 2);
    }
}

mod in_plane {
    use super::super::{Drive, behind, is_straight};
    use crate::body::Body;
    use crate::geom::{Vec2, Vec3};
    use crate::grid::{BLOCKED, Cell, Window};
    use crate::robot::RobotId;
    use proptest::prelude::*;

    /// 2 s to full speed.
    fn body() -> Body<f32> {
        Body {
            id: RobotId(1),
            velocity_mps: Vec3::ZERO,
            radius_m: 1.0,
            max_speed_mps: 2.0,
            max_acceleration_mps2: 1.0,
            step_s: 0.1,
        }
    }

    #[test]
    fn in_its_place_a_follower_has_its_leaders_velocity() {
        let drive = Drive::new(&body());
        let leader = Vec2::new(1.2, -0.7);
        assert_eq!(drive.follow(Vec2::ZERO, leader), leader);
        assert_eq!(drive.follow(Vec2::new(1.0, 0.0), Vec2::new(1.0, 0.0)), Vec2::new(1.5, 0.0));
        assert!((drive.follow(Vec2::new(90.0, 9.0), leader).norm() - 2.0).abs() < 1e-5);
        assert_eq!(drive.follow(Vec2::new(f32::NAN, 0.0), Vec2::ZERO), Vec2::ZERO);
    }

    #[test]
    fn a_leader_keeps_a_reserve_waits_in_proportion_and_comes_to_rest() {
        let drive = Drive::new(&body());
        assert_eq!(drive.halt_m(), 3.0);
        assert!((drive.leads_at(0.0, 90.0) - 1.8).abs() < 1e-6);
        assert!((drive.leads_at(1.5, 90.0) - 0.9).abs() < 1e-6);
        assert_eq!((drive.leads_at(3.0, 90.0), drive.leads_at(9.0, 90.0)), (0.0, 0.0));
        assert_eq!((drive.leads_at(0.0, 0.0), drive.leads_at(0.0, 1.0)), (0.0, 0.5));
        let drive = Drive::new(&Body { max_acceleration_mps2: f32::MAX, ..body() });
        assert_eq!(drive.halt_m(), 2.0);
    }

    #[test]
    fn a_robot_rests_within_a_quarter_of_its_radius_and_leaves_beyond_half() {
        let drive = Drive::new(&Body { radius_m: 2.0, ..body() });
        assert_eq!((drive.tolerance_m(false), drive.tolerance_m(true)), (0.5, 1.0));
    }

    /// 1 m/s^2 in steps of 0.1 s: 0.05 m/s a step to speed up or turn, 0.1 m/s to brake.
    #[test]
    fn a_leader_speeds_up_and_turns_half_as_fast_as_it_brakes() {
        let drive = Drive::new(&body());
        let east = |x| Vec2::new(x, 0.0);
        for (wish, wanted) in [
            (east(2.0), east(1.05)),
            (east(0.0), east(0.9)),
            (east(-2.0), east(0.9)),
            (east(0.95), east(0.95)),
            (Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.05)),
        ] {
            let off: Vec2<f32> = drive.gently(east(1.0), wish) - wanted;
            assert!(off.norm() < 1e-6, "{wish:?}: {off:?}");
        }
    }

    #[test]
    fn a_robot_ahead_or_aside_is_not_behind() {
        let north = Vec2::new(0.0, 1.0);
        assert_eq!(behind(Vec2::new(0.0, -3.0), north), 3.0);
        assert_eq!(behind(Vec2::new(9.0, 0.0), north), 0.0);
        assert_eq!(behind(Vec2::new(9.0, 5.0), north), 0.0);
        let drive = Drive::new(&body());
        assert!(drive.is_far_behind(Vec2::new(0.0, 3.1), north * 2.0));
        assert!(!drive.is_far_behind(Vec2::new(0.0, 2.9), north * 2.0));
        assert!(!drive.is_far_behind(Vec2::new(50.0, -1.0), north * 2.0));
    }

    #[test]
    fn a_wall_on_the_straight_way_closes_it_and_one_out_of_sight_does_not() {
        // The robot is in the second cell, half a metre east of its middle.
        let cells = [1, 1, 1, BLOCKED, 1];
        let window = Window::new(&cells, Cell::new(10, 7), 5, 1).unwrap();
        let here = (Cell::new(11, 7), Vec2::new(0.5_f32, 0.0), 2.0);
        let is_open = |way| is_straight(&window, here, way, &|cell| window.is_passable(cell));
        assert!(is_open(Vec2::new(2.4, 0.0)));
        assert!(!is_open(Vec2::new(2.6, 0.0)));
        assert!(!is_open(Vec2::new(400.0, 0.0)), "behind the wall");
        assert!(is_open(Vec2::new(-400.0, 0.0)), "beyond the window");
        assert!(is_open(Vec2::ZERO));
        let nonsense = (Cell::new(11, 7), Vec2::ZERO, 0.0);
        assert!(!is_straight(&window, nonsense, Vec2::new(1.0, 0.0), &|_| true));
    }

    /// The final error and the overshoot, with beacons that are `delay` steps old.
    fn follows(lag_s: f32, delay: usize) -> (f32, f32) {
        let (body, step_s) = (body(), 0.1);
        let mut leader = (Vec2::new(0.0, 0.0), Vec2::ZERO);
        let mut own = (Vec2::new(-3.0, 4.0), Vec2::ZERO);
        let mut told = std::vec::Vec::new();
        let (mut worst, mut overshoot) = (0.0_f32, 0.0_f32);
        for step in 0..900 {
            let drive = Drive::new(&body);
            leader.1 = drive.gently(leader.1, Vec2::new(drive.leads_at(0.0, 100.0 - leader.0.x), 0.0));
            told.push(leader);
            let (at, velocity) = told[told.len().saturating_sub(delay + 1)];
            let place = at + velocity * (step_s * (delay as f32)).min(step_s * step as f32);
            let wish = drive.follow(place - own.0, velocity);
            let answer = (wish - own.1) * (step_s / lag_s).min(1.0);
            own.1 += answer.clamp_norm(body.max_acceleration_mps2 * step_s);
            own.0 += own.1 * step_s;
            leader.0 += leader.1 * step_s;
            let off = own.0 - leader.0;
            overshoot = overshoot.max(-off.y);
            if step > 150 {
                worst = worst.max(off.norm());
            }
        }
        (worst, overshoot)
    }

    #[test]
    fn a_body_with_lag_reaches_its_place_without_oscillating() {
        for delay in 0..=4 {
            for lag_s in [0.1, 0.5, 1.0] {
                let (worst, overshoot) = follows(lag_s, delay);
                assert!(
                    worst < 1.0 && overshoot < 0.1,
                    "lag {lag_s} s, delay {delay}: {worst} m, over by {overshoot} m"
                );
            }
        }
    }

    proptest! {
        #[test]
        fn no_wish_is_faster_than_the_body(x: u32, y: u32, vx: u32, vy: u32, lag: u32, left: u32) {
            let [x, y, vx, vy, lag, left] = [x, y, vx, vy, lag, left].map(f32::from_bits);
            let drive = Drive::new(&body());
            prop_assert!(drive.follow(Vec2::new(x, y), Vec2::new(vx, vy)).norm() <= 2.0001);
            let speed = drive.leads_at(lag.abs(), left.abs());
            prop_assert!(speed <= 1.8001, "{speed}");
        }
    }
}
