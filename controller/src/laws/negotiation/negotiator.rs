//! A robot that negotiates: what it knows of land and robots, from step to step.

mod known;
mod report;
mod sensed;

use super::area::{Area, Sight};
use super::distance::{Distances, Nearby};
use super::moves::Moves;
use super::plan::{Member, Plan};
use super::wish::{Manners, Wish};
use crate::fixint;
use crate::grid::{Cell, Dir};
use crate::list;
use crate::rand::Rng;
use crate::robot::RobotId;
use heapless::Vec;
use known::{Known, linked};
use serde::{Deserialize, Serialize};

pub use report::{REPORTED, Report};
pub use sensed::Sensed;

/// Distance up to which robots plan together, cells.
pub const RANGE: u32 = 8;
/// Cells between two robots up to which one can be in the other's way in this step.
pub(super) const LINK: u32 = 2;
/// Cells to a robot whose silence shows that packets are lost.
const CLOSE: u32 = 4;
/// Shares of missed beacons, 256ths: from the second one on, each packet is sent twice, until it
/// falls below the first one.
const NOISY: [u8; 2] = [3, 25];
/// Steps after which a robot whose place is not known is forgotten.
const FORGET: u8 = 6;
/// The greatest [`Said::waiting`], which takes 12 bits on the air.
pub const MOST_WAITING: u16 = 4095;
/// Steps of a robot to and fro, or without the move that it planned, that are a stalemate.
const STALEMATE: u8 = 2;
/// Steps in which a robot that lost its moves goes last or not.
const COURTESY: u32 = 4;
/// Refusals in a row, without a word of a robot there, after which a cell counts as blocked.
const REFUSALS: u8 = 4;
const PURPOSE: u32 = u32::from_be_bytes(*b"mann");

/// A robot's report on itself in each step, before it decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Said {
    /// Where it is.
    #[serde(with = "fixint")]
    pub cell: Cell,
    /// Where it wants to go.
    #[serde(with = "fixint")]
    pub goal: Cell,
    /// Steps since it last stood on its goal, plus 1; at most [`MOST_WAITING`].
    #[serde(with = "fixint")]
    pub waiting: u16,
    /// Which cells around it it wants to enter.
    pub wish: Wish,
    /// Its steps so far, modulo 256.
    pub step: u8,
    /// How it behaves in this step.
    pub manners: Manners,
}

/// A robot that plans with the robots near it: at most `N` with itself.
///
/// In each step: [`see`](Self::see), send what that returns, [`hear`](Self::hear) the others, send
/// a [`report`](Self::report), [`hear_report`](Self::hear_report) the others, and
/// [`decide`](Self::decide). Without reports, robots know only the land that they have seen. A step
/// ends when it decides; all but that may come repeatedly and in any order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Negotiator<const N: usize> {
    id: RobotId,
    goal: Cell,
    /// Its report; its goal is its own cell where it stays beside its goal.
    own: Said,
    sight: Sight,
    moves: Moves,
    /// Where it was in the last step and in the one before.
    past: [Cell; 2],
    /// The move that it chose.
    chosen: Dir,
    /// Times in a row that it came back to where it was two steps before, and that it did not get
    /// the cell that it chose.
    swung: u8,
    refused: u8,
    /// The cell that it did not get, and how often in a row without a word of a robot there.
    barred: (Cell, u8),
    /// How it behaves after its view of this step, and how it promised to behave.
    manners: Manners,
    promised: Option<Manners>,
    /// As in [`Member::leaves_by`], in this step.
    leaves_by: Option<Dir>,
    /// Whether anything of this step came, and whether it saw its cell in this step.
    has_begun: bool,
    has_seen: bool,
    /// It could not decide in the last step, because it was on its way.
    is_busy: bool,
    is_priced: bool,
    /// Share of the close robots that it does not hear, 256ths, and whether that is too much.
    missed: u8,
    is_noisy: bool,
    area: Area,
    known: Vec<Known, N>,
    /// Reported robots that it does not know: the lowest byte of the number, and the cell.
    strangers: Vec<(u8, Cell), N>,
    #[serde(skip)]
    distances: Distances,
}

