//! Who a robot is, and what it is doing as a whole.

use serde::{Deserialize, Serialize};

/// A robot's number; 0 means nobody (the paper's "anyone").
///
/// 32 bits, because a simulated swarm has up to a million robots; small numbers stay small on the
/// wire (varint).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct RobotId(pub u32);

impl RobotId {
    /// Nobody in particular; as an addressee: everybody.
    pub const NOBODY: Self = Self(0);

    /// Whether this is the number of a robot.
    #[must_use]
    pub const fn is_somebody(self) -> bool {
        self.0 != 0
    }
}

/// What the robot is doing as a whole; see [`crate::supervisor`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// No goal yet.
    #[default]
    Idle,
    /// Taking its place in the formation, before or during travel.
    Forming,
    /// On the way to its target.
    Cruise,
    /// Standing because somebody asked or no way is open.
    Hold,
    /// At its target.
    Arrived,
    /// Own input is missing or wrong; standing.
    Fault,
    /// Its agent does not steer it: the motors are off, or somebody else does.
    Passive,
}

impl Mode {
    /// Whether it wants to go nowhere: it has arrived, or nobody has sent it.
    #[must_use]
    pub const fn is_parked(self) -> bool {
        matches!(self, Self::Idle | Self::Arrived)
    }

    /// Whether its agent steers it at all, be it to stand, so that others can count on its giving way.
    #[must_use]
    pub const fn gives_way(self) -> bool {
        !matches!(self, Self::Fault | Self::Passive)
    }
}
