//! Why a device is not the robot that it was told to be.

use core::fmt;
use staya_controller::agent::WrongTask;
use staya_controller::wire::Format;

/// Why a controller refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It was not told what to be.
    NotConfigured,
    /// The setup is for nobody.
    Nobody,
    /// It does not speak this format.
    Format(Format),
    /// The guidance law has no use for the task.
    Task,
    /// No guidance law of this firmware's reads so.
    Law,
    /// A search of so many cells.
    Search {
        /// Cells.
        needs: usize,
        /// Cells that fit.
        room: usize,
    },
    /// More obstacles than this.
    Obstacles {
        /// Obstacles that fit.
        room: usize,
    },
    /// A window whose cells are not as many as its sides say, an obstacle of no known shape, or neither a cell nor surroundings.
    Nonsense,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConfigured => f.write_str("not configured"),
            Self::Nobody => f.write_str("a setup for nobody: numbers begin at 1"),
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
