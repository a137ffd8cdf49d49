use super::{Doubt, State};
use crate::terminal::result_words;
use staya_mavlink::constants::{MAV_CMD_COMPONENT_ARM_DISARM, MAV_CMD_DO_SET_MODE, MAV_CMD_NAV_TAKEOFF};
use std::fmt;
use std::time::Duration;

/// An event of one vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The state changed to this one.
    State(State),
    /// The pilot left the external control mode for this custom mode.
    HandedOver(u32),
    /// The autopilot restarted.
    Restarted,
    /// Its positions are not trusted.
    Doubts(Doubt),
    /// The autopilot does not send the status of its estimator despite requests.
    NoHealth,
    /// A heartbeat arrived after this time without one.
    Back(Duration),
    /// A pilot acted during the entry, so the companion stops requesting.
    PilotActs,
    /// The last request of the entry failed.
    GaveUp,
    /// The autopilot refused a command.
    Refused {
        /// `MAV_CMD`.
        command: u16,
        /// `MAV_RESULT`.
        result: u8,
    },
}

impl State {
    /// Text for the operator, at most 40 bytes.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Silent => "no heartbeat: sends no setpoints",
            Self::Ambiguous => "two vehicles have this system id",
            Self::Pilot => "pilot has control",
            Self::Restarted => "restarted: select the mode again",
            Self::Entering => "requests control",
            Self::Disarmed => "waits: disarmed",
            Self::NoPosition => "waits: no position",
            Self::Grounded => "waits: on the ground or climbing",
            Self::Stopped => "position stale: stopped",
            Self::Distrusted => "position not trusted: stopped",
            Self::Steering => "companion has control",
        }
    }

    /// Whether the vehicle follows the companion's setpoints.
    pub const fn has_control(self) -> bool {
        matches!(self, Self::Steering | Self::Stopped | Self::Distrusted)
    }

    /// Whether the operator should act.
    pub const fn is_worrying(self) -> bool {
        matches!(self, Self::Silent | Self::Ambiguous | Self::Restarted | Self::Stopped | Self::Distrusted)
    }
}

const fn command_words(command: u16) -> &'static str {
    match command {
        MAV_CMD_DO_SET_MODE => "mode change",
        MAV_CMD_COMPONENT_ARM_DISARM => "arming",
        MAV_CMD_NAV_TAKEOFF => "takeoff",
        _ => "a request",
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(to) => f.write_str(to.words()),
            Self::HandedOver(mode) => write!(f, "handed over to the pilot (mode {mode})"),
            Self::Restarted => f.write_str("the autopilot has restarted"),
            Self::Doubts(doubt) => write!(f, "position not trusted: {}", doubt.words()),
            Self::NoHealth => f.write_str("no estimator status: all positions are trusted"),
            Self::Back(gap) => write!(f, "heartbeat back after {:.1} s", gap.as_secs_f64()),
            Self::PilotActs => f.write_str("pilot acted: requests stopped"),
            Self::GaveUp => f.write_str("no success: requests stopped"),
            Self::Refused { command, result } => {
                write!(f, "{} (command {command}): {}", command_words(*command), result_words(*result))
            }
        }
    }
}
