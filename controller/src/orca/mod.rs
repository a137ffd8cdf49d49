//! Optimal reciprocal collision avoidance in the plane: the velocity nearest the preferred one that
//! no neighbour forbids.
//!
//! Source: J. van den Berg, S. Guy, M. Lin, D. Manocha 2011, "Reciprocal n-body collision avoidance"
//! (ORCA), sections 4 and 5; the geometry as in Tolok et al. (FVM). Read [`half_plane`] for what one
//! neighbour forbids, [`wall`] for what the world forbids, then [`solve`] for what is left. [`space`] does the same for
//! robots that fly; [`half_plane_from_template`] looks half-planes up instead of computing them.
//!
//! All positions and velocities are relative to the robot, so that 1000 km from the origin nothing
//! changes. What differs from the reference implementation (RVO2): two robots in the same place
//! still have a half-plane, values that are not finite give none (and never spread), nothing is
//! allocated, also when there is no solution.

mod avoid;
mod escape;
mod fly;
mod gap;
mod half_plane;
mod solve;
pub mod space;
mod template;
mod turn;
mod velocity_obstacle;
mod wall;

#[cfg(test)]
mod tests;

pub use avoid::{Analytic, AvoidParams, Avoider, HalfPlanes};
pub use escape::EscapeParams;
pub use fly::{FlyParams, fly};
pub use half_plane::{HalfPlane, Neighbor, Params, half_plane};
pub use solve::{Solution, solve};
pub use template::{
    Table, Template, Template2k, Template8k, Template16k, Template64k, half_plane_from_template,
};
pub use velocity_obstacle::VelocityObstacle;
pub use wall::wall;
