//! What a companion owes its autopilot, as a state machine without I/O and clock: telemetry and time in, messages out. Read
//! [`OffboardStateMachine::poll`] first.
//!
//! It says that it is there once a second, asks for the telemetry that it needs, and sends velocities at a steady rate while, and only while,
//! it may steer: the autopilot is heard, it is in the mode for outside control, armed (and in the air, if it flies), and its position is fresh.
//!
//! Who decides about that mode is the pilot. With [`Entry::Once`] the companion asks for it (and for what else its rules say) a single time after its start; whatever
//! a pilot does in the meantime ends that. When the mode is left, by whomever, setpoints stop with that heartbeat. After a restart
//! of the autopilot the mode it comes up in is nobody's permission: it must be left and chosen again.

mod event;
mod health;
mod out;
mod poll;

pub use event::Event;
pub use health::Doubt;
pub use out::{ARM_DISARM, DO_SET_MODE, NAV_TAKEOFF, SET_MESSAGE_INTERVAL, status_text};

use super::kind::Kind;
use crate::geo::Global;
use health::Health;
use serde::{Deserialize, Serialize};
use staya_mavlink::constants::{
    MAV_LANDED_STATE_IN_AIR, MAV_LANDED_STATE_LANDING, MAV_LANDED_STATE_ON_GROUND, MAV_LANDED_STATE_TAKEOFF,
};
use staya_mavlink::dialect::MavMessage;
use std::collections::VecDeque;
use std::time::Duration;

/// The companion's component of its vehicle's system: `MAV_COMP_ID_ONBOARD_COMPUTER`.
pub const COMPONENT: u8 = 191;
/// The autopilot's component.
pub const AUTOPILOT: u8 = 1;

/// Between two own heartbeats.
const HEARTBEAT: Duration = Duration::from_secs(1);
/// How long there are no setpoints at all after a hand-over.
const QUIET: Duration = Duration::from_secs(5);
/// A time since boot that is earlier by more is another boot; by less, a message that was overtaken.
const OVERTAKEN_MS: i32 = 2000;
/// So many messages on end, each later than the one before and none in order, were not overtaken: the autopilot restarted soon after its start.
const BEHIND: u8 = 4;
/// A time since boot that is later by more is another boot, whose clock wrapped.
const DAY_MS: i32 = 86_400_000;
/// Who climbs no faster has come to the end of a takeoff, m/s.
const CLIMB_OVER_MPS: f64 = 0.3;
/// Lower than this over its home, a vehicle that does not say whether it flies is on the ground, metres.
const LOW_M: f64 = 1.0;

/// Who puts the vehicle into the mode for outside control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// The pilot.
    #[default]
    Wait,
    /// The companion, once after its start.
    Once,
}

/// By what rules a vehicle is steered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Who asks for the mode.
    pub entry: Entry,
    /// Whether [`Entry::Once`] also arms. Otherwise it waits until somebody else has.
    pub arm: bool,
    /// Whether it then takes off, to `altitude_m`.
    pub takeoff: bool,
    /// Height above home to take off to, metres.
    pub altitude_m: Option<f64>,
    /// Whether that height is kept then, as in the plane. Otherwise vertical velocities are the agent's.
    pub keeps_altitude: bool,
    /// A position that is older is stale.
    pub stale: Duration,
    /// An autopilot that is silent for longer is gone.
    pub link_lost: Duration,
    /// Between two setpoints.
    pub setpoint_every: Duration,
    /// Positions asked for, Hz.
    pub position_hz: f64,
    /// A dry run: what it asks for is taken to be granted at once, and whoever has a position is steered.
    pub rehearses: bool,
}

/// What a companion does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// No heartbeat: it sends no setpoints.
    Silent,
    /// The vehicle is in another mode: it is the pilot's.
    Pilot,
    /// The autopilot has restarted in the mode for outside control, where nobody has put it.
    Restarted,
    /// It asks for the mode, arms or takes off.
    Entering,
    /// In the mode, not armed.
    Disarmed,
    /// In the mode and armed, without a position yet.
    NoPosition,
    /// In the mode and armed, not in the air, or still taking off or landing.
    Grounded,
    /// It was steering and the position is stale: it tells the vehicle to stop.
    Stopped,
    /// It was steering and the position is not to be believed: it tells the vehicle to stop.
    Distrusted,
    /// It steers.
    Steering,
}

