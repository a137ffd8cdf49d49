//! A wire format chosen at run time. Firmware with a fixed format names its type instead.

use crate::signed::Signed;
use crate::signing::Signing;
use crate::wire::Mavlink;
use core::ops::{Deref, DerefMut};
use heapless::Vec;
use serde::{Deserialize, Serialize};
use staya_controller::auth::Key;
use staya_controller::robot::RobotId;
use staya_controller::wire::{
    DecodeError, EncodeError, Format, Frame, FromFormat, Header, KeyPhase, MAX_TAGGED_ROBOT, Message, Postcard, Sealed,
    Wire,
};

/// A wire format chosen at run time. Formats with a key need [`Sealed`] and [`Signed`], or boxes of
/// them, as `S` and `G`; without these a robot carries no code for keys. A digest covers only the
/// format inside, so agents in the same state have equal digests in any format.
#[derive(Clone, Debug)]
pub enum AnyWire<S = Keyless, G = Keyless> {
    /// The controller's own frames.
    Postcard(Postcard),
    /// MAVLink 2 frames.
    Mavlink(Mavlink),
    /// The controller's own frames with a tag.
    Sealed(S),
    /// MAVLink 2 frames with a signature.
    Signed(G),
}

/// Replaces a format with a key if keys are not used; it has no values.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Keyless {}

impl Deref for Keyless {
    type Target = Postcard;

    fn deref(&self) -> &Postcard {
        match *self {}
    }
}

impl DerefMut for Keyless {
    fn deref_mut(&mut self) -> &mut Postcard {
        match *self {}
    }
}

macro_rules! each {
    ($any:expr, $wire:ident => $do:expr) => {
        match $any {
            AnyWire::Postcard($wire) => $do,
            AnyWire::Mavlink($wire) => $do,
            AnyWire::Sealed($wire) => $do,
            AnyWire::Signed($wire) => $do,
        }
    };
}

impl<S, G> AnyWire<S, G> {
    /// Creates the format of this name, without a key, in its initial state.
    #[must_use]
    pub const fn new(format: Format) -> Self {
        match format {
            Format::Postcard => Self::Postcard(Postcard),
            Format::Mavlink => Self::Mavlink(Mavlink),
        }
    }
}

impl<S, G, const P: usize, const Q: usize> AnyWire<S, G>
where
    S: From<Sealed<P>> + Deref<Target = Sealed<P>>,
    G: From<Signed<Q>> + Deref<Target = Signed<Q>>,
{
    /// Creates the format of this name with a key. Postcard counts `starts` as in [`Sealed`];
    /// MAVLink begins at `timestamp` on `link` as in [`Signing`]. `None` from 2^20 starts on.
    #[must_use]
    pub fn keyed(format: Format, key: &Key, starts: u32, link: u8, timestamp: u64) -> Option<Self> {
        Some(match format {
            Format::Postcard => Self::Sealed(Sealed::at_start(key, starts)?.into()),
            Format::Mavlink => Self::Signed(Signed::new(Signing::new(key.clone(), link, timestamp)).into()),
        })
    }
}

/// The number of an operator, different from those of all robots. With a key there may be two
/// operators, on `link` 0 and 1; if the format has room, their numbers differ, so that each can
/// count its own frames.
#[must_use]
pub const fn operator(format: Format, has_key: bool, link: u8) -> RobotId {
    match format {
        Format::Postcard if has_key => RobotId(MAX_TAGGED_ROBOT.0 - link as u32),
        Format::Postcard => RobotId(u32::MAX),
        Format::Mavlink => RobotId(255),
    }
}

/// The largest robot number; 2^31 and above are reserved for [duplicates](RobotId::duplicate).
#[must_use]
pub const fn max_robot(format: Format, has_key: bool) -> RobotId {
    match format {
        Format::Postcard if has_key => RobotId(MAX_TAGGED_ROBOT.0 - 2),
        Format::Postcard => RobotId((1 << 31) - 2),
        Format::Mavlink => RobotId(crate::wire::MAX_ROBOT as u32),
    }
}

mod state;

impl<S, G> FromFormat for AnyWire<S, G>
where
    Self: Wire,
{
    fn from_format(format: Format) -> Option<Self> {
        Some(Self::new(format))
    }
}

impl FromFormat for Mavlink {
    fn from_format(format: Format) -> Option<Self> {
        (format == Format::Mavlink).then_some(Self)
    }
}

impl<S, G> Wire for AnyWire<S, G>
where
    S: Clone + core::fmt::Debug + Serialize + DerefMut<Target: Wire>,
    G: Clone + core::fmt::Debug + Serialize + DerefMut<Target: Wire>,
{
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

    fn is_authenticated(&self) -> bool {
        each!(self, wire => wire.is_authenticated())
    }

    fn held(&self) -> Option<(u16, KeyPhase)> {
        each!(self, wire => wire.held())
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        each!(self, wire => wire.next_frame(rest))
    }
}
