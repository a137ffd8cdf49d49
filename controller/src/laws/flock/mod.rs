//! Terms of flocks. The flocks are independent: the preferred motion of a robot, given its
//! neighbours.
//!
//! - [`lattice`](crate::lattice): equal distances, a reference, obstacles: an acceleration.
//! - [`goal_flock`](crate::goal_flock): goals, the neighbours' middle, repulsion: a velocity.
//! - [`boids`](crate::boids): headings on a torus: a heading.
//!
//! None of them guarantees that robots do not touch: add a safety layer.

pub mod action;
pub mod beta;

#[cfg(all(test, feature = "micromath"))]
pub(crate) mod fixtures;
