//! States of robots, told from robot to robot: a robot that is not heard is known all the same.
//!
//! Behind some beacons a robot tells the last known state of another one: first of a robot that it
//! has just found, or whose old state a third one has told, then in turn of a silent robot, a near
//! one, a silent one and any. A receiver stores a state that is newer than its own. It never stores
//! one of itself, of an id that two robots use, of one beyond
//! [`last`](crate::neighbor::PlausibilityLimits::last), of an unknown robot out of radio range, or
//! at a place that the known robot cannot have reached.
//!
//! With [`relays`](crate::agent::AgentConfig::relays) it also relays the beacons of robots that its
//! law needs: so the members of a formation know each other's moves where hills or distance hide
//! some of them.

use super::audience::{Audience, Hearing};
use super::dates::Sender;
use super::{Link, Outputs, Protocol, ReceiveContext, report};
use crate::agent::contact_loss::Listening;
use crate::agent::duplicate_id::is_within;
use crate::agent::io::{Event, OUTBOX};
use crate::geom::Position;
use crate::neighbor::{Neighbor, Put, Trace};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Beacon, Content as _, LostRobot, MAX_PAYLOAD, Message, Relayed, Wire};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Beacons for each told state: after the start, while a robot is silent, and while none is.
const TELL_EVERY: [u8; 3] = [1, 2, 4];
/// Unit of [`LostRobot::age_cs`]. Ages are rounded up, and a state is newer only if it is newer by
/// more than this, so that no state gets younger on its way.
const UNIT: Duration = Duration::from_millis(10);
/// Age of a told state that shows whom its teller hears, in units of the age of a stale neighbour.
const RECENT: i32 = 2;

/// The most beacons that a robot relays behind one of its own
/// ([`relays`](crate::agent::AgentConfig::relays)).
pub const RELAYS: usize = 3;

const _: () = assert!(Beacon::MAX_FRAME_LEN + RELAYS * Relayed::MAX_FRAME_LEN <= OUTBOX);

/// Spreads the turns of near robots.
const MIXED: u8 = 157;

/// Which state to tell next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Relay {
    /// Beacons since the last told state.
    beacons: u8,
    /// The number of the turn: every second one is that of a silent robot.
    turn: u8,
    /// The last robot in the turn of silent ones.
    silent: RobotId,
    /// The last robot in the turn of all.
    any: RobotId,
    /// A robot of which another robot has told an old state, or that was just heard for the first
    /// time.
    urgent: RobotId,
    /// The last robot in the turn of relayed ones.
    relayed: RobotId,
    audience: Audience,
}

impl Relay {
    /// Each robot begins with those after itself, so that not all tell the same.
    pub(super) const fn new(own: RobotId) -> Self {
        Self {
            beacons: 0,
            turn: 0,
            silent: own,
            any: own,
            urgent: RobotId::NONE,
            relayed: own,
            audience: Audience::NEW,
        }
    }

