//! Bodies on the grid: occupancy, timing and priority of moves.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), sections 2 and 3, eq. 6 (timing) and algorithm 4 (moves).
//! Line 7 of algorithm 4 is misprinted: as printed, the search for a direction ends at the first
//! move, also into the cell of another robot (`!= 0`). Here it ends at a free cell (`== 0`), a
//! robot without one stays, and the old cell becomes free, which the listing leaves out. The paper
//! does not define the order of moves. Here it is random in each tick, a function of (seed, tick,
//! robot), so that no robot has permanent priority and the order in memory does not matter.

#[doc(hidden)]
pub mod border;
pub mod plane;
mod refusal;
pub mod scouts;
mod window;

pub use refusal::Refusal;
pub use window::{known_window, window, window_but};

use crate::terrain::Terrain;
use rayon::prelude::*;
use staya_controller::agent::Command;
use staya_controller::grid::{BLOCKED, Cell, Dir, Norm, UNIT};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::scalar::NumberFormat;
use std::collections::HashMap;
use thiserror::Error;

const PRIORITY: u32 = 0x0057_0001;

/// Rules of movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveRules {
    /// Norm of a diagonal move.
    pub norm: Norm,
    /// Whether a diagonal move may cut the corner of one or two walls; robots there never block it.
    pub corner_cutting: bool,
    /// Whether a diagonal move may cross one that is under way, which counts as a collision.
    pub crossing: bool,
    /// Whether bodies move to four neighbours only.
    pub orthogonal: bool,
    /// Whether all bodies move at once ([`World::advance`]); for orthogonal moves.
    pub simultaneous: bool,
}

/// A robot's body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body {
    /// Id of the robot.
    pub id: RobotId,
    /// Cell that it occupies exclusively.
    pub cell: Cell,
    /// Move by which it entered the cell; `Stay` at the start.
    pub entered_by: Dir,
    /// Time when it may leave, in [`UNIT`]ths of a tick after the start.
    pub free_at: u64,
    /// Duration of its last crossing by the land of that time, [`UNIT`]ths of a tick; 0: none.
    pub crossing: u64,
    /// The cell was closed while the body was inside: it may leave, and no body may enter.
    pub is_shut_in: bool,
}

impl Body {
    pub(crate) const fn at_rest(id: RobotId, cell: Cell) -> Self {
        Self { id, cell, entered_by: Dir::Stay, free_at: 0, crossing: 0, is_shut_in: false }
    }

    /// The diagonal move by which it is entering its cell; `Stay` if it is not in such a move.
    fn diagonal(&self, now: u64) -> Dir {
        if self.free_at > now && self.entered_by.is_diagonal() { self.entered_by } else { Dir::Stay }
    }
}

/// A start that the world refuses.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Misplaced {
    /// The start is in a wall or outside the map.
    #[error("robot {} starts in the impassable cell ({}, {}); give it another start", .robot.0, .cell.x, .cell.y)]
    Blocked {
        /// Id of the robot.
        robot: RobotId,
        /// Its start.
        cell: Cell,
    },
    /// Two robots start in one cell.
    #[error("robots {} and {} both start in cell ({}, {}); give one of them another start", .first.0, .second.0, .cell.x, .cell.y)]
    Overlap {
        /// Id of the first robot in the list.
        first: RobotId,
        /// Id of the second robot.
        second: RobotId,
        /// Their start.
        cell: Cell,
    },
    /// The scenario wants another number format than `f32`.
    #[error(
        "the robots compute in `{0}`, which `staya hil` and `staya experiment` run; leave out `numbers`, or use one of these"
    )]
    Numbers(NumberFormat),
}

/// The terrain and the bodies on it.
#[derive(Clone, Debug)]
pub struct World {
    terrain: Terrain,
    rules: MoveRules,
    seed: u64,
    bodies: Vec<Body>,
    /// Per cell of the terrain: index of its body plus 1, or 0.
    occupancy: Vec<u32>,
    movers: Vec<(u64, RobotId, u32)>,
    /// Scratch of the collision check: a bit per cell. Empty between checks.
    seen: Vec<u64>,
}

