use super::inbox::Peer;
use super::reassembly::Reassembly;
use super::traffic::{GLANCE, Opened, Outgoing, Shared, start};
use socket2::SockRef;
use std::collections::HashMap;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Ground stations send at 1 Hz.
const FORGET: Duration = Duration::from_secs(20);
pub(super) const PEERS: usize = 16;
const YIELD: Duration = Duration::from_secs(5);
/// Senders with an incomplete frame; of more, the oldest one is dropped.
const INCOMPLETE: usize = 256;
/// The system may give less.
const KEPT: usize = 4 << 20;

#[derive(Clone, Default)]
struct Believed(Arc<Mutex<HashMap<SocketAddr, Instant>>>);

enum To {
    /// Fixed when the link opens.
    One(SocketAddr),
    Believed(Believed),
}

struct Udp {
    socket: UdpSocket,
    to: To,
    shared: Shared,
}

impl Believed {
    fn lock(&self) -> MutexGuard<'_, HashMap<SocketAddr, Instant>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn has(&self, peer: SocketAddr) -> bool {
        self.lock().contains_key(&peer)
    }

    fn note(&self, peer: SocketAddr, now: Instant) {
        let mut peers = self.lock();
        if peers.len() >= PEERS && !peers.contains_key(&peer) {
            let silent = peers.iter().min_by_key(|(_, heard)| **heard).map(|(peer, heard)| (*peer, *heard));
            match silent {
                Some((silent, heard)) if now.saturating_duration_since(heard) >= YIELD => drop(peers.remove(&silent)),
                _ => return,
            }
        }
        peers.insert(peer, now);
    }

    fn all(&self, now: Instant) -> Vec<SocketAddr> {
        let mut peers = self.lock();
        peers.retain(|_, heard| now.saturating_duration_since(*heard) < FORGET);
        peers.keys().copied().collect()
    }
}

pub(super) fn open_out(to: SocketAddr, shared: &Shared) -> Opened {
    let any = if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
    // For a peer on this computer the port need not be reachable from others.
    let local = match to {
        _ if !to.ip().is_loopback() => any,
        SocketAddr::V4(_) => "127.0.0.1:0",
        SocketAddr::V6(_) => "[::1]:0",
    };
    let socket = UdpSocket::bind(local)?;
    let reader = read(socket.try_clone()?, shared, move |from| (from.ip() == to.ip()).then_some(from == to))?;
    let shared = shared.clone();
    Ok((Box::new(Udp { socket, to: To::One(to), shared }), reader))
}

pub(super) fn open_in(at: SocketAddr, shared: &Shared) -> Opened {
    let socket = UdpSocket::bind(at)?;
    let believed = Believed::default();
    let known = believed.clone();
    let reader = read(socket.try_clone()?, shared, move |from| Some(known.has(from)))?;
    let shared = shared.clone();
    Ok((Box::new(Udp { socket, to: To::Believed(believed), shared }), reader))
}

/// `knows` returns whether a sender is known, or `None` to ignore it.
fn read(
    socket: UdpSocket,
    shared: &Shared,
    knows: impl Fn(SocketAddr) -> Option<bool> + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    socket.set_read_timeout(Some(GLANCE))?;
    let _ = SockRef::from(&socket).set_recv_buffer_size(KEPT);
    let shared = shared.clone();
    start("udp", move || {
        let (mut buffer, mut streams, mut next_look) = (vec![0; 65_536], Streams::default(), Instant::now());
        while !shared.is_closed() {
            // Errors report a timeout or an earlier datagram that was rejected; both are harmless.
            if let Ok((len, from)) = socket.recv_from(&mut buffer)
                && let Some(is_known) = knows(from)
            {
                streams.take(from, &buffer[..len], is_known, &shared);
            }
            let now = Instant::now();
            if now >= next_look {
                next_look = now + GLANCE;
                streams.expire(&knows, &shared);
            }
        }
        streams.end(&shared);
    })
}

/// The incomplete frames of senders.
#[derive(Default)]
struct Streams(HashMap<SocketAddr, Reassembly>);

impl Streams {
    fn take(&mut self, from: SocketAddr, bytes: &[u8], is_known: bool, shared: &Shared) {
        let mut stream = self.0.remove(&from).unwrap_or_default();
        shared.take(Peer::Address(from), &mut stream, bytes, true, is_known);
        if stream.waiting() == 0 {
            return;
        }
        if self.0.len() >= INCOMPLETE {
            let oldest = self.0.iter().min_by_key(|(_, stream)| stream.since()).map(|(from, _)| *from);
            let dropped = oldest.and_then(|oldest| self.0.remove(&oldest));
            shared.waste(dropped.map_or(0, |stream| stream.waiting()));
        }
        self.0.insert(from, stream);
    }

    fn expire(&mut self, knows: &impl Fn(SocketAddr) -> Option<bool>, shared: &Shared) {
        for (from, stream) in &mut self.0 {
            shared.take(Peer::Address(*from), stream, &[], true, knows(*from).unwrap_or(false));
        }
        self.0.retain(|_, stream| stream.waiting() > 0);
    }

    fn end(self, shared: &Shared) {
        shared.waste(self.0.values().map(Reassembly::waiting).sum());
    }
}

impl Udp {
    fn send_one(&self, to: SocketAddr, frame: &[u8]) {
        let is_sent = self.socket.send_to(frame, to).is_ok();
        self.shared.tally.sent(frame, is_sent);
    }
}

impl Outgoing for Udp {
    fn send(&self, peer: Option<Peer>, frame: &[u8]) {
        match (peer, &self.to) {
            (None, To::One(to)) => self.send_one(*to, frame),
            (None, To::Believed(peers)) => {
                peers.all(Instant::now()).into_iter().for_each(|to| self.send_one(to, frame))
            }
            (Some(Peer::Address(to)), To::One(_)) => self.send_one(to, frame),
            (Some(Peer::Address(to)), To::Believed(peers)) if peers.has(to) => self.send_one(to, frame),
            // An unknown peer may be a spoofed address.
            _ => self.shared.tally.sent(frame, false),
        }
    }

    fn believe(&self, peer: Peer) {
        if let (Peer::Address(from), To::Believed(peers)) = (peer, &self.to) {
            peers.note(from, Instant::now());
        }
    }

    fn local(&self) -> Option<SocketAddr> {
        self.socket.local_addr().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(port: usize) -> SocketAddr {
        SocketAddr::from(([127, 0, 0, 1], u16::try_from(port).expect("a port")))
    }

    #[test]
    fn an_active_peer_stays_whatever_others_arrive() {
        let believed = Believed::default();
        let began = Instant::now();
        for second in 0..60 {
            let now = began + Duration::from_secs(second);
            believed.note(peer(1), now);
            for other in 0..64 {
                believed.note(peer(1000 + other + 64 * second as usize), now);
            }
            let all = believed.all(now);
            assert!(all.contains(&peer(1)) && all.len() <= PEERS, "{second}: {all:?}");
        }
    }

    #[test]
    fn silent_peers_are_replaced_or_time_out() {
        let believed = Believed::default();
        let began = Instant::now();
        for port in 0..PEERS {
            believed.note(peer(port), began + Duration::from_millis(port as u64));
        }
        believed.note(peer(100), began + YIELD - Duration::from_millis(1));
        assert!(!believed.has(peer(100)), "all peers are active");
        believed.note(peer(100), began + YIELD);
        assert!(believed.has(peer(100)) && !believed.has(peer(0)), "the longest silent peer is replaced");
        assert_eq!(believed.all(began + FORGET + Duration::from_millis(500)), [peer(100)]);
    }
}
