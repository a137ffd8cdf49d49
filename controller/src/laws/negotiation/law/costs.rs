//! Wishes by the costs of land, from the search of a route.

use super::Wish;
use crate::cost::{Cost, EXCLUDED, TICK, Weights};
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::laws::cells::GridWorkspace;
use crate::route::{RouteParams, Router};

/// The tools of a robot that prices its moves.
pub(super) struct Costs<'a, const CELLS: usize, const M: usize, const L: usize> {
    pub params: &'a RouteParams,
    pub router: &'a mut Router<M, L>,
    pub workspace: &'a mut GridWorkspace<CELLS>,
    pub window: &'a Window<'a>,
    pub target: Cell,
}

impl<const CELLS: usize, const M: usize, const L: usize> Costs<'_, CELLS, M, L> {
    /// The weights of the moves out of `cell`, with other robots in the cells `others`; `None`
    /// without a route. Work: see [`Router::weights`].
    pub fn weights(&mut self, cell: Cell, others: impl IntoIterator<Item = Cell> + Clone) -> Option<Weights> {
        let Self { params, router, workspace, window, target } = self;
        router.weights(params, &mut workspace.field, window, cell, *target, others).ok()
    }

    /// The wish of a robot in `cell` with these weights; without, it is in its target.
    pub fn wish(&mut self, cell: Cell, weights: Option<&Weights>) -> Wish {
        let Some((weights, best)) = weights.and_then(|weights| Some((weights, weights.best()?))) else {
            return self.at_target(cell);
        };
        let mut wish = self.by_weights(cell, weights);
        let to = cell + best.offset();
        self.workspace.field.complete(self.params);
        if to != self.target {
            wish.then = self.workspace.field.weights_at(self.params, to).best().unwrap_or_default();
        }
        wish
    }

    /// The wish after the move `dir` out of `from`, by the search there.
    pub fn wish_after(&mut self, from: Cell, dir: Dir) -> Wish {
        let cell = from + dir.offset();
        if cell == self.target {
            return self.at_target(cell);
        }
        self.workspace.field.complete(self.params);
        let mut weights = self.workspace.field.weights_at(self.params, cell);
        let Some(best) = weights.best() else { return self.at_target(cell) };
        // The search leaves the own cell out: the way back costs both cells.
        let ways = [(dir, cell), (dir, from)].map(|(dir, cell)| self.entering(cell, dir));
        let back = Dir::between(cell, from).unwrap_or_default();
        weights.set(back, ways.iter().fold(weights.get(best), |sum, &way| sum.saturating_add(way)).min(EXCLUDED - 1));
        let mut wish = self.by_weights(cell, &weights);
        let to = cell + best.offset();
        if to != self.target {
            wish.then = self.workspace.field.weights_at(self.params, to).best().unwrap_or_default();
        }
        wish
    }

    /// The wish of a robot in its target: it stays, unless another one pushes it.
    pub fn at_target(&self, cell: Cell) -> Wish {
        let mut wish = Wish::CLOSED;
        for (dir, weight) in self.params.open_moves(self.window, cell).iter() {
            if weight != EXCLUDED {
                wish.set(dir, 2);
            }
        }
        wish
    }

    fn by_weights(&self, cell: Cell, weights: &Weights) -> Wish {
        let least = weights.iter().map(|(_, weight)| weight).min().unwrap_or(EXCLUDED);
        let open = self.params.open_moves(self.window, cell);
        let mut wish = Wish::CLOSED;
        for (dir, weight) in weights.iter() {
            if weight != EXCLUDED {
                let lost = weight.saturating_sub(least).saturating_add(TICK >> 1).checked_div(TICK);
                let lost = lost.and_then(|lost| u8::try_from(lost).ok());
                wish.set(dir, lost.unwrap_or(Wish::MOST_LOST));
            } else if open.get(dir) != EXCLUDED {
                // No route leads there, but another robot may push it there.
                wish.set(dir, Wish::MOST_LOST);
            }
        }
        wish
    }

    fn entering(&self, cell: Cell, dir: Dir) -> Cost {
        let class = self.window.get(cell).unwrap_or(BLOCKED);
        self.params.a0.of(dir.length(self.params.norm).saturating_mul(class.into()))
    }
}
