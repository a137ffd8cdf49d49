//! Results of the flock experiment.

use super::watch::{Frame, Run, Verdict};
use super::{Case, Plan, Point, Reference};
use crate::experiment::Maybe;
use serde::Serialize;
use staya_console::options::word;
use staya_sim::metrics::flock::{AlphaLimits, AlphaVerdict, FlockMeasure, alpha_flocking};
use staya_stats::quantile;
use std::fmt::{self, Display, Formatter};

/// Result of one run.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// Number of the run, from 0.
    pub run: usize,
    /// First iteration from which the conditions of alpha-flocking hold until the end.
    pub alpha: AlphaVerdict,
    /// The flock at the end.
    pub end: Option<FlockMeasure>,
    /// Largest number of components at any time.
    pub most_parts: usize,
    /// Smallest distance of two centres after two seconds, in d; `null` if all were beyond d.
    pub least_pair_over_d: Option<f64>,
    /// Pairs of overlapping bodies, summed over ticks.
    pub overlaps: usize,
    /// Smallest clearance from obstacles, in d, negative inside; `null` without obstacles.
    pub least_clearance_over_d: Option<f64>,
    /// Robots whose centre was ever inside an obstacle.
    pub inside: usize,
    /// Robots past all obstacles at the end; `null` without obstacles.
    pub past: Option<usize>,
    /// Trace hash.
    pub trace_hash: String,
}

/// Summary of one case over its runs.
#[derive(Clone, Debug, Serialize)]
pub struct CaseReport {
    /// The case.
    pub case: Case,
    /// The reference, if the case has obstacles.
    pub reference: Option<Reference>,
    /// Robots of each run.
    pub robots: usize,
    /// Ticks of each run.
    pub ticks: usize,
    /// c1 of alpha-, beta- and gamma-agents.
    pub gains: [f64; 3],
    /// Number of runs.
    pub runs: usize,
    /// Runs with alpha-flocking at their end.
    pub alpha_flocking: usize,
    /// Median iteration from which alpha-flocking holds, over those runs.
    pub alpha_from_median: Option<f64>,
    /// Latest iteration from which alpha-flocking holds, over those runs.
    pub alpha_from_latest: Option<usize>,
    /// Latest iteration from which all robots are connected; `null` if some run ends disconnected.
    pub connected_from_latest: Option<usize>,
    /// Mean C at the end.
    pub connectivity: f64,
    /// Largest R at the end, metres.
    pub radius_m: f64,
    /// Largest E~ at the end.
    pub deviation_energy: f64,
    /// Largest K~ at the end, (m/s)^2.
    pub velocity_mismatch: f64,
    /// Runs that end with one flock.
    pub one_flock: usize,
    /// Smallest `least_pair_over_d` of all runs.
    pub least_pair_over_d: Option<f64>,
    /// Overlaps of all runs.
    pub overlaps: usize,
    /// Smallest `least_clearance_over_d` of all runs.
    pub least_clearance_over_d: Option<f64>,
    /// Robots inside an obstacle, of all runs.
    pub inside: usize,
    /// Robots past all obstacles, of all runs.
    pub past: Option<usize>,
    /// Mean H per robot at the end, in the paper's units.
    pub hamiltonian: f64,
    /// Largest rise of H in a tick divided by its total loss, over all runs.
    pub hamiltonian_rise: f64,
    /// Results of each run.
    pub each: Vec<RunReport>,
    #[serde(skip)]
    pub(super) energies: Vec<Vec<f64>>,
    #[serde(skip)]
    pub(super) traces: Vec<Vec<Option<FlockMeasure>>>,
    #[serde(skip)]
    pub(super) frames: Vec<Frame>,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the experiment.
    pub seed: u64,
    /// Requested runs of each case.
    pub runs: u32,
    /// Distance of neighbours in the lattice (d), metres.
    pub spacing_m: f64,
    /// Radius of a body, metres.
    pub radius_m: f64,
    /// Length of a tick, seconds.
    pub step_s: f64,
    /// Safety layer behind the flock.
    pub safety: String,
    /// ORCA's horizon, seconds.
    pub horizon_s: f64,
    /// Loss of packets.
    pub loss: f64,
    /// Whether robots do not push towards robots nearer to the reference.
    pub takes_turns: bool,
    /// Width of the gap of case "gap", spacings.
    pub gap: f64,
    /// Whether the robots are particles with perfect knowledge.
    pub ideal: bool,
    /// Number of nearest particles that each particle knows, if not all.
    pub nearest: Option<usize>,
    /// Speed limit of the particles, in the paper's units.
    pub fastest: Option<f64>,
    /// Summaries by case, without cases that have no runs.
    pub cases: Vec<CaseReport>,
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let lines = plan.lines().into_iter().zip(runs);
        Self {
            seed: plan.seed,
            runs: plan.runs,
            spacing_m: plan.spacing_m,
            radius_m: plan.radius_m(),
            step_s: plan.step_s,
            safety: word(plan.safety),
            horizon_s: plan.horizon_s,
            loss: plan.loss,
            takes_turns: plan.takes_turns,
            gap: plan.gap,
            ideal: plan.ideal,
            nearest: plan.nearest,
            fastest: plan.fastest,
            cases: lines.filter_map(|(point, runs)| CaseReport::of(plan, point, runs)).collect(),
        }
    }
}

