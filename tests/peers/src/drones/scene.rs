//! Scenes.

use super::{Body, FLOOR_M, Radio, SPEED_MPS, STEP_S, Task, Vector, distance_m, minus};
use staya_controller::rand::Rng;

const HEIGHT_M: f64 = 30.0;
/// Least distance of two random starts, metres.
const APART_M: f64 = 2.0 * FLOOR_M;

/// When a drone dies.
#[derive(Clone, Copy, Debug)]
pub struct Death {
    /// The drone.
    pub drone: usize,
    /// Not before this time, seconds.
    pub from_s: f64,
    /// Not nearer to its start, metres.
    pub from_m: f64,
}

/// A scene: where drones start, what they are asked to do, what goes wrong.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The task.
    pub task: Task,
    /// Starts, metres.
    pub starts_m: Vec<Vector>,
    /// Goal of each drone, metres; none on a collision course.
    pub goals_m: Vec<Vector>,
    /// Distance from the goal that counts as arrived, metres.
    pub near_m: f64,
    /// Preferred speed, m/s.
    pub cruise_mps: f64,
    /// Control steps.
    pub steps: u32,
    /// The radio.
    pub radio: Radio,
    /// A drone that dies.
    pub death: Option<Death>,
}

impl Scene {
    fn new(task: Task, starts_m: Vec<Vector>, goals_m: Vec<Vector>, seconds: f64) -> Self {
        Self {
            task,
            starts_m,
            goals_m,
            near_m: 0.5,
            cruise_mps: SPEED_MPS,
            steps: (seconds / STEP_S) as u32,
            radio: Radio { loss: 0.0, seed: 0 },
            death: None,
        }
    }

    /// Two drones, 20 m apart, are sent towards each other at 2 m/s for 90 s.
    #[must_use]
    pub fn collision_course() -> Self {
        let starts_m = vec![[0.0, 0.0, HEIGHT_M], [20.0, 0.0, HEIGHT_M]];
        Self { cruise_mps: 2.0, ..Self::new(Task::Goals, starts_m, Vec::new(), 90.0) }
    }

    /// Eight drones within 100 m of each other flock to a place 500 m away.
    #[must_use]
    pub fn flock(seed: u32) -> Self {
        let starts_m = scattered(8, 50.0, seed);
        let goals_m = vec![[500.0, 0.0, HEIGHT_M]; 8];
        Self { near_m: 30.0, ..Self::new(Task::Flock, starts_m, goals_m, 160.0) }
    }

    /// Seven scattered drones form a wedge, 12 m apart.
    #[must_use]
    pub fn wedge(seed: u32) -> Self {
        let goals_m = vec![[0.0, 0.0, HEIGHT_M]; 7];
        Self { near_m: 1.0, ..Self::new(Task::Wedge(12.0), scattered(7, 40.0, seed), goals_m, 120.0) }
    }

    /// The same, with a goal for each drone instead of a formation.
    #[must_use]
    pub fn stations(seed: u32) -> Self {
        let goals_m = stations_m(7, 12.0).into_iter().map(|[north, east, _]| [north, east, HEIGHT_M]).collect();
        Self { task: Task::Goals, goals_m, ..Self::wedge(seed) }
    }

    /// Three drones, 15 m apart; the third one dies after 10 s.
    #[must_use]
    pub fn beacon_loss() -> Self {
        let starts_m: Vec<_> = [-15.0, 0.0, 15.0].map(|east_m| [0.0, east_m, HEIGHT_M]).into();
        Self {
            death: Some(Death { drone: 2, from_s: 10.0, from_m: 0.0 }),
            ..Self::new(Task::Goals, starts_m.clone(), starts_m, 40.0)
        }
    }

