//! What a robot is doing, as the engine sees it.

use crate::scenario::Robot;
use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};

/// What the rest of the engine needs to know of a robot after its decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// Whom it follows.
    pub leader: RobotId,
    /// The cell that it heads for.
    pub target: Cell,
    /// What it waits for.
    pub wait: Option<Wait>,
}

impl Status {
    /// Of a robot before its first step.
    pub const fn before(robot: &Robot) -> Self {
        Self { mode: Mode::Idle, leader: RobotId::NOBODY, target: robot.goal, wait: None }
    }

    /// Its computer is down.
    pub(super) const fn fall_silent(&mut self) {
        (self.mode, self.leader, self.wait) = (Mode::Fault, RobotId::NOBODY, None);
    }
}
