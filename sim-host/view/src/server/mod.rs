//! A web server for live pages. One thread serves files and WebSockets and never makes the run
//! wait.
//!
//! The run sends texts ([`Server::say`]) and frames ([`Server::show`]) and polls the requests of
//! pages ([`Server::next`]). A slow page gets fewer frames; a page that does not read, or exceeds
//! the limits in PROTOCOL.md, is disconnected. The connections are limited, and so are the memory
//! of each and its work per turn; a new connection replaces the oldest one without a complete
//! request.

mod connection;
mod metered;
mod request;

use crate::page::File;
use anyhow::{Result, anyhow};
use connection::{Connection, Outcome};
use mio::net::TcpListener;
use mio::{Events, Interest, Poll, Token, Waker};
use request::Rules;
use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tungstenite::{Bytes, Utf8Bytes};

const CONNECTIONS: usize = 256;
const PAGES: usize = 32;
/// Connections accepted in one turn.
const ACCEPTED: usize = 64;
/// Limit of a page's messages that the run has not read, bytes.
const UNHEARD: usize = 256 << 10;
/// Events of pages that a run handles before it continues; the server disconnects faster pages.
pub(crate) const WORDS: usize = 64;
/// Counted for each message in addition to its text.
const OVERHEAD: usize = 64;
/// Timeout of a request, and of its answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Time that the thread has to tell the pages that the server ends.
const FAREWELL: Duration = Duration::from_secs(1);

const LISTENER: Token = Token(0);
const WAKER: Token = Token(1);

/// Identifies a connected page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Client(usize);

/// Connection counters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All connections.
    pub connections: u64,
    /// Rejected requests: malformed, wrong token, other origin, or too many pages.
    pub refused: u64,
    /// Connections closed by the server: too slow, too talkative, not reading, or too many.
    pub left: u64,
}

/// An event of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FromPage {
    /// A page connected.
    Opened(Client),
    /// A page sent a message.
    Said(Client, String),
    /// A page disconnected.
    Closed(Client),
}

enum ToPages {
    Text(Option<Client>, Utf8Bytes),
    Seen(Client, u64),
    Dismiss(Client),
    End,
}

/// Bytes of the messages that the run has not read, for each page. A page is in it until the run
/// has read that it disconnected, which bounds the number of events.
type Unheard = BTreeMap<Client, usize>;

/// A server of live pages, which ends on drop within a second.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: String,
    heard: Receiver<FromPage>,
    unheard: Arc<Mutex<Unheard>>,
    outgoing: Sender<ToPages>,
    latest: Arc<Mutex<Option<Bytes>>>,
    counts: Arc<Mutex<Counts>>,
    waker: Arc<Waker>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens on `address` (port 0 selects a free port) and serves `files`.
    ///
    /// # Errors
    /// The address is in use or not available, or the system refused events, random numbers or a
    /// thread.
    pub fn start(address: SocketAddr, files: Vec<File>) -> Result<Self> {
        let listener = TcpListener::bind(address).map_err(|error| {
            anyhow!(
                "cannot listen on {address}: {error}; give another address with --listen, or port 0 for a free port"
            )
        })?;
        Self::serve(listener, files).map_err(|error| anyhow!("cannot serve pages: {error}; start the command again"))
    }

    fn serve(mut listener: TcpListener, files: Vec<File>) -> io::Result<Self> {
        let (address, token, poll) = (listener.local_addr()?, random_hex()?, Poll::new()?);
        let registry = poll.registry();
        registry.register(&mut listener, LISTENER, Interest::READABLE)?;
        let waker = Arc::new(Waker::new(registry, WAKER)?);
        let (heard_in, heard) = channel();
        let unheard = Arc::default();
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
            is_accepting: false,
            heard: heard_in,
            unheard: Arc::clone(&unheard),
            out,
            latest: Arc::clone(&latest),
            counts: Arc::clone(&counts),
        };
        let thread = std::thread::Builder::new().name("pages".to_owned()).spawn(move || pages.run());
        Ok(Self { address, token, heard, unheard, outgoing, latest, counts, waker, thread: Some(thread?) })
    }

    /// The address that the server listens on.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Connection counters so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        *lock(&self.counts)
    }

    /// URL of the page, with its token.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/?token={}", self.address, self.token)
    }

    /// The next event of a page; waits for at most `patience`, even if the server thread has ended.
    #[must_use]
    pub fn next(&self, patience: Duration) -> Option<FromPage> {
        let what = match self.heard.recv_timeout(patience) {
            Ok(what) => what,
            Err(RecvTimeoutError::Timeout) => return None,
            Err(RecvTimeoutError::Disconnected) => {
                std::thread::sleep(patience);
                return None;
            }
        };
        let mut unheard = lock(&self.unheard);
        match &what {
            FromPage::Opened(_) => {}
            FromPage::Said(client, text) => {
                if let Some(bytes) = unheard.get_mut(client) {
                    *bytes = bytes.saturating_sub(text.len() + OVERHEAD);
                }
            }
            FromPage::Closed(client) => drop(unheard.remove(client)),
        }
        Some(what)
    }

    /// Whether the server thread runs. It never restarts.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Sends a text to one page, or to all with `None`.
    pub fn say(&self, to: Option<Client>, text: impl Into<Utf8Bytes>) {
        self.send(ToPages::Text(to, text.into()));
    }

    /// Sends a text and drops a queued frame, which it makes obsolete.
    pub fn send_scene(&self, to: Option<Client>, text: impl Into<Utf8Bytes>) {
        *lock(&self.latest) = None;
        self.say(to, text);
    }

    /// Sends a frame to all pages. It replaces a frame that was not sent yet.
    pub fn show(&self, frame: impl Into<Bytes>) {
        *lock(&self.latest) = Some(frame.into());
        // If the wake-up fails, the frame leaves with the next message.
        let _ = self.waker.wake();
    }

    /// Records how many frames a page has drawn; it gets no more while three are in transit.
    pub fn seen(&self, client: Client, frames: u64) {
        self.send(ToPages::Seen(client, frames));
    }

    /// Disconnects a page.
    pub fn dismiss(&self, client: Client) {
        self.send(ToPages::Dismiss(client));
    }

    fn send(&self, what: ToPages) {
        // The thread ends only after all senders.
        let _ = self.outgoing.send(what);
        let _ = self.waker.wake();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.send(ToPages::End);
        let until = Instant::now() + FAREWELL;
        // The thread drops its end of the channel when it ends. It is not joined: a command must
        // end even if the thread does not.
        while self.heard.recv_timeout(until.saturating_duration_since(Instant::now())).is_ok() {
            if Instant::now() > until {
                return;
            }
        }
    }
}

