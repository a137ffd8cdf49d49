//! Inputs and outputs of a step.

use super::{AnySurroundings, KinematicState, Wait};
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::neighbor::Claim;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::DecodeError;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Capacity of [`Outputs::outbox`], bytes: a beacon and a few requests and acknowledgements.
pub const OUTBOX: usize = 256;
/// Events that one step can report.
pub const EVENTS: usize = 8;

/// Inputs of one step; `I` are the surroundings as the guidance law needs them
/// ([`OnGrid`](super::OnGrid), [`InPlane`](super::InPlane), [`InCells`](super::InCells),
/// [`AnySurroundings`](super::AnySurroundings)).
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, S, I> {
    /// Own position and velocity.
    pub state: KinematicState<S>,
    /// Terrain and obstacles as the robot's sensors report them.
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
    /// Take the first of these moves whose cell is free and passable, if any (A. V. Kuznetsov 2017,
    /// KUZ, algorithm 4).
    Move(Vec<Dir, 8>),
    /// Move with this world velocity, m/s, within the speed limit of the body.
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
    /// This robot did not acknowledge a message of the law in time.
    MessageExpired(RobotId),
    /// A neighbour was added to the table.
    NeighborFound(RobotId),
    /// A neighbour was silent for longer than packet loss explains.
    NeighborLost(RobotId),
    /// The table was full, and this neighbour was removed.
    NeighborEvicted(RobotId),
    /// The clock or the sequence number of a neighbour restarted.
    NeighborRebooted(RobotId),
    /// All neighbours are lost; see [`ContactLossPolicy`](super::ContactLossPolicy).
    ContactLost,
    /// Two robots use this id; give one of them another id. Reported once, and again after the
    /// robot was lost and found. The second robot is known as [`RobotId::duplicate`].
    DuplicateId(RobotId),
    /// A robot began to report a value beyond its [limit](super::AgentConfig::plausibility); once
    /// per step for ids of no robot.
    Implausible {
        /// The sender.
        id: RobotId,
        /// The implausible value.
        claim: Claim,
    },
    /// The wire format has no counter or timestamp left
    /// ([`EncodeError::Exhausted`](crate::wire::EncodeError)): the robot needs a new key.
    Muted,
}

/// Counts of frames that failed authentication, by [`Sealed`](crate::wire::Sealed) or by MAVLink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Refused {
    /// Without a tag or signature.
    pub unsigned: u16,
    /// With a wrong tag or signature: another key, or changed content.
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

/// Counts of beacons with values beyond
/// [`AgentConfig::plausibility`](super::AgentConfig::plausibility).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImplausibleCounts {
    /// Beacons refused for an id that no robot has.
    pub numbers: u16,
    /// Radii that were reduced to the limit.
    pub radii: u16,
    /// Velocities that were reduced to the limit.
    pub speeds: u16,
    /// Beacons refused for a place that the robot cannot have reached yet.
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
    /// The cause if the robot does not advance; [`Wait::GoalTaken`] if it arrived beside its goal.
    pub wait: Option<Wait>,
    /// Accepted frames: valid, not duplicates, from other robots.
    pub received: u16,
    /// Rejected frames: damaged, of another version, repeated or replayed. Foreign frames
    /// ([`DecodeError::Foreign`](crate::wire::DecodeError)) count as neither received nor rejected.
    pub rejected: u16,
    /// The rejected frames that failed authentication.
    pub refused: Refused,
    /// Received beacons with implausible values.
    pub implausible: ImplausibleCounts,
    /// Bytes to send: frames of the agent's wire format. Each postcard frame ends with a zero byte.
    pub outbox: Vec<u8, OUTBOX>,
    /// The first [`EVENTS`] events of this step.
    pub events: Vec<Event, EVENTS>,
    /// When to call the step again if nothing arrives earlier.
    pub call_again: Instant,
}

impl<S> Outputs<S> {
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