impl World {
    /// Creates a world with bodies at their starts, free to move at tick 0.
    ///
    /// # Errors
    /// A start is impassable, outside the map or taken.
    pub fn new(
        terrain: Terrain,
        rules: MoveRules,
        seed: u64,
        starts: impl IntoIterator<Item = (RobotId, Cell)>,
    ) -> Result<Self, Misplaced> {
        let cells = terrain.cells().len();
        let mut world = Self {
            terrain,
            rules,
            seed,
            bodies: Vec::new(),
            occupancy: vec![0; cells],
            movers: Vec::new(),
            seen: vec![0; cells.div_ceil(64)],
        };
        for (robot, cell) in starts {
            world.place(robot, cell)?;
        }
        Ok(world)
    }

    fn place(&mut self, robot: RobotId, cell: Cell) -> Result<(), Misplaced> {
        let at = match self.terrain.index(cell) {
            Some(at) if self.terrain.is_passable(cell) => at,
            _ => return Err(Misplaced::Blocked { robot, cell }),
        };
        if let Some(other) = self.body_at(cell) {
            let first = self.bodies[other].id;
            let second = robot;
            return Err(Misplaced::Overlap { first, second, cell });
        }
        self.bodies.push(Body::at_rest(robot, cell));
        self.occupancy[at] = self.bodies.len() as u32;
        Ok(())
    }

    /// The terrain.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// Restores body `index` if its cell is valid. A body in that cell must be moved too.
    pub(crate) fn put(&mut self, index: usize, body: Body) -> bool {
        let may_be_there = body.is_shut_in || self.terrain.is_passable(body.cell);
        let Some(to) = self.terrain.index(body.cell).filter(|_| may_be_there) else {
            return false;
        };
        let own = index as u32 + 1;
        if let Some(from) = self.terrain.index(self.bodies[index].cell)
            && self.occupancy[from] == own
        {
            self.occupancy[from] = 0;
        }
        self.occupancy[to] = own;
        let id = self.bodies[index].id;
        self.bodies[index] = Body { id, ..body };
        true
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.bodies.iter().enumerate().all(|(index, body)| self.body_at(body.cell) == Some(index))
    }

    pub(crate) fn put_cell(&mut self, cell: Cell, class: u8) {
        self.terrain.set(cell, class);
    }

    /// Changes terrain cells. A body in a cell that closes may leave it.
    pub fn change(&mut self, cells: &[(Cell, u8)]) {
        for &(cell, class) in cells {
            self.terrain.set(cell, class);
            if let Some(index) = self.body_at(cell) {
                self.bodies[index].is_shut_in = class == BLOCKED;
            }
        }
    }

    /// Changes a terrain cell by hand; 0 is a wall.
    ///
    /// # Errors
    /// The cell does not exist or is occupied.
    pub fn set_cell(&mut self, cell: Cell, class: u8) -> Result<(), Refusal> {
        let is_taken = self.body_at(cell).is_some();
        set_cell(&mut self.terrain, cell, class, is_taken)
    }

    /// The bodies, in the order in which they were placed.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Index of the body in a cell.
    #[must_use]
    pub fn body_at(&self, cell: Cell) -> Option<usize> {
        let at = self.terrain.index(cell)?;
        (self.occupancy[at] as usize).checked_sub(1)
    }

