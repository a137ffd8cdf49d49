//! Negotiation of bodies that move in the plane.

use super::super::{Manners, Moves, Nearby, Negotiator, Report, Said, Sensed, Sight, Wish};
use super::sight;
use crate::geom::Vec2;
use crate::grid::{Cell, Dir};
use crate::law::{self, Action, BadInput, Decision, InCells, Law, Progress, Protocol, Radio, Tools, View};
use crate::laws::any_protocol::InAny;
use crate::laws::cells::GridOrder;
use crate::parameters::{Parameters, SPEED};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Content, ProtocolId};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Time of a step, tenths of that for a cell at cruising speed; leaves speed to catch up.
const SLACK: i32 = 12;
/// How often a robot makes up for its distance from the point in a step, tenths.
const PULL: i32 = 18;
/// Steps in a row that a robot is late, after which it chooses its cell again.
const GIVES_UP: u8 = 4;

/// The protocol of robots that negotiate in the plane, in steps that begin at the same time.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InStep {}

impl Protocol for InStep {
    const ID: ProtocolId = ProtocolId(4);
    type Payload = InStepPayload;
    type Message = Report;
    type Order = GridOrder;
}

impl InAny for InStep {}

/// The payload of a robot that negotiates in the plane; 15 bytes on the air.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u8; 15]", into = "[u8; 15]")]
pub struct InStepPayload {
    /// Where it is at the end of this step.
    pub said: Said,
    /// The move by which it goes there.
    pub by: Dir,
    /// How far the step is.
    pub beat: Beat,
}

impl Content for InStepPayload {}

/// Of the four moves, from 0, and 4 for `Stay`.
const fn quarter(dir: Dir) -> u8 {
    dir as u8 >> 1
}

/// Cell, goal, `waiting`, step, 4 bits for each move of the wish, `by`, the move after the best one
/// and the manners, and the beat.
impl From<InStepPayload> for [u8; 15] {
    fn from(payload: InStepPayload) -> Self {
        let InStepPayload { said: Said { cell, goal, waiting, wish, step, manners }, by, beat } = payload;
        let [east, north, west, south] = Moves::FOUR.dirs() else { return [0; 15] };
        let lost = |dir: &Dir| u16::from(wish.lost(*dir).unwrap_or(15));
        let lost = lost(east) | lost(north) << 4 | lost(west) << 8 | lost(south) << 12;
        let moves = u16::from(quarter(by)) << 5 | u16::from(quarter(wish.then)) << 2 | u16::from(u8::from(manners) & 3);
        let [(a, b), (c, d), (e, f), (g, h), (i, j), (k, l)] =
            [cell.x as u16, cell.y as u16, goal.x as u16, goal.y as u16, waiting, lost]
                .map(|pair| (pair as u8, (pair >> 8) as u8));
        [a, b, c, d, e, f, g, h, i, j, k, l, step, moves as u8, beat.into()]
    }
}

impl From<[u8; 15]> for InStepPayload {
    fn from([a, b, c, d, e, f, g, h, i, j, k, l, step, moves, beat]: [u8; 15]) -> Self {
        let at = |x: [u8; 2], y: [u8; 2]| Cell::new(i16::from_le_bytes(x), i16::from_le_bytes(y));
        let dir = |quarter: u8| Dir::from_index((quarter & 7) << 1);
        let mut wish = Wish::CLOSED;
        wish.then = dir(moves >> 2);
        let mut lost = u16::from_le_bytes([k, l]);
        for &dir in Moves::FOUR.dirs() {
            if lost & 15 < 15 {
                wish.set(dir, (lost & 15) as u8);
            }
            lost >>= 4;
        }
        let said = Said {
            cell: at([a, b], [c, d]),
            goal: at([e, f], [g, h]),
            waiting: u16::from_le_bytes([i, j]),
            wish,
            step,
            manners: Manners::from(moves & 3),
        };
        Self { said, by: dir(moves >> 5), beat: beat.into() }
    }
}

/// A moment of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub struct Beat {
    /// Time since the step began, 128ths of a step; at most 127.
    pub phase: u8,
    /// Whether the robot will not leave its cell in the next step.
    pub is_late: bool,
}

