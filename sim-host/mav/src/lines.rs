use super::endpoint::Endpoint;
use super::inbox::{Inbox, Peer, Received};
use super::traffic::{Counts, Outgoing, Shared};
use super::{stream, udp};
use anyhow::{Result, anyhow};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;

struct Line {
    outgoing: Box<dyn Outgoing>,
    shared: Shared,
    thread: Option<JoinHandle<()>>,
}

/// Open links with one queue of received frames. Sending never waits: frames that cannot be sent
/// are lost and counted, as on a radio. Dropping closes the links.
///
/// A peer of a listening link is unknown until [`Self::believe`]: it receives no datagrams, and its
/// connection is the first to be closed. Every known peer has its own queue, served in turn.
pub struct Lines {
    lines: Vec<Line>,
    inbox: Arc<Inbox>,
}

impl Lines {
    /// Opens the links. A link is identified by its index in `endpoints`.
    ///
    /// # Errors
    /// The first link that cannot be opened. An absent peer is not an error.
    pub fn open(endpoints: &[Endpoint]) -> Result<Self> {
        let inbox = Arc::<Inbox>::default();
        let mut lines = Self { lines: Vec::new(), inbox: Arc::clone(&inbox) };
        for (line, endpoint) in endpoints.iter().enumerate() {
            let shared = Shared { line, inbox: Arc::clone(&inbox), tally: Arc::default(), closed: Arc::default() };
            let opened = match endpoint {
                Endpoint::UdpOut(address) => udp::open_out(*address, &shared),
                Endpoint::UdpIn(address) => udp::open_in(*address, &shared),
                Endpoint::TcpOut(address) => stream::connect(*address, &shared),
                Endpoint::TcpIn(address) => stream::listen(*address, &shared),
                Endpoint::Serial(port) => stream::serial(port, &shared),
            };
            let (outgoing, thread) = opened.map_err(|error| {
                anyhow!(
                    "cannot open {endpoint}: {error}; give another address or port, or end the program that uses it"
                )
            })?;
            lines.lines.push(Line { outgoing, shared, thread: Some(thread) });
        }
        Ok(lines)
    }

    /// Local address of link `line`; `None` for a serial port.
    pub fn local(&self, line: usize) -> Option<SocketAddr> {
        self.lines[line].outgoing.local()
    }

    /// Sends a frame to all peers of all links.
    pub fn send_all(&self, frame: &[u8]) {
        self.lines.iter().for_each(|line| line.outgoing.send(None, frame));
    }

    /// Sends a frame to one peer of a link, or to all.
    pub fn send(&self, line: usize, peer: Option<Peer>, frame: &[u8]) {
        self.lines[line].outgoing.send(peer, frame);
    }

    /// Marks a peer as known after a valid (with a key, authentic) frame; a silent peer expires.
    pub fn believe(&self, line: usize, peer: Peer) {
        self.lines[line].outgoing.believe(peer);
    }

    /// The next received frame of any link, or `None` after the timeout. Peers are served in turn.
    pub fn receive(&self, timeout: Duration) -> Option<Received> {
        self.inbox.next(timeout)
    }

    /// Charges the sender of the last received frame for its answers. Above 1000 per second (and
    /// 1000 at once) it is not served for a while, and its queue may fill up.
    pub fn charge(&self, answers: usize) {
        self.inbox.charge(answers);
    }

    /// Traffic counters of link `line`.
    pub fn counts(&self, line: usize) -> Counts {
        self.lines[line].shared.tally.counts()
    }

    /// Why the last connection attempt of link `line` failed; `None` without a failure.
    pub fn trouble(&self, line: usize) -> Option<String> {
        self.lines[line].shared.tally.trouble()
    }

    /// Closes all links. Frames already received remain available.
    pub fn close(&mut self) {
        for line in &self.lines {
            line.shared.closed.store(true, Ordering::Relaxed);
        }
        for thread in self.lines.iter_mut().filter_map(|line| line.thread.take()) {
            let _ = thread.join();
        }
    }

    /// Number of queued frames.
    pub fn waiting(&self) -> u64 {
        self.inbox.len()
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.close();
    }
}

#[cfg(test)]
mod tests;
