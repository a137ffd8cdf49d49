//! Globally optimal routes on the whole map.
//!
//! Dijkstra's algorithm with buckets as wide as the cheapest move (E. V. Denardo and B. L. Fox,
//! "Shortest-route methods: 1. Reaching, pruning, and buckets", Operations Research 27, 1979). A
//! cell cannot improve another one in its own bucket, so the result is exact for any order within a
//! bucket.

use super::Terrain;
use staya_controller::grid::{BLOCKED, Cell, DIAGONAL, Dir, Norm, UNIT};

/// More buckets than the most expensive move spans (a diagonal into class 255).
const RING: usize = 512;
const _: () = assert!(RING > (DIAGONAL * 255 / UNIT) as usize + 1);

const UNKNOWN: u64 = u64::MAX;

/// A route from cell to cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Route {
    /// Travel time, [`UNIT`]ths of a tick: sum of length times impassability of the entered cell.
    pub cost: u64,
    /// Cells from start to goal, both included.
    pub cells: Vec<Cell>,
}

impl Route {
    /// Length of the route, [`UNIT`]ths of a cell.
    #[must_use]
    pub fn length(&self, norm: Norm) -> u64 {
        length(&self.cells, norm)
    }
}

/// Length of a chain of adjacent cells, [`UNIT`]ths of a cell; repeated cells add nothing.
#[must_use]
pub fn length(cells: &[Cell], norm: Norm) -> u64 {
    let moves = cells.windows(2).filter(|pair| pair[0] != pair[1]);
    moves.filter_map(|pair| Dir::between(pair[0], pair[1])).map(|dir| u64::from(dir.length(norm))).sum()
}

/// Finds the cheapest route; for many routes, use a [`Planner`].
#[must_use]
pub fn route(terrain: &Terrain, from: Cell, to: Cell, norm: Norm, corner_cutting: bool) -> Option<Route> {
    Planner::default().route(terrain, from, to, norm, corner_cutting)
}

/// Reusable memory for searches: 9 bytes per cell of the largest map, plus the buckets.
#[derive(Debug, Default)]
pub struct Planner {
    /// With a blocked border around the map.
    land: Vec<u8>,
    cost: Vec<u64>,
    buckets: Vec<Vec<(u64, u32)>>,
    stride: usize,
}

impl Planner {
    /// Finds the cheapest route, identical on every machine; `None` if there is none, or if an end
    /// is blocked or off the map. Without `corner_cutting`, a diagonal move needs both orthogonal
    /// neighbours passable. O(size).
    pub fn route(
        &mut self,
        terrain: &Terrain,
        from: Cell,
        to: Cell,
        norm: Norm,
        corner_cutting: bool,
    ) -> Option<Route> {
        if !terrain.is_passable(from) || !terrain.is_passable(to) {
            return None;
        }
        self.load(terrain);
        let (start, goal) = (self.index(from), self.index(to));
        let moves = self.moves(norm);
        self.cost[start] = 0;
        self.buckets[0].push((0, start as u32));
        self.spread(Some(goal), false, &moves, corner_cutting);
        let cost = self.cost[goal];
        if cost == UNKNOWN {
            return None;
        }

        let mut cells = vec![to];
        let (mut here, mut cell) = (goal, to);
        while here != start {
            let price = u64::from(self.land[here]);
            // Searches backwards for the move that led here; the corner rule is symmetric.
            let back = moves.iter().find(|step| {
                let before = here.wrapping_add_signed(-step.offset);
                self.cost[before] != UNKNOWN
                    && self.cost[before] + step.length * price == self.cost[here]
                    && (corner_cutting || self.is_open(before, step))
            })?;
            here = here.wrapping_add_signed(-back.offset);
            cell = cell - back.dir.offset();
            cells.push(cell);
        }
        cells.reverse();
        Some(Route { cost, cells })
    }

    /// The cost of the cheapest route to `to` from each cell, row by row from the south;
    /// [`u64::MAX`] where there is none. O(size).
    pub fn costs_to(&mut self, terrain: &Terrain, to: Cell, norm: Norm, corner_cutting: bool) -> Vec<u64> {
        self.load(terrain);
        if terrain.is_passable(to) {
            let start = self.index(to);
            self.cost[start] = 0;
            self.buckets[0].push((0, start as u32));
            let moves = self.moves(norm);
            self.spread(None, true, &moves, corner_cutting);
        }
        let inner = self.cost.chunks_exact(self.stride).skip(1).take(usize::from(terrain.height()));
        inner.flat_map(|row| &row[1..self.stride - 1]).copied().collect()
    }

