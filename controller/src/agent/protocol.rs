//! What robots with one law say to each other beyond where they are, and an operator to them.

use super::Waypoint;
use crate::grid::Cell;
use crate::land::LandPatch;
use crate::robot::RobotId;
use crate::time::Instant;
use crate::wire::{Payload, RequestKind, TemplateAssignment};
use core::fmt::Debug;
use core::marker::PhantomData;
use heapless::Vec;

/// The vocabulary of one or more laws. Laws that share a protocol understand each other.
pub trait Protocol {
    /// Sent after each beacon and received as [`Neighbor::payload`](crate::neighbor::Neighbor);
    /// `()` for none, at no cost.
    type Payload: Payload;
    /// To one robot, acknowledged and resent, or to all, once.
    type Message: LawMessage;
    /// From the operator, by radio or by the firmware.
    type Order: LawOrder;
}

/// The protocol of a law that says nothing.
impl Protocol for () {
    type Payload = ();
    type Message = Never;
    type Order = Never;
}

/// No message and no order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Never {}

/// A message as the frames of robots carry it.
pub trait LawMessage: Clone + Debug {
    /// From [`Message::Request`](crate::wire::Message) of the kind `Redirect`.
    #[must_use]
    fn redirect() -> Option<Self> {
        None
    }

    /// From [`Message::Land`](crate::wire::Message).
    #[must_use]
    fn land(_patch: LandPatch) -> Option<Self> {
        None
    }

    /// The request that carries the message.
    fn request(&self) -> Option<RequestKind> {
        None
    }

    /// The patch that carries the message.
    fn patch(&self) -> Option<&LandPatch> {
        None
    }
}

/// An order as frames and the host's tasks carry it.
pub trait LawOrder: Clone + Debug {
    /// A goal for this robot alone.
    #[must_use]
    fn goal(_goal: Cell) -> Option<Self> {
        None
    }

    /// A goal for the top leader of the formation; this robot heads for its own place beside it.
    #[must_use]
    fn formation_goal(_goal: Cell) -> Option<Self> {
        None
    }

    /// A part of a template; `is_restarted`: its sender changed or restarted.
    #[must_use]
    fn template(_part: &TemplateAssignment, _is_restarted: bool) -> Option<Self> {
        None
    }

    /// Waypoint `index`.
    #[must_use]
    fn waypoint(_index: u8, _waypoint: Waypoint<f32>) -> Option<Self> {
        None
    }
}

impl LawMessage for Never {}
impl LawOrder for Never {}

/// The protocol of the laws that plan on the grid.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Grid {}

impl Protocol for Grid {
    type Payload = ();
    type Message = GridMessage;
    type Order = GridOrder;
}

/// A message between robots that plan on the grid (A. V. Kuznetsov 2017, KUZ, section 7).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GridMessage {
    /// A request. `Stop` and `Resume` reach the agent, which stops every robot that leads.
    Request(RequestKind),
    /// A patch of the sender's map, to all.
    Land(LandPatch),
}

impl LawMessage for GridMessage {
    fn redirect() -> Option<Self> {
        Some(Self::Request(RequestKind::Redirect))
    }

    fn land(patch: LandPatch) -> Option<Self> {
        Some(Self::Land(patch))
    }

    fn request(&self) -> Option<RequestKind> {
        match self {
            Self::Request(kind) => Some(*kind),
            Self::Land(_) => None,
        }
    }

    fn patch(&self) -> Option<&LandPatch> {
        match self {
            Self::Land(patch) => Some(patch),
            Self::Request(_) => None,
        }
    }
}

/// An order to a robot that plans on the grid.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GridOrder {
    /// Go to this cell, regardless of the place in a formation.
    Goal(Cell),
    /// The top leader of the formation goes to this cell, each other robot to its place beside it.
    FormationGoal(Cell),
    /// A part of the formation's template.
    Template {
        /// The part.
        part: TemplateAssignment,
        /// The sender changed or restarted, so its version numbers start anywhere.
        is_restarted: bool,
    },
}

impl LawOrder for GridOrder {
    fn goal(goal: Cell) -> Option<Self> {
        Some(Self::Goal(goal))
    }

    fn formation_goal(goal: Cell) -> Option<Self> {
        Some(Self::FormationGoal(goal))
    }

    fn template(part: &TemplateAssignment, is_restarted: bool) -> Option<Self> {
        Some(Self::Template { part: part.clone(), is_restarted })
    }
}

/// The protocol of the laws with waypoints.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Waypoints {}

impl Protocol for Waypoints {
    type Payload = ();
    type Message = Never;
    type Order = WaypointOrder;
}

