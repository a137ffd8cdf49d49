//! External control of one vehicle as a state machine without I/O or clock: telemetry and time in,
//! messages out. Start with [`OffboardStateMachine::poll`].
//!
//! The companion sends setpoints only while it has control: heartbeats arrive, the external control
//! mode is active, the vehicle is armed (and in the air, if it flies), and its position is fresh.
//!
//! The pilot decides about that mode. With [`Entry::Once`] the companion requests it once after its
//! start, until a pilot acts. Setpoints stop with the first heartbeat in another mode. After a
//! restart the mode is not a permission: the pilot must leave it and select it again.

mod event;
mod health;
mod out;
mod poll;

pub use event::Event;
pub use health::Doubt;
pub use out::status_text;

use super::kind::Kind;
use crate::geo::Global;
use health::Health;
use serde::Serialize;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::MavMessage;
use staya_sim::choice;
use std::collections::VecDeque;
use std::time::Duration;

const HEARTBEAT: Duration = Duration::from_secs(1);
const QUIET: Duration = Duration::from_secs(5);
/// A larger step back in the time since boot is a restart, a smaller one a reordered message.
const OVERTAKEN_MS: i32 = 2000;
/// Consecutive rising messages, all behind the known time, that mean a restart soon after boot.
const BEHIND: u8 = 4;
/// A larger step ahead means a restart behind a clock that had wrapped.
const DAY_MS: i32 = 86_400_000;
/// A slower climb ends a takeoff.
const CLIMB_OVER_MPS: f64 = 0.3;
/// Below this height above home a vehicle without a landed state counts as on the ground.
const LOW_M: f64 = 1.0;

choice! {
    /// Selection of the external control mode.
    pub enum Entry {
        /// The pilot selects the mode.
        Wait = "wait",
        /// The companion selects the mode, once after its start.
        Once = "once",
    }
}

/// Rules by which a companion controls a vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Selection of the external control mode.
    pub entry: Entry,
    /// Whether [`Entry::Once`] also arms. Otherwise it waits for arming by the pilot.
    pub arm: bool,
    /// Whether it then takes off to `altitude_m`.
    pub takeoff: bool,
    /// Takeoff height above home, metres.
    pub altitude_m: Option<f64>,
    /// Whether that height is kept in flight; otherwise the agent commands vertical velocities.
    pub keeps_altitude: bool,
    /// Age at which a position is stale.
    pub stale: Duration,
    /// Timeout of heartbeats.
    pub link_lost: Duration,
    /// Interval of setpoints.
    pub setpoint_every: Duration,
    /// Position rate requested from the autopilot, Hz.
    pub position_hz: f64,
    /// Dry run: requests count as granted at once, and every vehicle with a position is controlled.
    pub rehearses: bool,
}

/// State of a companion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// No heartbeat; no setpoints.
    Silent,
    /// Two vehicles send with this system id; no setpoints.
    Ambiguous,
    /// The vehicle is in another mode: the pilot has control.
    Pilot,
    /// The autopilot restarted in the external control mode, which is not a permission.
    Restarted,
    /// The companion requests the mode, arms or takes off.
    Entering,
    /// External control mode, disarmed.
    Disarmed,
    /// External control mode, armed, no position yet.
    NoPosition,
    /// External control mode, armed, on the ground, taking off or landing.
    Grounded,
    /// The position became stale; the companion commands zero velocity.
    Stopped,
    /// The position is not trusted; the companion commands zero velocity.
    Distrusted,
    /// The companion controls the vehicle.
    Steering,
}

/// The last trusted position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Time of arrival.
    pub at: Duration,
    /// Geographic position.
    pub place: Global,
    /// Height above home, metres.
    pub above_home_m: f64,
    /// Velocity north, east, down, m/s.
    pub velocity_ned_mps: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Beat {
    at: Duration,
    custom_mode: u32,
    control: Control,
    is_armed: bool,
}

/// The external control mode in heartbeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Control {
    /// Another mode.
    Pilot,
    /// The mode, as a permission.
    Companion,
    /// The mode since before a restart: the pilot must leave it first.
    Withdrawn,
}

