//! The numbers of the goal flock.

use super::Plan;
use super::watch::{Frame, Run};
use crate::experiment::Maybe;
use crate::options::word;
use serde::Serialize;
use staya_controller::agent::SafetyKind;
use staya_stats::mean;
use std::fmt::{self, Display, Formatter};

/// One K1 and one R_nbh: means over the runs.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Gain on the goal.
    pub k1: f64,
    /// K1 / K2; `null` when K2 is 0.
    pub k1_over_k2: Option<f64>,
    /// R_nbh, metres.
    pub neighborhood_m: f64,
    /// Runs.
    pub runs: usize,
    /// Length of the mean direction on the way, 0 to 1.
    pub polarisation: Option<f64>,
    /// Share of the robots in the largest group on the way.
    pub together: Option<f64>,
    /// Radius of the crowd on the way over that at the start.
    pub spread: Option<f64>,
    /// Share of the robots that came to the middle.
    pub gathered: f64,
    /// Time until half of them had, seconds: mean over the runs in which they did.
    pub half_gathered_s: Option<f64>,
    /// Share of the robots at a goal at the end.
    pub arrived: f64,
    /// Shares of the goals in these.
    pub goal_shares: [f64; 3],
    /// Least distance of two centres of any run, over R_MinDist; `null` when all were farther apart.
    pub least_pair_over_min_distance: Option<f64>,
    /// Pairs of bodies (radius 0.3 R_MinDist) that overlap, summed over ticks and runs.
    pub overlaps: usize,
    /// Fingerprints of the traces, xored.
    pub trace_hash: String,
    #[serde(skip)]
    pub(super) frames: Vec<Frame>,
}

/// Everything.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of everything.
    pub seed: u64,
    /// Robots.
    pub robots: u32,
    /// Gain on the middle of the neighbours.
    pub k2: f64,
    /// Gain on who is too near.
    pub k3: f64,
    /// R_MinDist, metres.
    pub min_distance_m: f64,
    /// Radius of a body, metres.
    pub radius_m: f64,
    /// How near to the middle or to a goal counts, metres.
    pub arrival_m: f64,
    /// Side of the square of the start, in R_MinDist and per root of the robots' number.
    pub start_side: f64,
    /// Obstacles on the way.
    pub obstacles: u32,
    /// Length of a tick, seconds.
    pub step_s: f64,
    /// Length of a run, seconds.
    pub seconds: f64,
    /// What is behind the flock.
    pub safety: String,
    /// Whether the first goal was moved.
    pub moves_goal: bool,
    /// By R_nbh, then K1. Those without a run are left out.
    pub points: Vec<Point>,
    #[serde(skip)]
    pub(super) plan: Plan,
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let points = plan.points().into_iter().zip(runs);
        Self {
            seed: plan.seed,
            robots: plan.robots,
            k2: plan.k2,
            k3: plan.k3,
            min_distance_m: plan.min_distance_m,
            radius_m: plan.radius_m(),
            arrival_m: plan.arrival_m(),
            start_side: plan.start_side,
            obstacles: plan.obstacles,
            step_s: plan.step_s,
            seconds: plan.seconds,
            safety: safety(plan),
            moves_goal: plan.moves_goal,
            points: points.filter_map(|(point, runs)| Point::of(plan, point, runs)).collect(),
            plan: plan.clone(),
        }
    }
}

/// The safety layer in words.
fn safety(plan: &Plan) -> String {
    let name = word(plan.safety);
    match plan.safety {
        SafetyKind::PushOut => format!("{name} ({}, {})", plan.model, plan.evasion),
        _ => name,
    }
}

impl Point {
    fn of(plan: &Plan, (k1, neighborhood_m): (f64, f64), runs: &[Run]) -> Option<Self> {
        let first = runs.first()?;
        let robots = f64::from(plan.robots) * runs.len() as f64;
        let way = |value: fn(&super::watch::Way) -> f64| {
            let values = runs.iter().filter_map(|run| run.way.as_ref());
            mean(&values.map(value).collect::<Vec<_>>())
        };
        let at = |goal: usize| runs.iter().map(|run| run.at_goals[goal]).sum::<usize>() as f64;
        let at_goals = [at(0), at(1), at(2)];
        let arrived: f64 = at_goals.iter().sum();
        let halves: Vec<f64> = runs.iter().filter_map(|run| run.half_gathered_s).collect();
        let least_m = runs.iter().map(|run| run.least_pair_m).fold(f64::INFINITY, f64::min);
        Some(Self {
            k1,
            k1_over_k2: (plan.k2 != 0.0).then(|| k1 / plan.k2),
            neighborhood_m,
            runs: runs.len(),
            polarisation: way(|way| way.polarisation),
            together: way(|way| way.together),
            spread: way(|way| way.spread),
            gathered: runs.iter().map(|run| run.gathered).sum::<usize>() as f64 / robots,
            half_gathered_s: mean(&halves),
            arrived: arrived / robots,
            goal_shares: at_goals.map(|at| if arrived > 0.0 { at / arrived } else { 0.0 }),
            least_pair_over_min_distance: least_m.is_finite().then(|| least_m / plan.min_distance_m),
            overlaps: runs.iter().map(|run| run.overlaps).sum(),
            trace_hash: format!("{:016x}", runs.iter().fold(0, |all, run| all ^ run.hash)),
            frames: first.frames.clone(),
        })
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} robots, 3 goals, R_MinDist {} m, radius {} m, K2 {}, K3 {}, start side {}, {} obstacles, {} s in steps of {} s, safety {}, seed {}",
            self.robots,
            self.min_distance_m,
            self.radius_m,
            self.k2,
            self.k3,
            self.start_side,
            self.obstacles,
            self.seconds,
            self.step_s,
            self.safety,
            self.seed
        )?;
        writeln!(
            f,
            "{:>6}{:>7}{:>8}{:>6}{:>7}{:>10}{:>8}{:>10}{:>8}{:>9}{:>20}{:>7}{:>9}",
            "R_nbh",
            "K1",
            "K1/K2",
            "runs",
            "order",
            "together",
            "spread",
            "gathered",
            "half s",
            "arrived",
            "goals %",
            "pair",
            "overlaps"
        )?;
        for point in &self.points {
            let goals = point.goal_shares.map(|share| format!("{:.0}", 100.0 * share));
            writeln!(
                f,
                "{:>6}{:>7}{:>8}{:>6}{:>7}{:>10}{:>8}{:>10.3}{:>8}{:>9.3}{:>20}{:>7}{:>9}",
                point.neighborhood_m,
                point.k1,
                Maybe(point.k1_over_k2, 2),
                point.runs,
                Maybe(point.polarisation, 3),
                Maybe(point.together, 3),
                Maybe(point.spread, 2),
                point.gathered,
                Maybe(point.half_gathered_s, 0),
                point.arrived,
                goals.join(" "),
                Maybe(point.least_pair_over_min_distance, 3),
                point.overlaps
            )?;
        }
        f.write_str("on the way to the middle of the goals: order: polarisation; together: share of the largest group; spread: radius of the crowd over that at the start;\n")?;
        f.write_str("gathered: share that came to the middle, half s: when half had; arrived: share at a goal at the end; goals: their shares of these;\n")?;
        f.write_str("pair: least distance of centres over R_MinDist; overlaps: pairs of bodies, over all ticks\n")?;
        Ok(())
    }
}
