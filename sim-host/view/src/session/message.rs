//! JSON messages between a session and its pages (`PROTOCOL.md`).

use super::Session;
use super::branch::Branch;
use super::text::Configuration;
use crate::frame::FrameData;
use crate::mind;
use crate::scene::{self, Mode, Scene};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Deserialize;
use serde_json::{Value, json};
use staya_sim::scenario::{Intervention, Scenario};
use staya_sim::world::plane::Shape;

/// The robot and the links of which a page gets details.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Looks {
    pub robot: Option<usize>,
    pub links: bool,
}

/// A request of a page. Pages that only watch make some of them.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Wanted {
    Pause,
    Play,
    Step,
    Speed { x: Option<f64> },
    Seek { tick: u32 },
    Select { robot: Option<usize> },
    Links { on: bool },
    Trail { ticks: Vec<u32>, branch: Option<u32> },
    Branch { number: u32 },
    Undo,
    Seen { frames: u64 },
    Save,
    Restart { seed: Option<u64> },
    New(Configuration),
    Order { order: Order },
}

#[derive(Clone, Debug)]
pub(crate) struct NotUnderstood {
    pub text: String,
    /// If not, the sender is not a page.
    pub is_json: bool,
}

impl Wanted {
    pub fn read(text: &str) -> Result<Self, NotUnderstood> {
        match serde_json::from_str(text) {
            Ok(wanted) => Ok(wanted),
            Err(error) => {
                let is_json = serde_json::from_str::<serde_json::Map<String, Value>>(text).is_ok();
                Err(NotUnderstood { text: format!("invalid request: {error}; reload the page"), is_json })
            }
        }
    }

    /// Whether the request needs the engine at the shown moment.
    pub const fn needs_the_run(&self) -> bool {
        !matches!(self, Wanted::Select { .. } | Wanted::Links { .. } | Wanted::Trail { .. } | Wanted::Seen { .. })
    }
}

/// Robots by index, positions relative to the scene's origin.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Order(serde_json::Map<String, Value>);

impl Order {
    /// Converts to robot numbers and world coordinates.
    pub fn intervention(mut self, scenario: &Scenario, origin_m: [f64; 3]) -> Result<Intervention, String> {
        if let Some(index) = self.0.get("robot").filter(|index| !index.is_null()) {
            let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
            let robot = index.and_then(|index| scenario.robots.get(index));
            let robot = robot.ok_or("unknown robot; select another one")?;
            self.0.insert("robot".to_owned(), robot.id.0.into());
        }
        // JSON has no infinity, so null means "no limit".
        if self.0.get("range_m").is_some_and(Value::is_null) {
            self.0.remove("range_m");
            self.0.insert("no_limit".to_owned(), true.into());
        }
        let no_limit = self.0.remove("no_limit").is_some();
        let intervention = serde_json::from_value(Value::Object(self.0));
        let mut intervention = intervention.map_err(|error| format!("invalid order: {error}"))?;
        let near = |place_m: &mut [f64; 3]| (0..3).for_each(|axis| place_m[axis] += origin_m[axis]);
        let flat = |place_m: &mut [f64; 2]| (0..2).for_each(|axis| place_m[axis] += origin_m[axis]);
        match &mut intervention {
            Intervention::Goal { place_m, .. } | Intervention::Waypoint { place_m, .. } => near(place_m),
            Intervention::Radio { range_m, .. } if no_limit => *range_m = Some(f64::INFINITY),
            Intervention::Solid { solid } => match solid {
                Shape::Circle { center_m, .. } => flat(center_m),
                Shape::Segment { from_m, to_m } => [from_m, to_m].into_iter().for_each(flat),
                Shape::Polygon { points_m } => points_m.iter_mut().for_each(flat),
                Shape::Ball { center_m, .. } => near(center_m),
            },
            _ => {}
        }
        Ok(intervention)
    }
}

pub(super) fn error(text: &str) -> String {
    json!({ "type": "error", "text": text }).to_string()
}

pub(super) fn saved(name: &str, branch: &Branch, text: &str) -> String {
    let number = branch.number;
    let file = if number > 1 { format!("{name}-branch-{number}.toml") } else { format!("{name}-by-hand.toml") };
    json!({ "type": "saved", "name": file, "branch": number, "orders": branch.done.len(), "text": text }).to_string()
}