/// Telemetry since the last restart of the autopilot.
#[derive(Clone, Debug, Default)]
struct Boot {
    health: Health,
    /// Largest time since boot.
    time_ms: Option<u32>,
    /// The last message behind that time, and how many in a row rose.
    behind: Option<(u32, u8)>,
    /// Time and velocity of `LOCAL_POSITION_NED`, which is finer.
    velocity: Option<(Duration, [f64; 3])>,
    landed: Option<u8>,
    /// Whether the last trusted position is of this boot. An older one is the best estimate for
    /// others.
    has_fix: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ask {
    Mode,
    Arm,
    Takeoff,
}

#[derive(Clone, Copy, Debug)]
struct Request {
    ask: Ask,
    attempt: u8,
    at: Duration,
}

/// Progress of [`Entry::Once`].
#[derive(Clone, Copy, Debug, Default)]
struct Entering {
    request: Option<Request>,
    /// Command and result of the last acknowledgement, if it was a refusal.
    refused: Option<(u16, u8)>,
}

/// The last check of the rates at which telemetry arrives.
#[derive(Clone, Copy, Debug)]
struct Check {
    next: Duration,
    positions: u64,
    reports: u64,
    /// Number of checks since the first request.
    count: u8,
}

/// Counters of a companion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OffboardCounters {
    /// Heartbeats received.
    pub heartbeats: u64,
    /// Positions received.
    pub positions: u64,
    /// Setpoints sent.
    pub setpoints: u64,
    /// Number of times the pilot took control.
    pub hand_overs: u64,
    /// Number of stops because of a stale position.
    pub stops: u64,
    /// Number of times that positions lost trust.
    pub doubts: u64,
    /// Restarts of the autopilot.
    pub restarts: u64,
}

/// State machine of one vehicle.
#[derive(Clone, Debug)]
pub struct OffboardStateMachine {
    system: u8,
    kind: Kind,
    rules: Rules,
    state: State,
    beat: Option<Beat>,
    fix: Option<Fix>,
    boot: Boot,
    /// `None` if not wanted, complete, or stopped by the pilot.
    entering: Option<Entering>,
    quiet_until: Duration,
    streaming_since: Option<Duration>,
    /// No control before this time.
    listens_until: Duration,
    is_ambiguous: bool,
    command: Option<(Duration, [f64; 3])>,
    next_heartbeat: Duration,
    next_setpoint: Duration,
    check: Option<Check>,
    events: VecDeque<Event>,
    tally: OffboardCounters,
}

impl OffboardStateMachine {
    /// Creates the state machine of vehicle `system`, which is assumed to have just started.
    pub fn new(system: u8, kind: Kind, rules: Rules) -> Self {
        Self {
            system,
            kind,
            rules,
            state: State::Silent,
            beat: None,
            fix: None,
            boot: Boot::default(),
            entering: (rules.entry == Entry::Once).then(Entering::default),
            quiet_until: Duration::ZERO,
            streaming_since: None,
            listens_until: Duration::ZERO,
            is_ambiguous: false,
            command: None,
            next_heartbeat: Duration::ZERO,
            next_setpoint: Duration::ZERO,
            check: None,
            events: VecDeque::new(),
            tally: OffboardCounters::default(),
        }
    }

    /// State at the last [`poll`](Self::poll).
    pub const fn state(&self) -> State {
        self.state
    }

    /// Counters so far.
    pub const fn tally(&self) -> OffboardCounters {
        self.tally
    }

    /// Last trusted position, of any age and any boot.
    pub const fn fix(&self) -> Option<Fix> {
        self.fix
    }

    /// Last position, if it is fresh and trusted.
    pub fn fresh_fix(&self, now: Duration) -> Option<Fix> {
        let is_trusted = self.boot.has_fix && self.boot.health.is_trusted(now);
        self.fix.filter(|fix| is_trusted && now.saturating_sub(fix.at) <= self.rules.stale)
    }

    /// Takes the next event for the operator.
    pub fn event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Sets the velocity that the agent commands, north, east, down, m/s.
    pub fn steer(&mut self, velocity_ned_mps: [f64; 3], now: Duration) {
        self.command = Some((now, velocity_ned_mps));
    }

