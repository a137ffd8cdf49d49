//! An interactive run; [`Session::run`] is its loop.
//!
//! The engine runs in the calling thread and never waits for pages. Each action of a page is an
//! [`Intervention`](staya_sim::scenario::Intervention) before the next tick, so the run is
//! reproducible bit for bit: to go back in time, the engine restarts and repeats all ticks. An
//! action in the past makes a new branch; the old one keeps its later actions and frames.

mod branch;
mod memory;
mod message;
mod text;

pub(crate) use message::{Looks, NotUnderstood, Wanted, trail};

use crate::frame::{FrameData, Framer};
use crate::mind::Events;
use crate::pace::{Pace, SLICE};
use crate::server::{Client, FromPage, Server, WORDS};
use anyhow::Result;
use branch::{Branch, Branches, changes_scene};
use staya_console::say;
use staya_record::claims::{Claim, claims};
use staya_sim::engine::{Engine, operated};
use staya_sim::scenario::{Overrides, Scenario};
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

pub(crate) const FRAME: Duration = Duration::from_millis(16);
pub(crate) const STATE: Duration = Duration::from_millis(500);
const SCENE: Duration = Duration::from_millis(250);
const FIGURES: Duration = Duration::from_millis(100);
/// Ticks of one request for past positions.
pub(crate) const TRAIL: usize = 240;
/// Limit of deferred requests; the page that sends another one is disconnected.
const DEFERRED: usize = 256;

/// A run and its pages.
pub struct Session {
    text: String,
    path: PathBuf,
    scenario: Scenario,
    engine: Engine,
    tick: u32,
    framer: Framer,
    frame: FrameData,
    bytes: Vec<u8>,
    branch: Branch,
    branches: Branches,
    events: Events,
    pace: Pace,
    /// The engine repeats the run up to this tick after a seek.
    catches_up_to: Option<u32>,
    /// The engine runs on to this tick without regard to the clock.
    runs_on_to: Option<u32>,
    /// Requests that wait for the end of the repetition.
    deferred: VecDeque<(Client, Wanted)>,
    /// Without any distance to go, only the last tick ends the run.
    has_work: bool,
    is_over: bool,
    pages: BTreeMap<Client, Looks>,
    claims: Vec<Claim>,
    is_new: bool,
    has_new_land: bool,
    logs_links: bool,
    scene_told: Instant,
    shown: Instant,
    told: Instant,
    figures_told: Instant,
}