/// The last position that could be believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// When it arrived.
    pub at: Duration,
    /// Where.
    pub place: Global,
    /// Above home, metres.
    pub above_home_m: f64,
    /// North, east, down, m/s.
    pub velocity_ned_mps: [f64; 3],
}

/// The last heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Beat {
    at: Duration,
    custom_mode: u32,
    is_controlled: bool,
    is_armed: bool,
}

/// What was asked for on entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ask {
    Mode,
    Arm,
    Takeoff,
}

/// What has happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OffboardCounters {
    /// Heartbeats heard.
    pub heartbeats: u64,
    /// Positions heard.
    pub positions: u64,
    /// Setpoints sent.
    pub setpoints: u64,
    /// How often the mode was left while the companion steered.
    pub hand_overs: u64,
    /// How often it stopped for want of a position.
    pub stops: u64,
    /// How often positions came that were not to be believed any more.
    pub doubts: u64,
    /// Restarts of the autopilot.
    pub restarts: u64,
}

/// One companion.
#[derive(Clone, Debug)]
pub struct OffboardStateMachine {
    system: u8,
    kind: Kind,
    rules: Rules,
    state: State,
    beat: Option<Beat>,
    /// The last one that could be believed, and whether it is of this boot.
    fix: Option<Fix>,
    is_of_boot: bool,
    health: Health,
    boot_ms: Option<u32>,
    /// The last message that seemed overtaken, by its time since boot, and how many came on end.
    behind: Option<(u32, u8)>,
    /// Velocity from `LOCAL_POSITION_NED`, which is finer, and when.
    velocity: Option<(Duration, [f64; 3])>,
    landed: Option<u8>,
    /// The companion may still ask.
    may_enter: bool,
    /// The mode is not a permission until it has been left.
    must_be_left: bool,
    quiet_until: Duration,
    streaming_since: Option<Duration>,
    asked: Option<(Ask, u8, Duration)>,
    refused: Option<(u16, u8)>,
    command: Option<(Duration, [f64; 3])>,
    next_heartbeat: Duration,
    next_setpoint: Duration,
    next_look: Option<Duration>,
    positions_at_look: u64,
    reports_at_look: u64,
    looks: u8,
    events: VecDeque<Event>,
    tally: OffboardCounters,
}

impl OffboardStateMachine {
    /// Of the vehicle `system`, which has just been switched on for all it knows.
    #[must_use]
    pub fn new(system: u8, kind: Kind, rules: Rules) -> Self {
        Self {
            system,
            kind,
            rules,
            state: State::Silent,
            beat: None,
            fix: None,
            is_of_boot: false,
            health: Health::default(),
            boot_ms: None,
            behind: None,
            velocity: None,
            landed: None,
            may_enter: rules.entry == Entry::Once,
            must_be_left: false,
            quiet_until: Duration::ZERO,
            streaming_since: None,
            asked: None,
            refused: None,
            command: None,
            next_heartbeat: Duration::ZERO,
            next_setpoint: Duration::ZERO,
            next_look: None,
            positions_at_look: 0,
            reports_at_look: 0,
            looks: 0,
            events: VecDeque::new(),
            tally: OffboardCounters::default(),
        }
    }

    /// What it does, as of the last [`poll`](Self::poll).
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// What has happened.
    #[must_use]
    pub const fn tally(&self) -> OffboardCounters {
        self.tally
    }

    /// The last position that could be believed, however old, and of whichever boot.
    #[must_use]
    pub const fn fix(&self) -> Option<Fix> {
        self.fix
    }

    /// The last position if it is not stale, and positions can still be believed.
    #[must_use]
    pub fn fresh_fix(&self, now: Duration) -> Option<Fix> {
        let fix = self.fix.filter(|_| self.is_of_boot && self.health.is_trusted(now));
        fix.filter(|fix| now.saturating_sub(fix.at) <= self.rules.stale)
    }

    /// Takes the next thing off that is worth telling a person.
    pub fn event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Takes the velocity that the agent wants from now on, metres per second north, east, down.
    pub fn steer(&mut self, velocity_ned_mps: [f64; 3], now: Duration) {
        self.command = Some((now, velocity_ned_mps));
    }

