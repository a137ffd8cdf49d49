//! The messages, in integers: millimetres, millimetres per second, microseconds, cells.
//!
//! The order and the types of the fields are the wire format (postcard): what is marked `fixint`
//! takes its full width, everything else is a byte or a varint. A change of what is here is a new
//! [`VERSION`](super::VERSION); a further message at the end of [`Message`] is not: who does not know it refuses it
//! ([`DecodeError::Body`](super::DecodeError::Body)) and hears all others.

use super::payload::PayloadBytes;
use crate::fixint;
use crate::grid::{Cell, Dir};
use crate::land::LandPatch;
use crate::robot::{Mode, RobotId};
use crate::template::TemplateEntry;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// What a robot says of itself, periodically. Everything that others may rely on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beacon {
    /// Sender's clock when it sampled its state.
    #[serde(with = "fixint")]
    pub time: Instant,
    /// World position, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// World velocity, mm/s.
    #[serde(with = "fixint")]
    pub velocity_mmps: [i16; 3],
    /// Radius of the smallest disc (ball) around the body, mm.
    #[serde(with = "fixint")]
    pub radius_mm: u16,
    /// Cell that the robot occupies.
    #[serde(with = "fixint")]
    pub cell: Cell,
    /// The move it wants next.
    pub heading: Dir,
    /// Time until it is free to leave its cell, ms (saturating).
    #[serde(with = "fixint")]
    pub busy_ms: u16,
    /// Its leader, or nobody.
    pub leader: RobotId,
    /// Its place in the formation; of a robot in a flock the flock's number. Nobody is in both, and the frame is full.
    pub slot: u8,
    /// What it is doing.
    pub mode: Mode,
    /// Cell it is heading for.
    #[serde(with = "fixint")]
    pub target: Cell,
}

/// What one robot asks of another (A. V. Kuznetsov 2017, KUZ, section 7: up the leader chain, hop by hop).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RequestKind {
    /// Stand until told to resume (or the request expires).
    Stop,
    /// Go on.
    Resume,
    /// Choose another direction than the last one.
    Redirect,
}

/// A request to one robot; resent until acknowledged, given up after its expiry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request {
    /// Whom it asks.
    pub to: RobotId,
    /// Who first asked, when it travels up the chain.
    pub origin: RobotId,
    /// Distinguishes requests of one sender; resent unchanged with each retry.
    pub number: u8,
    /// What it asks.
    pub kind: RequestKind,
    /// How long the request stands after it was received, ms.
    #[serde(with = "fixint")]
    pub valid_ms: u16,
}

/// "I have your request", whatever became of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ack {
    /// The robot that asked.
    pub to: RobotId,
    /// The boot in which it asked: its numbers start anew with each.
    pub boot: u8,
    /// The number of its request.
    pub number: u8,
    /// Whether it will be followed.
    pub accepted: bool,
}

/// Entries in one [`TemplateAssignment`]: as many as a frame of 60 bytes carries.
pub const TEMPLATE_PART: usize = 2;

/// A part of a formation template, from whoever commands the swarm to one robot.
///
/// Every part but the last is full, so that a part's number says where its entries belong; only the
/// single part of a template without neighbours is empty. See [`TemplateAssignment::split`] and
/// [`TemplateAssembler`](super::TemplateAssembler).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TemplateAssignment {
    /// Who it is for.
    pub to: RobotId,
    /// Counts templates of this sender, wraps; parts of different versions never mix.
    pub version: u8,
    /// This part, 0..`parts`.
    pub part: u8,
    /// How many parts make the template.
    pub parts: u8,
    /// The robot's place in the formation.
    pub slot: u8,
    /// Cell difference from the top leader's place to this robot's place.
    #[serde(with = "fixint")]
    pub offset: Cell,
    /// The neighbours within the geodesic radius that this part lists.
    pub entries: heapless::Vec<TemplateEntry, TEMPLATE_PART>,
}

/// A new goal for one robot, or for all. Nobody acknowledges it: its sender says it again, with the same
/// version, for as long as somebody may have missed it. The same holds for [`TemplateAssignment`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalAssignment {
    /// Who it is for; nobody = everybody.
    pub to: RobotId,
    /// Counts goals of this sender, wraps; an older one never replaces a newer one
    /// ([`Newest`](super::Newest)).
    pub version: u8,
    /// The goal of the formation's top leader (each robot adds its own offset).
    #[serde(with = "fixint")]
    pub target: Cell,
}

/// A place to go to for one robot, or for all, in the plane or in space; it may move. Nobody acknowledges it: see
/// [`GoalAssignment`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointAssignment {
    /// Who it is for; nobody = everybody.
    pub to: RobotId,
    /// Counts places of this sender and index, wraps.
    pub version: u8,
    /// Which of several places, from 0.
    pub index: u8,
    /// World position when sent, mm.
    #[serde(with = "fixint")]
    pub position_mm: [i32; 3],
    /// World velocity, mm/s.
    #[serde(with = "fixint")]
    pub velocity_mmps: [i16; 3],
}

/// What a robot is to do with a key of the swarm's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum KeyPhase {
    /// Hear who speaks with it, too.
    Hear,
    /// Speak with it.
    Speak,
    /// Hear nobody any more who speaks with an earlier one.
    Forget,
}

/// A new key of the swarm's for one robot, sealed with that robot's own; said again until [`KeyHeld`] comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeyAssignment {
    /// Who it is for.
    pub to: RobotId,
    /// Counts the swarm's keys, from 0 for the first.
    #[serde(with = "fixint")]
    pub generation: u16,
    /// What to do with it.
    pub phase: KeyPhase,
    /// The seed that it is made of, encrypted for that robot: see `auth::Seed`.
    pub wrapped: [u8; 32],
}

/// "So far I am": the answer to a [`KeyAssignment`], sealed with the robot's own key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeyHeld {
    /// Who had sent it.
    pub to: RobotId,
    /// The latest generation that it has.
    #[serde(with = "fixint")]
    pub generation: u16,
    /// What it does with it.
    pub phase: KeyPhase,
}

/// Everything that a frame can carry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// Periodic state.
    Beacon(Beacon),
    /// A request to one robot.
    Request(Request),
    /// Its acknowledgement.
    Ack(Ack),
    /// A part of a formation template.
    Template(TemplateAssignment),
    /// A goal.
    Goal(GoalAssignment),
    /// A place.
    Waypoint(WaypointAssignment),
    /// A key.
    Key(KeyAssignment),
    /// How far its receiver is with it.
    KeyHeld(KeyHeld),
    /// Land that the sender knows of.
    Land(LandPatch),
    /// What the sender's law tells others of its kind.
    Payload(PayloadBytes),
}

impl Message {
    /// Whom it is for; `None` for what is for everybody.
    #[must_use]
    pub const fn addressee(&self) -> Option<RobotId> {
        let to = match self {
            Self::Beacon(_) | Self::Land(_) | Self::Payload(_) => return None,
            Self::Request(request) => request.to,
            Self::Ack(ack) => ack.to,
            Self::Template(part) => part.to,
            Self::Goal(goal) => goal.to,
            Self::Waypoint(place) => place.to,
            Self::Key(key) => key.to,
            Self::KeyHeld(held) => held.to,
        };
        if to.is_somebody() { Some(to) } else { None }
    }

    /// Whether it is for an operator, and for nobody else, to say.
    #[must_use]
    pub const fn is_order(&self) -> bool {
        matches!(self, Self::Template(_) | Self::Goal(_) | Self::Waypoint(_) | Self::Key(_))
    }
}
