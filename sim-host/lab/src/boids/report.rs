//! Results of the boids experiment.

use super::{Flock, Method, Plan};
use crate::experiment::Maybe;
use crate::experiment::rows::{Each, Record};
use serde::Serialize;
use staya_sim::metrics::flock::polarisation;
use std::fmt::{self, Display, Formatter};

/// Time of one search for one number of boids.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Timing {
    /// Name of the search.
    pub method: &'static str,
    /// Wall time of the median step per boid, on one thread, index included, microseconds.
    pub us_per_boid: f64,
    /// Wall time of the median step, milliseconds.
    pub ms_per_step: f64,
    /// Hash of places and headings after the last step.
    pub hash: String,
}

/// All searches for one number of boids.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Number of boids.
    pub boids: u32,
    /// Timed steps.
    pub steps: u32,
    /// Mean number of neighbours in the last step.
    pub mean_neighbours: f64,
    /// One entry per search that was used.
    pub timings: Vec<Timing>,
    /// Lattice cells on all threads, microseconds per boid and step.
    pub parallel_us_per_boid: f64,
    #[serde(skip)]
    pub(super) is_equal: bool,
    #[serde(skip)]
    pub(super) hash: u64,
}

impl Record for Row {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("mean_neighbours", "mean number of neighbours in the last step", &mut self.mean_neighbours);
        for (method, [us_name, ms_name]) in Method::ALL.into_iter().zip([
            ["us_per_boid.all_pairs", "ms_per_step.all_pairs"],
            ["us_per_boid.pairs_once", "ms_per_step.pairs_once"],
            ["us_per_boid.cells", "ms_per_step.cells"],
            ["us_per_boid.tree", "ms_per_step.tree"],
            ["us_per_boid.midpoint_tree", "ms_per_step.midpoint_tree"],
        ]) {
            let found = self.timings.iter().position(|timing| timing.method == method.name());
            let timing = found.map(|at| &self.timings[at]);
            let [mut us, mut ms] = [timing.map(|t| t.us_per_boid), timing.map(|t| t.ms_per_step)];
            each(us_name, "wall time per boid and step on one thread, microseconds; empty: not run", &mut us);
            each(ms_name, "wall time of the median step, milliseconds", &mut ms);
            if let (None, Some(us_per_boid), Some(ms_per_step)) = (found, us, ms) {
                let hash = String::new();
                self.timings.push(Timing { method: method.name(), us_per_boid, ms_per_step, hash });
            }
        }
        each("us_per_boid.threads", "the same by cells on all threads", &mut self.parallel_us_per_boid);
        each("equal", "1: all searches gave the same trajectories", &mut self.is_equal);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

impl Row {
    pub(super) const fn new(boids: u32, steps: u32) -> Self {
        Self {
            boids,
            steps,
            mean_neighbours: 0.0,
            timings: Vec::new(),
            parallel_us_per_boid: 0.0,
            is_equal: true,
            hash: 0,
        }
    }

    pub(super) fn settle(&mut self) {
        self.is_equal = self.timings.windows(2).all(|pair| pair[0].hash == pair[1].hash);
        let first = self.timings.first().and_then(|timing| u64::from_str_radix(&timing.hash, 16).ok());
        self.hash = first.unwrap_or_default();
    }

    pub(super) fn tell_hashes(&mut self) {
        let (hash, is_equal) = (format!("{:016x}", self.hash), self.is_equal);
        for (index, timing) in self.timings.iter_mut().enumerate().filter(|(_, timing)| timing.hash.is_empty()) {
            timing.hash = if is_equal || index == 0 { hash.clone() } else { String::from("differs") };
        }
    }

    /// Whether all searches gave equal trajectories.
    #[must_use]
    pub const fn is_equal(&self) -> bool {
        self.is_equal
    }

    /// Microseconds per boid and step with this search; `None` if it was not used.
    #[must_use]
    pub fn us_per_boid(&self, method: &str) -> Option<f64> {
        let timing = self.timings.iter().find(|timing| timing.method == method);
        timing.map(|timing| timing.us_per_boid)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    pub step: u32,
    /// Length of the mean heading, 0 to 1.
    pub polarisation: f64,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the starts.
    pub seed: u64,
    /// Largest number of boids for searches over all pairs.
    pub most_by_all_pairs: u32,
    /// Area per boid.
    pub area_per_boid: f32,
    /// Distance up to which boids see neighbours.
    pub closest: f32,
    /// Threads of the parallel column.
    pub threads: usize,
    /// Whether all searches gave equal trajectories for every number of boids.
    pub equal: bool,
    /// Rows in the order of the plan.
    pub rows: Vec<Row>,
    /// The pictured flock.
    pub moments: Vec<Moment>,
    #[serde(skip)]
    pub(super) flocks: Vec<(u32, Flock)>,
}

impl Report {
    pub(super) fn new(plan: &Plan, rows: Vec<Row>, flocks: Vec<(u32, Flock)>) -> Self {
        let order = |flock: &Flock| {
            let headings = flock.headings().iter();
            polarisation::<2>(&headings.map(|h| [h.x, h.y].map(f64::from)).collect::<Vec<_>>())
        };
        Self {
            seed: plan.seed,
            most_by_all_pairs: plan.most_by_all_pairs,
            area_per_boid: plan.area_per_boid,
            closest: plan.closest,
            threads: rayon::current_num_threads(),
            moments: flocks.iter().map(|(step, flock)| Moment { step: *step, polarisation: order(flock) }).collect(),
            equal: rows.iter().all(Row::is_equal),
            rows,
            flocks,
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "boids on a torus of {} square units a boid, neighbours up to {}, seed {}; microseconds a boid in the median step",
            self.area_per_boid, self.closest, self.seed
        )?;
        write!(f, "{:>8}{:>7}{:>12}", "boids", "steps", "neighbours")?;
        for method in Method::ALL {
            write!(f, "{:>15}", method.name())?;
        }
        let parallel = format!("cells, {} threads", self.threads);
        writeln!(f, "{parallel:>19}{:>9}  hash", "equal")?;
        for row in &self.rows {
            write!(f, "{:>8}{:>7}{:>12.2}", row.boids, row.steps, row.mean_neighbours)?;
            for method in Method::ALL {
                write!(f, "{:>15}", Maybe(row.us_per_boid(method.name()), 3))?;
            }
            let equal = if row.is_equal() { "yes" } else { "NO" };
            let hash = row.timings.first().map_or("", |timing| &timing.hash);
            writeln!(f, "{:>19.3}{equal:>9}  {hash}", row.parallel_us_per_boid)?;
        }
        writeln!(
            f,
            "-: not run; all pairs only up to {} boids, since a step costs their square",
            self.most_by_all_pairs
        )?;
        for moment in &self.moments {
            writeln!(f, "pictured flock after {} steps: group order {:.3}", moment.step, moment.polarisation)?;
        }
        Ok(())
    }
}
