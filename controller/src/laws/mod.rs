//! The laws, one folder each: its algorithm without an agent, and in `law` the law that applies it.
//!
//! | folder | law |
//! | --- | --- |
//! | `waypoint` | straight to waypoints |
//! | `lattice`, `goal_flock`, `boids` | flocks; `flock` has their common terms |
//! | `route`, `formation` | cell by cell; `cells` has their common parts |
//! | `negotiation` | cell by cell, planned together |
//! | `external`, `guided` | the caller decides; an operator steers |
//!
//! `list` has those that can be chosen at run time.

#[cfg(feature = "flock")]
pub mod boids;
#[cfg(feature = "flock")]
pub mod flock;
#[cfg(feature = "formation")]
pub mod formation;
#[cfg(feature = "flock")]
pub mod goal_flock;
#[cfg(feature = "flock")]
pub mod lattice;
#[cfg(feature = "negotiation")]
pub mod negotiation;
#[cfg(feature = "route")]
pub mod route;

#[cfg(feature = "agent")]
pub(crate) mod any;
#[cfg(feature = "agent")]
pub(crate) mod any_protocol;
#[cfg(feature = "agent")]
pub(crate) mod cells;
#[cfg(feature = "agent")]
pub(crate) mod external;
#[cfg(feature = "agent")]
pub(crate) mod guided;
#[cfg(feature = "agent")]
pub(crate) mod list;
#[cfg(feature = "agent")]
pub(crate) mod waypoint;
