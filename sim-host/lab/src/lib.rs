//! Experiments that repeat papers and benchmarks. Each is a plan that implements
//! [`experiment::Experiment`].
//!
//! | module | source | experiment |
//! | --- | --- | --- |
//! | [`route`] | A. V. Kuznetsov 2017 (KUZ), section 5 | windowed routing and the global optimum |
//! | [`scouting`] | KUZ, section 3 | routing on changing land with incomplete or wrong maps |
//! | [`formation`] | KUZ, section 8 | six robots in formation |
//! | [`movingai`] | N. Sturtevant 2012 | queries of the Moving AI benchmark |
//! | [`crossing`] | van den Berg et al. 2011 (ORCA) | swaps, doorways, other conflicts |
//! | [`flock`] | R. Olfati-Saber 2006 (OLF), section VIII | five flocking simulations |
//! | [`goals`] | V. E. Pavlovsky, V. V. Pavlovsky (PAV) | a group on its way to three goals |
//! | [`boids`] | V. A. Starovoitova 2018 (STA), section 2.3 | boids on a torus, neighbour search |
//! | [`share`] | | effect of maps shared over the radio on routes |
//! | [`scale`] | | cost per robot in swarms of a thousand to a million |

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
