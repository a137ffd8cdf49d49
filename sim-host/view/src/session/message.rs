//! JSON messages between a session and its pages (`PROTOCOL.md`).

use super::Session;
use crate::frame::FrameData;
use crate::scene::{self, Mode, Scene};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Deserialize;
use serde_json::{Value, json};
use staya_controller::agent::Event;
use staya_controller::robot::RobotId;
use staya_sim::engine::{Choice, Inspection, Permitted, SeenLand};
use staya_sim::radio::Reception;
use staya_sim::scenario::{Intervention, Scenario};
use staya_sim::world::plane::Shape;

const LINKS: usize = 20_000;

#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Wanted {
    Pause,
    Play,
    Step,
    Speed { x: Option<f64> },
    Seek { tick: u32 },
    Select { robot: Option<usize> },
    Links { on: bool },
    Seen { frames: u64 },
    Save,
    Restart { seed: Option<u64> },
    New { robots: u32, goals: u32, obstacles: u32, seed: u64 },
    Order { order: Order },
}

#[derive(Clone, Debug)]
pub(super) struct NotUnderstood {
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
        !matches!(self, Wanted::Select { .. } | Wanted::Links { .. } | Wanted::Seen { .. })
    }
}

/// Robots by index, positions relative to the scene's origin.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Order(serde_json::Map<String, Value>);

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

pub(super) fn saved(name: &str, text: &str) -> String {
    json!({ "type": "saved", "name": format!("{name}-by-hand.toml"), "text": text }).to_string()
}

pub(super) fn event(event: &Event) -> String {
    match event {
        Event::ModeChanged { from, to } => format!("{from:?} → {to:?}").to_lowercase(),
        Event::NoRoute => "no open route".to_owned(),
        Event::TargetMoved { from, to } => format!("target ({}, {}) → ({}, {})", from.x, from.y, to.x, to.y),
        Event::MessageExpired(id) => format!("no answer from robot {id}"),
        Event::NeighborFound(id) => format!("robot {id} found"),
        Event::NeighborLost(id) => format!("robot {id} lost"),
        Event::NeighborEvicted(id) => format!("no room for robot {id}"),
        Event::NeighborRebooted(id) => format!("robot {id} restarted"),
        Event::ContactLost => "contact to all robots lost".to_owned(),
        Event::DuplicateId(id) => format!("two robots use number {id}"),
        Event::Implausible { id, claim } => format!("robot {id} reports implausible {claim}"),
        Event::Muted => "cannot send: counters or timestamps used up; give a new key".to_owned(),
    }
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
            ..Scene::new(&self.scenario, Mode::Live)
        };
        json!(scene).to_string()
    }

    fn radio(&self) -> scene::Radio {
        let mut radio = scene::Radio::of(&self.scenario);
        let planned = self.scenario.interventions.iter().filter(|(tick, _)| *tick < self.tick);
        for (_, what) in planned.chain(self.done.iter().filter(|(tick, _)| *tick <= self.tick)) {
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
        json!({
            "type": "state",
            "paused": self.pace.is_paused(),
            "speed": self.pace.speed(),
            "tick": self.catches_up_to.unwrap_or(self.tick),
            "first": 0,
            "last": self.last_tick(),
            "clients": self.pages.len(),
            "at_end": self.is_over,
            "radio": self.radio(),
        })
        .to_string()
    }

    /// `None` before the first tick.
    pub(super) fn rows(&self, most: usize) -> Option<String> {
        let frames = self.memory.some(most).filter_map(|bytes| FrameData::figures_of(bytes).ok());
        let rows: Vec<_> = frames.map(|(tick, figures)| json!([tick, figures])).collect();
        (rows.len() > 1).then(|| json!({ "type": "figures", "rows": rows }).to_string())
    }

    pub(super) fn links(&self) -> String {
        let robots = &self.scenario.robots;
        let index_of = |id: RobotId| robots.binary_search_by_key(&id, |robot| robot.id).ok();
        let mut pairs = Vec::new();
        for to in 0..robots.len() {
            for (sender, reception) in self.engine.receptions(to) {
                let Some(from) = index_of(*sender) else { continue };
                let fate = match reception {
                    Reception::Delivered => 0,
                    Reception::Lost => 1,
                    Reception::Damaged => 2,
                };
                pairs.extend((from as u32).to_le_bytes());
                pairs.extend(((to as u32) << 2 | fate).to_le_bytes());
                if pairs.len() >= LINKS * 8 {
                    break;
                }
            }
        }
        json!({ "type": "links", "tick": self.tick, "pairs": BASE64_STANDARD.encode(pairs) }).to_string()
    }

    pub(super) fn robot(&self, index: usize) -> String {
        let observation = self.engine.observation(index);
        let Inspection { known, plan, land, choice, parameters, sent_bytes, heard_bytes } = self.engine.inspect(index);
        let origin_m = self.framer.origin_m();
        let robots = &self.scenario.robots;
        let index_of = |id: RobotId| robots.binary_search_by_key(&id, |robot| robot.id).ok();
        let neighbors = known.iter().map(|known| {
            let other = index_of(known.id);
            let error_m = other.map(|other| {
                let truth_m = self.engine.observation(other).motion.position_m;
                let off = [0, 1, 2].map(|axis| known.position_m[axis] - truth_m[axis]);
                libm::sqrt(off.iter().map(|x| x * x).sum())
            });
            let position_m = [0, 1, 2].map(|axis| known.position_m[axis] - origin_m[axis]);
            json!({
                "id": known.id.0, "index": other, "position_m": position_m, "velocity_mps": known.velocity_mps,
                "age_s": known.age_s, "error_m": error_m,
            })
        });
        let plan =
            plan.iter().filter_map(|&(id, cell)| Some(json!({ "index": index_of(id)?, "cell": [cell.x, cell.y] })));
        let parameters = parameters.iter().map(|(parameter, value)| (parameter.name.to_owned(), json!(value)));
        let events = self.events.get(&index).into_iter().flatten();
        let status = observation.status;
        json!({
            "type": "robot",
            "index": index,
            "id": robots[index].id.0,
            "tick": self.tick,
            "mode": status.mode as u8,
            "wait": status.wait.map(|wait| wait as u8),
            "leader": index_of(status.leader),
            "boot": observation.boot,
            "up": observation.is_up,
            "wish": choice.as_ref().map(|choice| choice.wish_mps),
            "neighbors": neighbors.collect::<Vec<_>>(),
            "plan": plan.collect::<Vec<_>>(),
            "window": land.map(|land| window(&land)),
            "orca": choice.map(|choice| orca(&choice)),
            "events": events.map(|(tick, text)| json!({ "tick": tick, "text": text })).collect::<Vec<_>>(),
            "sent": sent_bytes,
            "heard": heard_bytes,
            "parameters": parameters.collect::<serde_json::Map<_, _>>(),
            "device": null,
        })
        .to_string()
    }
}

