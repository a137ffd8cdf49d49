use super::*;
use crate::cost::{Cost, EXCLUDED, TICK, Weights};
use crate::grid::{BLOCKED, Cell, DIAGONAL, Dir, Window};
use crate::rand::Rng;
use proptest::prelude::*;
use std::vec::Vec;

const NO_VISITS: Option<&VisitMemory<0>> = None;

/// North up: digits are impassabilities, `#` is blocked.
fn land(rows: &[&str]) -> (Vec<u8>, u16, u16) {
    let digit = |c: u8| if c == b'#' { BLOCKED } else { c - b'0' };
    let cells = rows.iter().rev().flat_map(|row| row.bytes().map(digit)).collect();
    (cells, rows[0].len() as u16, rows.len() as u16)
}

fn weights_on(rows: &[&str], params: &RouteParams, from: (i16, i16), to: (i16, i16)) -> Result<Weights, Unreachable> {
    let (cells, width, height) = land(rows);
    let window = Window::new(&cells, Cell::default(), width, height).unwrap();
    let mut field = CostField::<400>::new();
    field.weights(params, &window, Cell::new(from.0, from.1), Cell::new(to.0, to.1), [], NO_VISITS)
}

#[test]
fn cheapest_way_to_a_target_inside_avoids_bad_land() {
    let params = RouteParams { a3: Gain::ZERO, ..RouteParams::default() };
    let weights = weights_on(&["11111", "19991", "11111"], &params, (0, 1), (4, 1)).unwrap();
    // Two diagonal and two straight moves; once on bad land, off it by a diagonal.
    assert_eq!(weights.get(Dir::East), 10 * TICK + 2 * Gain::ONE.of(DIAGONAL));
    assert_eq!(weights.get(Dir::NorthEast), 2 * TICK + 2 * Gain::ONE.of(DIAGONAL));
    assert_eq!(weights.get(Dir::NorthEast), weights.get(Dir::SouthEast));
    assert_eq!(weights.best(), Some(Dir::NorthEast));
}

#[test]
fn corners_are_cut_only_when_allowed() {
    let rows = ["111", "1#1", "111"];
    let no = RouteParams::default();
    let yes = RouteParams { corner_cutting: true, ..no };
    assert_eq!(weights_on(&rows, &no, (1, 0), (2, 1)).unwrap().get(Dir::NorthEast), EXCLUDED);
    assert_eq!(weights_on(&rows, &yes, (1, 0), (2, 1)).unwrap().get(Dir::NorthEast), Gain::ONE.of(DIAGONAL));
}

#[test]
fn weights_never_return_through_the_own_cell() {
    // The only way from the western pocket leads over the robot's own cell.
    let weights = weights_on(&["###", "111", "###"], &RouteParams::default(), (1, 1), (2, 1)).unwrap();
    assert_eq!(weights.get(Dir::West), EXCLUDED);
    assert_eq!(weights.get(Dir::East), TICK);
}

#[test]
fn closed_in_robot_gets_an_error() {
    let params = RouteParams::default();
    assert_eq!(weights_on(&["###", "#1#", "###"], &params, (1, 1), (9, 9)), Err(Unreachable));
    assert_eq!(weights_on(&["1"], &params, (0, 0), (0, 0)), Err(Unreachable));
    assert_eq!(weights_on(&["1"], &params, (5, 5), (0, 0)), Err(Unreachable), "outside the window");
}

#[test]
fn best_exit_trades_path_against_distance() {
    let params = RouteParams { radius: 1, a3: Gain::from_int(3), ..RouteParams::default() };
    let weights = weights_on(&["111", "119", "111"], &params, (1, 1), (11, 1)).unwrap();
    assert_eq!(weights.get(Dir::East), 9 * TICK + 3 * 9 * TICK);
    assert_eq!(weights.best(), Some(Dir::NorthEast));
}

