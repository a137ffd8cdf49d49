//! Packets sent in one tick arrive at all other robots in the next, unless they are lost.

use heapless::Vec;
use staya_controller::rand::Rng;
use staya_controller::wire::Wire;

/// A beacon and some messages; further frames are dropped.
const SAID: usize = 120;
pub(crate) const INBOX: usize = 400;
const PURPOSE: u32 = u32::from_be_bytes(*b"cair");
const FADES: u32 = u32::from_be_bytes(*b"fade");
/// Ticks for which a link stays as it is: 2 s.
const FADE_TICKS: u32 = 20;

/// Probabilities per frame as Q0.32; `fade` is the share of time in which a link brings nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Faults {
    pub(crate) seed: u64,
    pub(crate) loss: u32,
    pub(crate) flip: u32,
    pub(crate) twice: u32,
    pub(crate) fade: u32,
}

/// Between `R` senders, with inboxes of `B` bytes.
pub(crate) struct Medium<W, const R: usize, const B: usize = INBOX> {
    wire: W,
    said: [Vec<u8, SAID>; R],
    next: [Vec<u8, SAID>; R],
    faults: Faults,
}

impl<W: Wire, const R: usize, const B: usize> Medium<W, R, B> {
    #[inline(never)] // Built in place to save stack.
    pub(crate) const fn new(wire: W, faults: Faults) -> Self {
        Self { wire, said: [const { Vec::new() }; R], next: [const { Vec::new() }; R], faults }
    }

    pub(crate) fn send(&mut self, sender: usize, bytes: &[u8]) {
        if let Some(said) = self.next.get_mut(sender) {
            let mut rest = bytes;
            while let Some((_, packet)) = next_packet(&self.wire, &mut rest) {
                push_packet(said, packet);
            }
        }
    }

    pub(crate) fn turn(&mut self) {
        core::mem::swap(&mut self.said, &mut self.next);
        for said in &mut self.next {
            said.clear();
        }
    }

    pub(crate) fn hear(&self, receiver: usize, tick: u32, inbox: &mut Vec<u8, B>) {
        inbox.clear();
        for (sender, said) in self.said.iter().enumerate() {
            if sender == receiver {
                continue;
            }
            let way = ((sender << 8) | receiver) as u32;
            if self.faults.fade > 0
                && Rng::keyed(self.faults.seed, FADES, way, tick / FADE_TICKS).chance_q32(self.faults.fade)
            {
                continue;
            }
            let mut rng = Rng::keyed(self.faults.seed, PURPOSE, way, tick);
            let mut rest = said.as_slice();
            while let Some((len, packet)) = next_packet(&self.wire, &mut rest) {
                self.carry(len, packet, &mut rng, inbox);
            }
        }
    }

    /// Each packet draws equally many random numbers, so that its fate does not affect the next.
    fn carry(&self, len: usize, packet: &[u8], rng: &mut Rng, inbox: &mut Vec<u8, B>) {
        let Faults { loss, flip, twice, .. } = self.faults;
        let (is_lost, is_wrong) = (rng.chance_q32(loss), rng.chance_q32(flip));
        let (comes_twice, place) = (rng.chance_q32(twice), rng.below(8 * len as u32));
        if is_lost {
            return;
        }
        let start = inbox.len();
        if push_packet(inbox, packet) && is_wrong {
            let byte = start.saturating_add((place >> 3) as usize);
            if let Some(byte) = inbox.get_mut(byte) {
                *byte ^= 1 << (place & 7);
            }
        }
        if comes_twice {
            push_packet(inbox, packet);
        }
    }
}

fn next_packet<'a>(wire: &impl Wire, rest: &mut &'a [u8]) -> Option<(usize, &'a [u8])> {
    let before = *rest;
    let len = wire.next_frame(rest)?.len();
    let packet = before.get(..before.len().saturating_sub(rest.len()))?;
    Some((len, packet))
}

fn push_packet<const N: usize>(bytes: &mut Vec<u8, N>, packet: &[u8]) -> bool {
    bytes.extend_from_slice(packet).is_ok()
}