impl From<u8> for Beat {
    fn from(bits: u8) -> Self {
        Self { phase: bits >> 1, is_late: bits & 1 == 1 }
    }
}

impl From<Beat> for u8 {
    fn from(beat: Beat) -> Self {
        beat.phase << 1 | Self::from(beat.is_late)
    }
}

/// [`NegotiationGuidance`](super::NegotiationGuidance) on a body in the plane: moves between the
/// centres of cells, to four neighbours, with one plan for each step. Two robots that follow each
/// other around a corner pass at a distance of 0.7 cells, so their diameters must be less. Robots
/// need equal cells, cruising speeds and accelerations.
///
/// *Clock:* all robots begin their steps together. A robot whose clock is behind that of a robot
/// that it hears adopts that clock.
///
/// *Path:* a point moves to the centre of the next cell at constant speed; the robot follows the
/// mean of its places over the last step, a quadratic B-spline.
///
/// *Claims:* a robot takes its move back if another one has said that it stays in that cell, or
/// that it enters the cell and has waited longer. A robot half a cell from its path is late: it
/// stays in the next step. A robot that is late for long begins again in the cell that it is in,
/// and counts the cell that it did not get into as blocked.
/// Where robots share a cell, those farther from the centre leave it first, to their side of it,
/// and others make way for them.
///
/// A decision takes O(N), and at the start of a step as much as a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NegotiationInPlane<S, const N: usize = 16> {
    speed_mps: S,
    goal: Option<Cell>,
    robot: Option<Negotiator<N>>,
    /// The cell at the start of the last step and of this one, and the move in this one.
    before: Cell,
    from: Cell,
    by: Dir,
    /// Its beacon and its broadcast in this step.
    said: Said,
    shared: Report,
    step: u8,
    began: Instant,
    length: Duration,
    decided: Instant,
    is_late: bool,
    /// Steps in a row that it is late.
    late: u8,
}

crate::parameters! {
    impl[S: Scalar, const N: usize] NegotiationInPlane<S, N> { SPEED => speed_mps }
}

impl<S: Scalar, const N: usize> NegotiationInPlane<S, N> {
    /// Creates the law with a cruising speed of `speed_mps`, within the speed limit of the body.
    #[must_use]
    pub const fn new(speed_mps: S) -> Self {
        Self {
            speed_mps,
            goal: None,
            robot: None,
            before: Cell { x: 0, y: 0 },
            from: Cell { x: 0, y: 0 },
            by: Dir::Stay,
            said: Said {
                cell: Cell { x: 0, y: 0 },
                goal: Cell { x: 0, y: 0 },
                waiting: 1,
                wish: Wish::CLOSED,
                step: 0,
                manners: Manners { is_last: false, keeps_on: false },
            },
            shared: Report { cell: [0; 2], sight: Sight([0; 16]), way: Nearby::UNKNOWN, heard: Vec::new() },
            step: 0,
            began: Instant::from_micros(0),
            length: Duration::ZERO,
            decided: Instant::from_micros(0),
            is_late: false,
            late: 0,
        }
    }

    /// Not inlined, so that a new robot takes no stack in a decision.
    #[inline(never)]
    fn begin(&mut self, id: RobotId, cell: Cell, now: Instant) {
        if self.robot.is_none() {
            self.robot = Some(Negotiator::new(id, cell, Moves::FOUR));
            (self.before, self.from, self.by) = (cell, cell, Dir::Stay);
            self.began = now - self.length;
        }
    }