    fn load(&mut self, terrain: &Terrain) {
        let (width, height) = (usize::from(terrain.width()), usize::from(terrain.height()));
        self.stride = width + 2;
        let size = self.stride * (height + 2);
        self.land.clear();
        self.land.resize(size, BLOCKED);
        for (row, source) in terrain.cells().chunks_exact(width).enumerate() {
            let start = (row + 1) * self.stride + 1;
            self.land[start..start + width].copy_from_slice(source);
        }
        self.cost.clear();
        self.cost.resize(size, UNKNOWN);
        self.buckets.resize_with(RING, Vec::new);
        for bucket in &mut self.buckets {
            bucket.clear();
        }
    }

    fn index(&self, cell: Cell) -> usize {
        (cell.y as usize + 1) * self.stride + cell.x as usize + 1
    }

    fn moves(&self, norm: Norm) -> [Step; 8] {
        let stride = self.stride as isize;
        Dir::MOVES.map(|dir| {
            let Cell { x, y } = dir.offset();
            Step {
                dir,
                offset: isize::from(y) * stride + isize::from(x),
                beside: dir.is_diagonal().then(|| [isize::from(x), isize::from(y) * stride]),
                length: u64::from(dir.length(norm)),
            }
        })
    }

    fn is_open(&self, at: usize, step: &Step) -> bool {
        step.beside
            .is_none_or(|beside| beside.iter().all(|offset| self.land[at.wrapping_add_signed(*offset)] != BLOCKED))
    }

    /// Finds costs from the cells in the first bucket until that of `goal` is known, or all;
    /// `is_back`: costs of the ways there.
    fn spread(&mut self, goal: Option<usize>, is_back: bool, moves: &[Step; 8], corner_cutting: bool) {
        let mut waiting = 1_usize;
        let mut number = 0_u64;
        let mut bucket = Vec::new();
        while waiting > 0 && goal.is_none_or(|goal| self.cost[goal] >= number * u64::from(UNIT)) {
            std::mem::swap(&mut bucket, &mut self.buckets[number as usize % RING]);
            waiting -= bucket.len();
            for (cost, at) in bucket.drain(..) {
                let at = at as usize;
                if self.cost[at] != cost {
                    continue;
                }
                for step in moves {
                    let next = at.wrapping_add_signed(step.offset);
                    let u = self.land[next];
                    let entered = if is_back { self.land[at] } else { u };
                    let reached = cost + step.length * u64::from(entered);
                    let is_better = u != BLOCKED && reached < self.cost[next];
                    if is_better && (corner_cutting || self.is_open(at, step)) {
                        self.cost[next] = reached;
                        let slot = (reached / u64::from(UNIT)) as usize % RING;
                        self.buckets[slot].push((reached, next as u32));
                        waiting += 1;
                    }
                }
            }
            number += 1;
        }
    }
}

struct Step {
    dir: Dir,
    offset: isize,
    beside: Option<[isize; 2]>,
    length: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_definition(land: &Terrain, from: Cell, norm: Norm, corner_cutting: bool) -> Vec<u64> {
        let cells = || (0..land.height() as i16).flat_map(|y| (0..land.width() as i16).map(move |x| Cell::new(x, y)));
        let mut costs = vec![UNKNOWN; land.cells().len()];
        if land.is_passable(from) {
            costs[land.index(from).unwrap()] = 0;
        }
        loop {
            let before = costs.clone();
            for cell in cells() {
                for dir in Dir::MOVES {
                    let next = cell + dir.offset();
                    let known = costs[land.index(cell).unwrap()];
                    let Cell { x, y } = dir.offset();
                    let corners = [Cell::new(x, 0), Cell::new(0, y)];
                    let open = corner_cutting || corners.iter().all(|c| land.is_passable(cell + *c));
                    if known != UNKNOWN && land.is_passable(next) && open {
                        let cost = known + u64::from(dir.length(norm)) * u64::from(land.get(next));
                        let slot = &mut costs[land.index(next).unwrap()];
                        *slot = cost.min(*slot);
                    }
                }
            }
            if costs == before {
                return costs;
            }
        }
    }

    fn cell() -> impl Strategy<Value = Cell> {
        (0..9_i16, 0..9_i16).prop_map(|(x, y)| Cell::new(x, y))
    }

