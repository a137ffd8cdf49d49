//! Predicts the cells of other robots at the end of the own next move.

use super::{FormationGuidance, seen_at};
use crate::cost::Gain;
use crate::formation::{Prediction, Seen, Steering, distances};
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::law::View;
use crate::laws::cells::{Grid, GridNeighbor};
use crate::robot::{Mode, RobotId};
use crate::route::{CostField, RouteParams};
use crate::template::Template;
use crate::time::Duration;
use heapless::Vec;

/// Cells by which an outdated state may be extrapolated.
const MAX_FORESIGHT: i16 = 3;

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize, K: Steering, H>
    FormationGuidance<CELLS, M, F, L, K, H>
{
    /// At most 32 robots: those of the template and the leader first, then the smallest ids.
    #[inline(never)]
    pub(super) fn seen<S: Copy>(
        &self,
        input: &View<'_, S, Grid>,
        (window, view): (&Window<'_>, &Template<F>),
        field: &mut CostField<CELLS>,
        all: &mut Vec<Seen, 32>,
    ) {
        let top = self.top(input, view);
        let concerns = |id: RobotId| id == self.leader || view.entries.iter().any(|entry| entry.id == id);
        for wanted in [true, false] {
            let others = input.on_grid().filter(|other| {
                let is_top = top.is_some_and(|(top, _)| top == other.id);
                (is_top || concerns(other.id)) == wanted
            });
            for other in others {
                let _ = all.push(seen_at(&other, self.foresee(input, window, &other)));
            }
        }
        if self.formation.prediction == Prediction::Reflexive {
            for index in 0..all.len() {
                let own = (view.entries.iter()).find(|entry| all.get(index).is_some_and(|seen| seen.id == entry.id));
                let Some(entry) = own else { continue };
                let place = top.and_then(|(top, offset)| {
                    let leader = all.iter().find(|seen| seen.id == top)?;
                    Some(leader.cell + offset + entry.offset)
                });
                if let Some(seen) = all.get(index).copied() {
                    let choice = self.choice_of(input, window, field, &seen, place);
                    if let (Some(choice), Some(seen)) = (choice, all.get_mut(index)) {
                        seen.predicted = choice;
                    }
                }
            }
        }
    }

    /// At constant velocity on the visible terrain, at most [`MAX_FORESIGHT`] cells away.
    fn foresee<S: Copy>(&self, input: &View<'_, S, Grid>, window: &Window<'_>, other: &GridNeighbor) -> Cell {
        let mut cell = other.cell;
        if !matches!(other.mode, Mode::Cruise | Mode::Forming) || other.heading == Dir::Stay {
            return cell;
        }
        let step = other.heading.offset();
        let length = other.heading.length(self.route.norm).cast_signed();
        let mut left = (input.now + input.tick).since(other.busy_until);
        for _ in 0..MAX_FORESIGHT {
            if left < Duration::ZERO {
                break;
            }
            let next = cell + step;
            let u = match window.get(next) {
                Some(BLOCKED) => break,
                Some(u) => u,
                // Beyond the window: the cost of its last cell, or easy terrain.
                None => window.get(cell).unwrap_or(1),
            };
            cell = next;
            let ticks = i32::from(u).saturating_mul(length);
            let micros = i64::from(input.tick.as_micros()) * i64::from(ticks);
            let crossing = micros.checked_div(i64::from(crate::grid::UNIT)).unwrap_or(0);
            let crossing = i32::try_from(crossing).unwrap_or(i32::MAX);
            left = Duration::from_micros(left.as_micros().saturating_sub(crossing));
        }
        cell
    }

    /// The choice of this law in another robot's place (KUZ section 7, item 1).
    fn choice_of<S: Copy>(
        &self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        field: &mut CostField<CELLS>,
        other: &Seen,
        place: Option<Cell>,
    ) -> Option<Cell> {
        let neighbor = input.grid_neighbor(other.id)?;
        let is_free = (input.now + input.tick).since(neighbor.busy_until) >= Duration::ZERO;
        let is_in_sight = Dir::MOVES.iter().all(|dir| window.get(other.cell + dir.offset()).is_some());
        if !is_free || !is_in_sight {
            return None;
        }
        let target = place.unwrap_or(neighbor.target);
        if target == other.cell {
            return Some(other.cell);
        }
        let params = RouteParams { a2: Gain::ZERO, ..self.route };
        let no_robots = core::iter::empty();
        let weights = field.weights::<0>(&params, window, other.cell, target, no_robots, None).ok()?;
        let price = distances(&self.formation, other.cell, place, &[]);
        let dir = weights.plus(&price).best()?;
        Some(other.cell + dir.offset())
    }
}
