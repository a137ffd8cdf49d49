//! Results of the route experiment.

use super::{Coefficient, Land, Plan, Run, ticks};
use crate::experiment::Maybe;
use rayon::prelude::*;
use serde::Serialize;
use staya_console::options::{shuffle_ticks, word};
use staya_controller::cost::Gain;
use staya_controller::grid::Norm;
use staya_controller::route::RouteParams;
use staya_sim::terrain::metrics::obstacles_of_entropy;
use staya_stats::{Goodness, Histogram, NortonRice, Summary, mean};
use std::fmt::{self, Display, Formatter};

const BINS: usize = 30;

/// Loss compared with the fastest route, percent, over arrived robots.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Loss {
    /// Mean, median and spread.
    #[serde(flatten)]
    pub summary: Summary,
    /// 95 % interval of the mean.
    pub interval95: [f64; 2],
}

impl Loss {
    fn of(values: &[f64]) -> Option<Self> {
        let summary = Summary::of(values)?;
        Some(Self { summary, interval95: summary.mean_interval95() })
    }
}

/// Arrival times: histogram, Norton-Rice distribution and its goodness of fit (KUZ figure 4).
#[derive(Clone, Debug, Serialize)]
pub struct Arrivals {
    /// Mean travel time, ticks.
    pub mean_ticks: f64,
    /// Left edge of the first bin, ticks.
    pub low_ticks: f64,
    /// Width of a bin, ticks.
    pub bin_ticks: f64,
    /// Arrivals in each bin.
    pub counts: Vec<u64>,
    /// Maximum-likelihood distribution; `None` for fewer than 10 or equal arrivals.
    pub norton_rice: Option<NortonRice>,
    /// Chi-square test of the distribution; `None` for fewer than about 40 arrivals.
    pub goodness: Option<Goodness>,
}

impl Arrivals {
    fn of(times_ticks: &[f64]) -> Option<Self> {
        let histogram = Histogram::new(times_ticks, BINS)?;
        let law = NortonRice::fit(times_ticks).ok();
        Some(Self {
            mean_ticks: mean(times_ticks)?,
            low_ticks: histogram.low,
            bin_ticks: histogram.width,
            counts: histogram.counts,
            norton_rice: law,
            goodness: law.and_then(|law| law.goodness(times_ticks)),
        })
    }
}

/// One point of the figures.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Family of landscapes: `natural`, `shuffled` or `uniform`.
    pub land: &'static str,
    /// Number of obstacles N; `null` for uniform land.
    pub obstacles: Option<u32>,
    /// Number of landscapes.
    pub runs: usize,
    /// Robots that reached their target.
    pub arrived: usize,
    /// dT: excess of the travel time over that of the fastest route, percent.
    pub time_loss_percent: Option<Loss>,
    /// dL (KUZ): absolute difference of the path's length to that of the fastest route, percent.
    pub length_loss_percent: Option<Loss>,
    /// Mean signed difference of the lengths, percent; negative if robots cross bad ground.
    pub length_excess_percent: Option<f64>,
    /// Mean configuration entropy S.
    pub entropy: f64,
    /// Mean total edge TE.
    pub total_edge: f64,
    /// Mean total edge density TED.
    pub total_edge_density: f64,
    /// N(S) of the mean entropy by KUZ's formula with its constant corrected.
    pub obstacles_of_entropy: f64,
    /// Arrival times of the robots.
    pub arrivals: Option<Arrivals>,
    /// Arrival times of the fastest routes on all landscapes.
    pub optimal_arrivals: Option<Arrivals>,
}

/// Effect of another value of a coefficient on the same landscapes.
#[derive(Clone, Debug, Serialize)]
pub struct Response {
    /// The coefficient.
    pub coefficient: Coefficient,
    /// Value of the coefficient.
    pub value: f64,
    /// Mean losses, in the order of the points.
    pub points: Vec<Means>,
}

/// Mean losses of one point.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Means {
    /// Robots that reached their target.
    pub arrived: usize,
    /// Mean dT, percent.
    pub time_loss_percent: Option<f64>,
    /// Mean dL, percent.
    pub length_loss_percent: Option<f64>,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Always `route`.
    pub experiment: &'static str,
    /// Requested landscapes per point.
    pub runs: u32,
    /// Cells along each side.
    pub size: u16,
    /// Classes of impassability.
    pub classes: u8,
    /// Interpretation of natural terrain.
    pub hills: String,
    /// Additional cost of a move that halves its chance, ticks; 0: the cheapest is first.
    pub shuffle_ticks: f64,
    /// Norm of the distance to an obstacle.
    pub hill_norm: Norm,
    /// Parked robots on each landscape.
    pub parked: u32,
    /// Seed of the experiment.
    pub seed: u64,
    /// Window radius, cells.
    pub radius: u8,
    /// Exit rule: `best` or `ray`.
    pub exit: String,
    /// When robots repeat their search: `each-cell` or `until-changed`.
    pub replan: String,
    /// Norm of the length of moves.
    pub norm: Norm,
    /// Whether moves may cut corners.
    pub corner_cutting: bool,
    /// Weight of travel time.
    pub a0: f64,
    /// Ticks per cell with another robot.
    pub a1: f64,
    /// Ticks per earlier visit.
    pub a2: f64,
    /// Ticks per cell of distance between exit and target.
    pub a3: f64,
    /// Points in the order of the plan, without points that have no runs.
    pub points: Vec<Point>,
    /// Effects of other coefficients.
    pub sweep: Vec<Response>,
    #[serde(skip)]
    pub(super) params: RouteParams,
}

