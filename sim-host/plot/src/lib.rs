//! Pictures as SVG and PNG, on computers without fonts or displays.
//!
//! [`Chart`], [`Panels`] and [`HeatMap`] draw data, [`run_pictures`] draws a run, and [`flock`]
//! draws robots in the plane. All create a [`canvas::Canvas`], a list of shapes that is written as
//! SVG and, through `tiny-skia` and built-in glyphs, as PNG. Drawing uses no clock and no random
//! numbers, so equal data give equal bytes.

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
