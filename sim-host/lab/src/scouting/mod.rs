//! Value of a map on changing land. KUZ section 3 defines u(t, .) and land that is "not fully
//! scouted", but gives no results for either.
//!
//! Each run creates one natural landscape (KUZ section 5) on which the crossing time of some cells
//! changes by one tick in each tick. One robot moves from (1, 1) to the opposite corner with the
//! controller's [`Router`](staya_controller::route::Router). It plans on its sight alone or on a
//! wider window of a map, which is partly blank or wrong and is updated with everything seen
//! ([`LandMemory`](staya_controller::route::LandMemory)). Its travel time is compared with the
//! lower bound for perfect knowledge of all future changes.

mod foresight;
mod report;
mod walk;

pub use report::{Point, Report};

use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::route::{MAX_RADIUS, SIZES};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::Args;
use foresight::Foresight;
use staya_console::options::{self, word};
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;
use staya_controller::route::{Replan, RouteParams};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::change::{ChangeKind, LandChange};
use staya_sim::terrain::generate::{self, Hills, natural_by};
use staya_sim::terrain::scouted::{Scouted, usual_class};
use std::num::NonZeroU32;
use std::path::PathBuf;
use walk::{Knowledge, Scout};

const LANDSCAPES: u32 = 0x0045_0011;
const CLASSES: u8 = 9;

/// Value of a map, partly blank or wrong, on changing land.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Plan {
    /// Obstacles of the natural landscapes.
    #[arg(long, default_value_t = 70)]
    pub obstacles: u32,
    /// Landscapes per point.
    #[arg(long, default_value_t = 200)]
    pub runs: u32,
    /// Cells along each side of a landscape.
    #[arg(long, default_value_t = 100)]
    pub size: u16,
    /// Range of sight, cells in each direction.
    #[arg(long, value_name = "CELLS", default_value_t = RouteParams::default().radius, value_parser = clap::value_parser!(u8).range(1..=i64::from(MAX_RADIUS)))]
    pub sight: u8,
    /// Planning radius on a map, cells in each direction; at least the range of sight.
    #[arg(long, value_name = "CELLS", default_value_t = 16, value_parser = clap::value_parser!(u8).range(1..=i64::from(MAX_RADIUS)))]
    pub map_radius: u8,
    /// Shares of the cells whose crossing time changes by a tick in each tick, 0 to 1.
    #[arg(long = "drift", value_name = "SHARE,...", value_delimiter = ',', default_value = "0,0.001,0.01")]
    pub drifts: Vec<f64>,
    /// Blank shares of the map, 0 to 1, one row each.
    #[arg(long = "unknown", value_name = "SHARE,...", value_delimiter = ',', default_value = "0,0.3,0.6,1")]
    pub unknown: Vec<f64>,
    /// Shares of the map that show other places, 0 to 1, one row each.
    #[arg(long = "wrong", value_name = "SHARE,...", value_delimiter = ',', default_value = "0.3,0.6")]
    pub wrong: Vec<f64>,
    /// Cells along each side of blank or wrong areas.
    #[arg(long, value_name = "CELLS", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub patch_cells: u16,
    /// Condition for a repeated search.
    #[arg(long, default_value = "each-cell", value_parser = options::replan())]
    pub replan: Replan,
    /// Seed; equal seeds give equal results. The route's parameters were tuned on seed 1.
    #[arg(long, default_value_t = 2)]
    pub seed: u64,
    /// Folder for rows.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-scouting")]
    pub out: PathBuf,
}

impl Default for Plan {
    fn default() -> Self {
        options::defaults()
    }
}

/// Knowledge of the robot about the land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Only the cells in sight.
    Sight,
    /// A partly blank or wrong map, updated by everything seen.
    Map {
        /// Blank share.
        unknown: f64,
        /// Wrong share.
        wrong: f64,
    },
    /// Sight as wide as the planning window on a map.
    Far,
}

impl Known {
    /// Name in rows.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sight => "sight",
            Self::Map { .. } => "map",
            Self::Far => "far sight",
        }
    }

    /// Blank and wrong shares.
    #[must_use]
    pub const fn shares(self) -> Option<[f64; 2]> {
        match self {
            Self::Map { unknown, wrong } => Some([unknown, wrong]),
            Self::Sight | Self::Far => None,
        }
    }
}

/// Result of one landscape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Smallest travel time, [`UNIT`](staya_controller::grid::UNIT)ths of a tick.
    pub least_cost: u64,
    /// Whether the robot reached its target.
    pub arrived: bool,
    /// Travel time of the robot, in the same unit.
    pub cost: u64,
    /// Number of moves.
    pub moves: u32,
    /// Cells that the robot finally remembered differently from its map.
    pub remembered: u32,
}

impl Record for Run {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("least_cost", "least travel time with the land of all times known, 70ths of a tick", &mut self.least_cost);
        each("arrived", "1: the robot reached its target", &mut self.arrived);
        each("cost", "travel time of the robot, 70ths of a tick", &mut self.cost);
        each("moves", "its moves", &mut self.moves);
        each("remembered", "cells that it remembers at the end otherwise than its map has them", &mut self.remembered);
    }
}

