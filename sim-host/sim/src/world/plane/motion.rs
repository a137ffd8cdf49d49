//! Motion of one body.

use super::{Abilities, Disc, max_speed_mps};
use crate::terrain::Terrain;
use staya_controller::agent::Command;
use staya_controller::body::Body as Limits;
use staya_controller::geom::Vec3;
use staya_controller::grid::Cell;

/// Age of a robot's command in a tick. A command holds for a step of its robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommandAge {
    /// The robot has decided in this tick.
    New,
    /// The step of the command is not over.
    Kept,
    /// The step is over and the robot has not decided again, or its computer is down.
    #[default]
    Expired,
}

impl Disc {
    /// Sets the target for a command.
    pub(super) fn steer(
        &mut self,
        command: &Command<f32>,
        age: CommandAge,
        land: Option<&Terrain>,
        shut: &[(Cell, u8)],
    ) {
        let Abilities { max_acceleration_mps2, lag_s, step_s, tick_s, .. } = self.abilities;
        let change_s = match age {
            CommandAge::Kept => return,
            CommandAge::New => step_s,
            CommandAge::Expired => tick_s,
        };
        let wish = match *command {
            Command::Velocity(v) => Vec3::new(v.x.into(), v.y.into(), v.z.into()),
            Command::Hold | Command::Move(_) => Vec3::ZERO,
        };
        let limits = Limits {
            id: self.id,
            velocity_mps: vector(self.velocity_mps),
            radius_m: self.radius_m,
            max_speed_mps: max_speed_mps(land, shut, &self.abilities, self.position_m),
            max_acceleration_mps2,
            // With a lag the velocity changes by no more in that time than without.
            step_s: if lag_s > 0.0 { change_s / (1.0 - libm::exp(-change_s / lag_s)) } else { change_s },
        };
        let target = limits.reach(wish);
        self.target_mps = [target.x, target.y, target.z];
    }

    /// Moves the body for a tick.
    pub(super) fn go(&mut self) {
        let Abilities { lag_s, tick_s, .. } = self.abilities;
        let [mean_mps, last_mps] = if lag_s > 0.0 {
            let left = libm::exp(-tick_s / lag_s);
            let (target, off) = (vector(self.target_mps), vector(self.velocity_mps) - vector(self.target_mps));
            [target + off * (lag_s * (1.0 - left) / tick_s), target + off * left].map(|v| [v.x, v.y, v.z])
        } else {
            [self.target_mps; 2]
        };
        for (place, speed) in self.position_m.iter_mut().zip(mean_mps) {
            *place += speed * tick_s;
        }
        self.velocity_mps = last_mps;
    }
}

const fn vector([x, y, z]: [f64; 3]) -> Vec3<f64> {
    Vec3::new(x, y, z)
}
