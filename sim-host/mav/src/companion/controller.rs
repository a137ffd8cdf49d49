//! The agent beside an autopilot: what it senses comes from telemetry and the scenario's land, what it commands is a velocity.

use staya_controller::agent::{
    Agent, AgentConfig, AnyGuidance, AnySafety, AnySurroundings, Command, Commanded, GridWorkspace, HALF_PLANES,
    InCells, LEARNED, NEIGHBORS, Outputs, Parameter, TEMPLATE, VISITS, Wait, Wish,
};
use staya_controller::agent::{GuidanceKind, SafetyKind, SafetySetup};
use staya_controller::geom::{Position, Vec3};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::{self, Instant};
use staya_controller::wire::Wire;
use staya_sim::engine::{self, Ground, Known, PlaneGround, Senses, WIDE};
use staya_sim::scenario::Scenario;
use std::sync::Arc;
use std::time::Duration;

/// A vehicle as its telemetry has it, in metres and m/s east, north, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Where.
    pub position_m: [f64; 3],
    /// How fast.
    pub velocity_mps: [f64; 3],
    /// How far from there it may be, metres; 0 as long as its telemetry is fresh and believed.
    pub error_m: f64,
}

/// How a vehicle that heads for a place is kept from overshooting.
#[derive(Clone, Copy, Debug)]
struct Brake {
    place_m: [f64; 3],
    tolerance_m: f64,
}

/// What the scenario wants, unless the pilot has the vehicle.
type Guided = Commanded<f32, AnyGuidance<f32, WIDE, VISITS, TEMPLATE, LEARNED>>;
type ControllerAgent<W> = Agent<f32, Guided, NEIGHBORS, AnySafety<f32, HALF_PLANES>, W>;

/// An agent with its land.
pub struct Controller<W> {
    index: usize,
    ground: Arc<PlaneGround>,
    agent: Box<ControllerAgent<W>>,
    workspace: GridWorkspace<WIDE>,
    senses: Senses,
    out: Outputs<f32>,
    is_in_space: bool,
    brake: Option<Brake>,
    max_acceleration_mps2: f64,
    lag_s: f64,
    /// Of its own body, metres.
    radius_m: f64,
    /// What it commanded last, if it steers.
    commanded_mps: Option<[f64; 3]>,
    /// When and where it stepped last.
    stepped: Option<(Instant, Position, [f64; 3])>,
}

