//! Moves on the grid near the borders between MPI ranks.
//!
//! Whether a robot may move depends on the moves before it by priority, a chain that may cross
//! borders several times. A rank therefore gets the bodies of other ranks within [`DEPTH`] cells
//! with their preferred moves, processes all by priority, and leaves moves undecided that depend on
//! bodies farther away. While any move in the world is undecided, ranks exchange their decisions
//! and start another round, which decides at least the first undecided move; usually one round
//! suffices. Refused bodies then try again, in another pass. The result is that of
//! [`World::advance`] for any partition.

use super::{Body, PRIORITY, World};
use serde::{Deserialize, Serialize};
use staya_controller::agent::Command;
use staya_controller::grid::{Cell, Dir, UNIT};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use std::collections::HashMap;

/// Distance in cells up to which a rank knows the bodies of others. At least 2, because bodies two
/// cells apart compete for a cell; a larger value costs bytes and leaves fewer moves undecided.
pub const DEPTH: i16 = 8;

/// Occupancy mark: not decided yet.
const OPEN: u32 = u32::MAX;
/// Marks a body of another rank.
const BESIDE: u32 = 1 << 31;

const NOWHERE: Cell = Cell::new(-1, -1);

/// A rectangle of cells, both corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellBounds {
    pub(crate) low: Cell,
    pub(crate) high: Cell,
}

impl CellBounds {
    /// Smallest rectangle around `cells`; `None` if there are none.
    pub fn around(cells: impl Iterator<Item = Cell>) -> Option<Self> {
        cells.fold(None, |bounds: Option<Self>, cell| {
            let Self { low, high } = bounds.unwrap_or(Self { low: cell, high: cell });
            Some(Self {
                low: Cell::new(low.x.min(cell.x), low.y.min(cell.y)),
                high: Cell::new(high.x.max(cell.x), high.y.max(cell.y)),
            })
        })
    }

    /// Chebyshev distance of a cell; 0 inside.
    pub(crate) fn distance(&self, cell: Cell) -> i32 {
        self.distance_to(&Self { low: cell, high: cell })
    }

    /// Chebyshev distance to another rectangle; 0 if they overlap.
    pub fn distance_to(&self, other: &Self) -> i32 {
        let off = |low: i16, high: i16, other_low: i16, other_high: i16| {
            (i32::from(low) - i32::from(other_high)).max(i32::from(other_low) - i32::from(high))
        };
        let x = off(self.low.x, self.high.x, other.low.x, other.high.x);
        let y = off(self.low.y, self.high.y, other.low.y, other.high.y);
        x.max(y).max(0)
    }
}

/// A body of another rank with its preferred moves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Beside {
    pub(crate) id: RobotId,
    pub(crate) cell: Cell,
    /// The diagonal move by which it is entering its cell.
    pub(crate) diagonal: Dir,
    pub(crate) wish: Option<heapless::Vec<Dir, 8>>,
}

/// Decided move of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settled {
    pub(crate) id: RobotId,
    pub(crate) by: Dir,
}

#[derive(Clone)]
struct Mover {
    priority: u64,
    id: RobotId,
    /// Index of the body: here, or in another rank if [`BESIDE`] is set.
    body: u32,
    cell: Cell,
    wish: heapless::Vec<Dir, 8>,
    /// Whether all bodies that can affect its move are known.
    is_seen: bool,
    by: Option<Dir>,
    is_told: bool,
}

impl Mover {
    /// No preferred cell was free.
    fn is_refused(&self) -> bool {
        self.by == Some(Dir::Stay) && !self.wish.contains(&Dir::Stay)
    }

    const fn mark(&self) -> u32 {
        if self.body & BESIDE == 0 { self.body + 1 } else { self.body }
    }
}

/// Moves of one tick, until all are decided.
pub struct Contest {
    now: u64,
    /// All attempts, in their order.
    movers: Vec<Mover>,
    /// Attempts before those of this pass.
    past: usize,
    beside: HashMap<RobotId, usize>,
    cells: Vec<Cell>,
    before: Vec<(usize, u32)>,
    /// Diagonal moves that are under way: of the bodies of this rank, then of other ranks.
    diagonals: Diagonals,
}

struct Diagonals {
    all: Vec<Dir>,
    own: usize,
}

impl Diagonals {
    /// Place of the body with an occupancy mark.
    const fn place(&self, mark: u32) -> usize {
        if mark & BESIDE == 0 { mark as usize - 1 } else { self.own + (mark & !BESIDE) as usize }
    }
}

