//! How much of a velocity a robot can have and still touch nobody, whatever became of the news.

use super::{Neighbor, NeighborTable, StalenessInflation};
use crate::body::Body;
use crate::geom::{Position, Vec3};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use heapless::Vec;

#[cfg(all(test, feature = "wire"))]
mod tests;

/// What is left between two bodies, millimetres: both places are told to a millimetre along each axis, and both robots may
/// leave [`TOLERANCE_UM`].
const ROUNDING_MM: i32 = 3;
/// Rounds in which a velocity is turned aside before it is shortened.
const ROUNDS: u8 = 6;
/// What the last round may leave, micrometres; part of the rounding.
const TOLERANCE_UM: i32 = 200;

/// The room that a robot has among those that it knows.
///
/// In a step a robot takes at most half of the gap to any other one, so that two which both do so cannot touch, however
/// long a step is. (D. Zhou, Z. Wang, S. Bandyopadhyay, M. Schwager, "Fast, on-line collision avoidance for dynamic
/// vehicles using buffered Voronoi cells", IEEE RA-L 2017, have the same as cells; here it limits what the safety layer
/// has chosen.) One that was not heard can be anywhere in a ball that grows, and the gap is that to the ball:
///
/// | the other one | its ball | own part of the gap |
/// | --- | --- | --- |
/// | is heard as ever | does not grow | half; all if it does not give way, less what it comes itself |
/// | has been silent for t beyond a step | grows by [`growth_mps`](StalenessInflation::growth_mps) t, though its border comes nearer by at most half of the gap in a step, as the robot itself does; with inertia, about the course that it had, by half of the acceleration times t^2 if that is less | the same |
/// | is lost, while at least half of all are fresh or the robot may be alone | the same, up to [`max_m`](StalenessInflation::max_m) | half |
///
/// Whoever's own centre is inside of such a ball stands. So no two touch each other at any loss of packets and in any
/// blackout, as long as nobody is faster than `growth_mps` and bodies do what they are told; one with inertia takes no
/// more than it can brake within.
#[derive(Clone, Copy, Debug)]
pub struct Room<'a, S> {
    /// Own body.
    pub body: &'a Body<S>,
    /// Own place.
    pub own: Position,
    /// Now.
    pub now: Instant,
    /// How old the latest news is when all is well: a step, or the radio's delay if that is longer. For so long others
    /// are taken to keep their velocities, which is the truth for a step.
    pub news: Duration,
    /// How far others may have come.
    pub inflation: StalenessInflation<S>,
    /// Whether to go on when most are lost, as if they stood.
    pub may_be_alone: bool,
}

/// What one robot or obstacle leaves.
#[derive(Clone, Copy)]
struct Limit<S> {
    /// The way there, of length 1.
    ahead: Vec3<S>,
    /// The sine of how far off that way it may be.
    slant: S,
    /// How far to go there in a step, metres; less than 0, by the tolerance at most, where that was taken already.
    room_m: S,
}

impl<S: Scalar> Limit<S> {
    /// How fast `velocity_mps` comes nearer, and the most that it may come nearer sideways besides, m/s.
    fn closing(&self, velocity_mps: Vec3<S>) -> (S, S) {
        let closing = velocity_mps.dot(self.ahead);
        let side = if self.slant > S::ZERO { (velocity_mps - self.ahead * closing).norm() } else { S::ZERO };
        (closing, side * self.slant)
    }

    /// The most that `velocity_mps` comes nearer in `step_s`, metres.
    fn taken(&self, velocity_mps: Vec3<S>, step_s: S) -> S {
        let (closing, side) = self.closing(velocity_mps);
        (closing + side) * step_s
    }
}

