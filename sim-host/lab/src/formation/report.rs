//! Results of the formation experiment.

mod laws;

pub use self::laws::LawJourney;
use self::laws::journeys;
use super::{Crossing, Plan, ROBOTS, Run, Way};
use crate::experiment::Maybe;
use serde::Serialize;
use staya_console::options::{shuffle_ticks, word};
use staya_controller::grid::UNIT;
use staya_sim::terrain::metrics::obstacles_of_entropy;
use staya_stats::{LogFit, Summary, mean};
use std::fmt::{self, Display, Formatter};

/// The fit is not valid outside its range; towards 0 it becomes negative.
const LEAST_OF_PAPER: f64 = 10.0;

/// Results of one kind of crossing over all landscapes of a point.
#[derive(Clone, Debug, Serialize)]
pub struct Journey {
    /// eps, cells.
    pub eps: u8,
    /// Loss of packets, 0 to 1.
    pub loss: f64,
    /// Landscapes that all robots crossed.
    pub arrived: usize,
    /// dPhi per robot over all landscapes, cells, with the graph on the top leader.
    pub error_per_agent: Summary,
    /// The 95 % interval of the mean of `error_per_agent`.
    pub error_interval95: [f64; 2],
    /// Mean dPhi per robot, cells, with the graph at its best-fitting translation.
    pub best_fit_error_per_agent: f64,
    /// Mean graph distance.
    pub graph_distance: f64,
    /// Largest error per robot in any tick, cells.
    pub worst_error: f64,
    /// Mean arrival time of the last robot, ticks, if all arrived with and without formation.
    pub time_ticks: Option<f64>,
    /// Ratio of `time_ticks` to the time without formation.
    pub time_ratio: Option<f64>,
    /// Robots inside walls or each other, summed over ticks.
    pub collisions: u64,
}

/// One point of the figure.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Number of obstacles N.
    pub obstacles: u32,
    /// Number of landscapes.
    pub runs: usize,
    /// Landscapes that all robots crossed without formation.
    pub alone_arrived: usize,
    /// Mean arrival time of the last robot without formation, ticks.
    pub alone_time_ticks: Option<f64>,
    /// Crossings in formation as planned.
    pub formation: Journey,
    /// Mean configuration entropy S of the landscapes.
    pub entropy: f64,
    /// dPhi / 6 of the paper's curve at N obstacles; `null` below 10, where the curve is not valid.
    pub paper_error_per_agent: Option<f64>,
    /// Ratio of our error to the paper's at this N.
    pub error_over_paper: Option<f64>,
    /// Obstacles at which the paper's terrain has this entropy: N(S) with its constant corrected.
    pub obstacles_of_entropy: f64,
    /// dPhi / 6 of the paper's curve at that number; rougher terrain than ours below N = 70.
    pub paper_error_at_entropy: Option<f64>,
    /// Ratio of our error to the paper's at this entropy.
    pub error_over_paper_at_entropy: Option<f64>,
    /// Crossings with other values of eps.
    pub other_eps: Vec<Journey>,
    /// Crossings with other losses.
    pub other_losses: Vec<Journey>,
    /// Crossings under other laws, each at all losses.
    pub other_laws: Vec<LawJourney>,
}

/// Parameter that a table or a plot varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variants {
    /// Other values of eps.
    Eps,
    /// Other losses.
    Loss,
}

impl Point {
    /// All values of a parameter with the planned one, in ascending order.
    #[must_use]
    pub fn variants(&self, kind: Variants) -> Vec<&Journey> {
        let others = match kind {
            Variants::Eps => &self.other_eps,
            Variants::Loss => &self.other_losses,
        };
        let key = |journey: &Journey| match kind {
            Variants::Eps => f64::from(journey.eps),
            Variants::Loss => journey.loss,
        };
        let mut all: Vec<&Journey> = others.iter().chain([&self.formation]).collect();
        all.sort_by(|a, b| key(a).total_cmp(&key(b)));
        all.dedup_by(|a, b| key(a) == key(b));
        all
    }
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the experiment.
    pub seed: u64,
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
    /// Distance of adjacent robots, cells.
    pub spacing: u8,
    /// Geodesic radius of the templates.
    pub rho: u8,
    /// Radius of the window.
    pub radius: u8,
    /// Lag at which the top leader waits, cells.
    pub halt_cells: f64,
    /// Least-squares fit of dPhi / 6 = a ln(N + 1) + b.
    pub fit: Option<LogFit>,
    /// The paper's fit.
    pub paper: LogFit,
    /// Points in ascending order of obstacles.
    pub points: Vec<Point>,
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let by_point = plan.obstacles.iter().zip(runs);
        let mut points: Vec<Point> =
            by_point.filter_map(|(&obstacles, runs)| Point::of(plan, obstacles, runs)).collect();
        points.sort_by_key(|point| point.obstacles);
        let fitted: Vec<[f64; 2]> =
            points.iter().map(|p| [f64::from(p.obstacles), p.formation.error_per_agent.mean]).collect();
        Self {
            seed: plan.seed,
            runs: plan.runs,
            size: plan.size,
            classes: plan.classes,
            hills: word(plan.hills),
            shuffle_ticks: shuffle_ticks(plan.sharpness),
            spacing: plan.spacing,
            rho: plan.rho,
            radius: plan.route.radius,
            halt_cells: f64::from(plan.formation.halt_lag) / f64::from(UNIT),
            fit: LogFit::of(&fitted),
            paper: LogFit::PAPER,
            points,
        }
    }
}