impl Session {
    /// Loads a scenario from `text`; errors and relative paths refer to `path`.
    ///
    /// # Errors
    /// The scenario is invalid, or its robots cannot be placed.
    pub fn new(text: String, path: &Path, overrides: &Overrides, is_paused: bool) -> Result<Self> {
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
            branch: Branch::default(),
            branches: Branches::default(),
            events: Events::default(),
            catches_up_to: None,
            runs_on_to: None,
            deferred: VecDeque::new(),
            has_work: false,
            is_over: false,
            pages: BTreeMap::new(),
            claims: known_claims(path),
            is_new: true,
            has_new_land: false,
            logs_links: false,
            scene_told: now,
            shown: now,
            told: now,
            figures_told: now,
        };
        session.take_frame();
        Ok(session)
    }

    /// Sets the initial speed, simulated seconds per second; `None` for no limit.
    pub fn set_speed(&mut self, speed: Option<f64>) {
        self.pace.set_speed(speed);
    }

    /// Runs and serves pages until `stop` returns true.
    pub fn run(mut self, server: &Server, stop: &dyn Fn() -> bool) {
        while !stop() {
            let now = Instant::now();
            let is_busy = self.catches_up_to.is_some() || self.runs_on_to.is_some();
            let rest = if is_busy { Some(Duration::ZERO) } else { self.pace.until_due(now) };
            let mut patience = rest.unwrap_or(STATE).min(STATE / 10);
            for _ in 0..WORDS {
                let Some(word) = server.next(patience) else { break };
                self.hear(word, server);
                patience = Duration::ZERO;
                if stop() {
                    return;
                }
            }
            self.work(server);
            self.show(server);
        }
    }

    fn work(&mut self, server: &Server) {
        let start = Instant::now();
        while start.elapsed() < SLICE {
            if let Some(goal) = self.catches_up_to {
                self.repeat(goal, server);
                continue;
            }
            if let Some(goal) = self.runs_on_to {
                self.advance(server);
                if self.tick >= goal || self.is_over {
                    self.runs_on_to = None;
                    self.tell(server);
                }
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

    fn advance(&mut self, server: &Server) {
        self.step();
        self.take_frame_if_new();
        let is_over = self.is_at_end();
        if is_over && !self.is_over {
            self.pace.pause();
            self.tell(server);
        }
        self.is_over = is_over;
    }

    fn is_at_end(&self) -> bool {
        self.tick >= self.scenario.ticks || (self.has_work && self.engine.is_over())
    }

    fn step(&mut self) {
        self.has_new_land |= self.scenario.land.changes.iter().any(|rule| rule.is_due(self.tick));
        self.engine.step();
        self.tick += 1;
        self.repeat_orders();
        self.has_work |= !self.engine.is_over();
        for index in 0..self.scenario.robots.len() {
            self.events.add(&self.engine, index, self.tick);
        }
    }

    /// Applies the orders that were given at this tick before.
    fn repeat_orders(&mut self) {
        for (_, what) in self.branch.done.iter().filter(|(tick, _)| *tick == self.tick) {
            let _ = self.engine.intervene(what);
            self.has_new_land |= changes_scene(what);
        }
    }

    fn repeat(&mut self, goal: u32, server: &Server) {
        if self.tick + 1 >= goal {
            self.log_links();
        }
        if self.tick < goal {
            return self.step();
        }
        self.catches_up_to = None;
        self.is_over = self.is_at_end();
        self.take_frame_if_new();
        self.send_scene(None, server);
        while let Some((client, asked)) = self.deferred.pop_front() {
            self.answer(client, asked, server);
            if self.catches_up_to.is_some() {
                return;
            }
        }
    }

    fn go_to(&mut self, tick: u32) {
        if tick < self.tick {
            self.start_again(tick);
        } else if tick > self.tick || self.catches_up_to.is_some() {
            self.catches_up_to = Some(tick);
        }
    }

    /// Repeats the run from its start up to `tick`.
    fn start_again(&mut self, tick: u32) {
        let Ok(engine) = operated(&self.scenario) else { return };
        (self.engine, self.tick, self.has_work, self.logs_links) = (engine, 0, false, false);
        self.events.clear();
        self.repeat_orders();
        self.catches_up_to = Some(tick);
    }

    fn take_frame_if_new(&mut self) {
        if self.branch.memory.last() < Some(self.tick) {
            self.take_frame();
        } else {
            self.take_frame_of_past();
        }
    }

    fn take_frame(&mut self) {
        self.take_frame_of_past();
        self.branch.memory.put(self.tick, &self.bytes);
        self.branch.series.put(self.tick, &self.frame.figures);
    }

    /// The present frame, while later ones are stored.
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
        if now.duration_since(self.figures_told) >= FIGURES {
            self.tell_figures(server);
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

    /// Logs the links of the next ticks if a page wants them. Returns whether they were not logged.
    fn log_links(&mut self) -> bool {
        let wants_links = self.pages.values().any(|looks| looks.links);
        let is_new = wants_links && !self.logs_links;
        if wants_links != self.logs_links {
            self.logs_links = wants_links;
            self.engine.log_receptions(wants_links);
        }
        is_new
    }

    fn hear(&mut self, word: FromPage, server: &Server) {
        match word {
            FromPage::Opened(client) => {
                self.pages.insert(client, Looks::default());
                self.send_scene(Some(client), server);
                server.say(Some(client), self.orders());
                self.tell(server);
                server.say(Some(client), self.branch.series.all());
            }
            FromPage::Closed(client) => {
                self.pages.remove(&client);
                self.log_links();
            }
            FromPage::Said(client, text) => match Wanted::read(&text) {
                // A later seek replaces the one that is under way.
                Ok(asked @ Wanted::Seek { .. }) if self.deferred.is_empty() => self.answer(client, asked, server),
                Ok(asked) if self.catches_up_to.is_some() && asked.needs_the_run() => {
                    if self.deferred.len() < DEFERRED {
                        self.deferred.push_back((client, asked));
                    } else {
                        server.dismiss(client);
                    }
                }
                Ok(asked) => self.answer(client, asked, server),
                Err(error) if error.is_json => server.say(Some(client), message::error(&error.text)),
                Err(_) => server.dismiss(client),
            },
        }
    }

    fn answer(&mut self, client: Client, asked: Wanted, server: &Server) {
        let error = |text: &str| server.say(Some(client), message::error(text));
        if asked.needs_the_run() {
            self.runs_on_to = None;
        }
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
                let known = tick.min(self.last_tick());
                self.runs_on_to = (tick > known).then_some(tick);
                self.show_past(known);
                self.go_to(known);
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
                // The links of the last tick are known only if they were logged before it.
                if self.log_links() && self.pace.is_paused() && self.catches_up_to.is_none() {
                    self.start_again(self.tick);
                }
                self.is_new = true;
            }
            Wanted::Trail { ticks, branch } => {
                let trail = self.trail(&ticks[..ticks.len().min(TRAIL)], branch);
                return server.say(Some(client), trail);
            }
            Wanted::Branch { number } => match self.branches.take(number) {
                Some(branch) => {
                    let old = std::mem::replace(&mut self.branch, branch);
                    self.branches.put(old);
                    self.show_branch(self.tick.min(self.last_stored()), server);
                }
                None => error(&format!("there is no branch {number}; reload the page")),
            },
            Wanted::Undo => match self.branches.undo(&mut self.branch) {
                Some(tick) => self.show_branch(tick, server),
                None => error("there is no change to undo"),
            },
            Wanted::Seen { frames } => server.seen(client, frames),
            Wanted::Save => {
                let hash = &self.frame.figures.hash;
                let text = text::saved(&self.text, &self.scenario, &self.branch, self.tick, hash);
                server.say(Some(client), message::saved(&self.scenario.name, &self.branch, &text));
            }
            Wanted::Restart { seed } => {
                let seed = seed.unwrap_or(self.scenario.seed);
                let overrides = Overrides { seed: Some(seed), ticks: Some(self.scenario.ticks) };
                let (text, path) = (self.text.clone(), self.path.clone());
                if let Err(wrong) = self.replace(text, &path, &overrides, server) {
                    error(&wrong.to_string());
                }
            }
            Wanted::New(configuration) => {
                let (path, none) = (Path::new("new-run.toml"), Overrides::default());
                let text = configuration.scenario();
                if let Err(wrong) = text.and_then(|text| self.replace(text, path, &none, server)) {
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

    fn replace(&mut self, text: String, path: &Path, overrides: &Overrides, server: &Server) -> Result<()> {
        let mut fresh = Self::new(text, path, overrides, self.pace.is_paused())?;
        fresh.pages = self.pages.keys().map(|client| (*client, Looks::default())).collect();
        *self = fresh;
        self.send_scene(None, server);
        server.say(None, self.orders());
        Ok(())
    }

    fn last_stored(&self) -> u32 {
        self.branch.memory.last().unwrap_or_default()
    }

    fn last_tick(&self) -> u32 {
        self.last_stored().max(self.tick)
    }

    /// Frames have no meaning without scene and state.
    fn send_scene(&mut self, to: Option<Client>, server: &Server) {
        server.send_scene(to, self.scene());
        self.has_new_land &= to.is_some();
        self.is_new = true;
        // The next frame comes soon rather than after the usual interval.
        self.shown = self.shown.checked_sub(FRAME).unwrap_or(self.shown);
    }

    fn tell(&mut self, server: &Server) {
        self.told = Instant::now();
        server.say(None, self.state());
        self.tell_figures(server);
    }

    fn tell_figures(&mut self, server: &Server) {
        self.figures_told = Instant::now();
        if self.branch.series.has_unsent() {
            server.say(None, self.branch.series.unsent());
        }
    }
}

/// A damaged plan does not keep its scenario from being shown.
fn known_claims(path: &Path) -> Vec<Claim> {
    claims(path).unwrap_or_else(|error| {
        say(&format!("the page shows no claims of the figure: {error}"));
        Vec::new()
    })
}

#[cfg(test)]
mod tests;
