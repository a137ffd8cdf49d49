//! Straight to a waypoint, by others on the way.

use super::beside::{Beside, Claim};
use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, ToWaypoints};
use super::{InPlane, Parameter, WAYPOINTS, Wait, Waypoint};
use crate::geom::Vec3;
use crate::rand::Rng;
use crate::scalar::Scalar;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Nearer than so many own radii, a waypoint on the way is passed: beside a robot that stands in it.
const PASSED_RADII: i32 = 3;

/// Straight to a waypoint, which may move; there it stays, and goes along with one that moves. If somebody else stands on
/// the last one, it has arrived beside him.
///
/// It goes by at most [`WAYPOINTS`] waypoints in the order of their numbers. Number 0 begins a course (what was before is
/// forgotten), the next number lengthens it, and one that is there already is moved. The last one is its goal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WaypointGuidance<S> {
    course: Vec<Waypoint<S>, WAYPOINTS, u8>,
    /// The one that it heads for.
    leg: u8,
    beside: Beside<S>,
    /// How near is there, metres.
    tolerance_m: S,
    /// Cruising speed, m/s; the body's own limit holds too.
    speed_mps: S,
}

impl<S: Scalar> WaypointGuidance<S> {
    /// Without a waypoint yet. `tolerance_m`: how near counts as being there, at least some millimetres, since
    /// waypoints are rounded to them; `speed_mps`: how fast it wants to go.
    #[must_use]
    pub const fn new(speed_mps: S, tolerance_m: S) -> Self {
        Self { course: Vec::new(), leg: 0, beside: Beside::NEW, tolerance_m, speed_mps }
    }

    /// The way to the waypoint that it heads for, metres, and that one's velocity; goes on to the next one when it is
    /// there. O([`WAYPOINTS`]).
    fn next<P>(&mut self, input: &GuidanceInput<'_, S, P>) -> Option<(Vec3<S>, Vec3<S>)> {
        let passed_m = self.tolerance_m.max(input.body.radius_m * S::from_i32(PASSED_RADII));
        let mut ahead = self.course.iter_mut().skip(usize::from(self.leg));
        let mut waypoint = ahead.next()?;
        let mut way = waypoint.way(input.state.position, input.now);
        for next in ahead {
            if way.norm() > passed_m {
                break;
            }
            self.leg = self.leg.saturating_add(1);
            waypoint = next;
            way = waypoint.way(input.state.position, input.now);
        }
        Some((way, waypoint.velocity_mps))
    }

    /// What [`Guidance::decide`] decides, whatever its robots tell each other.
    pub(super) fn head<P>(&mut self, input: &GuidanceInput<'_, S, P>) -> Result<Decision<S>, BadInput> {
        input.can_go()?;
        let (way, velocity_mps) = self.next(input).ok_or(BadInput)?;
        let is_last = usize::from(self.leg) + 1 >= self.course.len();
        let distance = way.norm();
        let speed = self.speed_mps.min(input.body.max_speed_mps);
        // On the last step no farther than the waypoint.
        let needed = distance.checked_div(input.body.step_s).unwrap_or(speed);
        let ahead = way.normalized().unwrap_or_default();
        let claim = match is_last && velocity_mps == Vec3::ZERO {
            true => self.beside.claim(input, way, self.tolerance_m),
            false => Claim::Goes,
        };
        let pace = match claim {
            Claim::Yields(room_m) if distance < room_m => -speed,
            Claim::Yields(_) => S::ZERO,
            Claim::Goes | Claim::IsBeside => needed.min(speed),
        };
        let is_beside = claim == Claim::IsBeside;
        let is_at_goal = is_last && distance <= self.tolerance_m || is_beside;
        Ok(Decision {
            // Who lets another one go first goes nowhere himself, and is in no jam.
            action: Action::Velocity {
                wish_mps: velocity_mps + ahead * pace,
                way_m: (!matches!(claim, Claim::Yields(_))).then_some(way),
            },
            status: Status {
                is_at_goal,
                waits_for: is_beside.then_some(Wait::Place),
                // Who stood when it is there would lose a waypoint that moves.
                makes_way: is_at_goal && velocity_mps != Vec3::ZERO,
                ..Status::default()
            },
            ..Decision::default()
        })
    }
}

impl<S> Teamwork for WaypointGuidance<S> {}

impl<S: Scalar> Guidance<S> for WaypointGuidance<S> {
    type Input<'a> = InPlane<'a, S>;
    type Destination = ToWaypoints;
    type Workspace = ();
    type Payload = ();

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S>,
        _: &InPlane<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Decision<S>, BadInput> {
        self.head(input)
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        if index == 0 {
            self.course.clear();
            self.leg = 0;
        }
        match self.course.get_mut(usize::from(index)) {
            Some(known) => {
                *known = *waypoint;
                true
            }
            None => usize::from(index) == self.course.len() && self.course.push(*waypoint).is_ok(),
        }
    }

    fn has_own_goal(&self) -> bool {
        !self.course.is_empty()
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        match parameter {
            Parameter::Speed => Some(self.speed_mps),
            Parameter::Tolerance => Some(self.tolerance_m),
            _ => None,
        }
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        match parameter {
            Parameter::Speed => self.speed_mps = value,
            Parameter::Tolerance => self.tolerance_m = value,
            _ => return false,
        }
        true
    }
}
