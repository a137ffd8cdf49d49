//! Three flocks: what a robot wishes, given who is near by. Each is pure; none knows of the others.
//!
//! - [`lattice`]: equal distances, a reference to follow, obstacles (Olfati-Saber 2006); gives an acceleration.
//! - [`goal`]: goals, the middle of the neighbours, repulsion (Pavlovsky and Pavlovsky); gives a velocity.
//! - [`boids`]: headings on a torus (Starovoitova 2018); gives a heading.
//!
//! None of them promises that robots do not touch: put a safety layer behind.

pub mod action;
pub mod beta;
pub mod boids;
pub mod goal;
pub mod lattice;
mod reference;

#[cfg(all(test, feature = "micromath"))]
mod tests;
