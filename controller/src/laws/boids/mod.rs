//! Boids on a torus: constant speed, only the heading changes. Start with [`BoidsParams::steer`].
//!
//! Source: V. A. Starovoitova 2018 (STA), sections 2.1 and 2.4 and the listing of class `Boid`. A
//! boid with a neighbour nearer than `crowded` turns away from that neighbour's heading. Otherwise
//! it turns to the mean heading of its neighbours and then to their middle.
//!
//! **Defects of the listing that are corrected here:**
//!
//! - The mean heading summed angles (+179 and -179 degrees gave 0), and the own heading without
//!   counting it. Here it is the direction of the sum of the neighbours' velocities.
//! - `cohere` turned away from the middle. Here it turns towards it.
//! - Distances and the middle ignored the torus. Here offsets are the shortest ones,
//!   [`Torus::shortest`](crate::geom::Torus::shortest).
//! - Two boids with one heading both turned left and stayed near. Here each turns away from the
//!   other, or, in one place, in the direction of [`tie`].
//!
//! **Cost.** Headings are unit vectors: a step takes two roots per boid and no sines.

#[cfg(feature = "agent")]
mod law;
#[cfg(feature = "agent")]
mod settings;

#[cfg(all(test, feature = "micromath"))]
mod tests;

#[cfg(feature = "agent")]
pub use law::BoidsGuidance;
#[cfg(feature = "agent")]
pub use settings::BoidsSettings;

use crate::geom::Vec2;
use crate::neighbor::{Nearby, tie};
use crate::parameters::{Parameter, Parameters, Value as _, row};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Turn<S> {
    cos: S,
    sin: S,
    /// More than a quarter turn.
    is_wide: bool,
}

impl<S: Scalar> Turn<S> {
    fn new(angle: S) -> Self {
        let angle = if angle > S::ZERO { angle.min(S::PI) } else { S::ZERO };
        let (sin, cos) = angle.sin_cos();
        Self { cos, sin: sin.max(S::ZERO), is_wide: angle > S::PI * S::HALF }
    }

    fn left(&self, heading: Vec2<S>) -> Vec2<S> {
        heading.rotate(self.cos, self.sin)
    }

    fn right(&self, heading: Vec2<S>) -> Vec2<S> {
        heading.rotate(self.cos, -self.sin)
    }

    /// Straight back: to the left, as in the listing.
    fn towards(&self, heading: Vec2<S>, target: Vec2<S>) -> Vec2<S> {
        let (det, dot) = (heading.det(target), heading.dot(target));
        // The sine is precise where the cosine is flat.
        let is_near = if self.is_wide { dot >= self.cos } else { dot > S::ZERO && det.abs() <= self.sin };
        if is_near {
            target
        } else if det >= S::ZERO {
            self.left(heading)
        } else {
            self.right(heading)
        }
    }
}

const CROWDED: Parameter =
    row("crowded_m", "BOID_CROWDED_M", "m", [0.0, 1000.0], "nearer than this a boid turns away").needed();
const CLOSEST: Parameter =
    row("closest_m", "BOID_CLOSEST_M", "m", [0.0, 10_000.0], "farthest neighbour that counts").needed();
const TURN: Parameter = row("max_turn", "BOID_TURN", "rad", [0.0, 3.15], "largest turn towards the others in a step");
const TURN_AWAY: Parameter =
    row("max_turn_away", "BOID_TURN_AWAY", "rad", [0.0, 3.15], "largest turn away from a too near boid in a step");

/// Parameters of boids, with values that [`BoidsParams::new`] precomputes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BoidsParams<S> {
    crowded: u64,
    closest: u64,
    turn: Turn<S>,
    turn_away: Turn<S>,
    #[serde(with = "crate::digest::uncounted")]
    values: [S; 4],
}

impl<S: Scalar> BoidsParams<S> {
    /// - `crowded_m`: a boid turns away from a neighbour closer than this (paper: 30). The larger,
    ///   the looser the flock; above `closest_m` boids do not align any more.
    /// - `closest_m`: neighbours count up to this distance (150).
    /// - `max_turn`: largest turn to the mean heading, and again to the middle, in a step, radians
    ///   (0.05). The larger, the quicker and the more nervous.
    /// - `max_turn_away`: turn away from a neighbour that is too near, radians (0.02).
    ///
    /// With distances that are not above 0 no neighbour counts. Angles that are not above 0 give no
    /// turn, and those above half a turn count as half a turn.
    #[must_use]
    pub fn new(crowded_m: S, closest_m: S, max_turn: S, max_turn_away: S) -> Self {
        let key = |distance: S| {
            let is_sound = distance > S::ZERO;
            is_sound.then(|| S::length_key([distance, S::ZERO, S::ZERO]))
        };
        Self {
            crowded: key(crowded_m).unwrap_or(0),
            closest: key(closest_m).unwrap_or(0),
            turn: Turn::new(max_turn),
            turn_away: Turn::new(max_turn_away),
            values: [crowded_m, closest_m, max_turn, max_turn_away],
        }
    }

