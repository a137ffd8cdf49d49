//! The radio link of an agent: decodes received frames, encodes frames to send.

use super::AgentConfig;
use super::contact_loss::{ContactState, Listening};
use super::duplicate_id::EchoFilter;
use super::io::{Event, OUTBOX, Outputs};
use super::{KinematicState, Outgoing, Protocol, Radio};
use crate::body::Body;
use crate::geom::{Position, Torus, Vec3};
use crate::law::Queued;
use crate::list::SparseVec;
use crate::neighbor::{
    Ages, LossEstimate, Neighbor, NeighborTable, PlausibilityFilter, PlausibilityLimits, Put, Trace,
};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{
    Ack, Addressed, Arrival, Beacon, Broadcast, Content, DecodeError, Due, EncodeError, Frame, Header,
    IncomingMessages, IncomingOrders, KeyHeld, MAX_PAYLOAD, Message, OutgoingMessages, Wire,
};
use dates::{Pace, Sender};
use relay::Relay;
use serde::{Deserialize, Serialize};

mod audience;
mod dates;
mod identity;
mod relay;
mod sight;

pub(super) use audience::Hearing;
pub use relay::RELAYS;

const PENDING: usize = 4;
const INCOMING: usize = 4;
/// Subjects of orders: one goal, or the waypoints.
const ORDERS: usize = 4;

/// A message or an order for the law.
pub(super) enum Received<Q: Protocol> {
    /// The payload of a new beacon, and when it was sent.
    Payload(RobotId, Q::Payload, Instant),
    /// Call [`Link::take_message`] with the receipt if the law takes it; none if it is for all.
    Message(RobotId, Q::Message, Option<Receipt>),
    /// Call [`Link::take_order`] with the receipt if the law takes it.
    Order(Q::Order, Receipt),
}

/// Identifies a message or an order.
pub(super) struct Receipt {
    header: Header,
    number: u8,
    subject: Option<u32>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(serialize = "S: Serialize, W: Serialize", deserialize = "S: Deserialize<'de>, W: Deserialize<'de>"))]
pub(super) struct Link<S, const N: usize, W, Q: Protocol> {
    wire: W,
    header: Header,
    said: EchoFilter,
    pub(super) table: NeighborTable<S, N, Q::Payload>,
    pub(super) contact: ContactState,
    pub(super) listening: Listening,
    suspects: PlausibilityFilter,
    loss: LossEstimate,
    senders: SparseVec<Sender, N>,
    outgoing: OutgoingMessages<PENDING>,
    incoming: IncomingMessages<INCOMING>,
    orders: IncomingOrders<ORDERS>,
    beacon_due: Instant,
    /// Up to when the own numbers count beacon periods.
    counted: Instant,
    has_sent: bool,
    relay: Relay,
    /// Constant in a run, so digests omit it.
    #[cfg(feature = "host")]
    #[serde(with = "crate::digest::uncounted")]
    torus: Option<Torus<S>>,
}

