//! `staya experiment goals`.

use super::params::SafetyArg;
use super::results::{Work, number};
use crate::goals::{Plan, Report, Results};
use anyhow::Result;
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Stop};
use staya_controller::push_out::{Evasion, Model};
use staya_sim::record::prepare_dir;
use staya_sim::scenario::SafetyName;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Push-out's model, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModelArg {
    /// 1: along the radius.
    Radial,
    /// 2: turned aside.
    Tangential,
}

/// How many robots push-out evades at once, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum EvasionArg {
    /// The nearest in the way.
    Single,
    /// All.
    Multiple,
}

/// The goal flock of Pavlovsky and Pavlovsky: 225 robots and three goals, group order over K1 / K2 and R_nbh.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct GoalsArgs {
    /// Gains of the pull to the goal.
    #[arg(
        long,
        value_name = "K1,...",
        value_delimiter = ',',
        default_value = "0,5,15,30,50,100,150"
    )]
    k1: Vec<f64>,
    /// Gain of the pull to the middle of the neighbours.
    #[arg(long, default_value_t = Plan::default().k2)]
    k2: f64,
    /// Gain of the push away from robots that are too near.
    #[arg(long, default_value_t = Plan::default().k3)]
    k3: f64,
    /// How far neighbours are seen (R_nbh); the nearest sixteen count.
    #[arg(
        long,
        value_name = "METRES,...",
        value_delimiter = ',',
        default_value = "20,40"
    )]
    neighborhood: Vec<f64>,
    /// Least distance of robots (R_MinDist); bodies have 0.3 of it as radius.
    #[arg(long, value_name = "METRES", default_value_t = Plan::default().min_distance_m)]
    min_distance: f64,
    /// Number of robots.
    #[arg(long, default_value_t = Plan::default().robots)]
    robots: u32,
    /// Runs per point, with different starts.
    #[arg(long, default_value_t = Plan::default().runs)]
    seeds: u32,
    /// Safety layer behind the flock; with none, robots overlap where they crowd around the goals.
    #[arg(long, value_enum, default_value = "orca")]
    safety: SafetyArg,
    /// What push-out makes of a step.
    #[arg(long, value_enum, default_value = "radial")]
    model: ModelArg,
    /// How many robots push-out evades at once.
    #[arg(long, value_enum, default_value = "multiple")]
    evasion: EvasionArg,
    /// Length of each run.
    #[arg(long, default_value_t = Plan::default().seconds)]
    seconds: f64,
    /// Length of a tick.
    #[arg(long, value_name = "SECONDS", default_value_t = Plan::default().step_s)]
    step: f64,
    /// The operator moves the first goal after a quarter of the time.
    #[arg(long)]
    move_goal: bool,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-goals")]
    out: PathBuf,
}

impl GoalsArgs {
    fn plan(&self) -> Plan {
        Plan {
            k1: self.k1.clone(),
            k2: self.k2,
            k3: self.k3,
            neighborhoods_m: self.neighborhood.clone(),
            min_distance_m: self.min_distance,
            robots: self.robots,
            runs: self.seeds,
            safety: SafetyName::from(self.safety),
            push_out: (
                match self.model {
                    ModelArg::Radial => Model::Radial,
                    ModelArg::Tangential => Model::Tangential,
                },
                match self.evasion {
                    EvasionArg::Single => Evasion::Single,
                    EvasionArg::Multiple => Evasion::Multiple,
                },
            ),
            seconds: self.seconds,
            step_s: self.step,
            moves_goal: self.move_goal,
            seed: self.seed,
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a picture that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
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
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "{} robots, 3 goals, R_MinDist {} m, radius {} m, K2 {}, K3 {}, {} s in steps of {} s, safety {}, seed {}",
        report.robots,
        report.min_distance_m,
        report.radius_m,
        report.k2,
        report.k3,
        report.seconds,
        report.step_s,
        report.safety,
        report.seed
    )?;
    writeln!(
        text,
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
    for point in &report.points {
        let goals = point
            .goal_shares
            .map(|share| format!("{:.0}", 100.0 * share));
        writeln!(
            text,
            "{:>6}{:>7}{:>8}{:>6}{:>7}{:>10}{:>8}{:>10.3}{:>8}{:>9.3}{:>20}{:>7}{:>9}",
            point.neighborhood_m,
            point.k1,
            number(point.k1_over_k2, 2),
            point.runs,
            number(point.polarisation, 3),
            number(point.together, 3),
            number(point.spread, 2),
            point.gathered,
            number(point.half_gathered_s, 0),
            point.arrived,
            goals.join(" "),
            number(point.least_pair_over_min_distance, 3),
            point.overlaps
        )?;
    }
    text.push_str("on the way to the middle of the goals: order: polarisation; together: share of the largest group; spread: radius of the crowd over that at the start;\n");
    text.push_str("gathered: share that came to the middle, half s: when half had; arrived: share at a goal at the end; goals: their shares of these;\n");
    text.push_str("pair: least distance of centres over R_MinDist; overlaps: pairs of bodies, over all ticks\n");
    Ok(text)
}
