//! Three independent flocks: the preferred motion of a robot, given its neighbours.
//!
//! - [`lattice`](crate::lattice): equal distances, a reference, obstacles (Olfati-Saber 2006): an acceleration.
//! - [`goal_flock`](crate::goal_flock): goals, the neighbours' middle, repulsion (Pavlovsky and Pavlovsky): a velocity.
//! - [`boids`](crate::boids): headings on a torus (Starovoitova 2018): a heading.
//!
//! None of them guarantees that robots do not touch: add a safety layer.

pub mod action;
pub mod beta;

#[cfg(all(test, feature = "micromath"))]
pub(crate) mod fixtures;
