//! Optimal reciprocal collision avoidance: the velocity nearest the preferred one that no neighbour and no obstacle
//! forbids, in the plane and in space.
//!
//! Source: J. van den Berg, S. Guy, M. Lin, D. Manocha 2011, "Reciprocal n-body collision avoidance"
//! (ORCA), sections 4 and 5. One step is read from the top:
//!
//! | file | has | in RVO2's `Agent.cc` |
//! | --- | --- | --- |
//! | `avoider.rs` | one step: the nearest obstacles and robots, margins, inertia | `computeNewVelocity` |
//! | `plane.rs` | the half-plane of a disc; the best velocity on a line | agents' lines, `linearProgram1` |
//! | `space.rs` | the half-space of a ball; the best velocity on a plane | the same in RVO2-3D, `linearProgram2` |
//! | `wall.rs` | the half-plane of a wall | obstacles' lines |
//! | `linear_program.rs` | the best velocity of all; the least bad one | `linearProgram2` and `3` (3D: `3`, `4`) |
//! | `dimension.rs` | half-spaces and balls; all in which the plane differs from space | |
//! | `deadlock/` | which wish to give to ORCA so that nobody waits for ever | not there |
//!
//! From the functional voxel model (FVM: A. Tolok et al.): [`VelocityObstacle`] is its analytic form of the velocity
//! obstacle, and [`half_plane_from_table`] looks half-planes up in its voxel template instead of computing them.
//!
//! All positions and velocities are relative to the robot, so that 1000 km from the origin nothing
//! changes. What differs from the reference implementation (RVO2): two robots in the same place
//! still have a half-plane, values that are not finite give none (and never spread), nothing is
//! allocated, also when there is no solution; a body with inertia chooses among the velocities that it can reach.

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
pub use dimension::{Dimension, HalfPlane, HalfSpace, MovingBall};
pub use linear_program::{Solution, solve};
pub use params::{AvoidParams, DeadlockParams, Params};
pub use plane::half_plane;
pub use space::half_space;
pub use velocity_obstacle::VelocityObstacle;
pub use voxel::{VelocityObstacleTable, VoxelTable2k, half_plane_from_table};
pub use wall::wall;
