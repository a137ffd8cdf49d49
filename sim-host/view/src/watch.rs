//! Live pages of a run that they cannot control: `staya run --view`, hardware in the loop, the
//! MAVLink bridge and companions. Without a page the run pays nothing: the caller polls
//! [`Watcher::is_due`] and makes a frame only if a page wants one.

use crate::frame::{FrameData, Framer, NO_WAIT, NONE};
use crate::page;
use crate::scene::{Mode, Scene};
use crate::server::{Client, FromPage, Server, WORDS};
use crate::session::{FRAME, Looks, NotUnderstood, Wanted};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use serde_json::json;
use staya_console::WatchArgs;
use staya_console::say;
use staya_sim::engine::{Known, Moment};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const LONGEST: usize = 256;

/// Details of a robot beyond its row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Its neighbours as it knows them, in world coordinates; `None` if not available.
    pub known: Option<Vec<Known>>,
    /// Load of the device that runs its controller.
    pub device: Option<DeviceFigures>,
    /// Names and values of other details, as text.
    pub facts: Vec<(&'static str, String)>,
}

/// Load of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct DeviceFigures {
    /// Instructions of the last step; `None` before it, and on boards, which do not count them.
    pub instructions: Option<u64>,
    /// Instructions of the longest step.
    pub most_instructions: Option<u64>,
    /// Ticks of the device's clock in the last step.
    pub ticks: Option<u32>,
    /// Largest stack used by a step, bytes.
    pub stack: u32,
    /// Steps in which the device and its shadow differed.
    pub mismatches: u64,
    /// Steps decided by the device.
    pub steps: u64,
    /// Restarts of the device.
    pub resets: u64,
}

/// Details that a run provides beyond the rows of robots.
pub trait Insight {
    /// Details of a robot, by index.
    fn about(&self, _index: usize) -> About {
        About::default()
    }

    /// Whether the row of a robot is measured; otherwise it comes from beacons.
    fn is_measured(&self, _index: usize) -> bool {
        true
    }

    /// Pairs of sender and receiver that are in contact; `None` if not available.
    fn links(&self) -> Option<Vec<[u32; 2]>> {
        None
    }
}

impl Insight for () {}

/// Shows a run to pages.
#[derive(Debug)]
pub struct Watcher {
    server: Server,
    scene: String,
    ids: Vec<u32>,
    framer: Framer,
    frame: FrameData,
    bytes: Vec<u8>,
    pages: BTreeMap<Client, Looks>,
    shown: Instant,
}

impl Watcher {
    /// Starts a page if the options select one, and prints its address on standard error.
    ///
    /// # Errors
    /// The address is not available.
    pub fn by_options(options: &WatchArgs, scenario: &Scenario) -> anyhow::Result<Option<Self>> {
        let Some(address) = options.address() else {
            return Ok(None);
        };
        let watcher = Self::new(Server::start(address, page::served()?)?, scenario)?;
        say(&watcher.server().url());
        Ok(Some(watcher))
    }

    /// Creates a watcher for the run of a scenario.
    ///
    /// # Errors
    /// The scene cannot be encoded as JSON.
    pub fn new(server: Server, scenario: &Scenario) -> Result<Self, serde_json::Error> {
        let now = Instant::now();
        Ok(Self {
            server,
            scene: serde_json::to_string(&Scene::new(scenario, Mode::Watch))?,
            ids: scenario.robots.iter().map(|robot| robot.id.0).collect(),
            framer: Framer::new(scenario),
            frame: FrameData::default(),
            bytes: Vec::new(),
            pages: BTreeMap::new(),
            shown: now.checked_sub(FRAME).unwrap_or(now),
        })
    }

    /// The server of the pages.
    #[must_use]
    pub const fn server(&self) -> &Server {
        &self.server
    }

    /// Number of connected pages.
    #[must_use]
    pub fn pages(&self) -> usize {
        self.pages.len()
    }

    /// Handles a bounded number of page messages. Returns whether a page wants a frame now.
    pub fn is_due(&mut self) -> bool {
        for _ in 0..WORDS {
            let Some(word) = self.server.next(Duration::ZERO) else { break };
            self.hear(word);
        }
        !self.pages.is_empty() && self.shown.elapsed() >= FRAME
    }

