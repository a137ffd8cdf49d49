//! The controller of one vehicle: telemetry and the scenario's map in, a velocity out.

use staya_controller::agent::{
    Agent, AgentConfig, AnyGuidance, AnySafety, AnySurroundings, Command, Commanded, GridWorkspace, HALF_PLANES,
    InCells, LEARNED, NEIGHBORS, Outputs, Parameter, TEMPLATE, VISITS, Wait, Wish,
};
use staya_controller::agent::{GuidanceKind, SafetyKind, SafetySetup};
use staya_controller::geom::{Position, Vec3};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::{self, Instant};
use staya_controller::wire::Wire;
use staya_sim::engine::{self, Ground, Known, PlaneGround, Sensor, WIDE};
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

#[derive(Clone, Copy, Debug)]
struct Brake {
    place_m: [f64; 3],
    tolerance_m: f64,
}

type Guided = Commanded<f32, AnyGuidance<f32, WIDE, VISITS, TEMPLATE, LEARNED>>;
type ControllerAgent<W> = Agent<f32, Guided, NEIGHBORS, AnySafety<f32, HALF_PLANES>, W>;

/// The agent of one vehicle with its map and senses.
pub struct Controller<W> {
    index: usize,
    ground: Arc<PlaneGround>,
    agent: Box<ControllerAgent<W>>,
    workspace: GridWorkspace<WIDE>,
    senses: Sensor,
    out: Outputs<f32>,
    is_in_space: bool,
    brake: Option<Brake>,
    max_acceleration_mps2: f64,
    lag_s: f64,
    radius_m: f64,
    commanded_mps: Option<[f64; 3]>,
    stepped: Option<(Instant, Position, [f64; 3])>,
}

impl<W: Wire> Controller<W> {
    /// Creates the controller of robot `index` on the map `ground`. `boot` must differ between
    /// starts. Lost neighbours get a margin of at least `error_m`, because an autopilot whose
    /// companion died keeps moving for a while.
    #[must_use]
    pub fn new(
        scenario: &Scenario,
        ground: &Arc<PlaneGround>,
        index: usize,
        boot: u8,
        [lag_s, error_m]: [f64; 2],
        wire: W,
    ) -> Self {
        let tick = time::Duration::from_micros(i32::try_from(scenario.tick_us).unwrap_or(i32::MAX));
        let config = AgentConfig {
            boot,
            seed: scenario.seed,
            plausibility: scenario.plausibility,
            ..ground.config(index, tick)
        };
        // No operator sends goals here, so speed and tolerance are unused.
        let guidance = Commanded::new(scenario.guidance(index).guidance(), 0.0, 0.0);
        let mut agent =
            Box::new(Agent::new(&config, guidance, with_room(scenario.safety(index), error_m).safety(), wire));
        // A law that takes no task refuses it; the scenario was validated for that.
        let _ = agent.assign(&ground.task(index, 0));
        let plane = scenario.plane.as_ref();
        let group = plane.map(|plane| plane.group(index));
        let places = plane.and_then(|plane| plane.starts.get(index)).map(|start| &start.places);
        let brake = group.zip(places).and_then(|(group, places)| {
            let place = match group.guidance.kind() {
                kind if kind.is_on_grid() => None,
                GuidanceKind::Waypoint => places.last(),
                _ => places.first(),
            };
            Some(Brake { place_m: place?.position_m, tolerance_m: group.tolerance_m })
        });
        let safety = group.map(|group| group.safety.kind());
        Self {
            index,
            ground: Arc::clone(ground),
            agent,
            workspace: GridWorkspace::default(),
            senses: Sensor::default(),
            out: Outputs::default(),
            is_in_space: safety == Some(SafetyKind::Fly),
            brake,
            max_acceleration_mps2: f64::from(config.max_acceleration_mps2),
            lag_s,
            radius_m: f64::from(config.radius_m),
            commanded_mps: None,
            stepped: None,
        }
    }

    /// The wire format of the agent.
    pub const fn wire_mut(&mut self) -> &mut W {
        self.agent.wire_mut()
    }