impl CaseReport {
    fn of(plan: &Plan, point: Point, runs: &[Run]) -> Option<Self> {
        let Point { case, reference } = point;
        let first = runs.first()?;
        let robots = first.trace.iter().flatten().next()?.robots;
        let each: Vec<RunReport> =
            (0..).zip(runs).map(|(number, run)| RunReport::of(plan, case, number, robots, run)).collect();
        let alphas: Vec<usize> = each.iter().filter_map(|r| r.alpha.alpha_flocking).collect();
        let from: Vec<f64> = alphas.iter().map(|&from| from as f64).collect();
        let ends: Vec<FlockMeasure> = each.iter().filter_map(|run| run.end).collect();
        let most = |value: fn(&FlockMeasure) -> f64| ends.iter().map(value).fold(0.0, f64::max);
        let least = |value: fn(&RunReport) -> Option<f64>| each.iter().filter_map(value).reduce(f64::min);
        Some(Self {
            case,
            reference,
            robots,
            ticks: first.trace.len() - 1,
            gains: plan.gains(case),
            runs: runs.len(),
            alpha_flocking: alphas.len(),
            alpha_from_median: quantile(&from, 0.5),
            alpha_from_latest: alphas.iter().copied().max(),
            connected_from_latest: runs
                .iter()
                .map(|run| connected_from(&run.trace))
                .collect::<Option<Vec<_>>>()
                .and_then(|all| all.into_iter().max()),
            connectivity: ends.iter().map(|m| m.connectivity).sum::<f64>() / ends.len() as f64,
            radius_m: most(|m| m.radius_m),
            deviation_energy: most(|m| m.deviation_energy),
            velocity_mismatch: most(|m| m.velocity_mismatch),
            one_flock: ends.iter().filter(|m| m.components == 1).count(),
            least_pair_over_d: least(|run| run.least_pair_over_d),
            overlaps: each.iter().map(|run| run.overlaps).sum(),
            least_clearance_over_d: least(|run| run.least_clearance_over_d),
            inside: each.iter().map(|run| run.inside).sum(),
            past: each.iter().map(|run| run.past).sum(),
            hamiltonian: runs.iter().map(|run| run.verdict.hamiltonian[1]).sum::<f64>() / runs.len() as f64,
            hamiltonian_rise: runs.iter().map(|run| run.verdict.hamiltonian_rise).fold(0.0, f64::max),
            traces: runs.iter().map(|run| run.trace.clone()).collect(),
            energies: runs.iter().map(|run| run.energies.clone()).collect(),
            frames: first.frames.clone(),
            each,
        })
    }
}

fn connected_from(trace: &[Option<FlockMeasure>]) -> Option<usize> {
    let is_apart = |moment: &Option<FlockMeasure>| moment.is_none_or(|m| m.components > 1);
    let from = trace.iter().rposition(is_apart).map_or(0, |last| last + 1);
    (from < trace.len()).then_some(from)
}

pub(super) fn verdict(plan: &Plan, case: Case, run: &Run) -> Verdict {
    let robots = run.trace.iter().flatten().next().map_or(0, |moment| moment.robots);
    let report = RunReport::of(plan, case, 0, robots, run);
    let end = report.end;
    let at_end = |value: fn(&FlockMeasure) -> f64| end.as_ref().map_or(0.0, value);
    Verdict {
        alpha_from: report.alpha.alpha_flocking,
        connected_from: connected_from(&run.trace),
        most_parts: report.most_parts,
        parts: end.map_or(0, |end| end.components),
        connectivity: at_end(|m| m.connectivity),
        radius_m: at_end(|m| m.radius_m),
        deviation_energy: at_end(|m| m.deviation_energy),
        velocity_mismatch: at_end(|m| m.velocity_mismatch),
        hamiltonian: [run.energies.first(), run.energies.last()].map(|energy| energy.copied().unwrap_or(0.0)),
        hamiltonian_rise: rise(&run.energies),
    }
}

fn rise(energies: &[f64]) -> f64 {
    let rise = energies.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let lost = energies.first().zip(energies.last()).map_or(0.0, |(first, last)| first - last);
    if rise > 0.0 && lost > 0.0 { rise / lost } else { rise }
}