#[test]
fn ray_takes_the_single_exit_or_the_nearest_reachable_border_cell() {
    let params = RouteParams { radius: 2, exit: ExitRule::Ray, ..RouteParams::default() };
    let open = ["11111", "11111", "11111", "11111", "11111"];
    let weights = weights_on(&open, &params, (2, 2), (20, 2)).unwrap();
    assert_eq!(weights.get(Dir::East), 2 * TICK);
    let walled = ["11111", "111##", "111##", "111##", "11111"];
    let weights = weights_on(&walled, &params, (2, 2), (20, 2)).unwrap();
    // (4, 0) and (4, 4) are equally near to the blocked (4, 2): the smaller cell wins.
    assert_eq!(weights.best(), Some(Dir::South));
}

#[test]
fn visits_and_other_robots_cost_their_gains() {
    let params = RouteParams {
        radius: 1,
        a1: Gain::from_int(5),
        a2: Gain::from_int(2),
        a3: Gain::ZERO,
        ..RouteParams::default()
    };
    let cells = [1; 9];
    let window = Window::new(&cells, Cell::default(), 3, 3).unwrap();
    let mut visits = VisitMemory::<4>::new();
    visits.enter(Cell::new(0, 1));
    visits.enter(Cell::new(2, 1));
    visits.enter(Cell::new(0, 1));
    let mut field = CostField::<25>::new();
    let weights =
        field.weights(&params, &window, Cell::new(1, 1), Cell::new(9, 1), [Cell::new(1, 0)], Some(&visits)).unwrap();
    assert_eq!(weights.get(Dir::East), TICK + 2 * TICK);
    assert_eq!(weights.get(Dir::West), TICK + 4 * TICK);
    assert_eq!(weights.get(Dir::South), TICK + 5 * TICK);
    assert_eq!(weights.get(Dir::North), TICK);
}

#[test]
fn window_larger_than_the_field_is_cut_and_never_panics() {
    let cells = [1; 121];
    let window = Window::new(&cells, Cell::default(), 11, 11).unwrap();
    let params = RouteParams::default();
    let mut field = CostField::<60>::new();
    let weights = field.weights(&params, &window, Cell::new(5, 1), Cell::new(99, 1), [], NO_VISITS);
    assert!(weights.is_ok());
    let mut nothing = CostField::<0>::new();
    assert_eq!(nothing.weights(&params, &window, Cell::new(5, 5), Cell::new(9, 9), [], NO_VISITS), Err(Unreachable));
}

#[test]
fn plan_is_followed_until_something_changes_on_it() {
    let params = RouteParams { radius: 3, a3: Gain::ONE, ..RouteParams::default() };
    let mut cells = [1; 49];
    let target = Cell::new(6, 3);
    let mut router = Router::<8>::new();
    let mut field = CostField::<81>::new();
    let mut here = Cell::new(3, 3);
    let mut follow = |router: &mut Router<8>, cells: &[u8], here, others: &[Cell]| {
        let window = Window::new(cells, Cell::default(), 7, 7).unwrap();
        router.observe(&params, here, target);
        router.follow(&params, &mut field, &window, here, target, others.iter().copied()).unwrap()
    };
    assert_eq!(follow(&mut router, &cells, here, &[]), Dir::East);
    here = Cell::new(4, 3);
    cells[0] = 9;
    assert_eq!(follow(&mut router, &cells, here, &[Cell::new(5, 5)]), Dir::East);
    cells[3 * 7 + 5] = 9;
    assert_ne!(follow(&mut router, &cells, here, &[]), Dir::East);
}

#[test]
fn plan_does_not_hold_when_a_corner_beside_it_closes() {
    let params = RouteParams { radius: 3, ..RouteParams::default() };
    let mut cells = [1; 49];
    let target = Cell::new(6, 6);
    let mut router = Router::<8>::new();
    let mut field = CostField::<81>::new();
    let mut follow = |router: &mut Router<8>, cells: &[u8], here| {
        let window = Window::new(cells, Cell::default(), 7, 7).unwrap();
        router.observe(&params, here, target);
        router.follow(&params, &mut field, &window, here, target, []).unwrap()
    };
    assert_eq!(follow(&mut router, &cells, Cell::new(3, 3)), Dir::NorthEast);
    cells[4 * 7 + 5] = BLOCKED;
    assert_eq!(follow(&mut router, &cells, Cell::new(4, 4)), Dir::North);
}