/// The context of received frames; `heard_at` is the time at which arriving frames were sent.
#[derive(Clone, Copy)]
pub(super) struct ReceiveContext<'a, S> {
    pub(super) position: Position,
    pub(super) velocity_mps: Vec3<S>,
    pub(super) heard_at: Instant,
    pub(super) fastest_mps: Option<S>,
    pub(super) period: Duration,
    pub(super) latency: Duration,
    pub(super) relays: u8,
    pub(super) plausibility: &'a PlausibilityLimits<S>,
    pub(super) needs: &'a dyn Fn(RobotId) -> bool,
}

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    pub(super) const fn new(config: &AgentConfig<S>, wire: W) -> Self {
        let AgentConfig { id, boot, ages, retry, .. } = *config;
        Self {
            wire,
            header: Header { boot, sender: id, sequence: 0 },
            said: EchoFilter::new(),
            table: NeighborTable::new(ages).with_reach(config.contact_loss.reach_m),
            contact: if config.contact_loss.expects_others { ContactState::Forgotten } else { ContactState::Never },
            listening: Listening::NotStarted,
            suspects: PlausibilityFilter::new(),
            loss: LossEstimate::new(),
            senders: SparseVec::new(),
            outgoing: OutgoingMessages::new(id, boot, retry),
            incoming: IncomingMessages::new(ages.expire_after),
            orders: IncomingOrders::new(),
            beacon_due: Instant::from_micros(0),
            counted: Instant::from_micros(0),
            has_sent: false,
            relay: Relay::new(id),
            #[cfg(feature = "host")]
            torus: None,
        }
    }

    #[cfg(feature = "host")]
    pub(super) const fn set_torus(&mut self, torus: Torus<S>) {
        self.torus = Some(torus);
    }

    const fn torus(&self) -> Option<Torus<S>> {
        #[cfg(feature = "host")]
        return self.torus;
        #[cfg(not(feature = "host"))]
        None
    }

    fn image(&self, place: Position, other: Position) -> Position {
        self.torus().map_or(place, |torus| torus.image(place, other))
    }

    pub(super) const fn wire(&self) -> &W {
        &self.wire
    }

    pub(super) const fn wire_mut(&mut self) -> &mut W {
        &mut self.wire
    }

    /// Moves neighbours to the list of lost robots once their silence is longer than packet loss
    /// explains; if it `remembers`, only after [`Ages::expire_after`]. Comes first in each step.
    pub(super) fn expire(
        &mut self,
        own: Position,
        body: &Body<S>,
        now: Instant,
        config: &AgentConfig<S>,
        remembers: bool,
        out: &mut Outputs<S>,
    ) {
        let (period, latency) = (config.beacon_period, config.latency);
        if let Some(torus) = self.torus() {
            self.table.see_at(|place| torus.image(place, own));
        }
        let keeps = self.wire.is_authenticated();
        if keeps {
            self.forget_numbers(now, period);
        }
        let (senders, loss) = (&mut self.senders, &mut self.loss);
        let Ages { stale_after, expire_after } = self.table.ages();
        let patience = if remembers {
            expire_after
        } else {
            loss.patience(self.table.len(), period, expire_after).max(stale_after)
        };
        let longest = Duration::from_micros(patience.as_micros().saturating_add(latency.as_micros()));
        let missed = patience.as_micros().checked_div(period.as_micros()).unwrap_or(0);
        let on_s = S::from_micro(period.as_micros()).max(body.step_s) + config.lag_s;
        self.table.expire((body, on_s), now, (longest, remembers), |lost| {
            loss.gave_up(u16::try_from(missed).unwrap_or(u16::MAX));
            // With a key its next frame may be one that an attacker has kept.
            if !keeps {
                senders.retain(|sender| sender.id != lost);
            }
            report(out, Event::NeighborLost(lost));
        });
    }

    pub(super) fn next_frame<'a>(&self, inbox: &mut &'a [u8]) -> Option<&'a [u8]> {
        self.wire.next_frame(inbox)
    }

    /// Decodes a frame, or counts it as rejected. Frames of other systems on the same band count as
    /// neither received nor rejected.
    pub(super) fn decode(&mut self, bytes: &[u8], out: &mut Outputs<S>) -> Option<Frame> {
        let error = match self.wire.decode(bytes) {
            Ok(frame) => return Some(frame),
            Err(DecodeError::Foreign) => return None,
            Err(error) => error,
        };
        out.refused.count(error);
        out.rejected = out.rejected.saturating_add(1);
        None
    }

    /// Returns a message that the agent must handle.
    pub(super) fn hear(
        &mut self,
        frame: &Frame,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<Received<Q>> {
        let id = self.known_as(frame, listener, out);
        let accepted = id.and_then(|id| {
            let (arrival, heard_at) = self.arrival(id, frame.header, listener, out)?;
            Some((id, arrival, ReceiveContext { heard_at, ..*listener }))
        });
        let count = if accepted.is_some() { &mut out.received } else { &mut out.rejected };
        *count = count.saturating_add(1);
        let (id, arrival, listener) = accepted?;
        self.take(frame, id, arrival, now, &listener, out)
    }

    /// Returns also when it was sent; `None` if the frame must be refused.
    fn arrival(
        &mut self,
        sender: RobotId,
        header: Header,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<(Arrival, Instant)> {
        let ReceiveContext { heard_at, period, latency, .. } = *listener;
        let Some(known) = self.senders.iter_mut().find(|known| known.id == sender) else {
            return Some((Arrival::New, heard_at));
        };
        let (missed, arrival, sent_at) = if self.wire.is_authenticated() {
            let missed = known.window.periods(header).saturating_sub(1);
            let (arrival, sent_at) = known.date(header, heard_at, &Pace { period, latency });
            (missed, arrival, sent_at)
        } else {
            (known.window.skipped(header), known.window.check(header), heard_at)
        };
        if arrival == Arrival::New {
            self.loss.heard(missed);
        }
        if arrival == Arrival::Rebooted {
            self.incoming.forget(sender);
            report(out, Event::NeighborRebooted(sender));
        }
        let is_recent = heard_at.since(sent_at) <= self.table.ages().expire_after;
        (arrival.is_accepted() && is_recent).then_some((arrival, sent_at))
    }

    fn take(
        &mut self,
        Frame { header, message, .. }: &Frame,
        id: RobotId,
        arrival: Arrival,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<Received<Q>> {
        let header = *header;
        let is_mine = |to: RobotId| to == self.header.sender;
        match message {
            Message::Beacon(beacon) if arrival.is_latest() => {
                let neighbor = Neighbor::from_beacon(id, beacon, Q::ID, listener.heard_at);
                let payload = neighbor.payload;
                self.keep(neighbor, header, now, listener, out);
                return payload.map(|payload| Received::Payload(id, payload, listener.heard_at));
            }
            Message::Law(Addressed { to, number, protocol, content }) if Q::Message::EXISTS && is_mine(*to) => {
                let message = Q::Message::decode(Q::ID, *protocol, content)?;
                let (number, subject) = (*number, Q::subject(&message));
                if self.incoming.is_repeat(header, number, subject, now) {
                    self.acknowledge(header, number, out);
                    return None;
                }
                let receipt = Receipt { header, number, subject: Some(subject) };
                return Some(Received::Message(id, message, Some(receipt)));
            }
            Message::Broadcast(Broadcast { protocol, content }) if Q::Message::EXISTS => {
                return Q::Message::decode(Q::ID, *protocol, content)
                    .map(|message| Received::Message(id, message, None));
            }
            Message::Ack(ack) if Q::Message::EXISTS => {
                let _ = self.outgoing.acknowledged(header.sender, ack);
            }
            Message::Order(Addressed { to, number, protocol, content })
                if Q::Order::EXISTS && (is_mine(*to) || !to.is_some()) =>
            {
                let (mut order, number) = (Q::Order::decode(Q::ID, *protocol, content)?, *number);
                let subject = Q::order_subject(&order);
                let is_restarted = subject.is_none() && self.orders.is_restarted(header);
                Q::received(&mut order, listener.heard_at, is_restarted);
                let is_news = self.orders.is_news(header, number, subject);
                return is_news.then_some(Received::Order(order, Receipt { header, number, subject }));
            }
            Message::Lost(told) if listener.fastest_mps.is_some() => {
                self.hear_told(id, told, None, now, listener, out);
            }
            Message::Relayed(said) if listener.relays > 0 => self.hear_relayed(id, said, now, listener, out),
            Message::Key(key) if is_mine(key.to) => {
                if let Some((generation, phase)) = self.wire.held() {
                    let held = KeyHeld { to: header.sender, generation, phase };
                    self.say_early(&Message::KeyHeld(held), out);
                }
            }
            _ => {}
        }
        None
    }

    fn keep(
        &mut self,
        mut neighbor: Neighbor<S, Q::Payload>,
        header: Header,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) {
        let id = neighbor.id;
        neighbor.position = self.image(neighbor.position, listener.position);
        self.cut(&mut neighbor, listener.plausibility, out);
        // Another robot has told of it since.
        let is_older = |known: &Neighbor<S, _>| known.trace == Trace::Told && neighbor.heard.is_before(known.heard);
        if self.known(id).is_some_and(is_older) {
            return;
        }
        self.table.note_reception(&mut neighbor, listener.position, listener.velocity_mps);
        self.contact = self.contact.heard(neighbor.heard);
        let put = self.table.put(neighbor, listener.position, now, listener.needs);
        self.note_eviction(put, out);
        if matches!(put, Put::Inserted | Put::Evicted(_)) {
            self.found(Sender::first(id, header, neighbor.heard), put, now);
            report(out, id.duplicate_of().map_or(Event::NeighborFound(id), Event::DuplicateId));
        }
    }

    /// Notes a robot that was put into the table.
    fn found(&mut self, sender: Sender, put: Put, now: Instant) {
        let id = sender.id;
        self.note_sender(sender);
        // In a full table others are found for ever.
        if put == Put::Inserted {
            self.relay.tell_next(id);
            self.listening.note(now);
        }
    }

    fn note_eviction(&mut self, put: Put, out: &mut Outputs<S>) {
        if let Put::Evicted(evicted) = put {
            if !self.wire.is_authenticated() {
                self.senders.retain(|sender| sender.id != evicted);
            }
            report(out, Event::NeighborEvicted(evicted));
        }
    }

    /// Acknowledges a message, and recognises its repeats.
    pub(super) fn take_message(&mut self, receipt: &Receipt, now: Instant, out: &mut Outputs<S>) {
        let Receipt { header, number, subject } = *receipt;
        self.incoming.note(header, number, subject.unwrap_or_default(), now);
        self.acknowledge(header, number, out);
    }

    fn acknowledge(&mut self, header: Header, number: u8, out: &mut Outputs<S>) {
        self.say_early(&Message::Ack(Ack { to: header.sender, boot: header.boot, number }), out);
    }

    /// Recognises the repeats of an order. One that the law did not take comes again.
    pub(super) fn take_order(&mut self, Receipt { header, number, subject }: Receipt) {
        if let Some(subject) = subject {
            self.orders.note(header, number, subject);
        }
    }

    /// Queues the messages of a law to single robots. One is dropped if the queue is full, because
    /// its cause will recur.
    pub(super) fn queue(&mut self, outgoing: &Outgoing, now: Instant) {
        for Queued { to, subject, protocol, content, valid } in &outgoing.messages {
            let _ = self.outgoing.send(*to, *subject, (*protocol, content), *valid, now);
        }
    }

    /// Queues the messages of a law and broadcasts one, after messages or a decision.
    pub(super) fn send(&mut self, outgoing: &Outgoing, now: Instant, out: &mut Outputs<S>) {
        self.queue(outgoing, now);
        if let Some((protocol, content)) = &outgoing.broadcast {
            let (protocol, content) = (*protocol, content.clone());
            self.say_early(&Message::Broadcast(Broadcast { protocol, content }), out);
        }
    }

    #[cfg(all(test, feature = "auth"))]
    pub(super) fn is_quiet(&self) -> bool {
        self.outgoing.is_empty()
    }

    /// Sends due messages, the beacon if it is due, then a broadcast and a told state if they fit.
    /// Returns whether it sent a beacon.
    pub(super) fn speak(
        &mut self,
        now: Instant,
        config: &AgentConfig<S>,
        beacon: Beacon,
        payload: impl FnOnce(&mut Radio<'_, Q>) -> Q::Payload,
        out: &mut Outputs<S>,
    ) -> bool {
        if Q::Message::EXISTS {
            self.resend(now, out);
        }
        let period = config.beacon_period;
        let is_beacon_due = !self.has_sent || now.has_reached(self.beacon_due, period);
        if is_beacon_due {
            let own = Position::from_mm(beacon.position_mm);
            let mut outgoing = Outgoing::default();
            let payload = payload(&mut Radio::new(now, config.message_valid, &mut outgoing));
            let (protocol, payload) = payload.encode::<MAX_PAYLOAD>(Q::ID).unwrap_or_default();
            let beacon = Message::Beacon(Beacon { protocol, payload, ..beacon });
            self.count_periods(now, period);
            self.said.note(self.header.sequence, &beacon);
            let start = out.outbox.len();
            let again = |start: usize, out: &mut Outputs<S>| {
                if outgoing.repeats_beacon {
                    repeat(start, &mut out.outbox);
                }
            };
            if self.say(&beacon, 0, out) == Err(EncodeError::Exhausted) {
                report(out, Event::Muted);
            }
            // Each behind its first one: receivers take no beacon after later frames.
            again(start, out);
            self.queue(&outgoing, now);
            // A broadcast that does not fit is lost, as one in the air.
            if let Some((protocol, content)) = outgoing.broadcast.clone() {
                let start = out.outbox.len();
                let _ = self.say(&Message::Broadcast(Broadcast { protocol, content }), 0, out);
                again(start, out);
            }
            if let Some(told) = self.state_to_tell(own, now) {
                let _ = self.say(&Message::Lost(told), 0, out);
            }
            self.has_sent = true;
            self.beacon_due = now + period;
        }
        let message_due = if Q::Message::EXISTS { self.outgoing.poll_at(now) } else { None };
        out.call_again = message_due.filter(|due| due.is_before(self.beacon_due)).unwrap_or(self.beacon_due);
        is_beacon_due
    }

    fn resend(&mut self, now: Instant, out: &mut Outputs<S>) {
        // Polling twice per message always empties the list.
        for _ in 0..2 * PENDING {
            match self.outgoing.poll(now) {
                Some(Due::Send(message)) => self.say_early(&Message::Law(message), out),
                Some(Due::Expired(to)) => report(out, Event::MessageExpired(to)),
                None => break,
            }
        }
    }

    fn say_early(&mut self, message: &Message, out: &mut Outputs<S>) {
        // A dropped frame is requested again by its receiver.
        let _ = self.say(message, self.wire.beacon_len(), out);
    }

    /// Leaves `reserved` bytes free.
    fn say(&mut self, message: &Message, reserved: usize, out: &mut Outputs<S>) -> Result<(), EncodeError> {
        let before = out.outbox.len();
        self.wire.encode(self.header, message, &mut out.outbox)?;
        if out.outbox.len() + reserved > OUTBOX {
            out.outbox.truncate(before);
            return Err(EncodeError::Full);
        }
        self.header.sequence = self.header.sequence.wrapping_add(1);
        Ok(())
    }
}

/// Adds the bytes from `start` on once more, if they fit.
fn repeat(start: usize, outbox: &mut heapless::Vec<u8, OUTBOX>) {
    let end = outbox.len();
    if end.saturating_sub(start).saturating_add(end) <= OUTBOX {
        for at in start..end {
            let _ = outbox.get(at).copied().map(|byte| outbox.push(byte));
        }
    }
}

// Not inlined: it has many callers.
#[inline(never)]
pub(super) fn report<S>(out: &mut Outputs<S>, event: Event) {
    let _ = out.events.push(event);
}

/// The kinematic part of a beacon. Lengths saturate, and NaN counts as 0.
pub(super) fn beacon<S: Scalar>(
    config: &AgentConfig<S>,
    mode: Mode,
    state: &KinematicState<S>,
    velocity_mps: Vec3<S>,
) -> Beacon {
    let milli = |value: S| value.to_milli().unwrap_or(0);
    let narrow = |value: S| milli(value).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    let Vec3 { x, y, z } = velocity_mps;
    Beacon {
        position_mm: state.position.mm,
        velocity_mmps: [narrow(x), narrow(y), narrow(z)],
        radius_mm: u16::try_from(milli(config.radius_m).max(0)).unwrap_or(u16::MAX),
        mode,
        flock: config.flock,
        ..Beacon::default()
    }
}

#[cfg(test)]
mod tests;
