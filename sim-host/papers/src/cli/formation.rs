//! `staya experiment formation`.

use super::params::NormArg;
use super::results::{Work, number};
use crate::formation::{Journey, Plan, Report, Results, Variants};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Stop};
use staya_controller::formation::{FormationParams, Prediction, Recovery};
use staya_controller::grid::UNIT;
use staya_controller::route::RouteParams;
use staya_sim::record::prepare_dir;
use std::fmt::Write as _;
use std::path::PathBuf;

/// How others are foreseen, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum PredictionArg {
    /// They go on as they announced.
    Constant,
    /// They do what the robot itself would do in their place.
    Reflexive,
}

/// What the top leader does while somebody is too far behind, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum RecoveryArg {
    /// It stands.
    Wait,
    /// It heads for where the others are off to (def).
    Def,
}

/// Six robots in formation on natural land: error, arrivals, travel time (Kuznetsov, section 8, figure 6).
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct FormationArgs {
    /// Numbers of obstacles, one point of the figure each.
    #[arg(
        long,
        value_name = "N,N,...",
        value_delimiter = ',',
        default_value = "0,10,20,40,70,100,130"
    )]
    obstacles: Vec<u32>,
    /// Landscapes per point.
    #[arg(long, default_value_t = 100)]
    runs: u32,
    /// How far from its place a neighbour may be and still count as found, cells.
    #[arg(long, default_value_t = FormationParams::default().eps)]
    eps: u8,
    /// Loss of packets, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    loss: f64,
    /// Other values of eps to try on the same landscapes.
    #[arg(
        long,
        value_name = "CELLS,...",
        value_delimiter = ',',
        default_value = "1,2,3,5"
    )]
    other_eps: Vec<u8>,
    /// Other losses to try on the same landscapes.
    #[arg(
        long,
        value_name = "LOSS,...",
        value_delimiter = ',',
        default_value = "0.1,0.3,0.6"
    )]
    other_losses: Vec<f64>,
    /// Do not try other values.
    #[arg(long, conflicts_with_all = ["other_eps", "other_losses"])]
    only: bool,
    /// How many cells ahead of the top leader's the others aim.
    #[arg(long, value_name = "CELLS", default_value_t = FormationParams::default().lead)]
    lead: u8,
    /// Share of the land under the others' places in what a cell costs the top leader, sixteenths.
    #[arg(long, value_name = "SIXTEENTHS", default_value_t = FormationParams::default().footprint, value_parser = clap::value_parser!(u8).range(0..=16))]
    footprint: u8,
    /// Lag at which the top leader waits (r0), cells.
    #[arg(long, value_name = "CELLS")]
    halt: Option<f64>,
    /// Cells from one robot to the next.
    #[arg(long, default_value_t = 3)]
    spacing: u8,
    /// Geodesic radius of what each robot knows of the formation's graph.
    #[arg(long, default_value_t = 3)]
    rho: u8,
    /// Radius of the robots' windows in cells.
    #[arg(long, default_value_t = RouteParams::default().radius)]
    radius: u8,
    /// How robots foresee each other.
    #[arg(long, value_enum, default_value = "constant")]
    prediction: PredictionArg,
    /// What the top leader does while somebody is too far behind.
    #[arg(long, value_enum, default_value = "wait")]
    recovery: RecoveryArg,
    /// Cells along each side of the landscape.
    #[arg(long, default_value_t = 100)]
    size: u16,
    /// Classes of impassability.
    #[arg(long, default_value_t = 9)]
    classes: u8,
    /// How the distance to an obstacle is measured.
    #[arg(long, value_enum, default_value = "euclidean")]
    hill_norm: NormArg,
    /// Give up a run after this many ticks.
    #[arg(long, default_value_t = 10_000)]
    ticks: u32,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-formation")]
    out: PathBuf,
}

