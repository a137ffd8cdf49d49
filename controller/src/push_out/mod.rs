//! Push-out: a step that would end too near to a robot or obstacle is pushed out, or turned aside
//! (V. E. Pavlovsky, V. V. Pavlovsky, "Mathematical model of a two-dimensional homogeneous flock of
//! robots", section 3). Start with [`push_out`]; [`zone`] has the effect of one obstacle.
//!
//! It is simple, and a robot alone with obstacles never comes too near. It considers the positions
//! of robots but not their velocities: two robots may come nearer than the least distance by one
//! step, and crowds may block each other.
//!
//! **Differences to the paper:**
//!
//! - Robots and obstacles have bodies, whose radii raise the least distance.
//! - The whole step counts instead of its end, so that a fast robot cannot jump through a small
//!   obstacle. Model 1 pushes its deepest point to the visible border of the zone.
//! - The paper steps sideways if position, new position and centre are on one line. Here they may
//!   also nearly be, since a push back along the line leaves nothing of the step there either.
//! - Robots that are already too near are pushed out no faster than they can move. Those in one
//!   place separate by [`tie`](crate::neighbor::tie).
//! - The paper's rule for several robots is lost with its figure 8; see [`Evasion::Multiple`].
//! - Walls and half-spaces are supported. All computations are in space; in the plane z remains 0.

pub mod zone;

#[cfg(test)]
mod tests;

use crate::body::Body;
use crate::geom::Vec3;
use crate::names::named;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::parameters::MIN_DISTANCE;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};
use zone::{Path, Side, Zone};

named! {
    /// How a step that leads too near is changed.
    #[derive(Default)]
    pub enum Model {
        /// Model 1: the step ends where the radius through its end leaves the zone (straight at the
        /// centre: sideways with the same length). The robot slides along the zone and slows down.
        #[default]
        Radial = "radial",
        /// Model 2: the step keeps its length and is turned to the border by the smaller angle.
        Tangential = "tangential",
    }
}

named! {
    /// How many robots are evaded at once. All obstacles are always evaded.
    #[derive(Default)]
    pub enum Evasion {
        /// Only the nearest one in the way, so the evading step may lead too near to another robot.
        Single = "single",
        /// All. The robot takes the evading step around any of them, to either side, that is
        /// nearest to its wish and clear of all; otherwise it stops.
        #[default]
        Multiple = "multiple",
    }
}

/// Parameters of push-out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PushOutParams<S> {
    /// How a step that leads too near is changed.
    pub model: Model,
    /// How many robots are evaded at once.
    pub evasion: Evasion,
    /// Least distance (R_MinDist) of two robots' centres, and of a centre from an obstacle's
    /// border, metres; above 0. Bodies raise it. One step's length more keeps moving robots apart.
    pub min_distance_m: S,
}

impl<S: Scalar> PushOutParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> PushOutParams<T> {
        PushOutParams { model: self.model, evasion: self.evasion, min_distance_m: cast(self.min_distance_m) }
    }

    /// Model 1 for all robots in the way.
    #[must_use]
    pub fn new(min_distance_m: S) -> Self {
        Self { model: Model::Radial, evasion: Evasion::Multiple, min_distance_m }
    }
}

crate::parameters! {
    impl[S: Scalar] PushOutParams<S> { MIN_DISTANCE => min_distance_m }
}

/// How deep a step may lead into a zone, millimetres: the precision of positions.
const TOLERANCE_MM: i32 = 1;

/// Returns the velocity nearest to `wish_mps` by the rules of the model, m/s, for the next
/// [`Body::step_s`].
///
/// A step that does not come too near is the wish, limited to the body's speed; acceleration is
/// ignored. If all evading steps lead too near to something the robot stops, or takes the least
/// deep one if it is too near already. Zero if the time step or the least distance is not above 0.
///
/// `nearby` may be in any order. NaN counts as absent (a wish: as zero); the result is finite and
/// not faster than the body. O(n) if nothing is in the way, otherwise O(n^2), n = `nearby` +
/// `obstacles`.
#[inline(never)]
#[must_use]
pub fn push_out<S: Scalar>(
    params: &PushOutParams<S>,
    body: &Body<S>,
    wish_mps: Vec3<S>,
    nearby: &[Nearby<S>],
    obstacles: &[Obstacle<S>],
) -> Vec3<S> {
    let is_sound = params.min_distance_m > S::ZERO && params.min_distance_m.is_finite() && body.step_s > S::ZERO;
    let wish = wish_mps.clamp_norm(body.max_speed_mps);
    let step = wish * body.step_s;
    if !is_sound || !step.is_finite() {
        return Vec3::ZERO;
    }
    let mut scene = Scene { params, body, nearby, obstacles };
    if scene.depth(step, S::ZERO) <= S::ZERO {
        return wish;
    }
    if params.evasion == Evasion::Single {
        scene.nearby = scene.nearest_in_the_way(step);
    }
    let evading = scene.evade(step);
    let rate = |metres: S| metres.checked_div(body.step_s).unwrap_or(S::ZERO);
    Vec3::new(rate(evading.x), rate(evading.y), rate(evading.z)).clamp_norm(body.max_speed_mps)
}

