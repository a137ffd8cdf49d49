//! Sweeps, and experiments that repeat papers and benchmarks. Experiments that are runs of
//! scenarios are [figures](figure): plans in `papers/`. The others implement
//! [`experiment::Experiment`]:
//!
//! | module | source | experiment |
//! | --- | --- | --- |
//! | [`route`] | A. V. Kuznetsov 2017 (KUZ), section 5 | windowed routing and the global optimum |
//! | [`movingai`] | N. Sturtevant 2012 | queries of the Moving AI benchmark |
//! | [`flock`] | R. Olfati-Saber 2006 (OLF), section VIII | five flocking simulations |
//! | [`goals`] | V. E. Pavlovsky, V. V. Pavlovsky (PAV) | a group on its way to three goals |
//! | [`boids`] | V. A. Starovoitova 2018 (STA), section 2.3 | boids on a torus, neighbour search |

mod arena;
pub mod boids;
pub mod cli;
pub mod experiment;
pub mod figure;
pub mod flock;
pub mod goals;
pub mod movingai;
pub mod optimal;
pub mod route;
pub mod sweep;
pub use staya_sim::walk;
