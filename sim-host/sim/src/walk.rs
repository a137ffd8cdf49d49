//! Simulation of a single robot with the controller's router.

use crate::terrain::Terrain;
use staya_controller::agent::VISITS;
use staya_controller::cost::Gain;
use staya_controller::grid::{BLOCKED, Cell, Dir, Window};
use staya_controller::rand::Rng;
use staya_controller::route::{CostField, Replan, RouteParams, Router};
use staya_controller::shuffle::{Sharpness, weighted_shuffle};

/// Moves after which a walk is aborted, per cell of width + height.
const PATIENCE: usize = 200;

/// Result of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Walk {
    /// Whether the robot reached its target.
    pub arrived: bool,
    /// Travel time by eqs. 6 and 7, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick: the sum
    /// over all moves of length times impassability of the entered cell.
    pub cost: u64,
    /// Length of the path in [`UNIT`](staya_controller::grid::UNIT)ths of a cell.
    pub length: u64,
    /// Number of moves.
    pub moves: usize,
}

/// Reusable memory for walks with windows of up to `CELLS` cells (border included). The router
/// stores visits of `M` cells and learned costs of `L` cells.
#[derive(Debug)]
pub struct Walker<const CELLS: usize, const M: usize = VISITS, const L: usize = 0> {
    field: Box<CostField<CELLS>>,
    path: Vec<Cell>,
    walled: Vec<u8>,
}

impl<const CELLS: usize, const M: usize, const L: usize> Default for Walker<CELLS, M, L> {
    fn default() -> Self {
        Self { field: Box::new(CostField::new()), path: Vec::new(), walled: Vec::new() }
    }
}

/// Inputs of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The terrain.
    pub land: &'a Terrain,
    /// Cells of stationary robots, in ascending order.
    pub parked: &'a [Cell],
    /// Start cell.
    pub from: Cell,
    /// Target cell.
    pub to: Cell,
}

impl<const CELLS: usize, const M: usize, const L: usize> Walker<CELLS, M, L> {
    /// Simulates a walk. The robot takes the cheapest move whose cell is free (KUZ algorithm 4,
    /// without the shuffle), and the router plans on a window of its radius. A walk ends at the
    /// target, when no move is left, or after 200 moves per cell of width + height.
    pub fn walk(&mut self, task: &Task<'_>, params: &RouteParams, replan: Replan) -> Walk {
        self.walk_shuffled(task, params, replan, Sharpness::Greedy, &mut Rng::new(0))
    }

    /// Simulates a walk with the shuffle (KUZ section 7): the order of moves is drawn by weight.
    pub fn walk_shuffled(
        &mut self,
        task: &Task<'_>,
        params: &RouteParams,
        replan: Replan,
        sharpness: Sharpness,
        rng: &mut Rng,
    ) -> Walk {
        let mut router = Router::<M, L>::new();
        let mut walk = Walk::default();
        let (land, to) = (task.land, task.to);
        let mut here = task.from;
        self.path.clear();
        self.path.push(here);
        let limit = PATIENCE * (usize::from(land.width()) + usize::from(land.height()));
        let margin = margin(CELLS, land, params.radius);
        let [width, height] = [land.width(), land.height()].map(|side| side + 2 * margin);
        wall(&mut self.walled, land, margin);
        let edge = margin.cast_signed();
        let south_west = Cell::default() - Cell::new(edge, edge);
        let Some(window) = Window::new(&self.walled, south_west, width, height) else {
            return walk;
        };
        loop {
            router.observe(params, here, to);
            if here == to || walk.moves == limit {
                walk.arrived = here == to;
                return walk;
            }
            let others = task.parked.iter().copied();
            let is_free = |dir: &Dir| task.parked.binary_search(&(here + dir.offset())).is_err();
            let field = &mut self.field;
            let planned = match replan {
                Replan::EachCell => None,
                Replan::UntilChanged => {
                    router.follow(params, field, &window, here, to, others.clone()).ok().filter(is_free)
                }
            };
            let dir = planned.or_else(|| {
                let weights = router.weights(params, field, &window, here, to, others);
                weighted_shuffle(&weights.ok()?, sharpness, rng).into_iter().find(is_free)
            });
            // Terrain and robots are static, so waiting does not help.
            let Some(dir) = dir else { return walk };
            here = here + dir.offset();
            self.path.push(here);
            let length = u64::from(dir.length(params.norm));
            walk.length += length;
            walk.cost += length * u64::from(land.get(here));
            walk.moves += 1;
        }
    }

    /// Cells of the last walk, start included.
    #[must_use]
    pub fn path(&self) -> &[Cell] {
        &self.path
    }

    /// Travel time of the whole path as the router estimates it,
    /// [`UNIT`](staya_controller::grid::UNIT)ths of a tick: the least weight of the moves out of
    /// `from`, with a0 = 1. `None` without a path. Exact if `CELLS` and radius 255 cover the map
    /// ([`holds`]).
    pub fn price(&mut self, land: &Terrain, params: &RouteParams, from: Cell, to: Cell) -> Option<f64> {
        if from == to {
            return Some(0.0);
        }
        let params = RouteParams { radius: u8::MAX, a0: Gain::ONE, ..*params };
        let window = Window::new(land.cells(), Cell::default(), land.width(), land.height())?;
        let mut router = Router::<0>::new();
        let weights = router.weights(&params, &mut self.field, &window, from, to, []).ok()?;
        let least = weights.best().map(|dir| weights.get(dir))?;
        Some(f64::from(least) / f64::from(Gain::ONE.sixteenths()))
    }
}

/// Wall border around the map; 0 if a window covers the map or would be too large for the search.
fn margin(cells: usize, land: &Terrain, radius: u8) -> u16 {
    let side = 2 * usize::from(radius) + 3;
    let is_larger = u16::from(radius) + 1 >= land.width().max(land.height());
    if is_larger || side * side > cells {
        return 0;
    }
    u16::from(radius)
}

fn wall(walled: &mut Vec<u8>, land: &Terrain, margin: u16) {
    let margin = usize::from(margin);
    let row = usize::from(land.width()) + 2 * margin;
    walled.clear();
    walled.resize(row * margin, BLOCKED);
    for cells in land.cells().chunks_exact(usize::from(land.width())) {
        walled.resize(walled.len() + margin, BLOCKED);
        walled.extend_from_slice(cells);
        walled.resize(walled.len() + margin, BLOCKED);
    }
    walled.resize(walled.len() + row * margin, BLOCKED);
}

/// Whether a search in `cells` cells, border included, covers the whole terrain from any position.
#[must_use]
pub fn holds(cells: usize, land: &Terrain) -> bool {
    let (width, height) = (usize::from(land.width()), usize::from(land.height()));
    width.max(height) <= usize::from(u8::MAX) + 1 && (width + 2) * (height + 2) <= cells
}