#[test]
fn costs_are_final_or_withheld_until_the_search_is_complete() {
    let params = RouteParams::default();
    let mut field = CostField::<169>::new();
    let (mut early, mut withheld) = (0, 0);
    for seed in 0..100 {
        let mut rng = Rng::new(seed);
        let cells: Vec<u8> = (0..121).map(|_| 1 + rng.below(9) as u8).collect();
        let window = Window::new(&cells, Cell::new(-5, -5), 11, 11).unwrap();
        let target = Cell::new(4, rng.below(9) as i16 - 4);
        field.weights(&params, &window, Cell::default(), target, [], NO_VISITS).unwrap();
        let all = || (-5..=5).flat_map(|y| (-5..=5).map(move |x| Cell::new(x, y)));
        let costs: Vec<_> = all().map(|cell| field.cost(cell)).collect();
        field.complete(&params);
        for (cell, cost) in all().zip(costs) {
            let last = field.cost(cell);
            assert_eq!(last.is_some(), cell != Cell::default(), "{cell:?}");
            assert!(cost.is_none() || cost == last, "seed {seed}, {cell:?}: {cost:?} before {last:?}");
            early += i32::from(cost.is_some());
            withheld += i32::from(cost.is_none() && last.is_some());
        }
        assert_eq!((field.cost(target), field.cost(Cell::new(6, 0))), (Some(0), None));
    }
    assert!(early > 1000 && withheld > 1000, "{early} early, {withheld} withheld");
}

#[test]
fn a_dear_cell_closes_no_route() {
    let most = Gain::from_sixteenths(u16::MAX);
    let params = RouteParams { a0: most, a1: most, a2: most, ..RouteParams::default() };
    let (cells, width, height) = ([BLOCKED, BLOCKED, BLOCKED, 1, 255, 1, BLOCKED, BLOCKED, BLOCKED], 3, 3);
    let window = Window::new(&cells, Cell::default(), width, height).unwrap();
    let others = [Cell::new(1, 1); 900];
    let mut field = CostField::<25>::new();
    let found = field.weights(&params, &window, Cell::new(0, 1), Cell::new(2, 1), others, NO_VISITS).unwrap();
    assert_eq!((found.get(Dir::East), found.best()), (EXCLUDED - 1, Some(Dir::East)));
}

/// The only route enters a cell that costs 18 million buckets more than the others.
#[test]
fn a_wide_range_of_costs_takes_no_longer() {
    let mut cells = [BLOCKED; 121];
    cells[55..66].fill(1);
    let window = Window::new(&cells, Cell::new(-5, -5), 11, 11).unwrap();
    let params = RouteParams { a2: Gain::from_sixteenths(u16::MAX), ..RouteParams::default() };
    let mut visits = VisitMemory::<4>::new();
    for cell in [Cell::new(3, 0), Cell::new(-2, 0)] {
        (0..300).for_each(|_| visits.enter(cell));
    }
    let mut field = CostField::<169>::new();
    field.weights(&params, &window, Cell::default(), Cell::new(20, 0), [], Some(&visits)).unwrap();
    assert!(field.turns() <= 66 * 11, "{} buckets", field.turns());
}

#[test]
fn extreme_gains_neither_close_a_route_nor_take_long() {
    let cells = [1; 121];
    let window = Window::new(&cells, Cell::new(-5, -5), 11, 11).unwrap();
    let most = Gain::from_sixteenths(u16::MAX);
    let mut visits = VisitMemory::<4>::new();
    (0..300).for_each(|_| visits.enter(Cell::new(1, 0)));
    let others = [Cell::new(1, 1), Cell::new(1, -1)];
    let mut field = CostField::<169>::new();
    for a0 in [Gain::ZERO, Gain::from_sixteenths(1), Gain::ONE, most] {
        for a3 in [Gain::ZERO, Gain::ONE, most] {
            let params = RouteParams { a0, a1: most, a2: most, a3, ..RouteParams::default() };
            for target in [Cell::new(30_000, 0), Cell::new(i16::MAX, i16::MIN)] {
                let found = field.weights(&params, &window, Cell::default(), target, others, Some(&visits));
                let best = found.unwrap().best().unwrap();
                assert!(a3 == Gain::ZERO || best.offset().x >= 0, "{a0:?} {a3:?} {best:?}");
                // At most 65 empty buckets before each of the 121 cells.
                assert!(field.turns() <= 66 * 121, "{a0:?} {a3:?}: {} buckets", field.turns());
                let small = RouteParams { radius: 2, ..params };
                let found = field.weights(&small, &window, Cell::default(), target, others, Some(&visits));
                assert!(found.is_ok());
            }
        }
    }
}

