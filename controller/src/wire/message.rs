//! The messages. All values are integers: millimetres, millimetres per second, microseconds, cells.
//!
//! The order and the types of the fields define the wire format (postcard): a field marked `fixint`
//! takes its full width, all others are a byte or a varint. Any change needs a new
//! [`VERSION`](super::VERSION), except a message appended to [`Message`], which older robots reject
//! ([`DecodeError::Body`](super::DecodeError::Body)).

use super::content::{Bytes, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD, ProtocolId};
use crate::robot::{Mode, RobotId};
use crate::{array, fixint};
use serde::{Deserialize, Serialize};

/// The state that a robot broadcasts periodically: everything that other robots may rely on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beacon {
    /// Position in world coordinates, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Velocity in world coordinates, mm/s.
    #[serde(with = "fixint")]
    pub velocity_mmps: [i16; 3],
    /// Radius of the smallest disc (ball) around the body, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
    /// Its current activity.
    pub mode: Mode,
    /// The number of its flock; robots of other flocks are strangers.
    pub flock: u8,
    /// The protocol of its law.
    pub protocol: ProtocolId,
    /// The payload of its law.
    pub payload: Bytes<MAX_PAYLOAD>,
}

/// A law's message to one robot, resent until it is acknowledged or expires; or an order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Addressed {
    /// The addressee. An order to [`RobotId::NONE`] is for all robots.
    pub to: RobotId,
    /// Distinguishes the messages of one sender; unchanged in each repeat. Of two orders about one
    /// subject the one that is 1 to 127 ahead on the circle of 256 values is newer.
    pub number: u8,
    /// The protocol of the content.
    pub protocol: ProtocolId,
    /// The message or the order.
    pub content: Bytes<MAX_ORDER>,
}

/// A law's message to all robots, sent once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Broadcast {
    /// The protocol of the content.
    pub protocol: ProtocolId,
    /// The message.
    pub content: Bytes<MAX_CONTENT>,
}

/// Confirms the reception of a message, whether or not it will be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ack {
    /// The robot that sent the message.
    pub to: RobotId,
    /// The boot number of that robot when it sent the message.
    pub boot: u8,
    /// The number of the message.
    pub number: u8,
}

/// The last state of a robot that the sender knows. Robots send those that they know in turn,
/// behind their beacons; an operator sends it to clear the place of a robot that was carried away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LostRobot {
    /// The robot.
    pub id: RobotId,
    /// True: it fell silent near the position. False: it was heard there, or with a radius of 0,
    /// it is no longer there.
    pub is_lost: bool,
    /// Time since its last beacon, or since it is known not to be there: hundredths of a second.
    #[serde(with = "fixint")]
    pub age_cs: u16,
    /// Centre of the ball in which it was, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Radius of that ball, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
}

/// The last beacon of a robot of the own formation, without its velocity, for robots that do not
/// hear it. Robots send those of the robots that their law needs in turn, behind their beacons.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Relayed {
    /// The robot.
    pub id: RobotId,
    /// Time since that beacon, hundredths of a second.
    #[serde(with = "fixint")]
    pub age_cs: u16,
    /// Its position, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Its radius, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
    /// Its activity.
    pub mode: Mode,
    /// The number of its flock.
    pub flock: u8,
    /// The protocol of its law.
    pub protocol: ProtocolId,
    /// The payload of its law.
    pub payload: Bytes<MAX_PAYLOAD>,
}

/// The stages of a key change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum KeyPhase {
    /// Accept frames made with the new key, in addition to the previous one.
    Hear,
    /// Send with the new key.
    Speak,
    /// Reject frames made with earlier keys.
    Forget,
}

/// A new key of the swarm, sealed with one robot's own key and repeated until [`KeyHeld`] arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeyAssignment {
    /// The addressee.
    pub to: RobotId,
    /// Counts the keys of the swarm, from 0 for the first.
    #[serde(with = "fixint")]
    pub generation: u16,
    /// The stage to advance to.
    pub phase: KeyPhase,
    /// The seed of the key, encrypted for the addressee: see `auth::Seed`.
    #[serde(with = "array")]
    pub wrapped: [u8; 32],
}

/// A robot's progress with its keys: the answer to a [`KeyAssignment`], sealed with its own key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeyHeld {
    /// The operator that sent the key.
    pub to: RobotId,
    /// The latest generation that the robot has.
    #[serde(with = "fixint")]
    pub generation: u16,
    /// The stage of that generation.
    pub phase: KeyPhase,
}

/// The content of a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// The periodic state of a robot.
    Beacon(Beacon),
    /// A law's message to one robot.
    Law(Addressed),
    /// The acknowledgement of a law's message.
    Ack(Ack),
    /// A law's message to all robots.
    Broadcast(Broadcast),
    /// An operator's order to the law. Not acknowledged: the sender repeats it, with one number, as
    /// long as a robot may have missed it.
    Order(Addressed),
    /// The state of another robot.
    Lost(LostRobot),
    /// A new key of the swarm.
    Key(KeyAssignment),
    /// A robot's progress with its keys.
    KeyHeld(KeyHeld),
    /// The last beacon of another robot.
    Relayed(Relayed),
}

impl Message {
    /// The robot that the message is addressed to; `None` if it is for all robots.
    #[must_use]
    pub const fn addressee(&self) -> Option<RobotId> {
        let to = match self {
            Self::Beacon(_) | Self::Broadcast(_) | Self::Lost(_) | Self::Relayed(_) => return None,
            Self::Law(message) | Self::Order(message) => message.to,
            Self::Ack(ack) => ack.to,
            Self::Key(key) => key.to,
            Self::KeyHeld(held) => held.to,
        };
        if to.is_some() { Some(to) } else { None }
    }

    /// Whether only an operator may send this message.
    #[must_use]
    pub const fn is_order(&self) -> bool {
        matches!(self, Self::Order(_) | Self::Key(_))
    }
}