/// The data are valid even after a panic of the other thread.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

fn random_hex() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

struct Pages {
    poll: Poll,
    listener: TcpListener,
    rules: Rules,
    files: Vec<File>,
    /// Keys are tokens, which rise: the oldest connection is first.
    connections: BTreeMap<usize, Connection>,
    next: usize,
    /// Connections may wait. The system reports each once.
    is_accepting: bool,
    heard: Sender<FromPage>,
    unheard: Arc<Mutex<Unheard>>,
    out: Receiver<ToPages>,
    latest: Arc<Mutex<Option<Bytes>>>,
    counts: Arc<Mutex<Counts>>,
}

impl Pages {
    fn run(mut self) {
        let mut events = Events::with_capacity(CONNECTIONS);
        loop {
            let has_more = self.is_accepting || self.connections.values().any(Connection::has_more);
            let patience = if has_more { Duration::ZERO } else { Duration::from_secs(1) };
            let _ = self.poll.poll(&mut events, Some(patience));
            for event in &events {
                match event.token() {
                    LISTENER => self.is_accepting = true,
                    WAKER => {}
                    Token(number) => {
                        if let Some(connection) = self.connections.get_mut(&number).filter(|_| event.is_readable()) {
                            connection.input_arrived();
                        }
                    }
                }
            }
            self.accept();
            let with_input: Vec<usize> = self.of(Connection::has_input).collect();
            with_input.into_iter().for_each(|number| self.read(number));
            if self.pass_on() {
                let registry = self.poll.registry();
                return self.connections.into_values().for_each(|connection| connection.end(registry, true));
            }
            let now = Instant::now();
            let late: Vec<usize> = self.of(|connection| connection.is_late(now)).collect();
            late.into_iter().for_each(|number| self.expel(number));
        }
    }

    fn of(&self, is: impl Fn(&Connection) -> bool) -> impl Iterator<Item = usize> {
        self.connections.iter().filter(move |(_, connection)| is(connection)).map(|(number, _)| *number)
    }

    fn accept(&mut self) {
        for _ in 0..ACCEPTED {
            let accepted = if self.is_accepting { self.listener.accept().ok() } else { None };
            let Some((mut stream, _)) = accepted else {
                self.is_accepting = false;
                return;
            };
            lock(&self.counts).connections += 1;
            if self.connections.len() >= CONNECTIONS {
                let oldest = self.of(|connection| !connection.is_live()).next();
                let Some(oldest) = oldest else { continue };
                self.expel(oldest);
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

    fn read(&mut self, number: usize) {
        let Some(connection) = self.connections.get_mut(&number) else {
            return;
        };
        let (client, heard, unheard) = (Client(number), &self.heard, &self.unheard);
        let has_room = lock(unheard).len() < PAGES;
        let mut hear = |text: String| {
            let mut unheard = lock(unheard);
            let bytes = unheard.entry(client).or_default();
            let cost = text.len() + OVERHEAD;
            let is_heard = *bytes + cost <= UNHEARD && heard.send(FromPage::Said(client, text)).is_ok();
            *bytes += if is_heard { cost } else { 0 };
            is_heard
        };
        match connection.read(&self.rules, &self.files, has_room, &mut hear) {
            Outcome::Goes => {}
            Outcome::Refused => lock(&self.counts).refused += 1,
            Outcome::Opened => {
                lock(unheard).insert(client, 0);
                let _ = heard.send(FromPage::Opened(client));
            }
            Outcome::Ended => self.close(number),
            Outcome::Exceeded => self.expel(number),
        }
    }

    /// Returns true once the run has dropped the server.
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

    fn expel(&mut self, number: usize) {
        lock(&self.counts).left += 1;
        self.close(number);
    }

    fn close(&mut self, number: usize) {
        if let Some(connection) = self.connections.remove(&number) {
            let was_live = connection.is_live();
            connection.end(self.poll.registry(), false);
            if was_live {
                let _ = self.heard.send(FromPage::Closed(Client(number)));
            }
        }
    }
}

#[cfg(test)]
mod tests;
