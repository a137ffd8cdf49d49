//! Pictures of the formation experiment.

use super::{Journey, Point, Report, Variants};
use staya_plot::{Chart, Panels, Series};
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

const STEPS: u32 = 100;

impl Report {
    /// Draws KUZ figure 6 and the effects of eps, loss and laws into `dir`, each as SVG and PNG,
    /// and returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = self.figure6().write(&dir.join("figure6"))?;
        for (kind, name) in [(Variants::Eps, "eps"), (Variants::Loss, "loss")] {
            if self.points.iter().any(|point| point.variants(kind).len() > 1) {
                files.extend(self.variants(kind).write(&dir.join(name))?);
            }
        }
        if let Some(laws) = self.laws_picture() {
            files.extend(laws.write(&dir.join("laws"))?);
        }
        Ok(files)
    }

    pub(super) fn note(&self) -> String {
        format!(
            "six robots {} cells apart, {2} x {2} cells, window radius {1}, {3} runs each",
            self.spacing, self.radius, self.size, self.runs
        )
    }

    pub(super) fn axis(&self) -> impl Iterator<Item = f64> {
        let most = self.points.last().map_or(0, |point| point.obstacles);
        (0..=STEPS).map(move |step| f64::from(most) * f64::from(step) / f64::from(STEPS))
    }

    fn figure6(&self) -> Panels {
        let place = |point: &Point| f64::from(point.obstacles);
        let errors = self.points.iter().map(|point| {
            let [low, high] = point.formation.error_interval95;
            [place(point), point.formation.error_per_agent.mean, low, high]
        });
        let mut error = Chart::new("Formation error per robot", "obstacles N", "error (cells)")
            .note(format!("{}, mean with 95 % interval", self.note()))
            .with(Series::intervals("measured", errors));
        if let Some(fit) = self.fit {
            let name = format!("{:.3} ln(N + 1) + {:.3}, R2 = {:.3}", fit.a, fit.b, fit.r2);
            error = error.with(Series::line(name, self.axis().map(|n| [n, fit.at(n)])).like_previous());
        }
        let paper = self.axis().map(|n| [n, self.paper.at(n)]).filter(|at| at[1] >= 0.0);
        error = error.with(Series::reference("paper: 0.901 ln(N + 1) - 0.674", paper));
        let same_entropy = self.points.iter().filter_map(|p| Some([place(p), p.paper_error_at_entropy?]));
        error = error.with(Series::points("paper, on land of equal entropy S", same_entropy).joined());
        let best_fit = self.points.iter().map(|p| [place(p), p.formation.best_fit_error_per_agent]);
        error = error.with(Series::points("measured, graph placed by best fit", best_fit).joined());

        let ratios = self.points.iter().filter_map(|p| Some([place(p), p.formation.time_ratio?]));
        let ends = [0.0, self.points.last().map_or(0.0, place)];
        let time = Chart::new("Travel time over that of the same robots without formation", "obstacles N", "ratio")
            .size(720.0, 300.0)
            .with(Series::points("in formation", ratios).joined())
            .with(Series::reference("goal: 1.5", ends.map(|n| [n, 1.5])));
        Panels::new("Six robots in formation on natural land").with(error).with(time)
    }

    fn variants(&self, kind: Variants) -> Panels {
        let (title, name): (_, fn(&Journey) -> String) = match kind {
            Variants::Eps => ("Effect of eps", |j| format!("eps = {} cells", j.eps)),
            Variants::Loss => ("Effect of a lossy radio", |j| format!("loss {:.0} %", 100.0 * j.loss)),
        };
        let mut error = Chart::new("Formation error per robot", "obstacles N", "error (cells)").note(self.note());
        let mut time = Chart::new("Travel time over that without formation", "obstacles N", "ratio").size(720.0, 320.0);
        let count = self.points.first().map_or(0, |point| point.variants(kind).len());
        for index in 0..count {
            let over_n = |value: fn(&Journey) -> Option<f64>| -> Vec<[f64; 2]> {
                let value = |point: &Point| value(point.variants(kind).get(index)?);
                let points = self.points.iter();
                points.filter_map(|p| Some([f64::from(p.obstacles), value(p)?])).collect()
            };
            let name = name(self.points[0].variants(kind)[index]);
            error = error.with(Series::points(name.clone(), over_n(|j| Some(j.error_per_agent.mean))).joined());
            time = time.with(Series::points(name, over_n(|j| j.time_ratio)).joined());
        }
        Panels::new(title).with(error).with(time)
    }
}
