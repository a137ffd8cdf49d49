//! What goes over a line, whatever its kind: who is at the other end, frames that come in, counts of both ways.

use super::inbox::{Inbox, Peer, Received};
use staya_mavlink::frame::{Scan, scan};
use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often those who wait look whether they are still wanted.
pub(super) const GLANCE: Duration = Duration::from_millis(50);

/// What a line has carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// Frames that came in, and their bytes.
    pub frames_in: u64,
    /// See there.
    pub bytes_in: u64,
    /// Frames that went out, once for each peer, and their bytes.
    pub frames_out: u64,
    /// See there.
    pub bytes_out: u64,
    /// Bytes that came in and belong to no frame.
    pub junk_bytes: u64,
    /// Frames that came in and found their peer's queue full.
    pub lost_in: u64,
    /// Frames that could not be sent: the other side is not there, or reads too slowly.
    pub lost_out: u64,
}

/// A [`Counts`] that threads share.
#[derive(Debug, Default)]
pub(super) struct SharedCounts {
    frames_in: AtomicU64,
    bytes_in: AtomicU64,
    frames_out: AtomicU64,
    bytes_out: AtomicU64,
    junk_bytes: AtomicU64,
    lost_in: AtomicU64,
    lost_out: AtomicU64,
    /// Why there was no connection when it was tried last.
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

    /// Keeps why a connection cannot be had, until there is one.
    pub(super) fn noting<T>(&self, tried: io::Result<T>) -> io::Result<T> {
        *self.trouble.lock().unwrap_or_else(PoisonError::into_inner) = tried.as_ref().err().map(ToString::to_string);
        tried
    }

    /// See [`Self::noting`].
    pub(super) fn trouble(&self) -> Option<String> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// A frame was handed to the system, or not.
    pub(super) fn sent(&self, frame: &[u8], is_sent: bool) {
        if is_sent {
            add(&self.frames_out, 1);
            add(&self.bytes_out, frame.len());
        } else {
            add(&self.lost_out, 1);
        }
    }
}

/// What the threads of a line share with it.
#[derive(Clone, Debug)]
pub(super) struct Shared {
    pub(super) line: usize,
    pub(super) inbox: Arc<Inbox>,
    pub(super) tally: Arc<SharedCounts>,
    pub(super) closed: Arc<AtomicBool>,
}

impl Shared {
    /// Whether the line is being closed.
    pub(super) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    /// Takes frames off the front of `bytes` and hands them on; returns how many bytes are used up. `is_whole` as for [`scan`]; who is not
    /// known shares a queue with all other strangers of the line.
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

/// What a kind of line does with frames to send.
pub(super) trait Outgoing: Send + Sync {
    /// To all who are there.
    fn send(&self, frame: &[u8]);
    /// To one of them.
    fn send_to(&self, peer: Peer, frame: &[u8]);
    /// A frame of this one was sound, and with a key authentic.
    fn believe(&self, peer: Peer);
    /// Where it listens, or is sent from; `None` for what is no socket.
    fn local(&self) -> Option<SocketAddr>;
}
