//! A robot that an operator may take over for a while.

use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, pass_on};
use super::waypoint_guidance::WaypointGuidance;
use super::{Parameter, Wait, Waypoint, WrongTask};
use crate::geom::Vec3;
use crate::grid::Cell;
use crate::land::LandPatch;
use crate::neighbor::Tracker;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// What an operator wants of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Wish<S> {
    /// Its own behaviour.
    #[default]
    Own,
    /// To be left alone: its motors are off, or somebody else steers. It is in [`Mode::Passive`](crate::robot::Mode::Passive), so that the
    /// others hear where it is and do not count on its giving way.
    Off,
    /// To stay where it is (and give way to others).
    Hold,
    /// To go with a velocity, m/s, for so long at most; then to hold. What the body cannot do is cut.
    Velocity {
        /// The velocity.
        velocity_mps: Vec3<S>,
        /// How long it stands unless it is renewed; at most 35 minutes.
        valid: Duration,
    },
    /// To go to a waypoint and stay there, as [`WaypointGuidance`] does. One that moves is followed for so long at most, from when it was
    /// said on; then to hold.
    Waypoint {
        /// The waypoint when it was said, and how it moves.
        waypoint: Waypoint<S>,
        /// How long it stands unless it is renewed; `None`: until another wish.
        valid: Option<Duration>,
    },
    /// On the grid: to go to a cell, as the own guidance law would.
    Cell(Cell),
}

/// Guidance law `G` until an operator wishes something else, and again when he wishes no more.
///
/// It only wishes, as any guidance law does: the safety layer behind it keeps the robot clear of others whatever the
/// operator wants. Robots that follow this one see by its beacon that it left its formation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Commanded<S, G> {
    inside: G,
    wish: Wish<S>,
    /// When the wish was first seen; `None`: not yet.
    since: Option<Instant>,
    straight: WaypointGuidance<S>,
}

impl<S: Scalar, G> Commanded<S, G> {
    /// `inside`, and for [`Wish::Waypoint`] a cruising speed in m/s and how near is there, metres.
    #[must_use]
    pub const fn new(inside: G, speed_mps: S, tolerance_m: S) -> Self {
        Self { inside, wish: Wish::Own, since: None, straight: WaypointGuidance::new(speed_mps, tolerance_m) }
    }

    /// The operator's wish from the next step on.
    ///
    /// # Errors
    /// [`WrongTask`] for a velocity or a waypoint where the law inside moves cell by cell, for a cell where it does not go to cells, and
    /// for a velocity that is no number. The wish that held before goes on.
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

    /// The wish that holds now: one that has run out is [`Wish::Hold`].
    #[must_use]
    pub const fn wish(&self) -> &Wish<S> {
        &self.wish
    }

    /// The guidance law inside.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.inside
    }

    /// Takes the wish in, and lets it run out.
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

/// Does `action`, whoever asks it to go on or to stop.
fn on_order<S>(action: Action<S>, goal: Cell) -> Decision<S> {
    let stays = matches!(action, Action::Stay);
    Decision {
        action,
        status: Status { waits_for: stays.then_some(Wait::Request), recovers: !stays, ..Status::default() },
        target: goal,
        leader: RobotId::NOBODY,
        slot: 0,
        asks: heapless::Vec::new(),
    }
}

impl<S, G: Teamwork> Teamwork for Commanded<S, G> {
    pass_on!(orders: self => self.inside);
    pass_on!(land: self => self.inside);
}

/// An ordered velocity leads to a place so many own radii ahead: farther than any from which one swerves.
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
                // Somewhere ahead, so that two who are sent against each other get past.
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

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        self.inside.parameter(parameter).or_else(|| self.straight.parameter(parameter))
    }

    /// Speed and tolerance also hold for [`Wish::Waypoint`].
    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        self.inside.tune(parameter, value) | self.straight.tune(parameter, value)
    }
}
