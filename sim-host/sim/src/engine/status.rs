//! Status of a robot, as used by the engine.

use crate::scenario::Robot;
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
