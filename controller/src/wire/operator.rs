//! The operator's side of the robots' own keys.

use super::frame::decode_verified;
use super::sealed::{Epochs, code, counter};
use super::{
    DecodeError, EncodeError, Frame, Header, KeyAssignment, KeyHeld, KeyPhase, Message, PEERS, TAG_LEN, decode,
};
use crate::auth::{Mac, Master, ReplayGuard, is_same};
use crate::robot::RobotId;
use heapless::Vec;

/// Sends to each robot under its own key, and receives the robots' reports about their keys. Its
/// counters and starts follow the rules of [`Sealed`](super::Sealed).
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct OperatorWire<const N: usize = PEERS> {
    master: Master,
    header: Header,
    epochs: Epochs,
    guard: ReplayGuard<N>,
}

impl<const N: usize> OperatorWire<N> {
    /// Creates the format of operator `id` at its start number `starts`; `None` from 2^20 on.
    #[must_use]
    pub fn at_start(master: Master, id: RobotId, starts: u32) -> Option<Self> {
        let header = Header { boot: starts as u8, sender: id, sequence: 0 };
        Some(Self { master, header, epochs: Epochs::at_start(starts)?, guard: ReplayGuard::new() })
    }

    /// The master key from which all other keys are derived.
    #[must_use]
    pub const fn master(&self) -> &Master {
        &self.master
    }

    /// Appends a frame for one robot. An order in it applies to that robot only.
    ///
    /// # Errors
    /// Those of [`Sealed`](super::Sealed).
    pub fn say<const M: usize>(
        &mut self,
        to: RobotId,
        message: &Message,
        out: &mut Vec<u8, M>,
    ) -> Result<usize, EncodeError> {
        let own = Mac::new(&self.master.own_key(to));
        let len = self.epochs.seal(&own, self.header, message, out)?;
        self.header.sequence = self.header.sequence.wrapping_add(1);
        Ok(len)
    }

    /// Appends a frame that assigns the key of a generation to a robot.
    ///
    /// # Errors
    /// Those of [`Sealed`](super::Sealed).
    pub fn send_key<const M: usize>(
        &mut self,
        to: RobotId,
        generation: u16,
        phase: KeyPhase,
        out: &mut Vec<u8, M>,
    ) -> Result<usize, EncodeError> {
        let own = Mac::new(&self.master.own_key(to));
        let wrapped = self.master.seed(generation).wrap(&own, generation);
        self.say(to, &Message::Key(KeyAssignment { to, generation, phase, wrapped }), out)
    }

    /// Decodes a robot's report about its keys.
    ///
    /// # Errors
    /// [`DecodeError::Foreign`] for any other intact frame, or the reason for rejecting it.
    pub fn hear(&mut self, frame: &[u8]) -> Result<(RobotId, KeyHeld), DecodeError> {
        // The frame itself names the robot whose key verifies it.
        let Frame { header: Header { sender, .. }, message, .. } = decode(frame)?;
        let Message::KeyHeld(held) = message else {
            return Err(DecodeError::Foreign);
        };
        if held.to != self.header.sender {
            return Err(DecodeError::Foreign);
        }
        let own = Mac::new(&self.master.own_key(sender));
        let mut epoch = 0;
        let frame = decode_verified(frame, |content, tag: Option<[u8; TAG_LEN]>| {
            let [a, b, c, d, sent @ ..] = tag.ok_or(DecodeError::Unsigned)?;
            epoch = u32::from_le_bytes([a, b, c, d]);
            if is_same(&code(&own, content, [a, b, c, d]), &sent) { Ok(()) } else { Err(DecodeError::Forged) }
        })?;
        if !self.guard.admit(sender.0, counter(epoch, frame.header.sequence)).is_fresh() {
            return Err(DecodeError::Replayed);
        }
        Ok((sender, held))
    }
}