    /// Takes a message of the vehicle's autopilot.
    pub fn hear(&mut self, message: &MavMessage, now: Duration) {
        match message {
            MavMessage::HEARTBEAT(beat) => self.heartbeat(beat.custom_mode, beat.base_mode, now),
            MavMessage::SYSTEM_TIME(time) => drop(self.is_in_order(time.time_boot_ms)),
            MavMessage::GLOBAL_POSITION_INT(at) if self.is_in_order(at.time_boot_ms) => {
                // Before they know where they are, autopilots say 0, 0.
                if (at.lat, at.lon) == (0, 0) {
                    return;
                }
                let fine = self
                    .velocity
                    .filter(|(heard, _)| now.saturating_sub(*heard).as_secs_f64() * self.rules.position_hz <= 2.0);
                let coarse = [at.vx, at.vy, at.vz].map(|v| f64::from(v) / 100.0);
                self.tally.positions += 1;
                if !self.health.is_trusted(now) {
                    return;
                }
                self.is_of_boot = true;
                self.fix = Some(Fix {
                    at: now,
                    place: Global::from_e7(at.lat, at.lon, at.alt),
                    above_home_m: f64::from(at.relative_alt) / 1e3,
                    velocity_ned_mps: fine.map_or(coarse, |(_, velocity)| velocity),
                });
            }
            MavMessage::LOCAL_POSITION_NED(at) if self.is_in_order(at.time_boot_ms) => {
                let velocity = [at.vx, at.vy, at.vz];
                if velocity.iter().all(|v| v.is_finite()) {
                    self.velocity = Some((now, velocity.map(f64::from)));
                }
            }
            MavMessage::EXTENDED_SYS_STATE(state) => self.landed = Some(state.landed_state),
            MavMessage::COMMAND_ACK(ack) => self.acknowledged(ack.command, ack.result),
            _ => {
                if let Some(doubt) = self.health.hear(message, now) {
                    self.tally.doubts += 1;
                    self.events.push_back(Event::Doubts(doubt));
                    // It does not wait for the next poll.
                    self.settle(now);
                }
            }
        }
    }

    /// Takes note of the autopilot's clock; whether the message is not one that was overtaken.
    fn is_in_order(&mut self, boot_ms: u32) -> bool {
        let since = self.boot_ms.map(|last| boot_ms.wrapping_sub(last).cast_signed());
        match since {
            Some(ms) if (-OVERTAKEN_MS..0).contains(&ms) => {
                let rising = self.behind.filter(|(last, _)| boot_ms > *last);
                let count = rising.map_or(1, |(_, count)| count.saturating_add(1));
                self.behind = Some((boot_ms, count));
                if count < BEHIND {
                    return false;
                }
                self.restarted();
            }
            Some(ms) if !(0..=DAY_MS).contains(&ms) => self.restarted(),
            _ => {}
        }
        (self.boot_ms, self.behind) = (Some(boot_ms), None);
        true
    }

    fn restarted(&mut self) {
        self.tally.restarts += 1;
        self.events.push_back(Event::Restarted);
        self.must_be_left = self.beat.is_some_and(|beat| beat.is_controlled);
        self.end_entry(None);
        // Where it was is still the best that others can be told.
        self.is_of_boot = false;
        self.health = Health::default();
        (self.velocity, self.landed) = (None, None);
        self.next_look = None;
    }

    fn heartbeat(&mut self, custom_mode: u32, base_mode: u8, now: Duration) {
        const CUSTOM: u8 = 1;
        const ARMED: u8 = 128;
        let is_controlled = base_mode & CUSTOM != 0 && self.kind.is_outside_control(custom_mode);
        let beat = Beat { at: now, custom_mode, is_controlled, is_armed: base_mode & ARMED != 0 };
        self.tally.heartbeats += 1;
        if let Some(last) = self.beat {
            if now.saturating_sub(last.at) > self.rules.link_lost {
                self.events.push_back(Event::Back(now.saturating_sub(last.at)));
                self.next_look = None;
            }
            let is_changed = last.custom_mode != custom_mode;
            if is_changed && !is_controlled || last.is_armed && !beat.is_armed {
                self.end_entry(Some(Event::PilotActs));
            }
            if last.is_controlled && !is_controlled {
                self.quiet_until = now + QUIET;
                self.streaming_since = None;
                if self.state.has_control() {
                    self.tally.hand_overs += 1;
                    self.events.push_back(Event::HandedOver(custom_mode));
                }
            }
        }
        if !is_controlled {
            self.must_be_left = false;
        }
        self.beat = Some(beat);
        // What ends with this heartbeat does not wait for the next poll.
        self.settle(now);
    }