/// Converts a coefficient to a number, sixteenths to units.
#[must_use]
pub fn decimal(gain: Gain) -> f64 {
    f64::from(gain.sixteenths()) / f64::from(Gain::ONE.sixteenths())
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let params = &plan.params;
        let filled: Vec<(Land, &[Run])> = plan
            .lands
            .iter()
            .zip(runs)
            .filter(|(_, runs)| !runs.is_empty())
            .map(|(land, runs)| (*land, runs.as_slice()))
            .collect();
        let points = filled.par_iter().filter_map(|(land, runs)| point(*land, runs, plan.size)).collect();
        let response = |(index, (coefficient, value)): (usize, &(Coefficient, Gain))| Response {
            coefficient: *coefficient,
            value: decimal(*value),
            points: filled
                .iter()
                .map(|(_, runs)| {
                    // Path 0 has the plan's own parameters.
                    let [time, length] = losses(runs, index + 1);
                    let size = |percent: f64| libm::fabs(percent);
                    let length: Vec<f64> = length.into_iter().map(size).collect();
                    Means { arrived: time.len(), time_loss_percent: mean(&time), length_loss_percent: mean(&length) }
                })
                .collect(),
        };
        Self {
            experiment: "route",
            runs: plan.runs,
            size: plan.size,
            classes: plan.classes,
            hills: word(plan.hills),
            shuffle_ticks: shuffle_ticks(plan.sharpness),
            hill_norm: plan.hill_norm,
            parked: plan.parked,
            seed: plan.seed,
            radius: params.radius,
            exit: word(params.exit),
            replan: word(plan.replan),
            norm: params.norm,
            corner_cutting: params.corner_cutting,
            a0: decimal(params.a0),
            a1: decimal(params.a1),
            a2: decimal(params.a2),
            a3: decimal(params.a3),
            points,
            sweep: plan.sweep.iter().enumerate().map(response).collect(),
            params: *params,
        }
    }
}

/// Excess of time and (signed) length of path `variant`, percent, over arrived robots.
fn losses(runs: &[Run], variant: usize) -> [Vec<f64>; 2] {
    let percent = |ours: u64, best: u64| 100.0 * (ours as f64 - best as f64) / best as f64;
    let arrived = runs.iter().map(|run| (run, &run.walks[variant])).filter(|(_, walk)| walk.arrived);
    let (time, length) = arrived
        .map(|(run, walk)| (percent(walk.cost, run.optimal_cost), percent(walk.length, run.optimal_length)))
        .unzip();
    [time, length]
}

