//! The moves of all robots that one robot knows of, by one deterministic rule.

use super::area::Area;
use super::moves::Moves;
use super::wish::{Manners, Wish};
use crate::grid::{Cell, Dir};
use crate::list;
use crate::rand::Rng;
use crate::robot::RobotId;
use core::cmp::Reverse;
use heapless::Vec;

/// A robot in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its number; without meaning for a robot that is only sensed.
    pub id: RobotId,
    /// Where it is.
    pub cell: Cell,
    /// Where it wants to go.
    pub goal: Cell,
    /// Steps since it last stood on its goal, plus 1; 0 for a robot that is only sensed.
    pub waiting: u16,
    /// Its steps so far, modulo 256; breaks ties differently in each step.
    pub step: u8,
    /// How it behaves in this step.
    pub manners: Manners,
    /// Its wish, as far as is known.
    pub wish: Wish,
    /// It stays in its cell.
    pub holds: bool,
    /// Steps until it can move.
    pub busy: u8,
    /// If another robot is in its cell too, nearer to the centre: the only move that it can make.
    pub leaves_by: Option<Dir>,
}

/// A robot's place in the chain of those that ask each other to move.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// Its move, as far as one is chosen.
    next: Option<Cell>,
    /// Moves, best first; only `count` of them.
    order: [Dir; 9],
    count: u8,
    tried: u8,
    /// Index of the robot that it exchanges its cell with.
    swaps: Option<u8>,
    /// Index of the robot that asked it.
    asked_by: Option<u8>,
}

impl Turn {
    const NONE: Self = Self { next: None, order: [Dir::Stay; 9], count: 0, tried: 0, swaps: None, asked_by: None };
}

/// Longest corridor that a swap looks along, cells.
const CORRIDOR: usize = 200;
/// Longest wait for a robot on its way that counts, ticks.
const MOST_WAIT: u8 = 64;
const PURPOSE: u32 = u32::from_be_bytes(*b"nego");

/// A key in whose ascending order a cheap move is likely to be first, but never certain to:
/// Exp(1) x `lost`, 1/64 (P. Efraimidis and P. Spirakis 2006, "Weighted random sampling with a
/// reservoir"). A strict order by costs lets two robots repeat their moves for ever.
fn shuffled(uniform: u32, lost: u8) -> u32 {
    let zeros = uniform.leading_zeros();
    // -log2, whose fraction is linear.
    let fraction = uniform.wrapping_shl(zeros.saturating_add(1).min(31)) >> 26;
    let logarithm = zeros << 6 | 63_u32.saturating_sub(fraction);
    logarithm.saturating_mul(lost.into())
}

/// The moves of at most `N` robots.
pub struct Plan<'a, const N: usize> {
    members: &'a [Member],
    turns: [Turn; N],
    area: &'a Area,
    moves: Moves,
}

impl<'a, const N: usize> Plan<'a, N> {
    /// Plans the moves of `members`; those beyond the first `N` are ignored. All robots that know
    /// the same plan the same.
    ///
    /// Each robot chooses once, among at most 9 cells, and looks along at most 9 corridors of 200
    /// cells; each look takes O(N).
    pub fn new(members: &'a [Member], area: &'a Area, moves: Moves) -> Self {
        let members = members.get(..N).unwrap_or(members);
        let mut plan = Self { members, turns: [Turn::NONE; N], area, moves };
        // Where two robots share a cell, one has to leave it, whoever else has to make way.
        let shares = |member: &Member| {
            let is_guest_here = |other: &Member| other.leaves_by.is_some() && other.cell == member.cell;
            (member.leaves_by.is_some(), members.iter().any(is_guest_here))
        };
        let mut order: Vec<((bool, bool), u16, u32, u8), N> = Vec::new();
        for (index, member) in members.iter().enumerate() {
            if member.holds {
                plan.go(index as u8, member.cell);
                continue;
            }
            let tie = Rng::keyed(0, PURPOSE, member.id.0, 0).next_u32();
            let rank = if member.manners.is_last { 0 } else { member.waiting };
            let _ = order.push((shares(member), rank, tie, index as u8));
        }
        list::sort_by_key(&mut order, |&key| Reverse(key));
        for &(.., index) in &order {
            if plan.next(index).is_none() {
                plan.place(index);
            }
        }
        plan
    }

    /// The cell that a member enters or stays in.
    #[must_use]
    pub fn next(&self, index: u8) -> Option<Cell> {
        self.turns.get(usize::from(index))?.next
    }

    fn member(&self, index: u8) -> Member {
        let none = Member {
            id: RobotId::NONE,
            cell: Cell::default(),
            goal: Cell::default(),
            waiting: 0,
            step: 0,
            manners: Manners::default(),
            wish: Wish::CLOSED,
            holds: false,
            busy: 0,
            leaves_by: None,
        };
        self.members.get(usize::from(index)).copied().unwrap_or(none)
    }

    fn turn(&mut self, index: u8) -> Option<&mut Turn> {
        self.turns.get_mut(usize::from(index))
    }