    /// Offers a tick. `robots` is read only if a page wants a frame now.
    pub fn tick(&mut self, moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>) {
        if self.is_due() {
            self.show(moment, robots, &());
        }
    }

    /// Sends a frame to all pages. O(bodies).
    pub fn show(&mut self, moment: &Moment<'_>, robots: impl Iterator<Item = RobotRow>, insight: &dyn Insight) {
        self.shown = Instant::now();
        self.framer.fill(&mut self.frame, moment, robots);
        self.frame.encode(&mut self.bytes);
        self.server.show(self.bytes.clone());
        let tick = self.frame.tick;
        let state = json!({
            "type": "state", "paused": false, "speed": null, "tick": tick, "first": tick, "last": tick,
            "clients": self.pages.len(), "at_end": false,
        });
        self.server.say(None, state.to_string());
        let mut links = None;
        for (client, looks) in &self.pages {
            let robot = looks.robot.filter(|index| *index < self.ids.len());
            if let Some(index) = robot {
                self.server.say(Some(*client), self.robot(index, insight));
            }
            if looks.links
                && let Some(links) = links.get_or_insert_with(|| insight.links().map(|pairs| self.links(&pairs)))
            {
                self.server.say(Some(*client), links.clone());
            }
        }
    }

    fn hear(&mut self, word: FromPage) {
        match word {
            FromPage::Opened(client) => {
                self.pages.insert(client, Looks::default());
                self.server.send_scene(Some(client), self.scene.clone());
            }
            FromPage::Closed(client) => {
                self.pages.remove(&client);
            }
            FromPage::Said(client, text) => {
                let looks = self.pages.entry(client).or_default();
                match Wanted::read(&text) {
                    _ if text.len() > LONGEST => self.server.dismiss(client),
                    Ok(Wanted::Select { robot }) => looks.robot = robot,
                    Ok(Wanted::Links { on }) => looks.links = on,
                    Ok(Wanted::Seen { frames }) => self.server.seen(client, frames),
                    // Other requests are ignored.
                    Ok(_) | Err(NotUnderstood { is_json: true, .. }) => {}
                    Err(_) => self.server.dismiss(client),
                }
            }
        }
    }

    fn robot(&self, index: usize, insight: &dyn Insight) -> String {
        let frame = &self.frame;
        let About { known, device, facts } = insight.about(index);
        let neighbors = known.map(|known| {
            let known = known.iter().map(|known| self.neighbor(known, insight));
            known.collect::<Vec<_>>()
        });
        json!({
            "type": "robot",
            "index": index,
            "id": self.ids.get(index),
            "tick": frame.tick,
            "mode": frame.mode.get(index),
            "wait": frame.wait.get(index).filter(|wait| **wait != NO_WAIT),
            "leader": frame.leader.get(index).filter(|leader| **leader != NONE),
            "neighbors": neighbors,
            "device": device,
            "facts": facts,
        })
        .to_string()
    }

    fn neighbor(&self, known: &Known, insight: &dyn Insight) -> serde_json::Value {
        let origin_m = self.framer.origin_m();
        let position_m = [0, 1, 2].map(|axis| known.position_m[axis] - origin_m[axis]);
        let index = self.ids.binary_search(&known.id.0).ok();
        let truth_m =
            index.filter(|index| insight.is_measured(*index)).and_then(|index| self.frame.position_m.get(index));
        let error_m = truth_m.map(|truth_m| {
            let off = [0, 1, 2].map(|axis| position_m[axis] - f64::from(truth_m[axis]));
            libm::sqrt(off.iter().map(|x| x * x).sum())
        });
        json!({
            "id": known.id.0, "index": index, "position_m": position_m, "velocity_mps": known.velocity_mps,
            "age_s": known.age_s, "error_m": error_m,
        })
    }

    fn links(&self, pairs: &[[u32; 2]]) -> String {
        let bytes: Vec<u8> = pairs.iter().flat_map(|[from, to]| [*from, to << 2]).flat_map(u32::to_le_bytes).collect();
        json!({ "type": "links", "tick": self.frame.tick, "pairs": BASE64_STANDARD.encode(bytes) }).to_string()
    }
}

#[cfg(test)]
mod tests;
