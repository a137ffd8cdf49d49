//! Plays a recording for pages, which can pause and seek.

use crate::frame::FrameData;
use crate::pace::Pace;
use crate::recording::{Reader, RecordingError};
use crate::series::Series;
use crate::server::{Client, FromPage, Server, WORDS};
use crate::session::{FRAME, NotUnderstood, STATE, TRAIL, Wanted, trail};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

/// Figures of more ticks are read for every n-th tick.
const FIGURES: u32 = 1 << 16;

/// Plays a recording for pages, which can pause and seek.
#[derive(Debug)]
pub struct Playback {
    reader: Reader,
    first: u32,
    last: u32,
    tick: u32,
    scene: String,
    figures: String,
    orders: String,
    pace: Pace,
    pages: BTreeSet<Client>,
    is_new: bool,
    shown: Instant,
    told: Instant,
}

impl Playback {
    /// Opens a recording at its beginning.
    ///
    /// # Errors
    /// The file cannot be read or is damaged.
    pub fn open(path: &Path, is_paused: bool) -> Result<Self, RecordingError> {
        let mut reader = Reader::open(path)?;
        let tick_s = reader.scene()?.tick_s;
        let scene = reader.scene_text()?;
        let (first, last) = reader.ticks().unwrap_or_default();
        let now = Instant::now();
        let mut playback = Self {
            reader,
            first,
            last,
            tick: first,
            scene,
            figures: String::new(),
            orders: String::new(),
            pace: Pace::new(tick_s, is_paused),
            pages: BTreeSet::new(),
            is_new: true,
            shown: now,
            told: now,
        };
        playback.figures = playback.figures()?;
        playback.orders = json!({ "type": "orders", "orders": playback.reader.orders()? }).to_string();
        Ok(playback)
    }

    /// The byte at which an incomplete file ends.
    pub const fn torn_at(&self) -> Option<u64> {
        self.reader.torn_at()
    }

    /// The first and the last tick.
    pub const fn ticks(&self) -> (u32, u32) {
        (self.first, self.last)
    }

    /// Sets the initial speed, simulated seconds per second; `None` for no limit.
    pub fn set_speed(&mut self, speed: Option<f64>) {
        self.pace.set_speed(speed);
    }

    /// Plays and serves pages until `stop` returns true.
    ///
    /// # Errors
    /// The file cannot be read or is damaged.
    pub fn run(mut self, server: &Server, stop: &dyn Fn() -> bool) -> Result<(), RecordingError> {
        while !stop() {
            let patience = self.pace.until_due(Instant::now()).unwrap_or(STATE).min(STATE / 10);
            let mut patience = patience.max(Duration::from_millis(1));
            for _ in 0..WORDS {
                let Some(word) = server.next(patience) else { break };
                self.hear(word, server)?;
                patience = Duration::ZERO;
            }
            let start = Instant::now();
            while self.pace.until_due(start) == Some(Duration::ZERO) {
                self.step();
                self.pace.done(start);
                if self.pace.speed().is_none() {
                    break;
                }
            }
            self.show(server)?;
        }
        Ok(())
    }

    fn step(&mut self) {
        self.tick = (self.tick + 1).min(self.last);
        self.is_new = true;
        if self.tick == self.last {
            self.pace.pause();
        }
    }

    fn hear(&mut self, word: FromPage, server: &Server) -> Result<(), RecordingError> {
        match word {
            FromPage::Opened(client) => {
                self.pages.insert(client);
                server.send_scene(Some(client), self.scene.clone());
                server.say(Some(client), self.figures.clone());
                server.say(Some(client), self.orders.clone());
                self.is_new = true;
            }
            FromPage::Closed(client) => {
                self.pages.remove(&client);
            }
            FromPage::Said(client, text) => match Wanted::read(&text) {
                Ok(Wanted::Pause) => self.pace.pause(),
                Ok(Wanted::Play) => {
                    if self.tick == self.last {
                        self.tick = self.first;
                    }
                    self.pace.play();
                }
                Ok(Wanted::Step) => {
                    self.pace.pause();
                    self.step();
                }
                Ok(Wanted::Speed { x }) => self.pace.set_speed(x),
                Ok(Wanted::Seek { tick }) => {
                    self.pace.pause();
                    self.tick = tick.clamp(self.first, self.last);
                    self.is_new = true;
                }
                Ok(Wanted::Seen { frames }) => {
                    server.seen(client, frames);
                    return Ok(());
                }
                Ok(Wanted::Trail { mut ticks, .. }) => {
                    ticks.truncate(TRAIL);
                    let mut frames = Vec::new();
                    for tick in ticks {
                        frames.push((tick, self.reader.frame_bytes(tick)?.to_vec()));
                    }
                    server.say(Some(client), trail(None, frames.iter().map(|(tick, frame)| (*tick, &frame[..]))));
                    return Ok(());
                }
                Ok(_) | Err(NotUnderstood { is_json: true, .. }) => {}
                Err(_) => server.dismiss(client),
            },
        }
        self.tell(server);
        Ok(())
    }

    fn show(&mut self, server: &Server) -> Result<(), RecordingError> {
        let now = Instant::now();
        if now.duration_since(self.told) >= STATE {
            self.tell(server);
        }
        if !self.is_new || self.pages.is_empty() || now.duration_since(self.shown) < FRAME {
            return Ok(());
        }
        (self.is_new, self.shown) = (false, now);
        let scene = self.reader.scene_text_at(self.tick)?;
        if scene != self.scene {
            server.send_scene(None, scene.clone());
            self.scene = scene;
        }
        server.show(self.reader.frame_bytes(self.tick)?.to_vec());
        Ok(())
    }

    fn tell(&mut self, server: &Server) {
        self.told = Instant::now();
        let state = json!({
            "type": "state", "paused": self.pace.is_paused(), "speed": self.pace.speed(), "tick": self.tick,
            "first": self.first, "last": self.last, "clients": self.pages.len(), "at_end": self.tick == self.last,
        });
        server.say(None, state.to_string());
    }

    fn figures(&mut self) -> Result<String, RecordingError> {
        let every = (self.last - self.first).div_ceil(FIGURES).max(1);
        let (mut series, mut before) = (Series::default(), None);
        for tick in (self.first..=self.last).step_by(every as usize) {
            let Ok((tick, figures)) = FrameData::figures_of(self.reader.frame_bytes(tick)?) else { continue };
            if before.replace(tick) != Some(tick) {
                series.put(tick, &figures);
            }
        }
        Ok(series.all())
    }
}
