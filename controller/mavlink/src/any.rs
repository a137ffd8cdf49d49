//! Any wire format, for hosts and for firmware that is told by its host what to speak. A firmware that knows names the format's type.

use crate::wire::Mavlink;
use heapless::Vec;
use serde::{Serialize, Serializer};
use staya_controller::robot::RobotId;
use staya_controller::wire::{DecodeError, EncodeError, Format, Frame, FromFormat, Header, Message, Postcard, Wire};

/// A wire format that is known only when the program runs.
///
/// In an agent's digest it is what is in it, so that agents of the same state have the same digest however they speak.
#[derive(Clone, Debug)]
pub enum AnyWire {
    /// The controller's own frames.
    Postcard(Postcard),
    /// MAVLink 2 frames.
    Mavlink(Mavlink),
}

/// Does `$do` with the format that is in it.
macro_rules! each {
    ($any:expr, $wire:ident => $do:expr) => {
        match $any {
            AnyWire::Postcard($wire) => $do,
            AnyWire::Mavlink($wire) => $do,
        }
    };
}

impl AnyWire {
    /// The format of this name, without a past.
    #[must_use]
    pub const fn new(format: Format) -> Self {
        match format {
            Format::Postcard => Self::Postcard(Postcard),
            Format::Mavlink => Self::Mavlink(Mavlink),
        }
    }
}

/// The number that an operator beside the robots has: no robot's, and one that the format has room for.
#[must_use]
pub const fn operator(format: Format) -> RobotId {
    match format {
        Format::Postcard => RobotId(u32::MAX),
        Format::Mavlink => RobotId(255),
    }
}

/// The largest number of a robot.
#[must_use]
pub const fn max_robot(format: Format) -> RobotId {
    match format {
        Format::Postcard => RobotId(u32::MAX - 1),
        Format::Mavlink => RobotId(crate::wire::MAX_ROBOT as u32),
    }
}

impl Serialize for AnyWire {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        each!(self, wire => wire.serialize(serializer))
    }
}

impl FromFormat for AnyWire {
    fn from_format(format: Format) -> Option<Self> {
        Some(Self::new(format))
    }
}

impl FromFormat for Mavlink {
    fn from_format(format: Format) -> Option<Self> {
        (format == Format::Mavlink).then_some(Self)
    }
}

impl Wire for AnyWire {
    fn beacon_len(&self) -> usize {
        each!(self, wire => wire.beacon_len())
    }

    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError> {
        each!(self, wire => wire.encode(header, message, out))
    }

    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        each!(self, wire => wire.decode(frame))
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        each!(self, wire => wire.next_frame(rest))
    }
}
