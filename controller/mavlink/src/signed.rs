//! The swarm's messages as signed MAVLink 2 frames: [`Signed`].

use crate::frame::{RawFrame, SIGNATURE_LEN};
use crate::signing::{STREAMS, SignError, Signing, Verdict};
use crate::wire::{BEACON_LEN, Mavlink};
use heapless::Vec;
use serde::{Deserialize, Serialize};
use staya_controller::wire::{DecodeError, EncodeError, Frame, Header, Message, Wire};

/// [`Mavlink`] with signatures of 13 bytes: own frames are signed, and frames not signed with the
/// key are rejected. [`Signing`] defines the accepted frames, and the timestamps after a start.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Signed<const N: usize = STREAMS> {
    signing: Signing<N>,
}

impl<const N: usize> Signed<N> {
    /// Creates the format with this state.
    #[must_use]
    pub const fn new(signing: Signing<N>) -> Self {
        Self { signing }
    }

    /// Timestamp and counts.
    #[must_use]
    pub const fn signing(&self) -> &Signing<N> {
        &self.signing
    }

    /// Mutable access, for setting the time.
    pub const fn signing_mut(&mut self) -> &mut Signing<N> {
        &mut self.signing
    }
}

impl<const N: usize> Wire for Signed<N> {
    fn beacon_len(&self) -> usize {
        BEACON_LEN + SIGNATURE_LEN
    }

    /// Also returns [`EncodeError::Exhausted`] if no timestamp is left.
    #[expect(clippy::arithmetic_side_effects, reason = "lengths within a frame")]
    fn encode<const M: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, M>,
    ) -> Result<usize, EncodeError> {
        let before = out.len();
        let len = Mavlink.encode(header, message, out)?;
        let signed = if M.saturating_sub(out.len()) < SIGNATURE_LEN {
            Err(EncodeError::Full)
        } else {
            let frame = out.get_mut(before..).unwrap_or_default();
            self.signing.sign(frame).map_err(|error| match error {
                SignError::Exhausted => EncodeError::Exhausted,
                SignError::NotAFrame => EncodeError::Full,
            })
        };
        let signature = signed.inspect_err(|_| out.truncate(before))?;
        out.extend_from_slice(&signature).map_err(|_| EncodeError::Full)?;
        Ok(len + SIGNATURE_LEN)
    }

    /// Messages of other systems are [`DecodeError::Foreign`], signed or not.
    fn decode(&mut self, bytes: &[u8]) -> Result<Frame, DecodeError> {
        let frame = Mavlink.decode(bytes)?;
        let raw = RawFrame::new(bytes).ok_or(DecodeError::Crc)?;
        match self.signing.verify(&raw) {
            Verdict::Authentic => Ok(frame),
            Verdict::Unsigned => Err(DecodeError::Unsigned),
            Verdict::Forged => Err(DecodeError::Forged),
            Verdict::Replayed => Err(DecodeError::Replayed),
            Verdict::Ahead => Err(DecodeError::Ahead),
            Verdict::NoRoom => Err(DecodeError::NoRoom),
        }
    }

    fn is_authenticated(&self) -> bool {
        true
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        Mavlink.next_frame(rest)
    }
}

#[cfg(test)]
mod tests;
