//! Distinguishes fresh authenticated frames from replayed ones: the sliding window of IPsec (RFC
//! 4303, section 3.4.3) per sender, on counters that never wrap or restart.

use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The class of a frame, given earlier frames of its sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Freshness {
    /// Newer than all frames before, or the first of its sender.
    New,
    /// Not received before, but later than a newer frame.
    Late,
    /// Received before, or so old that the guard no longer knows.
    Replayed,
    /// From an unknown sender while the table is full.
    NoRoom,
}

impl Freshness {
    /// Whether the frame was never accepted before.
    #[must_use]
    pub const fn is_fresh(self) -> bool {
        matches!(self, Self::New | Self::Late)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Peer {
    newest: u64,
    /// Bit k: the frame `newest - k` was received.
    seen: u32,
    sender: u32,
}

/// The newest counters of up to `N` senders; 16 bytes each.
///
/// Pass only authenticated frames, so that an attacker without the key cannot fill the table. No
/// sender is evicted, since its frames could then be replayed: a full table refuses further senders
/// ([`Freshness::NoRoom`]), so `N` must be at least the number of robots that have the key.
///
/// # Restart of the receiver
///
/// By default no state survives. An attacker can then replay a whole recording in order until the
/// true sender is received. To close this gap, store [`Self::export`] in persistent memory, from
/// time to time or at power-off, and restore it with [`Self::import`]; or raise [`Self::set_floor`]
/// above the counters recorded on earlier days.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ReplayGuard<const N: usize> {
    peers: Vec<Peer, N>,
    /// The least counter accepted from unknown senders.
    floor: u64,
}

impl<const N: usize> ReplayGuard<N> {
    /// Creates a guard without known senders.
    #[must_use]
    pub const fn new() -> Self {
        Self { peers: Vec::new(), floor: 0 }
    }

    /// Classifies an authenticated frame and records it. O(log N), for a new sender O(N).
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

    /// Each known sender with its newest counter, in the order of senders, to be stored.
    pub fn export(&self) -> impl Iterator<Item = (u32, u64)> + '_ {
        self.peers.iter().map(|peer| (peer.sender, peer.newest))
    }

    /// Restores an entry of [`Self::export`]: frames up to `counter` are not fresh. False without
    /// room.
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

    /// Refuses frames of unknown senders with a smaller counter.
    pub const fn set_floor(&mut self, floor: u64) {
        self.floor = floor;
    }

    /// The value of [`Self::set_floor`]; initially 0.
    #[must_use]
    pub const fn floor(&self) -> u64 {
        self.floor
    }

    /// A sender's newest counter, accepted or imported; `None` for an unknown sender. O(log N).
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
