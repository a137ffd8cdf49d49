//! The words of robots with one law, beyond their kinematics, and of their operator.

use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use crate::wire::{Addressed, Bytes, Content, MAX_CONTENT, MAX_MESSAGE, Message, Never, ProtocolId};
use core::marker::PhantomData;
use heapless::Vec;

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

/// A payload, a message or an order for a law that has another protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OfAnotherLaw;

/// Messages that a law can send to single robots in one step.
const MESSAGES: usize = 4;

#[derive(Clone, Debug)]
pub struct Queued {
    pub(crate) to: RobotId,
    pub(crate) subject: u32,
    pub(crate) protocol: ProtocolId,
    pub(crate) content: Bytes<MAX_MESSAGE>,
    pub(crate) valid: Duration,
}

/// The messages of a law that the agent will send.
#[derive(Clone, Debug, Default)]
pub struct Outgoing {
    pub(crate) messages: Vec<Queued, MESSAGES>,
    pub(crate) broadcast: Option<(ProtocolId, Bytes<MAX_CONTENT>)>,
    pub(crate) repeats_beacon: bool,
    decides_at_once: bool,
}

/// Sends messages of protocol `P`.
#[derive(Debug)]
pub struct Radio<'t, P> {
    now: Instant,
    outgoing: &'t mut Outgoing,
    /// How long requests hold, [`AgentConfig::message_valid`](crate::agent::AgentConfig).
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

    /// Makes a [`CellFollower`](crate::agent::CellFollower) decide at once, not in the next cell.
    pub const fn decide_at_once(&mut self) {
        self.outgoing.decides_at_once = true;
    }

    /// Sends the beacon of this step twice, and the broadcast behind it: for a bad radio and a law
    /// whose robots have to hear each other in each step. What does not fit is not sent again.
    pub const fn repeat_beacon(&mut self) {
        self.outgoing.repeats_beacon = true;
    }

    /// Whether the law inside must decide at once.
    pub(crate) fn takes_decision(&mut self) -> bool {
        core::mem::take(&mut self.outgoing.decides_at_once)
    }

    /// The same radio for a law inside another one.
    pub const fn of<T>(&mut self) -> Radio<'_, T> {
        Radio { now: self.now, outgoing: self.outgoing, valid: self.valid, protocol: PhantomData }
    }
}

impl<P: Protocol> Radio<'_, P> {
    /// Sends a message to one robot, again until it is acknowledged, for `valid` at most; then the
    /// agent reports [`Event::MessageExpired`](crate::agent::Event::MessageExpired). A message
    /// about the same subject to the same robot is replaced. Returns whether there is room for it:
    /// it has at most [`MAX_MESSAGE`] bytes, and in one step a law sends at most four.
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
    pub(crate) fn retain(&mut self, stays: impl Fn(&P::Message) -> bool) {
        self.outgoing.messages.retain(|queued| {
            let message = P::Message::decode(P::ID, queued.protocol, &queued.content);
            message.is_none_or(|message| stays(&message))
        });
    }
}
