use super::{Counts, Framing, count, remove};
use core::marker::PhantomData;
use heapless::Vec;

/// Holds frames until the line accepts them.
///
/// A full buffer drops the oldest, but never the rest of a frame that was partly sent. In formats
/// with a delimiter, one is sent after a pause, so that noise on idle lines does not damage the
/// frame.
#[derive(Clone, Debug)]
pub struct Sender<F, const N: usize> {
    bytes: Vec<u8, N>,
    /// Remaining bytes of a frame that was partly sent.
    begun: usize,
    /// The rest is not a whole frame: a single delimiter, or the end of a frame that failed.
    is_cut: bool,
    counts: Counts,
    framing: PhantomData<F>,
}

impl<F: Framing, const N: usize> Sender<F, N> {
    const END: usize = F::DELIMITER.is_some() as usize;

    /// Creates an empty sender.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), begun: 0, is_cut: false, counts: Counts::NONE, framing: PhantomData }
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox).
    /// O(outbox + `N`) per frame.
    pub fn send(&mut self, outbox: &[u8]) {
        let mut rest = outbox;
        while let Some(frame) = F::next_frame(&mut rest) {
            if frame.len() > Self::END {
                self.queue(frame);
            }
        }
    }

    /// The bytes to send next.
    #[must_use]
    pub fn unsent(&self) -> &[u8] {
        &self.bytes
    }

    /// Reports that the line accepted the first `bytes` of [`Self::unsent`]. O(`N`).
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

    /// Reports that the line failed: of a partly sent frame only the delimiter is kept.
    pub fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        if self.begun > Self::END {
            remove(&mut self.bytes, 0, self.begun.saturating_sub(Self::END));
            self.begun = Self::END;
            self.is_cut = true;
            count(&mut self.counts.dropped, 1);
        }
    }

    /// The counts so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn queue(&mut self, frame: &[u8]) {
        if let (true, Some(delimiter)) = (self.bytes.is_empty(), F::DELIMITER) {
            // If it does not fit, neither does the frame.
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
        let _ = self.bytes.extend_from_slice(frame);
    }

    /// Length of the frame that begins at `start`; at least 1.
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
