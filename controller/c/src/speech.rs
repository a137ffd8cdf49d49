//! The wire formats in this build, as one type. A digest contains only the format inside.

use crate::one_of::one_of;
use heapless::Vec;
#[cfg(feature = "auth")]
use staya_controller::wire::Sealed;
use staya_controller::wire::{DecodeError, EncodeError, Frame, Header, KeyPhase, Message, Postcard, Wire};
#[cfg(feature = "mavlink")]
use staya_mavlink::wire::Mavlink;

/// Number of senders that a robot with a key tracks against replays; it accepts no others.
#[cfg(feature = "auth")]
pub const PEERS: usize = if cfg!(feature = "small") { 16 } else { staya_controller::wire::PEERS };

one_of! { $ each:
    /// A wire format.
    #[expect(missing_docs, reason = "StayaWire says what each is")]
    #[cfg_attr(feature = "auth", expect(clippy::large_enum_variant, reason = "without a key, omit the feature"))]
    Speech {
        Postcard(Postcard),
        #[cfg(feature = "mavlink")]
        Mavlink(Mavlink),
        #[cfg(feature = "auth")]
        Sealed(Sealed<PEERS>),
    }
}

impl Wire for Speech {
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
