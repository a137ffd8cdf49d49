//! Several lines, one queue of frames.

use super::endpoint::Endpoint;
use super::{stream, udp};
use staya_mavlink::frame::{Scan, scan};
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Frames that wait for [`Lines::receive`] at most; more are lost and counted.
const INBOX: usize = 16_384;
/// How often those who wait look whether they are still wanted.
pub(super) const GLANCE: Duration = Duration::from_millis(50);

/// Why there is no line.
#[derive(Debug, thiserror::Error)]
#[error("cannot open {endpoint}: {source}")]
pub struct OpenError {
    /// Which one.
    pub endpoint: Endpoint,
    /// Why.
    pub source: io::Error,
}

/// Somebody at the other end of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Peer {
    /// Of a socket.
    Address(SocketAddr),
    /// Of a serial port.
    Wire,
}

/// A frame that came in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Over which line, by its number in [`Lines::open`].
    pub line: usize,
    /// From whom.
    pub peer: Peer,
    /// One whole frame: see [`staya_mavlink::frame::RawFrame`].
    pub frame: Vec<u8>,
}

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
    /// Frames that came in and found the queue full.
    pub lost_in: u64,
    /// Frames that could not be sent: the other side is not there, or reads too slowly.
    pub lost_out: u64,
}

/// A [`Counts`] that threads share.
#[derive(Debug, Default)]
pub(super) struct Tally {
    frames_in: AtomicU64,
    bytes_in: AtomicU64,
    frames_out: AtomicU64,
    bytes_out: AtomicU64,
    junk_bytes: AtomicU64,
    lost_in: AtomicU64,
    lost_out: AtomicU64,
}

fn add(counter: &AtomicU64, n: usize) {
    counter.fetch_add(n as u64, Ordering::Relaxed);
}

impl Tally {
    fn counts(&self) -> Counts {
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
    line: usize,
    inbox: SyncSender<Received>,
    pub(super) tally: Arc<Tally>,
    closed: Arc<AtomicBool>,
}

impl Shared {
    /// Whether the line is being closed.
    pub(super) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    /// Takes frames off the front of `bytes` and hands them on; returns how many bytes are used up. `is_whole` as for [`scan`].
    pub(super) fn take(&self, peer: Peer, bytes: &[u8], is_whole: bool) -> usize {
        let mut used = 0;
        loop {
            match scan(&bytes[used..], is_whole) {
                Scan::Frame { junk, frame } => {
                    add(&self.tally.junk_bytes, junk);
                    used += junk + frame.bytes().len();
                    self.hand_on(peer, frame.bytes());
                }
                Scan::Nothing { junk } => {
                    add(&self.tally.junk_bytes, junk);
                    return used + junk;
                }
            }
        }
    }

    fn hand_on(&self, peer: Peer, frame: &[u8]) {
        add(&self.tally.frames_in, 1);
        add(&self.tally.bytes_in, frame.len());
        let received = Received {
            line: self.line,
            peer,
            frame: frame.to_vec(),
        };
        if let Err(TrySendError::Full(_)) = self.inbox.try_send(received) {
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
    /// Where it listens, or is sent from; `None` for what is no socket.
    fn local(&self) -> Option<SocketAddr>;
}

struct Line {
    endpoint: Endpoint,
    outgoing: Box<dyn Outgoing>,
    shared: Shared,
    threads: Vec<JoinHandle<()>>,
}

/// Open lines. Nothing here waits for a slow or absent peer: what cannot be sent is lost and counted, as on a radio. Closed when dropped.
pub struct Lines {
    lines: Vec<Line>,
    inbox: Receiver<Received>,
}

impl Lines {
    /// Opens lines; each is known by its place in `endpoints`.
    ///
    /// # Errors
    /// The first one that cannot be opened. An absent peer is no error.
    pub fn open(endpoints: &[Endpoint]) -> Result<Self, OpenError> {
        let (sender, inbox) = sync_channel(INBOX);
        let mut lines = Self {
            lines: Vec::new(),
            inbox,
        };
        for (line, endpoint) in endpoints.iter().enumerate() {
            let shared = Shared {
                line,
                inbox: sender.clone(),
                tally: Arc::default(),
                closed: Arc::default(),
            };
            let opened = match endpoint {
                Endpoint::UdpOut(address) => udp::open_out(*address, &shared),
                Endpoint::UdpIn(address) => udp::open_in(*address, &shared),
                Endpoint::TcpOut(address) => Ok(stream::connect(*address, &shared)),
                Endpoint::TcpIn(address) => stream::listen(*address, &shared),
                Endpoint::Serial(port) => stream::serial(port, &shared),
            };
            let endpoint = endpoint.clone();
            let (outgoing, threads) = match opened {
                Ok(opened) => opened,
                Err(source) => return Err(OpenError { endpoint, source }),
            };
            lines.lines.push(Line {
                endpoint,
                outgoing,
                shared,
                threads,
            });
        }
        Ok(lines)
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// What line number `line` was opened as.
    #[must_use]
    pub fn endpoint(&self, line: usize) -> Option<&Endpoint> {
        self.lines.get(line).map(|line| &line.endpoint)
    }

    /// Where line number `line` listens, or is sent from; `None` for a serial port.
    #[must_use]
    pub fn local(&self, line: usize) -> Option<SocketAddr> {
        self.lines.get(line)?.outgoing.local()
    }

    /// Sends one frame to everybody on a line. A line that is not there sends nothing.
    pub fn send(&self, line: usize, frame: &[u8]) {
        if let Some(line) = self.lines.get(line) {
            line.outgoing.send(frame);
        }
    }

    /// Sends one frame to one peer of a line.
    pub fn send_to(&self, line: usize, peer: Peer, frame: &[u8]) {
        if let Some(line) = self.lines.get(line) {
            line.outgoing.send_to(peer, frame);
        }
    }

    /// The next frame that came in over any line, in order of arrival; `None` when there is none for so long.
    #[must_use]
    pub fn receive(&self, timeout: Duration) -> Option<Received> {
        match self.inbox.recv_timeout(timeout) {
            Ok(received) => Some(received),
            Err(RecvTimeoutError::Timeout) => None,
            // No line: nothing will come.
            Err(RecvTimeoutError::Disconnected) => {
                std::thread::sleep(timeout);
                None
            }
        }
    }

    /// What line number `line` has carried.
    #[must_use]
    pub fn counts(&self, line: usize) -> Counts {
        let line = self.lines.get(line);
        line.map_or_else(Counts::default, |line| line.shared.tally.counts())
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        for line in &self.lines {
            line.shared.closed.store(true, Ordering::Relaxed);
        }
        for line in &mut self.lines {
            for thread in line.threads.drain(..) {
                // One that panicked has nothing left to close.
                let _ = thread.join();
            }
        }
    }
}

#[cfg(test)]
mod tests;