impl Point {
    fn of(plan: &Plan, obstacles: u32, runs: &[Run]) -> Option<Self> {
        let alone: Vec<Option<f64>> = runs.iter().map(|run| run[0].time_ticks).collect();
        let alone_times: Vec<f64> = alone.iter().copied().flatten().collect();
        let of = |way: usize, eps: u8, loss: f64| {
            let crossings: Vec<Crossing> = runs.iter().map(|run| run[way]).collect();
            Journey::of(eps, loss, &crossings, &alone)
        };
        let mut together = plan.ways().enumerate().filter_map(|(way, kind)| match kind {
            Way::Alone | Way::Under { .. } => None,
            Way::Together { eps, loss } => of(way, eps, loss),
        });
        let formation = together.next()?;
        let other_eps: Vec<Journey> = together.by_ref().take(plan.other_eps.len()).collect();
        let other_losses = together.collect();
        let other_laws = journeys(plan.ways().enumerate().filter_map(|(way, kind)| match kind {
            Way::Alone | Way::Together { .. } => None,
            Way::Under { law, loss } => Some((law, of(way, law.eps(plan), loss))),
        }));
        let entropy = mean(&runs.iter().map(|run| run[0].entropy).collect::<Vec<_>>())?;
        let of_entropy = obstacles_of_entropy(entropy);
        let paper = |obstacles: f64| (obstacles >= LEAST_OF_PAPER).then(|| LogFit::PAPER.at(obstacles));
        let over = |paper: Option<f64>| Some(formation.error_per_agent.mean / paper?);
        let (same_obstacles, same_entropy) = (paper(f64::from(obstacles)), paper(of_entropy));
        Some(Self {
            obstacles,
            runs: runs.len(),
            alone_arrived: alone_times.len(),
            alone_time_ticks: mean(&alone_times),
            entropy,
            paper_error_per_agent: same_obstacles,
            error_over_paper: over(same_obstacles),
            obstacles_of_entropy: of_entropy,
            paper_error_at_entropy: same_entropy,
            error_over_paper_at_entropy: over(same_entropy),
            formation,
            other_eps,
            other_losses,
            other_laws,
        })
    }
}

