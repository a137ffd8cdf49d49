//! Tables of costs to go, which robots carry in flash ([`CostToGo`]): made from a known map.
//!
//! Travel times to the goal are found by [`Planner::costs_to`] and fitted by least squares: the
//! blend of four nodes is to be near the time in each cell that has a way to the goal.

use super::Terrain;
use super::optimal::Planner;
use staya_controller::formation::{Footprint, blended};
use staya_controller::grid::{Cell, Norm, Window};
use staya_controller::land::CostToGo;
use staya_controller::land::cost_to_go::{HEADER_LEN, Header, MOST};
use staya_controller::template::TemplateEntry;
use std::sync::Arc;
use thiserror::Error;

/// Rounds of the fit; more change the last digits of the loss.
const ROUNDS: usize = 30;
/// Least length of a table, bytes: two nodes along each side.
pub const LEAST_BYTES: usize = HEADER_LEN + 6;
/// Greatest length of a table that is worth its flash; a choice.
pub const MOST_BYTES: usize = 1 << 16;

/// Why a table cannot be made.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum KnownError {
    /// The goal is blocked or off the map.
    #[error("the goal {0:?} is blocked or off the map; give a free cell")]
    Goal([i16; 2]),
    /// Too few bytes.
    #[error("{0} bytes hold no table; give {LEAST_BYTES} or more")]
    Bytes(usize),
    /// The map is a line of cells.
    #[error("the map has one cell along a side; a table needs two or more")]
    Narrow,
}

/// Makes the table of the way to `goal` on `land`, of at most `bytes` bytes. Deterministic, and
/// identical on every machine. O(cells).
///
/// # Errors
/// [`KnownError`].
pub fn cost_to_go(
    land: &Terrain,
    goal: Cell,
    (norm, corner_cutting): (Norm, bool),
    bytes: usize,
) -> Result<CostToGo<Arc<[u8]>>, KnownError> {
    let cells = [land.width(), land.height()];
    if !land.is_passable(goal) {
        return Err(KnownError::Goal([goal.x, goal.y]));
    }
    if cells.iter().any(|&side| side < 2) {
        return Err(KnownError::Narrow);
    }
    let nodes = nodes(cells, bytes).ok_or(KnownError::Bytes(bytes))?;
    let times = Planner::default().costs_to(land, goal, norm, corner_cutting);
    let fitted = Fit::new(cells, nodes, &times).solved();
    let highest = fitted.iter().copied().fold(1.0, f64::max);
    let unit = (highest * 256.0 / f64::from(MOST)).ceil().max(1.0) as u32;
    let header = Header { nodes, cells, origin: Cell::new(0, 0), goal, unit };
    let mut table = vec![0; header.length()];
    let count = |column: u8, row: u8| {
        let at = usize::from(row) * usize::from(nodes[0]) + usize::from(column);
        (fitted[at].max(0.0) * 256.0 / f64::from(unit)).round() as u16
    };
    let written = header.write(&mut table, count);
    assert_eq!(written, Some(table.len()), "all fields are in range");
    Ok(CostToGo::from_bytes(Arc::from(table)).expect("just written"))
}

/// The land as the leader of a formation prices it, with the others at `entries`. O(cells x
/// entries).
#[must_use]
pub fn under(land: &Terrain, entries: &[TemplateEntry], footprint: Footprint) -> Terrain {
    const RADIUS: u8 = 127;
    let side = 2 * usize::from(RADIUS) + 1;
    let (width, height) = (land.width(), land.height());
    let whole = Window::new(land.cells(), Cell::new(0, 0), width, height);
    let mut priced = land.clone();
    let mut block = vec![0; side * side];
    let middles = |cells: u16| (i16::from(RADIUS)..).step_by(side).take(usize::from(cells).div_ceil(side));
    for middle in middles(height).flat_map(|y| middles(width).map(move |x| Cell::new(x, y))) {
        let around = (middle, RADIUS);
        let blend = whole.as_ref().and_then(|whole| blended(whole, around, entries, footprint, &mut block));
        let Some(blend) = blend else { continue };
        let corner = middle - Cell::new(RADIUS.into(), RADIUS.into());
        for cell in (0..side as i16).flat_map(|y| (0..side as i16).map(move |x| corner + Cell::new(x, y))) {
            if let Some(class) = blend.get(cell) {
                priced.set(cell, class);
            }
        }
    }
    priced
}

