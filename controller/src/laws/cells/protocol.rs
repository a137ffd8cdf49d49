//! The protocol of robots that plan on the grid.

use super::assembly::{TemplateAssembler, TemplatePart};
use crate::fixint;
use crate::grid::{Cell, Dir};
use crate::land::LandPatch;
use crate::law::{CellState, OfAnotherLaw, OnGrid, Protocol, Radio, Report, Scene, View};
use crate::neighbor::Neighbor;
use crate::robot::{Mode, RobotId};
use crate::template::Template;
use crate::time::{Duration, Instant};
use crate::wire::{Content, ProtocolId};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The protocol of the laws that plan on the grid (A. V. Kuznetsov 2017, KUZ).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Grid {}

impl Protocol for Grid {
    const ID: ProtocolId = ProtocolId(1);
    type Payload = GridPayload;
    type Message = GridMessage;
    type Order = GridOrder;

    fn subject(message: &GridMessage) -> u32 {
        match message {
            GridMessage::Stop { origin, .. } | GridMessage::Resume { origin } => origin.0.wrapping_add(1),
            GridMessage::Redirect | GridMessage::Land(_) => 0,
        }
    }

    /// Parts of a template repeat, and [`TemplateAssembler`](super::TemplateAssembler) sorts them.
    fn order_subject(order: &GridOrder) -> Option<u32> {
        (!matches!(order, GridOrder::Template { .. })).then_some(0)
    }

    fn received(order: &mut GridOrder, _: Instant, changed: bool) {
        if let GridOrder::Template { is_restarted, .. } = order {
            *is_restarted = changed;
        }
    }
}

/// The greatest number of a leader that fits a payload.
const MAX_LEADER: RobotId = RobotId((1 << 28) - 1);

/// The state of a robot on the grid; at most 16 bytes on the air, 15 with a leader below 2^21.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridPayload {
    /// The cell that the robot occupies.
    #[serde(with = "fixint")]
    pub cell: Cell,
    /// The cell that it is heading for.
    #[serde(with = "fixint")]
    pub target: Cell,
    /// Time until it may leave its cell, ms (saturating; KUZ eq. 6).
    #[serde(with = "fixint")]
    pub busy_ms: u16,
    /// The move that it wants to make next.
    pub heading: Dir,
    /// Its place in the formation.
    pub slot: u8,
    /// Its leader, below 2^28, or [`RobotId::NONE`].
    pub leader: RobotId,
}

impl Content for GridPayload {
    // A host decodes many.
    #[cfg(feature = "host")]
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut rest = fixint::Fields(bytes);
        let cell = Cell::new(rest.fixed()?, rest.fixed()?);
        let target = Cell::new(rest.fixed()?, rest.fixed()?);
        let (busy_ms, [heading, slot]) = (rest.fixed()?, rest.take()?);
        let is_direction = heading <= Dir::Stay as u8;
        let (heading, leader) = (Dir::from_index(heading), RobotId(rest.number()?));
        (is_direction && rest.0.is_empty()).then_some(Self { cell, target, busy_ms, heading, slot, leader })
    }
}

/// A message between robots that plan on the grid (KUZ section 7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GridMessage {
    /// Stop until a [`Resume`](Self::Resume) of the same sender and origin arrives, or for
    /// `valid_ms`. It travels up the chain of leaders.
    Stop {
        /// The robot that sent the message first.
        origin: RobotId,
        /// How long it holds after its reception, ms.
        #[serde(with = "fixint")]
        valid_ms: u16,
    },
    /// Continue.
    Resume {
        /// The robot that sent the message first.
        origin: RobotId,
    },
    /// Choose another direction than the last one.
    Redirect,
    /// A patch of the sender's map, to all.
    Land(LandPatch),
}

impl Content for GridMessage {}

impl GridMessage {
    /// A stop that holds for `valid`, at most 65 s.
    #[must_use]
    pub fn stop(origin: RobotId, valid: Duration) -> Self {
        let millis = valid.as_micros().max(0).checked_div(1000).unwrap_or(0);
        Self::Stop { origin, valid_ms: u16::try_from(millis).unwrap_or(u16::MAX) }
    }
}

