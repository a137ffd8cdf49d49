//! How messages become bytes of the air: [`Wire`], and [`Postcard`], the frames of this crate.
//!
//! An [`Agent`](crate::agent::Agent) speaks the one format that its type names, so that a firmware pays for no other. What a
//! format keeps between frames (counters, keys) is a part of the agent's state, and so of its digest; one that keeps nothing
//! adds nothing to either.

use super::frame::next_frame;
use super::{Beacon, DecodeError, EncodeError, Frame, Header, KeyPhase, Message, decode, encode};
use crate::names::named;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A wire format: frames of one message each, which can be told apart in a stream of bytes.
///
/// Whatever the bytes are, its functions give an answer, allocate nothing, do not panic, and their work is bounded.
pub trait Wire: Clone + core::fmt::Debug + Serialize {
    /// Bytes of a frame that carries a [`Beacon`], at most: what acknowledgements and requests leave free
    /// for it in the outbox.
    fn beacon_len(&self) -> usize;

    /// Appends one frame to `out` and returns its length.
    ///
    /// # Errors
    /// [`EncodeError::Full`] when the whole frame does not fit, [`EncodeError::NoSender`] when `header` names nobody,
    /// [`EncodeError::Robot`] when the format has no room for a robot's number. Nothing is written then.
    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError>;

    /// Reads one frame as [`Wire::next_frame`] gave it.
    ///
    /// # Errors
    /// What is wrong with it, see [`DecodeError`]; any bytes at all give an answer.
    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError>;

    /// How far the robot is with the keys that it was sent, for who sends them; `None` for a format without keys of its own.
    fn held(&self) -> Option<(u16, KeyPhase)> {
        None
    }

    /// Takes the next frame off `rest`, or bytes between frames that [`Wire::decode`] will refuse, so that damage is counted.
    /// `None` when nothing is left; otherwise `rest` is shorter than before.
    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]>;
}

named! {
    /// The wire formats that robots can be told to speak, by name.
    #[derive(Default)]
    pub enum Format {
        /// [`Postcard`].
        #[default]
        Postcard = "postcard",
        /// MAVLink 2 frames with the messages of Staya's dialect: the crate `staya-mavlink`.
        Mavlink = "mavlink",
    }
}

/// A wire format that is, or can be, the one of a name.
pub trait FromFormat: Wire {
    /// The format, without a past; `None` when this is another one.
    fn from_format(format: Format) -> Option<Self>;
}

/// The frames of this crate: postcard within COBS, see [`encode`] and [`decode`]; without a tag. It keeps nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Postcard;

impl Wire for Postcard {
    // With the room of a tag, so that a robot that sends none says no more in a step than one that does.
    fn beacon_len(&self) -> usize {
        Beacon::MAX_FRAME_LEN
    }

    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError> {
        encode(header, message, out)
    }

    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        decode(frame)
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        next_frame(rest)
    }
}

impl FromFormat for Postcard {
    fn from_format(format: Format) -> Option<Self> {
        (format == Format::Postcard).then_some(Self)
    }
}

#[cfg(test)]
mod tests;
