//! Sweeps, and experiments that repeat papers and benchmarks: [figures](figure) are plans in
//! `papers/`. A run of a plan is one of a scenario, measured by its summary and by
//! [probes](probe), or of a [study].

pub mod claims;
pub mod cli;
pub mod error;
pub mod figure;
pub mod joint;
pub mod measure;
mod migrate;
pub mod probe;
pub mod study;
pub mod sweep;
pub use staya_sim::walk;
