//! Poses in metres of bodies on the grid, interpolated between cells.

use crate::terrain::Terrain;
use crate::world::Body;
use staya_controller::agent::KinematicState;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Dir, GridFrame, UNIT};

#[derive(Clone, Copy, Debug)]
pub(super) struct Kinematics {
    frame: GridFrame<f64>,
    tick_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub(super) position_m: [f64; 2],
    pub(super) velocity_mps: [f64; 2],
}

impl From<Pose> for KinematicState<f32> {
    fn from(pose: Pose) -> Self {
        let [x, y] = pose.position_m;
        let [vx, vy] = pose.velocity_mps;
        Self {
            // The world's numbers are finite.
            position: Position::from_metres([x, y, 0.0]).unwrap_or_default(),
            velocity_mps: Vec3::new(vx as f32, vy as f32, 0.0),
        }
    }
}

impl Kinematics {
    pub(super) fn new(terrain: &Terrain, tick_s: f64) -> Self {
        let [x, y] = terrain.origin_m;
        Self { frame: GridFrame { origin_m: Vec2::new(x, y), cell_m: terrain.cell_m }, tick_s }
    }

    /// A body holds its new cell from the start of a crossing, but reaches the centre at its end.
    /// It keeps its speed while it can continue without losing a fraction of a tick.
    pub(super) fn pose(&self, body: &Body, now_units: u64) -> Pose {
        let center = self.frame.center(body.cell);
        let at_rest = Pose { position_m: [center.x, center.y], velocity_mps: [0.0; 2] };
        if body.entered_by == Dir::Stay || body.free_at + u64::from(UNIT) <= now_units {
            return at_rest;
        }
        let crossing = body.crossing as f64;
        let left = body.free_at.saturating_sub(now_units) as f64 / crossing;
        let step = body.entered_by.offset();
        let step_m = [f64::from(step.x), f64::from(step.y)].map(|d| d * self.frame.cell_m);
        let crossing_s = crossing / f64::from(UNIT) * self.tick_s;
        Pose {
            position_m: [center.x - step_m[0] * left, center.y - step_m[1] * left],
            velocity_mps: step_m.map(|d| d / crossing_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{MoveRules, World};
    use staya_controller::agent::Command;
    use staya_controller::grid::Cell;
    use staya_controller::robot::RobotId;

    #[test]
    fn a_crossing_has_constant_speed_from_centre_to_centre() {
        let mut terrain = Terrain::flat(3, 1);
        terrain.cell_m = 10.0;
        terrain.origin_m = [100.0, -10.0];
        terrain.set(Cell::new(1, 0), 4);
        let kinematics = Kinematics::new(&terrain, 0.5);
        let starts = [(RobotId(1), Cell::new(0, 0))];
        let mut world = World::new(terrain, MoveRules::default(), 0, starts).expect("free");
        let pose = |world: &World, ticks: u64| kinematics.pose(&world.bodies()[0], ticks * u64::from(UNIT));
        let start = Pose { position_m: [105.0, -5.0], velocity_mps: [0.0; 2] };
        assert_eq!(pose(&world, 0), start);
        let east = Command::Move([Dir::East].into_iter().collect());
        world.advance(10, &[east]);
        for (ticks, x, speed) in [(10, 105.0, 5.0), (12, 110.0, 5.0), (14, 115.0, 5.0), (15, 115.0, 0.0)] {
            let now = pose(&world, ticks);
            assert_eq!(now.position_m, [x, -5.0], "after {ticks} ticks");
            assert_eq!(now.velocity_mps, [speed, 0.0], "after {ticks} ticks");
        }
        // A change of the land under a body does not affect its current crossing.
        let before = pose(&world, 12);
        world.change(&[(Cell::new(1, 0), 9)]);
        assert_eq!(pose(&world, 12), before);
    }
}
