//! Pages in browsers: one thread that serves files and WebSockets to them, and never makes the run wait.
//!
//! The run says things ([`Server::say`]) and shows frames ([`Server::show`]); who is slow gets fewer frames, and who does not read at
//! all is left. What pages ask for, the run takes when it likes ([`Server::next`]). Few connections at a time, each with
//! bounded memory: whoever comes beyond that takes the place of the oldest one that has not said what it wants.

mod connection;
mod request;

use crate::page::File;
use connection::{Connection, Outcome};
use mio::event::Event;
use mio::net::TcpListener;
use mio::{Events, Interest, Poll, Token, Waker};
use request::Rules;
use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tungstenite::{Bytes, Utf8Bytes};

/// Connections at a time.
const CONNECTIONS: usize = 256;
/// Pages at a time.
const PAGES: usize = 32;
/// Words of pages that the run has not taken yet.
const UNHEARD: usize = 1024;
/// How long a connection may take to say what it wants, or to take its file.
const PATIENCE: Duration = Duration::from_secs(10);

const LISTENER: Token = Token(0);
const WAKER: Token = Token(1);

/// A page that is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Client(usize);

/// Connections so far, and what became of those that got nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All of them.
    pub connections: u64,
    /// Those that asked for what they do not get: no request, a wrong token, another origin, one page too many.
    pub refused: u64,
    /// Those that were left: too slow to say what they want, pages that do not read or talk without end, and the oldest of too many.
    pub left: u64,
}

/// What comes from pages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FromPage {
    /// One has connected.
    Opened(Client),
    /// It said something.
    Said(Client, String),
    /// It is gone.
    Closed(Client),
}

/// What goes to pages.
enum ToPages {
    Text(Option<Client>, Utf8Bytes),
    Seen(Client, u64),
    Dismiss(Client),
    End,
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is taken, or not ours.
    #[error("cannot listen on {address}: {source}; give another one with --listen, port 0 for any that is free")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// No events, no randomness, no thread.
    #[error("cannot serve pages: {0}")]
    System(io::Error),
    /// The thread is gone.
    #[error("the page is not served any more; start the command again, and report what it said above")]
    Ended,
}