/// The most nodes of that many bytes, about square, and at most one for each cell; `None` if two
/// along each side do not fit.
#[must_use]
pub fn nodes([width, height]: [u16; 2], bytes: usize) -> Option<[u8; 2]> {
    let most = bytes.checked_sub(HEADER_LEN)? * 2 / 3;
    let widest = width.min(255);
    let fitting = (2..=widest).filter_map(|columns| {
        let rows = (most / usize::from(columns)).min(height.min(255).into()) as u16;
        (rows >= 2).then_some([columns, rows])
    });
    // The larger step between nodes decides, then the other one.
    let steps = |&[columns, rows]: &[u16; 2]| {
        let step = |cells: u16, nodes: u16| f64::from(cells - 1) / f64::from(nodes - 1);
        let [x, y] = [step(width, columns), step(height, rows)];
        (x.max(y), x.min(y))
    };
    let best = fitting.min_by(|a, b| steps(a).partial_cmp(&steps(b)).expect("finite"));
    best.map(|nodes| nodes.map(|count| count as u8))
}

/// Nodes whose blend is nearest to the times of cells.
struct Fit {
    columns: usize,
    /// Per cell that has a way: its first node, the weights of the four nodes, and its time.
    cells: Vec<(usize, [f64; 4], f64)>,
    nodes: Vec<f64>,
}

impl Fit {
    fn new([width, height]: [u16; 2], nodes: [u8; 2], times: &[u64]) -> Self {
        let [columns, rows] = nodes.map(usize::from);
        let place = |at: usize, cells: u16, nodes: usize| {
            let along = at as f64 * (nodes - 1) as f64 / f64::from(cells - 1);
            let node = (along as usize).min(nodes - 2);
            (node, along - node as f64)
        };
        let mut cells = Vec::new();
        let (mut nearest, mut start) = (vec![f64::MAX; columns * rows], vec![None; columns * rows]);
        for (at, &time) in times.iter().enumerate().filter(|&(_, &time)| time != u64::MAX) {
            let (x, east) = place(at % usize::from(width), width, columns);
            let (y, north) = place(at / usize::from(width), height, rows);
            let weights = [(1.0 - east) * (1.0 - north), east * (1.0 - north), (1.0 - east) * north, east * north];
            cells.push((y * columns + x, weights, time as f64));
            // Each node begins with the time of the nearest cell.
            for [dx, dy] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let node = (y + dy) * columns + x + dx;
                let away = libm::hypot(east - dx as f64, north - dy as f64);
                if away < nearest[node] {
                    (nearest[node], start[node]) = (away, Some(time as f64));
                }
            }
        }
        Self { columns, cells, nodes: filled(start, columns) }
    }

    /// Jacobi's iteration on the normal equations, damped by the sums of weights.
    fn solved(mut self) -> Vec<f64> {
        let offsets = [0, 1, self.columns, self.columns + 1];
        for _ in 0..ROUNDS {
            let mut change = vec![(0.0, 0.0); self.nodes.len()];
            for &(first, weights, time) in &self.cells {
                let nodes = offsets.map(|offset| first + offset);
                let blend: f64 = nodes.iter().zip(weights).map(|(&node, weight)| weight * self.nodes[node]).sum();
                for (&node, weight) in nodes.iter().zip(weights) {
                    let (error, sum) = &mut change[node];
                    *error += weight * (time - blend);
                    *sum += weight;
                }
            }
            for (node, (error, sum)) in self.nodes.iter_mut().zip(change) {
                if sum > 0.0 {
                    *node += error / sum;
                }
            }
        }
        self.nodes
    }
}

