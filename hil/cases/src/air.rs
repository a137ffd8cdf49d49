//! The radio between the robots of a case: what one said in a tick all others hear in the next, or what is left of it.

use heapless::Vec;
use staya_controller::rand::Rng;
use staya_controller::wire::frames;

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

/// What `R` senders said in the last tick.
pub(crate) struct Air<const R: usize> {
    said: [Vec<u8, SAID>; R],
    next: [Vec<u8, SAID>; R],
    faults: Faults,
}

impl<const R: usize> Air<R> {
    pub(crate) const fn new(faults: Faults) -> Self {
        Self {
            said: [const { Vec::new() }; R],
            next: [const { Vec::new() }; R],
            faults,
        }
    }

    /// Takes what `sender` says in this tick, frame by frame as long as there is room.
    pub(crate) fn send(&mut self, sender: usize, bytes: &[u8]) {
        if let Some(said) = self.next.get_mut(sender) {
            for frame in frames(bytes) {
                push_frame(said, frame);
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
            for frame in frames(said) {
                self.carry(frame, &mut rng, inbox);
            }
        }
    }

    /// Each frame draws as often as any other, so that the fate of one does not change the next one's.
    fn carry(&self, frame: &[u8], rng: &mut Rng, inbox: &mut Vec<u8, INBOX>) {
        let Faults {
            loss, flip, twice, ..
        } = self.faults;
        let (is_lost, is_wrong) = (rng.chance_q32(loss), rng.chance_q32(flip));
        let (comes_twice, place) = (rng.chance_q32(twice), rng.below(8 * frame.len() as u32));
        if is_lost {
            return;
        }
        let start = inbox.len();
        if push_frame(inbox, frame) && is_wrong {
            let byte = start.saturating_add((place >> 3) as usize);
            if let Some(byte) = inbox.get_mut(byte) {
                *byte ^= 1 << (place & 7);
            }
        }
        if comes_twice {
            push_frame(inbox, frame);
        }
    }
}

/// Appends a frame and its delimiter if both fit; whether they did.
fn push_frame<const N: usize>(bytes: &mut Vec<u8, N>, frame: &[u8]) -> bool {
    if bytes.len().saturating_add(frame.len()) >= N {
        return false;
    }
    // There is room.
    bytes.extend_from_slice(frame).is_ok() && bytes.push(0).is_ok()
}