fn window(land: &SeenLand) -> Value {
    let costs: Vec<u8> = land.costs.iter().flat_map(|cost| cost.to_le_bytes()).collect();
    json!({
        "corner": [land.corner.x, land.corner.y],
        "side": land.width,
        "cells": BASE64_STANDARD.encode(&land.cells),
        "costs": BASE64_STANDARD.encode(costs),
    })
}

/// In space, the section at the chosen vertical velocity.
fn orca(choice: &Choice) -> Value {
    let flat = |v: [f32; 3]| [v[0], v[1]];
    let lines = choice.permitted.iter().filter_map(|permitted| {
        let (point, normal) = section(permitted, choice.chosen_mps[2])?;
        Some(json!({ "point": point, "normal": normal, "hard": permitted.is_of_obstacle }))
    });
    json!({
        "preferred_mps": flat(choice.wish_mps),
        "chosen_mps": flat(choice.chosen_mps),
        "max_speed_mps": choice.max_speed_mps,
        "lines": lines.collect::<Vec<_>>(),
    })
}

/// A point of the border and the unit vector into the half-space; `None` without a border there.
fn section(permitted: &Permitted, climb_mps: f32) -> Option<([f32; 2], [f32; 2])> {
    let Permitted { point_mps: [px, py, pz], normal: [nx, ny, nz], .. } = *permitted;
    let length = libm::hypotf(nx, ny);
    let is_level = length < 1e-3;
    let off = nz * (pz - climb_mps) / length;
    (!is_level).then(|| {
        let normal = [nx / length, ny / length];
        ([px + normal[0] * off, py + normal[1] * off], normal)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_equals_the_half_space_at_its_climb() {
        let plane = Permitted { point_mps: [0.3, -0.2, 0.0], normal: [0.6, 0.8, 0.0], is_of_obstacle: false };
        assert_eq!(section(&plane, 0.7), Some(([0.3, -0.2], [0.6, 0.8])));
        let space = Permitted { point_mps: [0.1, 0.2, 0.3], normal: [0.48, 0.36, 0.8], is_of_obstacle: false };
        for climb in [-0.5, 0.0, 0.3, 1.0] {
            let (point, normal) = section(&space, climb).expect("it cuts");
            assert!((libm::hypotf(normal[0], normal[1]) - 1.0).abs() < 1e-6);
            let off = (point[0] - 0.1) * 0.48 + (point[1] - 0.2) * 0.36 + (climb - 0.3) * 0.8;
            assert!(off.abs() < 1e-6, "{off}");
        }
        let floor = Permitted { point_mps: [0.0; 3], normal: [0.0, 0.0, 1.0], is_of_obstacle: true };
        assert_eq!(section(&floor, 1.0), None);
    }
}