impl Journey {
    fn of(eps: u8, loss: f64, crossings: &[Crossing], alone: &[Option<f64>]) -> Option<Self> {
        let column = |value: fn(&Crossing) -> f64| -> Vec<f64> { crossings.iter().map(value).collect() };
        let error = Summary::of(&column(|c| c.error))?;
        let both: Vec<[f64; 2]> = crossings
            .iter()
            .zip(alone)
            .filter_map(|(crossing, alone)| Some([crossing.time_ticks?, (*alone)?]))
            .collect();
        let time = mean(&both.iter().map(|times| times[0]).collect::<Vec<_>>());
        let base = mean(&both.iter().map(|times| times[1]).collect::<Vec<_>>());
        Some(Self {
            eps,
            loss,
            arrived: crossings.iter().filter(|c| c.arrived == ROBOTS).count(),
            error_per_agent: error,
            error_interval95: error.mean_interval95(),
            best_fit_error_per_agent: mean(&column(|c| c.best_fit_error))?,
            graph_distance: mean(&column(|c| c.graph_distance))?,
            worst_error: column(|c| c.worst_error).into_iter().fold(0.0, f64::max),
            time_ticks: time,
            time_ratio: time.zip(base).map(|(time, base)| time / base),
            collisions: crossings.iter().map(|c| c.collisions).sum(),
        })
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "six robots {} cells apart, {size} x {size} cells, {} classes, {} hills, window radius {}, rho {}, r0 {:.2} cells, \
             shuffle {} ticks, seed {}",
            self.spacing,
            self.classes,
            self.hills,
            self.radius,
            self.rho,
            self.halt_cells,
            self.shuffle_ticks,
            self.seed,
            size = self.size,
        )?;
        writeln!(
            f,
            "{:>4}{:>6}{:>9}{:>8}{:>7}{:>8}{:>9}{:>7}{:>7}{:>7}{:>10}{:>9}{:>8}{:>8}{:>7}{:>7}",
            "N",
            "runs",
            "arrived",
            "dPhi/6",
            "+-",
            "paper",
            "of paper",
            "S",
            "N(S)",
            "of it",
            "best fit",
            "dist",
            "worst",
            "alone",
            "time",
            "ratio"
        )?;
        for point in &self.points {
            let journey = &point.formation;
            writeln!(
                f,
                "{:>4}{:>6}{:>9}{:>8.3}{:>7}{:>8}{:>9}{:>7.3}{:>7.1}{:>7}{:>10.3}{:>9.3}{:>8.2}{:>8}{:>7}{:>7}",
                point.obstacles,
                point.runs,
                journey.arrived,
                journey.error_per_agent.mean,
                Maybe(journey.error_per_agent.mean_error95, 3),
                Maybe(point.paper_error_per_agent, 3),
                Maybe(point.error_over_paper, 2),
                point.entropy,
                point.obstacles_of_entropy,
                Maybe(point.error_over_paper_at_entropy, 2),
                journey.best_fit_error_per_agent,
                journey.graph_distance,
                journey.worst_error,
                Maybe(point.alone_time_ticks, 0),
                Maybe(journey.time_ticks, 0),
                Maybe(journey.time_ratio, 2),
            )?;
        }
        f.write_str("of paper: at equal N; of it: at equal entropy S, of the paper's at N(S) obstacles, where its land has that S;\n")?;
        f.write_str("dPhi/6: error per robot, cells; best fit: the same, graph placed by the best-fitting translation; dist: graph distance;\n")?;
        f.write_str("worst: largest error per robot of any tick; alone, time: ticks until the last robot arrived without and in formation\n\n")?;
        if let Some(fit) = self.fit {
            writeln!(f, "fit:   dPhi/6 = {:.6} ln(N + 1) {:+.6}, R2 = {:.4}", fit.a, fit.b, fit.r2)?;
        }
        let paper = self.paper;
        writeln!(f, "paper: dPhi/6 = {:.6} ln(N + 1) {:+.6}, R2 = {:.4}", paper.a, paper.b, paper.r2)?;
        variants(f, self, Variants::Eps)?;
        variants(f, self, Variants::Loss)?;
        self.write_laws(f)
    }
}

fn variants(f: &mut Formatter<'_>, report: &Report, kind: Variants) -> fmt::Result {
    let Some(first) = report.points.first() else {
        return Ok(());
    };
    let values = first.variants(kind);
    if values.len() < 2 {
        return Ok(());
    }
    let (name, value): (_, fn(&Journey) -> String) = match kind {
        Variants::Eps => ("eps", |journey| journey.eps.to_string()),
        Variants::Loss => ("loss %", |journey| format!("{:.0}", 100.0 * journey.loss)),
    };
    writeln!(
        f,
        "\ndPhi/6, travel time ratio and (worst error) for each {name}; [n] = only n landscapes were crossed by all"
    )?;
    write!(f, "{name:>8}")?;
    for point in &report.points {
        write!(f, "{:>20}", format!("N = {}", point.obstacles))?;
    }
    writeln!(f)?;
    for (index, journey) in values.iter().enumerate() {
        write!(f, "{:>8}", value(journey))?;
        for point in &report.points {
            let entry = point.variants(kind)[index];
            let crossed = if entry.arrived < point.runs { format!("[{}] ", entry.arrived) } else { String::new() };
            let entry = format!(
                "{crossed}{:.2} {} ({:.1})",
                entry.error_per_agent.mean,
                Maybe(entry.time_ratio, 2),
                entry.worst_error
            );
            write!(f, "{entry:>20}")?;
        }
        writeln!(f)?;
    }
    Ok(())
}