    /// Tells the state of this robot next, so that it knows that it is heard.
    pub(super) const fn tell_next(&mut self, id: RobotId) {
        self.urgent = id;
    }
}

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    /// Stores the state of a third robot if it is newer, and notes an old one. O(N).
    pub(super) fn hear_told(
        &mut self,
        teller: RobotId,
        told: &LostRobot,
        said: Option<&Relayed>,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) {
        let id = told.id;
        self.note_audience(teller, told, now, listener);
        let is_shared = self.table.get(id.duplicate(), now).known().is_some();
        if id == self.header.sender || id > listener.plausibility.last || !id.is_some() || is_shared {
            return;
        }
        if self.relay.urgent == id {
            self.relay.urgent = RobotId::NONE;
        }
        // An operator clears a place without a body.
        let is_alive = !told.is_lost && told.radius_mm > 0;
        let mut heard = listener.heard_at - UNIT.saturating_mul(told.age_cs.into());
        if is_alive {
            // Its velocity is not told, so it may have decided once more. On the grid the frame was
            // under way for this long, or the state would get younger from robot to robot.
            heard = heard - listener.period;
        }
        let known = self.table.all().find(|known| known.id == id).copied();
        if now.since(heard) < Duration::ZERO {
            return;
        }
        if let Some(known) = known
            && heard.since(known.heard) <= UNIT
        {
            // A relayed beacon shows sooner that its teller does not hear the robot.
            let late = if said.is_some() { listener.period.saturating_mul(2) } else { self.table.ages().stale_after };
            if known.heard.since(heard) > late {
                self.relay.urgent = id;
            }
            return;
        }
        let LostRobot { position_mm, radius_mm, .. } = *told;
        // A robot that was never heard is taken to give way.
        let mode = if is_alive { Mode::Cruise } else { Mode::Fault };
        let mut beacon = Beacon { position_mm, radius_mm, mode, ..Beacon::default() };
        if let Some(Relayed { mode, flock, protocol, payload, .. }) = said {
            beacon = Beacon { mode: *mode, flock: *flock, protocol: *protocol, payload: payload.clone(), ..beacon };
        }
        let mut state = Neighbor::from_beacon(id, &beacon, Q::ID, heard);
        state.position = self.image(state.position, listener.position);
        let _ = listener.plausibility.cut(&mut state);
        let in_contact = known.filter(|known| !known.is_lost());
        let is_on_grid = listener.fastest_mps.is_none();
        let is_near = is_on_grid || self.table.is_within_reach(state.position.since(listener.position));
        state.trace = match (is_alive, is_near) {
            (false, _) => Trace::Lost,
            (true, true) => Trace::Told,
            (true, false) => Trace::Leaving,
        };
        if let Some(known) = in_contact {
            let fastest_mps = listener.fastest_mps.unwrap_or(S::MAX);
            // One that is in contact is lost by its own silence only.
            if !is_alive || !is_within(state.position, &known, heard.since(known.heard), fastest_mps) {
                return;
            }
            let Neighbor { position, heard, radius_m, trace, flock, mode, payload, .. } = state;
            state = Neighbor { position, heard, radius_m, trace, ..known };
            if said.is_some() {
                state = Neighbor { flock, mode, payload, ..state };
            }
        } else {
            self.table.clear_lost(id);
            let is_wanted = is_near || said.is_some() && (listener.needs)(id);
            let is_stored = told.is_lost || is_alive && is_wanted;
            if !is_stored {
                return;
            }
        }
        let put = self.table.put(state, listener.position, now, listener.needs);
        self.note_eviction(put, out);
        if is_alive && matches!(put, Put::Inserted | Put::Evicted(_)) {
            self.found(Sender::silent(id), put, now);
            report(out, Event::NeighborFound(id));
        }
    }

    /// Stores a relayed beacon if it is newer.
    pub(super) fn hear_relayed(
        &mut self,
        teller: RobotId,
        said: &Relayed,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) {
        let Relayed { id, age_cs, position_mm, radius_mm, .. } = *said;
        // A radius of 0 would clear the place.
        let told = LostRobot { id, is_lost: false, age_cs, position_mm, radius_mm: radius_mm.max(1) };
        self.hear_told(teller, &told, Some(said), now, listener, out);
    }

    /// Relays the last beacons of robots that the law needs: up to `count`, as far as frames fit.
    /// The robot with the lowest id, which all of a formation follow, comes each time, then one of
    /// which another robot has relayed an older beacon, then the others in turn; with a `count` of
    /// 1 all come in turn. O(`count` N).
    pub(in crate::agent) fn relay(
        &mut self,
        count: u8,
        needs: impl Fn(RobotId) -> bool,
        now: Instant,
        out: &mut Outputs<S>,
    ) {
        let mut told = Vec::<RobotId, RELAYS>::new();
        for turn in 0..count.min(RELAYS as u8) {
            let is_first = turn == 0 && count > 1;
            let last = if is_first { RobotId::NONE } else { self.relay.relayed };
            let is_next = |id: RobotId| !told.contains(&id) && needs(id);
            let is_urgent = |id: RobotId| id == self.relay.urgent && is_next(id);
            let late = if is_first { None } else { self.said_after(last, is_urgent, now) };
            let is_late = late.is_some();
            let Some(said) = late.or_else(|| self.said_after(last, is_next, now)) else { return };
            if is_late {
                self.relay.urgent = RobotId::NONE;
            } else if !is_first {
                self.relay.relayed = said.id;
            }
            let _ = told.push(said.id);
            if self.say(&Message::Relayed(said), 0, out).is_err() {
                return;
            }
        }
    }

    /// The beacon of the robot with the next higher id, or the lowest one.
    fn said_after(&self, last: RobotId, needs: impl Fn(RobotId) -> bool, now: Instant) -> Option<Relayed> {
        let is_recent = |age: Duration| age <= self.table.ages().expire_after;
        let told = self.table.iter().filter(|known| needs(known.id) && known.age(now).is_some_and(is_recent));
        let told = told.filter(|known| known.payload.is_some());
        let known = told.min_by_key(|known| (known.id <= last, known.id))?;
        let (protocol, payload) = known.payload.as_ref()?.encode::<MAX_PAYLOAD>(Q::ID)?;
        let LostRobot { id, age_cs, position_mm, radius_mm, .. } = tell(known, now);
        let Neighbor { mode, flock, .. } = *known;
        Some(Relayed { id, age_cs, position_mm, radius_mm, mode, flock, protocol, payload })
    }

    /// Notes whether `teller` hears the own robot: a recent state of it, or of a robot that is
    /// farther from the teller, or that it is lost.
    fn note_audience(&mut self, teller: RobotId, told: &LostRobot, now: Instant, listener: &ReceiveContext<'_, S>) {
        let stale_after = self.table.ages().stale_after;
        if (now - listener.latency).since(listener.heard_at) > stale_after {
            return;
        }
        // The teller's states are as old as the latency when they arrive.
        let recent = stale_after.saturating_mul(RECENT).as_micros();
        let recent = recent.saturating_add(now.since(listener.heard_at).as_micros());
        let is_recent = UNIT.saturating_mul(told.age_cs.into()).as_micros() <= recent;
        let is_own = told.id == self.header.sender;
        // An operator clears a place without a body.
        if told.radius_mm == 0 {
            return;
        }
        if told.is_lost && is_own {
            self.relay.audience.loses();
        }
        if told.is_lost || !is_recent {
            return;
        }
        let own = listener.position;
        if is_own {
            self.relay.audience.hears();
        } else if let Some(teller) = self.table.get(teller, now).fresh() {
            let distance = |place: Position| place.since::<S>(teller.position).length_key();
            let place = self.image(Position::from_mm(told.position_mm), teller.position);
            if distance(place) > distance(self.image(own, teller.position)) {
                self.relay.audience.tells_of_farther();
            }
        }
    }

    /// How others hear the own robot.
    pub(in crate::agent) fn hearing(&self) -> Hearing {
        self.relay.audience.hearing(self.table.len())
    }

    /// Whether a robot is known from others only, although it is near enough to be heard.
    pub(in crate::agent) fn misses_robots(&self) -> bool {
        self.table.iter().any(|known| known.trace == Trace::Told)
    }

    /// The next state to tell, if one is due. Call it for each beacon. O(N).
    pub(super) fn state_to_tell(&mut self, own: Position, now: Instant) -> Option<LostRobot> {
        // Robots on a grid use no told states.
        if self.listening == Listening::NotStarted {
            return None;
        }
        let urgent = core::mem::replace(&mut self.relay.urgent, RobotId::NONE);
        let known = self.table.all().find(|known| known.id == urgent).copied();
        let is_urgent = known.is_some() || self.table.all().any(|known| self.is_silent(known, now));
        let [started_every, silent_every, every] = TELL_EVERY;
        let every = match (self.listening, is_urgent) {
            (Listening::Over(_), true) => silent_every,
            (Listening::Over(_), false) => every,
            _ => started_every,
        };
        self.relay.beacons = self.relay.beacons.saturating_add(1);
        if self.relay.beacons < every {
            self.relay.urgent = urgent;
            return None;
        }
        let next = known.or_else(|| self.next_in_turn(own, now))?;
        self.relay.beacons = 0;
        Some(tell(&next, now))
    }

    /// In turn a silent robot, a near one, a silent one and any.
    fn next_in_turn(&mut self, own: Position, now: Instant) -> Option<Neighbor<S, Q::Payload>> {
        let turn = self.relay.turn;
        self.relay.turn = turn.wrapping_add(1);
        let silent = self.next_after(self.relay.silent, |known| turn & 1 == 0 && self.is_silent(known, now));
        if let Some(next) = silent {
            self.relay.silent = next.id;
            return silent;
        }
        let near = if turn & 2 == 0 { self.near(own, turn) } else { None };
        if near.is_some() {
            return near;
        }
        let next = self.next_after(self.relay.any, |_| true)?;
        self.relay.any = next.id;
        Some(next)
    }

    /// One of the robots within half of the distance of the farthest, another one for another turn.
    fn near(&self, own: Position, turn: u8) -> Option<Neighbor<S, Q::Payload>> {
        let offset_m = |known: &Neighbor<S, Q::Payload>| known.position.since::<S>(own);
        let farthest = self.told().map(|known| offset_m(known).length_key()).max()?;
        let near = || self.told().filter(|known| (offset_m(known) * S::TWO).length_key() <= farthest);
        let at = usize::from(turn.wrapping_mul(MIXED) >> 3).checked_rem(near().count())?;
        near().nth(at).copied()
    }

    /// The robot with the next higher id, or the lowest one.
    fn next_after(
        &self,
        last: RobotId,
        is_wanted: impl Fn(&Neighbor<S, Q::Payload>) -> bool,
    ) -> Option<Neighbor<S, Q::Payload>> {
        self.told().filter(|known| is_wanted(known)).min_by_key(|known| (known.id <= last, known.id)).copied()
    }

    /// The robots of which this one tells.
    fn told(&self) -> impl Iterator<Item = &Neighbor<S, Q::Payload>> {
        let is_told =
            |known: &&Neighbor<S, Q::Payload>| known.id.duplicate_of().is_none() && known.trace != Trace::Leaving;
        self.table.all().filter(is_told)
    }

    fn is_silent(&self, known: &Neighbor<S, Q::Payload>, now: Instant) -> bool {
        known.trace != Trace::Leaving && known.age(now).is_none_or(|age| age > self.table.ages().stale_after)
    }
}

fn tell<S: Scalar, P>(known: &Neighbor<S, P>, now: Instant) -> LostRobot {
    let micros = known.age(now).unwrap_or(Duration::MAX).as_micros();
    let units = micros.checked_div(UNIT.as_micros()).unwrap_or(0).saturating_add(1);
    LostRobot {
        id: known.id,
        is_lost: known.is_lost(),
        age_cs: u16::try_from(units).unwrap_or(u16::MAX),
        position_mm: known.position.mm,
        radius_mm: u16::try_from(known.radius_m.to_milli().unwrap_or(0).max(0)).unwrap_or(u16::MAX),
    }
}

#[cfg(test)]
mod tests;
