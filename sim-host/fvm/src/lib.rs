#![doc = include_str!("../README.md")]

mod build;
pub mod cli;
pub mod draw;
mod function;
mod measure;
mod numbers;
pub mod orca;
mod room;
pub mod shape;
pub mod swarm;
mod template;
#[cfg(test)]
mod tests;

pub use build::{Grid, build};
pub use function::{Function, System};
pub use measure::{Errors, HalfPlaneErrors, Measured, Reading, half_planes, measure};
pub use room::Room;
pub use template::{Pair, Template, Templated, VelocityForm};
