use super::{RecordingError, Sink, Writer};
use crate::frame::{FrameData, Framer};
use crate::scene::{self, Mode, Scene};
use serde::Serialize;
use serde_json::{Value, json};
use staya_sim::engine::Moment;
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Intervention, Scenario};
use staya_sim::terrain::change::LandChange;
use std::path::Path;

/// Writes every n-th moment of a run, and the last one.
#[derive(Clone, Debug)]
pub struct RunRecorder<W: Sink> {
    writer: Writer<W>,
    framer: Framer,
    frame: FrameData,
    is_written: bool,
    every: u32,
    scene: Scene,
    /// Ticks before which an intervention changes the scene, latest first.
    changes: Vec<u32>,
    rules: Vec<LandChange>,
    seen: u32,
    orders: Vec<Value>,
    /// Minds at the tick of `frame`, while it is not written.
    minds: Vec<Value>,
}

impl<W: Sink> RunRecorder<W> {
    /// Starts a recording in `out`; errors call it `path`. `every` is in ticks, at least 1.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn new(out: W, path: &Path, scenario: &Scenario, every: u32) -> Result<Self, RecordingError> {
        Self::of(Scene::new(scenario, Mode::Recording), out, path, scenario, every)
    }

    /// As [`RunRecorder::new`], with the scene.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn of(scene: Scene, out: W, path: &Path, scenario: &Scenario, every: u32) -> Result<Self, RecordingError> {
        let interventions = scenario.events.interventions.iter();
        let mut changes: Vec<u32> =
            interventions.clone().filter(|(_, what)| changes_scene(what)).map(|(tick, _)| *tick).collect();
        changes.sort_unstable_by(|a, b| b.cmp(a));
        let orders = interventions.map(|(tick, what)| json!({ "tick": tick, "order": order(what, &scene) })).collect();
        Ok(Self {
            writer: Writer::new(out, path, &scene)?,
            framer: Framer::new(scenario),
            frame: FrameData::default(),
            is_written: true,
            every: every.max(1),
            scene,
            changes,
            rules: scenario.land.changes.clone(),
            seen: 0,
            orders,
            minds: Vec::new(),
        })
    }

    /// Handles a moment. O(bodies), and O(cells) where the scene changes.
    ///
    /// # Errors
    /// The recording cannot be written.
    pub fn tick(&mut self, moment: &Moment<'_>, robots: impl Iterator<Item = RobotRow>) -> Result<(), RecordingError> {
        let tick = moment.row.tick;
        let known = self.changes.len();
        while self.changes.last().is_some_and(|at| *at < tick) {
            self.changes.pop();
        }
        let has_new_land = (self.seen..tick).any(|at| self.rules.iter().any(|rule| rule.is_due(at)));
        self.seen = tick;
        if has_new_land || self.changes.len() < known {
            let origin_m = self.scene.origin_m;
            self.scene.land = moment.land.map(|land| scene::land(land, origin_m));
            self.scene.solids = scene::solids(moment.solids, self.scene.kind == scene::Kind::Space, origin_m);
            self.writer.scene(&self.scene)?;
        }
        self.minds.clear();
        self.framer.fill(&mut self.frame, moment, robots);
        self.is_written = tick.is_multiple_of(self.every);
        if self.is_written { self.writer.frame(&self.frame) } else { Ok(()) }
    }

    /// Records a robot's [`mind`](crate::mind::recorded) at the tick of the last moment.
    pub fn mind(&mut self, mind: Value) {
        if self.is_written {
            self.writer.mind(&mind);
        } else {
            self.minds.push(mind);
        }
    }

    /// Records an intervention before the next tick.
    pub fn note(&mut self, what: &Intervention) {
        if changes_scene(what) {
            self.changes.push(self.seen);
        }
        self.orders.push(json!({ "tick": self.seen, "order": order(what, &self.scene) }));
    }

    /// Ends an incomplete recording: writes the buffered frames, if possible. Returns the output.
    pub fn stop(self) -> W {
        self.writer.stop()
    }

    /// Writes the last frame, the orders and the summary.
    ///
    /// # Errors
    /// The recording cannot be written.
    pub fn finish(mut self, summary: &impl Serialize) -> Result<W, RecordingError> {
        if !self.is_written {
            self.writer.frame(&self.frame)?;
            self.minds.iter().for_each(|mind| self.writer.mind(mind));
        }
        self.writer.finish(&self.orders, summary)
    }
}

fn changes_scene(what: &Intervention) -> bool {
    matches!(
        what,
        Intervention::Solid { .. }
            | Intervention::Move { .. }
            | Intervention::Remove { .. }
            | Intervention::Cell { .. }
    )
}

/// Robots by index and positions relative to the scene's origin, as pages send them.
fn order(what: &Intervention, scene: &Scene) -> Value {
    let mut order = serde_json::to_value(what).unwrap_or_default();
    if let Some(robot) = what.robot() {
        order["robot"] = json!(scene.robots.id.binary_search(&robot).ok());
    }
    if let Some(place) = order.get_mut("place_m").and_then(Value::as_array_mut) {
        for (value, origin) in place.iter_mut().zip(scene.origin_m) {
            *value = json!(value.as_f64().map(|value| value - origin));
        }
    }
    order
}
