//! Moves on the grid when other ranks have the bodies beyond a border.
//!
//! Who enters a cell depends on who left it before, in the order of the tick's priorities: a chain that may cross a border
//! more than once. A rank therefore knows the bodies of others within [`DEPTH`] cells and what they want, goes through all in the
//! order of priorities, and leaves open what depends on somebody farther off. While anybody in the world is open, ranks tell each
//! other what they have settled and go through it again. The first one that is open, by priority, is settled in each round, since
//! all before it are; nearly always the first round settles all. The result is that of [`World::advance`], whatever the cut.

use super::{Body, PRIORITY, World};
use serde::{Deserialize, Serialize};
use staya_controller::agent::Command;
use staya_controller::grid::{Cell, Dir, UNIT};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use std::collections::HashMap;

/// How far beyond its own bodies a rank looks, cells; at least 2, for who wants to go where a body wants to go. More takes more bytes
/// and leaves less open.
pub const DEPTH: i16 = 8;

/// Nobody knows yet whether somebody is in the cell.
const OPEN: u32 = u32::MAX;
/// Marks a body of another rank.
const BESIDE: u32 = 1 << 31;

/// On no map.
const NOWHERE: Cell = Cell::new(-1, -1);

/// A rectangle of cells, both corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellBounds {
    pub(crate) low: Cell,
    pub(crate) high: Cell,
}

impl CellBounds {
    /// The least one around cells; `None` around none.
    pub fn around(cells: impl Iterator<Item = Cell>) -> Option<Self> {
        cells.fold(None, |bounds: Option<Self>, cell| {
            let Self { low, high } = bounds.unwrap_or(Self { low: cell, high: cell });
            Some(Self {
                low: Cell::new(low.x.min(cell.x), low.y.min(cell.y)),
                high: Cell::new(high.x.max(cell.x), high.y.max(cell.y)),
            })
        })
    }

    /// How far off a cell is, as a king goes; 0: in it.
    pub(crate) fn distance(&self, cell: Cell) -> i32 {
        self.distance_to(&Self { low: cell, high: cell })
    }

    /// How far off another one is; 0: they have a cell in common.
    pub fn distance_to(&self, other: &Self) -> i32 {
        let off = |low: i16, high: i16, other_low: i16, other_high: i16| {
            (i32::from(low) - i32::from(other_high)).max(i32::from(other_low) - i32::from(high))
        };
        let x = off(self.low.x, self.high.x, other.low.x, other.high.x);
        let y = off(self.low.y, self.high.y, other.low.y, other.high.y);
        x.max(y).max(0)
    }
}

/// A body of another rank, and what it wants.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Beside {
    pub(crate) id: RobotId,
    pub(crate) cell: Cell,
    /// Its preferred moves, if it may leave its cell in this tick.
    pub(crate) wish: Option<heapless::Vec<Dir, 8>>,
}

/// What a body does in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settled {
    pub(crate) id: RobotId,
    pub(crate) by: Dir,
}

/// Somebody who wants to move.
struct Mover {
    priority: u64,
    id: RobotId,
    /// A body here, or one of those beside with [`BESIDE`].
    body: u32,
    cell: Cell,
    wish: heapless::Vec<Dir, 8>,
    /// Whether everybody who matters to it is known.
    is_seen: bool,
    by: Option<Dir>,
    is_told: bool,
}

/// The moves of one tick, until all are settled.
pub struct Contest {
    now: u64,
    movers: Vec<Mover>,
    /// Where those beside are in `movers`.
    beside: HashMap<RobotId, usize>,
    /// The cells of all that are beside.
    cells: Vec<Cell>,
    /// What cells held before this round.
    before: Vec<(usize, u32)>,
}

impl World {
    /// The bodies within `depth` cells of `bounds`, with what they are told; without `commands`, with nothing.
    pub fn near(&self, tick: u32, bounds: &CellBounds, depth: i16, commands: Option<&[Command<f32>]>) -> Vec<Beside> {
        let now = u64::from(tick) * u64::from(UNIT);
        let near = self.bodies.iter().enumerate().filter(|(_, body)| bounds.distance(body.cell) <= i32::from(depth));
        near.map(|(index, body)| {
            let wish = match commands.map(|commands| &commands[index]) {
                Some(Command::Move(wish)) if body.free_at <= now => Some(wish.clone()),
                _ => None,
            };
            Beside { id: body.id, cell: body.cell, wish }
        })
        .collect()
    }

