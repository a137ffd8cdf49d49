use super::inbox::Peer;
use super::reassembly::Reassembly;
use super::traffic::{GLANCE, Opened, Outgoing, Shared, start};
use staya_serial::SerialPort;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

pub(super) const CONNECTIONS: usize = 32;
const IDLE: Duration = Duration::from_secs(60);
const YIELD: Duration = Duration::from_secs(5);
const QUEUE: usize = 1024;
const RETRY: Duration = Duration::from_secs(1);
const PATIENCE: Duration = Duration::from_secs(2);
const PAUSE: Duration = Duration::from_millis(500);

#[derive(Clone, Default)]
struct Peers(Arc<Mutex<HashMap<Peer, Connected>>>);

struct Connected {
    queue: SyncSender<Vec<u8>>,
    heard: Instant,
    is_believed: bool,
    socket: Option<TcpStream>,
}

impl Connected {
    fn end(&self) {
        if let Some(socket) = &self.socket {
            let _ = socket.shutdown(Shutdown::Both);
        }
    }
}

impl Peers {
    fn with<T>(&self, work: impl FnOnce(&mut HashMap<Peer, Connected>) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn join(&self, peer: Peer, socket: Option<TcpStream>) -> Receiver<Vec<u8>> {
        let (queue, frames) = sync_channel(QUEUE);
        let connected = Connected { queue, heard: Instant::now(), is_believed: false, socket };
        self.with(|peers| peers.insert(peer, connected));
        frames
    }

    fn end_idle(&self, now: Instant) {
        self.with(|peers| {
            let idle = |peer: &Connected| now.saturating_duration_since(peer.heard) >= IDLE;
            peers.values().filter(|peer| idle(peer)).for_each(Connected::end);
        });
    }

    /// Closes the oldest unknown peer, else the known peer that was silent for longest, if that is
    /// longer than `YIELD`. Returns whether there is room.
    fn make_room(&self, now: Instant) -> bool {
        self.with(|peers| {
            if peers.len() < CONNECTIONS {
                return true;
            }
            let first = peers.iter().min_by_key(|(_, peer)| (peer.is_believed, peer.heard));
            let first =
                first.filter(|(_, peer)| !peer.is_believed || now.saturating_duration_since(peer.heard) >= YIELD);
            let Some(first) = first.map(|(first, _)| *first) else {
                return false;
            };
            peers.remove(&first).inspect(Connected::end).is_some()
        })
    }
}

struct Stream {
    peers: Peers,
    local: Option<SocketAddr>,
    shared: Shared,
}

impl Outgoing for Stream {
    fn send(&self, peer: Option<Peer>, frame: &[u8]) {
        let is_lost = |peer: &&Connected| peer.queue.try_send(frame.to_vec()).is_err();
        let lost = self.peers.with(|peers| match peer {
            None => peers.values().filter(is_lost).count(),
            Some(peer) => usize::from(peers.get(&peer).is_none_or(|peer| is_lost(&peer))),
        });
        (0..lost).for_each(|_| self.shared.tally.sent(frame, false));
    }

    fn believe(&self, peer: Peer) {
        self.peers.with(|peers| {
            if let Some(peer) = peers.get_mut(&peer) {
                (peer.heard, peer.is_believed) = (Instant::now(), true);
            }
        });
    }

