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
pub mod map;
pub mod movie;
mod panels;
mod raster;
mod run;
mod scale;
mod series;
mod story;
mod svg;
pub mod terrain;
pub mod ticks;
mod trajectories;
mod view;
mod write;

pub use chart::{Chart, Series};
pub use heat::HeatMap;
pub use panels::Panels;

use flock::Sheet;
use staya_sim::record::{self, Error, History};
use staya_sim::scenario::Scenario;
use std::path::{Path, PathBuf};
use story::Story;

/// Draws the pictures of a run into `out_dir`, which is created if needed, each as SVG and PNG.
/// Returns the paths. O(cells + samples of the history).
///
/// - `trajectories`, on the grid, only if the history has frames: the map at the start, its
///   changing cells, the path of each robot, and the formation over time
/// - `formation`, on the grid, if the run has it: formation error and graph distance over time
/// - `motion`, in the plane and in space, only if the history has frames: [`motion_sheet`]
/// - `packets`: packets per second by result, over time
///
/// # Errors
/// The directory or a file cannot be written.
pub fn run_pictures(scenario: &Scenario, history: &History, out_dir: &Path) -> Result<Vec<PathBuf>, Error> {
    record::make_dir(out_dir)?;
    let of = format!("{} (seed {})", scenario.name, scenario.seed);
    if scenario.plane().is_none() {
        let (changing, edges) = (scenario.changing_cells(), scenario.numbered_edges());
        return run::on_map(&of, &scenario.land.terrain, &changing, history, &edges, out_dir);
    }
    let mut files = Vec::new();
    if !history.frames().is_empty() {
        files.extend(motion_sheet(&of, scenario, history).draw().write(&out_dir.join("motion"))?);
    }
    files.extend(run::packets(&of, history).draw().write(&out_dir.join("packets"))?);
    Ok(files)
}

/// Draws four moments of a run side by side: positions with past paths, from above on the map if
/// there is one, and in perspective for flyers. The title may be empty.
#[must_use]
pub fn motion_sheet(title: &str, scenario: &Scenario, history: &History) -> Sheet {
    let story = Story::new(scenario, history);
    let sheet = Sheet::new(title, 2).with_legend(story.keys());
    story.moments().fold(sheet, |sheet, at| {
        let title = format!("after {:.1} s", story.frames[at].time_s);
        sheet.with(flock::Snapshot { title, ..story.full_moment(at) })
    })
}

#[cfg(test)]
mod tests;
