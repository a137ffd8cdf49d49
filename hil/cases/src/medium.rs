//! The radio medium between the robots of a case: what one said in a tick all others hear in the next, or what is left
//! of it.

use heapless::Vec;
use staya_controller::rand::Rng;
use staya_controller::wire::Wire;

/// Bytes of one robot that are kept for the next tick: its beacon and some requests. What does not fit is not sent.
const SAID: usize = 144;
/// Bytes that one robot hears in a tick.
pub(crate) const INBOX: usize = 576;
/// Keeps the draws of this module apart from others.
const PURPOSE: u32 = u32::from_be_bytes(*b"cair");

/// What becomes of a frame on its way: probabilities as Q0.32.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Faults {
    pub(crate) seed: u64,
    /// It does not arrive.
    pub(crate) loss: u32,
    /// One of its bits is wrong.
    pub(crate) flip: u32,
    /// It arrives twice.
    pub(crate) twice: u32,
}

/// The medium that `R` senders share: what they said in the last tick, in wire format `W`.
pub(crate) struct Medium<W, const R: usize> {
    /// Tells frames apart.
    wire: W,
    said: [Vec<u8, SAID>; R],
    next: [Vec<u8, SAID>; R],
    faults: Faults,
}

impl<W: Wire, const R: usize> Medium<W, R> {
    #[inline(never)] // Made where it stays, not beside it first.
    pub(crate) const fn new(wire: W, faults: Faults) -> Self {
        Self { wire, said: [const { Vec::new() }; R], next: [const { Vec::new() }; R], faults }
    }

    /// Takes what `sender` says in this tick, frame by frame as long as there is room.
    pub(crate) fn send(&mut self, sender: usize, bytes: &[u8]) {
        if let Some(said) = self.next.get_mut(sender) {
            let mut rest = bytes;
            while let Some((_, packet)) = next_packet(&self.wire, &mut rest) {
                push_packet(said, packet);
            }
        }
    }

    /// The tick is over: what was said in it can be heard.
    pub(crate) fn turn(&mut self) {
        core::mem::swap(&mut self.said, &mut self.next);
        for said in &mut self.next {
            said.clear();
        }
    }

    /// What arrives at `receiver` in tick `tick`, in the order of the senders.
    pub(crate) fn hear(&self, receiver: usize, tick: u32, inbox: &mut Vec<u8, INBOX>) {
        inbox.clear();
        for (sender, said) in self.said.iter().enumerate() {
            if sender == receiver {
                continue;
            }
            let way = ((sender << 8) | receiver) as u32;
            let mut rng = Rng::keyed(self.faults.seed, PURPOSE, way, tick);
            let mut rest = said.as_slice();
            while let Some((len, packet)) = next_packet(&self.wire, &mut rest) {
                self.carry(len, packet, &mut rng, inbox);
            }
        }
    }

    /// Each packet, a frame of `len` bytes, draws as often as any other, so that the fate of one does not change the
    /// next one's.
    fn carry(&self, len: usize, packet: &[u8], rng: &mut Rng, inbox: &mut Vec<u8, INBOX>) {
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

/// Takes the next frame off `rest`: its length, and its bytes with its delimiter if the format has one.
fn next_packet<'a>(wire: &impl Wire, rest: &mut &'a [u8]) -> Option<(usize, &'a [u8])> {
    let before = *rest;
    let len = wire.next_frame(rest)?.len();
    let packet = before.get(..before.len().saturating_sub(rest.len()))?;
    Some((len, packet))
}

/// Appends a packet if it fits; whether it did.
fn push_packet<const N: usize>(bytes: &mut Vec<u8, N>, packet: &[u8]) -> bool {
    bytes.extend_from_slice(packet).is_ok()
}
