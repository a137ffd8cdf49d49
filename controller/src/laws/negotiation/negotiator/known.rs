//! The robots that a robot knows of.

use super::super::area::Area;
use super::super::distance::Nearby;
use super::super::moves::Moves;
use super::super::plan::Member;
use super::super::wish::Wish;
use super::Said;
use crate::grid::{Cell, Dir};
use crate::list;
use crate::robot::RobotId;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A robot nearby, as last heard, and where it should be since.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Known {
    pub(super) id: RobotId,
    pub(super) said: Said,
    /// The way to its goal, as last told, and the cell in which it told that.
    pub(super) way: (Cell, Nearby),
    /// It is not in the cell whose wish it told, and makes this move next, if that is known.
    pub(super) strayed: Option<Dir>,
    /// Steps since it was heard.
    pub(super) age: u8,
    /// Steps since its place was heard or reported.
    pub(super) lost: u8,
    /// It stays in its cell.
    pub(super) holds: bool,
    /// Steps until it can move.
    pub(super) busy: u8,
    /// As in [`Member::leaves_by`].
    pub(super) leaves_by: Option<Dir>,
}

impl Known {
    /// It went to a cell, or stayed, as far as this robot can tell.
    pub(super) fn goes(&mut self, to: Cell) {
        let Said { cell, wish, .. } = self.said;
        if to != cell {
            let is_best = self.strayed.is_none() && wish.best().is_some_and(|best| cell + best.offset() == to);
            self.strayed = Some(if is_best { wish.then } else { Dir::Stay });
            self.said.cell = to;
        }
    }

    /// Its wish: as told, by its way as last told, or by its goal.
    pub(super) fn wish(&self, area: &Area, moves: Moves) -> Wish {
        let Said { cell, goal, wish, .. } = self.said;
        let Some(then) = self.strayed else { return wish };
        let (center, way) = self.way;
        let wish = Wish::new((cell, goal), area, |a, b| way.compare(a - center, b - center), moves);
        match (wish.best(), then) {
            (None, Dir::Stay) if cell != goal => Wish::towards(cell, goal, area, moves),
            (None, then) if then != Dir::Stay => Wish::only(then, cell, area, moves),
            _ => wish,
        }
    }
}

/// The first member, and those that steps of at most `link` cells from robot to robot link with it:
/// no other one can be in its way, nor in the way of these. O(N^2).
pub(super) fn linked<const N: usize>(members: &Vec<Member, N>, link: u32) -> Vec<Member, N> {
    let mut is_linked: Vec<bool, N> = list::collect(members.iter().map(|_| false));
    let mut open: Vec<Cell, N> = Vec::new();
    let mut take = |index: usize, open: &mut Vec<Cell, N>| {
        if let (Some(flag @ false), Some(member)) = (is_linked.get_mut(index), members.get(index)) {
            *flag = true;
            let _ = open.push(member.cell);
        }
    };
    take(0, &mut open);
    while let Some(cell) = open.pop() {
        for (index, member) in members.iter().enumerate() {
            if member.cell.chebyshev(cell) <= link {
                take(index, &mut open);
            }
        }
    }
    list::collect(members.iter().zip(&is_linked).filter(|(_, is_linked)| **is_linked).map(|(member, _)| *member))
}
