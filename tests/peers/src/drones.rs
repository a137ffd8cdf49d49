//! Drones of Staya and of `ados-swarm` in the same scenes, on the same plant and radio: velocities
//! follow commands to first order, control at 10 Hz, beacons at 2 Hz.

mod ados;
mod scene;
mod staya;

pub use ados::Ados;
pub use scene::{Death, Scene};
pub use staya::Staya;

use staya_controller::rand::Rng;

/// Time between two control steps, seconds.
pub const STEP_S: f64 = ados_swarm::sim::SIM_DT;
/// Time constant of the velocity, seconds.
pub const LAG_S: f64 = ados_swarm::sim::VELOCITY_TAU_S;
/// Control steps for each beacon.
pub const BEACON_STEPS: u32 = ados_swarm::sim::BEACON_PERIOD_TICKS as u32;
/// Least distance of two drones, metres.
pub const FLOOR_M: f64 = ados_swarm::separation::SEPARATION_HARD_M;
/// Highest speed, m/s.
pub const SPEED_MPS: f64 = ados_swarm::MAX_COMMAND_SPEED_MPS;

/// A vector north, east and up.
pub type Vector = [f64; 3];

/// A drone's body.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Position, metres.
    pub at_m: Vector,
    /// Velocity, m/s.
    pub mps: Vector,
    /// Its computer runs. Otherwise the drone brakes, hovers and is silent.
    pub lives: bool,
}

/// The task of all drones of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Each flies to its own goal.
    Goals,
    /// All flock to the first goal.
    Flock,
    /// All form a wedge with this spacing, metres, around the mean of the goals.
    Wedge(f64),
}

/// The radio: which beacons arrive.
#[derive(Clone, Copy, Debug)]
pub struct Radio {
    /// Probability that a receiver misses a packet.
    pub loss: f64,
    /// Seed of the losses.
    pub seed: u32,
}

impl Radio {
    /// Whether a packet sent at `step` arrives.
    #[must_use]
    pub fn delivers(&self, step: u32, from: usize, to: usize) -> bool {
        let mut rng = Rng::keyed(self.seed.into(), step, from as u32, to as u32);
        f64::from(rng.below(1_000_000)) >= self.loss * 1e6
    }
}

/// The software of all drones of a scene.
pub trait Swarm {
    /// Starts the software.
    fn new(scene: &Scene) -> Self;

    /// Commanded velocities, m/s. `goals` are those of each drone, metres.
    fn step(&mut self, step: u32, bodies: &[Body], goals: &[Vector], radio: &Radio) -> Vec<Vector>;

    /// Whether `own` still counts `other` as present.
    fn knows(&self, step: u32, own: usize, other: usize) -> bool;
}

/// The result of a scene.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Least distance of two drones at any time, metres.
    pub least_m: f64,
    /// When all living drones were at their goals or stations for the first time, seconds.
    pub arrival_s: Option<f64>,
    /// Living drones at their goals at the end.
    pub arrived: usize,
    /// Greatest change of height, metres.
    pub climb_m: f64,
    /// When the last drone stopped counting the dead one as present, seconds after its death.
    pub dropped_s: Option<f64>,
    /// Greatest distance of a living drone from its goal or station at the end, metres.
    pub error_m: f64,
}

/// Runs a scene.
#[must_use]
pub fn run<S: Swarm>(scene: &Scene) -> Outcome {
    let mut swarm = S::new(scene);
    let body = |&at_m| Body { at_m, mps: [0.0; 3], lives: true };
    let mut bodies: Vec<Body> = scene.starts_m.iter().map(body).collect();
    let mut outcome =
        Outcome { least_m: f64::INFINITY, arrival_s: None, arrived: 0, climb_m: 0.0, dropped_s: None, error_m: 0.0 };
    let mut died_s = 0.0;
    for step in 0..scene.steps {
        let now_s = f64::from(step) * STEP_S;
        if let Some(Death { drone, from_s, from_m }) = scene.death {
            let body = &mut bodies[drone];
            if body.lives && now_s >= from_s && distance_m(body.at_m, scene.starts_m[drone]) >= from_m {
                body.lives = false;
                died_s = now_s;
            }
            let is_known =
                bodies[drone].lives || (0..bodies.len()).any(|own| own != drone && swarm.knows(step, own, drone));
            outcome.dropped_s = outcome.dropped_s.or((!is_known).then_some(now_s - died_s));
        }
        let goals = scene.goals_at(&bodies);
        let commands = swarm.step(step, &bodies, &goals, &scene.radio);
        let before = bodies.clone();
        for (body, command) in bodies.iter_mut().zip(commands) {
            let command = if body.lives { command } else { [0.0; 3] };
            for ((at_m, mps), command) in body.at_m.iter_mut().zip(&mut body.mps).zip(command) {
                *mps += (command - *mps) * (STEP_S / LAG_S);
                *at_m += *mps * STEP_S;
            }
        }
        outcome.least_m = outcome.least_m.min(least_m(&before, &bodies));
        let heights = bodies.iter().zip(&scene.starts_m).map(|(body, start)| (body.at_m[2] - start[2]).abs());
        outcome.climb_m = heights.fold(outcome.climb_m, f64::max);
        let errors_m = scene.errors_m(&bodies, &goals);
        let errors_m = || errors_m.iter().zip(&bodies).filter(|(_, body)| body.lives).map(|(&error_m, _)| error_m);
        outcome.error_m = errors_m().fold(0.0, f64::max);
        outcome.arrived = errors_m().filter(|&error_m| error_m <= scene.near_m).count();
        if outcome.error_m <= scene.near_m && outcome.arrival_s.is_none() {
            outcome.arrival_s = Some(now_s + STEP_S);
        }
    }
    outcome
}

/// Distance of two places, metres.
#[must_use]
pub fn distance_m(a: Vector, b: Vector) -> f64 {
    norm(minus(a, b))
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: Vector) -> f64 {
    libm::sqrt(dot(a, a))
}

/// The least distance of two drones while all move on straight lines, metres.
fn least_m(before: &[Body], after: &[Body]) -> f64 {
    let mut least_m = f64::INFINITY;
    for one in 0..before.len() {
        for other in 0..one {
            let from = minus(before[one].at_m, before[other].at_m);
            let way = minus(minus(after[one].at_m, after[other].at_m), from);
            let part = if dot(way, way) > 0.0 { (-dot(from, way) / dot(way, way)).clamp(0.0, 1.0) } else { 0.0 };
            least_m = least_m.min(norm([0, 1, 2].map(|axis| from[axis] + way[axis] * part)));
        }
    }
    least_m
}
