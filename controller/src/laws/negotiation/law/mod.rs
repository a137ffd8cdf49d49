//! Negotiation as a law.

mod costs;
mod in_plane;

use super::negotiator::LINK;
use super::{MOST_WAITING, Manners, Moves, Negotiator, Report, SIGHT, Said, Sensed, Sight, Wish};
use crate::cost::Weights;
use crate::grid::{BLOCKED, Cell, Dir, Norm, UNIT, Window};
use crate::law::{self, Action, BadInput, CellState, Decision, Law, OnGrid, Progress, Protocol, Radio, Tools, View};
use crate::laws::any_protocol::InAny;
use crate::laws::cells::{GridOrder, GridWorkspace, MoveHistory};
use crate::robot::RobotId;
use crate::route::{RouteParams, Router};
use crate::scalar::Scalar;
use crate::shuffle::Sharpness;
use crate::time::{Duration, Instant};
use crate::wire::{Content, ProtocolId};
use costs::Costs;
use heapless::Vec;
use serde::{Deserialize, Serialize};

pub use in_plane::{Beat, InStep, InStepPayload, NegotiationInPlane};

/// The protocol of robots that negotiate.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Negotiation {}

impl Protocol for Negotiation {
    const ID: ProtocolId = ProtocolId(3);
    type Payload = NegotiationPayload;
    type Message = Report;
    type Order = GridOrder;
}

/// The payload of a robot that negotiates; 16 bytes on the air.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u8; 16]", into = "[u8; 16]")]
pub struct NegotiationPayload {
    /// Where it is, or goes to in this tick.
    pub said: Said,
    /// The move by which it goes there.
    pub by: Dir,
    /// Steps from the next one on in which it cannot leave that cell; 63: it stays there.
    pub busy: u8,
}

/// Cells to the nearest robot up to which a robot among walls goes by the shared area.
const CROWD: u32 = 4;
/// The same in the next step but one, when others use what it says now.
const MEETS: u32 = 6;
/// Of a robot without a goal, or that an operator stopped.
pub const STAYS: u8 = 63;

/// Cell, goal, 4 bits of the step and 12 of `waiting`, the wish, `by` and the move after the best
/// one, 6 bits of `busy` and the manners.
impl From<NegotiationPayload> for [u8; 16] {
    fn from(payload: NegotiationPayload) -> Self {
        let NegotiationPayload { said, by, busy } = payload;
        let Said { cell, goal, waiting, wish, step, manners } = said;
        let order = waiting.min(MOST_WAITING) << 4 | u16::from(step & 15);
        let [(a, b), (c, d), (e, f), (g, h), (i, j)] =
            [cell.x as u16, cell.y as u16, goal.x as u16, goal.y as u16, order]
                .map(|pair| (pair as u8, (pair >> 8) as u8));
        let [k, l, m, n] = wish.bits().to_le_bytes();
        let moves = by as u8 | (wish.then as u8) << 4;
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, moves, busy.min(STAYS) << 2 | u8::from(manners) & 3]
    }
}

impl From<[u8; 16]> for NegotiationPayload {
    fn from([a, b, c, d, e, f, g, h, i, j, k, l, m, n, moves, busy]: [u8; 16]) -> Self {
        let at = |x: [u8; 2], y: [u8; 2]| Cell::new(i16::from_le_bytes(x), i16::from_le_bytes(y));
        let order = u16::from_le_bytes([i, j]);
        let said = Said {
            cell: at([a, b], [c, d]),
            goal: at([e, f], [g, h]),
            waiting: order >> 4,
            wish: Wish::from_bits(u32::from_le_bytes([k, l, m, n]), Dir::from_index(moves >> 4)),
            step: (order & 15) as u8,
            manners: Manners::from(busy & 3),
        };
        Self { said, by: Dir::from_index(moves & 15), busy: busy >> 2 }
    }
}

impl Content for NegotiationPayload {}
impl Content for Report {}
impl InAny for Negotiation {}