    /// Drones exchange places across a circle; starts are random within half a metre.
    #[must_use]
    pub fn circle(drones: usize, radius_m: f64, seed: u32) -> Self {
        let mut off_m = draws(seed, 0.5);
        let at = |drone: usize| {
            let angle = std::f64::consts::TAU * drone as f64 / drones as f64;
            [radius_m * libm::cos(angle), radius_m * libm::sin(angle), HEIGHT_M]
        };
        let starts_m = (0..drones).map(|drone| {
            let [north, east, up] = at(drone);
            [north + off_m(), east + off_m(), up]
        });
        let goals_m = (0..drones).map(|drone| {
            let [north, east, up] = at(drone);
            [-north, -east, up]
        });
        Self::new(Task::Goals, starts_m.collect(), goals_m.collect(), 180.0)
    }

    /// The scene with packet loss.
    #[must_use]
    pub fn lossy(mut self, loss: f64, seed: u32) -> Self {
        self.radio = Radio { loss, seed };
        self
    }

    /// The scene with a random drone that dies in the middle of its way.
    #[must_use]
    pub fn deadly(mut self, seed: u32) -> Self {
        let drone = seed as usize % self.starts_m.len();
        let part = 0.5 + draws(seed, 0.2)();
        let from_m = part * distance_m(self.starts_m[drone], self.goals_m[drone]);
        self.death = Some(Death { drone, from_s: 0.0, from_m });
        self
    }

    /// Distance of each drone from its goal, or from its station around the mean of all, metres.
    pub(super) fn errors_m(&self, bodies: &[Body], goals: &[Vector]) -> Vec<f64> {
        let Task::Wedge(spacing_m) = self.task else {
            return bodies.iter().zip(goals).map(|(body, &goal)| distance_m(body.at_m, goal)).collect();
        };
        let places: Vec<Vector> = bodies.iter().map(|body| body.at_m).collect();
        let mean_m = mean(&places);
        let stations = stations_m(bodies.len(), spacing_m);
        bodies.iter().zip(stations).map(|(body, station)| distance_m(minus(body.at_m, mean_m), station)).collect()
    }

    /// The current goals. On a collision course they are 2 m ahead of each drone.
    pub(super) fn goals_at(&self, bodies: &[Body]) -> Vec<Vector> {
        let (true, [one, other]) = (self.goals_m.is_empty(), bodies) else {
            return self.goals_m.clone();
        };
        let way = minus(other.at_m, one.at_m);
        let part = 2.0 / distance_m(other.at_m, one.at_m);
        let ahead = |from: Vector, sign: f64| [0, 1, 2].map(|axis| from[axis] + sign * way[axis] * part);
        vec![ahead(one.at_m, 1.0), ahead(other.at_m, -1.0)]
    }
}

/// Random numbers from `-range` to `range`.
fn draws(seed: u32, range: f64) -> impl FnMut() -> f64 {
    let mut rng = Rng::keyed(1, seed, 0, 0);
    move || (f64::from(rng.below(2_000_001)) / 1e6 - 1.0) * range
}

fn scattered(drones: usize, half_m: f64, seed: u32) -> Vec<Vector> {
    let mut draw = draws(seed, half_m);
    let mut starts_m: Vec<Vector> = Vec::new();
    while starts_m.len() < drones {
        let at = [draw(), draw(), HEIGHT_M];
        if starts_m.iter().all(|&other| distance_m(at, other) >= APART_M) {
            starts_m.push(at);
        }
    }
    starts_m
}

/// Places of a wedge around their mean, the tip first.
fn stations_m(drones: usize, spacing_m: f64) -> Vec<Vector> {
    let place = |drone: usize| {
        let rank_m = drone.div_ceil(2) as f64 * spacing_m;
        [-rank_m, if drone.is_multiple_of(2) { -rank_m } else { rank_m }, 0.0]
    };
    let places: Vec<Vector> = (0..drones).map(place).collect();
    let mean_m = mean(&places);
    places.into_iter().map(|place| minus(place, mean_m)).collect()
}

fn mean(places: &[Vector]) -> Vector {
    [0, 1, 2].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
}
