//! The reverse search: cost to the exit from every cell of the window.
//!
//! A move's cost depends only on the cell that it enters, so settling a cell offers its eight
//! predecessors one of two costs. A bucket of the ring (`queue`) is at most as wide as the cheapest
//! move, so a cell leaves the queue only once (Denardo and Fox 1979). All arrays have a blocked
//! border of one cell, so that neighbours are index offsets.

use super::{ExitRule, RouteParams, VisitMemory, ray_exit};
use crate::cost::{Cost, EXCLUDED, Weights};
use crate::grid::{BLOCKED, Cell, DIAGONAL, Dir, Norm, UNIT, Window};

mod beyond;
mod learning;
mod queue;

pub(super) use beyond::Beyond;
use queue::{MOST_CELLS, Queue, RING};

/// The robot's surroundings are closed: no exit can be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unreachable;

/// Scratch memory of one search, without state between calls: many robots can share one.
///
/// 14 bytes per cell. `CELLS` is at least (w + 2) * (h + 2) for the largest window used: 169 for
/// r = 5. A larger window is cut to the rows that fit.
#[derive(Clone, Debug)]
pub struct CostField<const CELLS: usize> {
    origin: Cell,
    width: u16,
    height: u16,
    stride: usize,
    impassability: [u8; CELLS],
    /// Additional costs of entering a cell; in a search that learns, a lower bound of its cost.
    extra: [Cost; CELLS],
    /// Cost to the exit; 0 in cells that routes must not use, so that no cost is lower.
    cost: [Cost; CELLS],
    queue: Queue<CELLS>,
    /// log2 of a bucket's width.
    shift: u32,
    easiest: u8,
    has_walls: bool,
    learns: bool,
    closed: usize,
    /// The next bucket, in an endless numbering of the ring: costs below it are final.
    at: u32,
    /// Buckets that the last search visited.
    #[cfg(test)]
    turns: u32,
}

impl<const CELLS: usize> Default for CostField<CELLS> {
    fn default() -> Self {
        Self::new()
    }
}

#[derive(Clone, Copy)]
struct Query<'a> {
    params: &'a RouteParams,
    from: usize,
    from_cell: Cell,
    target: Cell,
}

