//! The pictures of the goal flock: group order over K1 / K2 and R_nbh, and the way of a run.

use super::{Point, Report};
use staya_plot::flock::{Sheet, Snapshot};
use staya_plot::{Chart, Panels, Series};
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

impl Report {
    /// Draws the figures, and the first run of the point with the middle K1 and the last R_nbh, into `dir` (SVG and PNG), and
    /// names the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = self.order().write(&dir.join("order"))?;
        for (name, point) in self.shown() {
            files.extend(self.sheet(point).draw().write(&dir.join(name))?);
        }
        Ok(files)
    }

    /// Points to draw: least, middle and greatest K1 above 0 at the last R_nbh.
    fn shown(&self) -> Vec<(String, &Point)> {
        let last = self.points.last().map(|point| point.neighborhood_m);
        let points = self.points.iter();
        let row: Vec<&Point> = points.filter(|point| Some(point.neighborhood_m) == last && point.k1 > 0.0).collect();
        let mut shown = Vec::new();
        for index in [0, row.len() / 2, row.len().saturating_sub(1)] {
            if let Some(point) = row.get(index) {
                shown.push((format!("way-k1-{}", point.k1), *point));
            }
        }
        shown.dedup_by(|a, b| a.0 == b.0);
        shown
    }

    fn order(&self) -> Panels {
        let ratio = |point: &Point| point.k1_over_k2.unwrap_or(point.k1);
        let label = if self.k2 == 0.0 { "K1" } else { "K1 / K2" };
        let chart = |title: &str, y: &str, value: fn(&Point) -> Option<f64>| {
            let mut chart = Chart::new(title, label, y).size(560.0, 300.0);
            for &neighborhood_m in &self.plan.neighborhoods_m {
                let points = self.points.iter();
                let row = points.filter(|point| point.neighborhood_m == neighborhood_m);
                let values = row.filter_map(|point| Some([ratio(point), value(point)?]));
                let name = format!("R_nbh = {neighborhood_m} m");
                chart = chart.with(Series::points(name, values).joined());
            }
            chart
        };
        let title =
            format!("{} robots, 3 goals, R_MinDist = {} m, safety {}", self.robots, self.min_distance_m, self.safety);
        Panels::new(title)
            .columns(2)
            .with(chart("Polarisation on the way", "0 to 1", |p| p.polarisation).y_range(0.0, 1.05))
            .with(chart("Share of the largest group on the way", "0 to 1", |p| p.together).y_range(0.0, 1.05))
            .with(chart("Radius of the crowd on the way, over that at the start", "ratio", |p| p.spread))
            .with(chart("Share of robots at a goal at the end", "0 to 1", |p| Some(p.arrived)).y_range(0.0, 1.05))
            .with(chart("Least distance of two robots", "R_MinDist", |p| p.least_pair_over_min_distance))
            .with(chart("Time until half were at the middle", "s", |p| p.half_gathered_s))
    }

    fn sheet(&self, point: &Point) -> Sheet {
        let title = format!(
            "K1 = {}, K2 = {}, K3 = {}, R_nbh = {} m, safety {}",
            point.k1, self.k2, self.k3, point.neighborhood_m, self.safety
        );
        let mut sheet = Sheet::new(title, 2);
        for frame in &point.frames {
            let time_s = f64::from(frame.tick) * self.step_s;
            let goals_m = self.plan.goals_at(frame.tick).map(|[x, y, _]| [x, y]);
            let d = self.min_distance_m;
            sheet = sheet.with(Snapshot {
                title: format!("t = {time_s:.0} s"),
                positions_m: frame.places_m.clone(),
                velocities_mps: frame.velocities_mps.clone(),
                radius_m: self.radius_m,
                goals_m: goals_m.to_vec(),
                view_m: Some([[-20.0 * d, 95.0 * d], [-36.0 * d, 36.0 * d]]),
                size: [560.0, 390.0],
                ..Snapshot::default()
            });
        }
        sheet
    }
}