    /// Advances the clock to that of the robots ahead. Returns whether a step begins.
    fn keep_time(&mut self, view: &View<'_, S, InStep>) -> bool {
        let length = self.length.as_micros().max(1);
        let mut passed = view.now.since(self.began).as_micros().max(0);
        for (other, InStepPayload { said, beat, .. }) in view.peers() {
            // The clock of a robot that does not decide stands still, and a number of steps wraps.
            if beat.is_late || view.now.since(other.heard) > self.length {
                continue;
            }
            let steps = said.step.wrapping_sub(1).wrapping_sub(self.step) as i8;
            let theirs = (i64::from(length) * (i64::from(steps) * 128 + i64::from(beat.phase))) >> 7;
            let since = view.now.since(other.heard).as_micros().max(0);
            passed = passed.max(i32::try_from(theirs).unwrap_or(0).saturating_add(since));
        }
        let steps = passed.checked_div(length).unwrap_or(0);
        self.began = view.now - Duration::from_micros(passed - length.saturating_mul(steps));
        self.step = self.step.wrapping_add(steps as u8);
        steps > 0
    }

    /// Whether another robot has a better claim to the cell that it enters, or wants to exchange
    /// cells with it.
    fn loses(&self, view: &View<'_, S, InStep>) -> bool {
        let own = &self.said;
        self.by != Dir::Stay
            && view.peers().any(|(other, InStepPayload { said, by, .. })| {
                let start = said.cell - by.offset();
                let is_ahead = (said.waiting, other.id.0) > (own.waiting, view.id.0);
                said.step == own.step
                    && ((said.cell == own.cell && (by == Dir::Stay || is_ahead))
                        || (said.cell == self.from && start == own.cell))
            })
    }
}

/// The move to the side of its cell on which a body is.
fn outwards<S: Scalar>(off_m: Vec2<S>) -> Dir {
    let along = |dir: Dir| {
        let Cell { x, y } = dir.offset();
        off_m.x * S::from_i32(x.into()) + off_m.y * S::from_i32(y.into())
    };
    let farthest = |a: Dir, b: &Dir| if along(*b) > along(a) { *b } else { a };
    Moves::FOUR.dirs().iter().fold(Dir::North, farthest)
}

/// The time of a step: a body turns a corner in it. `None` if it is not a minute at most.
fn step_length<S: Scalar>(cell_m: S, speed_mps: S, max_acceleration_mps2: S) -> Option<Duration> {
    let crossing_s = cell_m.checked_div(speed_mps.max(S::from_milli(1)))? * S::from_ratio(SLACK, 10);
    // A corner takes sqrt(2) cells / step^2.
    let turn_s = (cell_m * S::TWO.sqrt()).checked_div(max_acceleration_mps2).unwrap_or(S::ZERO).sqrt();
    let length_s = crossing_s.max(turn_s);
    if length_s > S::from_i32(60) {
        return None;
    }
    (length_s * S::from_i32(1000)).floor_to_i32().map(Duration::from_millis)
}

