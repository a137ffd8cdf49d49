//! The radio link of an agent: decodes received frames, encodes frames to send.

use super::contact_loss::{ContactState, Listening};
use super::duplicate_id::EchoFilter;
use super::io::{Event, KinematicState, OUTBOX, Outputs};
use super::{AgentConfig, CellState, Outgoing, Report, Waypoint};
use crate::body::Body;
use crate::geom::{Position, Torus, Vec3};
use crate::grid::{Cell, Dir};
use crate::land::LandPatch;
use crate::neighbor::{Ages, LossEstimate, Neighbor, NeighborTable, PlausibilityFilter, PlausibilityLimits, Put};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{
    Arrival, Beacon, DecodeError, Due, EncodeError, Frame, Header, KeyHeld, Message, Newest, Orders, Payload,
    PayloadBytes, Request, RequestKind, Requests, SequenceWindow, TemplateAssignment, Wire,
};
use heapless::Vec;
use lost::LostNews;
use serde::{Deserialize, Serialize};

mod identity;
mod lost;
mod sight;

const PENDING: usize = 4;
const WAYPOINTS: usize = 4;
const ORDERS: usize = 8;

pub(super) enum Received {
    /// The sender asks to choose another direction.
    Redirect(RobotId),
    /// A stop or resume request for the own leader.
    PassOn(Request),
    /// `is_restarted`: the sender changed or restarted, so its version numbers start anywhere.
    Template { part: TemplateAssignment, is_restarted: bool },
    /// A goal for the top leader of the formation.
    Goal(Cell),
    /// Of the sender's map.
    Land(RobotId, LandPatch),
    /// Call [`Link::placed`] if it was accepted.
    Waypoint { index: u8, version: u8, waypoint: Waypoint<f32> },
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Link<S, const N: usize, W, P> {
    wire: W,
    header: Header,
    said: EchoFilter,
    pub(super) table: NeighborTable<S, N, P>,
    pub(super) contact: ContactState,
    pub(super) listening: Listening,
    suspects: PlausibilityFilter,
    loss: LossEstimate,
    windows: Vec<(RobotId, SequenceWindow), N>,
    requests: Requests<PENDING>,
    orders: Orders<ORDERS>,
    goal: Newest,
    waypoints: [Newest; WAYPOINTS],
    /// Sender and boot number of the last goal, template and waypoint.
    commanders: [Option<(RobotId, u8)>; 3],
    beacon_due: Instant,
    has_sent: bool,
    lost: LostNews,
    /// Constant in a run, so digests omit it.
    #[cfg(feature = "host")]
    #[serde(with = "crate::digest::uncounted")]
    torus: Option<Torus<S>>,
}

/// The context of received frames; `heard_at` is the time at which arriving frames were sent.
pub(super) struct ReceiveContext<'a, S> {
    pub(super) position: Position,
    pub(super) velocity_mps: Vec3<S>,
    pub(super) heard_at: Instant,
    pub(super) fastest_mps: Option<S>,
    pub(super) period: Duration,
    pub(super) plausibility: &'a PlausibilityLimits<S>,
    pub(super) needs: &'a dyn Fn(RobotId) -> bool,
}

