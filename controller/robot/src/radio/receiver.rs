//! From bytes to frames.

use super::queue::FrameQueue;
use super::{Counts, Inbound, count};
use heapless::Vec;
use staya_controller::wire::{MAX_FRAME_LEN, decode};

/// Collects frames from a stream of bytes until the next step asks for them.
///
/// Only sound frames are kept, so that noise never costs one: a piece between two zero bytes that is too long, damaged
/// or of another version is counted and forgotten (the agent judges the rest: late, repeated, its own). When `N`
/// bytes do not hold all frames between two steps, the oldest ones go. A frame takes at most
/// [`MAX_FRAME_LEN`] bytes; a beacon takes some 48, so that 1024 bytes hold the beacons of twenty robots.
#[derive(Clone, Debug, Default)]
pub struct Receiver<const N: usize> {
    queue: FrameQueue<N>,
    /// How many bytes of the queue the last step got.
    given: usize,
    /// The frame that is coming.
    partial: Vec<u8, MAX_FRAME_LEN>,
    /// What is coming is of no use up to the next zero byte.
    is_skipping: bool,
    counts: Counts,
}

impl<const N: usize> Receiver<N> {
    /// Without a byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            queue: FrameQueue::new(),
            given: 0,
            partial: Vec::new(),
            is_skipping: false,
            counts: Counts {
                frames: 0,
                refused: 0,
                dropped: 0,
                line_errors: 0,
            },
        }
    }

    /// A packet from a radio that has packets of its own: frames whose last zero byte may be missing. What was begun before it
    /// has no end any more.
    pub fn push_packet(&mut self, packet: &[u8]) {
        self.end_frame();
        self.push(packet);
        self.end_frame();
    }

    fn end_frame(&mut self) {
        let is_whole = !core::mem::take(&mut self.is_skipping);
        if is_whole && self.partial.is_empty() {
            // Nothing between two zero bytes.
        } else if is_whole && decode(&self.partial).is_ok() {
            self.forget_given();
            let dropped = self.queue.push(&self.partial, 0);
            count(&mut self.counts.dropped, dropped);
            count(&mut self.counts.frames, 1);
        } else {
            count(&mut self.counts.refused, 1);
        }
        self.partial.clear();
    }

    /// The last step is over when something new comes.
    fn forget_given(&mut self) {
        let given = core::mem::take(&mut self.given);
        if given > 0 {
            self.queue.remove(0, given);
        }
    }
}

impl<const N: usize> Inbound for Receiver<N> {
    /// O(bytes + N) and for each frame one [`decode`](staya_controller::wire::decode).
    fn push(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if *byte == 0 {
                self.end_frame();
            } else if !self.is_skipping && self.partial.push(*byte).is_err() {
                self.is_skipping = true;
            }
        }
    }

    fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        self.is_skipping = true;
    }

    fn take(&mut self) -> &[u8] {
        self.forget_given();
        self.given = self.queue.bytes().len();
        self.queue.bytes()
    }

    fn capacity(&self) -> usize {
        N
    }

    fn counts(&self) -> Counts {
        self.counts
    }
}