/// Robots that pass each other on the grid, with or without a map: at most `N` plan together.
/// Robots of other laws are not seen. On a 32-bit part it takes at most 4636 + 96 `N` bytes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NegotiationGuidance<const N: usize = 16> {
    moves: Moves,
    goal: Option<Cell>,
    robot: Option<Negotiator<N>>,
    /// When it last decided.
    decided: Instant,
    /// When its last crossing of a cell ended, or ends if it makes the move that it chose.
    crossed: Instant,
    tick: Duration,
    params: RouteParams,
    router: Router<64, 256>,
    /// Its wish in the cell that it goes to, by costs.
    next: Option<(Cell, Wish)>,
    /// The newest beacon of each robot since it last decided, and when it was sent.
    heard: Vec<Heard, N>,
}

/// A beacon.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Heard {
    from: RobotId,
    payload: NegotiationPayload,
    sent: Instant,
}

impl Heard {
    /// Where its robot was when it sent.
    fn start(&self) -> Cell {
        self.payload.said.cell - self.payload.by.offset()
    }
}

// Memory of firmware: a change of these sizes changes the memory map of every user.
#[cfg(target_pointer_width = "32")]
const _: () = {
    const fn fits<const N: usize>() -> bool {
        size_of::<NegotiationGuidance<N>>() <= 4636 + 96 * N
    }
    assert!(fits::<8>() && fits::<16>() && fits::<64>());
};

impl<const N: usize> NegotiationGuidance<N> {
    /// Creates the law for bodies with these moves.
    #[must_use]
    pub const fn new(moves: Moves) -> Self {
        Self {
            moves,
            goal: None,
            robot: None,
            decided: Instant::from_micros(0),
            crossed: Instant::from_micros(0),
            tick: Duration::ZERO,
            params: RouteParams::DEFAULT,
            router: Router::new(),
            next: None,
            heard: Vec::new(),
        }
    }

    /// Not inlined, so that a new robot takes no stack in a decision.
    #[inline(never)]
    fn begin(&mut self, id: RobotId, cell: Cell) {
        if self.robot.is_none() {
            self.robot = Some(Negotiator::new(id, cell, self.moves));
        }
    }
}

impl<const N: usize> Default for NegotiationGuidance<N> {
    fn default() -> Self {
        Self::new(Moves::EIGHT)
    }
}

impl<S: Scalar, const N: usize> Law<S> for NegotiationGuidance<N> {
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Negotiation;
    type Workspace = GridWorkspace<169>;