impl<const N: usize> Negotiator<N> {
    /// A robot at its goal, which knows nothing.
    #[must_use]
    pub const fn new(id: RobotId, cell: Cell, moves: Moves) -> Self {
        let manners = Manners { is_last: false, keeps_on: false };
        Self {
            id,
            goal: cell,
            own: Said { cell, goal: cell, waiting: 1, wish: Wish::CLOSED, step: 0, manners },
            sight: Sight([0; 16]),
            moves,
            past: [cell; 2],
            chosen: Dir::Stay,
            swung: 0,
            refused: 0,
            barred: (cell, 0),
            manners,
            promised: None,
            leaves_by: None,
            has_begun: false,
            has_seen: false,
            is_busy: false,
            is_priced: false,
            missed: 0,
            is_noisy: false,
            area: Area::new(cell),
            known: Vec::new(),
            strangers: Vec::new(),
            distances: Distances::EMPTY,
        }
    }

    /// Gives it a goal. It waits behind others that have waited longer.
    pub const fn set_goal(&mut self, goal: Cell) {
        self.goal = goal;
        self.own.goal = goal;
        self.own.waiting = 0;
    }

    /// Numbers the step that it sees next, for robots that count their steps together.
    pub const fn set_step(&mut self, step: u8) {
        self.own.step = step.wrapping_sub(1);
    }

    /// Where it wants to go.
    #[must_use]
    pub const fn goal(&self) -> Cell {
        self.goal
    }

    /// Where it was in the last step.
    #[must_use]
    pub const fn cell(&self) -> Cell {
        self.own.cell
    }

    /// Sets whether [`set_wish`](Self::set_wish) gives its wishes, so that it searches for none.
    pub const fn set_priced(&mut self, is_priced: bool) {
        self.is_priced = is_priced;
    }

    /// Replaces its wish in this step.
    pub const fn set_wish(&mut self, wish: Wish) {
        self.own.wish = wish;
    }

    /// Cells to the nearest robot that it knows of; `None` if it is alone. O(N).
    #[must_use]
    pub fn nearest(&self) -> Option<u32> {
        self.others().map(|cell| cell.chebyshev(self.own.cell)).min()
    }

    /// Whether each packet should be sent twice, because many are lost.
    #[must_use]
    pub const fn is_noisy(&self) -> bool {
        self.is_noisy
    }

    /// Follows the share of packets that are lost: those of the last steps count most. O(N).
    fn listen(&mut self) {
        let (close, own) = (&self.known, self.own.cell);
        let close = close.iter().filter(|other| other.lost <= FORGET && other.said.cell.chebyshev(own) <= CLOSE);
        let (missed, all) = close.fold((0_u16, 0), |(missed, all), other| (missed + u16::from(other.age > 0), all + 1));
        if let Some(share) = missed.saturating_mul(255).checked_div(all) {
            self.missed = (u16::from(self.missed).saturating_mul(7).saturating_add(share) >> 3) as u8;
            let [least, most] = NOISY;
            self.is_noisy = self.missed >= if self.is_noisy { least } else { most };
        }
    }

    /// Whether others can use its report: of the way among walls, and of robots, as packets are
    /// lost. O(N).
    #[must_use]
    pub fn has_news(&self) -> bool {
        let is_missed = |other: &Known| {
            let cells = other.said.cell.chebyshev(self.own.cell);
            (1..=FORGET).contains(&other.age) && cells <= CLOSE
        };
        !self.is_priced || self.known.iter().any(is_missed)
    }

    /// The cells of the robots that it knows of.
    pub fn others(&self) -> impl Iterator<Item = Cell> + Clone {
        let known = self.known.iter().filter(|other| other.lost <= FORGET).map(|other| other.said.cell);
        known.chain(self.strangers.iter().map(|&(_, cell)| cell))
    }

    /// Chooses a move without a plan, because no robot can be in its way.
    pub fn go(&mut self, dir: Dir) {
        self.begin();
        (self.has_begun, self.has_seen, self.is_busy) = (false, false, false);
        self.known.retain(|other| other.lost <= FORGET && other.said.cell.chebyshev(self.own.cell) <= RANGE);
        self.chosen = dir;
    }

    /// Whether it stays beside its goal, which another robot does not leave.
    #[must_use]
    pub fn is_beside_goal(&self) -> bool {
        self.own.goal != self.goal
    }