fn point(land: Land, runs: &[Run], size: u16) -> Option<Point> {
    let over_runs = |value: fn(&Run) -> f64| {
        let values: Vec<f64> = runs.iter().map(value).collect();
        mean(&values)
    };
    let entropy = over_runs(|run| run.entropy)?;
    let total_edge = over_runs(|run| run.total_edge as f64)?;
    let [time, length] = losses(runs, 0);
    let deviation: Vec<f64> = length.iter().map(|percent| libm::fabs(*percent)).collect();
    let walks = runs.iter().map(|run| &run.walks[0]);
    let arrivals: Vec<f64> = walks.filter(|walk| walk.arrived).map(|walk| ticks(walk.cost)).collect();
    let optimal: Vec<f64> = runs.iter().map(|run| ticks(run.optimal_cost)).collect();
    Some(Point {
        land: land.family(),
        obstacles: land.obstacles(),
        runs: runs.len(),
        arrived: arrivals.len(),
        time_loss_percent: Loss::of(&time),
        length_loss_percent: Loss::of(&deviation),
        length_excess_percent: mean(&length),
        entropy,
        total_edge,
        total_edge_density: total_edge / (f64::from(size) * f64::from(size)),
        obstacles_of_entropy: obstacles_of_entropy(entropy),
        arrivals: Arrivals::of(&arrivals),
        optimal_arrivals: Arrivals::of(&optimal),
    })
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{size} x {size} cells, {} classes, {} hills, window radius {}, exit {}, a = ({}, {}, {}, {}), shuffle {} ticks, seed {}",
            self.classes,
            self.hills,
            self.radius,
            self.exit,
            self.a0,
            self.a1,
            self.a2,
            self.a3,
            self.shuffle_ticks,
            self.seed,
            size = self.size,
        )?;
        writeln!(
            f,
            "{:<9}{:>5}{:>7}{:>9}{:>9}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
            "land", "N", "runs", "arrived", "dT %", "+-", "median", "dL %", "+-", "median", "S", "TE", "TED", "N(S)"
        )?;
        for point in &self.points {
            let column = |loss: Option<Loss>| {
                let summary = loss.map(|loss| loss.summary);
                [
                    Maybe(summary.map(|s| s.mean), 2),
                    Maybe(summary.and_then(|s| s.mean_error95), 2),
                    Maybe(summary.map(|s| s.median), 2),
                ]
            };
            let [t, te, tm] = column(point.time_loss_percent);
            let [l, le, lm] = column(point.length_loss_percent);
            writeln!(
                f,
                "{}{:>7}{:>9}{t:>9}{te:>8}{tm:>8}{l:>9}{le:>8}{lm:>8}{:>8.3}{:>8.0}{:>8.3}{:>8.1}",
                row_name(point),
                point.runs,
                point.arrived,
                point.entropy,
                point.total_edge,
                point.total_edge_density,
                point.obstacles_of_entropy,
            )?;
        }
        f.write_str("+-: half the 95 % interval of the mean. N(S): obstacles by entropy\n\n")?;
        f.write_str(
            "Travel time in ticks with its Norton-Rice law (m, alpha, beta) and the p-value of the chi-square test\n",
        )?;
        let names = ["mean", "m", "alpha", "beta", "p"];
        write!(f, "{:<14}", "")?;
        for group in ["by window", "fastest route"] {
            write!(f, "  {group:<14}")?;
            names.iter().try_for_each(|name| write!(f, "{name:>8}"))?;
        }
        writeln!(f)?;
        for point in &self.points {
            f.write_str(&row_name(point))?;
            for arrivals in [&point.arrivals, &point.optimal_arrivals] {
                write!(f, "{:16}", "")?;
                let arrivals = arrivals.as_ref();
                let law = arrivals.and_then(|a| a.norton_rice);
                let p = arrivals.and_then(|a| a.goodness).map(|g| g.p_value);
                let values = [
                    Maybe(arrivals.map(|a| a.mean_ticks), 1).to_string(),
                    digits(law.map(|law| law.m())),
                    digits(law.map(|law| law.alpha())),
                    digits(law.map(|law| law.beta())),
                    Maybe(p, 3).to_string(),
                ];
                values.iter().try_for_each(|value| write!(f, "{value:>8}"))?;
            }
            writeln!(f)?;
        }
        sweep_tables(f, self)
    }
}

fn digits(value: Option<f64>) -> String {
    match value {
        Some(x) if x < 0.01 => format!("{x:.0e}"),
        Some(x) if x < 100.0 => format!("{x:.2}"),
        _ => Maybe(value, 1).to_string(),
    }
}

fn row_name(point: &Point) -> String {
    let obstacles = point.obstacles.map_or(String::from("-"), |n| n.to_string());
    format!("{:<9}{obstacles:>5}", point.land)
}

fn sweep_tables(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    for responses in report.sweep.chunk_by(|a, b| a.coefficient == b.coefficient) {
        let coefficient = responses[0].coefficient;
        let name = coefficient.name();
        writeln!(f, "\ndT % / dL % for other values of {name}, * = the value above; (n) = only n arrived")?;
        write!(f, "{name:>8} ")?;
        for point in &report.points {
            let obstacles = point.obstacles.map_or(String::new(), |n| format!(" {n}"));
            write!(f, "{:>20}", format!("{}{obstacles}", point.land))?;
        }
        writeln!(f)?;
        for response in responses {
            let is_own = decimal(coefficient.get(&report.params)) == response.value;
            write!(f, "{:>8}{}", response.value, if is_own { '*' } else { ' ' })?;
            for (means, point) in response.points.iter().zip(&report.points) {
                write!(f, "{:>20}", cell(means, point.runs))?;
            }
            writeln!(f)?;
        }
    }
    Ok(())
}

fn cell(means: &Means, runs: usize) -> String {
    let (time, length) = (means.time_loss_percent, means.length_loss_percent);
    let mut text = format!("{} / {}", Maybe(time, 1), Maybe(length, 1));
    if means.arrived < runs {
        text = format!("({}) {text}", means.arrived);
    }
    text
}
