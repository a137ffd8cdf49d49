//! The environment of the main loop. Its errors never end the loop.

use crate::companion::medium::Medium;
use crate::companion::roll::KeyWatch;
use crate::tlog::Missing;
use crate::{Lines, Peer, Received, Tlog};
use staya_console::printable;
use staya_controller::auth::Key;
use staya_sim::record;
use std::io::{self, Write as _};
use std::time::{Duration, Instant};

/// By default there is no network, and no peer to choose from.
pub trait Machine {
    fn now(&self) -> Duration;

    fn pause(&mut self, time: Duration);

    fn receive(&mut self, wait: Duration) -> Option<Received>;

    fn send(&mut self, line: usize, peer: Option<Peer>, frame: &[u8]);

    /// `None` without links to real autopilots.
    fn lines(&self) -> Option<&Lines> {
        None
    }

    fn hear_others(&mut self, _heard: &mut dyn FnMut(&[u8])) {}

    fn tell_others(&mut self, _frames: &[u8]) {}

    /// An error is returned once; later frames are counted.
    fn log(&mut self, frame: &[u8]) -> Result<(), record::Error>;

    fn close_log(&mut self) -> Result<(), record::Error>;

    /// Frames and bytes that the log lacks.
    fn missing(&self) -> Missing;

    fn new_key(&mut self) -> Option<Result<Key, String>> {
        None
    }

    fn show(&mut self, line: &str) -> io::Result<()> {
        writeln!(io::stdout(), "{}", printable(line))
    }

    fn tell(&mut self, line: &str) -> io::Result<()> {
        writeln!(io::stderr(), "{}", printable(line))
    }
}

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
        self.lines.send(line, peer, frame);
    }

    fn lines(&self) -> Option<&Lines> {
        Some(&self.lines)
    }

    fn hear_others(&mut self, heard: &mut dyn FnMut(&[u8])) {
        self.medium.receive(heard);
    }

    fn tell_others(&mut self, frames: &[u8]) {
        self.medium.send(frames);
    }

    fn log(&mut self, frame: &[u8]) -> Result<(), record::Error> {
        self.tlog.as_mut().map_or(Ok(()), |tlog| tlog.add(frame))
    }

    fn close_log(&mut self) -> Result<(), record::Error> {
        self.tlog.as_mut().map_or(Ok(()), Tlog::finish)
    }

    fn missing(&self) -> Missing {
        self.tlog.as_ref().map(Tlog::missing).unwrap_or_default()
    }

    fn new_key(&mut self) -> Option<Result<Key, String>> {
        self.key.as_ref()?.news()
    }
}
