//! Status of a robot, as used by the engine.

use crate::scenario::Robot;
use crate::world::plane::Barrier;
use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};

/// Public results of a robot's last decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// Current mode.
    pub mode: Mode,
    /// Id of the robot that it follows.
    pub leader: RobotId,
    /// Target cell.
    pub target: Cell,
    /// Cause of waiting.
    pub wait: Option<Wait>,
}

impl Status {
    /// Status of a robot before its first step.
    pub const fn before(robot: &Robot) -> Self {
        Self { mode: Mode::Idle, leader: RobotId::NONE, target: robot.goal, wait: None }
    }

    pub(super) const fn fall_silent(&mut self) {
        (self.mode, self.leader, self.wait) = (Mode::Fault, RobotId::NONE, None);
    }
}

/// State of a robot at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Its mode.
    pub mode: Mode,
    /// Cause of waiting.
    pub wait: Option<Wait>,
    /// Why no motion leads to its goal; `None`: one does, or it has arrived or has no fixed goal.
    pub barrier: Option<Barrier>,
    /// Its body in the plane; `None` on the grid.
    pub body: Option<EndBody>,
}

/// A body in the plane at the end of a run, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EndBody {
    /// Position.
    pub position_m: [f64; 3],
    /// Radius.
    pub radius_m: f64,
    /// Radius with the way that it can soon go: bodies farther away are not in its way.
    pub reach_m: f64,
}
