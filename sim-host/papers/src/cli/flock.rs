//! `staya experiment flock`.

use super::params::SafetyArg;
use super::results::{Work, number};
use crate::flock::closing::{Closing, ClosingReport, Meeting};
use crate::flock::{Case, Plan, Report, Results};
use anyhow::Result;
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Stop};
use staya_sim::record::prepare_dir;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A simulation of the paper, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "lower")]
enum CaseArg {
    /// A: 150 robots in free space, algorithm 2 (figure 7).
    Free,
    /// B: 40 robots without a reference, algorithm 1: the group breaks up (figure 8).
    Fragment,
    /// C: 50 robots meet in space, algorithm 2 (figure 9).
    Rendezvous3d,
    /// D: 150 robots through six obstacles, algorithm 3 (figure 10).
    Split,
    /// E: 150 robots through a gap, algorithm 3 (figure 11).
    Squeeze,
}

/// Where the reference of D and E is, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReferenceArg {
    /// It goes ahead of the flock.
    Moving,
    /// It stands behind the obstacles, and has a velocity all the same (the paper's).
    Static,
}

/// The five flocking simulations of Olfati-Saber 2006 (section VIII), each robot an agent that hears packets only.
///
/// The paper gives no gains: c1 of alpha- and gamma-agents (c2 = 2 sqrt c1) and the reference's speed are what worked best.
/// A: 50 and 1. C: 10 and 0.2. D, E: 10, 200 (beta) and 2, with a reference that moves at 3/7 d per second. B has no
/// gains. Any spacing gives the same figures, lengths and speeds in proportion.
#[derive(Args, Clone, Debug)]
pub struct FlockArgs {
    /// Which simulations [default: all].
    #[arg(long, value_enum, value_delimiter = ',')]
    case: Vec<CaseArg>,
    /// Instead, drive flocks at each other, bare and with ORCA: overlaps and least distances by speed.
    #[arg(long, conflicts_with_all = ["case", "robots", "safety", "horizon", "seconds", "c_alpha", "c_beta", "c_gamma", "reference", "loss"])]
    closing: bool,
    /// Closing speeds, spacings per second.
    #[arg(
        long,
        value_name = "SPEED,...",
        value_delimiter = ',',
        default_value = "1,2,4,8",
        requires = "closing"
    )]
    speeds: Vec<f64>,
    /// Runs of each, with different starts.
    #[arg(long, default_value_t = 10)]
    seeds: u32,
    /// Number of robots, instead of the paper's.
    #[arg(long)]
    robots: Option<u32>,
    /// Safety layer behind the flock; in space "orca" means "fly".
    #[arg(long, value_enum, default_value = "none")]
    safety: SafetyArg,
    /// How far ahead ORCA looks.
    #[arg(long, value_name = "SECONDS", default_value_t = Plan::default().horizon_s)]
    horizon: f64,
    /// Distance of neighbours in the lattice (d); bodies have a fourteenth of it as radius.
    #[arg(long, value_name = "METRES", default_value_t = 7.0)]
    spacing: f64,
    /// Length of a tick.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.03)]
    step: f64,
    /// Length of each run, instead of the case's own.
    #[arg(long)]
    seconds: Option<f64>,
    /// Gain c1 on other robots, instead of the case's own.
    #[arg(long, value_name = "C1")]
    c_alpha: Option<f64>,
    /// Gain c1 on obstacles, instead of the case's own.
    #[arg(long, value_name = "C1")]
    c_beta: Option<f64>,
    /// Gain c1 on the reference, instead of the case's own.
    #[arg(long, value_name = "C1")]
    c_gamma: Option<f64>,
    /// Where the reference of D and E is.
    #[arg(long, value_enum, default_value = "moving")]
    reference: ReferenceArg,
    /// Loss of packets, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    loss: f64,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the pictures and series.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-flock")]
    out: PathBuf,
}

