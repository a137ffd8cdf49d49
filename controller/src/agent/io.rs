//! What goes into a step and what comes out of it.

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

/// What one step gets; `I` is what the guidance law must be told: [`OnGrid`](super::OnGrid), [`InPlane`](super::InPlane),
/// [`InCells`](super::InCells) or [`AnySurroundings`](super::AnySurroundings).
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, S, I> {
    /// Own state.
    pub state: KinematicState<S>,
    /// What is around.
    pub surroundings: I,
    /// What the radio delivered since the last step: frames of the agent's wire format, in order of arrival. Damaged, foreign
    /// and partial ones are recognised and counted.
    pub inbox: &'a [u8],
}

/// What a robot gets whose guidance law is known only at run time.
pub type AnyInputs<'a, S> = Inputs<'a, S, AnySurroundings<'a, S>>;

impl<'a, S: Scalar, I: Into<AnySurroundings<'a, S>>> Inputs<'a, S, I> {
    /// The same for a law that is known only at run time.
    #[must_use]
    pub fn any(self) -> AnyInputs<'a, S> {
        Inputs { state: self.state, surroundings: self.surroundings.into(), inbox: self.inbox }
    }
}

/// What the body should do until the next step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command<S> {
    /// Stand.
    #[default]
    Hold,
    /// Take the first of these moves whose cell is free and passable; none free: stand
    /// (A. V. Kuznetsov 2017, KUZ, algorithm 4).
    Move(Vec<Dir, 8>),
    /// Go with this world velocity, m/s: within the speed that the body can have.
    Velocity(Vec3<S>),
}

/// Something that the robot's owner may want to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// The supervisor changed its mode.
    ModeChanged {
        /// Before.
        from: Mode,
        /// Now.
        to: Mode,
    },
    /// No exit of the window can be reached.
    NoRoute,
    /// The target lay in an impassable cell and moved to the nearest passable one.
    TargetMoved {
        /// As assigned.
        from: Cell,
        /// As used.
        to: Cell,
    },
    /// A request ran out of retries.
    RequestExpired {
        /// Whom it asked.
        to: RobotId,
        /// What it asked.
        kind: RequestKind,
    },
    /// A neighbour came into the table.
    NeighborFound(RobotId),
    /// A neighbour was silent for too long.
    NeighborLost(RobotId),
    /// The table was full and a neighbour had to go.
    NeighborEvicted(RobotId),
    /// A neighbour's clock or sequence restarted.
    NeighborRebooted(RobotId),
    /// Nobody is heard any more: all are lost. What the robot makes of it: [`Silence`](super::Silence).
    NobodyHeard,
    /// Two robots have this number, the own one or that of another robot, and one of them should get another. Said once, and
    /// again when that one is found again after it was lost. What such robots do: the second one is kept clear of as
    /// [`RobotId::double`], and by that number it is lost.
    DuplicateId(RobotId),
    /// A robot says of itself what is beyond [`AgentConfig::claims`](super::AgentConfig::claims). Said when it begins; of numbers that no
    /// robot has, once in a step.
    Overclaimed {
        /// Who.
        id: RobotId,
        /// What.
        claim: Claim,
    },
    /// The robot says nothing any more: its format has no counter or timestamp left to authenticate frames with
    /// ([`EncodeError::Exhausted`](crate::wire::EncodeError)). Said for each beacon that was due; a new key ends it.
    Muted,
}

/// Frames that were refused for who may have said them and when, by a format that authenticates them: [`Sealed`](crate::wire::Sealed) or MAVLink's
/// signatures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Refused {
    /// Without tag or signature.
    pub unsigned: u16,
    /// With one of another key, or of another content.
    pub forged: u16,
    /// Recorded, repeated by the radio, or of a time too far ahead.
    pub replayed: u16,
    /// Of senders for whom there is no room.
    pub no_room: u16,
}

impl Refused {
    /// Counts why a frame was refused, if it is for such a reason.
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

/// Beacons that said what is beyond [`AgentConfig::claims`](super::AgentConfig::claims).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Overclaims {
    /// A number that no robot has; refused.
    pub numbers: u16,
    /// A radius that was cut.
    pub radii: u16,
    /// A velocity that was cut.
    pub speeds: u16,
    /// A place where the robot cannot be yet; refused.
    pub jumps: u16,
}

impl Overclaims {
    /// Counts one.
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

/// What one step gives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "a step only decides; the caller moves the body and sends the bytes"]
pub struct Outputs<S> {
    /// What the body should do.
    pub command: Command<S>,
    /// What the robot waits for, if it does not get on; [`Wait::Place`] when it has arrived beside its goal.
    pub wait: Option<Wait>,
    /// Frames of the inbox that were heard: sound, not seen before, of somebody else.
    pub received: u16,
    /// Frames of the inbox that were refused: damaged, of another version, repeated or replayed. Those of others on the same band
    /// ([`DecodeError::Foreign`](crate::wire::DecodeError)) count neither here nor there.
    pub rejected: u16,
    /// How many of the refused were not authentic.
    pub refused: Refused,
    /// What was heard and not believed, or not all of it.
    pub overclaims: Overclaims,
    /// Bytes for the radio: frames of the agent's wire format; postcard's end with a zero byte each.
    pub outbox: Vec<u8, OUTBOX>,
    /// What happened; the oldest ones when more than [`EVENTS`].
    pub events: Vec<Event, EVENTS>,
    /// When to call again if nothing arrives before.
    pub call_again: Instant,
}

impl<S> Outputs<S> {
    /// As [`Outputs::default`], in place.
    pub(super) fn clear(&mut self) {
        (self.command, self.wait) = (Command::Hold, None);
        (self.received, self.rejected) = (0, 0);
        self.refused = Refused::default();
        self.overclaims = Overclaims::default();
        self.outbox.clear();
        self.events.clear();
        self.call_again = Instant::default();
    }
}