/// An order to a robot that plans on the grid.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GridOrder {
    /// Go to this cell, regardless of the place in a formation.
    Goal(#[serde(with = "fixint")] Cell),
    /// The top leader of the formation goes to this cell, each other robot to its place beside it.
    FormationGoal(#[serde(with = "fixint")] Cell),
    /// A part of the formation's template.
    Template {
        /// The part.
        part: TemplatePart,
        /// The sender changed or restarted, so its version numbers start anywhere.
        #[serde(skip)]
        is_restarted: bool,
    },
}

impl Content for GridOrder {}

impl<const F: usize> TemplateAssembler<F> {
    /// Stores an order. Returns the template once it is complete.
    ///
    /// # Errors
    /// [`OfAnotherLaw`] if the order is not a part of a template, or a rejected part.
    pub fn order(&mut self, order: &GridOrder) -> Result<Option<Template<F>>, OfAnotherLaw> {
        let GridOrder::Template { part, is_restarted } = order else { return Err(OfAnotherLaw) };
        if *is_restarted {
            *self = Self::new();
        }
        self.put(part).map_err(|_| OfAnotherLaw)
    }
}

/// Another robot as laws on the grid know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridNeighbor {
    /// Its id.
    pub id: RobotId,
    /// When its state was received, own clock.
    pub heard: Instant,
    /// When it is free to leave its cell, own clock (KUZ eq. 6).
    pub busy_until: Instant,
    /// The cell that it occupies.
    pub cell: Cell,
    /// The cell that it is heading for.
    pub target: Cell,
    /// Its leader, or [`RobotId::NONE`].
    pub leader: RobotId,
    /// The move that it intends next.
    pub heading: Dir,
    /// Its place in the formation.
    pub slot: u8,
    /// The mode that it last reported.
    pub mode: Mode,
    /// Its law has this protocol, so it answers messages.
    pub is_peer: bool,
}

impl GridNeighbor {
    /// The state that a robot told; `None` for a robot with another protocol.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn told<S>(robot: &Neighbor<S, GridPayload>) -> Option<Self> {
        let GridPayload { cell, target, busy_ms, heading, slot, leader } = robot.payload?;
        let busy_until = robot.heard + Duration::from_millis(busy_ms.into());
        let Neighbor { id, heard, mode, .. } = *robot;
        Some(Self { id, heard, busy_until, cell, target, leader, heading, slot, mode, is_peer: true })
    }

    /// A robot that does not tell its cell, and stands for all that is known.
    const fn stranger<S>(robot: &Neighbor<S, GridPayload>, cell: Cell) -> Self {
        Self {
            id: robot.id,
            heard: robot.heard,
            busy_until: robot.heard,
            cell,
            target: cell,
            leader: RobotId::NONE,
            heading: Dir::Stay,
            slot: 0,
            mode: robot.mode,
            is_peer: false,
        }
    }
}

impl<'a, S: Copy> View<'a, S, Grid> {
    /// The known robots in the order of ids, on the grid. In the plane those of other protocols
    /// are in the cells of their positions; on the grid they are left out.
    pub fn on_grid(&self) -> impl Iterator<Item = GridNeighbor> + Clone + use<'a, S> {
        let view = *self;
        view.neighbors().filter_map(move |robot| view.in_cell(&robot))
    }

    /// One robot on the grid. O(log N).
    #[must_use]
    pub fn grid_neighbor(&self, id: RobotId) -> Option<GridNeighbor> {
        self.neighbor(id).and_then(|robot| self.in_cell(&robot))
    }

    fn in_cell(&self, robot: &Neighbor<S, GridPayload>) -> Option<GridNeighbor> {
        let stranger = || self.cells.map(|cells| GridNeighbor::stranger(robot, cells.cell_at(robot.position)));
        GridNeighbor::told(robot).or_else(stranger)
    }
}

/// Stops that a robot keeps at a time; further ones are refused.
const STOPS: usize = 4;

/// The stops that other robots asked for.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stops(Vec<Stop, STOPS, u8>);

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Stop {
    from: RobotId,
    origin: RobotId,
    until: Instant,
}

impl Stops {
    const NONE: Self = Self(Vec::new());

    /// Takes in a stop or a resume. Returns whether to pass it on to the own leader.
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    fn receive(&mut self, from: RobotId, origin: RobotId, valid_ms: Option<u16>, now: Instant) -> bool {
        self.0.retain(|stop| (stop.from, stop.origin) != (from, origin) && !is_over(stop.until, now));
        let Some(valid_ms) = valid_ms else { return true };
        self.0.push(Stop { from, origin, until: now + Duration::from_millis(valid_ms.into()) }).is_ok()
    }

    fn until(&self) -> Option<Instant> {
        let first = self.0.first()?.until;
        self.0.iter().map(|stop| stop.until).max_by_key(|until| until.since(first))
    }
}

/// Whether a stop has ended; also after a pause of any length.
pub(crate) const fn is_over(until: Instant, now: Instant) -> bool {
    now.has_reached(until, Duration::from_millis(u16::MAX as i32))
}

/// The goal of a law on the grid, the stops that other robots asked for, and the report.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GridTask {
    goal: Option<Goal>,
    stops: Stops,
    /// The robot to which messages for the leader go, as long as it is not heard itself.
    pub(crate) next_hop: RobotId,
    /// The report, without the stops.
    pub shown: Report,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Goal {
    Own(Cell),
    /// For the top leader; this robot heads for its own place beside it.
    Formation(Cell),
}

