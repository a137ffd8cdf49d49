//! The host side of Staya: a world, a lossy radio and any number of controllers between them.
//!
//! [`scenario`] reads what to simulate, [`terrain`] the land, [`engine`] runs every robot's
//! [`staya_controller::agent::Agent`] through two-phase ticks over [`world`] and [`radio`],
//! [`record`] keeps what happened, [`plot`] draws it, [`experiment`] reproduces papers.

pub mod terrain;