impl World {
    /// Bodies within `depth` cells of `bounds`, with their preferred moves if `commands` are given.
    pub fn near(&self, tick: u32, bounds: &CellBounds, depth: i16, commands: Option<&[Command<f32>]>) -> Vec<Beside> {
        let now = u64::from(tick) * u64::from(UNIT);
        let near = self.bodies.iter().enumerate().filter(|(_, body)| bounds.distance(body.cell) <= i32::from(depth));
        near.map(|(index, body)| {
            let wish = match commands.map(|commands| &commands[index]) {
                Some(Command::Move(wish)) if body.free_at <= now && !wish.is_empty() => Some(wish.clone()),
                _ => None,
            };
            Beside { id: body.id, cell: body.cell, diagonal: body.diagonal(now), wish }
        })
        .collect()
    }

    /// Begins the moves of a tick. `beside` contains all bodies of other ranks within [`DEPTH`]
    /// cells of `own`, the bounds of the bodies of this rank.
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
                && !wish.is_empty()
            {
                movers.push(mover(body.id, index as u32, body.cell, wish.clone(), true));
            }
        }
        let cells = beside.iter().map(|body| body.cell).collect();
        let mut marks = Vec::with_capacity(beside.len());
        let mut diagonals: Vec<_> = self.bodies.iter().map(|body| body.diagonal(now)).collect();
        for (number, Beside { id, cell, diagonal, wish }) in (0..).zip(beside) {
            marks.push((cell, number | BESIDE));
            diagonals.push(diagonal);
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
        let diagonals = Diagonals { all: diagonals, own: self.bodies.len() };
        let mut contest =
            Contest { now, movers, past: 0, beside: HashMap::new(), cells, before: Vec::new(), diagonals };
        contest.note_beside();
        contest
    }

    /// Keeps only the bodies with the indices `here`, in this order.
    pub fn keep(&mut self, here: &[u32]) {
        self.bodies = here.iter().map(|&index| self.bodies[index as usize]).collect();
        // Fresh memory: pages of the map without bodies stay untouched.
        self.occupancy = vec![0; self.terrain.cells().len()];
        for (mark, body) in (1..).zip(&self.bodies) {
            if let Some(at) = self.terrain.index(body.cell) {
                self.occupancy[at] = mark;
            }
        }
    }

    /// Appends a body that comes from another rank; `World::put` sets its position.
    pub fn admit(&mut self, id: RobotId) {
        self.bodies.push(Body::at_rest(id, NOWHERE));
    }

    /// Removes a body that goes to another rank; the last body takes its index.
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

    /// Collisions that [`World::count_collisions`] cannot see: cells shared with a body of another
    /// rank, counted by this rank if the other body has a lower id than all bodies here, and
    /// crossed diagonal moves, counted by the rank of the body with the higher id.
    pub fn count_collisions_beside(&self, tick: u32, beside: &[Beside]) -> u64 {
        let now = u64::from(tick) * u64::from(UNIT);
        let diagonal = |other: &&Beside| other.diagonal != Dir::Stay;
        let diagonals: HashMap<_, _> = beside.iter().filter(diagonal).map(|other| (other.cell, other)).collect();
        let crossed = |body: &&Body| {
            let (dir, from) = (body.diagonal(now), body.cell - body.diagonal(now).offset());
            let ends = [Cell::new(from.x, body.cell.y), Cell::new(body.cell.x, from.y)];
            let others = ends.iter().filter_map(|end| diagonals.get(end));
            others.filter(|other| other.id < body.id).any(|other| dir.crosses(from, other.diagonal, other.cell))
        };
        let crossed = if diagonals.is_empty() { 0 } else { self.bodies.iter().filter(crossed).count() as u64 };
        let mut least = HashMap::<Cell, RobotId>::new();
        for other in beside.iter().filter(|other| self.terrain.is_passable(other.cell)) {
            let id = least.entry(other.cell).or_insert(other.id);
            *id = other.id.min(*id);
        }
        if least.is_empty() {
            return crossed;
        }
        let mut own = HashMap::<Cell, RobotId>::new();
        for body in self.bodies.iter().filter(|body| least.contains_key(&body.cell)) {
            let id = own.entry(body.cell).or_insert(body.id);
            *id = body.id.min(*id);
        }
        crossed + own.iter().filter(|(cell, id)| least[cell] < **id).count() as u64
    }

    /// Index and occupancy of the next cell; `None` if the terrain does not allow the move.
    fn at_end_of(&self, from: Cell, dir: Dir) -> Option<(usize, u32)> {
        let at = self.terrain.index(from + dir.offset()).filter(|_| self.is_passable(from, dir))?;
        Some((at, self.occupancy[at]))
    }

    /// Whether a move crosses a diagonal that is under way; `None` if it depends on an undecided
    /// move.
    fn is_crossed(&self, from: Cell, dir: Dir, diagonals: &Diagonals) -> Option<bool> {
        let mut is_open = false;
        for side in self.sides(from, dir) {
            match self.terrain.index(side).map_or(0, |at| self.occupancy[at]) {
                0 => {}
                OPEN => is_open = true,
                mark if dir.crosses(from, diagonals.all[diagonals.place(mark)], side) => return Some(true),
                _ => {}
            }
        }
        (!is_open).then_some(false)
    }
}

