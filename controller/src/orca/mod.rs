//! Optimal reciprocal collision avoidance (ORCA), in the plane and in space: finds the velocity
//! nearest to the preferred one that no neighbour and no obstacle forbids.
//!
//! Source: J. van den Berg, S. Guy, M. Lin, D. Manocha 2011, "Reciprocal n-body collision
//! avoidance" (ORCA), sections 4 and 5. Read the files in this order:
//!
//! | file | content | in RVO2's `Agent.cc` |
//! | --- | --- | --- |
//! | `avoider.rs` | one step: nearest obstacles and robots, margins | `computeNewVelocity` |
//! | `plane.rs` | half-plane of a disc; best velocity on a line | agents' lines, `linearProgram1` |
//! | `space.rs` | half-space of a ball; best velocity on a plane | RVO2-3D, `linearProgram2` |
//! | `wall.rs` | half-plane of a wall | obstacles' lines |
//! | `linear_program.rs` | best velocity; least bad one | `linearProgram2`, `3` (3D: `3`, `4`) |
//! | `dimension.rs` | half-spaces, balls; differences of plane and space | |
//! | `deadlock/` | the preferred velocity that avoids deadlocks | not included |
//!
//! [`VelocityObstacle`] and [`half_plane_from_table`] come from the functional voxel model (FVM: A.
//! Tolok et al.): the analytic velocity obstacle, and half-planes from its voxel template.
//!
//! Positions and velocities are relative to the robot, so that the result is the same 1000 km from
//! the origin. Differences to RVO2: two robots in one place have a half-plane, values that are not
//! finite give no constraint, and a body with inertia chooses among reachable velocities.

mod avoider;
mod deadlock;
mod dimension;
mod linear_program;
mod params;
mod plane;
mod space;
mod velocity_obstacle;
mod voxel;
mod wall;

#[cfg(all(test, feature = "micromath"))]
mod fast32;
#[cfg(test)]
mod fixtures;

pub use avoider::{Analytic, Avoider, HalfSpaces, InSpace};
#[cfg(feature = "agent")]
pub(crate) use deadlock::detour;
pub use dimension::{Dimension, HalfPlane, HalfSpace, MovingBall};
pub use linear_program::{Solution, solve};
pub use params::{AvoidParams, DeadlockParams, Params};
pub use plane::half_plane;
pub use space::half_space;
pub use velocity_obstacle::VelocityObstacle;
pub use voxel::{VelocityObstacleTable, VoxelTable2k, half_plane_from_table};
pub use wall::wall;
