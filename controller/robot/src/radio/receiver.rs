//! From bytes to frames.

use super::{Counts, Framing, Piece, count, remove};
use core::marker::PhantomData;
use heapless::Vec;

/// Collects the swarm's frames from a stream of bytes until the next step asks for them.
///
/// Only sound frames are kept: noise, damaged pieces and other versions of the format are counted and forgotten, what
/// is for others is passed over (the agent judges the rest: late, repeated, its own). When `N` bytes do not hold all
/// frames between two steps and the one that is coming, the oldest ones go. `N` is at least [`Framing::LONGEST`]: 60
/// bytes of postcard, 280 of MAVLink. A beacon takes some 50, so that 1024 bytes hold the beacons of twenty robots.
#[derive(Clone, Debug)]
pub struct Receiver<F, const N: usize> {
    /// Whole frames, then what is coming.
    bytes: Vec<u8, N>,
    /// Bytes of whole frames.
    whole: usize,
    /// How many of them the last step got.
    given: usize,
    /// What is coming is of no use up to the next delimiter.
    is_skipping: bool,
    counts: Counts,
    framing: PhantomData<F>,
}

impl<F: Framing, const N: usize> Receiver<F, N> {
    const FITS: () = assert!(N >= F::LONGEST, "no room for one frame");

    /// Without a byte.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::FITS;
        Self { bytes: Vec::new(), whole: 0, given: 0, is_skipping: false, counts: Counts::NONE, framing: PhantomData }
    }

    /// Takes bytes in as they come, cut anywhere. O(bytes x [`Framing::LONGEST`] + `N`).
    pub fn push(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty() {
            if self.is_skipping {
                let end = rest.iter().position(|byte| F::DELIMITER == Some(*byte));
                let Some(end) = end else { return };
                rest = rest.get(end.saturating_add(1)..).unwrap_or_default();
                self.is_skipping = false;
                count(&mut self.counts.refused, 1);
                continue;
            }
            if self.bytes.len() == self.whole && F::DELIMITER == rest.first().copied() {
                // It ends nothing.
                rest = rest.get(1..).unwrap_or_default();
                continue;
            }
            self.forget_given();
            if self.bytes.is_full() {
                self.make_room();
                continue;
            }
            let room = N.saturating_sub(self.bytes.len());
            let (piece, later) = rest.split_at_checked(room).unwrap_or((rest, &[]));
            // It fits.
            let _ = self.bytes.extend_from_slice(piece);
            rest = later;
            self.sort();
        }
    }

    /// A packet from a radio that has packets of its own: frames whose last delimiter may be missing. What was begun
    /// before it has no end any more.
    pub fn push_packet(&mut self, packet: &[u8]) {
        self.end();
        self.push(packet);
        self.end();
    }

    /// The line lost bytes (an overrun, a framing error): what was begun is of no use.
    pub fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        self.cut_short();
    }

    /// The frames since the last call, for [`Inputs::inbox`](staya_controller::agent::Inputs::inbox).
    pub fn take(&mut self) -> &[u8] {
        self.forget_given();
        self.given = self.whole;
        self.bytes.get(..self.whole).unwrap_or_default()
    }

    /// What came so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Nothing more comes of what is begun.
    fn end(&mut self) {
        match F::DELIMITER {
            Some(delimiter) => self.push(&[delimiter]),
            None => self.cut_short(),
        }
    }

    /// Forgets what is begun, up to its delimiter if it has one.
    fn cut_short(&mut self) {
        let is_begun = self.bytes.len() > self.whole;
        self.bytes.truncate(self.whole);
        if F::DELIMITER.is_some() {
            self.is_skipping = true;
        } else if is_begun {
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

    /// The oldest frame goes. What is coming is never longer than the longest frame.
    fn make_room(&mut self) {
        let mut rest = self.bytes.get(..self.whole).unwrap_or_default();
        match F::next_frame(&mut rest) {
            Some(frame) => {
                let len = frame.len();
                remove(&mut self.bytes, 0, len);
                self.whole = self.whole.saturating_sub(len);
                count(&mut self.counts.dropped, 1);
            }
            None => {
                self.whole = 0;
                self.cut_short();
            }
        }
    }

    /// Sorts out what has come.
    fn sort(&mut self) {
        loop {
            let coming = self.bytes.get(self.whole..).unwrap_or_default();
            let piece = F::first(coming);
            match piece {
                Piece::Frame(len) => {
                    self.whole = self.whole.saturating_add(len);
                    count(&mut self.counts.frames, 1);
                }
                Piece::Other(len) => remove(&mut self.bytes, self.whole, len),
                Piece::Noise(len) => {
                    remove(&mut self.bytes, self.whole, len);
                    count(&mut self.counts.refused, 1);
                }
                Piece::Begun if coming.len() >= F::LONGEST => return self.cut_short(),
                Piece::Begun => return,
            }
        }
    }
}

impl<F: Framing, const N: usize> Default for Receiver<F, N> {
    fn default() -> Self {
        Self::new()
    }
}