/// Nodes without a cell beside them get the mean of known neighbours, ring after ring.
fn filled(mut nodes: Vec<Option<f64>>, columns: usize) -> Vec<f64> {
    while nodes.iter().any(Option::is_none) && nodes.iter().any(Option::is_some) {
        let before = nodes.clone();
        let rows = nodes.len() / columns;
        let known = |x: usize, y: usize| (x < columns && y < rows).then(|| before[y * columns + x]).flatten();
        for (at, node) in nodes.iter_mut().enumerate().filter(|(_, node)| node.is_none()) {
            let (x, y) = (at % columns, at / columns);
            let beside = [known(x + 1, y), known(x.wrapping_sub(1), y), known(x, y + 1), known(x, y.wrapping_sub(1))];
            let (sum, count) =
                beside.into_iter().flatten().fold((0.0, 0.0), |(sum, count), time| (sum + time, count + 1.0));
            *node = (count > 0.0).then(|| sum / count);
        }
    }
    nodes.into_iter().map(|node| node.unwrap_or(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::generate::{LandPlan, natural};
    use staya_controller::grid::{BLOCKED, UNIT};

    const MOVES: (Norm, bool) = (Norm::Euclidean, true);

    fn land(side: u16) -> Terrain {
        natural(&LandPlan { width: side, height: side, classes: 9, seed: 3 }, 40, Norm::Euclidean).expect("fits")
    }

    fn ticks(table: &CostToGo<Arc<[u8]>>, cell: Cell) -> f64 {
        table.at(cell) as f64 / f64::from(256 * UNIT)
    }

    #[test]
    fn nodes_are_about_square_and_use_the_bytes() {
        assert_eq!(nodes([100, 100], 4096), Some([52, 52]));
        assert_eq!(nodes([100, 100], 65536), Some([100, 100]), "a node for each cell is enough");
        assert_eq!(nodes([400, 100], 4096), Some([104, 26]));
        assert_eq!(nodes([2, 3000], 4096), Some([2, 255]));
        assert_eq!(nodes([9, 9], LEAST_BYTES), Some([2, 2]));
        assert_eq!(nodes([9, 9], LEAST_BYTES - 1), None);
        assert_eq!(nodes([9, 9], 3), None);
    }

    #[test]
    fn a_table_is_near_the_times_that_it_was_made_from() {
        let (land, goal) = (land(60), Cell::new(50, 50));
        let times = Planner::default().costs_to(&land, goal, MOVES.0, MOVES.1);
        let errors = |bytes: usize| {
            let table = cost_to_go(&land, goal, MOVES, bytes).expect("a way");
            assert!(table.header().length() <= bytes && table.header().goal == goal);
            let error = |at: usize| {
                let cell = Cell::new((at % 60) as i16, (at / 60) as i16);
                (ticks(&table, cell) - times[at] as f64 / f64::from(UNIT)).abs()
            };
            (0..3600).map(error).sum::<f64>() / 3600.0
        };
        let (fine, coarse, rough) = (errors(8192), errors(1024), errors(100));
        assert!(fine < 0.2 && fine < coarse && coarse < 1.5 && coarse < rough, "{fine} {coarse} {rough}");
    }

    #[test]
    fn cells_without_a_way_do_not_count() {
        let mut land = Terrain::flat(40, 40);
        // A closed room, and a wall with a door at its northern end.
        for at in 0..10 {
            for cell in [Cell::new(at, 10), Cell::new(10, at), Cell::new(20, at + 9), Cell::new(20, at + 19)] {
                land.set(cell, BLOCKED);
            }
        }
        let goal = Cell::new(35, 20);
        let table = cost_to_go(&land, goal, MOVES, 4096).expect("a way");
        let times = Planner::default().costs_to(&land, goal, MOVES.0, MOVES.1);
        for (at, &time) in times.iter().enumerate().filter(|(_, time)| **time != u64::MAX) {
            let cell = Cell::new((at % 40) as i16, (at / 40) as i16);
            assert!((ticks(&table, cell) - time as f64 / f64::from(UNIT)).abs() < 0.1, "{cell:?}");
        }
    }

    #[test]
    fn what_has_no_way_is_refused() {
        let mut land = land(9);
        land.set(Cell::new(4, 4), BLOCKED);
        let made = |land: &Terrain, goal, bytes| cost_to_go(land, goal, MOVES, bytes).map(|_| ());
        assert_eq!(made(&land, Cell::new(4, 4), 4096), Err(KnownError::Goal([4, 4])));
        assert_eq!(made(&land, Cell::new(9, 0), 4096), Err(KnownError::Goal([9, 0])));
        assert_eq!(made(&land, Cell::new(0, 0), 31), Err(KnownError::Bytes(31)));
        assert_eq!(made(&Terrain::flat(1, 5), Cell::new(0, 0), 4096), Err(KnownError::Narrow));
        assert_eq!(made(&land, Cell::new(0, 0), LEAST_BYTES), Ok(()));
    }

    #[test]
    fn land_under_a_formation_is_that_of_its_leader() {
        let land = land(300);
        let entry =
            |x, y, id| TemplateEntry { offset: Cell::new(x, y), id: staya_controller::robot::RobotId(id), hops: 1 };
        let entries = [entry(-3, 0, 2), entry(0, -3, 3)];
        for footprint in [Footprint::Dearest, Footprint::Mean(12)] {
            let priced = under(&land, &entries, footprint);
            let mut buffer = vec![0; 25 * 25];
            for middle in [Cell::new(50, 60), Cell::new(254, 254), Cell::new(290, 128), Cell::new(2, 299)] {
                let whole = Window::new(land.cells(), Cell::new(0, 0), 300, 300).expect("fits");
                let around = blended(&whole, (middle, 12), &entries, footprint, &mut buffer).expect("fits");
                for cell in (-12..13).flat_map(|y| (-12..13).map(move |x| middle + Cell::new(x, y))) {
                    if let Some(class) = around.get(cell) {
                        assert_eq!(priced.get(cell), class, "{cell:?}");
                    }
                }
            }
        }
        assert_eq!(under(&land, &[], Footprint::Dearest), land);
    }
}
