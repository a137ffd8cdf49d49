//! What robots speak: a wire format, with a key or without one.

use heapless::Vec;
use serde::{Serialize, Serializer};
use staya_controller::auth::Key;
use staya_controller::robot::RobotId;
use staya_controller::wire::{
    DecodeError, EncodeError, Format, Frame, Header, MAX_TAGGED_ROBOT, Message, Sealed, Wire,
};
use staya_mavlink::any::{self, AnyWire};
use staya_mavlink::signed::Signed;
use staya_mavlink::signing::{MINUTE, Signing};

/// Senders that a robot with a key knows: the robots of a scenario with a key, and two operators.
pub const PEERS: usize = 1024;

/// A wire format that is known only when the program runs, and authenticates if there is a key.
#[derive(Clone, Debug)]
pub enum RobotWire {
    /// Everybody is believed.
    Open(AnyWire),
    /// Postcard's frames with a tag.
    Sealed(Box<Sealed<PEERS>>),
    /// MAVLink's with a signature.
    Signed(Box<Signed<PEERS>>),
}

/// Does `$do` with the format that is in it.
macro_rules! each {
    ($any:expr, $wire:ident => $do:expr) => {
        match $any {
            RobotWire::Open($wire) => $do,
            RobotWire::Sealed($wire) => $do,
            RobotWire::Signed($wire) => $do,
        }
    };
}

impl RobotWire {
    /// Without a past, at start number `starts` of its robot. By the rule of [`Sealed`], and that of [`Signing`] for robots without a clock: what
    /// was stored before each start is less than a minute of timestamps behind.
    #[must_use]
    pub fn new(format: Format, key: Option<&Key>, starts: u8) -> Self {
        Self::on_link(format, key, starts, 0)
    }

    fn on_link(format: Format, key: Option<&Key>, starts: u8, link: u8) -> Self {
        match (key, format) {
            (None, _) => Self::Open(AnyWire::new(format)),
            (Some(key), Format::Postcard) => {
                let sealed = Sealed::at_start(key, starts.into());
                Self::Sealed(Box::new(sealed.expect("a byte is less than 2^20")))
            }
            (Some(key), Format::Mavlink) => {
                let signing = Signing::new(key.clone(), link, u64::from(starts) * MINUTE);
                Self::Signed(Box::new(Signed::new(signing)))
            }
        }
    }

    /// That of an operator beside the robots, and his number: no robot's. With a key operators on different `link`s, 0 and 1, are told apart, so that each may count
    /// his frames for himself.
    #[must_use]
    pub fn operator(format: Format, key: Option<&Key>, link: u8) -> (Self, RobotId) {
        let number = match (key, format) {
            (Some(_), Format::Postcard) => RobotId(MAX_TAGGED_ROBOT.0 - u32::from(link)),
            _ => any::operator(format),
        };
        (Self::on_link(format, key, u8::MAX, link), number)
    }

    /// The largest number of a robot.
    #[must_use]
    pub fn max_robot(format: Format, has_key: bool) -> RobotId {
        match (has_key, format) {
            (true, Format::Postcard) => RobotId(MAX_TAGGED_ROBOT.0 - 2),
            _ => any::max_robot(format),
        }
    }
}

impl Serialize for RobotWire {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        each!(self, wire => wire.serialize(serializer))
    }
}

impl Wire for RobotWire {
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
