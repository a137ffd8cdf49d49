//! Experiments: papers and benchmarks, run again.
//!
//! | module | paper |
//! | --- | --- |
//! | [`route`] | A. V. Kuznetsov 2017 (KUZ), section 5: windowed routing against the global optimum on random land |
//! | [`scouting`] | KUZ, section 3: the same on land that changes, with maps that are blank or wrong in part |
//! | [`formation`] | KUZ, section 8: six robots in formation |
//! | [`movingai`] | N. Sturtevant 2012: the queries of the Moving AI benchmark |
//! | [`crossing`] | van den Berg et al. 2011 (ORCA): swaps over a circle, and doorways |
//! | [`flock`] | R. Olfati-Saber 2006 (OLF), section VIII: the five simulations |
//! | [`goals`] | V. E. Pavlovsky and V. V. Pavlovsky (PAV): a group on its way to three goals |
//! | [`boids`] | V. A. Starovoitova 2018 (STA), section 2.3: boids on a torus, and what finding neighbours costs |
//! | [`share`] | none: what maps shared over the radio do to routes |
//! | [`scale`] | none: what a robot costs in swarms of a thousand to a million |
//!
//! Each is a plan that implements [`experiment::Experiment`].

mod arena;
pub mod boids;
pub mod cli;
pub mod crossing;
pub mod experiment;
pub mod flock;
pub mod formation;
pub mod goals;
pub mod movingai;
pub mod optimal;
pub mod route;
pub mod scale;
pub mod scouting;
pub mod share;
pub mod sweep;
pub use staya_sim::walk;