    /// Moves the bodies; `commands[i]` belongs to body `i`.
    ///
    /// A body that may leave takes the first of its preferred moves whose cell is passable and
    /// free, also if another body left that cell earlier in the tick; the order is that of this
    /// tick's priorities. Refused bodies try again after the others, as long as any body moves, so
    /// that robots can follow each other. A diagonal move must also not cross one that is under way
    /// in this tick ([`Dir::crosses`]), unless [`MoveRules::crossing`] allows it. Entering cell c
    /// by move d keeps the body busy for length(d) * u(c) ticks (eq. 6). A body that moves again as
    /// soon as it is free keeps the remaining fraction of a tick, so a journey takes exactly the
    /// sum of eq. 7.
    ///
    /// With [`MoveRules::simultaneous`] a body that may leave wants its first move, and all bodies
    /// move at once. They may follow each other, also in a circle. Two bodies do not exchange
    /// cells. Of several bodies that want one cell, the first one placed gets it. A body whose cell
    /// stays occupied does not move. This is the collision system `soft` of
    /// [POGEMA](https://github.com/Cognitive-AI-Systems/pogema).
    ///
    /// # Panics
    /// If there are fewer commands than bodies.
    pub fn advance(&mut self, tick: u32, commands: &[Command<f32>]) {
        let now = u64::from(tick) * u64::from(UNIT);
        if self.rules.simultaneous {
            return self.advance_at_once(now, commands);
        }
        let mut movers = std::mem::take(&mut self.movers);
        movers.clear();
        let bodies = self.bodies.par_iter().enumerate().with_min_len(1024);
        movers.par_extend(bodies.filter_map(|(index, body)| {
            let wants = matches!(&commands[index], Command::Move(preferred) if !preferred.is_empty());
            let moves = body.free_at <= now && wants;
            let priority = || Rng::keyed(self.seed, PRIORITY, body.id.0, tick).next_u64();
            moves.then(|| (priority(), body.id, index as u32))
        }));
        movers.par_sort_unstable();
        let mut refused = movers.len() + 1;
        while movers.len() < refused {
            refused = movers.len();
            movers.retain(|&(_, _, index)| match &commands[index as usize] {
                Command::Move(preferred) => !self.move_body(index as usize, preferred, now),
                _ => false,
            });
        }
        self.movers = movers;
    }

    /// Returns false if all preferred moves are refused.
    fn move_body(&mut self, index: usize, preferred: &[Dir], now: u64) -> bool {
        let body = self.bodies[index];
        let open = preferred.iter().find(|&&dir| dir == Dir::Stay || self.is_open(body.cell, dir, now));
        let Some(&dir) = open else { return false };
        let to = body.cell + dir.offset();
        if let (Some(from_at), Some(to_at)) = (self.terrain.index(body.cell), self.terrain.index(to))
            && dir != Dir::Stay
        {
            self.occupancy[from_at] = 0;
            self.occupancy[to_at] = index as u32 + 1;
            self.bodies[index] = self.entered(&body, dir, now);
        }
        true
    }

    /// O(bodies).
    fn advance_at_once(&mut self, now: u64, commands: &[Command<f32>]) {
        let wish = |(body, command): (&Body, &Command<f32>)| match command {
            Command::Move(preferred) if body.free_at <= now => {
                preferred.first().copied().filter(|&dir| self.is_passable(body.cell, dir)).unwrap_or_default()
            }
            _ => Dir::Stay,
        };
        let mut dirs: Vec<Dir> = self.bodies.iter().zip(commands).map(wish).collect();
        let mut takers = HashMap::new();
        let mut stays = Vec::new();
        for (index, (body, &dir)) in self.bodies.iter().zip(&dirs).enumerate() {
            let to = body.cell + dir.offset();
            let exchanges = self.body_at(to).is_some_and(|other| to + dirs[other].offset() == body.cell);
            if exchanges || *takers.entry(to).or_insert(index) != index {
                stays.push(index);
            }
        }
        // A body that stays also stops the one that wants its cell.
        while let Some(index) = stays.pop() {
            dirs[index] = Dir::Stay;
            stays.extend(takers.remove(&self.bodies[index].cell));
        }
        let moves: Vec<_> = (0..).zip(dirs).filter(|&(_, dir)| dir != Dir::Stay).collect();
        for &(index, _) in &moves {
            self.occupy(self.bodies[index].cell, 0);
        }
        for (index, dir) in moves {
            self.bodies[index] = self.entered(&self.bodies[index], dir, now);
            self.occupy(self.bodies[index].cell, index as u32 + 1);
        }
    }

    fn occupy(&mut self, cell: Cell, mark: u32) {
        if let Some(at) = self.terrain.index(cell) {
            self.occupancy[at] = mark;
        }
    }

