//! The messages. All values are integers: millimetres, millimetres per second, microseconds, cells.
//!
//! The order and the types of the fields define the wire format (postcard): a field marked `fixint`
//! takes its full width, all others are a byte or a varint. Any change needs a new
//! [`VERSION`](super::VERSION), except a message appended to [`Message`], which older robots reject
//! ([`DecodeError::Body`](super::DecodeError::Body)).

use super::payload::PayloadBytes;
use crate::fixint;
use crate::grid::{Cell, Dir};
use crate::land::LandPatch;
use crate::robot::{Mode, RobotId};
use crate::template::TemplateEntry;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// The state that a robot broadcasts periodically: everything that other robots may rely on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beacon {
    /// The sender's clock when it sampled its state.
    #[serde(with = "fixint")]
    pub time: Instant,
    /// Position in world coordinates, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Velocity in world coordinates, mm/s.
    #[serde(with = "fixint")]
    pub velocity_mmps: [i16; 3],
    /// Radius of the smallest disc (ball) around the body, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
    /// The cell that the robot occupies.
    #[serde(with = "fixint")]
    pub cell: Cell,
    /// The move that it wants to make next.
    pub heading: Dir,
    /// Time until it may leave its cell, ms (saturating).
    #[serde(with = "fixint")]
    pub busy_ms: u16,
    /// Its leader, or [`RobotId::NONE`].
    pub leader: RobotId,
    /// Its place in the formation, or the number of its flock; a robot is never in both.
    pub slot: u8,
    /// Its current activity.
    pub mode: Mode,
    /// The cell that it is heading for.
    #[serde(with = "fixint")]
    pub target: Cell,
}

/// The kind of a request, which travels up the leader chain hop by hop (KUZ section 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RequestKind {
    /// Stop until a [`RequestKind::Resume`] arrives or the request expires.
    Stop,
    /// Continue.
    Resume,
    /// Choose another direction than the last one.
    Redirect,
}

/// A request to one robot, resent until it is acknowledged or expires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request {
    /// The addressee.
    pub to: RobotId,
    /// The robot that made the request first; not the sender if it travels up the leader chain.
    pub origin: RobotId,
    /// Distinguishes the requests of one sender; unchanged in each retry.
    pub number: u8,
    /// The requested action.
    pub kind: RequestKind,
    /// How long the request is valid after its reception, ms.
    #[serde(with = "fixint")]
    pub valid_ms: u16,
}

/// Confirms the reception of a request, whether or not it will be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ack {
    /// The robot that sent the request.
    pub to: RobotId,
    /// The boot number of that robot when it sent the request.
    pub boot: u8,
    /// The number of the request.
    pub number: u8,
    /// Whether the request will be followed.
    pub accepted: bool,
}

/// Entries in one [`TemplateAssignment`]: as many as fit into a frame of 60 bytes.
pub const TEMPLATE_PART: usize = 2;

/// One part of a formation template, sent by the swarm's operator to one robot.
///
/// All parts except the last are full, so the number of a part determines where its entries belong.
/// See [`TemplateAssignment::split`] and [`TemplateAssembler`](super::TemplateAssembler).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TemplateAssignment {
    /// The addressee.
    pub to: RobotId,
    /// Counts the templates of this sender, wraps. Parts of different versions never mix.
    pub version: u8,
    /// The number of this part, 0..`parts`.
    pub part: u8,
    /// The number of parts in the template.
    pub parts: u8,
    /// The robot's place in the formation.
    pub slot: u8,
    /// Cell difference from the place of the top leader to the place of this robot.
    #[serde(with = "fixint")]
    pub offset: Cell,
    /// The neighbours within the geodesic radius that this part lists.
    pub entries: heapless::Vec<TemplateEntry, TEMPLATE_PART>,
}

/// A new goal for one robot or for all. Not acknowledged: the sender repeats it, with one version,
/// as long as a robot may have missed it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalAssignment {
    /// The addressee; [`RobotId::NONE`] = all robots.
    pub to: RobotId,
    /// Counts the goals of this sender, wraps; see [`Newest`](super::Newest).
    pub version: u8,
    /// The goal of the formation's top leader (each robot adds its own offset).
    #[serde(with = "fixint")]
    pub target: Cell,
}

/// A waypoint, possibly moving, for one robot or for all; not acknowledged, see [`GoalAssignment`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointAssignment {
    /// The addressee; [`RobotId::NONE`] = all robots.
    pub to: RobotId,
    /// Counts the waypoints of this sender and index, wraps.
    pub version: u8,
    /// Which of several waypoints, from 0.
    pub index: u8,
    /// Position in world coordinates when sent, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Velocity in world coordinates, mm/s.
    #[serde(with = "fixint")]
    pub velocity_mmps: [i16; 3],
}

/// A lost robot, as the sender knows it. Robots send it in turn, behind their beacons, and an
/// operator sends it to clear the place of a robot that was carried away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LostRobot {
    /// The robot.
    pub id: RobotId,
    /// True: it fell silent near the position. False: it was heard since, or is no longer there.
    pub is_lost: bool,
    /// Time since its last beacon, or since it is known not to be there: hundredths of a second.
    #[serde(with = "fixint")]
    pub age_cs: u16,
    /// Centre of the ball in which it stands, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// Radius of that ball, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
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
    /// A request to one robot.
    Request(Request),
    /// The acknowledgement of a request.
    Ack(Ack),
    /// A part of a formation template.
    Template(TemplateAssignment),
    /// A goal on the grid.
    Goal(GoalAssignment),
    /// A waypoint in the plane or in space.
    Waypoint(WaypointAssignment),
    /// A new key of the swarm.
    Key(KeyAssignment),
    /// A robot's progress with its keys.
    KeyHeld(KeyHeld),
    /// A piece of the sender's map.
    Land(LandPatch),
    /// Data of the sender's guidance law for robots with the same law.
    Payload(PayloadBytes),
    /// A lost robot, or one that was wrongly taken for lost.
    Lost(LostRobot),
}

impl Message {
    /// The robot that the message is addressed to; `None` if it is for all robots.
    #[must_use]
    pub const fn addressee(&self) -> Option<RobotId> {
        let to = match self {
            Self::Beacon(_) | Self::Land(_) | Self::Payload(_) | Self::Lost(_) => return None,
            Self::Request(request) => request.to,
            Self::Ack(ack) => ack.to,
            Self::Template(part) => part.to,
            Self::Goal(goal) => goal.to,
            Self::Waypoint(place) => place.to,
            Self::Key(key) => key.to,
            Self::KeyHeld(held) => held.to,
        };
        if to.is_some() { Some(to) } else { None }
    }

    /// Whether only an operator may send this message.
    #[must_use]
    pub const fn is_order(&self) -> bool {
        matches!(self, Self::Template(_) | Self::Goal(_) | Self::Waypoint(_) | Self::Key(_))
    }
}