    /// Where it wants to be if it is in a cell: beside a goal that is closed, it stays there.
    fn aim(&self, cell: Cell) -> Cell {
        let stays = cell.chebyshev(self.goal) == 1 && self.area.is_blocked(self.goal);
        if stays { cell } else { self.goal }
    }

    /// Sees its cell and the land around it. Returns what to say.
    pub fn see(&mut self, cell: Cell, sight: &Sight) -> Said {
        self.area.follow(cell);
        self.area.learn(cell, sight);
        self.be_at(cell, sight)
    }

    /// [`Self::see`] for a robot that does not look at the land, because it needs it for no plan.
    pub fn pass(&mut self, cell: Cell) -> Said {
        self.area.follow(cell);
        self.be_at(cell, &Sight::default())
    }

    fn be_at(&mut self, cell: Cell, sight: &Sight) -> Said {
        self.begin();
        self.sight = *sight;
        if !self.has_seen {
            self.has_seen = true;
            self.own.goal = self.aim(cell);
            self.own.waiting = waiting(cell == self.own.goal, self.own.waiting);
            self.own.step = self.own.step.wrapping_add(1);
            self.area.pass();
            if !self.is_busy {
                self.manners = self.manners(cell, self.own.step);
            }
            self.own.manners = self.promised.unwrap_or(self.manners);
        }
        self.own = Said { cell, wish: self.wish(cell, self.own.goal), ..self.own };
        self.own
    }

    fn wish(&mut self, cell: Cell, goal: Cell) -> Wish {
        if self.is_priced {
            return Wish::CLOSED;
        }
        if !self.distances.is_for(goal, &self.area) {
            self.distances.search(goal, &self.area, self.moves.diagonals);
        }
        Wish::new((cell, goal), &self.area, |a, b| self.distances.compare(a, b), self.moves)
    }

    /// The report after a decision, before the next step: its next cell.
    pub fn promise(&mut self) -> Said {
        self.promise_of(self.chosen)
    }

    /// The report instead of a [`promise`](Self::promise) if it does not move after all.
    pub fn stay(&mut self) -> Said {
        self.promise_of(Dir::Stay)
    }

    fn promise_of(&mut self, dir: Dir) -> Said {
        let Said { cell, waiting, step, .. } = self.own;
        let cell = cell + dir.offset();
        let goal = self.aim(cell);
        let (waiting, step) = (self::waiting(cell == goal, waiting), step.wrapping_add(1));
        self.promised = Some(self.manners);
        Said { cell, goal, waiting, wish: self.wish(cell, goal), step, manners: self.manners }
    }

    fn begin(&mut self) {
        if core::mem::replace(&mut self.has_begun, true) {
            return;
        }
        for other in &mut self.known {
            other.age = other.age.saturating_add(1);
            other.lost = other.lost.saturating_add(1);
            other.holds = false;
            other.busy = other.busy.saturating_sub(1);
            other.leaves_by = None;
            let said = &mut other.said;
            said.step = said.step.wrapping_add(1);
            said.waiting = waiting(said.cell == said.goal, said.waiting);
            said.manners = Manners::default();
        }
        self.strangers.clear();
    }

    /// A robot that swings to and fro in a corridor pushes on in half of its steps. One that is
    /// refused the cells that it chooses, because others know other robots, goes last in half of
    /// its steps.
    fn manners(&mut self, cell: Cell, step: u8) -> Manners {
        let [last, before] = self.past;
        let (swings, waits) = (cell == before && cell != last, cell == last && !self.moves.circles);
        self.swung = match self.swung {
            swung if waits => swung,
            swung if swings => swung.saturating_add(1),
            _ => 0,
        };
        let is_refused = cell == last && self.chosen != Dir::Stay;
        self.refused = if is_refused { self.refused.saturating_add(1) } else { self.refused.saturating_sub(1) };
        let wanted = last + self.chosen.offset();
        self.barred = match self.barred {
            (barred, count) if is_refused && barred == wanted => (wanted, count.saturating_add(1)),
            _ => (wanted, is_refused.into()),
        };
        if !waits {
            self.past = [cell, last];
        }
        let coin = |use_: u64, step: u32| Rng::keyed(use_, PURPOSE, self.id.0, step).next_u32() & 1 == 1;
        let step = u32::from(step);
        Manners {
            keeps_on: self.swung >= STALEMATE && coin(0, step),
            is_last: self.refused >= STALEMATE && coin(1, step.checked_div(COURTESY).unwrap_or(0)),
        }
    }