impl GridTask {
    /// Without a goal.
    pub const NEW: Self = Self { goal: None, stops: Stops::NONE, next_hop: RobotId::NONE, shown: Report::NONE };

    /// Takes in a goal; `offset` is the own place beside the top leader. False for other orders.
    pub fn order(&mut self, order: &GridOrder, offset: Cell) -> bool {
        let (goal, target) = match order {
            GridOrder::Goal(goal) => (Goal::Own(*goal), *goal),
            GridOrder::FormationGoal(top) => (Goal::Formation(*top), *top + offset),
            GridOrder::Template { .. } => return false,
        };
        self.goal = Some(goal);
        (self.shown.goal, self.shown.target) = (Some(target), Some(target));
        true
    }

    /// Stores a stop or a resume, and passes it on to the leader. The robot decides at once after
    /// each message that is not for all.
    pub fn receive(&mut self, from: RobotId, message: &GridMessage, radio: &mut Radio<'_, Grid>) {
        if matches!(message, GridMessage::Land(_)) {
            return;
        }
        radio.decide_at_once();
        let (origin, valid_ms) = match *message {
            GridMessage::Stop { origin, valid_ms } => (origin, Some(valid_ms)),
            GridMessage::Resume { origin } => (origin, None),
            GridMessage::Redirect | GridMessage::Land(_) => return,
        };
        let leader = self.shown.leader;
        if self.stops.receive(from, origin, valid_ms, radio.now()) && leader.is_some() && leader != origin {
            let valid = valid_ms.map_or(radio.valid, |millis| Duration::from_millis(millis.into()));
            radio.send(self.towards(leader), message, valid);
        }
    }

    /// The robot to which a message for the leader goes.
    pub(crate) const fn towards(&self, leader: RobotId) -> RobotId {
        if self.next_hop.is_some() { self.next_hop } else { leader }
    }

    /// Until when another robot asked this one to stop.
    #[must_use]
    pub fn stopped_until(&self) -> Option<Instant> {
        self.stops.until()
    }

    /// Whether a stop is in force.
    #[must_use]
    pub fn is_stopped(&self, now: Instant) -> bool {
        self.stopped_until().is_some_and(|until| !is_over(until, now))
    }

    /// The cell to go to; `None` without a goal. Drops stops that have ended.
    #[must_use]
    pub fn goal<S>(&mut self, view: &Scene<'_, S>, offset: Cell) -> Option<Cell> {
        self.stops.0.retain(|stop| !is_over(stop.until, view.now));
        let own = self.goal.map(|goal| match goal {
            Goal::Own(goal) => goal,
            Goal::Formation(top) => top + offset,
        });
        view.sent_to.or(own)
    }

    /// Shows the goal and the cell that the robot heads for.
    pub fn show(&mut self, goal: Cell, target: Cell) {
        (self.shown.goal, self.shown.target) = (Some(goal), Some(target));
    }

    /// Returns the report of the law.
    #[must_use]
    pub fn report(&self) -> Report {
        Report { stopped_until: self.stopped_until(), ..self.shown }
    }

    /// Returns the payload of a beacon.
    #[must_use]
    pub fn payload(&self, here: &OnGrid<'_>, heading: Dir) -> GridPayload {
        let CellState { cell, busy } = here.cell;
        let busy_ms = busy.as_micros().max(0).checked_div(1000).unwrap_or(0);
        GridPayload {
            cell,
            target: self.shown.target.unwrap_or_default(),
            busy_ms: u16::try_from(busy_ms).unwrap_or(u16::MAX),
            heading,
            slot: self.shown.slot,
            leader: if self.shown.leader > MAX_LEADER { RobotId::NONE } else { self.shown.leader },
        }
    }
}

#[cfg(all(test, feature = "host"))]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_payload_reader_agrees_with_postcard(
            payload in ((any::<[i16; 4]>(), any::<u16>()), 0..=8_u8, any::<u8>(), 0..1_u32 << 29),
            damage in any::<(usize, u8, bool)>(),
        ) {
            let (([x, y, to_x, to_y], busy_ms), heading, slot, leader) = payload;
            let (cell, target) = (Cell::new(x, y), Cell::new(to_x, to_y));
            let payload = GridPayload { cell, target, busy_ms, heading: Dir::from_index(heading), slot, leader: RobotId(leader) };
            let mut buffer = [0; 20];
            let bytes = postcard::to_slice(&payload, &mut buffer).unwrap();
            let is_short = leader < 1 << 28;
            prop_assert_eq!(GridPayload::read(bytes), is_short.then_some(payload));
            let (at, flips, is_cut) = damage;
            let at = at % bytes.len();
            bytes[at] ^= flips;
            let bytes = if is_cut { &bytes[..at] } else { &bytes[..] };
            if let Some(read) = GridPayload::read(bytes) {
                prop_assert_eq!(postcard::from_bytes(bytes), Ok(read));
            }
        }
    }
}
