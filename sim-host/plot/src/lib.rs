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
pub use motion::motion_sheet;
pub use panels::Panels;

use staya_sim::record::{self, Error, History};
use staya_sim::scenario::Scenario;
use std::path::{Path, PathBuf};

/// Draws the pictures of a run into `out_dir`, which is created if needed, each as SVG and PNG.
/// Returns the paths. O(cells + samples of the history).
///
/// - `trajectories`, on the grid, only if the history has frames: the map at the start, its
///   changing cells, the path of each robot, and the formation over time
/// - `formation`, on the grid, if the run has it: formation error and graph distance over time
/// - `motion`, in the plane, only if the history has frames: positions with past paths at four
///   moments, from above, on the map if there is one
/// - `packets`: packets per second by result, over time
///
/// # Errors
/// The directory or a file cannot be written.
pub fn run_pictures(scenario: &Scenario, history: &History, out_dir: &Path) -> Result<Vec<PathBuf>, Error> {
    record::make_dir(out_dir)?;
    let of = format!("{} (seed {})", scenario.name, scenario.seed);
    match &scenario.plane {
        Some(setup) => motion::in_plane(&of, scenario, setup, history, out_dir),
        None => {
            let (changing, edges) = (scenario.changing_cells(), scenario.numbered_edges());
            run::on_map(&of, &scenario.terrain, &changing, history, &edges, out_dir)
        }
    }
}

#[cfg(test)]
mod tests;