    fn go(&mut self, index: u8, to: Cell) {
        if let Some(turn) = self.turn(index) {
            turn.next = Some(to);
        }
    }

    /// The robot in a cell; of two, the one nearer to the centre.
    fn occupant(&self, cell: Cell) -> Option<u8> {
        let mut there = None;
        for (member, index) in self.members.iter().zip(0_u8..).filter(|(member, _)| member.cell == cell) {
            there = Some(index);
            if member.leaves_by.is_none() {
                break;
            }
        }
        there
    }

    /// Whether another member goes to this cell, or crosses the way of `member` to it.
    fn is_taken(&self, to: Cell, member: u8) -> bool {
        let from = self.member(member).cell;
        let dir = Dir::between(from, to).unwrap_or_default();
        let mut others =
            self.turns.iter().zip(self.members).enumerate().filter(|(index, _)| *index != usize::from(member));
        others.any(|(_, (turn, other))| {
            let crosses = |end: Cell| Dir::between(other.cell, end).is_some_and(|way| dir.crosses(from, way, end));
            turn.next.is_some_and(|end| end == to || (dir.is_diagonal() && crosses(end)))
        })
    }

    /// Whether the robot in this cell waits for a member's move.
    fn asks(&self, cell: Cell, member: u8) -> bool {
        let above = |index: &u8| self.turns.get(usize::from(*index)).and_then(|turn| turn.asked_by);
        let chain = core::iter::successors(above(&member), above).take(N);
        chain.into_iter().any(|index| self.member(index).cell == cell)
    }

    /// Whether a member makes its move now: it can move, and its cell is free or becomes free now.
    /// O(N^2).
    #[must_use]
    pub fn moves_now(&self, index: u8) -> bool {
        let mut at = index;
        for _ in 0..N {
            let (member, Some(to)) = (self.member(at), self.next(at)) else { return false };
            if member.busy > 0 || to == member.cell {
                return false;
            }
            match self.occupant(to) {
                Some(other) if other != at => at = other,
                _ => return true,
            }
        }
        // All of a circle can move.
        true
    }

    /// Chooses the move of a member and of all that it has to ask.
    fn place(&mut self, first: u8) {
        let mut top = first;
        self.begin(top, None);
        // Each round ends a choice or tries one of at most 9 cells.
        for _ in 0..N.saturating_mul(20) {
            let Some(turn) = self.turns.get(usize::from(top)).copied() else { return };
            let own = self.member(top).cell;
            let next = turn.order.get(..usize::from(turn.count)).and_then(|order| order.get(usize::from(turn.tried)));
            let Some(dir) = next else {
                // Nothing is free: it stays, and the one that asked tries another cell.
                self.go(top, own);
                let Some(above) = turn.asked_by else { return };
                if let Some(above) = self.turn(above) {
                    above.tried = above.tried.saturating_add(1);
                }
                top = above;
                continue;
            };
            let to = own + dir.offset();
            let other = self.occupant(to).filter(|&other| other != top);
            let is_exchange = other.is_some_and(|other| self.next(other) == Some(own));
            if self.is_taken(to, top) || is_exchange || (!self.moves.circles && self.asks(to, top)) {
                if let Some(turn) = self.turn(top) {
                    turn.tried = turn.tried.saturating_add(1);
                }
                continue;
            }
            self.go(top, to);
            if let Some(other) = other.filter(|&other| self.next(other).is_none()) {
                self.begin(other, Some(top));
                top = other;
                continue;
            }
            // It has its cell, and so have all that wait for it.
            loop {
                let Some(turn) = self.turns.get(usize::from(top)).copied() else { return };
                if turn.tried == 0
                    && let Some(swaps) = turn.swaps
                {
                    let own = self.member(top).cell;
                    if self.next(swaps).is_none() && !self.is_taken(own, swaps) {
                        self.go(swaps, own);
                    }
                }
                match turn.asked_by {
                    Some(above) => top = above,
                    None => return,
                }
            }
        }
    }

