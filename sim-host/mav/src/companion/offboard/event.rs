//! What a person wants to know of a companion.

use super::{ARM_DISARM, DO_SET_MODE, Doubt, NAV_TAKEOFF, State};
use std::fmt;
use std::time::Duration;

/// Something that happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The state changed.
    State {
        /// Before.
        from: State,
        /// Now.
        to: State,
    },
    /// The mode was left, for this custom mode, while the companion steered.
    HandedOver(u32),
    /// The autopilot's clock began anew.
    Restarted,
    /// Its positions are not to be believed any more.
    Doubts(Doubt),
    /// The autopilot says nothing of its estimator, although asked.
    NoHealth,
    /// Heard again after so long.
    Back(Duration),
    /// A pilot acted while the companion asked: it asks no more.
    PilotActs,
    /// It has asked often enough.
    GaveUp,
    /// The autopilot does not do what it was asked.
    Refused {
        /// `MAV_CMD`.
        command: u16,
        /// `MAV_RESULT`.
        result: u8,
    },
}

impl State {
    /// In words, at most 40 bytes.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Silent => "no heartbeat: sends nothing",
            Self::Pilot => "the pilot steers",
            Self::Restarted => "restarted: choose the mode anew",
            Self::Entering => "asks for control",
            Self::Disarmed => "waits: not armed",
            Self::NoPosition => "waits: no position yet",
            Self::Grounded => "waits: not in the air, or still climbing",
            Self::Stopped => "position is stale: stops",
            Self::Distrusted => "position not trusted: stops",
            Self::Steering => "steers",
        }
    }

    /// Whether the vehicle does what the companion says.
    #[must_use]
    pub const fn has_control(self) -> bool {
        matches!(self, Self::Steering | Self::Stopped | Self::Distrusted)
    }

    /// Whether somebody should look after it: `MAV_SEVERITY_WARNING` rather than `_INFO`.
    #[must_use]
    pub const fn is_worrying(self) -> bool {
        matches!(self, Self::Silent | Self::Restarted | Self::Stopped | Self::Distrusted)
    }
}

/// What it asks for, in words.
const fn command_words(command: u16) -> &'static str {
    match command {
        DO_SET_MODE => "the mode",
        ARM_DISARM => "arming",
        NAV_TAKEOFF => "the takeoff",
        _ => "a request",
    }
}

/// `MAV_RESULT` in words.
const fn result_words(result: u8) -> &'static str {
    match result {
        1 => "not now",
        2 => "denied",
        3 => "unsupported",
        4 => "failed",
        6 => "cancelled",
        _ => "refused",
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State { to, .. } => f.write_str(to.words()),
            Self::HandedOver(mode) => write!(f, "handed over to the pilot (mode {mode})"),
            Self::Restarted => f.write_str("the autopilot has restarted"),
            Self::Doubts(doubt) => write!(f, "position not trusted: {}", doubt.words()),
            Self::NoHealth => f.write_str("says nothing of its estimator: all its positions are trusted"),
            Self::Back(gap) => write!(f, "heard again after {:.1} s", gap.as_secs_f64()),
            Self::PilotActs => f.write_str("the pilot acts: asks no more"),
            Self::GaveUp => f.write_str("asked in vain: asks no more"),
            Self::Refused { command, result } => {
                write!(f, "{} (command {command}): {}", command_words(*command), result_words(*result))
            }
        }
    }
}
