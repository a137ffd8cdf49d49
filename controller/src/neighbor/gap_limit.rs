//! Limits a velocity so that robots cannot touch at any age of their neighbours' states.

use super::rounding::{OFFSET_ERROR_UM, ROUNDING_MM, TOLERANCE_UM};
use super::{Neighbor, NeighborTable, StalenessInflation, Trace};
use crate::body::Body;
use crate::geom::{Position, Vec3};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use heapless::Vec;

#[cfg(all(test, feature = "wire"))]
mod tests;

/// Part of a gap that a velocity which is turned aside leaves in addition, micrometres: more than
/// the rounding of the operations.
const GRAIN_UM: i32 = 20;
const ROUNDS: u8 = 6;
/// Time in which others tell of a robot that they hear, in units of the silence after which it is
/// lost.
const TOLD_BY: i32 = 2;

/// Limits a velocity by the gaps to the known robots, so that no two robots touch.
///
/// | neighbour | where it may be |
/// | --- | --- |
/// | up to date | on the path that it told, at the latest until the end of its step |
/// | silent for t beyond a step | in a ball around that end, that grows at [`growth_mps`] |
/// | lost | in that ball; from twice the silence on, at most [`max_m`] larger |
/// | told by another one | in a ball around that place, which grows at [`growth_mps`] |
///
/// [`growth_mps`]: StalenessInflation::growth_mps
/// [`max_m`]: StalenessInflation::max_m
///
/// A command is carried out for one step; then a body without inertia stands. Gaps are measured
/// from the end of the own path to the end of the other one. In a step the robot takes at most half
/// of the gap to a neighbour, or all of it if that neighbour does not give way, minus the
/// neighbour's own approach. A robot inside such a ball stands still. The guarantee holds at any
/// packet loss and in any blackout, as long as no robot is faster than `growth_mps` and bodies
/// follow their commands.
///
/// *Why half:* two robots that both take at most half of the gap in a step cannot touch, however
/// long the step is (D. Zhou, Z. Wang, S. Bandyopadhyay, M. Schwager, "Fast, on-line collision
/// avoidance for dynamic vehicles using buffered Voronoi cells", IEEE RA-L 2017). The rule also
/// limits the ball of a silent neighbour that gives way: of half of the last gap, what the own
/// motion has not taken is left in any case.
///
/// *Direction:* a motion takes the largest approach to any place where the neighbour may be.
/// Towards a ball that is the approach to the nearest direction of its cone.
///
/// *Out of phase:* robots decide at any instants. A neighbour that recedes may still be on its
/// path, anywhere from its start on, so the own path also stays off the nearest point of that path.
///
/// *Inertia:* the ball follows the last course of the body and grows by half of its acceleration
/// times t^2, if that is less. The own robot takes no more of a gap than it can brake within.
/// Braking for one neighbour leaves less acceleration for the others, so a velocity is allowed only
/// if braking straight along it keeps all gaps at once: closing speed times half of the braking
/// time counts, not the braking distance of the closing speed alone. Straight braking then remains
/// possible in the next step, and the robot takes it if it can reach no allowed velocity.
///
/// *Lag:* a body that is commanded to stand still covers its velocity times the lag, in a straight
/// line. That much of a gap is taken already, by the own body and by a neighbour that comes nearer.
/// So it is of the distance to an obstacle, before which the body has to stop.
///
/// *Downwash:* all distances and closing speeds between robots are those of a space with heights
/// divided by [`downwash`](Self::downwash). Ellipsoids are balls there, and braking stays straight.
///
/// *Lost robots:* their balls stop growing at `max_m` only while at least half of all robots are
/// fresh (of the lost ones, those count that have not [stood](Self::stands_after) for
/// long), or if the robot [may be alone](Self::may_be_alone).
#[derive(Clone, Copy, Debug)]
pub struct GapLimit<'a, S> {
    /// Own body.
    pub body: &'a Body<S>,
    /// Own position.
    pub own: Position,
    /// Own velocity, m/s; matters with a lag only, when that of `body` is its last command.
    pub own_mps: Vec3<S>,
    /// Time constant with which all bodies follow their commands (first order), seconds.
    pub lag_s: S,
    /// Current time.
    pub now: Instant,
    /// Time between two decisions of a robot, the same for all.
    pub tick: Duration,
    /// Time since the own last decision: a tick, or more if this one is late.
    pub elapsed: Duration,
    /// Whether all robots decide at the same instants.
    pub is_synchronous: bool,
    /// Age of a beacon when it is first used. One that is a `tick` old at most tells where the path
    /// of its sender ends; with each further tick the sender may have decided once more.
    pub latency: Duration,
    /// Growth of the balls around silent robots.
    pub inflation: StalenessInflation<S>,
    /// Whether lost robots count as standing even when most robots are lost.
    pub may_be_alone: bool,
    /// Silence after which a lost robot counts as standing in any case.
    pub stands_after: Duration,
    /// Whether the robot may follow a robot that recedes: the way on which that one can brake at
    /// most adds to the gap.
    pub is_agreed: bool,
    /// Whether others hear this robot: otherwise none gives way to it.
    pub is_heard: bool,
    /// Ratio of vertical to horizontal distance between robots, the same for all; at least 1.
    pub downwash: S,
}