    /// Parameters that may change while a robot runs.
    pub const TABLE: &'static [Parameter] = &[CROWDED, CLOSEST, TURN, TURN_AWAY];

    /// The paper's values, at a scale of `unit_m` metres: 30, 150, 0.05, 0.02.
    #[must_use]
    pub fn paper(unit_m: S) -> Self {
        Self::new(S::from_i32(30) * unit_m, S::from_i32(150) * unit_m, S::from_ratio(1, 20), S::from_ratio(1, 50))
    }

    /// The heading of boid `own` one step later; headings are unit vectors.
    ///
    /// `nearby` holds offsets that are shortest on the torus, in any order; heights and radii are
    /// ignored. A stationary neighbour counts only for the middle, one whose position or velocity
    /// is not a number not at all. The result is a unit vector for any input. O(nearby).
    #[must_use]
    #[inline(never)]
    pub fn steer(&self, own: RobotId, heading: Vec2<S>, nearby: &[Nearby<S>]) -> Vec2<S> {
        let heading = sound_heading(heading);
        let (mut velocities, mut offsets) = (Vec2::ZERO, Vec2::ZERO);
        let mut nearest: Option<(u64, &Nearby<S>)> = None;
        for other in nearby {
            let (offset, velocity) = (other.offset_m.xy(), other.velocity_mps.xy());
            let key = offset.length_key();
            if key > self.closest || !velocity.is_finite() || other.id == own {
                continue;
            }
            if !other.is_stranger {
                velocities += velocity;
                offsets += offset;
            }
            if nearest.is_none_or(|(least, other_id)| (key, other.id) < (least, other_id.id)) {
                nearest = Some((key, other));
            }
        }
        let next = match nearest {
            None => heading,
            Some((key, other)) if key < self.crowded => self.separate(own, heading, other),
            Some(_) => {
                let aligned = self.towards(heading, velocities);
                self.towards(aligned, offsets)
            }
        };
        let three_halves = S::ONE + S::HALF;
        next * (three_halves - S::HALF * next.norm_squared())
    }

    /// [`Self::steer`] with the heading as an angle in (-pi, pi], radians.
    #[must_use]
    pub fn turn(&self, own: RobotId, heading: S, nearby: &[Nearby<S>]) -> S {
        let (sin, cos) = if heading.is_finite() { heading.sin_cos() } else { (S::ZERO, S::ONE) };
        let next = self.steer(own, Vec2::new(cos, sin), nearby);
        let angle = next.y.atan2(next.x);
        if angle <= -S::PI { S::PI } else { angle }
    }

    fn towards(&self, heading: Vec2<S>, target: Vec2<S>) -> Vec2<S> {
        target.normalized().map_or(heading, |target| self.turn.towards(heading, target))
    }

    /// Turns to the right if the other heading points to the left of the own one.
    fn separate(&self, own: RobotId, heading: Vec2<S>, other: &Nearby<S>) -> Vec2<S> {
        let flies = other.velocity_mps.xy();
        let is_parallel = heading.det(flies) == S::ZERO;
        let is_left = if !is_parallel {
            heading.det(flies) > S::ZERO
        } else if heading.dot(flies) < S::ZERO {
            true
        } else {
            let place = other.offset_m.xy();
            let place = if place == Vec2::ZERO { tie(other.id, own) } else { place };
            let side = heading.det(place);
            side > S::ZERO || (side == S::ZERO && heading.dot(place) > S::ZERO)
        };
        if is_left { self.turn_away.right(heading) } else { self.turn_away.left(heading) }
    }
}

impl<S: Scalar> Parameters for BoidsParams<S> {
    fn table(&self) -> &'static [Parameter] {
        Self::TABLE
    }

    fn get(&self, index: usize) -> Option<f32> {
        self.values.get(index).map(|value| value.number())
    }

    fn store(&mut self, index: usize, value: f32, _: bool) -> bool {
        if let Some(slot) = self.values.get_mut(index) {
            *slot = S::nearest(value);
        }
        let [crowded_m, closest_m, max_turn, max_turn_away] = self.values;
        *self = Self::new(crowded_m, closest_m, max_turn, max_turn_away);
        index < self.values.len()
    }
}

fn sound_heading<S: Scalar>(heading: Vec2<S>) -> Vec2<S> {
    let off = heading.norm_squared() - S::ONE;
    if off.abs() < S::HALF * S::HALF {
        return heading;
    }
    heading.normalized().unwrap_or(Vec2::new(S::ONE, S::ZERO))
}