    fn local(&self) -> Option<SocketAddr> {
        self.local
    }
}

/// A link whose thread does `work`.
fn open(
    name: &str,
    local: Option<SocketAddr>,
    shared: &Shared,
    work: impl FnOnce(&Peers, &Shared) + Send + 'static,
) -> Opened {
    let stream = Stream { peers: Peers::default(), local, shared: shared.clone() };
    let (peers, shared) = (stream.peers.clone(), shared.clone());
    Ok((Box::new(stream), start(name, move || work(&peers, &shared))?))
}

pub(super) fn connect(to: SocketAddr, shared: &Shared) -> Opened {
    open("tcp", None, shared, move |peers, shared| {
        while !shared.is_closed() {
            if let Ok(socket) = shared.tally.noting(TcpStream::connect_timeout(&to, PATIENCE)) {
                let frames = peers.join(Peer::Address(to), None);
                converse_tcp(&socket, Peer::Address(to), frames, peers, shared);
            }
            wait(RETRY, shared);
        }
    })
}

pub(super) fn listen(at: SocketAddr, shared: &Shared) -> Opened {
    let listener = TcpListener::bind(at)?;
    listener.set_nonblocking(true)?;
    open("tcpin", listener.local_addr().ok(), shared, move |peers, shared| {
        let mut threads = Vec::<JoinHandle<()>>::new();
        while !shared.is_closed() {
            threads.retain(|thread| !thread.is_finished());
            let now = Instant::now();
            peers.end_idle(now);
            // Threads of closed connections need time to end; callers wait in the system's backlog.
            let accepted = if threads.len() < 2 * CONNECTIONS { listener.accept().ok() } else { None };
            let Some((socket, from)) = accepted else {
                thread::sleep(GLANCE);
                continue;
            };
            if !peers.make_room(now) {
                continue;
            }
            let (peer, Ok(end)) = (Peer::Address(from), socket.try_clone()) else {
                continue;
            };
            let frames = peers.join(peer, Some(end));
            let (with, shared) = (peers.clone(), shared.clone());
            match start("tcp", move || converse_tcp(&socket, peer, frames, &with, &shared)) {
                Ok(thread) => threads.push(thread),
                Err(_) => drop(peers.with(|peers| peers.remove(&peer))),
            }
        }
        for thread in threads {
            let _ = thread.join();
        }
    })
}

pub(super) fn serial(port: &SerialPort, shared: &Shared) -> Opened {
    let port = port.clone();
    let mut opened = Some(port.open(PAUSE).map_err(io::Error::other)?);
    open("serial", None, shared, move |peers, shared| {
        while !shared.is_closed() {
            if let Some((read, write)) = opened.take() {
                let frames = peers.join(Peer::Wire, None);
                converse(read, write, Peer::Wire, frames, peers, shared);
            }
            wait(RETRY, shared);
            opened = port.open(PAUSE).ok();
        }
    })
}

fn wait(time: Duration, shared: &Shared) {
    let mut left = time;
    while !left.is_zero() && !shared.is_closed() {
        thread::sleep(GLANCE.min(left));
        left = left.saturating_sub(GLANCE);
    }
}

fn converse_tcp(socket: &TcpStream, peer: Peer, frames: Receiver<Vec<u8>>, peers: &Peers, shared: &Shared) {
    let set = || {
        socket.set_nonblocking(false)?;
        socket.set_nodelay(true)?;
        socket.set_read_timeout(Some(GLANCE))?;
        socket.set_write_timeout(Some(PATIENCE))
    };
    if set().is_ok() {
        converse(socket, socket, peer, frames, peers, shared);
    }
    peers.with(|peers| peers.remove(&peer));
    let _ = socket.shutdown(Shutdown::Both);
}

fn converse(
    mut read: impl Read,
    write: impl Write + Send,
    peer: Peer,
    frames: Receiver<Vec<u8>>,
    peers: &Peers,
    shared: &Shared,
) {
    thread::scope(|scope| {
        let writer = thread::Builder::new().name(String::from("write"));
        if let Ok(writer) = writer.spawn_scoped(scope, move || write_all(write, &frames, shared)) {
            let (mut stream, mut chunk) = (Reassembly::default(), [0; 4096]);
            while !shared.is_closed() && !writer.is_finished() {
                match read.read(&mut chunk) {
                    Ok(0) => break,
                    Ok(len) => shared.take(peer, &mut stream, &chunk[..len], false, true),
                    Err(error) if is_nothing(&error) => shared.take(peer, &mut stream, &[], false, true),
                    Err(_) => break,
                }
            }
            shared.waste(stream.waiting());
        }
        peers.with(|peers| peers.remove(&peer));
    });
}

fn write_all(mut write: impl Write, frames: &Receiver<Vec<u8>>, shared: &Shared) {
    loop {
        match frames.recv_timeout(GLANCE) {
            Ok(frame) => {
                let is_sent = write.write_all(&frame).and_then(|()| write.flush());
                shared.tally.sent(&frame, is_sent.is_ok());
                if is_sent.is_err() {
                    return;
                }
            }
            Err(RecvTimeoutError::Timeout) if !shared.is_closed() => {}
            Err(_) => return,
        }
    }
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
