//! Several lines, one queue of frames.

use super::endpoint::Endpoint;
use super::inbox::{Inbox, Peer, Received};
use super::traffic::{Counts, Outgoing, Shared};
use super::{stream, udp};
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;

/// Why there is no line.
#[derive(Debug, thiserror::Error)]
#[error("cannot open {endpoint}: {source}")]
pub struct OpenError {
    /// Which one.
    pub endpoint: Endpoint,
    /// Why.
    pub source: io::Error,
}

struct Line {
    endpoint: Endpoint,
    outgoing: Box<dyn Outgoing>,
    shared: Shared,
    threads: Vec<JoinHandle<()>>,
}

/// Open lines. Nothing here waits for a slow or absent peer: what cannot be sent is lost and counted, as on a radio. Closed when dropped.
///
/// Who calls a line that listens is nobody until its owner says [`Self::believe`]: a datagram's sender is not told anything before, and one at a
/// connection is the first to go when there are too many. Each peer that is believed has a queue of its own, and all are served in turn.
pub struct Lines {
    lines: Vec<Line>,
    inbox: Arc<Inbox>,
}

impl Lines {
    /// Opens lines; each is known by its place in `endpoints`.
    ///
    /// # Errors
    /// The first one that cannot be opened. An absent peer is no error.
    pub fn open(endpoints: &[Endpoint]) -> Result<Self, OpenError> {
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
            let endpoint = endpoint.clone();
            let (outgoing, threads) = match opened {
                Ok(opened) => opened,
                Err(source) => return Err(OpenError { endpoint, source }),
            };
            lines.lines.push(Line { endpoint, outgoing, shared, threads });
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

    /// Says that a frame of this peer was sound, and with a key authentic: from now on, and as long as more of them come, it is one of those whom
    /// [`Self::send`] reaches.
    pub fn believe(&self, line: usize, peer: Peer) {
        if let Some(line) = self.lines.get(line) {
            line.outgoing.believe(peer);
        }
    }

    /// The next frame that came in over any line, each peer in turn; `None` when there is none for so long.
    #[must_use]
    pub fn receive(&self, timeout: Duration) -> Option<Received> {
        self.inbox.next(timeout)
    }

    /// Says how many messages the last frame of [`Self::receive`] was answered with. Whoever has had a thousand more than a thousand a second is not
    /// served until they are made up for; its frames wait, and are lost when its queue is full.
    pub fn charge(&self, answers: usize) {
        self.inbox.charge(answers);
    }

    /// What line number `line` has carried.
    #[must_use]
    pub fn counts(&self, line: usize) -> Counts {
        let line = self.lines.get(line);
        line.map_or_else(Counts::default, |line| line.shared.tally.counts())
    }
}

impl Lines {
    /// Why line number `line` has no connection, when that was tried last; `None` for one that has, or needs none.
    #[must_use]
    pub fn trouble(&self, line: usize) -> Option<String> {
        self.lines.get(line).and_then(|line| line.shared.tally.trouble())
    }
}

impl Lines {
    /// Ends all lines; nothing comes in any more, and what waits can still be received and counted.
    pub fn close(&mut self) {
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

    /// Frames that have come in and were not received yet.
    #[must_use]
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
