//! The controller of one vehicle: telemetry and the scenario's map in, a velocity out.

use staya_controller::agent::{
    Agent, AgentConfig, AnyLaw, Command, GridWorkspace, Guided, LEARNED, NEIGHBORS, Outputs, VISITS, Wait, Wish,
};
use staya_controller::agent::{Goals, LayerSettings};
use staya_controller::geom::{Position, Vec3};
use staya_controller::parameters::RADIUS;
use staya_controller::time::Instant;
use staya_controller::wire::Wire;
use staya_sim::engine::{self, Ground as _, Known, PlaneGround, ScenarioSafety, Senses, WIDE};
use staya_sim::scenario::Scenario;
use std::sync::Arc;
use std::time::Duration;

/// State of a vehicle from telemetry, in metres and m/s east, north, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Position.
    pub position_m: [f64; 3],
    /// Velocity.
    pub velocity_mps: [f64; 3],
    /// Largest position error, metres; 0 while telemetry is fresh and trusted.
    pub error_m: f64,
}

/// The agent of a vehicle, with a law that an operator may switch off.
type ControllerAgent<W> = Agent<f32, Guided<f32, AnyLaw<f32, WIDE, VISITS, LEARNED>>, NEIGHBORS, ScenarioSafety, W>;

/// The agent of one vehicle with its map and senses.
pub struct Controller<W> {
    index: usize,
    ground: Arc<PlaneGround>,
    agent: Box<ControllerAgent<W>>,
    workspace: GridWorkspace<WIDE>,
    senses: Senses,
    out: Outputs<f32>,
    is_in_space: bool,
    /// Goal, metres; `None` if the law has none.
    pub goal_m: Option<[f64; 3]>,
    radius_m: f64,
    stepped: Option<(Instant, Position, [f64; 3])>,
}

impl<W: Wire> Controller<W> {
    /// Creates the controller of robot `index` on the map `ground`. `boot` must differ between
    /// starts. Lost neighbours get a margin of at least `error_m`, because an autopilot whose
    /// companion died keeps moving for a while.
    pub fn new(scenario: &Scenario, ground: &Arc<PlaneGround>, index: usize, boot: u8, error_m: f64, wire: W) -> Self {
        let (config, task) = ground.setup(index, 0);
        // Each companion decides by a clock of its own.
        let is_synchronous = false;
        let (seed, plausibility) = (scenario.seed, scenario.trust.plausibility);
        let config = AgentConfig { boot, seed, plausibility, is_synchronous, ..config };
        // No operator sends goals here, so speed and tolerance are unused.
        let law = Guided::new(scenario.law(index).on_device().law(()), 0.0, 0.0);
        let safety = with_room(scenario.safety(index), error_m);
        let safety = ScenarioSafety::new(&safety, scenario.half_planes(index));
        let mut agent = Box::new(Agent::new(&config, law, safety, wire));
        // A law that takes no task refuses it; the scenario was validated for that.
        let _ = agent.assign(&task);
        let plane = scenario.plane();
        let group = plane.map(|plane| plane.group(index));
        let places = plane.and_then(|plane| plane.starts.get(index)).map(|start| &start.places);
        let goal = group.zip(places).and_then(|(group, places)| match group.law.goals() {
            Goals::Cell => None,
            Goals::Waypoints => places.last(),
            Goals::None | Goals::Shared(_) => places.first(),
        });
        let is_in_space = group.is_some_and(|group| group.safety.flies());
        Self {
            index,
            ground: Arc::clone(ground),
            agent,
            workspace: GridWorkspace::default(),
            senses: Senses::default(),
            out: Outputs::default(),
            is_in_space,
            goal_m: goal.map(|goal| goal.position_m),
            radius_m: f64::from(config.radius_m),
            stepped: None,
        }
    }

    /// The wire format of the agent.
    pub const fn wire_mut(&mut self) -> &mut W {
        self.agent.wire_mut()
    }

    /// The agent.
    pub fn agent(&self) -> &ControllerAgent<W> {
        &self.agent
    }

    /// Why the robot waits, if it does.
    pub const fn wait(&self) -> Option<Wait> {
        self.out.wait
    }

    /// Neighbours and their positions at the last step. O(neighbours).
    pub fn known(&self) -> Vec<Known> {
        let stepped = self.stepped.iter();
        stepped.flat_map(|&(now, own, own_m)| engine::known(self.agent.neighbors(), own, own_m, now)).collect()
    }

    /// Runs one step of the agent. An uncontrolled vehicle (flown by the pilot, or with stale
    /// telemetry) still sends beacons: it does not give way, and its radius includes the position
    /// error.
    pub fn step(&mut self, body: &Body, steers: bool, inbox: &[u8], now: Duration) -> &Outputs<f32> {
        // In the plane heights have no meaning, and altitudes of two receivers differ by metres.
        let flat = |[x, y, z]: [f64; 3]| [x, y, if self.is_in_space { z } else { 0.0 }];
        let (position_m, velocity_mps) = (flat(body.position_m), flat(body.velocity_mps));
        let mut inputs = self.ground.sense_at(self.index, position_m, velocity_mps, &mut self.senses);
        inputs.inbox = inbox;
        let wish = if steers { Wish::Own } else { Wish::Off };
        if *self.agent.law().wish() != wish {
            let _ = self.agent.law_mut().command(wish);
        }
        let [least, greatest] = RADIUS.range;
        let radius_m = (self.radius_m + body.error_m) as f32;
        let _ = self.agent.set_parameter(RADIUS.name, radius_m.clamp(least, greatest));
        // The agent's clock wraps; steps are much closer to each other.
        let now = Instant::from_micros(now.as_micros() as u32);
        self.stepped = Some((now, inputs.state.position, position_m));
        self.agent.step_into(&inputs, now, &mut self.workspace, &mut self.out);
        &self.out
    }

    /// Commanded velocity east, north, up, m/s.
    pub fn velocity_mps(&self) -> [f64; 3] {
        match self.out.command {
            Command::Velocity(Vec3 { x, y, z }) => [x, y, z].map(f64::from),
            Command::Hold | Command::Move(_) => [0.0; 3],
        }
    }
}

fn with_room(mut safety: LayerSettings, error_m: f64) -> LayerSettings {
    if let Some(orca) = safety.orca_mut() {
        orca.inflation.max_m = orca.inflation.max_m.max(error_m as f32);
    }
    safety
}

#[cfg(test)]
mod tests;
