//! A robot's knowledge and next decision: the messages `robot` and `links` of `PROTOCOL.md`.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use staya_controller::agent::Event;
use staya_controller::robot::RobotId;
use staya_sim::engine::{Choice, Engine, Inspection, Permitted, SeenLand};
use staya_sim::radio::Reception;
use staya_sim::scenario::Scenario;
use std::collections::{HashMap, VecDeque};

/// Stored events of a robot.
const EVENTS: usize = 20;
/// Packets of one message.
const LINKS: usize = 20_000;
/// Recorded minds have this many digits after the point.
const DIGITS: f64 = 1e4;

/// The last 20 events of each robot with their ticks.
#[derive(Clone, Debug, Default)]
pub struct Events(HashMap<usize, VecDeque<(u32, String)>>);

impl Events {
    /// Adds the events of robot `index` in the step to `tick`.
    pub fn add(&mut self, engine: &Engine, index: usize, tick: u32) {
        for event in engine.events(index) {
            let events = self.0.entry(index).or_default();
            if events.len() >= EVENTS {
                events.pop_front();
            }
            events.push_back((tick, text(event)));
        }
    }

    /// Forgets all events.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

fn text(event: &Event) -> String {
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

/// The message `robot` about robot `index` of a scenario at `tick`; positions are relative to
/// `origin_m`. O(neighbours).
#[must_use]
pub fn robot(
    engine: &Engine,
    scenario: &Scenario,
    origin_m: [f64; 3],
    events: &Events,
    (tick, index): (u32, usize),
) -> Value {
    let observation = engine.observation(index);
    let Inspection { known, plan, land, choice, parameters, sent_bytes, heard_bytes } = engine.inspect(index);
    let index_of = |id: RobotId| index_of(scenario, id);
    let neighbors = known.iter().map(|known| {
        let other = index_of(known.id);
        let error_m = other.map(|other| {
            let truth_m = engine.observation(other).motion.position_m;
            let off = [0, 1, 2].map(|axis| known.position_m[axis] - truth_m[axis]);
            libm::sqrt(off.iter().map(|x| x * x).sum())
        });
        let position_m = [0, 1, 2].map(|axis| known.position_m[axis] - origin_m[axis]);
        json!({
            "id": known.id.0, "index": other, "position_m": position_m, "velocity_mps": known.velocity_mps,
            "age_s": known.age_s, "error_m": error_m,
        })
    });
    let plan = plan.iter().filter_map(|&(id, cell)| Some(json!({ "index": index_of(id)?, "cell": [cell.x, cell.y] })));
    let parameters = parameters.iter().map(|(parameter, value)| (parameter.name.to_owned(), json!(value)));
    let events = events.0.get(&index).into_iter().flatten();
    let status = observation.status;
    json!({
        "type": "robot",
        "index": index,
        "id": scenario.robots[index].id.0,
        "tick": tick,
        "mode": status.mode as u8,
        "wait": status.wait.map(|wait| wait as u8),
        "leader": index_of(status.leader),
        "boot": observation.starts,
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
}

/// A mind of a recording: [`robot`] without the window and with the links of the robot, numbers
/// rounded to 0.0001. O(neighbours + links of all robots).
#[must_use]
pub fn recorded(
    engine: &Engine,
    scenario: &Scenario,
    origin_m: [f64; 3],
    events: &Events,
    (tick, index): (u32, usize),
) -> Value {
    let mut mind = robot(engine, scenario, origin_m, events, (tick, index));
    round(&mut mind);
    mind["window"] = Value::Null;
    mind["links"] = links(engine, scenario, Some(index)).into();
    mind
}

fn round(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(round),
        Value::Object(fields) => fields.values_mut().for_each(round),
        Value::Number(number) if number.is_f64() => {
            *value = json!(number.as_f64().map(|number| libm::round(number * DIGITS) / DIGITS));
        }
        _ => {}
    }
}

/// The pairs of the message `links`, only those from or to robot `of` if given; needs
/// [`Engine::log_receptions`]. O(robots + links).
#[must_use]
pub fn links(engine: &Engine, scenario: &Scenario, of: Option<usize>) -> String {
    let mut pairs = Vec::new();
    let all = (0..scenario.robots.len()).flat_map(|to| engine.receptions(to).iter().map(move |packet| (to, packet)));
    for (to, (sender, reception)) in all {
        let Some(from) = index_of(scenario, *sender) else { continue };
        if of.is_some_and(|of| of != from && of != to) {
            continue;
        }
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
    BASE64_STANDARD.encode(pairs)
}

fn index_of(scenario: &Scenario, id: RobotId) -> Option<usize> {
    scenario.robots.binary_search_by_key(&id, |robot| robot.id).ok()
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
        "climb_mps": choice.chosen_mps[2],
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
