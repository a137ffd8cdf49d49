//! Which authenticated frames are fresh, and which somebody recorded and sends again.
//!
//! The sliding window of IPsec (RFC 4303, section 3.4.3) per sender, over counters that never wrap and never start anew.

use heapless::Vec;
use serde::{Deserialize, Serialize};

/// How a frame stands to those of the same sender before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Freshness {
    /// Newer than everything before, or the sender's first one.
    New,
    /// Not seen before, but a newer one came first.
    Late,
    /// Seen before, or so old that this is forgotten.
    Replayed,
    /// From a sender that is not known and for whom there is no room.
    NoRoom,
}

impl Freshness {
    /// Whether the frame was never accepted before.
    #[must_use]
    pub const fn is_fresh(self) -> bool {
        matches!(self, Self::New | Self::Late)
    }
}

/// What is remembered of one sender; 16 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Peer {
    newest: u64,
    /// Bit k: the frame `newest - k` was seen.
    seen: u32,
    sender: u32,
}

/// The newest counters of up to `N` senders; 16 bytes each.
///
/// Only authenticated frames may come here, so that nobody without the key can fill it. A sender is never forgotten by
/// itself: who is forgotten can be replayed. When all `N` are taken, frames of further senders are refused
/// ([`Freshness::NoRoom`]), so `N` is at least the number of robots that have the key.
///
/// # What survives a restart of the receiver
///
/// Nothing by itself. Then each sender's first frame is believed, also a recorded one, and an attacker can replay a
/// whole recording in order, from the restart until the true sender is heard: every frame of it that is older is refused from then on. Who
/// wants to close this gap stores [`Self::export`] in lasting memory, from time to time or when the power goes, and gives it back with
/// [`Self::import`]; or raises [`Self::set_floor`] above what was recorded on earlier days.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ReplayGuard<const N: usize> {
    /// By sender, rising.
    peers: Vec<Peer, N>,
    /// Unknown senders begin here or later.
    floor: u64,
}

impl<const N: usize> ReplayGuard<N> {
    /// One that knows nobody.
    #[must_use]
    pub const fn new() -> Self {
        Self { peers: Vec::new(), floor: 0 }
    }

    /// Judges an authenticated frame and remembers it. O(log N), for a new sender O(N).
    pub fn admit(&mut self, sender: u32, counter: u64) -> Freshness {
        let at = match self.find(sender) {
            Ok(at) => at,
            Err(_) if counter < self.floor => return Freshness::Replayed,
            Err(_) => return self.insert(sender, counter, 1),
        };
        let Some(peer) = self.peers.get_mut(at) else {
            return Freshness::NoRoom;
        };
        if let Some(ahead) = counter.checked_sub(peer.newest).filter(|ahead| *ahead > 0) {
            let ahead = u32::try_from(ahead).unwrap_or(u32::MAX);
            peer.seen = peer.seen.checked_shl(ahead).unwrap_or(0) | 1;
            peer.newest = counter;
            return Freshness::New;
        }
        let behind = u32::try_from(peer.newest.saturating_sub(counter)).unwrap_or(u32::MAX);
        match 1_u32.checked_shl(behind) {
            Some(bit) if peer.seen & bit == 0 => {
                peer.seen |= bit;
                Freshness::Late
            }
            _ => Freshness::Replayed,
        }
    }

    /// Each known sender with its newest counter, by sender: what to store.
    pub fn export(&self) -> impl Iterator<Item = (u32, u64)> + '_ {
        self.peers.iter().map(|peer| (peer.sender, peer.newest))
    }

    /// Takes back what [`Self::export`] gave: nothing of `sender` up to `counter` is fresh any more. Returns whether there was room.
    pub fn import(&mut self, sender: u32, counter: u64) -> bool {
        match self.find(sender) {
            Err(_) => self.insert(sender, counter, u32::MAX).is_fresh(),
            Ok(at) => {
                if let Some(peer) = self.peers.get_mut(at)
                    && peer.newest <= counter
                {
                    (peer.newest, peer.seen) = (counter, u32::MAX);
                }
                true
            }
        }
    }

    /// Refuses frames of unknown senders whose counter is smaller.
    pub const fn set_floor(&mut self, floor: u64) {
        self.floor = floor;
    }

    /// What [`Self::set_floor`] set; 0 before.
    #[must_use]
    pub const fn floor(&self) -> u64 {
        self.floor
    }

    /// A sender's newest counter, accepted or imported; `None` for one who is not known. O(log N).
    #[must_use]
    pub fn newest(&self, sender: u32) -> Option<u64> {
        let at = self.find(sender).ok()?;
        Some(self.peers.get(at)?.newest)
    }

    /// Whether frames of this sender were accepted or imported.
    #[must_use]
    pub fn knows(&self, sender: u32) -> bool {
        self.find(sender).is_ok()
    }

    fn find(&self, sender: u32) -> Result<usize, usize> {
        self.peers.binary_search_by_key(&sender, |peer| peer.sender)
    }

    fn insert(&mut self, sender: u32, newest: u64, seen: u32) -> Freshness {
        let peer = Peer { newest, seen, sender };
        if self.peers.push(peer).is_err() {
            return Freshness::NoRoom;
        }
        crate::list::sink_last(&mut self.peers, |before, after| before.sender > after.sender);
        Freshness::New
    }
}

const _: () = assert!(size_of::<Peer>() == 16);