impl RunReport {
    fn of(plan: &Plan, case: Case, number: usize, robots: usize, run: &Run) -> Self {
        let over_d = |metres: f64| metres.is_finite().then(|| metres / plan.spacing_m);
        let unit_m = plan.spacing_m / 7.0;
        let mut limits = AlphaLimits::paper(2.0 * lattice_radius_m(plan, case, robots));
        // In (m/s)^2, from the paper's units.
        limits.velocity_mismatch *= unit_m * unit_m;
        Self {
            run: number,
            alpha: alpha_flocking(&run.trace, &limits),
            end: run.trace.last().copied().flatten(),
            most_parts: run.trace.iter().flatten().map(|m| m.components).max().unwrap_or(0),
            least_pair_over_d: over_d(run.least_pair_m),
            overlaps: run.overlaps,
            least_clearance_over_d: over_d(run.least_clearance_m),
            inside: run.inside,
            past: case.has_balls().then_some(run.past),
            trace_hash: format!("{:016x}", run.hash),
        }
    }
}

/// Radius of a perfect lattice's disc or ball; a cohesive flock is within twice this radius.
fn lattice_radius_m(plan: &Plan, case: Case, robots: usize) -> f64 {
    let (n, d) = (robots as f64, plan.spacing_m);
    if case == Case::Rendezvous3d {
        d * libm::cbrt(3.0 * n / (4.0 * std::f64::consts::PI * std::f64::consts::SQRT_2))
    } else {
        d * libm::sqrt(n * libm::sqrt(3.0) / (2.0 * std::f64::consts::PI))
    }
}

impl Report {
    pub(super) fn setting(&self) -> String {
        let turns = if self.takes_turns { ", in turn" } else { "" };
        if !self.ideal {
            return format!("safety {}, loss {}{turns}", self.safety, self.loss);
        }
        let nearest = self.nearest.map(|n| format!(", each knows {n}"));
        let fastest = self.fastest.map(|speed| format!(", at most {speed} units/s"));
        format!("ideal particles{turns}{}{}", nearest.unwrap_or_default(), fastest.unwrap_or_default())
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "d = {} m, radius {:.3} m, step {} s, {}, seed {}",
            self.spacing_m,
            self.radius_m,
            self.step_s,
            self.setting(),
            self.seed
        )?;
        writeln!(
            f,
            "{:<16}{:>7}{:>6}{:>7}{:>7}{:>6}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}{:>5}{:>7}{:>9}{:>8}{:>7}{:>11}",
            "case",
            "robots",
            "runs",
            "alpha",
            "from",
            "conn.",
            "C",
            "R (m)",
            "E~",
            "K~",
            "H/n",
            "rise",
            "one",
            "pair/d",
            "overlaps",
            "clear/d",
            "inside",
            "past"
        )?;
        for case in &self.cases {
            let past =
                case.past.map_or_else(|| String::from("-"), |past| format!("{past}/{}", case.robots * case.runs));
            writeln!(
                f,
                "{:<16}{:>7}{:>6}{:>7}{:>7}{:>6}{:>7.3}{:>8.1}{:>9.5}{:>9.5}{:>9.0}{:>9.1e}{:>5}{:>7}{:>9}{:>8}{:>7}{:>11}",
                Point { case: case.case, reference: case.reference }.name(),
                case.robots,
                case.runs,
                case.alpha_flocking,
                Maybe(case.alpha_from_median, 0),
                count(case.connected_from_latest),
                case.connectivity,
                case.radius_m,
                case.deviation_energy,
                case.velocity_mismatch,
                case.hamiltonian,
                case.hamiltonian_rise,
                case.one_flock,
                Maybe(case.least_pair_over_d, 3),
                case.overlaps,
                Maybe(case.least_clearance_over_d, 3),
                case.inside,
                past,
            )?;
        }
        f.write_str("alpha: runs with alpha-flocking at their end (e0 = 0.2, e1 = 0.005, e2 = 0.001), from: iteration, median over them;\n")?;
        f.write_str("conn.: iteration from which on all are connected in every run; C: mean at the end, R, E~, K~: largest at the end; one: runs that end as one flock;\n")?;
        f.write_str("H/n: structural Hamiltonian a robot (d = 7) at the end, mean; rise: its largest rise in a tick over all that it lost;\n")?;
        f.write_str("pair/d: least distance of centres after 2 s; overlaps: pairs of bodies, over all ticks; clear/d: least distance from an obstacle; inside: robots ever in one\n")?;
        Ok(())
    }
}

fn count(value: Option<usize>) -> String {
    value.map_or_else(|| String::from("-"), |value| value.to_string())
}