/// Serves pages until it is dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: String,
    heard: Receiver<FromPage>,
    outgoing: Sender<ToPages>,
    latest: Arc<Mutex<Option<Bytes>>>,
    counts: Arc<Mutex<Counts>>,
    waker: Arc<Waker>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens on `address` (port 0: any that is free) and serves `files`.
    ///
    /// # Errors
    /// [`ServeError`].
    pub fn start(address: SocketAddr, files: Vec<File>) -> Result<Self, ServeError> {
        let mut listener = TcpListener::bind(address).map_err(|source| ServeError::Listen { address, source })?;
        let address = listener.local_addr().map_err(ServeError::System)?;
        let token = random_hex().map_err(ServeError::System)?;
        let poll = Poll::new().map_err(ServeError::System)?;
        let registry = poll.registry();
        registry.register(&mut listener, LISTENER, Interest::READABLE).map_err(ServeError::System)?;
        let waker = Arc::new(Waker::new(registry, WAKER).map_err(ServeError::System)?);
        let (heard_in, heard) = sync_channel(UNHEARD);
        let (outgoing, out) = channel();
        let latest = Arc::new(Mutex::new(None));
        let counts = Arc::new(Mutex::new(Counts::default()));
        let rules = Rules { address, token: token.clone() };
        let pages = Pages {
            poll,
            listener,
            rules,
            files,
            connections: BTreeMap::new(),
            next: WAKER.0 + 1,
            heard: heard_in,
            out,
            latest: Arc::clone(&latest),
            counts: Arc::clone(&counts),
        };
        let thread = std::thread::Builder::new().name("pages".to_owned()).spawn(move || pages.run());
        let thread = Some(thread.map_err(ServeError::System)?);
        Ok(Self { address, token, heard, outgoing, latest, counts, waker, thread })
    }

    /// Where it listens.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// What became of connections so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        *lock(&self.counts)
    }

    /// The address of the page, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/?token={}", self.address, self.token)
    }

    /// The next thing that a page did; waits for it as long as `patience`, also when there will never be one again.
    #[must_use]
    pub fn next(&self, patience: Duration) -> Option<FromPage> {
        if patience.is_zero() {
            return self.heard.try_recv().ok();
        }
        match self.heard.recv_timeout(patience) {
            Ok(what) => Some(what),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                std::thread::sleep(patience);
                None
            }
        }
    }

    /// Whether it serves pages; if not, something in its thread went wrong, and never will again.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Says something to a page, or to all.
    pub fn say(&self, to: Option<Client>, text: impl Into<Utf8Bytes>) {
        self.send(ToPages::Text(to, text.into()));
    }

    /// Says something after which older frames mean nothing.
    pub fn begin_anew(&self, to: Option<Client>, text: impl Into<Utf8Bytes>) {
        *lock(&self.latest) = None;
        self.say(to, text);
    }

    /// Shows all pages a frame; one that has not been sent yet is not sent any more.
    pub fn show(&self, frame: impl Into<Bytes>) {
        *lock(&self.latest) = Some(frame.into());
        // The next time somebody says something it is sent all the same.
        let _ = self.waker.wake();
    }

    /// A page has drawn so many frames since it connected; it gets no more while two are on their way.
    pub fn seen(&self, client: Client, frames: u64) {
        self.send(ToPages::Seen(client, frames));
    }

    /// Closes the connection to a page.
    pub fn dismiss(&self, client: Client) {
        self.send(ToPages::Dismiss(client));
    }

    fn send(&self, what: ToPages) {
        // The thread ends after all others have.
        let _ = self.outgoing.send(what);
        let _ = self.waker.wake();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.send(ToPages::End);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What is in there is whole, whatever became of the thread that put it there.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// 128 random bits in hexadecimal digits.
fn random_hex() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The thread's side.
struct Pages {
    poll: Poll,
    listener: TcpListener,
    rules: Rules,
    files: Vec<File>,
    /// By token, hence the oldest first.
    connections: BTreeMap<usize, Connection>,
    next: usize,
    heard: SyncSender<FromPage>,
    out: Receiver<ToPages>,
    latest: Arc<Mutex<Option<Bytes>>>,
    counts: Arc<Mutex<Counts>>,
}

impl Pages {
    fn run(mut self) {
        let mut events = Events::with_capacity(CONNECTIONS);
        loop {
            // An interrupted poll is one without events.
            let _ = self.poll.poll(&mut events, Some(Duration::from_secs(1)));
            for event in &events {
                match event.token() {
                    LISTENER => self.accept(),
                    WAKER => {}
                    Token(number) => self.serve(number, event),
                }
            }
            if self.pass_on() {
                let registry = self.poll.registry();
                return self.connections.into_values().for_each(|connection| connection.end(registry, true));
            }
            let now = Instant::now();
            let late: Vec<usize> = self.of(|connection| connection.is_late(now)).collect();
            lock(&self.counts).left += late.len() as u64;
            late.into_iter().for_each(|number| self.close(number));
        }
    }

    fn of(&self, is: impl Fn(&Connection) -> bool) -> impl Iterator<Item = usize> {
        self.connections.iter().filter(move |(_, connection)| is(connection)).map(|(number, _)| *number)
    }

    fn accept(&mut self) {
        // Until there is nobody more; a connection that is gone already is none.
        while let Ok((mut stream, _)) = self.listener.accept() {
            lock(&self.counts).connections += 1;
            if self.connections.len() >= CONNECTIONS {
                let oldest = self.of(|connection| !connection.is_live()).next();
                let Some(oldest) = oldest else { continue };
                lock(&self.counts).left += 1;
                self.close(oldest);
            }
            let number = self.next;
            self.next += 1;
            let interest = Interest::READABLE | Interest::WRITABLE;
            let _ = stream.set_nodelay(true);
            if self.poll.registry().register(&mut stream, Token(number), interest).is_ok() {
                self.connections.insert(number, Connection::new(stream, Instant::now() + PATIENCE));
            }
        }
    }

    fn serve(&mut self, number: usize, event: &Event) {
        let has_room = self.of(Connection::is_live).count() < PAGES;
        let Some(connection) = self.connections.get_mut(&number) else {
            return;
        };
        let mut is_done = false;
        if event.is_readable() {
            let heard = &self.heard;
            // Whoever talks faster than the run listens is left.
            let mut hear = |text: String| heard.try_send(FromPage::Said(Client(number), text)).is_ok();
            match connection.read(&self.rules, &self.files, has_room, &mut hear) {
                Outcome::Goes => {}
                Outcome::Refused => lock(&self.counts).refused += 1,
                Outcome::Opened => is_done = self.heard.try_send(FromPage::Opened(Client(number))).is_err(),
                Outcome::Ended => is_done = true,
            }
        }
        if is_done || connection.write() == Outcome::Ended {
            self.close(number);
        }
    }

    /// Takes what the run says to those whom it is for. Returns whether it says no more.
    fn pass_on(&mut self) -> bool {
        while let Ok(what) = self.out.try_recv() {
            match what {
                ToPages::End => return true,
                ToPages::Seen(Client(number), frames) => {
                    if let Some(connection) = self.connections.get_mut(&number) {
                        connection.seen(frames);
                    }
                }
                ToPages::Dismiss(Client(number)) => self.close(number),
                ToPages::Text(Some(Client(number)), text) => {
                    if let Some(connection) = self.connections.get_mut(&number) {
                        connection.say(text);
                    }
                }
                ToPages::Text(None, text) => {
                    self.connections.values_mut().for_each(|connection| connection.say(text.clone()));
                }
            }
        }
        if let Some(frame) = lock(&self.latest).take() {
            self.connections.values_mut().for_each(|connection| connection.show(frame.clone()));
        }
        let ended: Vec<usize> = self
            .connections
            .iter_mut()
            .filter_map(|(number, connection)| (connection.write() == Outcome::Ended).then_some(*number))
            .collect();
        ended.into_iter().for_each(|number| self.close(number));
        false
    }

    fn close(&mut self, number: usize) {
        if let Some(connection) = self.connections.remove(&number) {
            let was_live = connection.is_live();
            connection.end(self.poll.registry(), false);
            if was_live {
                // If the run hears nothing any more, it hears of nobody's leaving either.
                let _ = self.heard.try_send(FromPage::Closed(Client(number)));
            }
        }
    }
}

#[cfg(test)]
mod tests;
