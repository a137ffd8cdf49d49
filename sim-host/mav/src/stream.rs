//! Lines of bytes: TCP and serial ports.

use super::traffic::{GLANCE, Outgoing, Peer, Shared};
use staya_serial::SerialPort;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Frames that wait for a slow peer at most.
const QUEUE: usize = 1024;
/// How long until a connection that ended is tried again.
const RETRY: Duration = Duration::from_secs(1);
/// How long a write may take before the peer counts as gone.
const PATIENCE: Duration = Duration::from_secs(2);
/// How long a serial port is read or written before it is looked at again.
const PAUSE: Duration = Duration::from_millis(500);

type Threads = Vec<JoinHandle<()>>;
type Opened = io::Result<(Box<dyn Outgoing>, Threads)>;

/// Who is connected.
#[derive(Clone, Default)]
struct Peers(Arc<Mutex<HashMap<Peer, SyncSender<Vec<u8>>>>>);

impl Peers {
    fn with<T>(&self, work: impl FnOnce(&mut HashMap<Peer, SyncSender<Vec<u8>>>) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

struct Stream {
    peers: Peers,
    local: Option<SocketAddr>,
    shared: Shared,
}

impl Outgoing for Stream {
    fn send(&self, frame: &[u8]) {
        self.peers.with(|peers| {
            for queue in peers.values() {
                if queue.try_send(frame.to_vec()).is_err() {
                    self.shared.tally.sent(frame, false);
                }
            }
        });
    }

    fn send_to(&self, peer: Peer, frame: &[u8]) {
        let is_queued = self.peers.with(|peers| {
            let queue = peers.get(&peer);
            queue.is_some_and(|queue| queue.try_send(frame.to_vec()).is_ok())
        });
        if !is_queued {
            self.shared.tally.sent(frame, false);
        }
    }

    fn local(&self) -> Option<SocketAddr> {
        self.local
    }
}

/// A connection to an address, again and again.
pub(super) fn connect(to: SocketAddr, shared: &Shared) -> (Box<dyn Outgoing>, Threads) {
    let peers = Peers::default();
    let stream = Stream { peers: peers.clone(), local: None, shared: shared.clone() };
    let shared = shared.clone();
    let work = move || {
        while !shared.is_closed() {
            if let Ok(socket) = shared.tally.noting(TcpStream::connect_timeout(&to, PATIENCE)) {
                converse_tcp(&socket, Peer::Address(to), &peers, &shared);
            }
            wait(RETRY, &shared);
        }
    };
    (Box::new(stream), vec![thread::spawn(work)])
}

/// Connections at an address.
pub(super) fn listen(at: SocketAddr, shared: &Shared) -> Opened {
    let listener = TcpListener::bind(at)?;
    listener.set_nonblocking(true)?;
    let peers = Peers::default();
    let stream = Stream { peers: peers.clone(), local: listener.local_addr().ok(), shared: shared.clone() };
    let shared = shared.clone();
    let work = move || {
        let mut threads = Threads::new();
        while !shared.is_closed() {
            threads.retain(|thread| !thread.is_finished());
            match listener.accept() {
                Ok((socket, from)) => {
                    let (peers, shared) = (peers.clone(), shared.clone());
                    threads.push(thread::spawn(move || {
                        converse_tcp(&socket, Peer::Address(from), &peers, &shared);
                    }));
                }
                Err(_) => thread::sleep(GLANCE),
            }
        }
        for thread in threads {
            let _ = thread.join();
        }
    };
    Ok((Box::new(stream), vec![thread::spawn(work)]))
}

/// A serial port; opened again when it was unplugged.
pub(super) fn serial(port: &SerialPort, shared: &Shared) -> Opened {
    let port = port.clone();
    let open = move || port.open(PAUSE);
    let mut opened = Some(open().map_err(io::Error::other)?);
    let peers = Peers::default();
    let stream = Stream { peers: peers.clone(), local: None, shared: shared.clone() };
    let shared = shared.clone();
    let work = move || {
        while !shared.is_closed() {
            if let Some((read, write)) = opened.take() {
                converse(read, write, Peer::Wire, &peers, &shared);
            }
            wait(RETRY, &shared);
            opened = open().ok();
        }
    };
    Ok((Box::new(stream), vec![thread::spawn(work)]))
}

/// Sleeps, but not beyond the line's end.
fn wait(time: Duration, shared: &Shared) {
    let mut left = time;
    while !left.is_zero() && !shared.is_closed() {
        thread::sleep(GLANCE.min(left));
        left = left.saturating_sub(GLANCE);
    }
}

fn converse_tcp(socket: &TcpStream, peer: Peer, peers: &Peers, shared: &Shared) {
    let set = || {
        socket.set_nonblocking(false)?;
        socket.set_nodelay(true)?;
        socket.set_read_timeout(Some(GLANCE))?;
        socket.set_write_timeout(Some(PATIENCE))?;
        Ok::<_, io::Error>((socket.try_clone()?, socket.try_clone()?))
    };
    if let Ok((read, write)) = set() {
        converse(read, write, peer, peers, shared);
    }
    // The other side may have gone already.
    let _ = socket.shutdown(std::net::Shutdown::Both);
}

/// Reads and writes until either side ends.
fn converse(mut read: impl Read, write: impl Write + Send, peer: Peer, peers: &Peers, shared: &Shared) {
    let (queue, frames) = sync_channel(QUEUE);
    peers.with(|peers| peers.insert(peer, queue));
    thread::scope(|scope| {
        let writer = scope.spawn(move || write_all(write, &frames, shared));
        let (mut buffer, mut chunk) = (Vec::new(), [0; 4096]);
        while !shared.is_closed() && !writer.is_finished() {
            match read.read(&mut chunk) {
                Ok(0) => break,
                Ok(len) => {
                    buffer.extend_from_slice(&chunk[..len]);
                    let used = shared.take(peer, &buffer, false);
                    buffer.drain(..used);
                }
                Err(error) if is_nothing(&error) => {}
                Err(_) => break,
            }
        }
        // The writer ends when nobody can send any more.
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

/// Nothing came in for a while; or the port was interrupted.
fn is_nothing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
