//! The words of robots with one law, beyond their kinematics, and of their operator.

use super::Waypoint;
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use crate::wire::{Addressed, Bytes, Content, MAX_CONTENT, MAX_MESSAGE, Message, Never, ProtocolId};
use core::marker::PhantomData;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The vocabulary of one or more laws. Laws that share a protocol understand each other.
pub trait Protocol: Clone + core::fmt::Debug {
    /// Its number in each frame.
    const ID: ProtocolId;
    /// A part of each beacon, at most [`MAX_PAYLOAD`](crate::wire::MAX_PAYLOAD) bytes: a state
    /// rather than a change, since receivers may get it late, repeatedly or never.
    type Payload: Content + Copy + Default + Send + Sync;
    /// To one robot, acknowledged and resent, at most [`MAX_MESSAGE`] bytes; or to all, once, at
    /// most [`MAX_CONTENT`] bytes.
    type Message: Content;
    /// From the operator, by radio or by the firmware, at most
    /// [`MAX_ORDER`](crate::wire::MAX_ORDER) bytes.
    type Order: Content;

    /// A newer message to the same robot about the same subject replaces an older one.
    fn subject(_message: &Self::Message) -> u32 {
        0
    }

    /// A newer order about the same subject replaces an older one, and repeats are recognised.
    /// `None`: the law gets every copy.
    fn order_subject(_order: &Self::Order) -> Option<u32> {
        Some(0)
    }

    /// Completes an order that came by radio. `sent`: when, own clock. `is_restarted`: it has no
    /// subject, and is by another operator than the last such order, or by one that restarted.
    fn received(_order: &mut Self::Order, _sent: Instant, _is_restarted: bool) {}

    /// Returns an order as a message to the robot `to`, or to all robots with [`RobotId::NONE`].
    /// `number` is 1 higher for each new order about the subject, and the same in repeats. `None`
    /// if the order has too many bytes.
    #[must_use]
    fn order(to: RobotId, number: u8, order: &Self::Order) -> Option<Message> {
        let (protocol, content) = order.encode(Self::ID)?;
        Some(Message::Order(Addressed { to, number, protocol, content }))
    }
}

/// The protocol of a law that says nothing.
impl Protocol for () {
    const ID: ProtocolId = ProtocolId::NONE;
    type Payload = ();
    type Message = Never;
    type Order = Never;
}

/// The protocol of the laws with waypoints.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Waypoints {}

impl Protocol for Waypoints {
    const ID: ProtocolId = ProtocolId(2);
    type Payload = ();
    type Message = Never;
    type Order = WaypointOrder;

    fn order_subject(order: &WaypointOrder) -> Option<u32> {
        Some(order.index.into())
    }

    fn received(order: &mut WaypointOrder, sent: Instant, _: bool) {
        order.waypoint.at = sent;
    }
}

/// Sets a waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointOrder {
    /// Its number, below [`WAYPOINTS`](super::WAYPOINTS).
    pub index: u8,
    /// The waypoint.
    #[serde(with = "on_air")]
    pub waypoint: Waypoint<f32>,
}

impl Content for WaypointOrder {}

impl WaypointOrder {
    /// Waypoint 0: the start of a new course.
    #[must_use]
    pub const fn first(waypoint: Waypoint<f32>) -> Self {
        Self { index: 0, waypoint }
    }
}

