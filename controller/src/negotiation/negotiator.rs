//! A robot that negotiates: what it knows of land and robots, from step to step.

use super::area::{Area, Sight};
use super::plan::{Fields, Member, Moves, Plan, Wish};
use crate::grid::{Cell, Dir};
use crate::robot::RobotId;
use heapless::Vec;

/// Distance up to which robots plan together, cells.
pub const RANGE: u32 = 8;
/// Steps after which a robot that is not heard is forgotten.
const FORGET: u8 = 6;
/// Moves that a robot may be away from where the last plan put it.
const MOST_MISSED: u32 = 2;
/// Cells around a robot in which it senses others.
const SENSED: u32 = 5;

/// What a robot says of itself in each step, before it decides; 15 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said {
    /// Who says it.
    pub id: RobotId,
    /// Where it is.
    pub cell: Cell,
    /// Where it wants to go.
    pub goal: Cell,
    /// Steps since it last stood on its goal, plus 1.
    pub waiting: u16,
    /// Its steps so far, modulo 256.
    pub step: u8,
    /// Which cells around it it wants to enter.
    pub wish: Wish,
}

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

/// A robot nearby, as last heard, and where it should be since.
#[derive(Clone, Copy, Debug)]
struct Known {
    said: Said,
    /// Steps since it was heard.
    age: u8,
}

/// A robot that plans with the robots near it: at most `N` with itself, and distances of `F` goals.
///
/// In each step: [`see`](Self::see), send what that returns, [`hear`](Self::hear) the others,
/// [`decide`](Self::decide).
#[derive(Clone, Debug)]
pub struct Negotiator<const N: usize, const F: usize> {
    own: Said,
    moves: Moves,
    area: Area,
    known: Vec<Known, N>,
    fields: Fields<F>,
}

impl<const N: usize, const F: usize> Negotiator<N, F> {
    /// A robot at its goal, which knows nothing.
    #[must_use]
    pub const fn new(id: RobotId, cell: Cell, moves: Moves) -> Self {
        let own = Said { id, cell, goal: cell, waiting: 1, step: 0, wish: Wish(0) };
        Self { own, moves, area: Area::new(cell), known: Vec::new(), fields: Fields::new() }
    }

    /// Gives it a goal. It waits behind others that have waited longer.
    pub const fn set_goal(&mut self, goal: Cell) {
        self.own.goal = goal;
        self.own.waiting = 0;
    }

    /// Begins a step in `cell`. Returns what to say.
    pub fn see(&mut self, cell: Cell, sight: &Sight) -> Said {
        self.area.follow(cell);
        self.area.learn(cell, sight);
        let waiting = if cell == self.own.goal { 1 } else { self.own.waiting.saturating_add(1) };
        let distances = self.fields.to(self.own.goal, &self.area, self.moves);
        let wish = Wish::new(cell, &self.area, distances, self.moves);
        let step = self.own.step.wrapping_add(1);
        self.own = Said { cell, waiting, step, wish, ..self.own };
        for other in &mut self.known {
            other.age = other.age.saturating_add(1);
            other.said.step = other.said.step.wrapping_add(1);
            let at_goal = other.said.cell == other.said.goal;
            other.said.waiting = if at_goal { 1 } else { other.said.waiting.saturating_add(1) };
        }
        self.own
    }

    /// Hears another robot in this step; `sight`: what it sees, if it tells that.
    pub fn hear(&mut self, said: &Said, sight: Option<&Sight>) {
        if said.id == self.own.id || said.cell.chebyshev(self.own.cell) > RANGE {
            return;
        }
        if let Some(sight) = sight {
            self.area.learn(said.cell, sight);
        }
        let known = Known { said: *said, age: 0 };
        if let Some(other) = self.known.iter_mut().find(|other| other.said.id == said.id) {
            *other = known;
        } else {
            let _ = self.known.push(known);
        }
    }

    /// Chooses the move of this step.
    pub fn decide(&mut self, sensed: Sensed<'_>) -> Dir {
        let own = self.own;
        self.known.retain(|other| other.age <= FORGET || !matches!(sensed, Sensed::Nothing));
        let strangers = match sensed {
            Sensed::Nothing => Vec::new(),
            Sensed::Cells(cells) => self.match_sensed(cells),
            Sensed::Robots(robots) => self.place_sensed(robots),
        };
        self.known.retain(|other| other.said.cell.chebyshev(own.cell) <= RANGE);
        let mut members: Vec<Member, N> = Vec::new();
        let _ = members.push(member(&own, true));
        // The newest news of a cell counts.
        self.known.sort_unstable_by_key(|other| (other.age, other.said.id.0));
        for Known { said, age } in &self.known {
            if members.iter().all(|other| other.cell != said.cell) {
                let _ = members.push(member(said, *age == 0));
            }
        }
        for cell in strangers {
            let _ = members.push(Member { id: RobotId::NONE, cell, goal: cell, waiting: 0, step: 0, wish: None });
        }
        let plan: Plan<'_, N, F> = Plan::new(&members, &self.area, &mut self.fields, self.moves);
        let next = plan.next(0).unwrap_or(own.cell);
        // Until it is heard again, a robot is where this plan puts it.
        for other in &mut self.known {
            let index = members.iter().position(|member| member.id == other.said.id);
            if let Some(cell) = index.and_then(|index| plan.next(index as u8)) {
                other.said.cell = cell;
            }
        }
        Dir::between(own.cell, next).unwrap_or(Dir::Stay)
    }

    /// Puts known robots where they are sensed. Returns the cells of those that are not known.
    fn place_sensed(&mut self, robots: &[(RobotId, Cell)]) -> Vec<Cell, N> {
        let mut unknown = Vec::new();
        for &(id, cell) in robots {
            match self.known.iter_mut().find(|other| other.said.id == id) {
                Some(other) => other.said.cell = cell,
                None => drop(unknown.push(cell)),
            }
        }
        unknown
    }

    /// Puts each known robot within 5 cells into the nearest sensed cell, at most two moves away,
    /// and forgets those for which there is none. Returns the cells of robots that are not known.
    fn match_sensed(&mut self, cells: &[Cell]) -> Vec<Cell, N> {
        let own = self.own.cell;
        let mut free: Vec<Cell, N> = cells.iter().copied().filter(|&cell| cell != own).take(N).collect();
        self.known.sort_unstable_by_key(|other| (other.age, other.said.id.0));
        let mut placed: Vec<RobotId, N> = Vec::new();
        for most in [0, MOST_MISSED] {
            for Known { said, .. } in &mut self.known {
                if said.cell.chebyshev(own) > SENSED || placed.contains(&said.id) {
                    continue;
                }
                let far = |cell: Cell| u32::from(cell.x.abs_diff(said.cell.x)) + u32::from(cell.y.abs_diff(said.cell.y));
                let nearest = (0..free.len()).min_by_key(|&index| free.get(index).map_or(u32::MAX, |&cell| far(cell)));
                if let Some((index, cell)) = nearest.and_then(|index| Some((index, *free.get(index)?)))
                    && far(cell) <= most
                {
                    said.cell = cell;
                    free.swap_remove(index);
                    let _ = placed.push(said.id);
                }
            }
        }
        self.known.retain(|other| other.said.cell.chebyshev(own) > SENSED || placed.contains(&other.said.id));
        free
    }
}

const fn member(said: &Said, is_fresh: bool) -> Member {
    let Said { id, cell, goal, waiting, step, wish } = *said;
    Member { id, cell, goal, waiting, step, wish: if is_fresh { Some(wish) } else { None } }
}
