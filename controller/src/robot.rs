//! The id and the mode of a robot.

use crate::names::named;
use core::fmt;
use serde::{Deserialize, Serialize};

/// The id of a robot, 1 to 2^31 - 2^16 - 1; 0 stands for no robot (the paper's "anyone").
///
/// Ids must be unique. If two robots use one id, robots in range of both know one of them under its
/// [duplicate id](Self::duplicate), from 2^31 on. The 2^16 ids below are [local](Self::local). 32
/// bits serve simulated swarms of a million robots; small ids are short on the wire (varint).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct RobotId(pub u32);

impl RobotId {
    /// No particular robot; as a receiver, all robots.
    pub const NONE: Self = Self(0);

    /// Whether this is not [`RobotId::NONE`].
    #[must_use]
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }

    /// The id that a robot assigns to its anonymous [detection](crate::neighbor::Tracker) `n`.
    #[must_use]
    pub const fn local(n: u16) -> Self {
        Self(FIRST_LOCAL | n as u32)
    }

    /// Whether this is a [`RobotId::local`] id.
    #[must_use]
    pub const fn is_local(self) -> bool {
        self.0 & !0xFFFF == FIRST_LOCAL
    }

    /// The id under which a second robot with this id is known; no robot uses it itself.
    #[must_use]
    pub const fn duplicate(self) -> Self {
        Self(self.0 | DOUBLE)
    }

    /// The shared id, if this is a duplicate id.
    #[must_use]
    pub const fn duplicate_of(self) -> Option<Self> {
        if self.0 & DOUBLE == 0 { None } else { Some(Self(self.0 & !DOUBLE)) }
    }
}

impl fmt::Display for RobotId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.duplicate_of() {
            None if self.is_local() => write!(f, "seen {}", self.0 - FIRST_LOCAL),
            None => write!(f, "{}", self.0),
            Some(first) => write!(f, "{} (the second one)", first.0),
        }
    }
}

const DOUBLE: u32 = 1 << 31;

const FIRST_LOCAL: u32 = DOUBLE - (1 << 16);

named! {
    /// The current activity of a robot; see [`crate::supervisor`].
    #[derive(Default)]
    #[repr(u8)]
    pub enum Mode {
        /// It has no goal.
        #[default]
        Idle = "idle",
        /// It takes its place in the formation, before or during travel.
        Forming = "forming",
        /// It is on the way to its goal.
        Cruise = "cruise",
        /// It stands because it was asked to, or because no route is open.
        Hold = "hold",
        /// It is at its goal.
        Arrived = "arrived",
        /// It stands because an input is missing or invalid; in a simulation also while its
        /// computer is off.
        Fault = "down",
        /// Its agent does not steer it: the motors are off, or another controller steers.
        Passive = "passive",
    }
}

impl Mode {
    const ALL: [Self; 7] =
        [Self::Idle, Self::Forming, Self::Cruise, Self::Hold, Self::Arrived, Self::Fault, Self::Passive];

    /// Returns the mode with this number on the wire, from 0 in the order of the list.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Whether it does not intend to move: it has arrived, or has no goal.
    #[must_use]
    pub const fn is_parked(self) -> bool {
        matches!(self, Self::Idle | Self::Arrived)
    }

    /// Whether its agent steers it, even if only to stand, so that others can rely on it.
    #[must_use]
    pub const fn gives_way(self) -> bool {
        !matches!(self, Self::Fault | Self::Passive)
    }
}