    /// Hears another robot in this step. If it knows too many, it forgets the robot lost for
    /// longest, and of those lost for equally long the farthest.
    pub fn hear(&mut self, id: RobotId, said: &Said) {
        self.hear_from(id, said, said.cell);
    }

    /// Hears a robot that goes from `start` to the cell that it says, and may not get that.
    pub fn hear_from(&mut self, id: RobotId, said: &Said, start: Cell) {
        self.begin();
        if id != self.id && said.cell.chebyshev(self.own.cell) <= RANGE {
            self.free(start);
            self.note(id, said);
        }
    }

    fn note(&mut self, id: RobotId, said: &Said) {
        let way = (said.cell, Nearby::UNKNOWN);
        let known =
            Known { id, said: *said, way, strayed: None, age: 0, lost: 0, holds: false, busy: 0, leaves_by: None };
        match self.known.iter_mut().find(|other| other.id == id) {
            Some(other) => *other = Known { way: other.way, ..known },
            None => {
                let Err(known) = self.known.push(known) else { return };
                let own = self.own.cell;
                let order = |other: &Known| (other.lost, other.said.cell.chebyshev(own));
                if let Some(last) = self.known.iter_mut().max_by_key(|other| order(other))
                    && order(last) > order(&known)
                {
                    *last = known;
                }
            }
        }
    }

    /// Hears a robot that stays where it is: its cell is closed.
    pub fn hear_staying(&mut self, id: RobotId, said: &Said) {
        self.begin();
        if id != self.id && said.cell.chebyshev(self.own.cell) <= RANGE {
            self.note(id, said);
            self.hold(id);
            self.area.block(said.cell, true);
        }
    }

    /// It does not get into this cell, so that counts as blocked until a robot is heard there.
    pub fn close(&mut self, cell: Cell) {
        self.area.block(cell, false);
    }

    /// A robot in this cell moves, so nothing blocks it.
    pub fn free(&mut self, cell: Cell) {
        self.area.unblock(cell);
        if self.barred.0 == cell {
            self.barred.1 = 0;
        }
    }

    /// Hears a robot that said that it goes to a cell, and cannot have left `cell`.
    pub fn hear_at(&mut self, id: RobotId, said: &Said, cell: Cell) {
        self.hear(id, &Said { cell, ..*said });
        if let Some(other) = self.known.iter_mut().find(|other| other.id == id) {
            other.strayed = Some(Dir::Stay);
            other.age = 1;
        }
    }

    /// The own move takes more than a step, or is put off, so it is not refused.
    pub const fn take_time(&mut self) {
        self.chosen = Dir::Stay;
    }

    /// A step passes in which it is on its way to a cell. Returns what to say before the next one.
    pub fn rest(&mut self) -> Said {
        self.begin();
        (self.has_begun, self.has_seen, self.is_busy) = (false, false, true);
        self.stay()
    }

    /// A robot cannot move in this step.
    pub fn hold(&mut self, id: RobotId) {
        if let Some(other) = self.known.iter_mut().find(|other| other.id == id) {
            other.holds = true;
        }
    }

    /// A robot cannot move for some steps.
    pub fn set_busy(&mut self, id: RobotId, steps: u8) {
        if let Some(other) = self.known.iter_mut().find(|other| other.id == id) {
            other.busy = steps;
        }
    }

    /// A robot, or this one, shares its cell with one that is nearer to the centre, and leaves
    /// it by this move.
    pub fn share(&mut self, id: RobotId, by: Dir) {
        if id == self.id {
            self.leaves_by = Some(by);
        } else if let Some(other) = self.known.iter_mut().find(|other| other.id == id) {
            other.leaves_by = Some(by);
        }
    }

