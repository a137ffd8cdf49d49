//! One robot on the move, by nothing but the controller's router.

use crate::terrain::Terrain;
use staya_controller::agent::VISITS;
use staya_controller::cost::Gain;
use staya_controller::grid::{BLOCKED, Cell, Dir, Window};
use staya_controller::rand::Rng;
use staya_controller::route::{CostField, Replan, RouteParams, Router};
use staya_controller::shuffle::{Sharpness, weighted_shuffle};

/// Moves after which a robot is lost, per cell of the map's half circumference (width + height).
const PATIENCE: usize = 200;

/// How a walk ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Walk {
    /// Whether the robot reached its target.
    pub arrived: bool,
    /// Travel time by eqs. 6 and 7, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick: over all moves,
    /// length times impassability of the cell entered.
    pub cost: u64,
    /// Length of the way in [`UNIT`](staya_controller::grid::UNIT)ths of a cell.
    pub length: u64,
    /// Moves made.
    pub moves: usize,
}

/// Scratch memory for walks of robots with windows of up to `CELLS` cells, border included, that remember visits of
/// `M` cells and learn the costs of `L`; reusable.
#[derive(Debug)]
pub struct Walker<const CELLS: usize, const M: usize = VISITS, const L: usize = 0> {
    field: Box<CostField<CELLS>>,
    path: Vec<Cell>,
    /// The land with walls around it.
    walled: Vec<u8>,
}

impl<const CELLS: usize, const M: usize, const L: usize> Default for Walker<CELLS, M, L> {
    fn default() -> Self {
        Self { field: Box::new(CostField::new()), path: Vec::new(), walled: Vec::new() }
    }
}

/// From where to where, across what.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The land.
    pub land: &'a Terrain,
    /// Cells of robots that stand there all the time, in ascending order.
    pub parked: &'a [Cell],
    /// Start.
    pub from: Cell,
    /// Target.
    pub to: Cell,
}

impl<const CELLS: usize, const M: usize, const L: usize> Walker<CELLS, M, L> {
    /// Lets a robot walk.
    ///
    /// The router cuts the window to its radius around the robot itself, as on a robot whose sensors see farther. The robot
    /// takes the cheapest move whose cell no other robot has (KUZ algorithm 4, without the shuffle). A walk ends at the target, where no move is left, or after 200 moves per
    /// cell of width + height.
    pub fn walk(&mut self, task: &Task<'_>, params: &RouteParams, replan: Replan) -> Walk {
        self.walk_shuffled(task, params, replan, Sharpness::Greedy, &mut Rng::new(0))
    }

    /// The same with the shuffle (KUZ section 7): the order in which moves are tried is drawn by their weights.
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
            // Land and robots that do not change offer no move later either.
            let Some(dir) = dir else { return walk };
            here = here + dir.offset();
            self.path.push(here);
            let length = u64::from(dir.length(params.norm));
            walk.length += length;
            walk.cost += length * u64::from(land.get(here));
            walk.moves += 1;
        }
    }

    /// The cells of the last walk, start included.
    #[must_use]
    pub fn path(&self) -> &[Cell] {
        &self.path
    }

    /// What the router takes the travel time of the whole way to be, in [`UNIT`](staya_controller::grid::UNIT)ths of
    /// a tick: least weight of the moves out of `from`, with a0 = 1. Exact when `CELLS` and the greatest radius (255) hold
    /// the whole map; see [`holds`]. `None` without a way.
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

/// How far beyond the map windows show walls, as [`World::window`](crate::world::World::window) does: by the radius.
/// By nothing where the window of a robot anywhere holds the whole map, or would be too large for the search.
fn margin(cells: usize, land: &Terrain, radius: u8) -> u16 {
    let side = 2 * usize::from(radius) + 3;
    let is_larger = u16::from(radius) + 1 >= land.width().max(land.height());
    if is_larger || side * side > cells {
        return 0;
    }
    u16::from(radius)
}

/// Writes the land with `margin` cells of wall on each side.
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

/// Whether a search in `cells` cells, border included, sees all of the land from anywhere on it.
#[must_use]
pub fn holds(cells: usize, land: &Terrain) -> bool {
    let (width, height) = (usize::from(land.width()), usize::from(land.height()));
    width.max(height) <= usize::from(u8::MAX) + 1 && (width + 2) * (height + 2) <= cells
}