impl<S: Scalar, const N: usize> Law<S> for NegotiationInPlane<S, N> {
    type Surroundings<'a> = InCells<'a, S>;
    type Protocol = InStep;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, InStep>,
        here: &InCells<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Some(goal) = view.sent_to.or(self.goal) else { return Ok(Decision::idle()) };
        view.can_move()?;
        let (under, window) = here.grid.seen()?;
        let place = here.in_cell;
        self.length = step_length(place.cell_m, self.speed_mps, view.body.max_acceleration_mps2).ok_or(BadInput)?;
        self.begin(view.id, under, view.now);
        let to_center = |cell: Cell| {
            let along = |cells: i16, offset: S| S::from_i32(cells.into()) * place.cell_m - offset;
            let cells = cell - under;
            Vec2::new(along(cells.x, place.offset_m.x), along(cells.y, place.offset_m.y)) - view.ahead_m.xy()
        };
        let speed = self.speed_mps.min(view.body.max_speed_mps);
        if self.keep_time(view) {
            self.before = self.from;
            self.from = self.from + self.by.offset();
            self.late = if self.is_late { self.late.saturating_add(1) } else { 0 };
            let refused = (self.late >= GIVES_UP).then_some(self.from).filter(|&cell| cell != under);
            if self.late >= GIVES_UP {
                (self.before, self.from, self.late) = (under, under, 0);
            }
            let own = (view.id, self.from, -to_center(self.from));
            let Some(robot) = &mut self.robot else { return Ok(Decision::idle()) };
            if robot.goal() != goal {
                robot.set_goal(goal);
            }
            robot.set_step(self.step);
            if let Some(cell) = refused {
                robot.close(cell);
            }
            robot.see(self.from, &sight(self.from, under, &window));
            for (other, InStepPayload { said, by, beat }) in view.peers() {
                // A robot whose step began already was there when it began.
                let is_ahead = said.step == self.step.wrapping_add(1);
                if said.step == self.step || is_ahead {
                    if is_ahead {
                        robot.hear_at(other.id, &said, said.cell - by.offset());
                    } else {
                        robot.hear(other.id, &said);
                    }
                    if beat.is_late {
                        robot.hold(other.id);
                    }
                }
            }
            // Each robot of this step with its cell, and where it is from the centre of that.
            let mut bodies: Vec<(RobotId, Cell, Vec2<S>), N> = Vec::new();
            let _ = bodies.push(own);
            for (other, payload) in view.peers().filter(|(_, payload)| payload.said.step == self.step) {
                let cell = payload.said.cell;
                let body_m = other.offset_at(view.state.position, view.now, view.ages.expire_after).xy();
                let _ = bodies.push((other.id, cell, body_m - to_center(cell)));
            }
            for &(id, cell, off_m) in &bodies {
                let is_nearer = |&(other, its, its_m): &(RobotId, Cell, Vec2<S>)| {
                    its == cell && (its_m.norm(), other.0) < (off_m.norm(), id.0)
                };
                if bodies.iter().any(is_nearer) {
                    robot.share(id, outwards(off_m));
                }
            }
            let was_late = self.is_late;
            let dir = robot.decide(Sensed::Nothing);
            self.by = if was_late { Dir::Stay } else { dir };
            self.said = if was_late {
                robot.take_time();
                robot.stay()
            } else {
                robot.promise()
            };
            self.shared = robot.report();
        } else if self.loses(view)
            && let Some(robot) = &mut self.robot
        {
            self.by = Dir::Stay;
            self.said = robot.stay();
        }
        self.decided = view.now;
        // The mean of the point over the last step: a spline of constant acceleration in each step.
        let [passed, length] = [view.now.since(self.began), self.length].map(|span| S::from_micro(span.as_micros()));
        let share = passed.checked_div(length).unwrap_or(S::ONE);
        let rest = S::ONE - share;
        let [before, from, end] = [self.before, self.from, self.said.cell].map(to_center);
        let [last, next] = [from - before, end - from];
        let way = from - last * (rest * rest * S::HALF) + next * (share * share * S::HALF);
        let rate = S::ONE.checked_div(length).unwrap_or(S::ZERO);
        let wish = (last * rest + next * share + way * S::from_ratio(PULL, 10)) * rate;
        self.is_late = way.norm() > place.cell_m * S::HALF;
        let wish = wish.clamp_norm(speed);
        let is_there = self.from == goal && self.by == Dir::Stay;
        let progress = Progress::at_goal(is_there);
        let action = Action::Velocity { wish_mps: wish.extend(S::ZERO), way_m: None };
        Ok(Decision { action, progress, makes_way: is_there, is_agreed: true })
    }

    fn payload(&mut self, here: &InCells<'_, S>, _: Dir, radio: &mut Radio<'_, InStep>) -> InStepPayload {
        let now = radio.now();
        let (said, by, is_late) = if self.robot.is_some() && self.decided == now {
            radio.broadcast(&self.shared);
            (self.said, self.by, self.is_late)
        } else {
            // It does not decide: it stays where it is.
            let (cell, step) = (here.grid.cell.cell, self.step.wrapping_add(1));
            (Said { cell, goal: cell, waiting: 1, step, ..Said::default() }, Dir::Stay, true)
        };
        let passed = i64::from(now.since(self.began).as_micros().max(0)) << 7;
        let phase = passed.checked_div(self.length.as_micros().into()).unwrap_or(0).min(127) as u8;
        InStepPayload { said, by, beat: Beat { phase, is_late } }
    }

    fn receive(&mut self, from: RobotId, report: &Report, _: &mut Radio<'_, InStep>) -> bool {
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

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
    }
}
