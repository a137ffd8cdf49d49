//! Frames in a fixed buffer, one after the other.

use core::cell::Cell;
use heapless::Vec;

/// Whole frames, each ended by its zero byte, the oldest first.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameQueue<const N: usize> {
    bytes: Vec<u8, N>,
}

impl<const N: usize> FrameQueue<N> {
    pub(super) const fn new() -> Self {
        Self { bytes: Vec::new() }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Appends a frame, given without its zero byte, and drops the oldest ones for it if need be, but none of the
    /// first `kept` bytes. How many were dropped; the frame itself counts when there is no room at all.
    pub(super) fn push(&mut self, frame: &[u8], kept: usize) -> usize {
        let needed = frame.len().saturating_add(1);
        if kept.saturating_add(needed) > N {
            return 1;
        }
        let mut dropped = 0;
        while self.bytes.len().saturating_add(needed) > N {
            let oldest = self.frame_len(kept);
            // A lone delimiter is no frame.
            dropped += usize::from(oldest > 1);
            self.remove(kept, oldest.max(1));
        }
        // There is room now.
        let _ = self.bytes.extend_from_slice(frame);
        let _ = self.bytes.push(0);
        dropped
    }

    /// Bytes of the frame that begins at `start`, its zero byte included; 0 behind the last one.
    pub(super) fn frame_len(&self, start: usize) -> usize {
        let rest = self.bytes.get(start..).unwrap_or_default();
        let end = rest.iter().position(|byte| *byte == 0);
        end.map_or(rest.len(), |end| end + 1)
    }

    /// Takes `count` bytes out from `start` on. O(N).
    pub(super) fn remove(&mut self, start: usize, count: usize) {
        remove(&mut self.bytes, start, count);
    }
}

/// Takes `count` bytes out from `start` on. O(N).
pub(super) fn remove<const N: usize>(bytes: &mut Vec<u8, N>, start: usize, count: usize) {
    let cells = Cell::from_mut(bytes.as_mut_slice()).as_slice_of_cells();
    let count = count.min(cells.len().saturating_sub(start));
    let later = cells.iter().skip(start.saturating_add(count));
    for (to, from) in cells.iter().skip(start).zip(later) {
        to.set(from.get());
    }
    let left = cells.len().saturating_sub(count);
    bytes.truncate(left);
}
