//! Sweeps: a scenario with some of its fields changed, thousands of times, on one machine or many.
//!
//! | module | |
//! | --- | --- |
//! | [`design`] | runs that have numbers: plans of sweeps, and experiments |
//! | [`plan`] | which fields, which values, which seeds; what is measured |
//! | [`run`] | one run of a plan: a function of plan and number, and of nothing else |
//! | [`row`] | what is written down of it |
//! | [`shard`] | the part of a plan that one process does, and the file that its rows are appended to |
//! | [`merge`] | the rows of all shards in order, or what is wrong with them |
//! | [`aggregate`] | means, medians and intervals over the seeds |
//! | [`pictures`] | a figure over one axis or two |
//! | [`script`] | the same on clusters: Slurm, GNU parallel |
//! | [`jobs`] | jobs in parallel, for sweeps and for experiments |

pub mod aggregate;
pub mod design;
mod error;
pub mod jobs;
pub mod merge;
pub mod pictures;
pub mod plan;
pub mod row;
pub mod run;
mod sample;
mod schema;
pub mod script;
pub mod shard;
mod value;

pub use error::SweepError;
pub use plan::Plan;
pub use schema::schema;
pub use shard::Shard;
pub use value::{Figure, Value};
