//! A run that goes on by itself, and pages that look at it: with devices, over a bridge, or for its results.

use crate::frame::{FrameData, Framer};
use crate::scene::{Mode, Scene};
use crate::server::{FromPage, Server};
use serde_json::json;
use staya_sim::engine::Moment;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::time::{Duration, Instant};

/// Least time between two frames.
const FRAME: Duration = Duration::from_millis(16);

/// Shows pages what comes by.
#[derive(Debug)]
pub struct Watcher {
    server: Server,
    scene: String,
    framer: Framer,
    frame: FrameData,
    bytes: Vec<u8>,
    pages: usize,
    shown: Instant,
}

impl Watcher {
    /// For the run of a scenario.
    ///
    /// # Errors
    /// The scene has no form as JSON.
    pub fn new(server: Server, scenario: &Scenario) -> Result<Self, serde_json::Error> {
        Ok(Self {
            server,
            scene: serde_json::to_string(&Scene::new(scenario, Mode::Watch))?,
            framer: Framer::new(scenario),
            frame: FrameData::default(),
            bytes: Vec::new(),
            pages: 0,
            shown: Instant::now(),
        })
    }

    /// The address of the page.
    #[must_use]
    pub fn url(&self) -> String {
        self.server.url()
    }

    /// Looks at a tick; `robots` are asked for only if a page wants to see them now. O(1) otherwise.
    pub fn tick(&mut self, moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>) {
        while let Some(word) = self.server.next(Duration::ZERO) {
            match word {
                FromPage::Opened(client) => {
                    self.pages += 1;
                    self.server.begin_anew(Some(client), self.scene.clone());
                }
                FromPage::Closed(_) => self.pages -= 1,
                FromPage::Said(client, text) => {
                    let seen = serde_json::from_str::<serde_json::Value>(&text);
                    let frames = seen.ok().and_then(|seen| seen.get("frames")?.as_u64());
                    frames.into_iter().for_each(|frames| self.server.seen(client, frames));
                }
            }
        }
        let now = Instant::now();
        if self.pages == 0 || now.duration_since(self.shown) < FRAME {
            return;
        }
        self.shown = now;
        self.framer.fill(&mut self.frame, moment, robots);
        self.frame.encode(&mut self.bytes);
        self.server.show(self.bytes.clone());
        let tick = moment.row.tick;
        let state = json!({
            "type": "state", "paused": false, "speed": null, "tick": tick, "first": tick, "last": tick,
            "clients": self.pages, "at_end": false,
        });
        self.server.say(None, state.to_string());
    }
}
