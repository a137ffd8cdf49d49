//! Frames that wait for the line.

use super::queue::FrameQueue;
use super::{Counts, Outbound, count};
use staya_controller::wire::frames;

/// Holds what steps want sent until the line takes it.
///
/// When `N` bytes do not hold it all, the oldest frames go, but never the rest of one whose first bytes are on the line.
/// A zero byte goes before the first frame after a pause, so that what the receivers' idle lines picked up does not spoil it.
#[derive(Clone, Debug, Default)]
pub struct Sender<const N: usize> {
    queue: FrameQueue<N>,
    /// Bytes that are left of a frame whose first bytes are sent.
    begun: usize,
    /// It failed: what is left is only its end.
    is_cut: bool,
    counts: Counts,
}

impl<const N: usize> Sender<N> {
    /// With nothing to send.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            queue: FrameQueue::new(),
            begun: 0,
            is_cut: false,
            counts: Counts {
                frames: 0,
                refused: 0,
                dropped: 0,
                line_errors: 0,
            },
        }
    }
}

impl<const N: usize> Outbound for Sender<N> {
    /// O(outbox + N) per frame.
    fn send(&mut self, outbox: &[u8]) {
        for frame in frames(outbox) {
            if self.queue.bytes().is_empty() {
                self.queue.push(&[], 0);
            }
            let dropped = self.queue.push(frame, self.begun);
            count(&mut self.counts.dropped, dropped);
        }
    }

    fn unsent(&self) -> &[u8] {
        self.queue.bytes()
    }

    /// O(N).
    fn sent(&mut self, bytes: usize) {
        let sent = self.queue.bytes().iter().take(bytes);
        let mut begun = self.begun > 0;
        let mut ended = 0;
        for byte in sent {
            if *byte == 0 && begun {
                ended += usize::from(!core::mem::take(&mut self.is_cut));
            }
            begun = *byte != 0;
        }
        count(&mut self.counts.frames, ended);
        self.queue.remove(0, bytes);
        self.begun = if begun { self.queue.frame_len(0) } else { 0 };
    }

    /// Of a begun frame only the zero byte is left, which ends it for the receivers.
    fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        // One of which only the end is left has been sent.
        if self.begun > 1 {
            self.queue.remove(0, self.begun.saturating_sub(1));
            self.begun = 1;
            self.is_cut = true;
            count(&mut self.counts.dropped, 1);
        }
    }

    fn counts(&self) -> Counts {
        self.counts
    }
}