    /// Sends no setpoints and requests no control before this time, so that another vehicle with
    /// the same system id is heard first.
    pub const fn listen_until(&mut self, time: Duration) {
        self.listens_until = time;
    }

    /// Sets whether two vehicles send with this system id.
    pub fn set_ambiguous(&mut self, is_ambiguous: bool, now: Duration) {
        self.is_ambiguous = is_ambiguous;
        self.settle(now);
    }

    /// Handles a message of the autopilot.
    pub fn hear(&mut self, message: &MavMessage, now: Duration) {
        match message {
            MavMessage::HEARTBEAT(beat) => self.heartbeat(beat.custom_mode, beat.base_mode, now),
            MavMessage::SYSTEM_TIME(time) => drop(self.is_in_order(time.time_boot_ms)),
            MavMessage::GLOBAL_POSITION_INT(at) if self.is_in_order(at.time_boot_ms) => {
                // Autopilots send latitude and longitude 0 before they know their position.
                if (at.lat, at.lon) == (0, 0) {
                    return;
                }
                let is_recent = |heard| now.saturating_sub(heard).as_secs_f64() * self.rules.position_hz <= 2.0;
                let fine = self.boot.velocity.filter(|(heard, _)| is_recent(*heard));
                let coarse = [at.vx, at.vy, at.vz].map(|v| f64::from(v) / 100.0);
                self.tally.positions += 1;
                if !self.boot.health.is_trusted(now) {
                    return;
                }
                self.boot.has_fix = true;
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
                    self.boot.velocity = Some((now, velocity.map(f64::from)));
                }
            }
            MavMessage::EXTENDED_SYS_STATE(state) => self.boot.landed = Some(state.landed_state),
            MavMessage::COMMAND_ACK(ack) => self.acknowledged(ack.command, ack.result),
            _ => {
                if let Some(doubt) = self.boot.health.hear(message, now) {
                    self.tally.doubts += 1;
                    self.events.push_back(Event::Doubts(doubt));
                    self.settle(now);
                }
            }
        }
    }

    /// Returns false for a reordered message.
    fn is_in_order(&mut self, boot_ms: u32) -> bool {
        let since = self.boot.time_ms.map(|last| boot_ms.wrapping_sub(last).cast_signed());
        match since {
            Some(ms) if (-OVERTAKEN_MS..0).contains(&ms) => {
                let rising = self.boot.behind.filter(|(last, _)| boot_ms > *last);
                let count = rising.map_or(1, |(_, count)| count.saturating_add(1));
                self.boot.behind = Some((boot_ms, count));
                if count < BEHIND {
                    return false;
                }
                self.restarted();
            }
            Some(ms) if !(0..=DAY_MS).contains(&ms) => self.restarted(),
            _ => {}
        }
        (self.boot.time_ms, self.boot.behind) = (Some(boot_ms), None);
        true
    }

    fn restarted(&mut self) {
        self.tally.restarts += 1;
        self.events.push_back(Event::Restarted);
        if let Some(Beat { control: control @ Control::Companion, .. }) = &mut self.beat {
            *control = Control::Withdrawn;
        }
        self.end_entry(None);
        self.boot = Boot::default();
        self.check = None;
    }

    fn heartbeat(&mut self, custom_mode: u32, base_mode: u8, now: Duration) {
        let is_withdrawn = self.beat.is_some_and(|last| last.control == Control::Withdrawn);
        let control =
            match base_mode & MAV_MODE_FLAG_CUSTOM_MODE_ENABLED != 0 && self.kind.is_outside_control(custom_mode) {
                false => Control::Pilot,
                true if is_withdrawn => Control::Withdrawn,
                true => Control::Companion,
            };
        let beat = Beat { at: now, custom_mode, control, is_armed: base_mode & MAV_MODE_FLAG_SAFETY_ARMED != 0 };
        self.tally.heartbeats += 1;
        if let Some(last) = self.beat {
            if now.saturating_sub(last.at) > self.rules.link_lost {
                self.events.push_back(Event::Back(now.saturating_sub(last.at)));
                self.check = None;
            }
            let is_changed = last.custom_mode != custom_mode;
            if is_changed && control == Control::Pilot || last.is_armed && !beat.is_armed {
                self.end_entry(Some(Event::PilotActs));
            }
            if last.control != Control::Pilot && control == Control::Pilot {
                self.quiet_until = now + QUIET;
                self.streaming_since = None;
                if self.state.has_control() {
                    self.tally.hand_overs += 1;
                    self.events.push_back(Event::HandedOver(custom_mode));
                }
            }
        }
        self.beat = Some(beat);
        self.settle(now);
    }

    fn end_entry(&mut self, event: Option<Event>) {
        if self.entering.take().is_some() {
            self.events.extend(event);
        }
    }

    fn acknowledged(&mut self, command: u16, result: u8) {
        const IN_PROGRESS: u8 = 5;
        let Some(Entering { request: Some(_), refused: last }) = &mut self.entering else { return };
        if ![MAV_CMD_DO_SET_MODE, MAV_CMD_COMPONENT_ARM_DISARM, MAV_CMD_NAV_TAKEOFF].contains(&command) {
            return;
        }
        let refused = (result != 0 && result != IN_PROGRESS).then_some((command, result));
        if refused.is_some() && refused != *last {
            self.events.push_back(Event::Refused { command, result });
        }
        *last = refused;
    }

    /// A takeoff must be complete: takeoff and landing belong to the pilot or the entry.
    fn is_in_air(&self, fix: &Fix) -> bool {
        if !self.kind.flies() {
            return true;
        }
        let has_begun = self.state.has_control();
        let [_, _, down_mps] = fix.velocity_ned_mps;
        let asked_m = self.rules.altitude_m.filter(|_| self.entering.is_some() && self.rules.takeoff);
        let is_up = match asked_m {
            Some(altitude_m) => fix.above_home_m >= altitude_m - (altitude_m * 0.1).max(0.5),
            None => has_begun || -down_mps < CLIMB_OVER_MPS,
        };
        match self.boot.landed {
            Some(MAV_LANDED_STATE_ON_GROUND | MAV_LANDED_STATE_TAKEOFF | MAV_LANDED_STATE_LANDING) => false,
            Some(MAV_LANDED_STATE_IN_AIR) => is_up,
            _ => fix.above_home_m >= LOW_M && is_up,
        }
    }

    fn is_taking_off(&self) -> bool {
        match self.boot.landed {
            Some(MAV_LANDED_STATE_TAKEOFF | MAV_LANDED_STATE_IN_AIR) => true,
            Some(MAV_LANDED_STATE_ON_GROUND) => false,
            _ => self.boot.has_fix && self.fix.is_some_and(|fix| fix.above_home_m >= LOW_M),
        }
    }

    /// The state at `now`: the first rule that applies.
    fn next_state(&self, now: Duration) -> State {
        if self.is_ambiguous {
            return State::Ambiguous;
        }
        let heard = self.beat.filter(|beat| now.saturating_sub(beat.at) <= self.rules.link_lost);
        let Some(beat) = heard else { return State::Silent };
        let fix = self.fresh_fix(now).filter(|_| now >= self.listens_until);
        if self.rules.rehearses {
            return if fix.is_some() { State::Steering } else { State::NoPosition };
        }
        let enters = self.entering.is_some() && fix.is_some() && (beat.is_armed || self.rules.arm);
        match beat.control {
            Control::Pilot => return if enters { State::Entering } else { State::Pilot },
            Control::Withdrawn => return State::Restarted,
            Control::Companion => {}
        }
        if !beat.is_armed {
            return if enters { State::Entering } else { State::Disarmed };
        }
        let Some(fix) = fix else {
            return match self.state {
                last if !last.has_control() => State::NoPosition,
                State::Steering | State::Stopped if self.boot.health.is_trusted(now) => State::Stopped,
                _ => State::Distrusted,
            };
        };
        if !self.is_in_air(&fix) {
            let takes_off = enters && self.rules.takeoff;
            return if takes_off { State::Entering } else { State::Grounded };
        }
        State::Steering
    }

    fn settle(&mut self, now: Duration) {
        let to = self.next_state(now);
        if to == self.state {
            return;
        }
        if to == State::Steering && !self.rules.rehearses {
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
        self.events.push_back(Event::State(to));
    }
}

#[cfg(test)]
pub(super) mod tests;