    /// Orders the moves of a member.
    fn begin(&mut self, index: u8, asked_by: Option<u8>) {
        let member = self.member(index);
        let Member { id, cell, .. } = member;
        let mut order: Vec<(u8, u32, Dir), 9> = Vec::new();
        // Four bits of the step are on the air: with them alone, plans would repeat after 16 steps.
        let turn = u32::from(member.step & 15) | u32::from(member.waiting) << 4;
        let can = |dir: &&Dir| member.leaves_by.is_none_or(|by| by == **dir);
        for &dir in self.moves.dirs().iter().chain(&[Dir::Stay]).filter(can) {
            if let Some(lost) = member.wish.lost(dir) {
                let to = cell + dir.offset();
                let place = u64::from(to.x as u16) << 16 | u64::from(to.y as u16);
                let tie = Rng::keyed(place, PURPOSE, id.0, turn).next_u32();
                let busy = |other: u8| if other == index { 0 } else { self.member(other).busy };
                let wait = self.occupant(to).map_or(0, busy);
                let lost = if dir == Dir::Stay { lost } else { lost.saturating_add(wait.min(MOST_WAIT)) };
                let tie = if lost > Wish::STAYING { shuffled(tie, lost) } else { tie };
                let _ = order.push((lost.min(Wish::STAYING + 1), tie, dir));
            }
        }
        list::sort_by_key(&mut order, |&(rank, tie, dir)| (rank, tie, dir.index()));
        let best = order.first().map_or(Dir::Stay, |&(_, _, dir)| dir);
        let swaps = if best == Dir::Stay || member.manners.keeps_on || member.leaves_by.is_some() {
            None
        } else {
            self.swap(index, cell + best.offset())
        };
        if let Some(other) = swaps {
            // Both move at once, so it waits for a robot that is still on its way.
            if self.member(other).busy > 0 {
                order.retain(|&(.., dir)| dir == Dir::Stay);
            } else {
                order.reverse();
            }
        }
        if let Some(turn) = self.turn(index) {
            (turn.tried, turn.swaps, turn.asked_by) = (0, swaps, asked_by);
            turn.count = order.len() as u8;
            turn.order.iter_mut().zip(&order).for_each(|(to, &(_, _, dir))| *to = dir);
        }
    }

    /// The robot that a member must exchange places with, because a corridor is too narrow for
    /// both. LaCAM2's rule (K. Okumura 2023, "Improving LaCAM for scalable eventually optimal
    /// multi-agent pathfinding", IJCAI).
    fn swap(&self, index: u8, to: Cell) -> Option<u8> {
        let member = self.member(index);
        let own = member.cell;
        if let Some(other) = self.occupant(to)
            && self.next(other).is_none()
            && self.must_swap(index, other, own, to)
            && self.can_swap([index, other], own, to)
        {
            return Some(other);
        }
        for &dir in self.moves.dirs() {
            let beside = own + dir.offset();
            if beside == to || member.wish.lost(dir).is_none() {
                continue;
            }
            if let Some(other) = self.occupant(beside)
                && other != index
                && self.must_swap(other, index, own, to)
                && self.can_swap([index, other], own, to)
            {
                return Some(other);
            }
        }
        None
    }

    /// Whether `pusher`, on its way from `from` over `to`, only comes past `pulled` by exchanging
    /// places. Decided by their wishes and goals alone, because along a corridor a robot continues
    /// until its goal.
    fn must_swap(&self, pusher: u8, pulled: u8, mut from: Cell, mut to: Cell) -> bool {
        let (front, back) = (self.member(pusher), self.member(pulled));
        if !self.goes_over(&front, from, to) {
            return false;
        }
        let comes_back = back.cell == to
            && back.goal != to
            && Dir::between(to, from).is_some_and(|dir| back.wish.lost(dir) == Some(0));
        let mut is_pulled = comes_back || back.goal == from;
        for _ in 0..CORRIDOR {
            if front.goal == from {
                break;
            }
            match self.ways_on([pusher, pulled], to, from) {
                (0, _) => break,
                (1, on) => (from, to) = (to, on),
                _ => return false,
            }
            is_pulled |= back.goal == from;
        }
        is_pulled
    }

    /// Whether a robot in `from`, or beside it, wants to go from there to `to`, or ends in `from`.
    fn goes_over(&self, robot: &Member, from: Cell, to: Cell) -> bool {
        let is_there = robot.cell == from;
        let Some(first) = Dir::between(robot.cell, if is_there { to } else { from }) else { return false };
        if robot.goal == robot.cell || robot.wish.lost(first) != Some(0) {
            return false;
        }
        is_there
            || robot.goal == from
            || if robot.wish.best() == Some(first) && robot.wish.then != Dir::Stay {
                from + robot.wish.then.offset() == to
            } else {
                // Its next but one move is not known, unless there is only one.
                self.area.around(from, self.moves.dirs()).filter(|&on| on != robot.cell).count() == 1
            }
    }

    /// Whether the way over `to` comes to a fork where one robot can let the other pass.
    fn can_swap(&self, both: [u8; 2], mut to: Cell, mut from: Cell) -> bool {
        let start = from;
        for _ in 0..CORRIDOR {
            if to == start {
                return false;
            }
            match self.ways_on(both, to, from) {
                (0, _) => return false,
                (1, on) => (from, to) = (to, on),
                _ => return true,
            }
        }
        false
    }

    /// The number of ways on from `at`, and one of them: not back to `from`, and not into a dead
    /// end with a robot that is none of `both`.
    fn ways_on(&self, both: [u8; 2], at: Cell, from: Cell) -> (usize, Cell) {
        let dirs = self.moves.dirs();
        let is_full = |cell: Cell| {
            self.occupant(cell).is_some_and(|other| !both.contains(&other)) && self.area.around(cell, dirs).count() == 1
        };
        let on = self.area.around(at, dirs).filter(|&cell| cell != from && !is_full(cell));
        on.fold((0, at), |(count, _), cell| (count + 1, cell))
    }
}