    /// The companion does not ask any more.
    fn end_entry(&mut self, event: Option<Event>) {
        if self.may_enter {
            self.events.extend(event);
        }
        self.may_enter = false;
        self.asked = None;
    }

    fn acknowledged(&mut self, command: u16, result: u8) {
        const IN_PROGRESS: u8 = 5;
        let is_own = [out::DO_SET_MODE, out::ARM_DISARM, out::NAV_TAKEOFF].contains(&command);
        let is_done = result == 0 || result == IN_PROGRESS;
        if !is_own || self.asked.is_none() {
            return;
        }
        let refused = (!is_done).then_some((command, result));
        // Each refusal is told once, however often it is repeated.
        if let Some((command, result)) = refused.filter(|_| refused != self.refused) {
            self.events.push_back(Event::Refused { command, result });
        }
        self.refused = refused;
    }

    /// Whether a vehicle that flies can be steered. Its takeoff must be over: taking off and landing are the pilot's, or what was asked for.
    fn is_in_air(&self, fix: &Fix) -> bool {
        if !self.kind.flies() {
            return true;
        }
        let has_begun = self.state.has_control();
        let [_, _, down_mps] = fix.velocity_ned_mps;
        let asked_m = self.rules.altitude_m.filter(|_| self.may_enter && self.rules.takeoff);
        let is_up = match asked_m {
            Some(altitude_m) => fix.above_home_m >= altitude_m - (altitude_m * 0.1).max(0.5),
            None => has_begun || -down_mps < CLIMB_OVER_MPS,
        };
        match self.landed {
            Some(MAV_LANDED_STATE_ON_GROUND | MAV_LANDED_STATE_TAKEOFF | MAV_LANDED_STATE_LANDING) => false,
            Some(MAV_LANDED_STATE_IN_AIR) => is_up,
            _ => fix.above_home_m >= LOW_M && is_up,
        }
    }

    /// Whether it has left the ground, by what it says, or else by its height.
    fn is_taking_off(&self) -> bool {
        match self.landed {
            Some(MAV_LANDED_STATE_TAKEOFF | MAV_LANDED_STATE_IN_AIR) => true,
            Some(MAV_LANDED_STATE_ON_GROUND) => false,
            _ => self.fix.is_some_and(|fix| self.is_of_boot && fix.above_home_m >= LOW_M),
        }
    }

    /// What to do now. The first rule that applies.
    fn next_state(&self, now: Duration) -> State {
        let beat = self.beat;
        let heard = beat.filter(|beat| now.saturating_sub(beat.at) <= self.rules.link_lost);
        let Some(beat) = heard else {
            return State::Silent;
        };
        let fix = self.fresh_fix(now);
        if self.rules.rehearses {
            return if fix.is_some() { State::Steering } else { State::NoPosition };
        }
        // It asks only for what it could use.
        let enters = self.may_enter && fix.is_some() && (beat.is_armed || self.rules.arm);
        if !beat.is_controlled {
            return if enters { State::Entering } else { State::Pilot };
        }
        if self.must_be_left {
            return State::Restarted;
        }
        if !beat.is_armed {
            return if enters { State::Entering } else { State::Disarmed };
        }
        let Some(fix) = fix else {
            return match self.state {
                State::Steering | State::Stopped | State::Distrusted if !self.health.is_trusted(now) => {
                    State::Distrusted
                }
                // Until there is one to be believed.
                State::Distrusted => State::Distrusted,
                State::Steering | State::Stopped => State::Stopped,
                _ => State::NoPosition,
            };
        };
        if !self.is_in_air(&fix) {
            let takes_off = enters && self.rules.takeoff;
            return if takes_off { State::Entering } else { State::Grounded };
        }
        State::Steering
    }

    /// Changes the state, if it has to, and says so.
    fn settle(&mut self, now: Duration) {
        let (from, to) = (self.state, self.next_state(now));
        if from == to {
            return;
        }
        if to == State::Steering && !self.rules.rehearses {
            // It has what it wanted.
            self.end_entry(None);
        }
        if to == State::Stopped {
            self.tally.stops += 1;
        }
        if to.has_control() || to == State::Entering {
            self.next_setpoint = now;
        }
        self.command = None;
        self.state = to;
        self.events.push_back(Event::State { from, to });
    }
}

#[cfg(test)]
pub(super) mod tests;
