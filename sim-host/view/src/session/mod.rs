//! A run that pages look at and take hold of: [`Session::run`] is its loop.
//!
//! The engine is stepped here, in the thread that called; pages are served by another one and never make it wait. Whatever a
//! page does is an [`Intervention`] before the next tick, so that the run can be made again to the bit: to go back, the
//! engine starts anew and does all again up to there.

mod memory;
mod message;
mod text;

pub use text::Configuration;

use crate::frame::{FrameData, Framer};
use crate::pace::{Pace, SLICE};
use crate::server::{Client, FromPage, Server};
use memory::Memory;
use message::Wanted;
use staya_sim::engine::{Operated, operated};
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{Intervention, Overrides, Scenario, ScenarioError};
use staya_sim::world::Misplaced;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Least time between two frames.
const FRAME: Duration = Duration::from_millis(16);
/// Time between two states that nobody asked for.
const STATE: Duration = Duration::from_millis(500);
/// Least time between two scenes of land that changes by itself.
const SCENE: Duration = Duration::from_millis(250);
/// Events of a robot that are kept.
const EVENTS: usize = 20;
/// Rows of figures that a page is told at first.
const ROWS: usize = 2000;

/// Why there is nothing to look at.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The scenario cannot be read, or is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Robots cannot start where they should.
    #[error("the robots cannot be placed: {0}")]
    Misplaced(#[from] Misplaced),
}

/// What a page looks at.
#[derive(Clone, Copy, Debug, Default)]
struct Looks {
    robot: Option<usize>,
    links: bool,
}

/// A run, and those who look at it.
pub struct Session {
    text: String,
    path: PathBuf,
    scenario: Scenario,
    engine: Box<dyn Operated>,
    /// Ticks that the engine has done.
    tick: u32,
    framer: Framer,
    frame: FrameData,
    bytes: Vec<u8>,
    memory: Memory,
    /// By hand, by rising tick.
    done: Vec<(u32, Intervention)>,
    /// What happened to robots lately.
    events: HashMap<usize, VecDeque<(u32, String)>>,
    pace: Pace,
    /// On the way to this tick again, without anybody's seeing it.
    catches_up_to: Option<u32>,
    /// What is asked for in the meantime.
    deferred: VecDeque<(Client, Wanted)>,
    /// Whether anybody has had a way to go: otherwise nothing but its last tick ends the run.
    has_work: bool,
    /// Whether the end of the run has been seen.
    is_over: bool,
    pages: BTreeMap<Client, Looks>,
    is_new: bool,
    /// Whether the land has changed since it was shown.
    has_new_land: bool,
    scene_told: Instant,
    shown: Instant,
    told: Instant,
}

