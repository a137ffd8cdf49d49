//! With [`Course`] a follower looks ahead (R. C. Coulter, "Implementation of the pure pursuit path
//! tracking algorithm", CMU-RI-TR-92-01, 1992): it plans its route to where its place will be some
//! moves later, avoids bad land in time, and the leader waits less.

use serde::{Deserialize, Serialize};
use staya_controller::formation::{Anchor, FormationParams, NextMove, Steering, lag};
use staya_controller::grid::{Cell, Dir, Norm, UNIT};
use staya_controller::robot::RobotId;

/// Uses the leader's recent moves, each weighted half as much as the next one. O(1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Course {
    leader: Option<(RobotId, Cell)>,
    /// Mean move, [`ONE`] per cell.
    x: i32,
    y: i32,
}

const ONE: i32 = 1024;
const LEAST: i32 = 100;
/// Planning distance, cells; more saves time and costs accuracy (`staya experiment formation`).
const AHEAD: u8 = 4;
const MOST: u32 = 16;

impl Course {
    /// Creates an undefined course.
    #[must_use]
    pub const fn new() -> Self {
        Self { leader: None, x: 0, y: 0 }
    }

    /// `None` if it is too short to define a direction.
    fn length(self) -> Option<i32> {
        Some(length(self.x, self.y)).filter(|&length| length >= LEAST)
    }

    /// The point `cells` cells along the course and half as far towards `to_go`.
    fn ahead(self, cells: u8, to_go: Cell) -> Option<Cell> {
        let own = self.length()?;
        let [gx, gy] = [to_go.x, to_go.y].map(i32::from);
        let rest = length(gx, gy);
        let unit = |part: i32, of: i32| (part * ONE).checked_div(of).unwrap_or(0);
        let x = unit(self.x, own) + (unit(gx, rest) >> 1);
        let y = unit(self.y, own) + (unit(gy, rest) >> 1);
        let all = length(x, y);
        let along = |part: i32| (2 * i32::from(cells) * part + all).checked_div_euclid(2 * all);
        Some(Cell::new(along(x)? as i16, along(y)? as i16))
    }
}

fn length(x: i32, y: i32) -> i32 {
    (x.unsigned_abs().pow(2) + y.unsigned_abs().pow(2)).isqrt().cast_signed()
}

impl Steering for Course {
    fn note(&mut self, leader: (RobotId, Cell)) {
        let (id, cell) = leader;
        let before = self.leader.replace(leader).filter(|&(old, _)| old == id);
        let Some((_, old)) = before else { return };
        let cells = old.chebyshev(cell);
        let off = cell - old;
        let mean = |part: i16| (i32::from(part) * ONE).checked_div(cells.cast_signed()).unwrap_or(0);
        for _ in 0..cells.min(MOST) {
            self.x = (self.x + mean(off.x)) >> 1;
            self.y = (self.y + mean(off.y)) >> 1;
        }
    }

    fn aims(&self, params: &FormationParams, anchor: &Anchor, goal: Cell) -> [Cell; 2] {
        let to_go = goal - anchor.place();
        match (self.ahead(AHEAD, to_go), self.ahead(params.lead, to_go)) {
            (Some(far), Some(near)) => [anchor.place() + far, anchor.place() + near],
            _ => NextMove.aims(params, anchor, goal),
        }
    }

    fn lag(&self, off: Cell, heading: Dir) -> u32 {
        let Some(length) = self.length() else { return lag(off, heading) };
        let along = i64::from(off.x) * i64::from(self.x) + i64::from(off.y) * i64::from(self.y);
        let behind = (-along * i64::from(UNIT)).checked_div(length.into()).unwrap_or(0);
        let aside = Cell::default().distance(off, Norm::Euclidean) >> 1;
        u32::try_from(behind.max(0)).unwrap_or(u32::MAX).max(aside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEADER: RobotId = RobotId(1);
    const GOAL: Cell = Cell::new(90, 90);

    fn course(cells: &[(i16, i16)]) -> Course {
        let mut course = Course::new();
        cells.iter().for_each(|&(x, y)| course.note((LEADER, Cell::new(x, y))));
        course
    }

    fn anchor() -> Anchor {
        Anchor { predicted: Cell::new(20, 20), offset: Cell::new(-3, 0), heading: Dir::North }
    }

    #[test]
    fn without_a_course_the_next_move_decides() {
        let params = FormationParams::default();
        for cells in [&[][..], &[(5, 5)], &[(5, 5), (5, 5)]] {
            let course = course(cells);
            assert_eq!(course.aims(&params, &anchor(), GOAL), [Cell::new(17, 21); 2]);
            assert_eq!(course.lag(Cell::new(0, -3), Dir::North), lag(Cell::new(0, -3), Dir::North));
        }
    }

    #[test]
    fn a_follower_plans_farther_than_it_prices() {
        let params = FormationParams { lead: 1, ..FormationParams::default() };
        let east = course(&[(0, 0), (1, 0), (2, 0), (3, 0)]);
        assert_eq!(east.aims(&params, &anchor(), Cell::new(90, 20)), [Cell::new(21, 20), Cell::new(18, 20)]);
        let south_west = course(&[(0, 0), (-1, -1), (-2, -2)]);
        let goal = Cell::new(-13, -10);
        assert_eq!(south_west.aims(&params, &anchor(), goal), [Cell::new(14, 17), Cell::new(16, 19)]);
        assert_eq!(east.aims(&params, &anchor(), Cell::new(17, 90)), [Cell::new(21, 22), Cell::new(18, 20)]);
        assert_eq!(east.aims(&params, &anchor(), Cell::new(17, 20)), [Cell::new(21, 20), Cell::new(18, 20)]);
    }

    #[test]
    fn a_single_move_aside_turns_the_course_by_less_than_itself() {
        let turned = course(&[(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1)]);
        assert_eq!(turned.ahead(4, Cell::default()), Some(Cell::new(3, 3)));
        let late = course(&[(0, 0), (4, 0), (4, 1)]);
        assert_eq!(late, turned);
        let mut other = turned;
        other.note((RobotId(2), Cell::new(50, 50)));
        assert_eq!((other.x, other.y), (turned.x, turned.y));
    }

    #[test]
    fn lag_is_along_the_course_or_half_of_the_offset() {
        let east = course(&[(0, 0), (4, 0), (8, 0), (12, 0)]);
        assert_eq!(east.lag(Cell::new(-3, 0), Dir::North), 3 * UNIT);
        assert_eq!(east.lag(Cell::new(3, 0), Dir::North), 3 * UNIT / 2);
        assert_eq!(east.lag(Cell::new(0, 4), Dir::North), 2 * UNIT);
    }

    #[test]
    fn extreme_cells_stay_in_range() {
        let far = i16::MAX;
        let across = course(&[(-far, -far), (far, far), (-far, far)]);
        let off = Cell::new(-far, -far);
        assert!(across.lag(off, Dir::Stay) > 0);
        assert!(across.length().is_some_and(|length| length <= 2 * ONE));
    }
}
