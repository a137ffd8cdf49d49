//! Lets an operator take over a robot temporarily.

use super::waypoint::{Waypoint, WaypointGuidance};
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::law::{
    Action, BadInput, Decision, Law, MessageOf, OrderOf, PayloadOf, Progress, Radio, Report, Scene, Surroundings,
    Tools, View, Wait, WrongTask,
};
use crate::parameters::Parameters;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
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

/// Law `L`, which an operator can override. The safety layer still avoids other robots,
/// and followers see in the beacon that this robot left the formation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Guided<S, L> {
    inside: L,
    wish: Wish<S>,
    /// When the command took effect.
    since: Option<Instant>,
    straight: WaypointGuidance<S>,
}

impl<S: Scalar, L> Guided<S, L> {
    /// Wraps `inside`; speed and arrival distance `tolerance_m` apply to [`Wish::Waypoint`].
    #[must_use]
    pub const fn new(inside: L, speed_mps: S, tolerance_m: S) -> Self {
        Self { inside, wish: Wish::Own, since: None, straight: WaypointGuidance::new(speed_mps, tolerance_m) }
    }

    /// Sets the command from the next step on.
    ///
    /// # Errors
    /// [`WrongTask`], with the previous command still active, for a velocity or a waypoint if the
    /// law moves cell by cell, a cell if it does not plan on the grid, and a velocity that is not
    /// finite.
    /// An enum of laws accepts all of these; its host knows which body it has.
    pub fn command(&mut self, wish: Wish<S>) -> Result<(), WrongTask>
    where
        L: Law<S>,
    {
        let has_plane = <L::Surroundings<'_> as Surroundings<S>>::HAS_PLANE;
        let is_possible = match &wish {
            Wish::Own | Wish::Off | Wish::Hold => true,
            Wish::Velocity { velocity_mps, .. } => has_plane && velocity_mps.is_finite(),
            Wish::Waypoint { .. } => has_plane,
            Wish::Cell(_) => <L::Surroundings<'_> as Surroundings<S>>::HAS_GRID,
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
    pub const fn inside(&self) -> &L {
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
                self.straight.begin(waypoint);
            }
            return;
        };
        let age = now.since(since);
        if valid.is_some_and(|valid| age < Duration::ZERO || age >= valid) {
            self.wish = Wish::Hold;
        }
    }
}

fn on_order<S>(action: Action<S>) -> Decision<S> {
    let stays = matches!(action, Action::Stay);
    Decision::new(action, if stays { Progress::Waiting(Wait::Stopped) } else { Progress::Recovering })
}

/// Distance of the way point of a commanded velocity, own radii: farther than robots swerve.
const LEADS_TO_RADII: i32 = 100;

impl<S: Scalar, L: Law<S>> Law<S> for Guided<S, L> {
    type Surroundings<'a> = L::Surroundings<'a>;
    type Protocol = L::Protocol;
    type Workspace = L::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, S, Self::Protocol>,
        here: &Self::Surroundings<'_>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, radio, workspace } = tools;
        let tools = Tools { rng, radio, workspace };
        self.renew(view.now);
        match self.wish {
            Wish::Own => self.inside.decide(view, here, tools),
            Wish::Off => Ok(on_order(Action::Release)),
            Wish::Hold => Ok(on_order(Action::Stay)),
            Wish::Velocity { velocity_mps, .. } => {
                view.can_move()?;
                let wish_mps = velocity_mps.clamp_norm(view.body.max_speed_mps);
                // Lets two robots that are sent against each other pass.
                let far_m = view.body.radius_m * S::from_i32(LEADS_TO_RADII);
                let way_m = wish_mps.normalized().map(|ahead| ahead * far_m);
                Ok(on_order(Action::Velocity { wish_mps, way_m }))
            }
            Wish::Waypoint { .. } => {
                let mut decision = self.straight.head(view)?;
                if !decision.progress.has_arrived() {
                    decision.progress = Progress::Recovering;
                }
                Ok(decision)
            }
            Wish::Cell(goal) => {
                let scene = Scene { sent_to: Some(goal), ..view.scene };
                self.inside.decide(&View { scene, ..*view }, here, tools)
            }
        }
    }

    fn payload(
        &mut self,
        here: &Self::Surroundings<'_>,
        heading: Dir,
        radio: &mut Radio<'_, Self::Protocol>,
    ) -> PayloadOf<Self, S> {
        self.inside.payload(here, heading, radio)
    }

    fn receive_payload(&mut self, from: RobotId, payload: &PayloadOf<Self, S>, sent: Instant) {
        self.inside.receive_payload(from, payload, sent);
    }

    fn receive(&mut self, from: RobotId, message: &MessageOf<Self, S>, radio: &mut Radio<'_, Self::Protocol>) -> bool {
        self.inside.receive(from, message, radio)
    }

    fn order(&mut self, order: &OrderOf<Self, S>) -> bool {
        self.inside.order(order)
    }

    fn needs(&self, id: RobotId) -> bool {
        self.inside.needs(id)
    }

    /// A robot that an operator steers has left its formation.
    fn report(&self) -> Report {
        let shown = self.inside.report();
        match self.wish {
            Wish::Own | Wish::Cell(_) => shown,
            _ => Report { goal: shown.goal, target: shown.target, ..Report::NONE },
        }
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        self.inside.expects(id)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside.parameters(visit);
        self.straight.parameters(visit);
    }
}