    fn decide(
        &mut self,
        view: &View<'_, S, Negotiation>,
        here: &OnGrid<'_>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Some(goal) = view.sent_to.or(self.goal) else { return Ok(Decision::idle()) };
        let (cell, window) = here.seen()?;
        self.begin(view.id, cell);
        let Some(robot) = &mut self.robot else { return Ok(Decision::idle()) };
        if robot.goal() != goal {
            robot.set_goal(goal);
        }
        let target = window.reachable(goal);
        self.router.observe(&self.params, cell, target);
        // Among walls only a search of the shared area finds the way that others expect.
        let has_walls = window.cells().contains(&BLOCKED);
        let heard = self.heard.iter().map(|heard| heard.payload.said.cell.chebyshev(cell));
        let nearest = heard.chain(robot.nearest()).min();
        let is_among =
            has_walls && nearest.is_some_and(|cells| cells <= CROWD && is_dense(&window) || self.router.idle() > 0);
        let is_priced = self.moves.diagonals && !robot.is_beside_goal() && !is_among;
        robot.set_priced(is_priced);
        look(robot, cell, &window, !is_priced || nearest.is_some_and(|cells| cells <= LINK));
        let failed: Vec<RobotId, N> = failed(&self.heard, cell);
        for heard in &self.heard {
            let Heard { from: id, payload: NegotiationPayload { said, busy, .. }, sent } = *heard;
            if busy == STAYS {
                robot.hear_staying(id, &said);
            } else if failed.contains(&id) {
                robot.hear_at(id, &said, heard.start());
            } else {
                robot.hear_from(id, &said, heard.start());
            }
            // It counted from its next step.
            let age = view.now.since(sent).as_micros().max(0).checked_div(view.tick.as_micros()).unwrap_or(0);
            let left = if busy > 0 { i32::from(busy).saturating_add(1).saturating_sub(age) } else { 0 };
            match u8::try_from(left) {
                Ok(0) | Err(_) => {}
                Ok(_) if busy == STAYS => robot.hold(id),
                Ok(left) => robot.set_busy(id, left),
            }
        }
        self.heard.clear();
        let (params, router, workspace) = (&self.params, &mut self.router, tools.workspace);
        let mut costs = Costs { params, router, workspace, window: &window, target };
        let weights = if is_priced && cell != target { costs.weights(cell, robot.others()) } else { None };
        let told = self.next.take().filter(|&(at, _)| at == cell).map(|(_, wish)| wish);
        let nearest = robot.nearest().unwrap_or(u32::MAX);
        let mut moves = Vec::new();
        if is_priced && nearest > LINK {
            // No robot can be in its way.
            let weights = weights.unwrap_or(Weights::CLOSED);
            moves = MoveHistory::order(&weights, Sharpness::Greedy, 8, tools.rng);
            robot.go(moves.first().copied().unwrap_or_default());
        } else {
            if is_priced {
                let wish = told.unwrap_or_else(|| costs.wish(cell, weights.as_ref()));
                robot.set_wish(wish);
            }
            let dir = robot.decide(Sensed::Nothing);
            if dir != Dir::Stay {
                let _ = moves.push(dir);
            }
        }
        let dir = moves.first().copied().unwrap_or_default();
        if is_priced && nearest <= MEETS {
            let wish = if dir != Dir::Stay {
                costs.wish_after(cell, dir)
            } else {
                told.unwrap_or_else(|| costs.wish(cell, weights.as_ref()))
            };
            self.next = Some((cell + dir.offset(), wish));
        }
        // The rest of a tick counts; it is free now, so a later end is that of a refused move.
        let rest = view.now.since(self.crossed);
        self.crossed = if rest >= Duration::ZERO && rest < view.tick { self.crossed } else { view.now };
        (self.decided, self.tick) = (view.now, view.tick);
        let is_beside = robot.is_beside_goal();
        let has_arrived = cell == target || is_beside;
        let progress = if has_arrived {
            Progress::arrived(is_beside)
        } else if is_priced && weights.is_none() {
            Progress::Stuck
        } else {
            Progress::Going
        };
        if dir != Dir::Stay {
            let class = window.get(cell + dir.offset()).unwrap_or(1);
            self.crossed = self.crossed + crossing(view.tick, dir, class);
        }
        let makes_way = has_arrived && !moves.is_empty();
        Ok(Decision { makes_way, ..Decision::new(Action::Moves(moves), progress) })
    }

    fn payload(&mut self, here: &OnGrid<'_>, _: Dir, radio: &mut Radio<'_, Negotiation>) -> NegotiationPayload {
        let CellState { cell, busy } = here.cell;
        let Some(robot) = &mut self.robot else {
            // Without a goal it stays where it is.
            let said = Said { cell, goal: cell, waiting: 1, ..Said::default() };
            return NegotiationPayload { said, by: Dir::Stay, busy: STAYS };
        };
        if robot.is_noisy() {
            radio.repeat_beacon();
        }
        if robot.has_news() {
            radio.broadcast(&robot.report());
        }
        let now = radio.now();
        let mut stays = false;
        let said = match here.seen() {
            Ok((cell, window)) if self.decided != now => {
                self.crossed = now + busy;
                stays = busy == Duration::ZERO;
                if stays {
                    robot.take_time();
                }
                look(robot, cell, &window, robot.nearest().is_some_and(|cells| cells <= LINK));
                robot.rest()
            }
            _ => robot.promise(),
        };
        let said = match self.next {
            Some((at, wish)) if at == said.cell => Said { wish, ..said },
            _ => said,
        };
        let by = Dir::between(cell, said.cell).unwrap_or_default();
        // The last step of a crossing ends when it is free.
        let left = self.crossed.since(now).as_micros().saturating_sub(1);
        let busy = left.checked_div(self.tick.as_micros()).unwrap_or(0);
        let busy = busy.clamp(0, i32::from(STAYS - 1)) as u8;
        NegotiationPayload { said, by, busy: if stays { STAYS } else { busy } }
    }