impl<S: Scalar> Room<'_, S> {
    /// What there is room for of `velocity_mps`, m/s: turned aside as far as that helps, along those of `obstacles` that it
    /// is turned towards, then shortened. `None`: one that is silent can be right here, so stand.
    ///
    /// O(N + obstacles), and a root or two for each robot; 20 N bytes of stack (`f32`).
    #[must_use]
    #[inline(never)]
    pub fn limit<const N: usize, P: Copy>(
        &self,
        table: &mut NeighborTable<S, N, P>,
        obstacles: &[Obstacle<S>],
        velocity_mps: Vec3<S>,
    ) -> Option<Vec3<S>> {
        let (known, lost, ages) = (table.as_slice(), table.lost(), table.ages());
        let is_fresh = |other: &&Neighbor<S, P>| other.age(self.now).is_some_and(|age| age <= ages.stale_after);
        let fresh = known.iter().filter(is_fresh).count();
        let is_bad = !self.may_be_alone && fresh + fresh < known.len() + lost.len();
        let mut limits = Vec::<Limit<S>, N>::new();
        let mut is_hidden = false;
        for other in &mut table.entries {
            let (limit, is_here) = self.limit_of(other, is_bad);
            is_hidden |= is_here;
            // As many places as entries.
            let _ = limits.push(limit);
        }
        let step_s = self.body.step_s;
        let mut v = if is_hidden { Vec3::ZERO } else { velocity_mps };
        for _ in 0..ROUNDS {
            let mut is_turned = false;
            for limit in &limits {
                let (closing, side) = limit.closing(v);
                let most = limit.room_m.checked_div(step_s).unwrap_or(S::ZERO) - side;
                if closing > most && closing > S::ZERO {
                    v -= limit.ahead * (closing - most.max(S::ZERO));
                    is_turned = true;
                }
            }
            // The next round would do as little.
            if !is_turned {
                break;
            }
        }
        // The safety layer has seen to them, unless the way is another one.
        if v != velocity_mps {
            for (point, distance) in obstacles.iter().filter_map(Obstacle::nearest_point) {
                let ahead = point.normalized().unwrap_or(Vec3::ZERO);
                let room_m = distance - self.body.radius_m - S::from_milli(ROUNDING_MM);
                let most = room_m.max(S::ZERO).checked_div(step_s).unwrap_or(S::ZERO);
                v -= ahead * (v.dot(ahead) - most).max(S::ZERO);
            }
        }
        let mut share = S::ONE;
        for limit in &limits {
            let taken_m = limit.taken(v, step_s) - S::from_micro(TOLERANCE_UM);
            if taken_m > limit.room_m {
                share = share.min(limit.room_m.max(S::ZERO).checked_div(taken_m).unwrap_or(S::ZERO));
            }
        }
        let v = v * share;
        for (other, limit) in table.entries.iter_mut().zip(&limits) {
            other.gap_m = other.gap_m * S::HALF - limit.taken(v, step_s);
        }
        (!is_hidden).then_some(v)
    }

    /// What a robot leaves, and whether it can be right here. Notes the least gap to it.
    fn limit_of<P>(&self, other: &mut Neighbor<S, P>, is_bad: bool) -> (Limit<S>, bool) {
        let Room { body, inflation, .. } = self;
        let age = other.age(self.now).unwrap_or(Duration::MAX);
        let silent = age.as_micros().saturating_sub(self.news.as_micros()).max(0);
        let silent_s = S::from_micro(silent);
        let is_parked = other.is_lost && !is_bad;
        let mut grown = inflation.growth_mps * silent_s;
        if is_parked {
            grown = grown.min(inflation.max_m);
        }
        // Up to here it went as it had said; with inertia it cannot leave that course at once, only a step's worth of it.
        let most = body.max_acceleration_mps2;
        let swerve_mps = most * (silent_s + body.step_s);
        let swerves = !is_parked && swerve_mps * S::HALF < inflation.growth_mps;
        let offset_m = other.offset_at(self.own, self.now, if swerves { age } else { self.news });
        let distance = offset_m.norm();
        let ahead = offset_m.normalized().unwrap_or(Vec3::ZERO);
        let told_mps = -other.velocity_mps.dot(ahead);
        if swerves {
            grown = swerve_mps * S::HALF * silent_s;
        }
        let mut gap = distance - body.radius_m - other.radius_m - S::from_milli(ROUNDING_MM) - grown;
        // One that does not give way comes as it likes.
        if silent > 0 && !is_parked && other.mode.gives_way() {
            gap = gap.max(other.gap_m);
        }
        other.gap_m = gap;
        let comes_mps = match silent {
            0 => told_mps,
            _ if is_parked => S::ZERO,
            _ if swerves => told_mps + swerve_mps,
            _ => inflation.growth_mps,
        };
        let room_m = if !other.mode.gives_way() {
            self.brakes(gap - comes_mps * body.step_s, comes_mps.max(S::ZERO))
        } else if silent > 0 {
            self.brakes(gap * S::HALF, comes_mps.max(S::ZERO) * S::HALF)
        } else {
            self.brakes((gap * S::HALF).min(gap - self.way_to_stand(comes_mps)), S::ZERO)
        };
        let slant = grown.checked_div(distance).unwrap_or(S::ZERO);
        (Limit { ahead, slant, room_m: room_m.max(-S::from_micro(TOLERANCE_UM)) }, silent > 0 && grown >= distance)
    }

    /// The way in which a body like the own one comes to stand, metres; 0 without inertia.
    fn way_to_stand(&self, speed_mps: S) -> S {
        let most = self.body.max_acceleration_mps2;
        let speed = speed_mps.max(S::ZERO);
        if most >= S::MAX { S::ZERO } else { (speed * speed * S::HALF).checked_div(most).unwrap_or(S::ZERO) }
    }

    /// How far to go in a step so that the body can stand within `left`, metres, which shrinks at `growth_mps` until it
    /// does.
    fn brakes(&self, left: S, growth_mps: S) -> S {
        let Body { step_s, max_acceleration_mps2: most, .. } = *self.body;
        if most >= S::MAX || left <= S::ZERO {
            return left;
        }
        // v step + v^2 / 2 most + growth v / most = left.
        let lag = most * step_s + growth_mps;
        ((lag * lag + most * left * S::TWO).sqrt() - lag) * step_s
    }
}
