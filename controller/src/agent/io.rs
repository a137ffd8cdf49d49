//! Inputs and outputs of a step.

use super::{AnySurroundings, Wait};
use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir};
use crate::neighbor::Claim;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::{DecodeError, RequestKind};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Bytes that one step can send: a beacon and a few requests and acknowledgements.
pub const OUTBOX: usize = 256;
/// Events that one step can report.
pub const EVENTS: usize = 8;

/// The robot's own state, from its sensors or its autopilot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KinematicState<S> {
    /// World position.
    pub position: Position,
    /// World velocity, metres per second.
    pub velocity_mps: Vec3<S>,
}

/// Inputs of one step. `I` is the input of the guidance law: [`OnGrid`](super::OnGrid),
/// [`InPlane`](super::InPlane), [`InCells`](super::InCells) or
/// [`AnySurroundings`](super::AnySurroundings).
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, S, I> {
    /// Own position and velocity.
    pub state: KinematicState<S>,
    /// The surroundings as the guidance law needs them.
    pub surroundings: I,
    /// Bytes received since the last step: frames of the agent's wire format, in order of arrival.
    /// Damaged, foreign and partial frames are detected and counted.
    pub inbox: &'a [u8],
}

/// Inputs of an agent whose guidance law is chosen at run time.
pub type AnyInputs<'a, S> = Inputs<'a, S, AnySurroundings<'a, S>>;

impl<'a, S: Scalar, I: Into<AnySurroundings<'a, S>>> Inputs<'a, S, I> {
    /// Converts the inputs for an agent whose guidance law is chosen at run time.
    #[must_use]
    pub fn any(self) -> AnyInputs<'a, S> {
        Inputs { state: self.state, surroundings: self.surroundings.into(), inbox: self.inbox }
    }
}

/// The motion of the body until the next step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command<S> {
    /// Stand still.
    #[default]
    Hold,
    /// Take the first of these moves whose cell is free and passable; stand still if none is (A. V.
    /// Kuznetsov 2017, KUZ, algorithm 4).
    Move(Vec<Dir, 8>),
    /// Move with this world velocity, m/s, which is within the speed limit of the body.
    Velocity(Vec3<S>),
}

/// An event for the robot's operator or firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// The supervisor changed its mode.
    ModeChanged {
        /// Previous mode.
        from: Mode,
        /// Current mode.
        to: Mode,
    },
    /// No exit of the window is reachable.
    NoRoute,
    /// The target lay in an impassable cell and moved to the nearest passable one.
    TargetMoved {
        /// The assigned cell.
        from: Cell,
        /// The cell used instead.
        to: Cell,
    },
    /// A request ran out of retries.
    RequestExpired {
        /// The robot that was asked.
        to: RobotId,
        /// The kind of the request.
        kind: RequestKind,
    },
    /// A neighbour was added to the table.
    NeighborFound(RobotId),
    /// A neighbour was silent for longer than packet loss explains.
    NeighborLost(RobotId),
    /// The table was full, and this neighbour was removed.
    NeighborEvicted(RobotId),
    /// The clock or the sequence number of a neighbour restarted.
    NeighborRebooted(RobotId),
    /// All neighbours are lost. [`ContactLossPolicy`](super::ContactLossPolicy) determines the reaction.
    ContactLost,
    /// Two robots use this id, which is the own id or that of a neighbour. Give one of them another
    /// id.
    ///
    /// Reported once, and again if the robot is found again after it was lost. The second robot is
    /// avoided under the id [`RobotId::duplicate`], and is reported as lost under that id.
    DuplicateId(RobotId),
    /// A robot reported a value beyond [`AgentConfig::plausibility`](super::AgentConfig::plausibility).
    /// Reported when it begins; for ids that no robot has, once per step.
    Implausible {
        /// The sender.
        id: RobotId,
        /// The implausible value.
        claim: Claim,
    },
    /// The robot cannot send: its wire format has no counter or timestamp left to authenticate
    /// frames with ([`EncodeError::Exhausted`](crate::wire::EncodeError)). Reported for each beacon
    /// that is due, until a new key is set.
    Muted,
}

/// Counts of frames that failed authentication. Only formats that authenticate frames fill it:
/// [`Sealed`](crate::wire::Sealed) and signed MAVLink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Refused {
    /// Without a tag or signature.
    pub unsigned: u16,
    /// With a tag or signature that does not match: another key, or changed content.
    pub forged: u16,
    /// Recorded and replayed, repeated by the radio, or with a timestamp too far ahead.
    pub replayed: u16,
    /// From a sender for which the replay window has no room.
    pub no_room: u16,
}

impl Refused {
    pub(super) fn count(&mut self, error: DecodeError) {
        let count = match error {
            DecodeError::Unsigned => &mut self.unsigned,
            DecodeError::Forged => &mut self.forged,
            DecodeError::Replayed | DecodeError::Ahead => &mut self.replayed,
            DecodeError::NoRoom => &mut self.no_room,
            _ => return,
        };
        *count = count.saturating_add(1);
    }
}

/// Counts of beacons with values beyond [`AgentConfig::plausibility`](super::AgentConfig::plausibility).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImplausibleCounts {
    /// Ids that no robot has; the beacon was refused.
    pub numbers: u16,
    /// Radii that were reduced to the limit.
    pub radii: u16,
    /// Velocities that were reduced to the limit.
    pub speeds: u16,
    /// Places that the robot cannot have reached yet; the beacon was refused.
    pub jumps: u16,
}

impl ImplausibleCounts {
    pub(super) fn count(&mut self, claim: Claim) {
        let count = match claim {
            Claim::Number => &mut self.numbers,
            Claim::Radius => &mut self.radii,
            Claim::Speed => &mut self.speeds,
            Claim::Jump => &mut self.jumps,
        };
        *count = count.saturating_add(1);
    }
}

/// Outputs of one step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "a step only decides; the caller moves the body and sends the bytes"]
pub struct Outputs<S> {
    /// The motion of the body.
    pub command: Command<S>,
    /// The cause if the robot does not advance; [`Wait::GoalTaken`] if it has arrived beside its
    /// occupied goal.
    pub wait: Option<Wait>,
    /// Frames of the inbox that were accepted: valid, not duplicates, from other robots.
    pub received: u16,
    /// Frames of the inbox that were rejected: damaged, of another version, repeated or replayed.
    /// Foreign frames on the same band ([`DecodeError::Foreign`](crate::wire::DecodeError)) count
    /// as neither received nor rejected.
    pub rejected: u16,
    /// The rejected frames that failed authentication.
    pub refused: Refused,
    /// Received beacons with implausible values.
    pub implausible: ImplausibleCounts,
    /// Bytes to send: frames of the agent's wire format. Each postcard frame ends with a zero byte.
    pub outbox: Vec<u8, OUTBOX>,
    /// Events of this step; if more than [`EVENTS`] occur, the first ones.
    pub events: Vec<Event, EVENTS>,
    /// When to call the step again if nothing arrives earlier.
    pub call_again: Instant,
}

impl<S> Outputs<S> {
    /// Resets to [`Outputs::default`] in place.
    pub(super) fn clear(&mut self) {
        (self.command, self.wait) = (Command::Hold, None);
        (self.received, self.rejected) = (0, 0);
        self.refused = Refused::default();
        self.implausible = ImplausibleCounts::default();
        self.outbox.clear();
        self.events.clear();
        self.call_again = Instant::default();
    }
}