struct Scene<'a, S> {
    params: &'a PushOutParams<S>,
    body: &'a Body<S>,
    nearby: &'a [Nearby<S>],
    obstacles: &'a [Obstacle<S>],
}

impl<'a, S: Scalar> Scene<'a, S> {
    fn zones(&self, step: Vec3<S>) -> impl Iterator<Item = Zone<S>> + use<'a, S> {
        let (body, least) = (self.body, self.params.min_distance_m);
        let obstacles = self.obstacles.iter();
        let obstacles = obstacles.filter_map(move |o| Zone::of_obstacle(o, body, least, step));
        let robots = self.nearby.iter();
        obstacles.chain(robots.filter_map(move |other| Zone::of_robot(other, body, least)))
    }

    /// How deep the step leads into a zone, beyond the tolerance; inexact above `limit`.
    fn depth(&self, step: Vec3<S>, limit: S) -> S {
        let (path, limit) = (Path::new(step), limit.max(S::from_milli(TOLERANCE_MM)));
        let mut deepest = S::ZERO;
        for zone in self.zones(step) {
            deepest = zone.depth_from(&path, deepest);
            if deepest > limit {
                return deepest;
            }
        }
        if deepest > S::from_milli(TOLERANCE_MM) { deepest } else { S::ZERO }
    }

    /// The nearest robot that the step leads too near to, if any. Ties by number.
    fn nearest_in_the_way(&self, step: Vec3<S>) -> &'a [Nearby<S>] {
        let tolerance = S::from_milli(TOLERANCE_MM);
        let in_the_way = self.nearby.chunks(1).filter(|one| {
            let zone = one.first().and_then(|other| Zone::of_robot(other, self.body, self.params.min_distance_m));
            zone.is_some_and(|zone| zone.depth(step) > tolerance)
        });
        let key = |one: &&[Nearby<S>]| one.first().map(|other| (other.offset_m.length_key(), other.id));
        in_the_way.min_by_key(key).unwrap_or(&[])
    }

    fn evade(&self, step: Vec3<S>) -> Vec3<S> {
        let model = self.params.model;
        let longest = self.body.max_speed_mps * self.body.step_s;
        let mut best = Best { depth: self.depth(Vec3::ZERO, S::MAX), change: u64::MAX, step: Vec3::ZERO };
        // Sideways is one step for all zones, except for vertical ones.
        let (mut has_sidestepped, mut has_sidestepped_upright) = (false, false);
        for zone in self.zones(step) {
            // Model 1 pushes out of zones that the step leads into; model 2 may pass between two
            // zones, along the border of one that is not in the way.
            let matters = match model {
                Model::Radial => zone.depth(step) > S::ZERO,
                Model::Tangential => zone.depth(Vec3::ZERO) > -longest,
            };
            if !matters {
                continue;
            }
            let has_tried = match zone.is_upright {
                true => &mut has_sidestepped_upright,
                false => &mut has_sidestepped,
            };
            let sides = if *has_tried { &zone::SIDES[..1] } else { &zone::SIDES[..] };
            *has_tried = model == Model::Radial;
            for &side in sides {
                let Some(evading) = zone.evade(step, model, side) else {
                    continue;
                };
                let evading = evading.clamp_norm(longest);
                if model == Model::Tangential {
                    best.consider(evading, step, |limit| self.depth(evading, limit));
                    continue;
                }
                let deepest = self.deepest(evading);
                best.consider(evading, step, |_| deepest.map_or(S::ZERO, |(depth, _)| depth));
                if let Some((_, other)) = deepest
                    && let Some(again) = other.evade(evading, model, Side::Rule)
                {
                    let again = again.clamp_norm(longest);
                    best.consider(again, step, |limit| self.depth(again, limit));
                }
            }
        }
        best.step
    }

    /// The deepest zone, beyond the tolerance, and its depth; the first of equals.
    fn deepest(&self, step: Vec3<S>) -> Option<(S, Zone<S>)> {
        let path = Path::new(step);
        let mut deepest = None;
        let mut most = S::from_milli(TOLERANCE_MM);
        for zone in self.zones(step) {
            let depth = zone.depth_from(&path, most);
            if depth > most {
                most = depth;
                deepest = Some((depth, zone));
            }
        }
        deepest
    }
}

/// Depths that differ by less are equal, micrometres: rounding.
const EQUAL_UM: i32 = 1;

/// The least deep step so far, then the one nearest to the wish, then the first.
struct Best<S> {
    depth: S,
    change: u64,
    step: Vec3<S>,
}

impl<S: Scalar> Best<S> {
    /// `depth` need not be exact beyond the limit given to it.
    fn consider(&mut self, evading: Vec3<S>, wish: Vec3<S>, depth: impl FnOnce(S) -> S) {
        let change = (evading - wish).length_key();
        if self.depth <= S::ZERO && change >= self.change {
            return;
        }
        let depth = depth(self.depth);
        let equal = S::from_micro(EQUAL_UM);
        if depth < self.depth - equal || (depth <= self.depth + equal && change < self.change) {
            *self = Self { depth, change, step: evading };
        }
    }
}
