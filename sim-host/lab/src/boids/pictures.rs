//! Pictures of the boids experiment.

use super::{Method, Report};
use staya_plot::flock::{Sheet, Snapshot};
use staya_plot::{Chart, Series};
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

impl Report {
    /// Draws the flock at three moments (`flock`) and the cost by number of boids (`cost`) into
    /// `dir`, each as SVG and PNG, and returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = Vec::new();
        if !self.flocks.is_empty() {
            files.extend(self.flock().draw().write(&dir.join("flock"))?);
        }
        if !self.rows.is_empty() {
            files.extend(self.cost().write(&dir.join("cost"))?);
        }
        Ok(files)
    }

    fn flock(&self) -> Sheet {
        let boids = self.flocks.first().map_or(0, |(_, flock)| flock.places().len());
        let title = format!("{boids} boids on a torus");
        let pairs = self.flocks.iter().zip(&self.moments);
        pairs.fold(Sheet::new(title, 3), |sheet, ((step, flock), moment)| {
            let [width, height] = flock.sides().map(f64::from);
            sheet.with(Snapshot {
                title: format!("step {step}, group order {:.2}", moment.polarisation),
                positions_m: flock.places().iter().map(|at| at.map(f64::from)).collect(),
                velocities_mps: flock.headings().iter().map(|h| [h.x, h.y].map(f64::from)).collect(),
                view_m: Some([[0.0, width], [0.0, height]]),
                labels: ["x".into(), "y".into()],
                size: [440.0, 366.0],
                ..Snapshot::default()
            })
        })
    }

    fn cost(&self) -> Chart {
        let chart = Chart::new("Cost of a step of boids with each search", "boids", "microseconds per boid and step")
            .note("median step on one thread, building the index included")
            .log_x()
            .log_y();
        Method::ALL.into_iter().fold(chart, |chart, method| {
            let points = self.rows.iter().filter_map(|row| {
                let us = row.us_per_boid(method.name())?;
                Some([f64::from(row.boids), us])
            });
            chart.with(Series::points(method.name(), points).joined())
        })
    }
}
