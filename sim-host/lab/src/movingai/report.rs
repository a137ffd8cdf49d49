//! Results of a benchmark's queries.

use super::{Benchmark, Robots, Sight};
use crate::experiment::rows::{Each, Record};
use serde::Serialize;
use staya_stats::Summary;
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// Result of one query.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Optimal length given by the benchmark, cells.
    pub optimal_cells: f64,
    /// Whether the robot reached the goal.
    pub arrived: bool,
    /// Length of the path, cells; until the robot gave up if it did not arrive.
    pub length_cells: f64,
    /// Shortest route by the router with the whole map in its window, cells, if there is one.
    pub priced_cells: Option<f64>,
}

impl Record for Answer {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("arrived", "1: the robot reached the goal", &mut self.arrived);
        each("length_cells", "length of its path; until it gave up if it did not arrive", &mut self.length_cells);
        each("priced_cells", "shortest route by the router with the whole map; empty: none", &mut self.priced_cells);
    }
}

impl Answer {
    /// Excess of the path over the optimal length, percent.
    #[must_use]
    pub fn loss_percent(&self) -> f64 {
        percent(self.length_cells, self.optimal_cells)
    }

    /// Deviation of `priced_cells` from the optimal length, percent.
    #[must_use]
    pub fn price_error_percent(&self) -> Option<f64> {
        Some(percent(self.priced_cells?, self.optimal_cells))
    }
}

fn percent(ours: f64, optimal: f64) -> f64 {
    if ours == optimal {
        return 0.0;
    }
    100.0 * (ours - optimal) / optimal
}

/// Results of a benchmark.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Always `movingai`.
    pub experiment: &'static str,
    /// File of the map.
    pub map: PathBuf,
    /// Columns of the map.
    pub width: u16,
    /// Rows of the map.
    pub height: u16,
    /// Window radius in cells; `null`: the whole map.
    pub radius: Option<u8>,
    /// Cells of the visit memory.
    pub visits: usize,
    /// Cells of the learned costs.
    pub learned: usize,
    /// Queries in the scenario.
    pub queries: usize,
    /// Queries answered; fewer after an early end.
    pub answered: usize,
    /// Robots that reached their goal.
    pub arrived: usize,
    /// Excess of paths over the optimal length, percent, over arrived robots.
    pub loss_percent: Option<Summary>,
    /// Largest absolute deviation of `priced_cells` from the optimal length, percent.
    pub worst_price_error_percent: Option<f64>,
    /// With the whole map in the window: queries for which the router finds no route.
    pub without_price: Option<usize>,
}

impl Report {
    /// Computes the statistics of the answers.
    #[must_use]
    pub fn of(benchmark: &Benchmark, robots: &Robots, answers: &[Answer]) -> Self {
        let losses: Vec<f64> = answers.iter().filter(|answer| answer.arrived).map(Answer::loss_percent).collect();
        let errors = answers.iter().filter_map(Answer::price_error_percent);
        let whole = robots.sight == Sight::Map;
        Self {
            experiment: "movingai",
            map: benchmark.map.clone(),
            width: benchmark.land.width(),
            height: benchmark.land.height(),
            radius: match robots.sight {
                Sight::Radius(radius) => Some(radius),
                Sight::Map => None,
            },
            visits: robots.memory.cells(),
            learned: robots.learning.cells(),
            queries: benchmark.queries.len(),
            answered: answers.len(),
            arrived: losses.len(),
            loss_percent: Summary::of(&losses),
            worst_price_error_percent: errors.map(f64::abs).reduce(f64::max),
            without_price: whole.then(|| answers.iter().filter(|answer| answer.priced_cells.is_none()).count()),
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (width, height) = (self.width, self.height);
        writeln!(f, "{} ({width} x {height} cells)", self.map.display())?;
        let radius = self.radius.map_or_else(|| String::from("the whole map"), |r| format!("radius {r}"));
        writeln!(f, "  window                {radius}")?;
        writeln!(f, "  visit memory          {} cells", self.visits)?;
        writeln!(f, "  learned costs         {} cells", self.learned)?;
        let (answered, queries) = (self.answered, self.queries);
        writeln!(f, "  queries answered      {answered} of {queries}")?;
        writeln!(f, "  arrived               {}", self.arrived)?;
        if let Some(loss) = &self.loss_percent {
            writeln!(
                f,
                "  longer than optimal   {:.2} % on average, median {:.2} %, at most {:.2} %",
                loss.mean, loss.median, loss.max
            )?;
        }
        if let Some(error) = self.worst_price_error_percent {
            writeln!(f, "  optimal lengths       met within {error:.4} % for every query with a way")?;
        }
        if let Some(without @ 1..) = self.without_price {
            writeln!(f, "  no way found          {without}")?;
        }
        Ok(())
    }
}
