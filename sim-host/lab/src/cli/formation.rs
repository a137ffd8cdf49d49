//! `staya experiment formation`.

use crate::formation::{Law, Plan, Published};
use anyhow::{Result, bail};
use clap::Args;
use staya_console::options;
use staya_controller::formation::{FormationParams, Prediction, Recovery};
use staya_controller::grid::{Norm, UNIT};
use staya_controller::route::RouteParams;
use staya_controller::shuffle::Sharpness;
use staya_sim::terrain::generate::Hills;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct FormationArgs {
    /// Numbers of obstacles, one point of the figure each.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "0,10,20,40,70,100,130")]
    obstacles: Vec<u32>,
    /// Landscapes per point.
    #[arg(long, default_value_t = 100)]
    runs: u32,
    /// Distance from its place up to which a neighbour counts as found, cells.
    #[arg(long, default_value_t = FormationParams::default().eps)]
    eps: u8,
    /// Loss of packets, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    loss: f64,
    /// Further values of eps on the same landscapes.
    #[arg(long, value_name = "CELLS,...", value_delimiter = ',', default_value = "1,2,3,5")]
    other_eps: Vec<u8>,
    /// Further losses on the same landscapes.
    #[arg(long, value_name = "LOSS,...", value_delimiter = ',', default_value = "0.1,0.3,0.6")]
    other_losses: Vec<f64>,
    /// Further laws on the same landscapes, at each loss.
    #[arg(
        long,
        value_name = "LAW,...",
        value_delimiter = ',',
        default_value = "lookahead,loose,shared,unwaiting,paper",
        value_enum
    )]
    other_laws: Vec<Law>,
    /// Sum of deviations from found neighbours at which the paper's law waits, cells.
    #[arg(long, value_name = "CELLS")]
    paper_halt: Option<f64>,
    /// Sum at which the paper's law moves again (about r0), cells.
    #[arg(long, value_name = "CELLS")]
    paper_resume: Option<f64>,
    /// How robots predict each other under the paper's law.
    #[arg(long, default_value = "reflexive", value_parser = options::prediction())]
    paper_prediction: Prediction,
    /// Geodesic radius of templates under the paper's law; 1 gives the leaders of figure 5.
    #[arg(long, default_value_t = Published::default().rho)]
    paper_rho: u8,
    /// Omit other values and laws.
    #[arg(long, conflicts_with_all = ["other_eps", "other_losses", "other_laws"])]
    only: bool,
    /// Distance that followers aim ahead of the top leader's cell, cells.
    #[arg(long, value_name = "CELLS", default_value_t = FormationParams::default().lead)]
    lead: u8,
    /// Weight of the land under other robots' places in the top leader's cell costs, sixteenths.
    #[arg(long, value_name = "SIXTEENTHS", default_value_t = FormationParams::default().footprint, value_parser = clap::value_parser!(u8).range(0..=16))]
    footprint: u8,
    /// Lag at which the top leader waits (r0), cells.
    #[arg(long, value_name = "CELLS")]
    halt: Option<f64>,
    /// Cells from one robot to the next.
    #[arg(long, default_value_t = 3)]
    spacing: u8,
    /// Geodesic radius of a robot's template in the formation's graph.
    #[arg(long, default_value_t = 3)]
    rho: u8,
    /// Radius of the robots' windows, cells.
    #[arg(long, default_value_t = RouteParams::default().radius)]
    radius: u8,
    /// How robots predict each other.
    #[arg(long, default_value = "constant", value_parser = options::prediction())]
    prediction: Prediction,
    /// Reaction of the top leader to robots that are too far behind.
    #[arg(long, default_value = "wait", value_parser = options::recovery())]
    recovery: Recovery,
    /// Cells along each side of the landscape.
    #[arg(long, default_value_t = 100)]
    size: u16,
    /// Classes of impassability.
    #[arg(long, default_value_t = 9)]
    classes: u8,
    /// Interpretation of natural land, which the paper defines in one sentence (docs/limits.md).
    #[arg(long, default_value = "even", value_parser = options::hills())]
    hills: Hills,
    /// Draw the order of moves: this additional cost halves a move's chance; 0 never draws.
    #[arg(long, value_name = "TICKS", default_value = "0", value_parser = options::shuffle)]
    shuffle: Sharpness,
    /// Norm of the distance to an obstacle.
    #[arg(long, default_value = "euclidean", value_parser = options::norm())]
    hill_norm: Norm,
    /// Time limit of a run, ticks.
    #[arg(long, default_value_t = 10_000)]
    ticks: u32,
    /// Seed; equal seeds give equal results. Parameters were tuned on seed 1.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-formation")]
    pub out: PathBuf,
}

impl FormationArgs {
    pub fn plan(&self) -> Result<Plan> {
        let mut formation = FormationParams {
            eps: self.eps,
            lead: self.lead,
            footprint: self.footprint,
            prediction: self.prediction,
            recovery: self.recovery,
            ..FormationParams::default()
        };
        if let Some(units) = units("--halt", self.halt)? {
            (formation.halt_lag, formation.resume_lag) = (units, units);
        }
        let mut published = Published { rho: self.paper_rho, ..Published::default() };
        let params = &mut published.params;
        params.eps = self.eps;
        params.prediction = self.paper_prediction;
        params.halt = units("--paper-halt", self.paper_halt)?.unwrap_or(params.halt);
        params.resume = units("--paper-resume", self.paper_resume)?.unwrap_or(params.resume).min(params.halt);
        let is_other = |wanted: bool| wanted && !self.only;
        Ok(Plan {
            obstacles: self.obstacles.clone(),
            runs: self.runs,
            size: self.size,
            classes: self.classes,
            hills: self.hills,
            sharpness: self.shuffle,
            hill_norm: self.hill_norm,
            spacing: self.spacing,
            rho: self.rho,
            route: RouteParams { radius: self.radius, ..RouteParams::default() },
            formation,
            loss: self.loss,
            other_eps: self.other_eps.iter().copied().filter(|&eps| is_other(eps != self.eps)).collect(),
            other_losses: self.other_losses.iter().copied().filter(|&loss| is_other(loss != self.loss)).collect(),
            other_laws: if self.only { Vec::new() } else { self.other_laws.clone() },
            published,
            ticks: self.ticks,
            seed: self.seed,
        })
    }
}

fn units(option: &str, cells: Option<f64>) -> Result<Option<u16>> {
    let Some(cells) = cells else { return Ok(None) };
    let units = cells * f64::from(UNIT);
    if !(0.0..=f64::from(u16::MAX)).contains(&units) {
        bail!("{option} {cells}; give 0 to {} cells", u32::from(u16::MAX) / UNIT);
    }
    Ok(Some(libm::round(units) as u16))
}
