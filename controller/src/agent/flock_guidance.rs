//! The three flocks as guidances.

use super::guidance::{BadInput, Guidance, Guided, Place, View};
use crate::flock::boids::BoidsParams;
use crate::flock::goal::{GoalParams, Goals, Stage, wish};
use crate::flock::lattice::{LatticeParams, Reference, acceleration};
use crate::geom::{Position, Vec2, Vec3};
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::Serialize;

/// Goals that a robot of a goal flock has room for.
pub const GOALS: usize = 4;

/// The alpha flock (OLF): robots at equal distances that follow a reference, if they are given one as place 0.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LatticeGuidance<S> {
    params: LatticeParams<S>,
    place: Option<Place<S>>,
    moves: bool,
}

impl<S: Scalar> LatticeGuidance<S> {
    /// `moves`: whether the reference goes where its velocity takes it (a dynamic gamma-agent), or stays, with a velocity
    /// all the same (a static one, as in the paper's obstacle courses).
    #[must_use]
    pub const fn new(params: LatticeParams<S>, moves: bool) -> Self {
        Self {
            params,
            place: None,
            moves,
        }
    }
}

impl<S: Scalar> Guidance<S> for LatticeGuidance<S> {
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<S>, BadInput> {
        view.can_go()?;
        let moves = self.moves;
        let reference = self.place.as_mut().map(|place| Reference {
            offset_m: if moves {
                place.way(view.pose.position, view.now)
            } else {
                place.position.since(view.pose.position)
            },
            velocity_mps: place.velocity_mps,
        });
        let body = &view.body;
        let change = acceleration(
            &self.params,
            body,
            view.nearby,
            view.obstacles,
            reference.as_ref(),
        );
        let velocity_mps = body.velocity_mps + change * body.step_s;
        if !velocity_mps.is_finite() {
            return Err(BadInput);
        }
        Ok(Guided {
            velocity_mps,
            way_m: reference.map(|reference| reference.offset_m),
            ..Guided::default()
        })
    }

    fn assign_place(&mut self, index: u8, place: &Place<S>) -> bool {
        if index == 0 {
            self.place = Some(*place);
        }
        index == 0
    }

    fn has_own_goal(&self) -> bool {
        true
    }
}

/// The goal flock (PAV): to the middle of the goals together, there each robot draws one of them. Goals stay where they are until
/// they are given anew: the velocity of a [`Place`] counts for nothing here.
#[derive(Clone, Debug, Serialize)]
pub struct GoalFlockGuidance<S> {
    params: GoalParams<S>,
    arrival_m: S,
    seed: u64,
    goals: Goals<GOALS>,
}

impl<S: Scalar> GoalFlockGuidance<S> {
    /// `arrival_m`: how near counts as being there; a crowd needs room, so about the neighbourhood. `seed`: of the draws.
    #[must_use]
    pub const fn new(params: GoalParams<S>, arrival_m: S, seed: u64) -> Self {
        Self {
            params,
            arrival_m,
            seed,
            goals: Goals::new(),
        }
    }

    /// Where the robot is on its way.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.goals.stage()
    }

    /// Whether it may stand: near its own goal, and kept by the others from going nearer. Who stood as soon as it was near
    /// would be a wall around the goal to all who come later.
    fn is_there(&self, own: Position, way_m: Option<Vec3<S>>, wish_mps: Vec3<S>) -> bool {
        let is_drawn = matches!(self.goals.stage(), Stage::Goal(_));
        let is_near = is_drawn && self.goals.has_arrived(own, self.arrival_m);
        let way_m = way_m.unwrap_or_default();
        let is_kept_off = way_m.dot(wish_mps) <= S::ZERO;
        is_near && (is_kept_off || way_m.norm() <= self.params.min_distance_m)
    }
}

impl<S: Scalar> Guidance<S> for GoalFlockGuidance<S> {
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<S>, BadInput> {
        view.can_go()?;
        let own = view.pose.position;
        let _ = self.goals.update(own, self.arrival_m, self.seed, view.id);
        let goal = self.goals.current();
        let velocity_mps = wish(&self.params, &view.body, own, goal, view.nearby);
        let way_m = goal.map(|goal| goal.since(own));
        Ok(Guided {
            velocity_mps,
            way_m,
            is_at_goal: self.is_there(own, way_m, velocity_mps),
            ..Guided::default()
        })
    }

    fn assign_place(&mut self, index: u8, place: &Place<S>) -> bool {
        let index = usize::from(index);
        self.goals.set_goal(index, place.position)
            || (index == self.goals.as_slice().len() && self.goals.push(place.position).is_ok())
    }

    fn has_own_goal(&self) -> bool {
        true
    }
}

/// Boids (STA): even speed, headings that follow the neighbours'. In the open plane; what the torus of the paper
/// adds is the world's matter.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BoidsGuidance<S> {
    params: BoidsParams<S>,
    speed_mps: S,
    heading: Option<Vec2<S>>,
}

impl<S: Scalar> BoidsGuidance<S> {
    /// At `speed_mps`; the first heading is that of the body, or drawn if it stands.
    #[must_use]
    pub const fn new(params: BoidsParams<S>, speed_mps: S) -> Self {
        Self {
            params,
            speed_mps,
            heading: None,
        }
    }
}

impl<S: Scalar> Guidance<S> for BoidsGuidance<S> {
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S>,
        rng: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<S>, BadInput> {
        view.can_go()?;
        let mut draw = || {
            let turn = S::from_ratio(rng.below(20_000).cast_signed() - 10_000, 10_000);
            let (sin, cos) = (turn * S::PI).sin_cos();
            Vec2::new(cos, sin)
        };
        // Where a safety layer has turned the body, there it looks.
        let moving = view.body.velocity_mps.xy().normalized();
        let heading = moving.or(self.heading).unwrap_or_else(&mut draw);
        let heading = self.params.steer(view.id, heading, view.nearby);
        self.heading = Some(heading);
        let velocity_mps: Vec3<S> = (heading * self.speed_mps).extend(S::ZERO);
        Ok(Guided {
            velocity_mps,
            ..Guided::default()
        })
    }

    fn has_own_goal(&self) -> bool {
        true
    }
}