impl<const CELLS: usize> CostField<CELLS> {
    /// Creates scratch memory.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(CELLS <= MOST_CELLS, "cells are numbered in 16 bits") };
        Self {
            origin: Cell::new(0, 0),
            width: 0,
            height: 0,
            stride: 0,
            impassability: [BLOCKED; CELLS],
            extra: [0; CELLS],
            cost: [0; CELLS],
            queue: Queue::new(),
            shift: 0,
            easiest: 0,
            has_walls: false,
            learns: false,
            closed: 0,
            at: 0,
            #[cfg(test)]
            turns: 0,
        }
    }

    /// Weights of the eight moves out of `from` towards `target` (alg. 3): the least cost of the
    /// routes that begin with the move, stay in the window and do not return to `from`.
    ///
    /// The window is `window` cut to radius r around `from`. Routes end at the target; if it is
    /// outside or no way inside leads to it, on the border by [`ExitRule`]. `others` are the cells
    /// of other robots.
    ///
    /// # Errors
    /// [`Unreachable`] when no exit can be reached, or `from` is not in the window.
    ///
    /// Work: at most three searches, each O(w h) while costs lie within 64 times the cheapest move
    /// of each other, and never more than O((w h)^2).
    pub fn weights<const M: usize>(
        &mut self,
        params: &RouteParams,
        window: &Window<'_>,
        from: Cell,
        target: Cell,
        others: impl IntoIterator<Item = Cell>,
        visits: Option<&VisitMemory<M>>,
    ) -> Result<Weights, Unreachable> {
        self.weights_knowing(params, window, (from, target), others, visits, &Beyond::default())
    }

    /// [`Self::weights`] with knowledge of land beyond the window; O(w + h) more per learned cell.
    pub(super) fn weights_knowing<const M: usize>(
        &mut self,
        params: &RouteParams,
        window: &Window<'_>,
        (from, target): (Cell, Cell),
        others: impl IntoIterator<Item = Cell>,
        visits: Option<&VisitMemory<M>>,
        beyond: &Beyond<'_>,
    ) -> Result<Weights, Unreachable> {
        self.load(params, window, from);
        let occupied = params.a1.of(UNIT);
        for cell in others {
            self.add_extra(cell, occupied);
        }
        for (cell, count) in visits.into_iter().flat_map(VisitMemory::iter) {
            self.add_extra(cell, params.a2.of(UNIT * u32::from(count)));
        }
        self.solve(params, from, target, beyond)
    }

    /// Not inlined: firmware contains it once.
    #[inline(never)]
    fn solve(
        &mut self,
        params: &RouteParams,
        from: Cell,
        target: Cell,
        beyond: &Beyond<'_>,
    ) -> Result<Weights, Unreachable> {
        let from_index = self.index(from).ok_or(Unreachable)?;
        let query = Query { params, from: from_index, from_cell: from, target };
        if let Some(inside) = self.index(target) {
            self.search_from(&query, Some(inside));
            let weights = self.outgoing(&query);
            if weights.best().is_some() {
                return Ok(weights);
            }
        }
        match params.exit {
            ExitRule::Best => {
                self.begin(&query);
                self.offer_border(&query, beyond);
                self.search(&query);
            }
            ExitRule::Ray => {
                let exit = ray_exit(params.radius, from, target);
                let at = self.index(exit).filter(|&at| self.is_passable(at) && at != from_index);
                self.search_from(&query, at);
                if self.outgoing(&query).best().is_none() {
                    let nearest = self.nearest_reachable_border(&query, exit).ok_or(Unreachable)?;
                    self.search_from(&query, Some(nearest));
                }
            }
        }
        let weights = self.outgoing(&query);
        weights.best().map(|_| weights).ok_or(Unreachable)
    }

    /// Impassability of the easiest land (255: all wall), and whether there are walls.
    pub(super) const fn land(&self) -> (u8, bool) {
        (self.easiest, self.has_walls)
    }

    /// Completes the last search, which stops once the next moves are priced. O(w h).
    pub fn complete(&mut self, params: &RouteParams) {
        self.advance(params, None);
    }

    /// Cost to the exit of the last query from `cell`; `None` without a route, or if it was not
    /// searched that far ([`CostField::complete`]). The robot's own cell is blocked.
    #[must_use]
    pub fn cost(&self, cell: Cell) -> Option<Cost> {
        let cost = *self.cost.get(self.index(cell)?)?;
        let open = self.index(cell).is_some_and(|at| self.is_passable(at) && at != self.closed);
        let is_final = self.queue.is_empty() || cost >> self.shift < self.at;
        (open && is_final && cost != EXCLUDED).then_some(cost)
    }

    /// The first move of the cheapest route from `cell` under the last query; `None` without one.
    #[must_use]
    pub fn descend(&self, params: &RouteParams, cell: Cell) -> Option<Dir> {
        let here = self.cost(cell)?;
        let at = self.index(cell)?;
        let weights = self.outgoing(&Query { params, from: at, from_cell: cell, target: cell });
        let dir = weights.best()?;
        // An exit may be cheaper than every route onwards from it.
        (weights.get(dir) <= here).then_some(dir)
    }

    /// Weights of the moves out of `cell` under the last query, not back to the robot's own cell.
    #[must_use]
    pub fn weights_at(&self, params: &RouteParams, cell: Cell) -> Weights {
        match self.index(cell) {
            Some(at) => self.outgoing(&Query { params, from: at, from_cell: cell, target: cell }),
            None => Weights::CLOSED,
        }
    }

    #[cfg(test)]
    pub(super) const fn turns(&self) -> u32 {
        self.turns
    }

    fn index(&self, cell: Cell) -> Option<usize> {
        let dx = u16::try_from(i32::from(cell.x) - i32::from(self.origin.x)).ok()?;
        let dy = u16::try_from(i32::from(cell.y) - i32::from(self.origin.y)).ok()?;
        let inside = dx < self.width && dy < self.height;
        inside.then(|| (usize::from(dy) + 1) * self.stride + usize::from(dx) + 1)
    }

    fn is_passable(&self, at: usize) -> bool {
        self.impassability.get(at).is_some_and(|&u| u != BLOCKED)
    }

    #[inline(never)]
    pub(super) fn load(&mut self, params: &RouteParams, window: &Window<'_>, from: Cell) {
        let (origin, width, height) = window.cut(from, params.radius);
        self.origin = origin;
        self.stride = usize::from(width) + 2;
        let rows = CELLS.checked_div(self.stride).unwrap_or(0).saturating_sub(2);
        self.width = if height == 0 { 0 } else { width };
        self.height = if width == 0 { 0 } else { height.min(rows.min(usize::from(u16::MAX)) as u16) };

        let used = (usize::from(self.height) + 2) * self.stride;
        for at in self.impassability.iter_mut().take(used) {
            *at = BLOCKED;
        }
        for at in self.extra.iter_mut().take(used) {
            *at = 0;
        }
        let mut least = u8::MAX;
        self.learns = false;
        self.has_walls = false;
        for row in 0..self.height {
            let source = window
                .index(self.origin + Cell::new(0, row.cast_signed()))
                .and_then(|start| window.cells().get(start..start + usize::from(self.width)));
            let start = (usize::from(row) + 1) * self.stride + 1;
            let sink = self.impassability.get_mut(start..start + usize::from(self.width));
            let (Some(source), Some(sink)) = (source, sink) else {
                continue;
            };
            // Not `copy_from_slice`, whose panic the compiler would keep.
            for (sink, u) in sink.iter_mut().zip(source) {
                *sink = *u;
            }
            least = source.iter().copied().filter(|&u| u != BLOCKED).fold(least, u8::min);
            self.has_walls |= source.contains(&BLOCKED);
        }
        self.easiest = least;
        let cheapest = params.a0.of(u32::from(least) * UNIT);
        self.shift = cheapest.checked_ilog2().unwrap_or(0);
    }

    fn add_extra(&mut self, cell: Cell, cost: Cost) {
        if let Some(extra) = self.index(cell).and_then(|at| self.extra.get_mut(at)) {
            *extra = extra.saturating_add(cost);
        }
    }

    #[inline(never)]
    fn begin(&mut self, query: &Query<'_>) {
        let used = (usize::from(self.height) + 2) * self.stride;
        for (cost, &u) in self.cost.iter_mut().zip(&self.impassability).take(used) {
            *cost = if u == BLOCKED { 0 } else { EXCLUDED };
        }
        self.queue.clear(used);
        #[cfg(test)]
        {
            self.turns = 0;
        }
        self.closed = query.from;
        if let Some(own) = self.cost.get_mut(query.from) {
            *own = 0;
        }
    }

    fn search_from(&mut self, query: &Query<'_>, exit: Option<usize>) {
        self.begin(query);
        exit.into_iter().for_each(|at| self.offer(at, 0));
        self.search(query);
    }

    fn search(&mut self, query: &Query<'_>) {
        // Costs of the exits may lie far from 0: start the ring at the least of them.
        self.at = self.lowest_offer();
        self.advance(query.params, Some(query.from));
    }

    #[inline(never)]
    fn advance(&mut self, params: &RouteParams, around: Option<usize>) {
        let mut idle = 0;
        while !self.queue.is_empty() && !around.is_some_and(|cell| self.has_settled_around(cell)) {
            let at = self.queue.next_from(self.at);
            idle += 1;
            #[cfg(test)]
            {
                self.turns += 1;
            }
            while let Some(cell) = self.queue.pop(at) {
                let cost = self.cost.get(cell).copied().unwrap_or(0);
                let due = cost >> self.shift;
                if due > at {
                    self.queue.link(cell, due.min(at.saturating_add(RING - 1)));
                } else {
                    self.settle(params, cell, cost, at);
                    idle = 0;
                }
            }
            self.at = at.saturating_add(1);
            if idle > RING {
                self.skip();
                idle = 0;
            }
        }
    }

    /// Skips to the next cell if a whole turn of the ring settled none, which extreme gains cause.
    fn skip(&mut self) {
        self.at = self.lowest_offer();
        let used = (usize::from(self.height) + 2) * self.stride;
        for cell in 0..used {
            if self.queue.holds(cell) {
                let cost = self.cost.get(cell).copied().unwrap_or(0);
                let last = self.at.saturating_add(RING - 1);
                self.queue.unlink(cell);
                self.queue.link(cell, (cost >> self.shift).min(last));
            }
        }
    }

    fn has_settled_around(&self, at: usize) -> bool {
        let s = self.stride;
        let rows = [at.wrapping_sub(s + 1), at.wrapping_sub(1), at + s - 1];
        rows.iter().all(|&start| {
            let row = self.cost.get(start..start + 3).unwrap_or_default();
            row.iter().all(|&cost| cost >> self.shift < self.at)
        })
    }

    fn lowest_offer(&self) -> u32 {
        let costs = self.queue.iter().filter_map(|cell| self.cost.get(cell).copied());
        costs.min().unwrap_or(0) >> self.shift
    }

    fn settle(&mut self, params: &RouteParams, cell: usize, cost: Cost, at: u32) {
        let u = u32::from(self.impassability.get(cell).copied().unwrap_or(BLOCKED));
        let extra = if self.learns { 0 } else { self.extra.get(cell).copied().unwrap_or(0) };
        let beyond = cost.saturating_add(extra);
        let axis = beyond.saturating_add(params.a0.of(UNIT * u));
        let diagonal = match params.norm {
            Norm::Chebyshev => axis,
            Norm::Euclidean => beyond.saturating_add(params.a0.of(DIAGONAL * u)),
        };
        let stride = self.stride;
        let (east, west) = (cell + 1, cell.wrapping_sub(1));
        let (north, south) = (cell + stride, cell.wrapping_sub(stride));
        for beside in [east, west, north, south] {
            self.relax(beside, axis, at);
        }
        let open = |side| params.corner_cutting || self.is_passable(side);
        let [e, w, n, s] = [east, west, north, south].map(open);
        let corners = [
            (north + 1, n && e),
            (north.wrapping_sub(1), n && w),
            (south + 1, s && e),
            (south.wrapping_sub(1), s && w),
        ];
        for (corner, is_open) in corners {
            if is_open {
                self.relax(corner, diagonal, at);
            }
        }
    }

    #[inline]
    fn relax(&mut self, cell: usize, cost: Cost, at: u32) {
        let Some(known) = self.cost.get_mut(cell) else {
            return;
        };
        if cost < *known {
            let least = if self.learns { self.extra.get(cell).copied().unwrap_or(0) } else { 0 };
            let cost = cost.max(least);
            if cost >= *known {
                return;
            }
            *known = cost;
            self.queue.unlink(cell);
            self.queue.link(cell, (cost >> self.shift).clamp(at, at.saturating_add(RING - 1)));
        }
    }

    fn offer(&mut self, cell: usize, price: Cost) {
        let Some(known) = self.cost.get_mut(cell) else {
            return;
        };
        if price < *known {
            *known = price;
            self.queue.unlink(cell);
            self.queue.link(cell, price >> self.shift);
        }
    }

    fn border(&self) -> impl Iterator<Item = Cell> + use<CELLS> {
        let (origin, width, height) = (self.origin, self.width.cast_signed(), self.height.cast_signed());
        let rows = (0..width).flat_map(move |x| [(x, 0), (x, height - 1)]);
        let columns = (1..height - 1).flat_map(move |y| [(0, y), (width - 1, y)]);
        rows.chain(columns).map(move |(x, y)| origin + Cell::new(x, y))
    }

    /// The border cell nearest to `exit` (ties by [`Cell`]) that the robot can reach.
    fn nearest_reachable_border(&mut self, query: &Query<'_>, exit: Cell) -> Option<usize> {
        // Moves are symmetric: a search from the own cell finds all reachable cells.
        let open = self.outgoing_with(query, |_| Some(0));
        self.begin(query);
        for (dir, cost) in open.iter() {
            let beside = self.index(query.from_cell + dir.offset());
            if let (true, Some(at)) = (cost != EXCLUDED, beside) {
                self.offer(at, 0);
            }
        }
        self.search(query);
        self.complete(query.params);
        let reached = self.border().filter(|&cell| self.cost(cell).is_some());
        let reached = reached.filter(|&cell| cell != query.from_cell);
        let nearest = reached.min_by_key(|&cell| (cell.distance_squared(exit), cell))?;
        self.index(nearest)
    }

    fn outgoing(&self, query: &Query<'_>) -> Weights {
        self.outgoing_with(query, |at| self.cost.get(at).copied().filter(|&cost| cost != EXCLUDED))
    }

    fn outgoing_with(&self, query: &Query<'_>, rest: impl Fn(usize) -> Option<Cost>) -> Weights {
        let params = query.params;
        let step = |dir: Dir| {
            let next = self.index(query.from_cell + dir.offset())?;
            let u = self.impassability.get(next).copied().filter(|&u| u != BLOCKED)?;
            if next == self.closed {
                return None;
            }
            if dir.is_diagonal() && !params.corner_cutting {
                let beside = dir.offset();
                let open =
                    |dx, dy| self.index(query.from_cell + Cell::new(dx, dy)).is_some_and(|at| self.is_passable(at));
                if !(open(beside.x, 0) && open(0, beside.y)) {
                    return None;
                }
            }
            let enter = params.a0.of(dir.length(params.norm) * u32::from(u));
            let extra = if self.learns { 0 } else { self.extra.get(next).copied()? };
            Some(rest(next)?.saturating_add(enter).saturating_add(extra).min(EXCLUDED - 1))
        };
        Weights::new(Dir::MOVES.map(|dir| step(dir).unwrap_or(EXCLUDED)))
    }
}
