//! The same for MAVLink frames, which nothing ends: their headers say how long they are.

use super::queue::remove;
use super::{Counts, Inbound, Outbound, count};
use heapless::Vec;
use staya_controller::wire::DecodeError;
use staya_mavlink::frame::{MAX_FRAME_LEN, Scan, scan};
use staya_mavlink::wire::decode;

const NONE: Counts = Counts {
    frames: 0,
    refused: 0,
    dropped: 0,
    line_errors: 0,
};

/// Collects the swarm's messages from a stream of MAVLink until the next step asks for them.
///
/// Only sound frames that a robot's controller understands are kept; other MAVLink messages on the same line are passed over, and pieces that
/// belong to no frame are counted. When `N` bytes do not hold all frames between two steps and the one that is coming, the oldest ones go. `N` is
/// at least [`MAX_FRAME_LEN`], the longest frame of anybody; a beacon takes 53 bytes.
#[derive(Clone, Debug, Default)]
pub struct MavlinkReceiver<const N: usize> {
    /// Whole frames, then what is coming.
    bytes: Vec<u8, N>,
    /// Bytes of whole frames.
    whole: usize,
    /// How many of them the last step got.
    given: usize,
    counts: Counts,
}

impl<const N: usize> MavlinkReceiver<N> {
    const FITS: () = assert!(N >= MAX_FRAME_LEN, "no room for one frame");

    /// Without a byte.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::FITS;
        Self {
            bytes: Vec::new(),
            whole: 0,
            given: 0,
            counts: NONE,
        }
    }

    /// A packet from a radio that has packets of its own: whole frames. What was begun before it has no end any more.
    pub fn push_packet(&mut self, packet: &[u8]) {
        self.forget_begun();
        self.push(packet);
        self.forget_begun();
    }

    fn forget_begun(&mut self) {
        if self.bytes.len() > self.whole {
            self.bytes.truncate(self.whole);
            count(&mut self.counts.refused, 1);
        }
    }

    /// The last step is over when something new comes.
    fn forget_given(&mut self) {
        let given = core::mem::take(&mut self.given);
        if given > 0 {
            remove(&mut self.bytes, 0, given);
            self.whole = self.whole.saturating_sub(given);
        }
    }

    /// Makes room for one byte: the oldest frame goes. What is coming is never longer than the longest frame.
    fn make_room(&mut self) {
        let oldest = first_len(self.bytes.get(..self.whole).unwrap_or_default());
        if oldest > 0 {
            remove(&mut self.bytes, 0, oldest);
            self.whole = self.whole.saturating_sub(oldest);
            count(&mut self.counts.dropped, 1);
        } else {
            self.forget_begun();
        }
    }

    /// Sorts out what has come.
    fn sort(&mut self) {
        loop {
            let coming = self.bytes.get(self.whole..).unwrap_or_default();
            let (junk, frame) = match scan(coming, false) {
                Scan::Frame { junk, frame } => (junk, frame.bytes()),
                Scan::Nothing { junk } => (junk, &[][..]),
            };
            let len = frame.len();
            let judged = decode(frame);
            if junk > 0 {
                remove(&mut self.bytes, self.whole, junk);
                count(&mut self.counts.refused, 1);
            }
            if len == 0 {
                return;
            }
            match judged {
                Ok(_) => {
                    self.whole = self.whole.saturating_add(len);
                    count(&mut self.counts.frames, 1);
                }
                Err(error) => {
                    remove(&mut self.bytes, self.whole, len);
                    if error != DecodeError::Foreign {
                        count(&mut self.counts.refused, 1);
                    }
                }
            }
        }
    }
}

/// Bytes of the first of whole frames; 0 without one.
fn first_len(frames: &[u8]) -> usize {
    match scan(frames, true) {
        Scan::Frame { junk, frame } => junk.saturating_add(frame.bytes().len()),
        Scan::Nothing { junk } => junk,
    }
}

impl<const N: usize> Inbound for MavlinkReceiver<N> {
    /// O(bytes * [`MAX_FRAME_LEN`] + N).
    fn push(&mut self, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        self.forget_given();
        let mut rest = bytes;
        while !rest.is_empty() {
            if self.bytes.is_full() {
                self.make_room();
            }
            let room = N.saturating_sub(self.bytes.len());
            let (piece, later) = rest.split_at_checked(room).unwrap_or((rest, &[]));
            // It fits.
            let _ = self.bytes.extend_from_slice(piece);
            rest = later;
            self.sort();
        }
    }

    fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        self.forget_begun();
    }

    fn take(&mut self) -> &[u8] {
        self.forget_given();
        self.given = self.whole;
        self.bytes.get(..self.whole).unwrap_or_default()
    }

    fn capacity(&self) -> usize {
        N
    }

    fn counts(&self) -> Counts {
        self.counts
    }
}

/// Holds what steps want sent until the line takes it. When `N` bytes do not hold it all, the oldest frames go, but never the rest of one whose first bytes are
/// on the line.
#[derive(Clone, Debug, Default)]
pub struct MavlinkSender<const N: usize> {
    bytes: Vec<u8, N>,
    /// Bytes that are left of a frame whose first bytes are sent.
    begun: usize,
    counts: Counts,
}

impl<const N: usize> MavlinkSender<N> {
    /// With nothing to send.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bytes: Vec::new(),
            begun: 0,
            counts: NONE,
        }
    }

    fn queue(&mut self, frame: &[u8]) {
        if self.begun.saturating_add(frame.len()) > N {
            return count(&mut self.counts.dropped, 1);
        }
        while self.bytes.len().saturating_add(frame.len()) > N {
            let oldest = first_len(self.bytes.get(self.begun..).unwrap_or_default());
            remove(&mut self.bytes, self.begun, oldest.max(1));
            count(&mut self.counts.dropped, 1);
        }
        // There is room now.
        let _ = self.bytes.extend_from_slice(frame);
    }
}

impl<const N: usize> Outbound for MavlinkSender<N> {
    /// O(outbox + N) per frame.
    fn send(&mut self, outbox: &[u8]) {
        let mut rest = outbox;
        while let Some(frame) = staya_mavlink::frame::next_frame(&mut rest) {
            self.queue(frame.bytes());
        }
    }

    fn unsent(&self) -> &[u8] {
        &self.bytes
    }

    /// O(N).
    fn sent(&mut self, bytes: usize) {
        let mut left = bytes.min(self.bytes.len());
        let mut at = 0_usize;
        while left > 0 {
            if self.begun == 0 {
                let frames = self.bytes.get(at..).unwrap_or_default();
                self.begun = first_len(frames).max(1);
            }
            let now = left.min(self.begun);
            self.begun = self.begun.saturating_sub(now);
            at = at.saturating_add(now);
            left = left.saturating_sub(now);
            if self.begun == 0 {
                count(&mut self.counts.frames, 1);
            }
        }
        remove(&mut self.bytes, 0, at);
    }

    /// The rest of a begun frame goes: receivers find the next one by its checksum.
    fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        let begun = core::mem::take(&mut self.begun);
        if begun > 0 {
            remove(&mut self.bytes, 0, begun);
            count(&mut self.counts.dropped, 1);
        }
    }

    fn counts(&self) -> Counts {
        self.counts
    }
}

#[cfg(test)]
mod tests;