    /// Mode of the agent.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.agent.mode()
    }

    /// Robot that this one follows; 0 for none.
    #[must_use]
    pub const fn leader(&self) -> RobotId {
        self.agent.leader()
    }

    /// Why the robot waits, if it does.
    #[must_use]
    pub const fn wait(&self) -> Option<Wait> {
        self.out.wait
    }

    /// Goal, metres; `None` if the guidance has none.
    #[must_use]
    pub fn goal_m(&self) -> Option<[f64; 3]> {
        self.brake.map(|brake| brake.place_m)
    }

    /// Neighbours and their positions at the last step. O(neighbours).
    #[must_use]
    pub fn known(&self) -> Vec<Known> {
        let stepped = self.stepped.iter();
        stepped.flat_map(|&(now, own, own_m)| engine::known(self.agent.neighbors(), own, own_m, now)).collect()
    }

    /// Number of known neighbours.
    #[must_use]
    pub fn neighbors(&self) -> usize {
        self.agent.neighbors().len()
    }

    #[cfg(test)]
    pub(crate) fn known_radius_m(&self, robot: u32) -> Option<f32> {
        self.agent.neighbors().iter().find(|known| known.id.0 == robot).map(|known| known.radius_m)
    }

    /// Runs one step of the agent. An uncontrolled vehicle (flown by the pilot, or with stale
    /// telemetry) still sends beacons: it does not give way, and its radius includes the position
    /// error.
    pub fn step(&mut self, body: &Body, steers: bool, inbox: &[u8], now: Duration) -> &Outputs<f32> {
        let [x, y, z] = body.position_m;
        // In the plane heights have no meaning, and altitudes of two receivers differ by metres.
        let position_m = [x, y, if self.is_in_space { z } else { 0.0 }];
        let velocity_mps = self.own_velocity(body.velocity_mps);
        let mut inputs = self.ground.sense_at(self.index, position_m, velocity_mps, &mut self.senses);
        inputs.inbox = inbox;
        let wish = if steers { Wish::Own } else { Wish::Off };
        if *self.agent.guidance().wish() != wish {
            let _ = self.agent.guidance_mut().command(wish);
        }
        let plane = match &mut inputs.surroundings {
            AnySurroundings::InPlane(plane) | AnySurroundings::InCells(InCells { plane, .. }) => Some(plane),
            AnySurroundings::OnGrid(_) => None,
        };
        if let (Some(plane), Some(brake)) = (plane, self.brake) {
            let limit = speed_before(&brake, position_m, self.max_acceleration_mps2, self.lag_s);
            plane.max_speed_mps = plane.max_speed_mps.min(limit as f32);
        }
        let [least, greatest] = Parameter::Radius.range();
        let radius_m = (self.radius_m + body.error_m) as f32;
        let _ = self.agent.set_parameter(Parameter::Radius, radius_m.clamp(least, greatest));
        // The agent's clock wraps; steps are much closer to each other.
        let now = Instant::from_micros(now.as_micros() as u32);
        self.stepped = Some((now, inputs.state.position, position_m));
        self.agent.step_into(&inputs, now, &mut self.workspace, &mut self.out);
        self.commanded_mps = steers.then(|| self.velocity_mps());
        &self.out
    }

    /// Commanded velocity east, north, up, m/s.
    #[must_use]
    pub fn velocity_mps(&self) -> [f64; 3] {
        match self.out.command {
            Command::Velocity(Vec3 { x, y, z }) => [x, y, z].map(f64::from),
            Command::Hold | Command::Move(_) => [0.0; 3],
        }
    }

    /// The last command, limited to the velocities in reach of the measured one. With an
    /// acceleration limited from the measured velocity, a lagging vehicle would never speed up.
    fn own_velocity(&self, measured_mps: [f64; 3]) -> [f64; 3] {
        let Some(commanded) = self.commanded_mps else {
            return measured_mps;
        };
        let off = [0, 1, 2].map(|axis| commanded[axis] - measured_mps[axis]);
        let length = off.iter().map(|x| x * x).sum::<f64>().sqrt();
        let most = self.max_acceleration_mps2 * self.lag_s;
        let share = if length > most { most / length } else { 1.0 };
        [0, 1, 2].map(|axis| measured_mps[axis] + off[axis] * share)
    }
}

/// Largest speed from which the vehicle stops at its goal with its lag and half its acceleration.
fn speed_before(brake: &Brake, position_m: [f64; 3], acceleration_mps2: f64, lag_s: f64) -> f64 {
    let way = [0, 1, 2].map(|axis| brake.place_m[axis] - position_m[axis]);
    let distance_m = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    if lag_s <= 0.0 {
        return f64::INFINITY;
    }
    let slow = brake.tolerance_m / (2.0 * lag_s);
    // v^2 / a + v lag = remaining distance, solved for v, with half of the acceleration a.
    let by_lag = acceleration_mps2 * lag_s / 2.0;
    let fast = if acceleration_mps2.is_finite() {
        (by_lag * by_lag + acceleration_mps2 * distance_m).sqrt() - by_lag
    } else {
        distance_m / (2.0 * lag_s)
    };
    slow.max(fast)
}

fn with_room(mut safety: SafetySetup, error_m: f64) -> SafetySetup {
    if let SafetySetup::Orca { inflation, .. } | SafetySetup::Fly { inflation, .. } = &mut safety {
        inflation.max_m = inflation.max_m.max(error_m as f32);
    }
    safety
}

#[cfg(test)]
mod tests;
