//! The goal flock: robots move to goals together, each attracted to the middle of its neighbours
//! and repelled by the nearest. Start with [`wish`].
//!
//! Source: V. E. Pavlovsky, V. V. Pavlovsky, "Mathematical model of a two-dimensional homogeneous
//! flock of robots", section 2 (first stage; add a safety layer).
//!
//! **Differences to the paper:**
//!
//! - Closer than half the least distance the paper has no repulsion. Here it is that at half the
//!   least distance; robots in one place separate by [`tie`].
//! - On its last step a robot does not pass its goal, or it would oscillate around it forever.
//! - All computations are in space; in the plane z remains 0.

#[cfg(feature = "agent")]
mod law;
#[cfg(feature = "agent")]
mod settings;

#[cfg(all(test, feature = "micromath"))]
mod tests;

#[cfg(feature = "agent")]
pub use law::{GOALS, GoalFlockGuidance};
#[cfg(feature = "agent")]
pub use settings::GoalFlockSettings;

use crate::body::Body;
use crate::geom::{Position, Vec3};
use crate::neighbor::{Nearby, tie};
use crate::parameters::{MIN_DISTANCE, SPEED, row};
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Parameters of the goal flock. Only the ratios of the gains matter once their sum is longer
/// than 1. A gain may be 0, or negative (the opposite direction).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalParams<S> {
    /// Pull of the goal (K1). Far above [`Self::center_gain`] the group is lost.
    pub goal_gain: S,
    /// Pull of the middle of the neighbours (K2). Far above [`Self::goal_gain`] no robot arrives.
    pub center_gain: S,
    /// Push of each neighbour that is too near (K3), from 0 at twice the least distance to 2.25
    /// times this at half of it. With a gain that is too small, robots touch and block each other.
    pub repulsion_gain: S,
    /// Range of neighbours (R_nbh), metres; at least twice [`Self::min_distance_m`].
    pub neighborhood_m: S,
    /// Least distance of two robots' centres (R_MinDist), metres; above 0 and at least two radii.
    pub min_distance_m: S,
    /// Speed (V_Max), m/s; more than 0. The body's own limit also applies.
    pub speed_mps: S,
}

impl<S: Scalar> GoalParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> GoalParams<T> {
        GoalParams {
            goal_gain: cast(self.goal_gain),
            center_gain: cast(self.center_gain),
            repulsion_gain: cast(self.repulsion_gain),
            neighborhood_m: cast(self.neighborhood_m),
            min_distance_m: cast(self.min_distance_m),
            speed_mps: cast(self.speed_mps),
        }
    }

    /// The paper's ratio R_nbh = 4 R_MinDist, and gains of 1, 1/2 and 1.
    #[must_use]
    pub fn new(min_distance_m: S, speed_mps: S) -> Self {
        Self {
            goal_gain: S::ONE,
            center_gain: S::HALF,
            repulsion_gain: S::ONE,
            neighborhood_m: S::from_i32(4) * min_distance_m,
            min_distance_m,
            speed_mps,
        }
    }

    /// Whether all parameters are in the ranges stated; if not, [`wish`] is zero.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let gains = [self.goal_gain, self.center_gain, self.repulsion_gain];
        gains.iter().all(|gain| gain.is_finite())
            && self.min_distance_m > S::ZERO
            && self.neighborhood_m >= S::TWO * self.min_distance_m
            && self.neighborhood_m.is_finite()
            && self.speed_mps > S::ZERO
            && self.speed_mps.is_finite()
    }
}

crate::parameters! {
    impl[S: Scalar] GoalParams<S>, where is_sound {
        SPEED => speed_mps,
        MIN_DISTANCE => min_distance_m,
        row("neighborhood_m", "GOAL_NBH_M", "m", [0.002, 10_000.0], "farthest neighbour that counts")
            .depends("4 `min_distance_m`") => neighborhood_m,
        row("k1", "GOAL_K1", "", [-1000.0, 1000.0], "pull of the goal (K1)") => goal_gain,
        row("k2", "GOAL_K2", "", [-1000.0, 1000.0], "pull of the middle of the neighbours (K2)") => center_gain,
        row("k3", "GOAL_K3", "", [-1000.0, 1000.0], "push of neighbours that are too near (K3)") => repulsion_gain,
    }
}

/// The preferred velocity of the robot at `own`, m/s: V_Max (r1 + r2 + r3), at most V_Max.
///
/// Without a goal r1 is zero. `nearby` may be in any order; a neighbour whose position is not a
/// number is ignored. The result is finite and at most as long as V_Max for any input. O(nearby).
#[must_use]
#[inline(never)]
pub fn wish<S: Scalar>(
    params: &GoalParams<S>,
    body: &Body<S>,
    own: Position,
    goal: Option<Position>,
    nearby: &[Nearby<S>],
) -> Vec3<S> {
    if !params.is_sound() {
        return Vec3::ZERO;
    }
    let speed = params.speed_mps.min(body.max_speed_mps);
    let can_move = speed > S::ZERO;
    if !can_move {
        return Vec3::ZERO;
    }
    let way = goal.map_or(Vec3::ZERO, |goal| goal.since(own));
    // r1 = K1 unit(goal - x), eq. 2; near the goal limited to the remaining distance.
    let left = if body.has_inertia() {
        // Brakes before the goal.
        body.stopping_speed(way.norm()).checked_div(speed).unwrap_or(S::ONE)
    } else {
        let step_m = speed * body.step_s;
        if way.norm() < step_m { way.norm().checked_div(step_m).unwrap_or(S::ONE) } else { S::MAX }
    };
    let r1 = way.normalized().map_or(Vec3::ZERO, |unit| unit * params.goal_gain.min(left));
    let (r2, r3) = among_neighbors(params, body.id, nearby);
    (r1 + r2 + r3).clamp_norm(S::ONE) * speed
}