impl FlockArgs {
    fn plan(&self) -> Plan {
        let case = |case: &CaseArg| match case {
            CaseArg::Free => Case::Free,
            CaseArg::Fragment => Case::Fragment,
            CaseArg::Rendezvous3d => Case::Rendezvous3d,
            CaseArg::Split => Case::Split,
            CaseArg::Squeeze => Case::Squeeze,
        };
        Plan {
            cases: if self.case.is_empty() {
                Case::ALL.to_vec()
            } else {
                self.case.iter().map(case).collect()
            },
            runs: self.seeds,
            robots: self.robots,
            safety: self.safety.into(),
            horizon_s: self.horizon,
            spacing_m: self.spacing,
            step_s: self.step,
            seconds: self.seconds,
            gains: [self.c_alpha, self.c_beta, self.c_gamma],
            is_static: matches!(self.reference, ReferenceArg::Static),
            loss: self.loss,
            seed: self.seed,
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a picture that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        if self.closing {
            return self.run_closing(global);
        }
        let plan = self.plan();
        plan.check()?;
        let stop = Stop::on_ctrl_c()?;
        prepare_dir(&self.out)?;
        let work = Work::new("runs", plan.total(), &self.out);
        let (results, mut course) =
            work.carry_out(global, &stop, |told| plan.carry_out(told), Results::done)?;
        let report = results.report();
        course.pictures = report.draw(&self.out)?;
        course.tell(&report, table, global)?;
        Ok(Ended::by(&stop))
    }

    fn run_closing(&self, global: &Global) -> Result<Ended> {
        let plan = Closing {
            speeds: self.speeds.clone(),
            runs: self.seeds,
            spacing_m: self.spacing,
            step_s: self.step,
            seed: self.seed,
        };
        plan.check()?;
        let stop = Stop::on_ctrl_c()?;
        let work = Work::new("runs", plan.total(), &self.out);
        let ((report, _), course) = work.carry_out(
            global,
            &stop,
            |told| plan.carry_out(told),
            |(_, done)| *done,
        )?;
        course.tell(&report, closing_table, global)?;
        Ok(Ended::by(&stop))
    }
}

/// A whole number, or `-`.
fn count(value: Option<usize>) -> String {
    value.map_or_else(|| String::from("-"), |value| value.to_string())
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "d = {} m, radius {:.3} m, step {} s, safety {}, loss {}, seed {}{}",
        report.spacing_m,
        report.radius_m,
        report.step_s,
        report.safety,
        report.loss,
        report.seed,
        if report.static_reference {
            ", static reference"
        } else {
            ""
        }
    )?;
    writeln!(
        text,
        "{:<13}{:>7}{:>6}{:>7}{:>7}{:>6}{:>7}{:>8}{:>9}{:>9}{:>5}{:>7}{:>9}{:>8}{:>7}{:>11}",
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
        "one",
        "pair/d",
        "overlaps",
        "clear/d",
        "inside",
        "past"
    )?;
    for case in &report.cases {
        let past = case.past.map_or_else(
            || String::from("-"),
            |past| format!("{past}/{}", case.robots * case.runs),
        );
        writeln!(
            text,
            "{:<13}{:>7}{:>6}{:>7}{:>7}{:>6}{:>7.3}{:>8.1}{:>9.5}{:>9.5}{:>5}{:>7}{:>9}{:>8}{:>7}{:>11}",
            case.case.name(),
            case.robots,
            case.runs,
            case.alpha_flocking,
            number(case.alpha_from_median, 0),
            count(case.connected_from_latest),
            case.connectivity,
            case.radius_m,
            case.deviation_energy,
            case.velocity_mismatch,
            case.one_flock,
            number(case.least_pair_over_d, 3),
            case.overlaps,
            number(case.least_clearance_over_d, 3),
            case.inside,
            past,
        )?;
    }
    text.push_str("alpha: runs with alpha-flocking at their end (e0 = 0.2, e1 = 0.005, e2 = 0.001), from: iteration, median over them;\n");
    text.push_str("conn.: iteration from which on all are connected in every run; C: mean at the end, R, E~, K~: largest at the end; one: runs that end as one flock;\n");
    text.push_str("pair/d: least distance of centres after 2 s; overlaps: pairs of bodies, over all ticks; clear/d: least distance from an obstacle; inside: robots ever in one\n");
    Ok(text)
}

fn closing_table(report: &ClosingReport) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "d = {} m, radius {:.3} m, step {} s, seed {}; each side goes at half the speed of closing",
        report.spacing_m, report.radius_m, report.step_s, report.seed
    )?;
    writeln!(
        text,
        "{:<8}{:<8}{:>5}{:>6} |{:>12}{:>10}{:>8} |{:>12}{:>10}{:>8}",
        "flock",
        "who",
        "d/s",
        "runs",
        "bare: runs",
        "overlaps",
        "pair/d",
        "ORCA: runs",
        "overlaps",
        "pair/d"
    )?;
    for line in &report.lines {
        let meeting = |m: &Meeting| {
            format!(
                "{:>12}{:>10}{:>8.3}",
                m.runs_with_overlap, m.overlaps, m.least_pair_over_d
            )
        };
        writeln!(
            text,
            "{:<8}{:<8}{:>5}{:>6} |{} |{}",
            format!("{:?}", line.flock).to_lowercase(),
            format!("{:?}", line.sides).to_lowercase(),
            line.speed_over_d,
            line.runs,
            meeting(&line.bare),
            meeting(&line.orca)
        )?;
    }
    text.push_str("runs: with overlap; overlaps: pairs of bodies, over all ticks and runs; pair/d: least distance of centres (bodies touch at 0.143)\n");
    Ok(text)
}
