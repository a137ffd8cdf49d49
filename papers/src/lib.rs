//! Laws as published, on the public interface of [`staya_controller`] alone, for comparison.
//!
//! | law | source |
//! | --- | --- |
//! | [`PublishedFormation`] | A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2, 5, 6 and 7 |
//! | Staya's formation steered by [`Course`] | R. C. Coulter 1992, pure pursuit |
#![no_std]

#[cfg(test)]
extern crate std;

mod course;
pub mod criteria;
mod formation;
mod settings;
#[cfg(test)]
mod tests;

pub use course::Course;
pub use formation::PublishedFormation;
pub use settings::{LookaheadSettings, PublishedSettings};
