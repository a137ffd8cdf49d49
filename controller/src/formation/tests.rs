use super::*;
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::robot::{Mode, RobotId};
use crate::template::{Template, TemplateEntry, TemplateError, rotated};
use proptest::prelude::*;
use std::vec::Vec;

/// Figure 5: rows 1 2 3 and 4 5 6, three cells apart, robot 1 in front.
const PLACES: [Cell; 6] =
    [Cell::new(0, 0), Cell::new(-3, 0), Cell::new(-6, 0), Cell::new(0, -3), Cell::new(-3, -3), Cell::new(-6, -3)];
const EDGES: [(u16, u16); 7] = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)];

fn template(robot: usize, rho: u8) -> Template<8> {
    Template::from_graph(&PLACES, &EDGES, robot - 1, rho).unwrap()
}

fn seen(id: u32, x: i16, y: i16) -> Seen {
    let cell = Cell::new(x, y);
    Seen { id: RobotId(id), cell, predicted: cell, heading: Dir::Stay, leader: RobotId::NOBODY, mode: Mode::Cruise }
}

/// Everybody in place, robot 1 at `top`.
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
    // Farther neighbours of a larger radius become leaders only when no nearer one is there.
    let leader_without = |dead: &[u32]| {
        let living: Vec<Seen> = robots.iter().copied().filter(|seen| !dead.contains(&seen.id.0)).collect();
        find_leader(RobotId(6), &found(6, 3, 2, &living).members).0
    };
    assert_eq!([leader_without(&[]), leader_without(&[3])], [3, 5]);
    assert_eq!([leader_without(&[3, 5]), leader_without(&[3, 5, 1, 2, 4])], [1, 0]);
}

#[test]
fn templates_hold_everybody_within_the_geodesic_radius() {
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
fn graphs_that_make_no_sense_are_refused() {
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
fn a_place_for_anyone_takes_the_nearest_that_nobody_named() {
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
    // Robot 2 is two cells west of its place by robots 1, 3 and 5.
    robots[1].cell = Cell::new(5, 10);
    let found = found(2, 1, 5, &robots);
    let price = distances(&params, Cell::new(5, 10), None, &found.members);
    assert_eq!(price.best(), Some(Dir::East));
    // One cell off its place by everybody: one tick at a gain of 1.
    assert_eq!(price.get(Dir::East), crate::cost::TICK);
    let by_top = distances(&params, Cell::new(5, 10), Some(Cell::new(7, 10)), &[]);
    assert_eq!(by_top.get(Dir::East), crate::cost::TICK);
    let nobody = distances(&params, Cell::new(5, 10), None, &[]);
    assert_eq!(nobody, crate::cost::Weights::new([0; 8]));
}

#[test]
fn places_out_of_reach_close_no_move() {
    let params = FormationParams { gain: crate::cost::Gain::from_sixteenths(u16::MAX), ..FormationParams::default() };
    let far = Cell::new(i16::MAX, i16::MIN);
    assert!(distances(&params, Cell::default(), Some(far), &[]).best().is_some());
}

#[test]
fn lag_counts_what_is_behind_in_full_and_the_rest_by_half() {
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
    let mut pace = Pace::new();
    let waits = [300, 301, 250, 201, 200, 250].map(|lag| pace.update(&params, lag));
    assert_eq!(waits, [false, true, true, true, false, false]);
}

#[test]
fn def_points_to_where_the_others_are_off_to() {
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
fn land_is_priced_for_all_who_would_cross_it() {
    // Columns of impassability 1, 1, 9, 9; somebody two cells to the east; a wall at the end.
    let cells = [1, 1, 9, BLOCKED];
    let window = Window::new(&cells, Cell::new(20, 5), 4, 1).unwrap();
    let entry = TemplateEntry { offset: Cell::new(2, 0), id: RobotId(2), hops: 1 };
    let mut out = [0; 4];
    let mut price =
        |footprint| blended(&window, (Cell::new(20, 5), 3), &[entry], footprint, &mut out).unwrap().cells().to_vec();
    assert_eq!(price(Footprint::Mean(0)), cells);
    // West cell: half of 1 and 9. Second: the wall behind counts not. Walls stay.
    assert_eq!(price(Footprint::Mean(8)), [5, 1, 9, BLOCKED]);
    assert_eq!(price(Footprint::Mean(16)), [9, 1, 9, BLOCKED]);
    assert_eq!(price(Footprint::Dearest), [9, 1, 9, BLOCKED]);
    let around = (Cell::new(20, 5), 1);
    assert!(blended(&window, around, &[entry], Footprint::Dearest, &mut [0; 1]).is_none());
    // A larger window than the search needs: only its part is priced, all of it is looked at.
    let mut near = [0; 2];
    let near = blended(&window, around, &[entry], Footprint::Mean(16), &mut near).unwrap();
    assert_eq!((near.origin(), near.cells()), (Cell::new(20, 5), &[9, 1][..]));
}

#[test]
fn a_robot_near_its_place_stands_rather_than_leave_it() {
    let place = Cell::new(3, 3);
    assert!(should_stay(Cell::new(3, 3), place, Dir::East));
    assert!(!should_stay(Cell::new(2, 3), place, Dir::East));
    assert!(!should_stay(Cell::new(1, 3), place, Dir::West), "too far off to rest");
}

#[test]
fn graph_distance_is_the_paper_s_sum() {
    let mut robots = in_place(Cell::new(10, 10));
    robots[1].cell = Cell::new(4, 14);
    robots.remove(3);
    let at = graph_distance(Cell::new(10, 10), &found(1, 1, 10, &robots));
    // Robot 4 is missing; robot 2 is (3, 4) = 5 cells off.
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
            // Rounding moves a cell by at most half a diagonal.
            prop_assert!((norm(rotated(offset, dir)) - norm(offset)).abs() <= 0.72, "{:?}", dir);
        }
    }

    /// Who stands where does not depend on where the map has its origin.
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
