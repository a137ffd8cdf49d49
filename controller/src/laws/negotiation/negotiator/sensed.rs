//! Robots that a robot senses, beside those that it hears.

use super::{Negotiator, moves};
use crate::grid::Cell;
use crate::list;
use crate::robot::RobotId;
use heapless::Vec;

/// Moves that a robot may be away from where the last plan put it.
const MOST_MISSED: u32 = 2;
/// Cells around a robot in which it senses others.
const SENSED: u32 = 5;

/// The robots that a robot senses within 5 cells in this step.
#[derive(Clone, Copy, Debug, Default)]
pub enum Sensed<'a> {
    /// It has no such sensor.
    #[default]
    Nothing,
    /// The occupied cells.
    Cells(&'a [Cell]),
    /// Which robot is where.
    Robots(&'a [(RobotId, Cell)]),
}

impl<const N: usize> Negotiator<N> {
    /// Puts known robots where they are sensed. Returns the cells of those that are not known.
    pub(super) fn place_sensed(&mut self, robots: &[(RobotId, Cell)]) -> Vec<Cell, N> {
        let mut unknown = Vec::new();
        for &(id, cell) in robots {
            match self.known.iter_mut().find(|other| other.id == id) {
                Some(other) => other.goes(cell),
                None => drop(unknown.push(cell)),
            }
        }
        unknown
    }

    /// Puts each known robot within 5 cells into the nearest sensed cell, at most two moves away,
    /// and forgets those for which there is none. Returns the cells of robots that are not known.
    pub(super) fn match_sensed(&mut self, cells: &[Cell]) -> Vec<Cell, N> {
        let own = self.own.cell;
        let mut free: Vec<Cell, N> = list::collect(cells.iter().copied().filter(|&cell| cell != own));
        list::sort_by_key(&mut self.known, |other| (other.lost, other.age, other.id.0));
        let mut placed: Vec<RobotId, N> = Vec::new();
        for most in [0, MOST_MISSED] {
            for other in &mut self.known {
                let at = other.said.cell;
                if at.chebyshev(own) > SENSED || placed.contains(&other.id) {
                    continue;
                }
                let far = |&index: &usize| free.get(index).map_or(u32::MAX, |&cell| moves(cell, at));
                let nearest = (0..free.len()).min_by_key(far).filter(|index| far(index) <= most);
                if let Some(index) = nearest
                    && index < free.len()
                {
                    other.goes(free.swap_remove(index));
                    let _ = placed.push(other.id);
                }
            }
        }
        self.known.retain(|other| other.said.cell.chebyshev(own) > SENSED || placed.contains(&other.id));
        free
    }
}