impl Session {
    /// A run of a scenario file before its first tick.
    ///
    /// # Errors
    /// [`SessionError`].
    pub fn open(path: &Path, overrides: &Overrides, is_paused: bool) -> Result<Self, SessionError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        Self::new(text, path, overrides, is_paused)
    }

    /// The same of a text that stands, or might stand, in the file `path`.
    ///
    /// # Errors
    /// [`SessionError`].
    pub fn new(text: String, path: &Path, overrides: &Overrides, is_paused: bool) -> Result<Self, SessionError> {
        let scenario = Scenario::parse(&text, path, overrides)?;
        let engine = operated(&scenario)?;
        let now = Instant::now();
        let mut session = Self {
            text,
            path: path.to_owned(),
            framer: Framer::new(&scenario),
            pace: Pace::new(scenario.tick_s(), is_paused),
            scenario,
            engine,
            tick: 0,
            frame: FrameData::default(),
            bytes: Vec::new(),
            memory: Memory::default(),
            done: Vec::new(),
            events: HashMap::new(),
            catches_up_to: None,
            deferred: VecDeque::new(),
            has_work: false,
            is_over: false,
            pages: BTreeMap::new(),
            is_new: true,
            has_new_land: false,
            scene_told: now,
            shown: now,
            told: now,
        };
        session.take_frame();
        Ok(session)
    }

    /// The scenario.
    #[must_use]
    pub const fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// How fast it goes at first: simulated seconds per second, `None` as fast as it can.
    pub fn set_speed(&mut self, speed: Option<f64>) {
        self.pace.set_speed(speed);
    }

    /// Runs, and serves pages, until `stop` says so.
    pub fn run(mut self, server: &Server, stop: &dyn Fn() -> bool) {
        while !stop() {
            let now = Instant::now();
            let rest = if self.catches_up_to.is_some() { Some(Duration::ZERO) } else { self.pace.until_due(now) };
            let patience = rest.unwrap_or(STATE).min(STATE / 10);
            let mut word = server.next(patience);
            while let Some(what) = word {
                self.hear(what, server);
                word = server.next(Duration::ZERO);
            }
            self.work(server);
            self.show(server);
        }
    }

    /// Ticks that are due, for a slice of time.
    fn work(&mut self, server: &Server) {
        let start = Instant::now();
        while start.elapsed() < SLICE {
            if let Some(goal) = self.catches_up_to {
                self.repeat(goal, server);
                continue;
            }
            let now = Instant::now();
            if self.pace.until_due(now) != Some(Duration::ZERO) {
                return;
            }
            self.advance(server);
            self.pace.done(now);
        }
    }

    /// One tick more, which nobody has seen before.
    fn advance(&mut self, server: &Server) {
        let tick = self.tick;
        self.done.retain(|(at, _)| *at <= tick);
        self.memory.forget_from(tick + 1);
        self.step();
        self.take_frame();
        let is_over = self.is_at_end();
        if is_over && !self.is_over {
            self.pace.pause();
            self.tell(server);
        }
        self.is_over = is_over;
    }

    /// Whether all have arrived that had a way to go, or it is the last tick.
    fn is_at_end(&self) -> bool {
        self.tick >= self.scenario.ticks || (self.has_work && self.engine.is_over())
    }

    fn step(&mut self) {
        self.has_new_land |= self.scenario.changes.iter().any(|rule| rule.is_due(self.tick));
        self.engine.advance();
        self.tick += 1;
        self.has_work |= !self.engine.is_over();
        for index in 0..self.scenario.robots.len() {
            for event in self.engine.events(index) {
                let events = self.events.entry(index).or_default();
                if events.len() >= EVENTS {
                    events.pop_front();
                }
                events.push_back((self.tick, message::event(event)));
            }
        }
    }

    /// Does a tick again on the way to one that was done before.
    fn repeat(&mut self, goal: u32, server: &Server) {
        for (_, what) in self.done.iter().filter(|(tick, _)| *tick == self.tick) {
            // It made sense the first time.
            let _ = self.engine.intervene(what);
        }
        if self.tick < goal {
            return self.step();
        }
        self.catches_up_to = None;
        self.is_over = self.is_at_end();
        self.engine.log_receptions(self.wants_links());
        self.take_frame_of_past();
        self.begin_anew(None, server);
        while let Some((client, asked)) = self.deferred.pop_front() {
            self.answer(client, asked, server);
            if self.catches_up_to.is_some() {
                return;
            }
        }
    }

    /// The engine as it was at a tick; it gets there step by step.
    fn go_back_to(&mut self, tick: u32) {
        if tick < self.tick {
            match operated(&self.scenario) {
                Ok(engine) => (self.engine, self.tick, self.has_work) = (engine, 0, false),
                // They could be placed before.
                Err(_) => return,
            }
            self.events.clear();
        } else if tick > self.tick {
            // What was done at this tick is done already.
            self.step();
        } else {
            return;
        }
        self.catches_up_to = Some(tick);
    }

    fn take_frame(&mut self) {
        self.take_frame_of_past();
        self.memory.put(self.tick, &self.bytes);
    }

    /// The frame of now, when later ones are known.
    fn take_frame_of_past(&mut self) {
        let (framer, frame) = (&self.framer, &mut self.frame);
        self.engine.show(&mut |moment, robots| framer.fill(frame, moment, robots));
        self.frame.encode(&mut self.bytes);
        self.is_new = true;
    }

    fn show(&mut self, server: &Server) {
        let now = Instant::now();
        if now.duration_since(self.told) >= STATE {
            self.tell(server);
        }
        if self.has_new_land && self.catches_up_to.is_none() && now.duration_since(self.scene_told) >= SCENE {
            (self.has_new_land, self.scene_told) = (false, now);
            server.say(None, self.scene());
        }
        if !self.is_new || self.pages.is_empty() || now.duration_since(self.shown) < FRAME {
            return;
        }
        (self.is_new, self.shown) = (false, now);
        server.show(self.bytes.clone());
        if self.catches_up_to.is_none() {
            self.look_closer(server);
        }
    }

    /// What pages see beside the frame.
    fn look_closer(&self, server: &Server) {
        let mut robots = BTreeMap::new();
        let mut links = None;
        for (client, looks) in &self.pages {
            if let Some(index) = looks.robot {
                let robot = robots.entry(index).or_insert_with(|| self.robot(index));
                server.say(Some(*client), robot.clone());
            }
            if looks.links {
                let links = links.get_or_insert_with(|| self.links());
                server.say(Some(*client), links.clone());
            }
        }
    }

    fn wants_links(&self) -> bool {
        self.pages.values().any(|looks| looks.links)
    }

    fn hear(&mut self, word: FromPage, server: &Server) {
        match word {
            FromPage::Opened(client) => {
                self.pages.insert(client, Looks::default());
                self.begin_anew(Some(client), server);
                self.tell(server);
            }
            FromPage::Closed(client) => {
                self.pages.remove(&client);
                self.engine.log_receptions(self.wants_links());
            }
            FromPage::Said(client, text) => match Wanted::read(&text) {
                Ok(asked) if self.catches_up_to.is_some() && asked.needs_the_run() => {
                    self.deferred.push_back((client, asked));
                }
                Ok(asked) => self.answer(client, asked, server),
                Err(error) if error.is_json => server.say(Some(client), message::error(&error.text)),
                Err(_) => server.dismiss(client),
            },
        }
    }

    fn answer(&mut self, client: Client, asked: Wanted, server: &Server) {
        let error = |text: &str| server.say(Some(client), message::error(text));
        match asked {
            Wanted::Pause => self.pace.pause(),
            Wanted::Play => self.pace.play(),
            Wanted::Step => {
                self.pace.pause();
                self.advance(server);
            }
            Wanted::Speed { x } => self.pace.set_speed(x),
            Wanted::Seek { tick } => {
                self.pace.pause();
                self.go_back_to(tick.min(self.last_tick()));
                if let Some(frame) = self.memory.at(tick) {
                    self.bytes = frame.to_vec();
                    self.is_new = true;
                }
            }
            Wanted::Select { robot } => {
                let robot = robot.filter(|robot| *robot < self.scenario.robots.len());
                if let Some(looks) = self.pages.get_mut(&client) {
                    looks.robot = robot;
                }
                self.is_new = true;
            }
            Wanted::Links { on } => {
                if let Some(looks) = self.pages.get_mut(&client) {
                    looks.links = on;
                }
                self.engine.log_receptions(self.wants_links());
            }
            Wanted::Seen { frames } => server.seen(client, frames),
            Wanted::Save => {
                let hash = &self.frame.figures.hash;
                let text = text::saved(&self.text, &self.scenario, &self.done, self.tick, hash);
                server.say(Some(client), message::saved(&self.scenario.name, &text));
            }
            Wanted::Restart { seed } => {
                let seed = seed.unwrap_or(self.scenario.seed);
                let overrides = Overrides { seed: Some(seed), ticks: Some(self.scenario.ticks) };
                let (text, path) = (self.text.clone(), self.path.clone());
                if let Err(wrong) = self.replace(text, &path, &overrides, server) {
                    error(&wrong.to_string());
                }
            }
            Wanted::New { robots, goals, obstacles, seed } => {
                let text = Configuration { robots, goals, obstacles, seed }.scenario();
                if let Err(wrong) = self.replace(text, Path::new("new-run.toml"), &Overrides::default(), server) {
                    error(&wrong.to_string());
                }
            }
            Wanted::Order { order } => match order.intervention(&self.scenario, self.framer.origin_m()) {
                Err(wrong) => error(&wrong),
                Ok(what) => match self.engine.intervene(&what) {
                    Err(refusal) => error(&refusal.to_string()),
                    Ok(()) => self.note(what, server),
                },
            },
        }
        self.tell(server);
    }

    /// Takes note of what was done, and shows what has changed.
    fn note(&mut self, what: Intervention, server: &Server) {
        let tick = self.tick;
        self.done.retain(|(at, _)| *at <= tick);
        self.memory.forget_from(tick + 1);
        let changes_scene = !matches!(
            what,
            Intervention::Goal { .. }
                | Intervention::Waypoint { .. }
                | Intervention::Down { .. }
                | Intervention::Radio { .. }
        );
        self.done.push((tick, what));
        self.is_over = false;
        self.take_frame();
        if changes_scene {
            self.begin_anew(None, server);
        }
    }

    /// Another run for the same pages.
    fn replace(
        &mut self,
        text: String,
        path: &Path,
        overrides: &Overrides,
        server: &Server,
    ) -> Result<(), SessionError> {
        let mut fresh = Self::new(text, path, overrides, self.pace.is_paused())?;
        fresh.pages = self.pages.keys().map(|client| (*client, Looks::default())).collect();
        *self = fresh;
        self.begin_anew(None, server);
        Ok(())
    }

    /// The last tick that there is something to see of.
    fn last_tick(&self) -> u32 {
        self.memory.last().map_or(self.tick, |last| last.max(self.tick))
    }

    /// What a page must know before frames mean anything to it.
    fn begin_anew(&mut self, to: Option<Client>, server: &Server) {
        server.begin_anew(to, self.scene());
        self.has_new_land &= to.is_some();
        if let Some(rows) = self.rows(ROWS) {
            server.say(to, rows);
        }
        self.is_new = true;
        // Soon, not after the next frame's time.
        self.shown = self.shown.checked_sub(FRAME).unwrap_or(self.shown);
    }

    fn tell(&mut self, server: &Server) {
        self.told = Instant::now();
        server.say(None, self.state());
    }
}

#[cfg(test)]
mod tests;