#[derive(Default)]
struct Scratch {
    scout: Scout,
    foresight: Foresight,
}

impl Plan {
    /// Kinds of knowledge, one per row.
    #[must_use]
    pub fn known(&self) -> Vec<Known> {
        let blank = self.unknown.iter().map(|&unknown| Known::Map { unknown, wrong: 0.0 });
        let wrong = self.wrong.iter().map(|&wrong| Known::Map { unknown: 0.0, wrong });
        [Known::Sight].into_iter().chain(blank).chain(wrong).chain([Known::Far]).collect()
    }

    fn point(&self, point: usize) -> (Known, f64) {
        (self.known()[point / self.drifts.len()], self.drifts[point % self.drifts.len()])
    }

    fn landscape_seed(&self, run: u32) -> u64 {
        Rng::keyed(self.seed, LANDSCAPES, self.obstacles, run).next_u64()
    }

    fn run_one(&self, Scratch { scout, foresight }: &mut Scratch, point: usize, run: u32) -> Result<Run> {
        let (known, drift) = self.point(point);
        let seed = self.landscape_seed(run);
        let plan = generate::LandPlan { width: self.size, height: self.size, classes: CLASSES, seed };
        let land = natural_by(&plan, self.obstacles, Default::default(), Hills::Even)?;
        let changes = drifting(&land, drift);
        let far = (self.size - 2).cast_signed();
        let ends = [Cell::new(1, 1), Cell::new(far, far)];
        let map = known.shares().map(|[unknown, wrong]| {
            let (patch_cells, assumed) = (self.patch_cells, usual_class(&land));
            Scouted { unknown, wrong, patch_cells, assumed, seed }.map(&land)
        });
        let radius = if known == Known::Sight { self.sight } else { self.map_radius };
        let params = RouteParams { radius, ..RouteParams::default() };
        let sight = if known == Known::Far { self.map_radius } else { self.sight };
        let knowledge = Knowledge { map: map.as_ref(), sight };
        let walk = scout.walk((&land, &changes, seed), ends, &knowledge, &params, self.replan);
        // The smallest travel time is at most that of the robot.
        let least = foresight.least_cost((&land, &changes, seed), ends, params.norm, walk.cost);
        Ok(Run { least_cost: least.unwrap_or(walk.cost), ..walk })
    }
}

fn drifting(land: &Terrain, share: f64) -> Vec<LandChange> {
    let draws = libm::round(share * land.cells().len() as f64) as u32;
    let kind = ChangeKind::Drift { cells: None, draws, step: 1, classes: CLASSES };
    let rule = LandChange { first: 1, every: NonZeroU32::new(1), kind };
    Some(rule).filter(|_| draws > 0).into_iter().collect()
}

impl Experiment for Plan {
    const NAME: &'static str = "scouting";
    const UNIT: &'static str = "ways";
    type Run = Run;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "landscapes per point")?;
        let (size, least, most) = (self.size, SIZES.start(), SIZES.end());
        ensure!(SIZES.contains(&size), "a landscape of {size} x {size} cells; its side must be {least}..={most}");
        ensure!(!self.drifts.is_empty(), "no drift; give one share or more, 0 for land that stays");
        for share in self.drifts.iter().chain(&self.unknown).chain(&self.wrong) {
            ensure!((0.0..=1.0).contains(share), "{share} is not a share; give 0 to 1");
        }
        let (sight, wide) = (self.sight, self.map_radius);
        ensure!(
            sight <= wide,
            "a map of radius {wide} where robots see {sight} cells far; give --map-radius {sight} or more"
        );
        let plan = generate::LandPlan { width: size, height: size, classes: CLASSES, seed: self.seed };
        natural_by(&plan, self.obstacles, Default::default(), Hills::Even)?;
        Ok(())
    }

    fn points(&self) -> usize {
        self.known().len() * self.drifts.len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            obstacles,
            runs: _,
            size,
            sight,
            map_radius,
            drifts: _,
            unknown: _,
            wrong: _,
            patch_cells,
            replan,
            seed,
            out: _,
        } = self;
        let (known, drift) = self.point(point);
        let share = |at: usize| known.shares().map_or(Value::from("-"), |shares| shares[at].into());
        vec![
            ("known", known.name().into()),
            ("unknown", share(0)),
            ("wrong", share(1)),
            ("drift_per_tick", drift.into()),
            ("obstacles", (*obstacles).into()),
            ("side_cells", u32::from(*size).into()),
            ("sight_cells", u32::from(*sight).into()),
            ("map_radius_cells", u32::from(*map_radius).into()),
            ("patch_cells", u32::from(*patch_cells).into()),
            ("replan", word(*replan).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// Seed of the landscape (for `staya terrain`), of its changes and of the map's errors.
    fn seed(&self, _: usize, run: u32) -> u64 {
        self.landscape_seed(run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run::default()
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        jobs.each(|scratch, point, run| Ok(Some(self.run_one(scratch, point, run)?)))
    }

    fn report(&self, runs: &[Vec<Run>]) -> Report {
        Report::of(self, runs)
    }
}

#[cfg(test)]
mod tests;
