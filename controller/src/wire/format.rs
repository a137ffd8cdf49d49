//! The trait of all wire formats, [`Wire`], and the format of this crate, [`Postcard`].
//!
//! An [`Agent`](crate::agent::Agent) type names one format, so a firmware contains no other.
//! Counters and keys of a format belong to the agent's state and its digest.

use super::frame::next_frame;
use super::{Beacon, DecodeError, EncodeError, Frame, Header, KeyPhase, Message, decode, encode};
use crate::names::named;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A wire format: frames of one message each, which can be separated in a byte stream. Its
/// functions accept any bytes, do not allocate or panic, and do bounded work.
pub trait Wire: Clone + core::fmt::Debug + Serialize {
    /// Maximum length in bytes of a frame with a [`Beacon`]; other messages leave this much free.
    fn beacon_len(&self) -> usize;

    /// Appends one frame to `out` and returns its length.
    ///
    /// # Errors
    /// [`EncodeError::Full`] if the whole frame does not fit, [`EncodeError::NoSender`] if the
    /// sender is [`RobotId::NONE`](crate::robot::RobotId::NONE), [`EncodeError::Robot`] if the
    /// format cannot represent a robot number. Nothing is written in these cases.
    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError>;

    /// Decodes one frame as returned by [`Wire::next_frame`].
    ///
    /// # Errors
    /// The reason for rejecting the frame, see [`DecodeError`].
    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError>;

    /// Whether only senders with the key are accepted. Their numbers then count beacon periods, two
    /// numbers each ([`SequenceWindow::periods`](super::SequenceWindow::periods)), so that a
    /// receiver can date a delayed frame.
    fn is_authenticated(&self) -> bool {
        false
    }

    /// The robot's progress with its assigned keys; `None` for a format without own keys.
    fn held(&self) -> Option<(u16, KeyPhase)> {
        None
    }

    /// Removes the next frame from `rest`, or bytes between frames, which [`Wire::decode`] will
    /// reject and so count as damage. Returns `None` once `rest` is empty.
    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]>;
}

named! {
    /// The wire formats that a configuration can name.
    #[derive(Default)]
    pub enum Format {
        /// [`Postcard`].
        #[default]
        Postcard = "postcard",
        /// MAVLink 2 frames with the messages of Staya's dialect: the crate `staya-mavlink`.
        Mavlink = "mavlink",
    }
}

/// A wire format that can be chosen by name.
pub trait FromFormat: Wire {
    /// The format in its initial state; `None` if `format` is not the name of this format.
    fn from_format(format: Format) -> Option<Self>;
}

/// The frames of this crate: untagged postcard within COBS, see [`encode`] and [`decode`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Postcard;

impl Wire for Postcard {
    // Includes the space of a tag, so that robots send as much per step without tags as with them.
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
