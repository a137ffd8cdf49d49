//! Frames that wait for the line.

use super::{Counts, Framing, count, remove};
use core::marker::PhantomData;
use heapless::Vec;

/// Holds what steps want sent until the line takes it.
///
/// When `N` bytes do not hold it all, the oldest frames go, but never the rest of one whose first bytes are on the
/// line. Where frames have a delimiter, one goes before the first frame after a pause, so that what the receivers' idle
/// lines picked up does not spoil it.
#[derive(Clone, Debug)]
pub struct Sender<F, const N: usize> {
    bytes: Vec<u8, N>,
    /// Bytes that are left of a frame whose first bytes are sent.
    begun: usize,
    /// What is begun is no whole frame: a delimiter by itself, or the end of a frame that failed.
    is_cut: bool,
    counts: Counts,
    framing: PhantomData<F>,
}

impl<F: Framing, const N: usize> Sender<F, N> {
    /// Bytes of a delimiter.
    const END: usize = F::DELIMITER.is_some() as usize;

    /// With nothing to send.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), begun: 0, is_cut: false, counts: Counts::NONE, framing: PhantomData }
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox). O(outbox + `N`) per frame.
    pub fn send(&mut self, outbox: &[u8]) {
        let mut rest = outbox;
        while let Some(frame) = F::next_frame(&mut rest) {
            if frame.len() > Self::END {
                self.queue(frame);
            }
        }
    }

    /// What the line should take next.
    #[must_use]
    pub fn unsent(&self) -> &[u8] {
        &self.bytes
    }

    /// The line took the first `bytes` of [`Self::unsent`]. O(`N`).
    pub fn sent(&mut self, bytes: usize) {
        let mut left = bytes.min(self.bytes.len());
        let mut at = 0_usize;
        while left > 0 {
            if self.begun == 0 {
                self.begun = self.frame_len(at);
                self.is_cut = self.begun <= Self::END;
            }
            let now = left.min(self.begun);
            self.begun = self.begun.saturating_sub(now);
            at = at.saturating_add(now);
            left = left.saturating_sub(now);
            if self.begun == 0 && !self.is_cut {
                count(&mut self.counts.frames, 1);
            }
        }
        remove(&mut self.bytes, 0, at);
    }

    /// The line failed: of a begun frame only the delimiter is left, which ends it for the receivers.
    pub fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        // One of which only the end is left has been sent.
        if self.begun > Self::END {
            remove(&mut self.bytes, 0, self.begun.saturating_sub(Self::END));
            self.begun = Self::END;
            self.is_cut = true;
            count(&mut self.counts.dropped, 1);
        }
    }

    /// What was sent so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn queue(&mut self, frame: &[u8]) {
        if let (true, Some(delimiter)) = (self.bytes.is_empty(), F::DELIMITER) {
            // Without room for it there is none for the frame.
            let _ = self.bytes.push(delimiter);
        }
        if self.begun.saturating_add(frame.len()) > N {
            return count(&mut self.counts.dropped, 1);
        }
        while self.bytes.len().saturating_add(frame.len()) > N {
            let oldest = self.frame_len(self.begun);
            count(&mut self.counts.dropped, usize::from(oldest > Self::END));
            remove(&mut self.bytes, self.begun, oldest);
        }
        // There is room now.
        let _ = self.bytes.extend_from_slice(frame);
    }

    /// Bytes of the frame that begins at `start`; at least 1.
    fn frame_len(&self, start: usize) -> usize {
        let mut rest = self.bytes.get(start..).unwrap_or_default();
        F::next_frame(&mut rest).map_or(1, <[u8]>::len)
    }
}

impl<F: Framing, const N: usize> Default for Sender<F, N> {
    fn default() -> Self {
        Self::new()
    }
}