impl<S: Scalar, const N: usize, W: Wire, P: Payload> Link<S, N, W, P> {
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
            windows: Vec::new(),
            requests: Requests::new(id, boot, retry),
            orders: Orders::new(ages.expire_after),
            goal: Newest::new(),
            waypoints: [Newest::new(); WAYPOINTS],
            commanders: [None; 3],
            beacon_due: Instant::from_micros(0),
            has_sent: false,
            lost: LostNews::NEW,
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
        let (windows, loss) = (&mut self.windows, &mut self.loss);
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
            windows.retain(|(id, _)| *id != lost);
            report(out, Event::NeighborLost(lost));
        });
    }

    pub(super) fn next_frame<'a>(&self, inbox: &mut &'a [u8]) -> Option<&'a [u8]> {
        self.wire.next_frame(inbox)
    }

    /// Returns a message that the agent must handle.
    pub(super) fn hear(
        &mut self,
        bytes: &[u8],
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<Received> {
        let frame = match self.wire.decode(bytes) {
            // Frames of other systems on the same band count as neither received nor rejected.
            Err(DecodeError::Foreign) => return None,
            Err(error) => {
                out.refused.count(error);
                None
            }
            Ok(frame) => Some(frame),
        };
        let frame = frame.and_then(|frame| {
            let id = self.known_as(&frame, listener, out)?;
            let arrival = self.arrival(id, frame.header, out)?;
            Some((frame, id, arrival))
        });
        let count = if frame.is_some() { &mut out.received } else { &mut out.rejected };
        *count = count.saturating_add(1);
        let (frame, id, arrival) = frame?;
        self.take(frame, id, arrival, now, listener, out)
    }

    /// `None` if the frame must be refused.
    fn arrival(&mut self, sender: RobotId, header: Header, out: &mut Outputs<S>) -> Option<Arrival> {
        let window = self.windows.iter_mut().find(|(id, _)| *id == sender);
        let (missed, arrival) =
            window.map_or((0, Arrival::New), |(_, window)| (window.skipped(header), window.check(header)));
        if arrival == Arrival::New {
            self.loss.heard(missed);
        }
        if arrival == Arrival::Rebooted {
            self.orders.forget(sender);
            report(out, Event::NeighborRebooted(sender));
        }
        arrival.is_accepted().then_some(arrival)
    }

    fn take(
        &mut self,
        frame: Frame,
        id: RobotId,
        arrival: Arrival,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<Received> {
        let Header { sender, .. } = frame.header;
        let is_mine = |to: RobotId| to == self.header.sender;
        match frame.message {
            Message::Beacon(beacon) if arrival.is_latest() => {
                let mut neighbor = Neighbor::from_beacon(id, &beacon, listener.heard_at);
                // The payload arrives in a separate frame; after a restart the old one is invalid.
                let known = self.table.get(id, now).known().filter(|_| arrival != Arrival::Rebooted);
                neighbor.payload = known.map_or(neighbor.payload, |known| known.payload);
                self.keep(neighbor, frame.header, now, listener, out);
            }
            Message::Request(request) if is_mine(request.to) => {
                let answer = self.orders.receive(frame.header, &request, now);
                self.say_early(&Message::Ack(answer.ack), out);
                match request.kind {
                    _ if !answer.is_new => {}
                    RequestKind::Redirect => return Some(Received::Redirect(id)),
                    RequestKind::Stop | RequestKind::Resume => return Some(Received::PassOn(request)),
                }
            }
            Message::Ack(ack) if is_mine(ack.to) => {
                let _ = self.requests.acknowledged(sender, &ack);
            }
            Message::Template(part) if is_mine(part.to) => {
                let [_, commander, _] = &mut self.commanders;
                let is_restarted = is_another(commander, frame.header);
                return Some(Received::Template { part, is_restarted });
            }
            Message::Goal(goal) if is_mine(goal.to) || !goal.to.is_some() => {
                let [commander, _, _] = &mut self.commanders;
                if is_another(commander, frame.header) {
                    self.goal.forget();
                }
                if self.goal.admit(goal.version) {
                    return Some(Received::Goal(goal.target));
                }
            }
            Message::Waypoint(said) if is_mine(said.to) || !said.to.is_some() => {
                let [_, _, commander] = &mut self.commanders;
                if is_another(commander, frame.header) {
                    self.waypoints = [Newest::new(); WAYPOINTS];
                }
                let newest = self.waypoints.get(usize::from(said.index))?;
                if newest.is_news(said.version) {
                    return Some(Received::Waypoint {
                        index: said.index,
                        version: said.version,
                        waypoint: Waypoint {
                            position: Position::from_mm(said.position_mm),
                            velocity_mps: Vec3::from_milli(said.velocity_mmps.map(i32::from)),
                            at: listener.heard_at,
                        },
                    });
                }
            }
            Message::Land(patch) => return Some(Received::Land(id, patch)),
            Message::Payload(bytes) if size_of::<P>() > 0 && arrival.is_latest() => self.table.tell(id, bytes.get()),
            Message::Lost(lost) if listener.fastest_mps.is_some() => self.hear_lost(&lost, now, listener, out),
            Message::Key(key) if is_mine(key.to) => {
                if let Some((generation, phase)) = self.wire.held() {
                    self.say_early(&Message::KeyHeld(KeyHeld { to: sender, generation, phase }), out);
                }
            }
            _ => {}
        }
        None
    }

    fn keep(
        &mut self,
        mut neighbor: Neighbor<S, P>,
        header: Header,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) {
        let id = neighbor.id;
        neighbor.position = self.image(neighbor.position, listener.position);
        self.cut(&mut neighbor, listener.plausibility, out);
        self.table.note_reception(&mut neighbor, listener.position, listener.velocity_mps);
        self.contact = ContactState::InContact(neighbor.heard);
        let put = self.table.put(neighbor, listener.position, now, listener.needs);
        self.note_eviction(put, out);
        if matches!(put, Put::Inserted | Put::Evicted(_)) {
            let mut window = SequenceWindow::new();
            let _ = window.check(header);
            // Cannot fail: there are as many windows as entries.
            let _ = self.windows.push((id, window));
            report(out, id.duplicate_of().map_or(Event::NeighborFound(id), Event::DuplicateId));
        }
    }

    fn note_eviction(&mut self, put: Put, out: &mut Outputs<S>) {
        if let Put::Evicted(evicted) = put {
            self.windows.retain(|(id, _)| *id != evicted);
            report(out, Event::NeighborEvicted(evicted));
        }
    }

    /// One that was not accepted is reported again when it is repeated: it may be usable by then.
    pub(super) fn placed(&mut self, index: u8, version: u8) {
        if let Some(newest) = self.waypoints.get_mut(usize::from(index)) {
            let _ = newest.admit(version);
        }
    }

    /// Queues a request. It is dropped if the queue is full, because its cause will recur.
    pub(super) fn ask(&mut self, to: RobotId, origin: RobotId, kind: RequestKind, valid: Duration, now: Instant) {
        let millis = valid.as_micros().max(0).checked_div(1000).unwrap_or(0);
        let millis = u16::try_from(millis).unwrap_or(u16::MAX);
        let _ = self.requests.ask(to, origin, kind, millis, now);
    }

    /// Queues the requests of a law and broadcasts its patch, after a decision.
    pub(super) fn send(&mut self, outgoing: &Outgoing, valid: Duration, now: Instant, out: &mut Outputs<S>) {
        for &(to, kind) in &outgoing.requests {
            self.ask(to, self.header.sender, kind, valid, now);
        }
        if let Some(patch) = outgoing.patch {
            self.say_early(&Message::Land(patch), out);
        }
    }

    #[cfg(test)]
    pub(super) fn is_quiet(&self) -> bool {
        self.requests.is_empty()
    }

    pub(super) fn is_stopped(&mut self, now: Instant) -> bool {
        self.orders.is_stopped(now)
    }

    /// Sends due requests, the beacon if it is due, then the payload, a map patch and a lost robot
    /// if they fit.
    pub(super) fn speak(
        &mut self,
        now: Instant,
        period: Duration,
        beacon: impl FnOnce() -> Beacon,
        told: impl FnOnce(&mut Outgoing) -> P,
        out: &mut Outputs<S>,
    ) {
        // Polling twice per request always empties the list.
        for _ in 0..2 * PENDING {
            match self.requests.poll(now) {
                Some(Due::Send(request)) => self.say_early(&Message::Request(request), out),
                Some(Due::Expired(Request { to, kind, .. })) => {
                    report(out, Event::RequestExpired { to, kind });
                }
                None => break,
            }
        }
        if !self.has_sent || now.has_reached(self.beacon_due, period) {
            let beacon = Message::Beacon(beacon());
            self.said.note(self.header.sequence, &beacon);
            if self.say(&beacon, 0, out) == Err(EncodeError::Exhausted) {
                report(out, Event::Muted);
            }
            // Data that does not fit is sent again at its next turn.
            let mut outgoing = Outgoing::default();
            let payload = told(&mut outgoing);
            if size_of::<P>() > 0
                && let Some(bytes) = PayloadBytes::of(&payload)
            {
                let _ = self.say(&Message::Payload(bytes), 0, out);
            }
            if let Some(patch) = outgoing.patch {
                let _ = self.say(&Message::Land(patch), 0, out);
            }
            if let Some(lost) = self.lost_to_tell(now) {
                let _ = self.say(&Message::Lost(lost), 0, out);
            }
            self.has_sent = true;
            self.beacon_due = now + period;
        }
        out.call_again = match self.requests.poll_at(now) {
            Some(request_due) if request_due.is_before(self.beacon_due) => request_due,
            _ => self.beacon_due,
        };
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

/// Returns whether they changed.
fn is_another(last: &mut Option<(RobotId, u8)>, header: Header) -> bool {
    let now = Some((header.sender, header.boot));
    core::mem::replace(last, now) != now
}

pub(super) fn report<S>(out: &mut Outputs<S>, event: Event) {
    let _ = out.events.push(event);
}

/// Lengths saturate, and NaN counts as 0.
pub(super) fn beacon<S: Scalar>(
    config: &AgentConfig<S>,
    (shown, heading): (Report, Dir),
    mode: Mode,
    state: &KinematicState<S>,
    on_grid: CellState,
    v: Vec3<S>,
    now: Instant,
) -> Beacon {
    let milli = |value: S| value.to_milli().unwrap_or(0);
    let narrow = |value: S| milli(value).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    let busy_ms = i64::from(on_grid.busy.as_micros().max(0)).checked_div(1000).unwrap_or(0);
    Beacon {
        time: now,
        position_mm: state.position.mm,
        velocity_mmps: [narrow(v.x), narrow(v.y), narrow(v.z)],
        radius_mm: u16::try_from(milli(config.radius_m).max(0)).unwrap_or(u16::MAX),
        cell: on_grid.cell,
        heading,
        busy_ms: u16::try_from(busy_ms).unwrap_or(u16::MAX),
        leader: shown.leader,
        slot: if config.flock == 0 { shown.slot } else { config.flock },
        mode,
        target: shown.target.unwrap_or_default(),
    }
}