/// r2 = K2 unit(mean of the neighbours - x), eq. 5, and r3, eq. 8.
fn among_neighbors<S: Scalar>(params: &GoalParams<S>, own: RobotId, nearby: &[Nearby<S>]) -> (Vec3<S>, Vec3<S>) {
    let (mut sum, mut r3) = (Vec3::ZERO, Vec3::ZERO);
    for other in nearby {
        let distance = other.offset_m.norm();
        let is_seen = distance <= params.neighborhood_m;
        if !is_seen || other.id == own {
            continue;
        }
        if !other.is_stranger {
            sum += other.offset_m;
        }
        let force = repulsion(params, distance);
        let apart = || tie(other.id, own).extend(S::ZERO);
        let towards = other.offset_m.normalized().unwrap_or_else(apart);
        r3 -= towards * force;
    }
    let r2 = sum.normalized().map_or(Vec3::ZERO, |unit| unit * params.center_gain);
    (r2, r3)
}

/// f = K3 (2 - d / R_MinDist)^2 for R_MinDist / 2 <= d <= 2 R_MinDist (eqs. 6 and 7); 0 beyond.
fn repulsion<S: Scalar>(params: &GoalParams<S>, distance_m: S) -> S {
    let ratio = distance_m.checked_div(params.min_distance_m);
    let lack = S::TWO - ratio.unwrap_or(S::TWO).clamp(S::HALF, S::TWO);
    params.repulsion_gain * lack * lack
}

/// The current destination of a robot with goals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// The middle of all goals.
    #[default]
    Gather,
    /// The goal with this index.
    Goal(usize),
}

/// Error of [`Goals::push`]: the list is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Full;

/// Up to `N` goals of a robot. It first moves to the middle of all, then to a random one (eq. 3).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Goals<const N: usize> {
    places: Vec<Position, N>,
    stage: Stage,
    /// Restarts; each gives a new random choice.
    round: u32,
}

impl<const N: usize> Goals<N> {
    const PURPOSE: u32 = 0x676F_616C; // "goal"

    /// Creates an empty list.
    #[must_use]
    pub const fn new() -> Self {
        Self { places: Vec::new(), stage: Stage::Gather, round: 0 }
    }

    /// Adds a goal. [`Full`] if there are `N` already; then nothing changes.
    pub fn push(&mut self, goal: Position) -> Result<(), Full> {
        self.places.push(goal).map_err(|_| Full)
    }

    /// Moves a goal, also during a run: the middle and a robot that has chosen the goal follow.
    /// Returns whether the goal exists.
    #[must_use]
    pub fn set_goal(&mut self, index: usize, goal: Position) -> bool {
        self.places.get_mut(index).map(|place| *place = goal).is_some()
    }

    /// All goals.
    #[must_use]
    pub fn as_slice(&self) -> &[Position] {
        &self.places
    }

    /// The robot's current destination.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.stage
    }

    /// Returns to the middle first; the next choice is independent of the last.
    pub const fn restart(&mut self) {
        self.stage = Stage::Gather;
        self.round = self.round.wrapping_add(1);
    }

    /// The middle of all goals, rounded to millimetres; `None` without goals. O(N).
    #[must_use]
    pub fn centroid(&self) -> Option<Position> {
        let count = i64::try_from(self.places.len()).ok()?;
        let mut sum = [0_i64; 3];
        for place in &self.places {
            for (total, mm) in sum.iter_mut().zip(place.mm) {
                *total += i64::from(mm);
            }
        }
        let mean = |total: i64| (2 * total + count).checked_div_euclid(2 * count);
        let [x, y, z] = sum.map(|total| mean(total).and_then(|mm| i32::try_from(mm).ok()));
        Some(Position::from_mm([x?, y?, z?]))
    }

    /// The position of the current destination; `None` without goals.
    #[must_use]
    pub fn current(&self) -> Option<Position> {
        match self.stage {
            Stage::Gather => self.centroid(),
            Stage::Goal(index) => self.places.get(index).copied(),
        }
    }

    /// Whether the robot at `own` is within `arrival_m` of its destination. Choose about the
    /// neighbourhood: a crowd needs space, and most robots never reach the middle itself.
    #[must_use]
    pub fn has_arrived<S: Scalar>(&self, own: Position, arrival_m: S) -> bool {
        self.current().is_some_and(|goal| goal.since::<S>(own).norm() <= arrival_m)
    }

    /// Chooses a goal if the robot at `own` is within `arrival_m` of the middle: uniformly, as a
    /// function of seed, robot and round. Returns the index chosen, if any.
    pub fn update<S: Scalar>(&mut self, own: Position, arrival_m: S, seed: u64, robot: RobotId) -> Option<usize> {
        if self.stage != Stage::Gather || !self.has_arrived(own, arrival_m) {
            return None;
        }
        let count = u32::try_from(self.places.len()).ok()?;
        let drawn = Rng::keyed(seed, Self::PURPOSE, robot.0, self.round).below(count);
        let index = usize::try_from(drawn).ok()?;
        self.stage = Stage::Goal(index);
        Some(index)
    }
}
