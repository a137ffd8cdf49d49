//! The bytes of one peer as a stream of frames, whatever carries them. A serial-to-UDP bridge cuts
//! its stream anywhere, so a frame may begin in one datagram and end in the next one.

use staya_mavlink::frame::{RawFrame, Scan, scan};
use std::time::{Duration, Instant};

/// Longest wait for the rest of a frame. The longest frame takes 0.3 s at 9600 baud.
const PATIENCE: Duration = Duration::from_secs(1);

/// Received bytes that wait for the rest of their frame: fewer than one frame.
#[derive(Debug, Default)]
pub(super) struct Reassembly {
    bytes: Vec<u8>,
    /// Time at which the first of them became the first one.
    since: Option<Instant>,
}

impl Reassembly {
    /// Passes each frame that is complete to `each`, and returns the number of bytes that belong to
    /// no frame. Bounded work: that of [`scan`].
    ///
    /// A datagram that begins with a frame shows that the rest of an earlier one was lost.
    pub(super) fn push(&mut self, bytes: &[u8], is_datagram: bool, now: Instant, each: &mut impl FnMut(&[u8])) -> u64 {
        let mut junk = self.expire(now, each);
        let border = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        let (mut used, begun) = self.scan(0, each);
        junk += begun;
        let is_cut_off = is_datagram && used < border && begins_frame(&self.bytes[border..]);
        if is_cut_off {
            junk += (border - used) as u64;
            let (end, skipped) = self.scan(border, each);
            (used, junk) = (end, junk + skipped);
        }
        self.keep(used, now);
        junk
    }

    /// Gives up frames whose rest is overdue. Returns the number of bytes that belong to no frame.
    pub(super) fn expire(&mut self, now: Instant, each: &mut impl FnMut(&[u8])) -> u64 {
        if self.since.is_none_or(|since| now.saturating_duration_since(since) < PATIENCE) {
            return 0;
        }
        // A message outside the dialect ends with the bytes.
        if RawFrame::new(&self.bytes).is_some() {
            each(&self.bytes);
            self.keep(self.bytes.len(), now);
            return 0;
        }
        // The first byte begins no frame, but a frame may begin behind it.
        let (used, junk) = self.scan(1, each);
        self.keep(used, now);
        junk + 1
    }

    /// Number of bytes that wait for the rest of their frame.
    pub(super) fn waiting(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// Time at which the first waiting byte arrived; `None` without one.
    pub(super) const fn since(&self) -> Option<Instant> {
        self.since
    }

    /// Returns where the bytes begin that are still incomplete, and the number of junk bytes.
    fn scan(&self, from: usize, each: &mut impl FnMut(&[u8])) -> (usize, u64) {
        let (mut used, mut all_junk) = (from, 0);
        loop {
            match scan(&self.bytes[used..], false) {
                Scan::Frame { junk, frame } => {
                    all_junk += junk as u64;
                    used += junk + frame.bytes().len();
                    each(frame.bytes());
                }
                Scan::Nothing { junk } => return (used + junk, all_junk + junk as u64),
            }
        }
    }

    fn keep(&mut self, used: usize, now: Instant) {
        self.bytes.drain(..used);
        self.since = match (self.bytes.is_empty(), used) {
            (true, _) => None,
            (false, 0) => self.since.or(Some(now)),
            (false, _) => Some(now),
        };
    }
}

/// Whether a frame with a verified checksum begins here.
fn begins_frame(bytes: &[u8]) -> bool {
    matches!(scan(bytes, true), Scan::Frame { junk: 0, frame } if frame.is_known())
}

#[cfg(test)]
mod tests;