#[derive(Clone, Copy)]
struct Limit<S> {
    /// Direction of the neighbour, in the space with lowered heights, as all that follows.
    ahead: Vec3<S>,
    /// Sine of the angle by which `ahead` may be wrong.
    slant: S,
    /// Its cosine; 1 if the angle is that of rounding only.
    cos: S,
    /// Permitted approach until the robot stands, metres; negative, within tolerance, without a
    /// gap.
    left_m: S,
    /// Speed at which the gap shrinks meanwhile, m/s.
    growth_mps: S,
}

/// A velocity in the space with lowered heights, and its length, m/s.
#[derive(Clone, Copy)]
struct Pace<S> {
    velocity_mps: Vec3<S>,
    speed_mps: S,
}

impl<S: Scalar> Pace<S> {
    /// Whether no approach at this pace reaches `mps`: twice the speed is more than its rounding.
    fn is_below(&self, mps: S) -> bool {
        self.speed_mps + self.speed_mps <= mps
    }
}

impl<S: Scalar> Limit<S> {
    /// The largest closing speed in any direction of the cone, m/s.
    fn approach(&self, pace: &Pace<S>) -> S {
        let closing = pace.velocity_mps.dot(self.ahead);
        if self.cos >= S::ONE {
            return (closing + pace.speed_mps * self.slant).min(pace.speed_mps);
        }
        let side = (pace.velocity_mps - self.ahead * closing).norm();
        // Inside the cone, or towards its edge.
        let is_inside = side * self.cos <= closing * self.slant;
        if is_inside { pace.speed_mps } else { closing * self.cos + side * self.slant }
    }

    /// The change of the closing speed after which the approach is `most_mps`, m/s, if nothing else
    /// of the velocity changes; the opposite of its speed at most.
    fn turn(&self, pace: &Pace<S>, most_mps: S) -> S {
        let closing = pace.velocity_mps.dot(self.ahead);
        let speed = pace.speed_mps;
        let side = (pace.velocity_mps - self.ahead * closing).norm();
        let wanted = if side <= most_mps * self.slant {
            // Inside the cone the speed counts.
            (most_mps * most_mps - side * side).max(S::ZERO).sqrt()
        } else if self.cos < S::ONE {
            (most_mps - side * self.slant).checked_div(self.cos).unwrap_or(-speed).max(-speed)
        } else {
            most_mps - (most_mps + side) * self.slant
        };
        wanted - closing
    }

    /// The part of a velocity, from 0 to 1, from which the robot stops within the gap after this
    /// step. `brake_s` is the time to brake from the whole velocity.
    fn share(&self, pace: &Pace<S>, step_s: S, brake_s: S) -> S {
        let (closing, left_m) = (self.approach(pace), self.left_m.max(S::ZERO));
        let (now, later) = (closing * step_s + self.growth_mps * brake_s, closing * brake_s * S::HALF);
        if closing <= S::ZERO || now + later - S::from_micro(TOLERANCE_UM) <= self.left_m {
            return S::ONE;
        }
        if brake_s <= S::ZERO {
            return left_m.checked_div(now - S::from_micro(TOLERANCE_UM)).unwrap_or(S::ZERO);
        }
        // Solves share now + share^2 later = left, without cancellation.
        let root = (now * now + later * left_m * S::from_i32(4)).sqrt();
        (left_m * S::TWO).checked_div(now + root).unwrap_or(S::ZERO).min(S::ONE)
    }
}

