//! Reasons why a device refuses a configuration or a step.

use core::fmt;
use staya_controller::agent::WrongTask;
use staya_controller::wire::Format;

/// Reason of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The device is not configured.
    NotConfigured,
    /// The setup has no robot id.
    NoRobot,
    /// The firmware does not speak this packet format.
    Format(Format),
    /// The guidance law does not accept the task.
    Task,
    /// The bytes do not describe the firmware's guidance law.
    Law,
    /// The grid search needs more cells than the device has.
    Search {
        /// Cells needed.
        needs: usize,
        /// Cells available.
        room: usize,
    },
    /// More obstacles than fit.
    Obstacles {
        /// Obstacles that fit.
        room: usize,
    },
    /// Inconsistent inputs: a window's size, an unknown shape, neither cell nor surroundings.
    Nonsense,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConfigured => f.write_str("not configured"),
            Self::NoRobot => f.write_str("the setup has no robot number; numbers begin at 1"),
            Self::Format(format) => {
                write!(f, "this firmware was built without {}", format.name())
            }
            Self::Task => fmt::Display::fmt(&WrongTask, f),
            Self::Law => f.write_str("the host has another guidance law than this firmware"),
            Self::Search { needs, room } => {
                write!(f, "a search of {needs} cells, and room for {room}")
            }
            Self::Obstacles { room } => write!(f, "more than {room} obstacles"),
            Self::Nonsense => f.write_str("terrain or surroundings that make no sense"),
        }
    }
}

impl core::error::Error for Refusal {}
