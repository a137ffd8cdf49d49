//! Lines of datagrams.

use super::traffic::{GLANCE, Outgoing, Peer, Shared};
use std::collections::HashMap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Who was not heard for so long is not told any more.
const FORGET: Duration = Duration::from_secs(60);
/// Peers of a port that listens, at most; the one that was silent longest makes room.
const PEERS: usize = 64;

type Opened = io::Result<(Box<dyn Outgoing>, Vec<JoinHandle<()>>)>;
type Heard = Arc<Mutex<HashMap<SocketAddr, Instant>>>;

/// Datagrams to one address.
struct Out {
    socket: UdpSocket,
    to: SocketAddr,
    shared: Shared,
}

/// Datagrams to all who were heard.
struct In {
    socket: UdpSocket,
    heard: Heard,
    shared: Shared,
}

pub(super) fn open_out(to: SocketAddr, shared: &Shared) -> Opened {
    let any = if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
    // On this machine nobody else need reach the port.
    let local = match to {
        _ if !to.ip().is_loopback() => any,
        SocketAddr::V4(_) => "127.0.0.1:0",
        SocketAddr::V6(_) => "[::1]:0",
    };
    let socket = UdpSocket::bind(local)?;
    let reader = read(socket.try_clone()?, shared, move |from| from.ip() == to.ip())?;
    let shared = shared.clone();
    Ok((Box::new(Out { socket, to, shared }), vec![reader]))
}

pub(super) fn open_in(at: SocketAddr, shared: &Shared) -> Opened {
    let socket = UdpSocket::bind(at)?;
    let heard = Heard::default();
    let known = Arc::clone(&heard);
    let reader = read(socket.try_clone()?, shared, move |from| {
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= PEERS && !known.contains_key(&from) {
            let silent = known.iter().min_by_key(|(_, heard)| **heard);
            if let Some(silent) = silent.map(|(peer, _)| *peer) {
                known.remove(&silent);
            }
        }
        known.insert(from, Instant::now());
        true
    })?;
    let shared = shared.clone();
    let line = In { socket, heard, shared };
    Ok((Box::new(line), vec![reader]))
}

/// Reads datagrams from those who are welcome until the line is closed.
fn read(
    socket: UdpSocket,
    shared: &Shared,
    is_welcome: impl Fn(SocketAddr) -> bool + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    socket.set_read_timeout(Some(GLANCE))?;
    let shared = shared.clone();
    thread::Builder::new().name(String::from("udp")).spawn(move || {
        let mut buffer = vec![0; 65_536];
        while !shared.is_closed() {
            // Errors are those of datagrams that nobody took, or that none came: neither ends a line.
            if let Ok((len, from)) = socket.recv_from(&mut buffer)
                && is_welcome(from)
            {
                shared.take(Peer::Address(from), &buffer[..len], true);
            }
        }
    })
}

impl Out {
    fn to(&self, to: SocketAddr, frame: &[u8]) {
        let is_sent = self.socket.send_to(frame, to).is_ok();
        self.shared.tally.sent(frame, is_sent);
    }
}

impl Outgoing for Out {
    fn send(&self, frame: &[u8]) {
        self.to(self.to, frame);
    }

    fn send_to(&self, peer: Peer, frame: &[u8]) {
        if let Peer::Address(to) = peer {
            self.to(to, frame);
        }
    }

    fn local(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }
}

impl Outgoing for In {
    fn send(&self, frame: &[u8]) {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.retain(|_, heard| heard.elapsed() < FORGET);
        let peers: Vec<_> = heard.keys().copied().collect();
        drop(heard);
        for peer in peers {
            self.send_to(Peer::Address(peer), frame);
        }
    }

    fn send_to(&self, peer: Peer, frame: &[u8]) {
        if let Peer::Address(to) = peer {
            let is_sent = self.socket.send_to(frame, to).is_ok();
            self.shared.tally.sent(frame, is_sent);
        }
    }

    fn local(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }
}
