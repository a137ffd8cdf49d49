use super::inbox::{Inbox, Peer, Received};
use super::reassembly::Reassembly;
use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

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

/// Counters and state of a link, shared by its threads.
#[derive(Debug, Default)]
pub(super) struct Tally(Mutex<(Counts, Option<String>)>);

impl Tally {
    fn lock(&self) -> MutexGuard<'_, (Counts, Option<String>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn counts(&self) -> Counts {
        self.lock().0
    }

    /// Keeps the error of an attempt to connect, or forgets the last one.
    pub(super) fn noting<T>(&self, tried: io::Result<T>) -> io::Result<T> {
        self.lock().1 = tried.as_ref().err().map(ToString::to_string);
        tried
    }

    pub(super) fn trouble(&self) -> Option<String> {
        self.lock().1.clone()
    }

    pub(super) fn sent(&self, frame: &[u8], is_sent: bool) {
        let counts = &mut self.lock().0;
        if is_sent {
            counts.frames_out += 1;
            counts.bytes_out += frame.len() as u64;
        } else {
            counts.lost_out += 1;
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Shared {
    pub(super) line: usize,
    pub(super) inbox: Arc<Inbox>,
    pub(super) tally: Arc<Tally>,
    pub(super) closed: Arc<AtomicBool>,
}

impl Shared {
    pub(super) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    /// Queues the frames that `bytes` complete. Empty bytes only give up overdue ones.
    pub(super) fn take(&self, peer: Peer, stream: &mut Reassembly, bytes: &[u8], is_datagram: bool, is_known: bool) {
        let mut frames = Vec::new();
        let junk = stream.push(bytes, is_datagram, Instant::now(), &mut |frame: &[u8]| frames.push(frame.to_vec()));
        self.waste(junk);
        for frame in frames {
            let counts = &mut self.tally.lock().0;
            counts.frames_in += 1;
            counts.bytes_in += frame.len() as u64;
            let received = Received { line: self.line, peer, frame };
            counts.lost_in += u64::from(!self.inbox.put(received, is_known));
        }
    }

    /// Counts bytes that belong to no frame.
    pub(super) fn waste(&self, junk: u64) {
        self.tally.lock().0.junk_bytes += junk;
    }
}

/// The sending side of an open link, and its thread.
pub(super) type Opened = io::Result<(Box<dyn Outgoing>, JoinHandle<()>)>;

pub(super) fn start(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<JoinHandle<()>> {
    thread::Builder::new().name(name.to_owned()).spawn(work)
}

pub(super) trait Outgoing: Send + Sync {
    /// To one peer, or to all.
    fn send(&self, peer: Option<Peer>, frame: &[u8]);
    fn believe(&self, peer: Peer);
    /// `None` without a socket.
    fn local(&self) -> Option<SocketAddr>;
}