/// A waypoint in 18 bytes: millimetres and millimetres per second, when the frame was sent.
mod on_air {
    use super::{Instant, Position, Vec3, Waypoint};
    use crate::fixint::Fixed;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<Z: Serializer>(waypoint: &Waypoint<f32>, to: Z) -> Result<Z::Ok, Z::Error> {
        let Vec3 { x, y, z } = waypoint.velocity_mps;
        let milli = |mps: f32| crate::scalar::Scalar::to_milli(mps).unwrap_or(0);
        let velocity_mmps = [x, y, z].map(|mps| milli(mps).clamp(i16::MIN.into(), i16::MAX.into()) as i16);
        (waypoint.position.mm.to_bytes(), velocity_mmps.to_bytes()).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Waypoint<f32>, D::Error> {
        let (mm, mmps) = Deserialize::deserialize(from)?;
        let mmps = <[i16; 3]>::from_bytes(mmps);
        Ok(Waypoint {
            position: Position::from_mm(Fixed::from_bytes(mm)),
            velocity_mps: Vec3::from_milli(mmps.map(i32::from)),
            at: Instant::from_micros(0),
        })
    }
}

/// Messages that a law can send to single robots in one step.
const MESSAGES: usize = 4;

#[derive(Clone, Debug)]
pub(super) struct Queued {
    pub(super) to: RobotId,
    pub(super) subject: u32,
    pub(super) protocol: ProtocolId,
    pub(super) content: Bytes<MAX_MESSAGE>,
    pub(super) valid: Duration,
}

/// The messages of a law that the agent will send.
#[derive(Clone, Debug, Default)]
pub struct Outgoing {
    pub(super) messages: Vec<Queued, MESSAGES>,
    pub(super) broadcast: Option<(ProtocolId, Bytes<MAX_CONTENT>)>,
    decides_at_once: bool,
}

/// Sends messages of protocol `P`.
#[derive(Debug)]
pub struct Radio<'t, P> {
    now: Instant,
    outgoing: &'t mut Outgoing,
    /// How long requests hold, [`AgentConfig::message_valid`](super::AgentConfig).
    pub valid: Duration,
    protocol: PhantomData<fn(P)>,
}

impl<'t, P> Radio<'t, P> {
    /// Collects messages in `outgoing`; `now` is the time of the step. For tests of laws.
    #[must_use]
    pub const fn new(now: Instant, valid: Duration, outgoing: &'t mut Outgoing) -> Self {
        Self { now, outgoing, valid, protocol: PhantomData }
    }

    /// Time of the step.
    #[must_use]
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Makes a [`CellFollower`](super::CellFollower) decide at once rather than in the next cell.
    pub const fn decide_at_once(&mut self) {
        self.outgoing.decides_at_once = true;
    }

    /// Whether the law inside must decide at once.
    pub(super) fn takes_decision(&mut self) -> bool {
        core::mem::take(&mut self.outgoing.decides_at_once)
    }

    /// The same radio for a law inside another one.
    pub const fn of<T>(&mut self) -> Radio<'_, T> {
        Radio { now: self.now, outgoing: self.outgoing, valid: self.valid, protocol: PhantomData }
    }
}

impl<P: Protocol> Radio<'_, P> {
    /// Sends a message to one robot, again until it is acknowledged, for `valid` at most; then the
    /// agent reports [`MessageExpired`](super::Event::MessageExpired). A message about the same
    /// subject to the same robot is replaced. Returns whether there is room for it: it has at most
    /// [`MAX_MESSAGE`] bytes, and in one step a law sends at most four.
    pub fn send(&mut self, to: RobotId, message: &P::Message, valid: Duration) -> bool {
        let Some((protocol, content)) = message.encode(P::ID).filter(|_| to.is_some()) else { return false };
        let queued = Queued { to, subject: P::subject(message), protocol, content, valid };
        self.outgoing.messages.push(queued).is_ok()
    }

    /// Sends a message to all, once, if it fits the frames of this step.
    pub fn broadcast(&mut self, message: &P::Message) {
        self.outgoing.broadcast = message.encode(P::ID);
    }

    /// Takes back the messages to single robots of this step that `stays` returns false for.
    pub(super) fn retain(&mut self, stays: impl Fn(&P::Message) -> bool) {
        self.outgoing.messages.retain(|queued| {
            let message = P::Message::decode(P::ID, queued.protocol, &queued.content);
            message.is_none_or(|message| stays(&message))
        });
    }
}
