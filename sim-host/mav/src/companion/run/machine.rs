//! What the loop needs of the machine that it runs on. Nothing here can end it: what fails is told, or lost as on a radio.

use crate::companion::medium::Medium;
use crate::companion::roll::KeyWatch;
use crate::{Counts, Lines, Peer, Received, Tlog, TlogError};
use staya_controller::auth::Key;
use std::io::{self, Write as _};
use std::time::{Duration, Instant};

/// Time, links, the network between companions, a log and a terminal.
pub trait Machine {
    /// Since the start.
    fn now(&self) -> Duration;

    /// Lets time pass.
    fn pause(&mut self, time: Duration);

    /// The next frame of any line, waiting for at most `wait`.
    fn receive(&mut self, wait: Duration) -> Option<Received>;

    /// Sends a frame on a line, to one peer or to all.
    fn send(&mut self, line: usize, peer: Option<Peer>, frame: &[u8]);

    /// Notes that `peer` said something sound over line number `line`, and may be told things.
    fn believe(&mut self, line: usize, peer: Peer);

    /// What line number `line` has carried.
    fn counts(&self, line: usize) -> Counts;

    /// Why line number `line` has no connection.
    fn trouble(&self, line: usize) -> Option<String>;

    /// Gives `heard` what companions of other processes have said meanwhile.
    fn hear_others(&mut self, heard: &mut dyn FnMut(&[u8]));

    /// Says something to them.
    fn tell_others(&mut self, frames: &[u8]);

    /// Keeps a frame.
    ///
    /// # Errors
    /// When the log cannot be written; it is not asked again.
    fn log(&mut self, frame: &[u8]) -> Result<(), TlogError>;

    /// Ends the log.
    ///
    /// # Errors
    /// When its last part cannot be written.
    fn close_log(&mut self) -> Result<(), TlogError>;

    /// Another key in the file of the packets' key, or what is wrong with that file.
    fn new_key(&mut self) -> Option<Result<Key, String>> {
        None
    }

    /// A line on standard output.
    ///
    /// # Errors
    /// When nobody takes it.
    fn show(&mut self, line: &str) -> io::Result<()>;

    /// A line on standard error.
    ///
    /// # Errors
    /// When nobody takes it.
    fn tell(&mut self, line: &str) -> io::Result<()>;
}

/// The real one.
pub struct Host {
    pub began: Instant,
    pub lines: Lines,
    pub medium: Medium,
    pub tlog: Option<Tlog>,
    pub key: Option<KeyWatch>,
}

impl Machine for Host {
    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn pause(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn receive(&mut self, wait: Duration) -> Option<Received> {
        self.lines.receive(wait)
    }

    fn send(&mut self, line: usize, peer: Option<Peer>, frame: &[u8]) {
        match peer {
            Some(peer) => self.lines.send_to(line, peer, frame),
            None => self.lines.send(line, frame),
        }
    }

    fn believe(&mut self, line: usize, peer: Peer) {
        self.lines.believe(line, peer);
    }

    fn counts(&self, line: usize) -> Counts {
        self.lines.counts(line)
    }

    fn trouble(&self, line: usize) -> Option<String> {
        self.lines.trouble(line)
    }

    fn hear_others(&mut self, heard: &mut dyn FnMut(&[u8])) {
        self.medium.receive(heard);
    }

    fn tell_others(&mut self, frames: &[u8]) {
        self.medium.send(frames);
    }

    fn log(&mut self, frame: &[u8]) -> Result<(), TlogError> {
        self.tlog.as_mut().map_or(Ok(()), |tlog| tlog.add(frame))
    }

    fn close_log(&mut self) -> Result<(), TlogError> {
        self.tlog.take().map_or(Ok(()), Tlog::finish)
    }

    fn new_key(&mut self) -> Option<Result<Key, String>> {
        self.key.as_ref()?.news()
    }

    fn show(&mut self, line: &str) -> io::Result<()> {
        writeln!(io::stdout(), "{line}")
    }

    fn tell(&mut self, line: &str) -> io::Result<()> {
        writeln!(io::stderr(), "{line}")
    }
}
