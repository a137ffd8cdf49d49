use super::{Counts, Framing, Piece, count, remove};
use core::marker::PhantomData;
use heapless::Vec;

/// Collects the swarm's frames from a byte stream until the next step takes them.
///
/// Only intact frames are kept; noise, damage and other versions of the format are counted. A full
/// buffer drops the oldest frames. `N` is at least [`Framing::LONGEST`]: 60 bytes for postcard, 280
/// for MAVLink. A beacon takes some 50, so 1024 bytes hold the beacons of twenty robots.
#[derive(Clone, Debug)]
pub struct Receiver<F, const N: usize> {
    /// Whole frames, then the incoming bytes.
    bytes: Vec<u8, N>,
    whole: usize,
    /// Length of the frames that the last step took.
    given: usize,
    /// Bytes up to the next delimiter are unusable.
    is_skipping: bool,
    counts: Counts,
    framing: PhantomData<F>,
}

impl<F: Framing, const N: usize> Receiver<F, N> {
    const FITS: () = assert!(N >= F::LONGEST, "no room for one frame");

    /// Creates an empty receiver.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::FITS;
        Self { bytes: Vec::new(), whole: 0, given: 0, is_skipping: false, counts: Counts::NONE, framing: PhantomData }
    }

    /// Adds received bytes, in pieces of any length. O(bytes x [`Framing::LONGEST`] + `N`).
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
            let _ = self.bytes.extend_from_slice(piece);
            rest = later;
            self.sort();
        }
    }

    /// Adds a packet of a radio that has its own packets; the last delimiter may be missing. An
    /// incomplete frame before it is dropped.
    pub fn push_packet(&mut self, packet: &[u8]) {
        self.end();
        self.push(packet);
        self.end();
    }

    /// Reports that the line lost bytes (an overrun, a framing error): drops the incomplete frame.
    pub fn line_error(&mut self) {
        count(&mut self.counts.line_errors, 1);
        self.cut_short();
    }

    /// The frames received since the last call, for [`Inputs`](staya_controller::agent::Inputs).
    pub fn take(&mut self) -> &[u8] {
        self.forget_given();
        self.given = self.whole;
        self.bytes.get(..self.whole).unwrap_or_default()
    }

    /// The counts so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn end(&mut self) {
        match F::DELIMITER {
            Some(delimiter) => self.push(&[delimiter]),
            None => self.cut_short(),
        }
    }

    /// Skips to its delimiter if the format has one.
    fn cut_short(&mut self) {
        let is_begun = self.bytes.len() > self.whole;
        self.bytes.truncate(self.whole);
        if F::DELIMITER.is_some() {
            self.is_skipping = true;
        } else if is_begun {
            count(&mut self.counts.refused, 1);
        }
    }

    fn forget_given(&mut self) {
        let given = core::mem::take(&mut self.given);
        if given > 0 {
            remove(&mut self.bytes, 0, given);
            self.whole = self.whole.saturating_sub(given);
        }
    }

    /// The incoming frame is never longer than the longest frame.
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
