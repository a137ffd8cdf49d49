//! Lets an operator take over a robot temporarily.

use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, pass_on};
use super::waypoint_guidance::WaypointGuidance;
use super::{Wait, Waypoint, WrongTask};
use crate::geom::Vec3;
use crate::grid::Cell;
use crate::land::LandPatch;
use crate::neighbor::Tracker;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// A command of an operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Wish<S> {
    /// Follow the own guidance law.
    #[default]
    Own,
    /// Release control: the motors are off, or another controller steers. In
    /// [`Mode::Passive`](crate::robot::Mode::Passive) others do not rely on it giving way.
    Off,
    /// Stay at the current position, and give way to other robots.
    Hold,
    /// Move with a velocity within the abilities of the body for a limited time, then hold.
    Velocity {
        /// The velocity, m/s.
        velocity_mps: Vec3<S>,
        /// Lifetime unless renewed; at most 35 minutes.
        valid: Duration,
    },
    /// Go to a waypoint and stay there, as [`WaypointGuidance`] does; follow it if it moves.
    Waypoint {
        /// The waypoint at the time of the command, and its velocity.
        waypoint: Waypoint<S>,
        /// Lifetime unless renewed; `None`: until another command.
        valid: Option<Duration>,
    },
    /// On the grid: go to a cell with the own guidance law.
    Cell(Cell),
}

/// Guidance law `G`, which an operator can override. The safety layer still avoids other robots,
/// and followers see in the beacon that this robot left the formation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Commanded<S, G> {
    inside: G,
    wish: Wish<S>,
    /// When the command took effect.
    since: Option<Instant>,
    straight: WaypointGuidance<S>,
}

impl<S: Scalar, G> Commanded<S, G> {
    /// Wraps `inside`; speed and arrival distance `tolerance_m` apply to [`Wish::Waypoint`].
    #[must_use]
    pub const fn new(inside: G, speed_mps: S, tolerance_m: S) -> Self {
        Self { inside, wish: Wish::Own, since: None, straight: WaypointGuidance::new(speed_mps, tolerance_m) }
    }

    /// Sets the command from the next step on.
    ///
    /// # Errors
    /// [`WrongTask`], with the previous command still active, for a velocity or a waypoint if the
    /// law moves cell by cell, a cell if it does not go to cells, and a velocity that is not
    /// finite.
    pub fn command(&mut self, wish: Wish<S>) -> Result<(), WrongTask>
    where
        G: Guidance<S>,
    {
        let is_possible = match &wish {
            Wish::Own | Wish::Off | Wish::Hold => true,
            Wish::Velocity { velocity_mps, .. } => self.inside.goes_by_velocity() && velocity_mps.is_finite(),
            Wish::Waypoint { .. } => self.inside.goes_by_velocity(),
            Wish::Cell(_) => self.inside.goes_to_cells(),
        };
        if !is_possible {
            return Err(WrongTask);
        }
        self.wish = wish;
        self.since = None;
        Ok(())
    }

    /// The active command; [`Wish::Hold`] after a command has expired.
    #[must_use]
    pub const fn wish(&self) -> &Wish<S> {
        &self.wish
    }

    /// The wrapped guidance law.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.inside
    }

    fn renew(&mut self, now: Instant) {
        let valid = match &mut self.wish {
            Wish::Velocity { valid, .. } => Some(*valid),
            Wish::Waypoint { valid, .. } => *valid,
            _ => None,
        };
        let Some(since) = self.since else {
            self.since = Some(now);
            if let Wish::Waypoint { waypoint, .. } = &mut self.wish {
                waypoint.at = now;
                let _ = self.straight.assign_waypoint(0, waypoint);
            }
            return;
        };
        let age = now.since(since);
        if valid.is_some_and(|valid| age < Duration::ZERO || age >= valid) {
            self.wish = Wish::Hold;
        }
    }
}

fn on_order<S>(action: Action<S>, goal: Cell) -> Decision<S> {
    let stays = matches!(action, Action::Stay);
    Decision {
        action,
        status: Status { waits_for: stays.then_some(Wait::Stopped), recovers: !stays, ..Status::default() },
        target: goal,
        leader: RobotId::NONE,
        slot: 0,
        asks: heapless::Vec::new(),
    }
}

impl<S, G: Teamwork> Teamwork for Commanded<S, G> {
    pass_on!(orders: self => self.inside);
    pass_on!(land: self => self.inside);
}

/// Distance of the way point of a commanded velocity, own radii: farther than robots swerve.
const LEADS_TO_RADII: i32 = 100;

impl<S: Scalar, G: Guidance<S>> Guidance<S> for Commanded<S, G> {
    type Input<'a> = G::Input<'a>;
    type Destination = G::Destination;
    type Workspace = G::Workspace;
    type Payload = G::Payload;

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S, Self::Payload>,
        here: &Self::Input<'_>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        self.renew(input.now);
        match self.wish {
            Wish::Own => self.inside.decide(input, here, rng, workspace),
            Wish::Off => Ok(on_order(Action::Release, input.goal)),
            Wish::Hold => Ok(on_order(Action::Stay, input.goal)),
            Wish::Velocity { velocity_mps, .. } => {
                input.can_go()?;
                let wish_mps = velocity_mps.clamp_norm(input.body.max_speed_mps);
                // Lets two robots that are sent against each other pass.
                let far_m = input.body.radius_m * S::from_i32(LEADS_TO_RADII);
                let way_m = wish_mps.normalized().map(|ahead| ahead * far_m);
                let action = Action::Velocity { wish_mps, way_m };
                Ok(on_order(action, input.goal))
            }
            Wish::Waypoint { .. } => {
                let mut decision = self.straight.head(input)?;
                decision.target = input.goal;
                decision.status.recovers = true;
                Ok(decision)
            }
            Wish::Cell(goal) => {
                let input = GuidanceInput { goal, ..*input };
                self.inside.decide(&input, here, rng, workspace)
            }
        }
    }

    fn goes_to_cells(&self) -> bool {
        self.inside.goes_to_cells()
    }

    fn goes_by_velocity(&self) -> bool {
        self.inside.goes_by_velocity()
    }

    fn has_own_goal(&self) -> bool {
        self.wish != Wish::Own || self.inside.has_own_goal()
    }

    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        self.inside.tracker()
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        self.inside.assign_waypoint(index, waypoint)
    }

    fn payload(&mut self, now: Instant) -> Self::Payload {
        self.inside.payload(now)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside.parameters(visit);
        self.straight.parameters(visit);
    }
}