/// The positions of frames, each with the tick for which a page asked.
pub(crate) fn trail<'a>(branch: Option<u32>, frames: impl Iterator<Item = (u32, &'a [u8])>) -> String {
    let rows = frames.filter_map(|(tick, frame)| {
        let (_, positions) = FrameData::positions_of(frame).ok()?;
        Some(json!([tick, BASE64_STANDARD.encode(positions)]))
    });
    json!({ "type": "trail", "branch": branch, "rows": rows.collect::<Vec<_>>() }).to_string()
}

impl Session {
    pub(super) fn scene(&mut self) -> String {
        let origin_m = self.framer.origin_m();
        let mut parameters: Vec<scene::Parameter> = Vec::new();
        for (row, value) in (0..self.scenario.robots.len()).flat_map(|index| self.engine.parameters(index)) {
            if parameters.iter().all(|known| known.name != row.name) {
                parameters.push(scene::Parameter {
                    name: row.name.to_owned(),
                    unit: row.unit.to_owned(),
                    least: row.range[0].into(),
                    greatest: row.range[1].into(),
                    value: Some(value.into()),
                    what: row.what.to_owned(),
                });
            }
        }
        let is_in_space = scene::is_in_space(&self.scenario);
        let scene = Scene {
            land: self.engine.view().terrain.map(|land| scene::land(land, origin_m)),
            solids: scene::solids(self.engine.view().solids, is_in_space, origin_m),
            parameters,
            radio: self.radio(),
            description: scene::description(&self.text),
            claims: self.claims.clone(),
            ..Scene::new(&self.scenario, Mode::Live)
        };
        json!(scene).to_string()
    }

    fn radio(&self) -> scene::Radio {
        let mut radio = scene::Radio::of(&self.scenario);
        let planned = self.scenario.events.interventions.iter().filter(|(tick, _)| *tick < self.tick);
        for (_, what) in planned.chain(self.branch.done.iter().filter(|(tick, _)| *tick <= self.tick)) {
            if let Intervention::Radio { loss, range_m } = what {
                radio.loss = loss.unwrap_or(radio.loss);
                if let Some(range_m) = range_m {
                    radio.range_m = Some(*range_m).filter(|range_m| range_m.is_finite());
                }
            }
        }
        radio
    }

    pub(super) fn state(&self) -> String {
        let mut branches: Vec<&Branch> = self.branches.iter().chain([&self.branch]).collect();
        branches.sort_unstable_by_key(|branch| branch.number);
        let branches = branches.iter().map(|branch| {
            let last = branch.memory.last().unwrap_or_default();
            json!({ "number": branch.number, "from": branch.from, "last": last, "orders": branch.done.len() })
        });
        json!({
            "type": "state",
            "paused": self.pace.is_paused() && self.runs_on_to.is_none(),
            "speed": self.pace.speed(),
            "tick": self.catches_up_to.unwrap_or(self.tick),
            "first": 0,
            "last": self.last_tick(),
            "clients": self.pages.len(),
            "at_end": self.is_over,
            "radio": self.radio(),
            "branch": self.branch.number,
            "branches": branches.collect::<Vec<_>>(),
        })
        .to_string()
    }

    /// The planned orders and those of pages.
    pub(super) fn orders(&self) -> String {
        let orders = self.scenario.events.interventions.iter().chain(&self.branch.done).map(|(tick, what)| {
            let kind = serde_json::to_value(what).map(|mut what| what["kind"].take());
            json!({ "tick": tick, "order": { "kind": kind.unwrap_or_default() } })
        });
        json!({ "type": "orders", "orders": orders.collect::<Vec<_>>() }).to_string()
    }

    /// Past positions, of another branch by its number.
    pub(super) fn trail(&self, ticks: &[u32], branch: Option<u32>) -> String {
        let other = branch.and_then(|number| self.branches.iter().find(|branch| branch.number == number));
        let memory = &other.unwrap_or(&self.branch).memory;
        trail(branch, ticks.iter().filter_map(|&tick| Some((tick, memory.at(tick)?))))
    }

    pub(super) fn links(&self) -> String {
        let pairs = mind::links(&self.engine, &self.scenario, None);
        json!({ "type": "links", "tick": self.tick, "pairs": pairs }).to_string()
    }

    pub(super) fn robot(&self, index: usize) -> String {
        let origin_m = self.framer.origin_m();
        mind::robot(&self.engine, &self.scenario, origin_m, &self.events, (self.tick, index)).to_string()
    }
}