impl<W: Wire> Controller<W> {
    /// Of robot number `index` of the scenario, whose robots are on `ground`; `boot` differs from start to start. Others that fall silent get as much more
    /// room as the scenario says, and at least `error_m` metres: an autopilot without its companion goes on for a while.
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
        let config = AgentConfig { boot, seed: scenario.seed, claims: scenario.claims, ..ground.config(index, tick) };
        // Nobody wishes places here, so neither speed nor tolerance counts.
        let guidance = Commanded::new(scenario.guidance(index).guidance(), 0.0, 0.0);
        let mut agent =
            Box::new(Agent::new(&config, guidance, with_room(scenario.safety(index), error_m).safety(), wire));
        // A law that has no use for its task says so; the scenario was checked for that.
        let _ = agent.assign(&ground.task(index, 0));
        let plane = scenario.plane.as_ref();
        let group = plane.map(|plane| plane.group(index));
        let places = plane.and_then(|plane| plane.starts.get(index)).map(|start| &start.places);
        let brake = group.zip(places).and_then(|(group, places)| {
            let place = match group.guidance.kind() {
                kind if kind.is_on_grid() => None,
                // The end of its way.
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
            senses: Senses::default(),
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

    /// How it speaks.
    pub const fn wire_mut(&mut self) -> &mut W {
        self.agent.wire_mut()
    }

    /// What the robot does.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.agent.mode()
    }

    /// Whom it follows; 0: nobody.
    #[must_use]
    pub const fn leader(&self) -> RobotId {
        self.agent.leader()
    }

    /// What it waits for, if it does not get on.
    #[must_use]
    pub const fn wait(&self) -> Option<Wait> {
        self.out.wait
    }

    /// Where it is to go, metres, if that is a place.
    #[must_use]
    pub fn goal_m(&self) -> Option<[f64; 3]> {
        self.brake.map(|brake| brake.place_m)
    }

    /// Whom it knew at its last step, and where. O(neighbours).
    #[must_use]
    pub fn known(&self) -> Vec<Known> {
        let stepped = self.stepped.iter();
        stepped.flat_map(|&(now, own, own_m)| engine::known(self.agent.neighbors(), own, own_m, now)).collect()
    }

    /// How many others it knows.
    #[must_use]
    pub fn neighbors(&self) -> usize {
        self.agent.neighbors().len()
    }

    /// The radius of a robot that it knows, metres.
    #[cfg(test)]
    pub fn known_radius_m(&self, robot: u32) -> Option<f32> {
        self.agent.neighbors().iter().find(|known| known.id.0 == robot).map(|known| known.radius_m)
    }

    /// One step of the agent. One that does not steer (the pilot does, or telemetry is stale) says by its beacons where it is and that others must make way;
    /// the radius that it says has its error in it, so that they stay clear of wherever it can be.
    pub fn step(&mut self, body: &Body, steers: bool, inbox: &[u8], now: Duration) -> &Outputs<f32> {
        let [x, y, z] = body.position_m;
        // In the plane heights are told apart by nobody, and altitudes differ by metres between two receivers.
        let position_m = [x, y, if self.is_in_space { z } else { 0.0 }];
        let velocity_mps = self.own_velocity(body.velocity_mps);
        let mut inputs = self.ground.sense_at(self.index, position_m, velocity_mps, &mut self.senses);
        inputs.inbox = inbox;
        let wish = if steers { Wish::Own } else { Wish::Off };
        if *self.agent.guidance().wish() != wish {
            // Both are possible for any guidance.
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
        // Any agent has a radius.
        let _ = self.agent.set_parameter(Parameter::Radius, radius_m.clamp(least, greatest));
        // The robot's clock wraps; steps are far closer to each other.
        let now = Instant::from_micros(now.as_micros() as u32);
        self.stepped = Some((now, inputs.state.position, position_m));
        self.agent.step_into(&inputs, now, &mut self.workspace, &mut self.out);
        self.commanded_mps = steers.then(|| self.velocity_mps());
        &self.out
    }

    /// What it commands: east, north, up, m/s.
    #[must_use]
    pub fn velocity_mps(&self) -> [f64; 3] {
        match self.out.command {
            Command::Velocity(Vec3 { x, y, z }) => [x, y, z].map(f64::from),
            Command::Hold | Command::Move(_) => [0.0; 3],
        }
    }

    /// The velocity that the vehicle is about to have: what it was told, within what it can change while it follows. Acceleration is
    /// limited from there, or a vehicle that lags would never get going.
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

/// How fast a vehicle may be that should stand at a place: it brakes with half of what it could, and reaches the place so slowly that it stands
/// within the tolerance although it lags.
fn speed_before(brake: &Brake, position_m: [f64; 3], acceleration_mps2: f64, lag_s: f64) -> f64 {
    let way = [0, 1, 2].map(|axis| brake.place_m[axis] - position_m[axis]);
    let distance_m = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    if lag_s <= 0.0 {
        return f64::INFINITY;
    }
    let slow = brake.tolerance_m / (2.0 * lag_s);
    // v^2 / 2a plus what it goes on while it lags is the way that is left.
    let by_lag = acceleration_mps2 * lag_s / 2.0;
    let fast = if acceleration_mps2.is_finite() {
        (by_lag * by_lag + acceleration_mps2 * distance_m).sqrt() - by_lag
    } else {
        distance_m / (2.0 * lag_s)
    };
    slow.max(fast)
}

/// The same, but those who were lost get at least `error_m` metres of room.
fn with_room(mut safety: SafetySetup, error_m: f64) -> SafetySetup {
    if let SafetySetup::Orca { inflation, .. } | SafetySetup::Fly { inflation, .. } = &mut safety {
        inflation.max_m = inflation.max_m.max(error_m as f32);
    }
    safety
}

#[cfg(test)]
mod tests;
