//! Sweeps: thousands of runs of a scenario with varied fields, on one machine or many.
//!
//! | module | contents |
//! | --- | --- |
//! | [`plan`] | varied fields, values, seeds and measures |
//! | [`run`] | one run, a function of plan and number only |
//! | [`report`] | table, verdicts and files of a complete plan |
//! | [`record`] | the judgements of a full run on the conditions of its plan |
//! | [`row`] | the record of a run |
//! | [`shard`] | the part of a plan that one process does, and its file of rows |
//! | [`merge`] | the rows of all shards in order, and their consistency |
//! | [`gain`] | differences of means over an axis |
//! | [`aggregate`] | means, medians and intervals over the seeds |
//! | [`pictures`] | charts of a figure over one or two axes |
//! | [`script`] | scripts for clusters: Slurm, GNU parallel |
//! | [`jobs`] | parallel jobs |

pub mod aggregate;
pub mod gain;
pub mod jobs;
pub mod merge;
pub mod pictures;
pub mod plan;
pub mod record;
pub mod report;
pub mod row;
pub mod run;
mod sample;
mod schema;
pub mod script;
pub mod shard;
mod value;

pub use plan::Plan;
pub use schema::schema;
pub use shard::Shard;
pub use value::{Figure, Value};
