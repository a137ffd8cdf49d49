//! Pictures as SVG and PNG, on machines without fonts or displays.
//!
//! [`Chart`], [`Panels`] and [`HeatMap`] draw data; [`run_pictures`] draws what happened in a run; [`flock`] draws robots in the plane at
//! some moments. All make a
//! [`canvas::Canvas`], a list of shapes, which is written once as SVG and once, through
//! `tiny-skia` and letters that are compiled in, as PNG. Drawing asks for no clock and no
//! randomness: the same data give the same bytes.

pub mod canvas;
pub mod chart;
pub mod colour;
mod crowd;
pub mod flock;
mod font;
pub mod heat;
mod layout;
mod look;
mod map;
mod motion;
pub mod movie;
mod panels;
mod raster;
mod run;
mod scale;
mod series;
mod svg;
pub mod terrain;
pub mod ticks;
mod trajectories;
mod write;

pub use chart::{Chart, Series};
pub use heat::HeatMap;
pub use motion::{motion_pictures, motion_sheet};
pub use panels::Panels;
pub use run::run_pictures;

#[cfg(test)]
mod tests;