    /// Begins the moves of a tick among bodies of others: all of them that are within [`DEPTH`] cells of `own`, which holds all bodies
    /// that are here.
    pub fn contest(
        &mut self,
        tick: u32,
        commands: &[Command<f32>],
        own: Option<&CellBounds>,
        beside: Vec<Beside>,
    ) -> Contest {
        let now = u64::from(tick) * u64::from(UNIT);
        let priority = |id: RobotId| Rng::keyed(self.seed, PRIORITY, id.0, tick).next_u64();
        let mover = |id, body, cell, wish, is_seen| Mover {
            priority: priority(id),
            id,
            body,
            cell,
            wish,
            is_seen,
            by: None,
            is_told: false,
        };
        let mut movers = Vec::new();
        for (index, (body, command)) in self.bodies.iter().zip(commands).enumerate() {
            if let Command::Move(wish) = command
                && body.free_at <= now
            {
                movers.push(mover(body.id, index as u32, body.cell, wish.clone(), true));
            }
        }
        let cells = beside.iter().map(|body| body.cell).collect();
        let mut marks = Vec::with_capacity(beside.len());
        for (number, Beside { id, cell, wish }) in (0..).zip(beside) {
            marks.push((cell, number | BESIDE));
            if let Some(wish) = wish {
                let is_seen = own.is_some_and(|own| own.distance(cell) <= i32::from(DEPTH) - 2);
                movers.push(mover(id, number | BESIDE, cell, wish, is_seen));
            }
        }
        for (cell, mark) in marks {
            if let Some(at) = self.terrain.index(cell) {
                self.occupancy[at] = mark;
            }
        }
        movers.sort_unstable_by_key(|mover| (mover.priority, mover.id));
        let others = movers.iter().enumerate().filter(|(_, mover)| mover.body & BESIDE != 0);
        let beside = others.map(|(at, mover)| (mover.id, at)).collect();
        Contest { now, movers, beside, cells, before: Vec::new() }
    }

    /// Keeps these bodies alone, by their places, in this order.
    pub fn keep(&mut self, here: &[u32]) {
        self.bodies = here.iter().map(|&index| self.bodies[index as usize]).collect();
        // New memory: pages of the map that nobody here comes to are never touched.
        self.occupancy = vec![0; self.terrain.cells().len()];
        for (mark, body) in (1..).zip(&self.bodies) {
            if let Some(at) = self.terrain.index(body.cell) {
                self.occupancy[at] = mark;
            }
        }
    }

    /// A body comes from another rank, behind those that are here; where it is, [`World::put`] has to say.
    pub fn admit(&mut self, id: RobotId) {
        self.bodies.push(Body::at_rest(id, NOWHERE));
    }

    /// A body goes to another rank; the last one takes its place.
    pub fn dismiss(&mut self, index: usize) {
        let body = self.bodies.swap_remove(index);
        if let Some(at) = self.terrain.index(body.cell) {
            self.occupancy[at] = 0;
        }
        if let Some(moved) = self.bodies.get(index)
            && let Some(at) = self.terrain.index(moved.cell)
        {
            self.occupancy[at] = index as u32 + 1;
        }
    }

    /// What [`World::count_collisions`] does not see: cells that a body of another rank has, too, before all that are here.
    pub fn count_collisions_beside(&self, beside: &[Beside]) -> u64 {
        let mut least = HashMap::<Cell, RobotId>::new();
        for other in beside.iter().filter(|other| self.terrain.is_passable(other.cell)) {
            let id = least.entry(other.cell).or_insert(other.id);
            *id = other.id.min(*id);
        }
        if least.is_empty() {
            return 0;
        }
        let mut own = HashMap::<Cell, RobotId>::new();
        for body in self.bodies.iter().filter(|body| least.contains_key(&body.cell)) {
            let id = own.entry(body.cell).or_insert(body.id);
            *id = body.id.min(*id);
        }
        own.iter().filter(|(cell, id)| least[cell] < **id).count() as u64
    }

