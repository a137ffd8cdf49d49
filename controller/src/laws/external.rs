//! A law whose decisions come from outside the agent, such as from firmware in another language.

use super::any_protocol::{AnyMessage, AnyOrder, AnyPayload, AnyProtocol, OtherPayload, Raw};
use crate::grid::Dir;
use crate::law::{Action, AnySurroundings, BadInput, Decision, Law, OnGrid, Progress, Radio, Tools, View};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Duration;
use crate::wire::{Bytes, MAX_CONTENT, MAX_MESSAGE, ProtocolId};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Received messages that wait, and messages to single robots that wait.
const QUEUE: usize = 4;

/// A message or an order that an [`External`] law received.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Incoming {
    /// The sender; [`RobotId::NONE`] for an order.
    pub from: RobotId,
    /// Whether it is an order rather than a message.
    pub is_order: bool,
    /// The content.
    pub bytes: Bytes<MAX_CONTENT>,
}

/// Does what its owner decides between [`Agent::hear_into`] and [`Agent::act_into`], or before a
/// whole step. The owner reaches it by [`Agent::law_mut`], and reads the payloads of others in
/// [`Agent::neighbors`].
///
/// A decision is used once: unless it is renewed, the robot stays ([`Action::Stay`]) from then on,
/// so an owner that hangs stops its robot. A decision to be idle holds until the next one.
/// Velocities need [`InPlane::max_speed_mps`] above 0, and moves [`OnGrid`] with its window;
/// without them the robot is in [`Mode::Fault`](crate::robot::Mode::Fault).
///
/// [`Agent::hear_into`]: crate::agent::Agent::hear_into
/// [`Agent::act_into`]: crate::agent::Agent::act_into
/// [`Agent::law_mut`]: crate::agent::Agent::law_mut
/// [`Agent::neighbors`]: crate::agent::Agent::neighbors
/// [`InPlane::max_speed_mps`]: crate::agent::InPlane::max_speed_mps
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct External<S> {
    protocol: ProtocolId,
    next: Decision<S>,
    payload: AnyPayload,
    to_one: Vec<(RobotId, Duration, Bytes<MAX_MESSAGE>), QUEUE, u8>,
    to_all: Option<Bytes<MAX_CONTENT>>,
    inbox: Vec<Incoming, QUEUE, u8>,
    dropped: u16,
}

impl<S: Scalar> External<S> {
    /// Creates the law without a decision: the robot is idle. `protocol` is 64 to 255.
    #[must_use]
    pub fn new(protocol: ProtocolId) -> Self {
        Self {
            protocol,
            next: Decision::idle(),
            payload: AnyPayload::Empty(protocol),
            to_one: Vec::new(),
            to_all: None,
            inbox: Vec::new(),
            dropped: 0,
        }
    }

    /// Sets the next decision.
    pub fn set_decision(&mut self, decision: Decision<S>) {
        self.next = decision;
    }

    /// Sets the payload of each beacon from now on. Returns whether it fits.
    pub fn set_payload(&mut self, bytes: &[u8]) -> bool {
        let payload = match bytes {
            [] => Some(AnyPayload::Empty(self.protocol)),
            bytes => OtherPayload::new(self.protocol, bytes).map(AnyPayload::Other),
        };
        payload.map(|payload| self.payload = payload).is_some()
    }

    /// Sends a message to one robot at the next decision, as [`Radio::send`] does. A newer message
    /// to a robot replaces one that it has not acknowledged. Returns whether it fits: four wait at
    /// most.
    pub fn send(&mut self, to: RobotId, bytes: &[u8], valid: Duration) -> bool {
        let Ok(bytes) = Bytes::from_slice(bytes) else { return false };
        to.is_some() && self.to_one.push((to, valid, bytes)).is_ok()
    }

    /// Sends a message to all robots at the next decision, as [`Radio::broadcast`] does. Returns
    /// whether it fits: one waits at most.
    pub fn broadcast(&mut self, bytes: &[u8]) -> bool {
        if self.to_all.is_some() {
            return false;
        }
        self.to_all = Bytes::from_slice(bytes).ok();
        self.to_all.is_some()
    }

    /// Takes out the oldest message or order. Four wait at most; another one replaces the oldest.
    pub fn take(&mut self) -> Option<Incoming> {
        let oldest = self.inbox.first().cloned();
        let mut is_oldest = true;
        self.inbox.retain(|_| !core::mem::take(&mut is_oldest));
        oldest
    }

    /// Messages and orders that were replaced before they were taken out; it saturates.
    #[must_use]
    pub const fn dropped(&self) -> u16 {
        self.dropped
    }

    /// Stores what has its protocol. Returns whether it has.
    fn keep<const N: usize>(&mut self, from: RobotId, is_order: bool, raw: &Raw<N>) -> bool {
        let bytes = Bytes::from_slice(&raw.bytes).ok().filter(|_| raw.id == self.protocol);
        let Some(bytes) = bytes else { return false };
        if self.inbox.is_full() {
            self.take();
            self.dropped = self.dropped.saturating_add(1);
        }
        self.inbox.push(Incoming { from, is_order, bytes }).is_ok()
    }

    fn post(&mut self, radio: &mut Radio<'_, AnyProtocol>) {
        let id = self.protocol;
        let message = |bytes: &[u8]| Raw::new(id, bytes).map(AnyMessage::Other);
        for (to, valid, bytes) in &self.to_one {
            let _ = message(bytes).is_some_and(|message| radio.send(*to, &message, *valid));
        }
        self.to_one.clear();
        if let Some(message) = self.to_all.take().and_then(|bytes| message(&bytes)) {
            radio.broadcast(&message);
        }
    }
}

impl<S: Scalar> Law<S> for External<S> {
    type Surroundings<'a> = AnySurroundings<'a, S>;
    type Protocol = AnyProtocol;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, AnyProtocol>,
        here: &AnySurroundings<'_, S>,
        mut tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        self.post(&mut tools.radio);
        if self.next.progress == Progress::Idle {
            return Ok(self.next.clone());
        }
        let decision = core::mem::take(&mut self.next);
        match decision.action {
            Action::Velocity { .. } => view.can_move()?,
            Action::Moves(_) => OnGrid::try_from(*here)?.seen().map(|_| ())?,
            Action::Stay | Action::Release => {}
        }
        Ok(decision)
    }

    fn payload(&mut self, _: &AnySurroundings<'_, S>, _: Dir, _: &mut Radio<'_, AnyProtocol>) -> AnyPayload {
        self.payload
    }

    fn receive(&mut self, from: RobotId, message: &AnyMessage, _: &mut Radio<'_, AnyProtocol>) -> bool {
        matches!(message, AnyMessage::Other(raw) if self.keep(from, false, raw))
    }

    fn order(&mut self, order: &AnyOrder) -> bool {
        matches!(order, AnyOrder::Other(raw) if self.keep(RobotId::NONE, true, raw))
    }
}