    /// Chooses the move of this step. O(N^2), and the plan: see [`Plan::new`].
    pub fn decide(&mut self, sensed: Sensed<'_>) -> Dir {
        self.begin();
        (self.has_begun, self.has_seen, self.is_busy) = (false, false, false);
        self.listen();
        let own = self.own;
        let (barred, refusals) = self.barred;
        if refusals >= REFUSALS {
            self.area.block(barred, false);
        }
        self.known.retain(|other| other.lost <= FORGET || !matches!(sensed, Sensed::Nothing));
        let strangers = match sensed {
            // A report of a robot that was heard itself is only what another one expected.
            Sensed::Nothing => {
                let is_heard = |number: u8| self.known.iter().any(|other| other.age == 0 && other.id.0 as u8 == number);
                list::collect(self.strangers.iter().filter(|(number, _)| !is_heard(*number)).map(|&(_, cell)| cell))
            }
            Sensed::Cells(cells) => self.match_sensed(cells),
            Sensed::Robots(robots) => self.place_sensed(robots),
        };
        self.known.retain(|other| other.said.cell.chebyshev(own.cell) <= RANGE);
        let mut members: Vec<Member, N> = Vec::new();
        let _ = members.push(Member { leaves_by: self.leaves_by.take(), ..member(self.id, &own) });
        // The newest news of a cell counts.
        list::sort_by_key(&mut self.known, |other| (other.lost, other.age, other.id.0));
        let known = self.known.iter().map(|other| Member {
            wish: other.wish(&self.area, self.moves),
            holds: other.holds,
            busy: other.busy,
            leaves_by: other.leaves_by,
            ..member(other.id, &other.said)
        });
        for member in known.chain(strangers.iter().map(|&cell| self.stranger(cell))) {
            let is_same =
                |other: &Member| other.cell == member.cell && (member.leaves_by, other.leaves_by) == (None, None);
            if !members.iter().any(is_same) {
                let _ = members.push(member);
            }
        }
        let is_free = |cell: Cell| !members.iter().any(|member| member.cell == cell);
        let alone = |member: &Member| {
            let to = member.cell + member.wish.best().unwrap_or_default().offset();
            if member.holds || member.busy > 0 || !is_free(to) { member.cell } else { to }
        };
        // Among walls a robot that was not heard may be a cell further.
        let linked = linked(&members, if self.is_priced { LINK } else { LINK + 1 });
        let plan: Plan<'_, N> = Plan::new(&linked, &self.area, self.moves);
        let goes_to = |index: u8| plan.next(index).filter(|_| plan.moves_now(index));
        let next = goes_to(0).unwrap_or(own.cell);
        // Until it is heard again, a robot is where this plan puts it, or where it wanted to go.
        for other in &mut self.known {
            let in_plan = linked.iter().position(|member| member.id == other.id);
            let to = match in_plan {
                Some(index) => goes_to(index as u8),
                None => members.iter().find(|member| member.id == other.id).map(alone),
            };
            if let Some(cell) = to {
                other.goes(cell);
            }
        }
        self.chosen = Dir::between(own.cell, next).unwrap_or(Dir::Stay);
        self.chosen
    }

    /// A robot of which only the cell is known.
    fn stranger(&self, cell: Cell) -> Member {
        let (id, manners) = (RobotId::NONE, Manners::default());
        let wish = Wish::towards(cell, cell, &self.area, self.moves);
        Member { id, cell, goal: cell, waiting: 0, step: 0, manners, wish, holds: false, busy: 0, leaves_by: None }
    }

    /// Where it expects a robot after the last decision; itself too.
    #[must_use]
    pub fn expects(&self, id: RobotId) -> Option<Cell> {
        if id == self.id {
            return Some(self.own.cell + self.chosen.offset());
        }
        self.known.iter().find(|other| other.id == id).map(|other| other.said.cell)
    }
}

/// Moves between two cells without diagonals.
fn moves(a: Cell, b: Cell) -> u32 {
    u32::from(a.x.abs_diff(b.x)) + u32::from(a.y.abs_diff(b.y))
}

const fn waiting(is_at_goal: bool, before: u16) -> u16 {
    match before {
        _ if is_at_goal => 1,
        before if before < MOST_WAITING => before.saturating_add(1),
        _ => MOST_WAITING,
    }
}

fn member(id: RobotId, said: &Said) -> Member {
    let Said { cell, goal, waiting, wish, step, manners } = *said;
    Member { id, cell, goal, waiting, step, manners, wish, holds: false, busy: 0, leaves_by: None }
}
