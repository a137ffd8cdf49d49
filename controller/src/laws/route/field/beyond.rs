use super::{CostField, Query};
use crate::cost::{Cost, EXCLUDED};
use crate::grid::{Cell, DIAGONAL};
use crate::land::Outlook;

#[derive(Clone, Copy, Default)]
pub(in crate::route) struct Beyond<'a> {
    /// Lower bounds of the cost.
    pub learned: &'a [(Cell, Cost)],
    pub land: Option<&'a dyn Outlook>,
}

impl<const CELLS: usize> CostField<CELLS> {
    /// Makes every border cell an exit, priced by its distance to the target (eq. 10) and the land
    /// there, or by the learned cost if that is higher.
    pub(super) fn offer_border(&mut self, query: &Query<'_>, beyond: &Beyond<'_>) {
        let Query { params, target, .. } = *query;
        let distance = |cell: Cell| cell.distance(target, params.norm);
        // Prices that would leave the range of costs are reduced by the least of them.
        let size = u32::from(self.width) + u32::from(self.height);
        let farthest = (query.from_cell.chebyshev(target) + size) * DIAGONAL;
        let base =
            if params.a3.of(farthest) < EXCLUDED >> 1 { 0 } else { self.border().map(distance).min().unwrap_or(0) };
        for cell in self.border() {
            if let Some(at) = self.index(cell) {
                let known = beyond.learned.iter().find(|&&(at, _)| at == cell).map_or(0, |&(_, cost)| cost);
                let straight = params.a3.of(distance(cell) - base);
                let price = beyond.land.map_or(straight, |land| land.price(cell, straight));
                self.offer(at, price.max(known.min(EXCLUDED - 1)));
            }
        }
    }
}