impl Contest {
    fn note_beside(&mut self) {
        let others = self.movers.iter().enumerate().skip(self.past);
        let others = others.filter(|(_, mover)| mover.body & BESIDE != 0);
        self.beside = others.map(|(at, mover)| (mover.id, at)).collect();
    }

    /// Whether own bodies moved in this pass, and whether own bodies were refused. All moves of the
    /// pass must be decided.
    pub fn result(&self) -> [bool; 2] {
        let own = || self.movers[self.past..].iter().filter(|mover| mover.body & BESIDE == 0);
        [own().any(|mover| !mover.is_refused()), own().any(Mover::is_refused)]
    }

    /// Starts the next pass: refused bodies try again.
    pub fn retry(&mut self) {
        let again = self.movers[self.past..].iter().filter(|mover| mover.is_refused());
        let again: Vec<_> = again.map(|mover| Mover { by: None, is_told: false, ..mover.clone() }).collect();
        self.past = self.movers.len();
        self.movers.extend(again);
        self.note_beside();
    }

    /// Processes all moves by priority. Returns the number of undecided moves of this rank.
    pub fn round(&mut self, world: &mut World) -> u64 {
        let mut open = 0;
        for mover in &mut self.movers {
            let Some(from) = world.terrain.index(mover.cell) else {
                continue;
            };
            if mover.by.is_none() && mover.is_seen {
                mover.by = choose(world, &self.diagonals, mover.cell, &mover.wish);
            }
            let mut set = |at: usize, mark: u32| {
                self.before.push((at, world.occupancy[at]));
                world.occupancy[at] = mark;
            };
            match mover.by {
                Some(Dir::Stay) => {}
                Some(by) => {
                    let mark = mover.mark();
                    let to = world.terrain.index(mover.cell + by.offset());
                    set(from, 0);
                    if let Some(to) = to {
                        set(to, mark);
                    }
                    if by.is_diagonal() {
                        let place = self.diagonals.place(mark);
                        self.diagonals.all[place] = by;
                    }
                }
                None => {
                    open += u64::from(mover.body & BESIDE == 0);
                    set(from, OPEN);
                    for &dir in mover.wish.iter().take_while(|&&dir| dir != Dir::Stay) {
                        let crossed = world.is_crossed(mover.cell, dir, &self.diagonals);
                        if let (Some((at, 0)), Some(false) | None) = (world.at_end_of(mover.cell, dir), crossed) {
                            self.before.push((at, 0));
                            world.occupancy[at] = OPEN;
                            // All competitors are known, so it stops here at the latest.
                            if mover.is_seen && crossed == Some(false) {
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
        for mover in &self.movers {
            let place = self.diagonals.place(mover.mark());
            self.diagonals.all[place] = Dir::Stay;
        }
        open
    }

    /// Own decisions since the last [`Contest::tell`] about bodies within [`DEPTH`] cells of
    /// `bounds`.
    pub fn settled(&self, bounds: &CellBounds) -> Vec<Settled> {
        let own = self.movers.iter().filter(|mover| mover.body & BESIDE == 0 && !mover.is_told);
        let near = own.filter(|mover| bounds.distance(mover.cell) <= i32::from(DEPTH));
        near.filter_map(|mover| Some(Settled { id: mover.id, by: mover.by? })).collect()
    }

    /// Marks all decisions as sent.
    pub fn tell(&mut self) {
        for mover in &mut self.movers {
            mover.is_told = mover.by.is_some();
        }
    }

    /// Applies decisions of other ranks.
    pub fn hear(&mut self, settled: &[Settled]) {
        for Settled { id, by } in settled {
            if let Some(&at) = self.beside.get(id) {
                self.movers[at].by = Some(*by);
            }
        }
    }

    /// Moves the bodies of this rank and removes those of other ranks.
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

/// First preferred open move; `None` if it depends on an undecided move.
fn choose(world: &World, diagonals: &Diagonals, from: Cell, wish: &[Dir]) -> Option<Dir> {
    for &dir in wish {
        if dir == Dir::Stay {
            return Some(Dir::Stay);
        }
        match world.at_end_of(from, dir) {
            Some((_, 0)) => match world.is_crossed(from, dir, diagonals) {
                Some(true) => {}
                crossed => return crossed.map(|_| dir),
            },
            Some((_, OPEN)) => return None,
            _ => {}
        }
    }
    Some(Dir::Stay)
}

#[cfg(test)]
mod tests;