/// Sets a waypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointOrder {
    /// Its number, below [`WAYPOINTS`](super::WAYPOINTS).
    pub index: u8,
    /// The waypoint.
    pub waypoint: Waypoint<f32>,
}

impl WaypointOrder {
    /// Waypoint 0: the start of a new course.
    #[must_use]
    pub const fn first(waypoint: Waypoint<f32>) -> Self {
        Self { index: 0, waypoint }
    }
}

impl LawOrder for WaypointOrder {
    fn waypoint(index: u8, waypoint: Waypoint<f32>) -> Option<Self> {
        Some(Self { index, waypoint })
    }
}

/// The protocol of an enum of built-in laws.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnyProtocol {}

impl Protocol for AnyProtocol {
    type Payload = ();
    type Message = GridMessage;
    type Order = AnyOrder;
}

/// An order to a law that is chosen at run time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyOrder {
    Grid(GridOrder),
    Waypoint(WaypointOrder),
}

impl LawOrder for AnyOrder {
    fn goal(goal: Cell) -> Option<Self> {
        GridOrder::goal(goal).map(Self::Grid)
    }

    fn formation_goal(goal: Cell) -> Option<Self> {
        GridOrder::formation_goal(goal).map(Self::Grid)
    }

    fn template(part: &TemplateAssignment, is_restarted: bool) -> Option<Self> {
        GridOrder::template(part, is_restarted).map(Self::Grid)
    }

    fn waypoint(index: u8, waypoint: Waypoint<f32>) -> Option<Self> {
        WaypointOrder::waypoint(index, waypoint).map(Self::Waypoint)
    }
}

/// An order for another law, or a message for one that takes none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OfAnotherLaw;

impl TryFrom<AnyOrder> for GridOrder {
    type Error = OfAnotherLaw;
    fn try_from(order: AnyOrder) -> Result<Self, OfAnotherLaw> {
        if let AnyOrder::Grid(order) = order { Ok(order) } else { Err(OfAnotherLaw) }
    }
}

impl TryFrom<AnyOrder> for WaypointOrder {
    type Error = OfAnotherLaw;
    fn try_from(order: AnyOrder) -> Result<Self, OfAnotherLaw> {
        if let AnyOrder::Waypoint(order) = order { Ok(order) } else { Err(OfAnotherLaw) }
    }
}

impl TryFrom<AnyOrder> for Never {
    type Error = OfAnotherLaw;
    fn try_from(_: AnyOrder) -> Result<Self, OfAnotherLaw> {
        Err(OfAnotherLaw)
    }
}

impl TryFrom<GridMessage> for Never {
    type Error = OfAnotherLaw;
    fn try_from(_: GridMessage) -> Result<Self, OfAnotherLaw> {
        Err(OfAnotherLaw)
    }
}

/// Messages that a law can send to single robots in one step.
const MESSAGES: usize = 3;

/// The messages of a law that the agent will send.
#[derive(Clone, Debug, Default)]
pub struct Outgoing {
    pub(super) requests: Vec<(RobotId, RequestKind), MESSAGES>,
    pub(super) patch: Option<LandPatch>,
}

/// Sends messages `M` of a law.
#[derive(Debug)]
pub struct Radio<'t, M> {
    now: Instant,
    outgoing: &'t mut Outgoing,
    messages: PhantomData<fn(M)>,
}

impl<'t, M> Radio<'t, M> {
    /// Collects messages in `outgoing`; `now` is the time of the step. For tests of laws.
    #[must_use]
    pub const fn new(now: Instant, outgoing: &'t mut Outgoing) -> Self {
        Self { now, outgoing, messages: PhantomData }
    }

    /// Time of the step.
    #[must_use]
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// The same radio for a law inside another one.
    pub const fn of<T>(&mut self) -> Radio<'_, T> {
        Radio { now: self.now, outgoing: self.outgoing, messages: PhantomData }
    }

    /// Takes requests of this kind back.
    pub(super) fn retract(&mut self, kind: RequestKind) {
        self.outgoing.requests.retain(|(_, other)| *other != kind);
    }
}

impl<M: LawMessage> Radio<'_, M> {
    /// Sends a message to one robot, again until it is acknowledged or expires. Returns whether
    /// there is room for it.
    pub fn send(&mut self, to: RobotId, message: &M) -> bool {
        let request = message.request();
        request.is_some_and(|kind| self.outgoing.requests.push((to, kind)).is_ok())
    }

    /// Sends a message to all, once, if it fits the frames of this step.
    pub fn broadcast(&mut self, message: &M) {
        self.outgoing.patch = message.patch().cloned();
    }
}