    fn receive_payload(&mut self, from: RobotId, payload: &NegotiationPayload, sent: Instant) {
        let heard = Heard { from, payload: *payload, sent };
        if let Some(known) = self.heard.iter_mut().find(|known| known.from == from) {
            *known = heard;
        } else if self.heard.push(heard).is_err()
            && let Some(robot) = &self.robot
        {
            let far = |heard: &Heard| heard.payload.said.cell.chebyshev(robot.cell());
            if let Some(farthest) = self.heard.iter_mut().max_by_key(|known| far(known))
                && far(farthest) > far(&heard)
            {
                *farthest = heard;
            }
        }
    }

    fn receive(&mut self, from: RobotId, report: &Report, _: &mut Radio<'_, Negotiation>) -> bool {
        if let Some(robot) = &mut self.robot {
            robot.hear_report(from, report, false);
        }
        true
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        let GridOrder::Goal(goal) = order else { return false };
        self.goal = Some(*goal);
        true
    }

    fn report(&self) -> law::Report {
        law::Report { goal: self.goal, target: self.goal, ..law::Report::default() }
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        self.robot.as_ref()?.expects(id)
    }
}

/// Sees the land if it `needs` it and there are walls, of the map or around it.
fn look<const N: usize>(robot: &mut Negotiator<N>, cell: Cell, window: &Window<'_>, needs: bool) {
    let whole = 2 * SIGHT as usize + 1;
    let is_open = || window.cells().len() == whole * whole && !window.cells().contains(&BLOCKED);
    if !needs || is_open() {
        robot.pass(cell);
    } else {
        robot.see(cell, &sight(cell, cell, window));
    }
}

/// Whether the walls are dense enough to decide the ways: a sixteenth of the cells in sight.
fn is_dense(window: &Window<'_>) -> bool {
    let cells = window.cells();
    cells.iter().filter(|&&class| class == BLOCKED).count() > cells.len() >> 4
}

/// The robots that did not get the cell that they said, because another one is there. O(N^3).
fn failed<const N: usize>(heard: &[Heard], own: Cell) -> Vec<RobotId, N> {
    let mut failed = Vec::new();
    loop {
        let is_free = |to: Cell| {
            let stays =
                |other: &Heard| (other.payload.by == Dir::Stay || failed.contains(&other.from)) && other.start() == to;
            to != own && !heard.iter().any(stays)
        };
        let mut going = heard.iter().filter(|other| other.payload.by != Dir::Stay && !failed.contains(&other.from));
        let Some(other) = going.find(|other| !is_free(other.payload.said.cell)) else { return failed };
        if failed.push(other.from).is_err() {
            return failed;
        }
    }
}

/// Time to cross a cell.
fn crossing(tick: Duration, dir: Dir, class: u8) -> Duration {
    let length = u64::from(class) * u64::from(dir.length(Norm::Euclidean));
    let micros = (tick.as_micros().max(0).unsigned_abs() as u64 * length).checked_div(UNIT.into()).unwrap_or(0);
    Duration::from_micros(i32::try_from(micros).unwrap_or(i32::MAX))
}

/// The walls around a cell, in a window with the centre `eye`. Cells beyond the edge of the land
/// are closed.
fn sight(cell: Cell, eye: Cell, window: &Window<'_>) -> Sight {
    let sees = |reach: i16| {
        let edges = [(-reach, 0), (reach, 0), (0, -reach), (0, reach)];
        edges.into_iter().any(|(x, y)| window.get(eye + Cell::new(x, y)).is_some())
    };
    let reach = (1..=SIGHT).take_while(|&reach| sees(reach)).last().unwrap_or(0) as u32;
    Sight::new(cell, |cell| match window.get(cell) {
        Some(class) => class == BLOCKED,
        None => cell.chebyshev(eye) <= reach,
    })
}
