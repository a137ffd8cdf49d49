use super::*;
use crate::grid::{BLOCKED, Cell, Dir, Window};
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

const SIDE: i16 = 20;

/// 20 x 20 cells within walls of 7 cells, wider than any view in these tests.
struct Land {
    cells: Vec<u8>,
}

const RIM: i16 = 7;
const WIDTH: i16 = SIDE + 2 * RIM;

impl Land {
    fn new(inside: &[u8]) -> Self {
        let mut land = Self { cells: vec![BLOCKED; (WIDTH * WIDTH) as usize] };
        for (at, &u) in inside.iter().enumerate() {
            let at = at as i16;
            land.cells[((at / SIDE + RIM) * WIDTH + at % SIDE + RIM) as usize] = u;
        }
        land
    }

    fn window(&self) -> Window<'_> {
        Window::new(&self.cells, Cell::new(-RIM, -RIM), WIDTH as u16, WIDTH as u16).unwrap()
    }

    fn moves(&self, from: Cell, corner_cutting: bool) -> impl Iterator<Item = Cell> + '_ {
        let window = self.window();
        Dir::MOVES.into_iter().filter_map(move |dir| {
            let Cell { x, y } = dir.offset();
            let open = |dx, dy| window.is_passable(from + Cell::new(dx, dy));
            let corners = !dir.is_diagonal() || corner_cutting || open(x, 0) && open(0, y);
            (corners && open(x, y)).then_some(from + Cell::new(x, y))
        })
    }

    fn can_reach(&self, from: Cell, to: Cell, corner_cutting: bool) -> bool {
        let mut known = vec![from];
        let mut next = 0;
        while let Some(&cell) = known.get(next) {
            let around: Vec<Cell> = self.moves(cell, corner_cutting).filter(|cell| !known.contains(cell)).collect();
            known.extend(around);
            next += 1;
        }
        known.contains(&to)
    }

    fn walk<const M: usize, const L: usize>(&self, params: &RouteParams, from: Cell, to: Cell) -> Option<usize> {
        let mut router = Router::<M, L>::new();
        let mut field = CostField::<225>::new();
        let mut cell = from;
        for moves in 0..30_000 {
            router.observe(params, cell, to);
            if cell == to {
                return Some(moves);
            }
            let dir = router.weights(params, &mut field, &self.window(), cell, to, []).unwrap().best().unwrap();
            let next = cell + dir.offset();
            assert!(self.moves(cell, params.corner_cutting).any(|open| open == next), "{cell:?} to {next:?}");
            cell = next;
        }
        None
    }
}

fn cell() -> impl Strategy<Value = Cell> {
    (0..SIDE, 0..SIDE).prop_map(|(x, y)| Cell::new(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_reachable_target_is_reached(
        walls in 1..9_u8,
        inside in prop::collection::vec((0..20_u8, 1..4_u8), (SIDE * SIDE) as usize),
        (from, to) in (cell(), cell()),
        radius in 1..6_u8,
        corner_cutting: bool,
        gains in any::<[u8; 2]>(),
    ) {
        let inside: Vec<u8> = inside.into_iter().map(|(die, u)| if die < walls { BLOCKED } else { u }).collect();
        let land = Land::new(&inside);
        prop_assume!(land.window().is_passable(from) && land.can_reach(from, to, corner_cutting));
        let [a2, a3] = gains.map(|gain| Gain::from_sixteenths(gain.into()));
        let params = RouteParams { radius, corner_cutting, a2, a3, ..RouteParams::default() };
        prop_assert!(land.walk::<0, 0>(&params, from, to).is_some(), "the wall alone");
        prop_assert!(land.walk::<8, 8>(&params, from, to).is_some(), "with little memory");
        prop_assert!(land.walk::<64, 256>(&params, from, to).is_some(), "with much");
    }
}

fn dead_end() -> Land {
    let mut inside = vec![1; (SIDE * SIDE) as usize];
    for at in 2..18 {
        inside[(at * SIDE + 16) as usize] = BLOCKED;
        inside[(2 * SIDE + at) as usize] = BLOCKED;
        inside[(17 * SIDE + at) as usize] = BLOCKED;
    }
    Land::new(&inside)
}

#[test]
fn wall_following_and_learning_leave_a_dead_end_larger_than_the_window() {
    let params = RouteParams { radius: 3, ..RouteParams::default() };
    let (from, to) = (Cell::new(15, 10), Cell::new(19, 10));
    let wall = dead_end().walk::<0, 0>(&params, from, to).unwrap();
    let learning = dead_end().walk::<0, 256>(&params, from, to).unwrap();
    assert!(wall < 100 && learning < 200, "{wall} and {learning}");
}

#[test]
fn a_robot_pushed_off_the_wall_still_arrives() {
    let land = dead_end();
    let params = RouteParams { radius: 3, ..RouteParams::default() };
    let (mut cell, to) = (Cell::new(15, 10), Cell::new(19, 10));
    let mut router = Router::<8>::new();
    let mut field = CostField::<225>::new();
    let mut moves = 0;
    while cell != to {
        router.observe(&params, cell, to);
        let weights = router.weights(&params, &mut field, &land.window(), cell, to, []).unwrap();
        let pushed = land.moves(cell, false).last().filter(|_| moves % 150 == 149);
        cell = pushed.unwrap_or(cell + weights.best().unwrap().offset());
        moves += 1;
        assert!(moves < 5000);
    }
}

#[test]
fn others_in_sight_are_not_learned_as_walls() {
    let land = dead_end();
    let params = RouteParams { radius: 3, a1: Gain::from_int(200), ..RouteParams::default() };
    let to = Cell::new(19, 10);
    let learned = |others: &[Cell]| {
        let mut router = Router::<0, 64>::new();
        let mut field = CostField::<225>::new();
        for cell in [Cell::new(15, 10), Cell::new(14, 10)] {
            router.observe(&params, cell, to);
            router.weights(&params, &mut field, &land.window(), cell, to, others.iter().copied()).unwrap();
        }
        crate::digest::digest(&router)
    };
    assert_eq!(learned(&[Cell::new(13, 9)]), learned(&[Cell::new(13, 10), Cell::new(12, 11)]));
    assert_ne!(learned(&[]), learned(&[Cell::new(13, 10)]));
}
