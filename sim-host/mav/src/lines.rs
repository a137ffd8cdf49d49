//! Several lines, one queue of frames.

use super::endpoint::Endpoint;
use super::traffic::{Counts, Outgoing, Peer, Received, Shared};
use super::{stream, udp};
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Frames that wait for [`Lines::receive`] at most; more are lost and counted.
const INBOX: usize = 16_384;
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
        let mut lines = Self { lines: Vec::new(), inbox };
        for (line, endpoint) in endpoints.iter().enumerate() {
            let shared = Shared { line, inbox: sender.clone(), tally: Arc::default(), closed: Arc::default() };
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

impl Lines {
    /// Why line number `line` has no connection, when that was tried last; `None` for one that has, or needs none.
    #[must_use]
    pub fn trouble(&self, line: usize) -> Option<String> {
        self.lines.get(line).and_then(|line| line.shared.tally.trouble())
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
