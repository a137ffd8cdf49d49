//! Who a robot is, and what it is doing as a whole.

use core::fmt;
use serde::{Deserialize, Serialize};

/// A robot's number, 1 to 2^31 - 2^16 - 1; 0 means nobody (the paper's "anyone").
///
/// Each robot has one of its own. When two have the same by mistake, those that hear both know one of them as its
/// [double](Self::double): the numbers from 2^31 on are for these. Those before them are for whom a robot [sees](Self::local).
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

    /// Somebody whose number nobody has told, as number `n` of those whom a robot [sees](crate::neighbor::Tracker): one of the last 2^16 numbers
    /// before those of doubles. It means something to that robot alone; no robot should be given one.
    #[must_use]
    pub const fn local(n: u16) -> Self {
        Self(FIRST_LOCAL | n as u32)
    }

    /// Whether it is one of [`RobotId::local`].
    #[must_use]
    pub const fn is_local(self) -> bool {
        self.0 & !0xFFFF == FIRST_LOCAL
    }

    /// What a second robot of this number is known as; a number that nobody has.
    #[must_use]
    pub const fn double(self) -> Self {
        Self(self.0 | DOUBLE)
    }

    /// The number of the robot that this is the double of; `None` when it is none.
    #[must_use]
    pub const fn doubled(self) -> Option<Self> {
        if self.0 & DOUBLE == 0 { None } else { Some(Self(self.0 & !DOUBLE)) }
    }
}

impl fmt::Display for RobotId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.doubled() {
            None if self.is_local() => write!(f, "seen {}", self.0 - FIRST_LOCAL),
            None => write!(f, "{}", self.0),
            Some(first) => write!(f, "{} (the second one)", first.0),
        }
    }
}

/// Set in the numbers of doubles.
const DOUBLE: u32 = 1 << 31;

/// The first of those that a robot gives to whom it sees.
const FIRST_LOCAL: u32 = DOUBLE - (1 << 16);

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