    fn entered(&self, body: &Body, dir: Dir, now: u64) -> Body {
        let idle = now - body.free_at;
        let start = if idle < u64::from(UNIT) { body.free_at } else { now };
        let cell = body.cell + dir.offset();
        let crossing = u64::from(dir.length(self.rules.norm)) * u64::from(self.terrain.get(cell));
        Body { id: body.id, cell, entered_by: dir, free_at: start + crossing, crossing, is_shut_in: false }
    }

    fn is_open(&self, from: Cell, dir: Dir, now: u64) -> bool {
        let to = from + dir.offset();
        let diagonal = |index: usize| self.bodies[index].diagonal(now);
        self.is_passable(from, dir)
            && self.body_at(to).is_none()
            && !self
                .sides(from, dir)
                .any(|side| self.body_at(side).is_some_and(|body| dir.crosses(from, diagonal(body), side)))
    }

    /// Whether the terrain allows the move.
    fn is_passable(&self, from: Cell, dir: Dir) -> bool {
        let to = from + dir.offset();
        let passable = |x, y| self.terrain.is_passable(Cell::new(x, y));
        self.terrain.is_passable(to)
            && !(self.rules.orthogonal && dir.is_diagonal())
            && (self.rules.corner_cutting || !dir.is_diagonal() || (passable(to.x, from.y) && passable(from.x, to.y)))
    }

    /// The ends of diagonal moves that must not be under way during a move.
    fn sides(&self, from: Cell, dir: Dir) -> impl Iterator<Item = Cell> + use<> {
        let to = from + dir.offset();
        let count = if dir.is_diagonal() && !self.rules.crossing { 2 } else { 0 };
        [Cell::new(from.x, to.y), Cell::new(to.x, from.y)].into_iter().take(count)
    }

    /// Number of bodies in a shared cell, in a blocked cell that did not close around them, or in a
    /// diagonal move that crosses one counted before. Does not use the occupancy table of
    /// [`World::advance`], so that it finds errors in it. `tick` is that of the last moves.
    /// O(robots).
    pub fn count_collisions(&mut self, tick: u32) -> u64 {
        let now = u64::from(tick) * u64::from(UNIT);
        let mut collisions = 0;
        for body in &self.bodies {
            let is_open = |at: &usize| self.terrain.cells()[*at] != BLOCKED || body.is_shut_in;
            let at = self.terrain.index(body.cell).filter(is_open);
            let word = at.map(|at| (&mut self.seen[at / 64], 1 << (at % 64)));
            match word {
                Some((word, bit)) if *word & bit == 0 => *word |= bit,
                _ => collisions += 1,
            }
        }
        for at in self.bodies.iter().filter_map(|body| self.terrain.index(body.cell)) {
            self.seen[at / 64] = 0;
        }
        // Diagonals through one point: both lie in the four cells north-east of the same cell.
        let corner = |body: &Body| {
            let from = body.cell - body.diagonal(now).offset();
            self.terrain.index(Cell::new(from.x.min(body.cell.x), from.y.min(body.cell.y)))
        };
        let diagonals = || self.bodies.iter().filter(|body| body.diagonal(now) != Dir::Stay).filter_map(corner);
        for at in diagonals() {
            let (word, bit) = (&mut self.seen[at / 64], 1 << (at % 64));
            collisions += u64::from(*word & bit != 0);
            *word |= bit;
        }
        for at in diagonals() {
            self.seen[at / 64] = 0;
        }
        collisions
    }
}

/// A body inside a cell keeps the crossing time that it entered with.
fn set_cell(terrain: &mut Terrain, cell: Cell, class: u8, is_taken: bool) -> Result<(), Refusal> {
    if terrain.index(cell).is_none() {
        let what = format!("({}, {}) is outside the map", cell.x, cell.y);
        return Err(Refusal::new(
            "cell",
            what,
            format!("give a cell of the map of {} x {} cells", terrain.width(), terrain.height()),
        ));
    }
    if is_taken {
        return Err(Refusal::new("cell", "a robot is there", "wait until it has left, or take another cell"));
    }
    terrain.set(cell, class);
    Ok(())
}

#[cfg(test)]
mod tests;
