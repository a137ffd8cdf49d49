//! Converts the grid's blocked cells to walls.

use super::Obstacle;
use crate::geom::Vec2;
use crate::grid::{BLOCKED, Cell, GridFrame, Window};
use crate::list;
use crate::scalar::Scalar;
use heapless::Vec;

#[derive(Clone, Copy)]
struct Wall<S> {
    /// By the distance to the robot ([`Vec2::length_key`]).
    key: u64,
    ends_m: [Vec2<S>; 2],
}

/// Returns the sides of blocked cells that face passable ones, as walls relative to the robot at
/// `place_m` (in the world), nearest first; sides in one line are one wall. Of equally distant ones
/// the one that runs north is first, then the one farther west or south. Walls beyond `reach_m`,
/// and all but the `K` nearest, are omitted; unknown terrain beyond the window has none.
///
/// Choose a reach of at least the own radius plus the distance of one horizon at full speed, and a
/// window that contains it. A small `K` reduces foresight but not safety, if it holds the walls
/// that can be touched in one control step: eight for a body and a step smaller than a cell.
///
/// Empty if an input is not finite or the robot is off the grid. Bounded work: two reads of each
/// cell within reach (at most 255 cells each way), and one insertion into a list of `K` per wall.
#[must_use]
pub fn grid_walls<S: Scalar, const K: usize>(
    window: &Window<'_>,
    frame: &GridFrame<S>,
    place_m: Vec2<S>,
    reach_m: S,
) -> Vec<Obstacle<S>, K> {
    let walls = Walls::<S, K>::around(window, frame, place_m, reach_m);
    let walls = walls.map(|walls| walls.nearest).unwrap_or_default();
    list::collect(walls.iter().map(|wall| Obstacle::Wall(wall.ends_m)))
}

struct Walls<S, const K: usize> {
    /// South-west corner of the own cell relative to the robot, metres.
    corner_m: Vec2<S>,
    own: Cell,
    cell_m: S,
    reach_m: S,
    nearest: Vec<Wall<S>, K>,
}

impl<S: Scalar, const K: usize> Walls<S, K> {
    fn around(window: &Window<'_>, frame: &GridFrame<S>, place_m: Vec2<S>, reach_m: S) -> Option<Self> {
        let own = frame.cell(place_m)?;
        let half = frame.cell_m * S::HALF;
        let mut walls = Self {
            corner_m: frame.center(own) - Vec2::new(half, half) - place_m,
            own,
            cell_m: frame.cell_m,
            reach_m,
            nearest: Vec::new(),
        };
        let cells = reach_m.checked_div(frame.cell_m)?.floor_to_i32()?;
        let radius = u8::try_from(cells.saturating_add(1).clamp(0, 255)).ok()?;
        let (first, width, height) = window.cut(own, radius);
        let last = Cell::new(
            first.x.saturating_add_unsigned(width.saturating_sub(1)),
            first.y.saturating_add_unsigned(height.saturating_sub(1)),
        );
        if width == 0 || height == 0 {
            return Some(walls);
        }
        // West sides of cells from south to north, then south sides from west to east.
        let (cells, row) = (window.cells(), usize::from(window.width()));
        for x in first.x.saturating_add(1)..=last.x {
            let begin = window.index(Cell::new(x, first.y))?;
            walls.join((first.y, last.y), sides(cells, begin, row, 1), |y| Cell::new(x, y));
        }
        for y in first.y.saturating_add(1)..=last.y {
            let begin = window.index(Cell::new(first.x, y))?;
            walls.join((first.x, last.x), sides(cells, begin, 1, row), |x| Cell::new(x, y));
        }
        Some(walls)
    }

    /// Adds the walls along one line; `corner` is the corner before a side.
    fn join(&mut self, (first, last): (i16, i16), sides: impl Iterator<Item = bool>, corner: impl Fn(i16) -> Cell) {
        let mut begin = None;
        for (at, is_side) in (first..=last).zip(sides) {
            match (is_side, begin) {
                (true, None) => begin = Some(at),
                (false, Some(from)) => {
                    self.add(corner(from), corner(at));
                    begin = None;
                }
                _ => {}
            }
        }
        if let Some(from) = begin {
            self.add(corner(from), corner(last.saturating_add(1)));
        }
    }

