//! The guidance law of my-swarm, for the simulator and for the robot.
#![no_std]
// Listed in clippy.toml: functions of f32 whose bits differ between processors.
#![deny(clippy::disallowed_methods)]

use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::Vec3;
use staya_controller::scalar::{Scalar, cast};

/// Drives straight to the goal, slower near other robots. Write your own law here.
///
/// It computes in any number format `S`: `f32` in the simulator, and on the robot in the one of
/// firmware/src/robot.rs. The functions of `Scalar`, such as `y.atan2(x)`, give the same bits on
/// each processor; those of `f32` do not.
///
/// The fields are the law's memory. serde saves them in checkpoints and sends them to robots in
/// hardware-in-the-loop tests.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MyLaw {
    /// Preferred speed, m/s.
    pub speed_mps: f32,
    /// Distance at which the goal counts as reached, metres.
    pub tolerance_m: f32,
    /// Distance to another robot, from centre to centre, below which the speed is halved, metres.
    pub careful_m: f32,
    goal: Option<Waypoint<f32>>,
}

impl MyLaw {
    /// Creates a law without a goal.
    #[must_use]
    pub const fn new(speed_mps: f32, tolerance_m: f32, careful_m: f32) -> Self {
        Self { speed_mps, tolerance_m, careful_m, goal: None }
    }
}

impl<S: Scalar> Law<S> for MyLaw {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    /// The preferred velocity. The safety layer changes it to avoid collisions.
    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        _: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Some(goal) = &mut self.goal else { return Ok(Decision::idle()) };
        view.can_move()?;
        let [speed_mps, tolerance_m, careful_m] = [self.speed_mps, self.tolerance_m, self.careful_m].map(cast::<f32, S>);
        let way_m: Vec3<S> = goal.way(view.state.position, view.now).cast();
        let distance_m = way_m.norm();
        let is_crowded = view.nearby.iter().any(|other| other.offset_m.norm() < careful_m);
        let speed_mps = if is_crowded { speed_mps * S::HALF } else { speed_mps };
        // Slows down over the last half second.
        let speed_mps = speed_mps.min(view.body.max_speed_mps).min(distance_m * S::TWO);
        let wish_mps = way_m.normalized().unwrap_or_default() * speed_mps;
        let action = Action::Velocity { wish_mps, way_m: Some(way_m) };
        Ok(Decision::new(action, Progress::at_goal(distance_m <= tolerance_m)))
    }

    fn order(&mut self, order: &WaypointOrder) -> bool {
        self.goal = Some(order.waypoint);
        order.index == 0
    }
}
