//! Three independent flocks: the preferred motion of a robot, given its neighbours.
//!
//! - [`lattice`]: equal distances, a reference, obstacles (Olfati-Saber 2006): an acceleration.
//! - [`goal`]: goals, the neighbours' middle, repulsion (Pavlovsky and Pavlovsky): a velocity.
//! - [`boids`]: headings on a torus (Starovoitova 2018): a heading.
//!
//! None of them guarantees that robots do not touch: add a safety layer.

pub mod action;
pub mod beta;
pub mod boids;
pub mod goal;
pub mod lattice;
mod reference;

#[cfg(all(test, feature = "micromath"))]
mod tests;