/// The cosine of the angle with this sine: the least one that rounding leaves possible, below 1.
fn cos_of<S: Scalar>(side_m: S, distance_m: S) -> S {
    let squared = (distance_m - side_m) * (distance_m + side_m);
    let cos = squared.max(S::ZERO).sqrt().checked_div(distance_m).unwrap_or(S::ZERO);
    cos.min(S::ONE - S::from_micro(1))
}

impl<S: Scalar> GapLimit<'_, S> {
    /// Returns the part of `velocity_mps`, m/s, that the gaps allow: first turned aside, without
    /// running into `obstacles`, then shortened. `None` if a silent robot may be at the own
    /// position: stand still. O(N + obstacles); 24 N bytes of stack (`f32`).
    #[must_use]
    #[inline(never)]
    pub fn limit<const N: usize, P: Copy>(
        &self,
        table: &mut NeighborTable<S, N, P>,
        obstacles: &[Obstacle<S>],
        velocity_mps: Vec3<S>,
    ) -> Option<Vec3<S>> {
        let parked_after = self.parked_after(table);
        let mut limits = Vec::<Limit<S>, N>::new();
        let mut is_hidden = false;
        for other in &mut table.entries {
            // One machine code for all payloads.
            let mut bare = other.map(|_| None);
            let (limit, is_here) = self.limit_of(&mut bare, parked_after);
            other.gap_m = bare.gap_m;
            is_hidden |= is_here;
            // Both have capacity N.
            let _ = limits.push(limit);
        }
        let wanted_mps = if is_hidden { Vec3::ZERO } else { velocity_mps };
        let aside_mps = self.aside(&limits, wanted_mps);
        // The safety layer has considered obstacles for the original velocity, without braking.
        let is_checked = !self.brakes_for_walls() && aside_mps == velocity_mps;
        let v = if is_checked { aside_mps } else { self.before(obstacles, aside_mps) };
        let (v, reached_mps) = self.shortened(&limits, obstacles, v);
        let (pace, own) = (self.pace(reached_mps), self.pace(self.own_mps));
        for (other, limit) in table.entries.iter_mut().zip(&limits) {
            if !other.is_lost() {
                other.gap_m = other.gap_m * S::HALF - self.taken_m(limit, &pace, &own);
            }
        }
        (!is_hidden).then_some(v)
    }

    /// Turns a velocity aside, as far as that takes few rounds. O(limits).
    #[inline(never)]
    fn aside(&self, limits: &[Limit<S>], mut v: Vec3<S>) -> Vec3<S> {
        let step_s = self.body.step_s;
        let per_s = |brake_s: S| S::ONE.checked_div(step_s + brake_s * S::HALF).unwrap_or(S::ZERO);
        let (mut pace, mut brake_s) = (self.pace(v), self.brake_s(v));
        let mut rate = per_s(brake_s);
        for _ in 0..ROUNDS {
            let mut is_turned = false;
            for limit in limits {
                let left_m = (limit.left_m - limit.growth_mps * brake_s).max(S::ZERO);
                let most_mps = left_m * rate;
                if pace.is_below(most_mps) {
                    continue;
                }
                // A robot is turned away from another one only if it could not move otherwise.
                let turns_away = left_m <= S::from_micro(TOLERANCE_UM);
                let closing = pace.velocity_mps.dot(limit.ahead);
                if limit.approach(&pace) > most_mps && (turns_away || closing > S::ZERO) {
                    let aim_m = left_m - S::from_micro(GRAIN_UM);
                    let change = limit.turn(&pace, aim_m * rate);
                    let change = if turns_away { change } else { change.max(-closing) };
                    v += self.along(limit.ahead) * change;
                    (pace, brake_s) = (self.pace(v), self.brake_s(v));
                    rate = per_s(brake_s);
                    is_turned = true;
                }
            }
            if !is_turned {
                break;
            }
        }
        v.clamp_norm(self.body.max_speed_mps)
    }

    /// The part of a velocity that the gaps allow, and the velocity that the body reaches with it
    /// in this step. O(limits + obstacles).
    #[inline(never)]
    fn shortened(&self, limits: &[Limit<S>], obstacles: &[Obstacle<S>], v: Vec3<S>) -> (Vec3<S>, Vec3<S>) {
        let allowed = |v: Vec3<S>| {
            let (brake_s, pace) = (self.brake_s(v), self.pace(v));
            let shares = limits.iter().map(|limit| limit.share(&pace, self.body.step_s, brake_s));
            shares.fold(S::ONE, Scalar::min)
        };
        let v = v * allowed(v);
        if !self.body.has_inertia() {
            return (v, v);
        }
        let reached = self.body.reach(v);
        // From the present velocity the body may reach none that is allowed.
        let off_mps = if self.brakes_for_walls() { self.before(obstacles, reached) - reached } else { Vec3::ZERO };
        if allowed(reached) < S::ONE || off_mps.norm() > S::from_micro(TOLERANCE_UM) {
            return (Vec3::ZERO, self.body.reach(Vec3::ZERO));
        }
        (v, reached)
    }

    /// Length of a gap that a step at this pace takes, metres. `own` is the present pace.
    #[inline(never)]
    fn taken_m(&self, limit: &Limit<S>, pace: &Pace<S>, own: &Pace<S>) -> S {
        let mut taken_mps = limit.approach(pace);
        if self.lag_s > S::ZERO {
            // The body moves at a velocity between the present one and the commanded one.
            taken_mps = taken_mps.max(limit.approach(own));
        }
        if !self.is_synchronous {
            // The other robot may decide after this motion, and take half of the gap that it adds.
            taken_mps = taken_mps.max(S::ZERO);
        }
        taken_mps * self.body.step_s
    }

    /// Silence after which a lost robot counts as standing: time for others to tell that they hear
    /// it. Longer if its silence may be that of the own radio.
    fn parked_after<const N: usize, P: Copy>(&self, table: &NeighborTable<S, N, P>) -> Duration {
        let told_by = table.ages().expire_after.saturating_mul(TOLD_BY).min(self.stands_after);
        if self.is_bad(table) { self.stands_after } else { told_by }
    }

    /// Whether lost robots may be moving: their silence may be that of the own radio.
    fn is_bad<const N: usize, P: Copy>(&self, table: &NeighborTable<S, N, P>) -> bool {
        let (known, lost, ages) = (table.as_slice(), table.lost(), table.ages());
        let is_fresh = |other: &&Neighbor<S, P>| other.age(self.now).is_some_and(|age| age <= ages.stale_after);
        let fresh = known.iter().filter(is_fresh).count();
        let stands = |other: &&Neighbor<S, P>| other.age(self.now).is_none_or(|age| age > self.stands_after);
        let lost = lost.len() - lost.iter().filter(stands).count();
        !self.may_be_alone && fresh + fresh < known.len() + lost
    }

    /// How often a robot may have decided since a state of this age, without being heard; negative
    /// before the state.
    fn silent_steps(&self, age_us: i32) -> i32 {
        let (tick_us, first_us) = (self.tick.as_micros(), self.latency.min(self.tick).as_micros());
        let silent_us = age_us.saturating_sub(first_us);
        // Half of a step is left for delays that cannot be known exactly: a quarter for the radio,
        // and an eighth each for the step that received the beacon and for this one.
        let late_us = tick_us - (tick_us >> 3) - 1;
        if (-late_us..=0).contains(&silent_us) {
            return 0;
        }
        silent_us.saturating_add(late_us).checked_div_euclid(tick_us).unwrap_or(0)
    }

    /// Returns the limit, and whether the robot can be at the own position. Stores the gap bound.
    #[inline(never)]
    fn limit_of(&self, other: &mut Neighbor<S>, parked_after: Duration) -> (Limit<S>, bool) {
        let GapLimit { body, inflation, .. } = self;
        let age = other.age(self.now).unwrap_or(Duration::MAX);
        let steps = self.silent_steps(age.as_micros());
        let is_silent = steps > 0;
        let silent_s = S::from_micro(self.tick.saturating_mul(steps.max(0)).as_micros());
        let is_parked = other.is_lost() && age > parked_after;
        let mut grown = inflation.growth_mps * silent_s;
        if is_parked {
            grown = grown.min(inflation.max_m);
        }
        // A body with inertia leaves its course gradually: extrapolate it over its whole age.
        let most = body.max_acceleration_mps2;
        let swerve_mps = most * (silent_s + body.step_s);
        let has_course = other.trace != Trace::Told;
        let swerves = !is_parked && has_course && swerve_mps * S::HALF < inflation.growth_mps;
        let course_mps = if has_course { self.lowered(other.velocity_mps) } else { Vec3::ZERO };
        let ahead_s = if swerves { silent_s + body.step_s } else { body.step_s };
        let offset_m = self.lowered(other.position.since::<S>(self.own)) + course_mps * ahead_s;
        let distance = offset_m.norm();
        let ahead = offset_m.normalized().unwrap_or(Vec3::ZERO);
        let told_mps = -course_mps.dot(ahead);
        if swerves {
            grown = swerve_mps * S::HALF * silent_s;
        }
        let radii_m = body.radius_m + other.radius_m + S::from_milli(ROUNDING_MM);
        let ball_m = distance - radii_m - grown;
        let mut gap = ball_m;
        // A neighbour that does not give way need not keep to half of the gap.
        let gives_way = self.is_heard && other.mode.gives_way();
        if is_silent && !other.is_lost() && gives_way {
            // It may have decided once since the own last decision; if more often, nothing is left.
            let before_us = age.as_micros().saturating_sub(self.elapsed.as_micros());
            let is_kept = steps <= self.silent_steps(before_us).saturating_add(1);
            let kept_m = if is_kept { other.gap_m } else { S::ZERO };
            // Both may have taken the tolerance since.
            gap = gap.max(kept_m - S::from_micro(TOLERANCE_UM) * S::TWO);
        }
        let comes_mps = match is_silent {
            false => told_mps,
            _ if is_parked => S::ZERO,
            _ if swerves => told_mps + swerve_mps,
            _ => inflation.growth_mps,
        };
        let (left_m, growth_mps) = if !gives_way {
            (gap - comes_mps * body.step_s, comes_mps.max(S::ZERO))
        } else if is_silent {
            (gap * S::HALF, comes_mps.max(S::ZERO) * S::HALF)
        } else {
            let other_s = self.brake_s(other.velocity_mps) * S::HALF + self.lag_s;
            let other_m = comes_mps.max(S::ZERO) * other_s;
            ((gap * S::HALF).min(gap - other_m), S::ZERO)
        };
        let left_m = if self.is_agreed { left_m + body.braking_m(-comes_mps) } else { left_m };
        let mut reach_m = S::from_micro(OFFSET_ERROR_UM);
        if is_silent {
            reach_m += grown + if other.is_lost() { other.gap_m } else { S::ZERO };
        }
        if !other.is_lost() {
            // Out of phase it may decide twice until the own next decision, but not each time.
            let is_first = !self.is_synchronous && gap <= ball_m;
            other.gap_m = if is_first { gap * S::HALF } else { gap };
        }
        let rounded_m = if is_silent { S::ZERO } else { reach_m * S::HALF };
        let slant = reach_m.checked_div(distance - rounded_m).unwrap_or(S::ONE);
        let cos = if is_silent { cos_of(reach_m, distance) } else { S::ONE };
        let mut limit = Limit { ahead, slant, cos, left_m, growth_mps };
        if !is_silent && !self.is_synchronous && (told_mps < S::ZERO || gap < S::ZERO) {
            let told_m = course_mps * body.step_s;
            // At least as long as the path: most neighbours are farther away.
            let longest_m = told_m.x.abs() + told_m.y.abs() + told_m.z.abs();
            if ball_m - longest_m < body.max_speed_mps * body.step_s {
                self.keep_off_path(&mut limit, offset_m, told_m, radii_m);
            }
        }
        if self.lag_s > S::ZERO {
            // Distance that the body still covers, if it is commanded to stand.
            limit.left_m -= limit.approach(&self.pace(self.own_mps)) * self.lag_s;
        }
        limit.left_m = limit.left_m.max(-S::from_micro(TOLERANCE_UM));
        (limit, is_silent && reach_m >= distance)
    }

    /// Limits the approach to the nearest point of the path `told_m`, which ends at `end_m` and
    /// which a robot may still be on: the whole gap, since that path does not change. Without a gap
    /// the motion must lead away from all of the path.
    fn keep_off_path(&self, limit: &mut Limit<S>, end_m: Vec3<S>, told_m: Vec3<S>, radii_m: S) {
        let back = end_m.dot(told_m).checked_div(told_m.norm_squared()).unwrap_or(S::ZERO);
        let nearest_m = end_m - told_m * back.max(S::ZERO).min(S::ONE);
        let (distance, error_m) = (nearest_m.norm(), S::from_micro(OFFSET_ERROR_UM));
        let gap_m = distance - radii_m;
        if gap_m >= self.body.max_speed_mps * self.body.step_s {
            return;
        }
        limit.left_m = limit.left_m.min(gap_m);
        let far_m = if gap_m < S::ZERO { end_m - told_m } else { nearest_m };
        let sin = far_m.cross(limit.ahead).norm().checked_div(far_m.norm()).unwrap_or(S::ONE);
        let rounded = error_m.checked_div(distance - error_m).unwrap_or(S::ONE);
        limit.slant = (sin + rounded).min(S::ONE);
        if far_m.dot(limit.ahead) <= S::ZERO {
            // The path leads past the own place: each motion counts whole.
            (limit.ahead, limit.slant) = (Vec3::ZERO, S::ONE);
        }
        limit.cos = cos_of(limit.slant, S::ONE);
    }

    /// Turns a velocity aside so that a step with it ends before the obstacles; a body with a
    /// lag or inertia can also brake along it before them.
    #[inline(never)]
    fn before(&self, obstacles: &[Obstacle<S>], mut v: Vec3<S>) -> Vec3<S> {
        let (mut span_s, mut rolls_m) = (self.body.step_s, Vec3::ZERO);
        if self.brakes_for_walls() {
            span_s += self.brake_s(v) * S::HALF;
            rolls_m = self.own_mps * self.lag_s;
        }
        for (point, distance) in obstacles.iter().filter_map(Obstacle::nearest_point) {
            let ahead = point.normalized().unwrap_or(Vec3::ZERO);
            let room_m = distance - self.body.radius_m - S::from_milli(ROUNDING_MM) - rolls_m.dot(ahead);
            let most = room_m.max(S::ZERO).checked_div(span_s).unwrap_or(S::ZERO);
            v -= ahead * (v.dot(ahead) - most).max(S::ZERO);
        }
        v
    }

    /// Whether the body must be able to brake before obstacles after this step.
    fn brakes_for_walls(&self) -> bool {
        self.lag_s > S::ZERO || self.is_agreed || self.body.has_inertia()
    }

    fn pace(&self, v: Vec3<S>) -> Pace<S> {
        let velocity_mps = self.lowered(v);
        Pace { velocity_mps, speed_mps: velocity_mps.norm() }
    }

    /// The vector with its height divided by the downwash.
    fn lowered(&self, v: Vec3<S>) -> Vec3<S> {
        if self.downwash <= S::ONE { v } else { Vec3::new(v.x, v.y, v.z.checked_div(self.downwash).unwrap_or(v.z)) }
    }

    /// The shortest change of velocity by which the closing speed along `ahead` changes by 1 m/s.
    fn along(&self, ahead: Vec3<S>) -> Vec3<S> {
        let along = self.lowered(ahead);
        if self.downwash <= S::ONE { ahead } else { along * S::ONE.checked_div(along.dot(along)).unwrap_or(S::ZERO) }
    }

    /// Time to brake to rest, seconds; 0 without inertia.
    fn brake_s(&self, velocity_mps: Vec3<S>) -> S {
        let most = self.body.max_acceleration_mps2;
        if most >= S::MAX { S::ZERO } else { velocity_mps.norm().checked_div(most).unwrap_or(S::ZERO) }
    }
}
