use super::inbox::{Inbox, Peer, Received};
use staya_mavlink::frame::{Scan, scan};
use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

pub(super) const GLANCE: Duration = Duration::from_millis(50);

/// Traffic counters of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// Frames received.
    pub frames_in: u64,
    /// Bytes received.
    pub bytes_in: u64,
    /// Frames sent, counted once for each peer.
    pub frames_out: u64,
    /// Bytes sent.
    pub bytes_out: u64,
    /// Received bytes that belong to no frame.
    pub junk_bytes: u64,
    /// Received frames dropped because their peer's queue was full.
    pub lost_in: u64,
    /// Frames that could not be sent, because the peer is absent or reads too slowly.
    pub lost_out: u64,
}

#[derive(Debug, Default)]
pub(super) struct SharedCounts {
    frames_in: AtomicU64,
    bytes_in: AtomicU64,
    frames_out: AtomicU64,
    bytes_out: AtomicU64,
    junk_bytes: AtomicU64,
    lost_in: AtomicU64,
    lost_out: AtomicU64,
    trouble: Mutex<Option<String>>,
}

fn add(counter: &AtomicU64, n: usize) {
    counter.fetch_add(n as u64, Ordering::Relaxed);
}

impl SharedCounts {
    pub(super) fn counts(&self) -> Counts {
        let get = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counts {
            frames_in: get(&self.frames_in),
            bytes_in: get(&self.bytes_in),
            frames_out: get(&self.frames_out),
            bytes_out: get(&self.bytes_out),
            junk_bytes: get(&self.junk_bytes),
            lost_in: get(&self.lost_in),
            lost_out: get(&self.lost_out),
        }
    }

    pub(super) fn noting<T>(&self, tried: io::Result<T>) -> io::Result<T> {
        *self.trouble.lock().unwrap_or_else(PoisonError::into_inner) = tried.as_ref().err().map(ToString::to_string);
        tried
    }

    pub(super) fn trouble(&self) -> Option<String> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn sent(&self, frame: &[u8], is_sent: bool) {
        if is_sent {
            add(&self.frames_out, 1);
            add(&self.bytes_out, frame.len());
        } else {
            add(&self.lost_out, 1);
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Shared {
    pub(super) line: usize,
    pub(super) inbox: Arc<Inbox>,
    pub(super) tally: Arc<SharedCounts>,
    pub(super) closed: Arc<AtomicBool>,
}

impl Shared {
    pub(super) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    /// Queues the frames at the start of `bytes`, and returns the number of bytes used.
    pub(super) fn take(&self, peer: Peer, bytes: &[u8], is_whole: bool, is_known: bool) -> usize {
        let mut used = 0;
        loop {
            match scan(&bytes[used..], is_whole) {
                Scan::Frame { junk, frame } => {
                    add(&self.tally.junk_bytes, junk);
                    used += junk + frame.bytes().len();
                    self.hand_on(peer, frame.bytes(), is_known);
                }
                Scan::Nothing { junk } => {
                    add(&self.tally.junk_bytes, junk);
                    return used + junk;
                }
            }
        }
    }

    fn hand_on(&self, peer: Peer, frame: &[u8], is_known: bool) {
        add(&self.tally.frames_in, 1);
        add(&self.tally.bytes_in, frame.len());
        let received = Received { line: self.line, peer, frame: frame.to_vec() };
        if !self.inbox.put(received, is_known) {
            add(&self.tally.lost_in, 1);
        }
    }
}

pub(super) trait Outgoing: Send + Sync {
    fn send(&self, frame: &[u8]);
    fn send_to(&self, peer: Peer, frame: &[u8]);
    fn believe(&self, peer: Peer);
    /// `None` without a socket.
    fn local(&self) -> Option<SocketAddr>;
}