impl FormationArgs {
    fn plan(&self) -> Result<Plan> {
        let mut formation = FormationParams {
            eps: self.eps,
            lead: self.lead,
            footprint: self.footprint,
            prediction: match self.prediction {
                PredictionArg::Constant => Prediction::Constant,
                PredictionArg::Reflexive => Prediction::Reflexive,
            },
            recovery: match self.recovery {
                RecoveryArg::Wait => Recovery::Wait,
                RecoveryArg::Def => Recovery::Def,
            },
            ..FormationParams::default()
        };
        if let Some(cells) = self.halt {
            let units = cells * f64::from(UNIT);
            if !(0.0..=f64::from(u16::MAX)).contains(&units) {
                bail!(
                    "--halt {cells}; give 0 to {} cells",
                    u32::from(u16::MAX) / UNIT
                );
            }
            formation.halt_lag = libm::round(units) as u16;
            formation.resume_lag = formation.halt_lag;
        }
        let is_other = |wanted: bool| wanted && !self.only;
        Ok(Plan {
            obstacles: self.obstacles.clone(),
            runs: self.runs,
            size: self.size,
            classes: self.classes,
            hill_norm: self.hill_norm.into(),
            spacing: self.spacing,
            rho: self.rho,
            route: RouteParams {
                radius: self.radius,
                ..RouteParams::default()
            },
            formation,
            loss: self.loss,
            other_eps: self
                .other_eps
                .iter()
                .copied()
                .filter(|&eps| is_other(eps != self.eps))
                .collect(),
            other_losses: self
                .other_losses
                .iter()
                .copied()
                .filter(|&loss| is_other(loss != self.loss))
                .collect(),
            ticks: self.ticks,
            seed: self.seed,
            ..Plan::default()
        })
    }

    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a picture that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let plan = self.plan()?;
        plan.check()?;
        let stop = Stop::on_ctrl_c()?;
        prepare_dir(&self.out)?;
        let work = Work::new("landscapes", plan.total(), &self.out);
        let (results, mut course) =
            work.carry_out(global, &stop, |told| plan.carry_out(told), Results::done)?;
        let report = results.report();
        course.pictures = report.draw(&self.out)?;
        let tables = |report: &Report| {
            let variants = variants(report, Variants::Eps)? + &variants(report, Variants::Loss)?;
            Ok(table(report)? + &variants)
        };
        course.tell(&report, tables, global)?;
        Ok(Ended::by(&stop))
    }
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "six robots {} cells apart, {size} x {size} cells, {} classes, window radius {}, rho {}, r0 {:.2} cells, seed {}",
        report.spacing,
        report.classes,
        report.radius,
        report.rho,
        report.halt_cells,
        report.seed,
        size = report.size,
    )?;
    writeln!(
        text,
        "{:>4}{:>6}{:>9}{:>8}{:>7}{:>8}{:>9}{:>10}{:>9}{:>8}{:>8}{:>7}{:>7}",
        "N",
        "runs",
        "arrived",
        "dPhi/6",
        "+-",
        "paper",
        "of paper",
        "best fit",
        "dist",
        "worst",
        "alone",
        "time",
        "ratio"
    )?;
    for point in &report.points {
        let journey = &point.formation;
        writeln!(
            text,
            "{:>4}{:>6}{:>9}{:>8.3}{:>7}{:>8.3}{:>9}{:>10.3}{:>9.3}{:>8.2}{:>8}{:>7}{:>7}",
            point.obstacles,
            point.runs,
            journey.arrived,
            journey.error_per_agent.mean,
            number(journey.error_per_agent.mean_error95, 3),
            point.paper_error_per_agent,
            number(point.error_over_paper, 2),
            journey.best_fit_error_per_agent,
            journey.graph_distance,
            journey.worst_error,
            number(point.alone_time_ticks, 0),
            number(journey.time_ticks, 0),
            number(journey.time_ratio, 2),
        )?;
    }
    text.push_str("dPhi/6: error per robot, cells; best fit: the same, graph placed by the best-fitting translation; dist: graph distance;\n");
    text.push_str("worst: largest error per robot of any tick; alone, time: ticks until the last robot arrived without and in formation\n\n");
    if let Some(fit) = report.fit {
        writeln!(
            text,
            "fit:   dPhi/6 = {:.6} ln(N + 1) {:+.6}, R2 = {:.4}",
            fit.a, fit.b, fit.r2
        )?;
    }
    let paper = report.paper;
    writeln!(
        text,
        "paper: dPhi/6 = {:.6} ln(N + 1) {:+.6}, R2 = {:.4}",
        paper.a, paper.b, paper.r2
    )?;
    Ok(text)
}

/// A line per value, a column per point.
fn variants(report: &Report, kind: Variants) -> Result<String, std::fmt::Error> {
    let Some(first) = report.points.first() else {
        return Ok(String::new());
    };
    let values = first.variants(kind);
    if values.len() < 2 {
        return Ok(String::new());
    }
    let (name, value): (_, fn(&Journey) -> String) = match kind {
        Variants::Eps => ("eps", |journey| journey.eps.to_string()),
        Variants::Loss => ("loss %", |journey| format!("{:.0}", 100.0 * journey.loss)),
    };
    let mut text = format!(
        "\ndPhi/6, travel time ratio and (worst error) for each {name}; [n] = only n landscapes were crossed by all\n"
    );
    write!(text, "{name:>8}")?;
    for point in &report.points {
        write!(text, "{:>20}", format!("N = {}", point.obstacles))?;
    }
    text.push('\n');
    for (index, journey) in values.iter().enumerate() {
        write!(text, "{:>8}", value(journey))?;
        for point in &report.points {
            let entry = point.variants(kind)[index];
            let crossed = if entry.arrived < point.runs {
                format!("[{}] ", entry.arrived)
            } else {
                String::new()
            };
            let entry = format!(
                "{crossed}{:.2} {} ({:.1})",
                entry.error_per_agent.mean,
                number(entry.time_ratio, 2),
                entry.worst_error
            );
            write!(text, "{entry:>20}")?;
        }
        text.push('\n');
    }
    Ok(text)
}