    /// Whether a body in `from` may move by `dir`, if nobody is there; who is.
    fn at_end_of(&self, from: Cell, dir: Dir) -> Option<(usize, u32)> {
        let to = from + dir.offset();
        let passable = |x, y| self.terrain.is_passable(Cell::new(x, y));
        let may = self.terrain.is_passable(to)
            && (self.rules.corner_cutting || !dir.is_diagonal() || (passable(to.x, from.y) && passable(from.x, to.y)));
        let at = self.terrain.index(to).filter(|_| may)?;
        Some((at, self.occupancy[at]))
    }
}

impl Contest {
    /// Goes through all in order. Returns how many that are here are still open.
    pub fn round(&mut self, world: &mut World) -> u64 {
        let mut open = 0;
        for mover in &mut self.movers {
            let Some(from) = world.terrain.index(mover.cell) else {
                continue;
            };
            if mover.by.is_none() && mover.is_seen {
                mover.by = choose(world, mover.cell, &mover.wish);
            }
            let mut set = |at: usize, mark: u32| {
                self.before.push((at, world.occupancy[at]));
                world.occupancy[at] = mark;
            };
            match mover.by {
                Some(Dir::Stay) => {}
                Some(by) => {
                    let mark = if mover.body & BESIDE == 0 { mover.body + 1 } else { mover.body };
                    let to = world.terrain.index(mover.cell + by.offset());
                    set(from, 0);
                    if let Some(to) = to {
                        set(to, mark);
                    }
                }
                None => {
                    open += u64::from(mover.body & BESIDE == 0);
                    set(from, OPEN);
                    for &dir in mover.wish.iter().take_while(|&&dir| dir != Dir::Stay) {
                        if let Some((at, 0)) = world.at_end_of(mover.cell, dir) {
                            self.before.push((at, 0));
                            world.occupancy[at] = OPEN;
                            // At worst it goes here.
                            if mover.is_seen {
                                break;
                            }
                        }
                    }
                }
            }
        }
        while let Some((at, mark)) = self.before.pop() {
            world.occupancy[at] = mark;
        }
        open
    }

    /// What has been settled here since this was last asked of anybody within [`DEPTH`] cells of others' bounds.
    pub fn settled(&self, bounds: &CellBounds) -> Vec<Settled> {
        let own = self.movers.iter().filter(|mover| mover.body & BESIDE == 0 && !mover.is_told);
        let near = own.filter(|mover| bounds.distance(mover.cell) <= i32::from(DEPTH));
        near.filter_map(|mover| Some(Settled { id: mover.id, by: mover.by? })).collect()
    }

    /// All that is settled has been told.
    pub fn tell(&mut self) {
        for mover in &mut self.movers {
            mover.is_told = mover.by.is_some();
        }
    }

    /// What was settled elsewhere.
    pub fn hear(&mut self, settled: &[Settled]) {
        for Settled { id, by } in settled {
            if let Some(&at) = self.beside.get(id) {
                self.movers[at].by = Some(*by);
            }
        }
    }

    /// Moves the bodies that are here, and forgets the others.
    pub fn finish(self, world: &mut World) {
        for at in self.cells.into_iter().filter_map(|cell| world.terrain.index(cell)) {
            world.occupancy[at] = 0;
        }
        let moved = |mover: &Mover| match mover.by {
            Some(by) if by != Dir::Stay && mover.body & BESIDE == 0 => Some((mover.body as usize, by)),
            _ => None,
        };
        for (index, _) in self.movers.iter().filter_map(moved) {
            if let Some(at) = world.terrain.index(world.bodies[index].cell) {
                world.occupancy[at] = 0;
            }
        }
        for (index, by) in self.movers.iter().filter_map(moved) {
            let body: Body = world.entered(&world.bodies[index], by, self.now);
            if let Some(at) = world.terrain.index(body.cell) {
                world.occupancy[at] = index as u32 + 1;
            }
            world.bodies[index] = body;
        }
    }
}

/// The first preferred move whose cell is free; `None`: that depends on who is not settled.
fn choose(world: &World, from: Cell, wish: &[Dir]) -> Option<Dir> {
    for &dir in wish {
        if dir == Dir::Stay {
            return Some(Dir::Stay);
        }
        match world.at_end_of(from, dir) {
            Some((_, 0)) => return Some(dir),
            Some((_, OPEN)) => return None,
            _ => {}
        }
    }
    Some(Dir::Stay)
}

#[cfg(test)]
mod tests;