    proptest! {
        #[test]
        fn routes_are_walkable_and_optimal(
            cells in prop::collection::vec(prop_oneof![2 => Just(BLOCKED), 4 => 1..=4_u8, 1 => Just(255)], 81),
            from in cell(),
            to in cell(),
            norm in prop_oneof![Just(Norm::Euclidean), Just(Norm::Chebyshev)],
            corner_cutting: bool,
        ) {
            let land = Terrain::from_cells(9, 9, cells).unwrap();
            let costs = by_definition(&land, from, norm, corner_cutting);
            let found = route(&land, from, to, norm, corner_cutting);
            let expected = costs[land.index(to).unwrap()];
            prop_assert_eq!(found.as_ref().map_or(UNKNOWN, |route| route.cost), expected);
            let Some(found) = found else { return Ok(()) };
            prop_assert_eq!((found.cells[0], *found.cells.last().unwrap()), (from, to));
            let mut cost = 0;
            for pair in found.cells.windows(2) {
                let dir = Dir::between(pair[0], pair[1]).unwrap();
                prop_assert!(dir != Dir::Stay && land.is_passable(pair[1]));
                cost += u64::from(dir.length(norm)) * u64::from(land.get(pair[1]));
            }
            prop_assert_eq!(cost, expected);
        }
    }

    #[test]
    fn costs_to_a_cell_are_those_of_the_routes_from_all_others() {
        let mut land = Terrain::from_cells(4, 3, vec![1, 2, 9, 1, 3, 1, 1, 7, 1, 4, 2, 5]).unwrap();
        land.set(Cell::new(2, 0), BLOCKED);
        let goal = Cell::new(3, 0);
        for (norm, corner_cutting) in [(Norm::Euclidean, true), (Norm::Chebyshev, false)] {
            let costs = Planner::default().costs_to(&land, goal, norm, corner_cutting);
            for (at, cost) in (0..12).zip(costs) {
                let found = route(&land, Cell::new(at % 4, at / 4), goal, norm, corner_cutting);
                assert_eq!(cost, found.map_or(u64::MAX, |route| route.cost), "{at}");
            }
        }
        let none = Planner::default().costs_to(&land, Cell::new(2, 0), Norm::Euclidean, true);
        assert_eq!(none, [u64::MAX; 12]);
    }

    #[test]
    fn planner_keeps_nothing_of_the_previous_map() {
        let mut planner = Planner::default();
        let big = Terrain::flat(30, 20);
        let mut small = Terrain::flat(3, 3);
        let (a, b) = (Cell::new(0, 0), Cell::new(2, 2));
        assert_eq!(planner.route(&big, a, Cell::new(29, 0), Norm::Euclidean, false).unwrap().cost, 29 * 70);
        assert_eq!(planner.route(&small, a, b, Norm::Euclidean, false).unwrap().cost, 2 * 99);
        small.set(Cell::new(1, 0), BLOCKED);
        small.set(Cell::new(1, 1), BLOCKED);
        small.set(Cell::new(1, 2), BLOCKED);
        assert_eq!(planner.route(&small, a, b, Norm::Euclidean, true), None);
        assert_eq!(planner.route(&big, a, b, Norm::Chebyshev, false).unwrap().cost, 2 * 70);
    }

    #[test]
    fn no_route_from_blocked_or_outside_ends_and_an_empty_one_between_equal_ends() {
        let mut land = Terrain::flat(3, 1);
        let at = |x| Cell::new(x, 0);
        assert_eq!(route(&land, at(0), at(3), Norm::Euclidean, false), None);
        assert_eq!(route(&land, at(-1), at(1), Norm::Euclidean, false), None);
        let stay = route(&land, at(1), at(1), Norm::Euclidean, false).unwrap();
        assert_eq!((stay.cost, stay.cells.len(), stay.length(Norm::Euclidean)), (0, 1, 0));
        land.set(at(2), BLOCKED);
        assert_eq!(route(&land, at(0), at(2), Norm::Euclidean, false), None);
    }

    #[test]
    fn cost_sums_entered_cells_and_length_sums_moves() {
        let land = Terrain::from_cells(3, 1, vec![9, 2, 255]).unwrap();
        let found = route(&land, Cell::new(0, 0), Cell::new(2, 0), Norm::Euclidean, false).unwrap();
        assert_eq!(found.cost, 70 * 257);
        assert_eq!(found.length(Norm::Euclidean), 140);
        let diagonal = [Cell::new(0, 0), Cell::new(1, 1), Cell::new(1, 1), Cell::new(1, 0)];
        assert_eq!(length(&diagonal, Norm::Euclidean), 99 + 70);
        assert_eq!(length(&diagonal, Norm::Chebyshev), 140);
    }
}