fn oracle(cells: &[u8], width: usize, from: usize, exits: &[(usize, Cost)], params: &RouteParams) -> Vec<u64> {
    let height = cells.len() / width;
    let mut cost = std::vec![u64::MAX; cells.len()];
    for &(exit, price) in exits {
        if cells[exit] != BLOCKED && exit != from {
            cost[exit] = cost[exit].min(u64::from(price));
        }
    }
    let mut moves = std::vec![u64::MAX; 8];
    for _ in 0..cells.len() + 1 {
        for at in 0..cells.len() {
            for dir in Dir::MOVES {
                let (x, y) =
                    ((at % width) as i64 + i64::from(dir.offset().x), (at / width) as i64 + i64::from(dir.offset().y));
                let inside = |x: i64, y: i64| x >= 0 && y >= 0 && x < width as i64 && y < height as i64;
                if !inside(x, y) {
                    continue;
                }
                let next = y as usize * width + x as usize;
                let free = |x: i64, y: i64| inside(x, y) && cells[y as usize * width + x as usize] != BLOCKED;
                let (ax, ay) = ((at % width) as i64, (at / width) as i64);
                let corner = !dir.is_diagonal() || params.corner_cutting || (free(x, ay) && free(ax, y));
                if cells[next] == BLOCKED || next == from || !corner || cost[next] == u64::MAX || cells[at] == BLOCKED {
                    continue;
                }
                let total = cost[next] + u64::from(params.a0.of(dir.length(params.norm) * u32::from(cells[next])));
                if at == from {
                    moves[dir.index()] = total;
                } else {
                    cost[at] = cost[at].min(total);
                }
            }
        }
    }
    moves
}

proptest! {
    #[test]
    fn search_equals_bellman_ford(
        cells in proptest::collection::vec(prop_oneof![1 => Just(BLOCKED), 5 => 1u8..=9, 1 => 1u8..=255], 49),
        from in 0usize..49, inside in proptest::option::of(0usize..49),
        corner_cutting: bool, chebyshev: bool, a0 in 0u16..40, a3 in 0u16..100,
    ) {
        let norm = if chebyshev { crate::grid::Norm::Chebyshev } else { crate::grid::Norm::Euclidean };
        let params = RouteParams {
            radius: 7, norm, corner_cutting, a0: Gain::from_sixteenths(a0), a3: Gain::from_sixteenths(a3),
            ..RouteParams::default()
        };
        let cell = |at: usize| Cell::new((at % 7) as i16, (at / 7) as i16);
        prop_assume!(cells[from] != BLOCKED && inside != Some(from));
        let target = inside.map_or(Cell::new(30, -4), cell);
        let window = Window::new(&cells, Cell::default(), 7, 7).unwrap();
        let mut field = CostField::<81>::new();
        let found = field.weights(&params, &window, cell(from), target, [], NO_VISITS);
        let border: Vec<_> = (0..49).filter(|at| [0, 6].contains(&(at % 7)) || [0, 6].contains(&(at / 7)))
            .map(|at| (at, params.a3.of(cell(at).distance(target, norm)))).collect();
        let mut wanted = inside.map_or(std::vec![u64::MAX; 8], |at| oracle(&cells, 7, from, &[(at, 0)], &params));
        if wanted.iter().all(|&cost| cost == u64::MAX) {
            wanted = oracle(&cells, 7, from, &border, &params);
        }
        for (dir, cost) in found.unwrap_or(Weights::CLOSED).iter() {
            let cost = if cost == EXCLUDED { u64::MAX } else { u64::from(cost) };
            prop_assert_eq!(cost, wanted[dir.index()], "{:?}", dir);
        }
    }
}