    fn add(&mut self, from: Cell, to: Cell) {
        let ends_m = [from, to].map(|corner| {
            let steps = |to: i16, from: i16| S::from_i32(i32::from(to) - i32::from(from));
            let way = Vec2::new(steps(corner.x, self.own.x), steps(corner.y, self.own.y));
            self.corner_m + way * self.cell_m
        });
        let [a, b] = ends_m;
        let foot = Vec2::new(S::ZERO.clamp(a.x, b.x), S::ZERO.clamp(a.y, b.y));
        let is_near = foot.norm() <= self.reach_m;
        if !(foot.is_finite() && is_near) {
            return;
        }
        let key = foot.length_key();
        let place = self.nearest.partition_point(|wall| wall.key <= key);
        let mut wall = Wall { key, ends_m };
        for farther in self.nearest.iter_mut().skip(place) {
            core::mem::swap(farther, &mut wall);
        }
        let _ = self.nearest.push(wall);
    }
}

/// Whether each side separates a blocked from a passable cell: `back` places before the cell at
/// `begin` and each `step` after it.
fn sides(cells: &[u8], begin: usize, step: usize, back: usize) -> impl Iterator<Item = bool> {
    let is_blocked = |at: usize| cells.get(at).map(|&cell| cell == BLOCKED);
    let mut at = begin;
    core::iter::from_fn(move || {
        let is_side = is_blocked(at)? != is_blocked(at.wrapping_sub(back))?;
        at = at.wrapping_add(step);
        Some(is_side)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rand::Rng;
    use crate::scalar::Q16;
    use proptest::prelude::*;
    use std::vec::Vec as List;

    const FRAME: GridFrame<f64> = GridFrame { origin_m: Vec2::new(100.0, -50.0), cell_m: 2.0 };

    /// Rows of `#` and `.`, the northernmost first, with the south-west cell at (10, 20).
    fn cells(rows: &[&str]) -> List<u8> {
        let rows = rows.iter().rev();
        rows.flat_map(|row| row.bytes().map(|b| if b == b'#' { BLOCKED } else { 1 })).collect()
    }

    fn window<'a>(cells: &'a [u8], rows: &[&str]) -> Window<'a> {
        let (width, height) = (rows[0].len() as u16, rows.len() as u16);
        Window::new(cells, Cell::new(10, 20), width, height).unwrap()
    }

    fn seen<const K: usize>(rows: &[&str], at: (f64, f64), reach: f64) -> List<[f64; 4]> {
        let bytes = cells(rows);
        let corner = FRAME.origin_m + Vec2::new(10.0, 20.0) * FRAME.cell_m;
        let place = corner + Vec2::new(at.0, at.1) * FRAME.cell_m;
        let found = grid_walls::<_, K>(&window(&bytes, rows), &FRAME, place, reach * FRAME.cell_m);
        let in_cells = |obstacle: &Obstacle<f64>| match obstacle {
            Obstacle::Wall(ends) => {
                let [a, b] = ends.map(|end| (end + place - corner) * 0.5);
                [a.x, a.y, b.x, b.y].map(|c| libm::round(c * 1e6) / 1e6)
            }
            other => panic!("no wall: {other:?}"),
        };
        found.iter().map(in_cells).collect()
    }

    #[test]
    fn a_corner_is_two_walls_and_the_nearer_one_comes_first() {
        let rows = ["....", ".##.", ".##.", "...."];
        let west = [1.0, 1.0, 1.0, 3.0];
        let south = [1.0, 1.0, 3.0, 1.0];
        let (east, north) = ([3.0, 1.0, 3.0, 3.0], [1.0, 3.0, 3.0, 3.0]);
        assert_eq!(seen::<8>(&rows, (0.75, 1.5), 1.0), [west, south]);
        assert_eq!(seen::<8>(&rows, (1.5, 0.5), 1.0), [south, west]);
        assert_eq!(seen::<8>(&rows, (0.5, 0.5), 1.0), [west, south]);
        assert_eq!(seen::<8>(&rows, (0.75, 1.5), 9.0), [west, south, north, east]);
    }

    #[test]
    fn a_corridor_of_one_cell_is_two_long_walls() {
        let rows = ["######", "......", "######"];
        let walls = [[0.0, 1.0, 6.0, 1.0], [0.0, 2.0, 6.0, 2.0]];
        assert_eq!(seen::<8>(&rows, (2.5, 1.25), 9.0), walls);
        assert_eq!(seen::<8>(&rows, (2.5, 1.75), 9.0), [walls[1], walls[0]]);
        assert!(seen::<8>(&rows, (2.5, 1.25), 0.2).is_empty());
        assert_eq!(seen::<8>(&rows, (2.5, 1.25), 0.3), [walls[0]].map(|[_, y, _, w]| [1.0, y, 4.0, w]));
    }

    #[test]
    fn beyond_the_window_nothing_is_assumed() {
        assert!(seen::<8>(&["...", "...", "..."], (1.5, 1.5), 9.0).is_empty());
        assert!(seen::<8>(&["###", "###", "###"], (1.5, 1.5), 9.0).is_empty());
        assert!(seen::<8>(&[".#", "#."], (400.0, 1.0), 9.0).is_empty());
        assert!(seen::<8>(&[".#", "#."], (1e9, 1.0), 9.0).is_empty());
        let empty = Window::new(&[], Cell::new(10, 20), 0, 0).unwrap();
        let place = Vec2::new(121.0, -9.0);
        assert!(grid_walls::<f64, 4>(&empty, &FRAME, place, 5.0).is_empty());
    }

    #[test]
    fn at_full_capacity_the_farthest_are_omitted() {
        let rows = [".#.#.", "#.#.#", ".#.#.", "#.#.#", ".#.#."];
        let all = seen::<64>(&rows, (2.4, 2.45), 9.0);
        // Each line is one wall: blocked and passable cells change sides at a corner of the board.
        assert_eq!(all.len(), 8);
        assert_eq!(seen::<5>(&rows, (2.4, 2.45), 9.0), all[..5]);
        assert_eq!(seen::<8>(&rows, (2.4, 2.45), 9.0), all);
        assert_eq!(seen::<1>(&rows, (2.4, 2.45), 9.0), all[..1]);
        assert!(seen::<0>(&rows, (2.4, 2.45), 9.0).is_empty());
    }

    #[test]
    fn invalid_input_gives_no_walls() {
        let rows = [".#", "#."];
        let bytes = cells(&rows);
        let window = window(&bytes, &rows);
        let place = Vec2::new(121.0, -9.0);
        let walls = |frame: GridFrame<f64>, place, reach| grid_walls::<_, 4>(&window, &frame, place, reach).len();
        assert_eq!(walls(FRAME, place, 5.0), 2);
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(walls(FRAME, place, bad), 0, "{bad}");
        }
        assert_eq!(walls(FRAME, Vec2::new(f64::NAN, 0.0), 5.0), 0);
        let flat = GridFrame { cell_m: 0.0, ..FRAME };
        assert_eq!(walls(flat, place, 5.0), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn f32_and_q16_see_the_same_walls(x in 2.0_f64..10.0, y in 2.0_f64..10.0, seed: u64) {
            let mut rng = Rng::new(seed);
            let bytes: List<u8> = (0..144).map(|_| (rng.below(3) > 0).into()).collect();
            let window = Window::new(&bytes, Cell::new(0, 0), 12, 12).unwrap();
            fn walls<S: Scalar>(window: &Window<'_>, x: f64, y: f64) -> List<[f64; 4]> {
                let s = |value: f64| S::from_f64(value).unwrap();
                let frame = GridFrame { origin_m: Vec2::ZERO, cell_m: S::ONE };
                let found = grid_walls::<S, 128>(window, &frame, Vec2::new(s(x), s(y)), s(20.0));
                found
                    .iter()
                    .map(|obstacle| match obstacle {
                        Obstacle::Wall([a, b]) => [a.x, a.y, b.x, b.y].map(S::to_f64),
                        other => panic!("no wall: {other:?}"),
                    })
                    .collect()
            }
            let exact = walls::<f64>(&window, x, y);
            for others in [walls::<f32>(&window, x, y), walls::<Q16>(&window, x, y)] {
                prop_assert_eq!(exact.len(), others.len());
                for wall in &exact {
                    let is_same = |other: &[f64; 4]| {
                        wall.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-3)
                    };
                    prop_assert!(others.iter().any(is_same), "{wall:?}");
                }
            }
        }
    }
}
