//! Reports of robots on the land and on third robots.

use super::{Known, Nearby, Sight};
use super::{Negotiator, RANGE, moves};
use crate::grid::Cell;
use crate::list;
use crate::robot::RobotId;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Robots in a [`Report`].
pub const REPORTED: usize = 5;
/// Most cells to a robot in a [`Report`], along each axis.
const NEAR: i16 = 7;
/// Most blocked cells in a [`Report`].
const MOST_BLOCKED: usize = 2;

/// A robot's broadcast after it has heard the others in a step; at most 36 bytes on the air.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// Where it is: the lowest bytes of the coordinates.
    pub cell: [u8; 2],
    /// The land that it sees.
    pub sight: Sight,
    /// How far its goal is from the cells around it.
    pub way: Nearby,
    /// The nearest robots that it heard in this step: the lowest byte of the number, and the
    /// offsets to the east and to the north plus 8, in the low and in the high four bits. Before
    /// them cells that it found blocked: these offsets, and 0.
    pub heard: Vec<(u8, u8), REPORTED>,
}

impl<const N: usize> Negotiator<N> {
    /// The broadcast after the others were heard.
    #[must_use]
    pub fn report(&self) -> Report {
        let mut near: Vec<(u32, RobotId, Cell), N> = Vec::new();
        for other in self.known.iter().filter(|other| other.age == 0) {
            let offset = other.said.cell - self.own.cell;
            if is_near(offset) {
                let _ = near.push((offset.chebyshev(Cell::default()), other.id, offset));
            }
        }
        list::sort_by_key(&mut near, |&(distance, id, _)| (distance, id.0));
        let blocked = self.area.blocked().map(|cell| cell - self.own.cell).filter(|&offset| is_near(offset));
        let blocked = blocked.take(MOST_BLOCKED).map(|offset| (packed(offset), 0));
        let heard = near.iter().map(|&(_, id, offset)| (id.0 as u8, packed(offset)));
        let heard = list::collect(blocked.chain(heard).take(REPORTED));
        let is_known = !self.is_priced && self.distances.goal() == self.own.goal;
        let way = if is_known { Nearby::new(self.own.cell, &self.distances) } else { Nearby::UNKNOWN };
        Report { cell: Report::low(self.own.cell), sight: self.sight, way, heard }
    }

    /// Hears what another robot reports in this step. `is_there`: it did not move since. O(N) for
    /// each robot in it.
    pub fn hear_report(&mut self, from: RobotId, report: &Report, is_there: bool) {
        self.begin();
        let cell = nearest(report.cell, self.own.cell);
        self.area.learn(cell, &report.sight);
        if let Some(known) = self.known.iter_mut().find(|known| known.id == from) {
            known.way = (cell, report.way);
        }
        if is_there {
            self.place(from.0 as u8, cell);
        }
        // Others may say where they expect this robot.
        let own = self.id.0 as u8;
        for &(number, offset) in &report.heard {
            if offset == 0 {
                self.hear_blocked(cell + unpacked(number));
            } else if number != own {
                self.place(number, cell + unpacked(offset));
            }
        }
    }

    /// Another robot found a cell blocked.
    fn hear_blocked(&mut self, cell: Cell) {
        let moves = |other: &Known| other.said.cell == cell && other.lost == 0;
        if cell != self.own.cell && !self.known.iter().any(moves) {
            self.area.block(cell, true);
        }
    }

    /// Puts a reported robot into its cell, unless it was heard there.
    fn place(&mut self, number: u8, cell: Cell) {
        let is_there = |other: &Known| other.lost == 0 && other.said.cell == cell;
        let is_far = cell.chebyshev(self.own.cell) > RANGE;
        if cell == self.own.cell || is_far || self.known.iter().any(is_there) {
            return;
        }
        let may_be = |other: &&mut Known| {
            let most = 2 * u32::from(other.lost) + 1;
            other.id.0 as u8 == number && other.lost > 0 && moves(other.said.cell, cell) <= most
        };
        match self.known.iter_mut().filter(may_be).min_by_key(|other| moves(other.said.cell, cell)) {
            Some(other) => {
                other.goes(cell);
                other.lost = 0;
            }
            None if !self.strangers.iter().any(|&(_, at)| at == cell) => drop(self.strangers.push((number, cell))),
            None => {}
        }
    }
}

fn is_near(offset: Cell) -> bool {
    offset.x.abs() <= NEAR && offset.y.abs() <= NEAR
}

const fn packed(offset: Cell) -> u8 {
    (offset.x + NEAR + 1) as u8 | ((offset.y + NEAR + 1) as u8) << 4
}

fn unpacked(offset: u8) -> Cell {
    Cell::new((offset & 15).into(), (offset >> 4).into()) - Cell::new(NEAR + 1, NEAR + 1)
}

impl Report {
    /// A cell as [`Self::cell`] tells it.
    #[must_use]
    pub const fn low(cell: Cell) -> [u8; 2] {
        [cell.x as u8, cell.y as u8]
    }
}

/// The cell with these lowest bytes that is nearest to `own`.
fn nearest([x, y]: [u8; 2], own: Cell) -> Cell {
    let [own_x, own_y] = Report::low(own);
    own + Cell::new(i16::from(x.wrapping_sub(own_x) as i8), i16::from(y.wrapping_sub(own_y) as i8))
}
