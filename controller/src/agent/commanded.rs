//! A robot that an operator may take over for a while.

use super::guidance::{BadInput, Guidance, Guided, Place, View};
use super::parameter::Parameter;
use super::waypoint_guidance::WaypointGuidance;
use crate::geom::Vec3;
use crate::grid::Cell;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::TemplateAssignment;
use serde::Serialize;

/// What an operator wants of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
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
    /// To go to a place and stay there, as [`WaypointGuidance`] does. A place that moves is followed for so long at most, from when it was
    /// said on; then to hold.
    Place {
        /// The place when it was said, and how it moves.
        place: Place<S>,
        /// How long it stands unless it is renewed; `None`: until another wish.
        valid: Option<Duration>,
    },
    /// On the grid: to go to a cell, as the own guidance would.
    Cell(Cell),
}

/// A task that means nothing to the guidance: it goes to other things, or by other means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WrongTask;

impl core::fmt::Display for WrongTask {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the guidance has no use for the task")
    }
}

impl core::error::Error for WrongTask {}

/// Guidance `G` until an operator wishes something else, and again when he wishes no more.
///
/// It only wishes, as any guidance does: the safety layer behind it keeps the robot clear of others whatever the
/// operator wants. Robots that follow this one see by its beacon that it left its formation.
#[derive(Clone, Debug, Serialize)]
pub struct Commanded<S, G> {
    inside: G,
    wish: Wish<S>,
    /// When the wish was first seen; `None`: not yet.
    since: Option<Instant>,
    straight: WaypointGuidance<S>,
}

impl<S: Scalar, G> Commanded<S, G> {
    /// `inside`, and for [`Wish::Place`] a cruising speed in m/s and how near is there, metres.
    #[must_use]
    pub const fn new(inside: G, speed_mps: S, tolerance_m: S) -> Self {
        Self {
            inside,
            wish: Wish::Own,
            since: None,
            straight: WaypointGuidance::new(speed_mps, tolerance_m),
        }
    }

    /// The operator's wish from the next step on.
    ///
    /// # Errors
    /// [`WrongTask`] for a velocity or a place where the guidance inside moves cell by cell, for a cell where it does not go to cells, and
    /// for a velocity that is no number. The wish that held before goes on.
    pub fn command(&mut self, wish: Wish<S>) -> Result<(), WrongTask>
    where
        G: Guidance<S>,
    {
        let is_possible = match &wish {
            Wish::Own | Wish::Off | Wish::Hold => true,
            Wish::Velocity { velocity_mps, .. } => {
                self.inside.goes_by_velocity() && velocity_mps.is_finite()
            }
            Wish::Place { .. } => self.inside.goes_by_velocity(),
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

    /// The guidance inside.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.inside
    }

    /// Takes the wish in, and lets it run out.
    fn renew(&mut self, now: Instant)
    where
        S: Scalar,
    {
        let valid = match &mut self.wish {
            Wish::Velocity { valid, .. } => Some(*valid),
            Wish::Place { valid, .. } => *valid,
            _ => None,
        };
        let Some(since) = self.since else {
            self.since = Some(now);
            if let Wish::Place { place, .. } = &mut self.wish {
                place.at = now;
                let _ = Guidance::assign_place(&mut self.straight, 0, place);
            }
            return;
        };
        let age = now.since(since);
        if valid.is_some_and(|valid| age < Duration::ZERO || age >= valid) {
            self.wish = Wish::Hold;
        }
    }
}

/// Stays, whoever asks it to go on.
fn standing<S: Scalar>(view: &View<'_, S>) -> Guided<S> {
    Guided {
        target: view.goal,
        waits: true,
        ..Guided::default()
    }
}

impl<S: Scalar, G: Guidance<S>> Guidance<S> for Commanded<S, G> {
    type Workspace = G::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Guided<S>, BadInput> {
        self.renew(view.now);
        match self.wish {
            Wish::Own => self.inside.decide(view, rng, workspace),
            Wish::Off => Ok(Guided {
                is_passive: true,
                ..standing(view)
            }),
            Wish::Hold => Ok(standing(view)),
            Wish::Velocity { velocity_mps, .. } => {
                view.can_go()?;
                Ok(Guided {
                    velocity_mps: velocity_mps.clamp_norm(view.body.max_speed_mps),
                    target: view.goal,
                    recovers: true,
                    ..Guided::default()
                })
            }
            Wish::Place { .. } => Ok(Guided {
                target: view.goal,
                recovers: true,
                ..self.straight.decide(view, rng, &mut ())?
            }),
            Wish::Cell(goal) => {
                let view = View { goal, ..*view };
                self.inside.decide(&view, rng, workspace)
            }
        }
    }

    fn redirect(&mut self) {
        self.inside.redirect();
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_anew: bool) -> bool {
        self.inside.assign_template(part, is_anew)
    }

    fn assign_place(&mut self, index: u8, place: &Place<S>) -> bool {
        self.inside.assign_place(index, place)
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

    fn goal_offset(&self) -> Cell {
        self.inside.goal_offset()
    }

    fn needs(&self, id: RobotId) -> bool {
        self.inside.needs(id)
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        self.inside
            .parameter(parameter)
            .or_else(|| self.straight.parameter(parameter))
    }

    /// Speed and tolerance also hold for [`Wish::Place`].
    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        self.inside.tune(parameter, value) | self.straight.tune(parameter, value)
    }
}
