//! Flocks driven at each other, without a safety layer and with ORCA.
//!
//! A flock's repulsion is bounded, so robots pass through each other above some closing speed.
//! Here, two robots (slightly off their common line) or two groups of three by three meet head on;
//! the goal of each side is the start of the other. The closing speed is in spacings d per second,
//! half of it for each side.

use super::check_spacing_and_step;
use crate::arena::{Arena, FASTEST_MPS, uniform};
use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_console::options::word;
use staya_controller::agent::{BoidsSetup, GuidanceSetup, SafetyKind};
use staya_controller::goal_flock::GoalParams;
use staya_controller::lattice::{LatticeParams, ReferenceMotion};
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::PushOutParams;
use staya_controller::rand::Rng;
use staya_sim::engine::simulate;
use staya_sim::metrics::flock::gaps;
use staya_sim::nearby::Space;
use staya_sim::scenario::{Scenario, Start, Target};
use std::fmt::{self, Display, Formatter};
use std::ops::ControlFlow;

const OFFSETS: u32 = 0x0046_0201;
const GAP: f64 = 4.0;

/// The flocking law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Flock {
    /// Alpha flock (OLF), algorithm 3.
    Alpha,
    /// Goal flock (PAV), R_MinDist = d / 2.
    Goal,
    /// Boids (STA), crowded below d.
    Boids,
}

/// Size of the two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// One robot against one.
    Pair,
    /// Nine robots against nine.
    Groups,
}

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Closing {
    /// Closing speeds, spacings per second, more than 0.
    pub speeds: Vec<f64>,
    /// Runs of each combination, at least 1.
    pub runs: u32,
    /// Distance of neighbours (d), metres, 0.1 to 50.
    pub spacing_m: f64,
    /// Length of a tick, seconds, 0.001 to 0.1.
    pub step_s: f64,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Closing {
    fn default() -> Self {
        Self { speeds: vec![1.0, 2.0, 4.0, 8.0], runs: 10, spacing_m: 7.0, step_s: 0.03, seed: 1 }
    }
}

/// Results over all runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Meeting {
    /// Runs in which bodies overlapped.
    pub runs_with_overlap: usize,
    /// Overlapping pairs, summed over ticks and runs.
    pub overlaps: usize,
    /// Smallest distance of two centres, in d; bodies touch at 1 / 7.
    pub least_pair_over_d: f64,
}

/// One row of the table.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// The flocking law.
    pub flock: Flock,
    /// Size of the two sides.
    pub sides: Sides,
    /// Closing speed, spacings per second.
    pub speed_over_d: f64,
    /// Number of runs.
    pub runs: usize,
    /// Without a safety layer.
    pub bare: Meeting,
    /// With ORCA.
    pub orca: Meeting,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct ClosingReport {
    /// Seed of the experiment.
    pub seed: u64,
    /// Distance of neighbours (d), metres.
    pub spacing_m: f64,
    /// Radius of a body, metres.
    pub radius_m: f64,
    /// Length of a tick, seconds.
    pub step_s: f64,
    /// Rows by flock, sides and speed, without those that have no runs.
    pub lines: Vec<Line>,
}

/// Result of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Met {
    /// Overlapping pairs, summed over ticks.
    pub overlaps: usize,
    /// Smallest distance of two centres, metres; very large if all were beyond d.
    pub least_m: f64,
    /// Trace hash.
    pub hash: u64,
}

impl Record for Met {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("overlaps", "overlapping pairs, summed over ticks", &mut self.overlaps);
        each("least_pair_m", "least distance of two centres; very large: none came within d", &mut self.least_m);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

const WAYS: [SafetyKind; 2] = [SafetyKind::None, SafetyKind::Orca];

impl Closing {
    /// Radius of a body, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.spacing_m / 14.0
    }

    fn lines(&self) -> Vec<(Flock, Sides, f64)> {
        let mut lines = Vec::new();
        for flock in [Flock::Alpha, Flock::Goal, Flock::Boids] {
            for sides in [Sides::Pair, Sides::Groups] {
                lines.extend(self.speeds.iter().map(|&speed| (flock, sides, speed)));
            }
        }
        lines
    }

    fn scenario(&self, flock: Flock, sides: Sides, speed: f64, safety: SafetyKind, run: u32) -> Scenario {
        let d = self.spacing_m;
        let side_mps = speed * d / 2.0;
        let seed = self.run_seed(run);
        let guidance = match flock {
            Flock::Alpha => {
                let motion = ReferenceMotion::Dynamic;
                GuidanceSetup::Lattice { params: LatticeParams::new(d as f32), motion }
            }
            Flock::Goal => GuidanceSetup::GoalFlock {
                params: GoalParams::new((d / 2.0) as f32, side_mps as f32),
                arrival_m: d as f32,
                seed,
            },
            Flock::Boids => GuidanceSetup::Boids {
                params: BoidsSetup { crowded_m: d as f32, closest_m: (4.0 * d) as f32, ..BoidsSetup::PAPER },
                speed_mps: side_mps as f32,
            },
        };
        let arena = Arena {
            name: "closing",
            seed,
            step_s: self.step_s,
            seconds: 4.0 * GAP / speed,
            radius_m: self.radius_m(),
            max_speed_mps: side_mps,
            range_m: 30.0 * d,
            loss: 0.0,
            sight_m: d,
            guidance,
            safety,
            // Beacons are one step old, in which a robot moves by its radius.
            orca: AvoidParams { margin_m: (d / 100.0) as f32, ..AvoidParams::default() },
            push_out: PushOutParams::new(1.0),
            solids: Vec::new(),
        };
        let setup = arena.setup(self.starts(flock, sides, side_mps, run));
        arena.scenario(setup)
    }

    fn starts(&self, flock: Flock, sides: Sides, side_mps: f64, run: u32) -> Vec<Start> {
        let d = self.spacing_m;
        let rows = match sides {
            Sides::Pair => 1,
            Sides::Groups => 3_u32,
        };
        let mut rng = Rng::keyed(self.seed, OFFSETS, run, 0);
        let off_m = uniform(&mut rng, -1.0, 1.0) * self.radius_m();
        let mut starts = Vec::new();
        for (way, off_m) in [(1.0, 0.0), (-1.0, off_m)] {
            let target = match flock {
                Flock::Alpha => {
                    Target { position_m: [-way * GAP * d / 2.0, off_m, 0.0], velocity_mps: [way * side_mps, 0.0, 0.0] }
                }
                Flock::Goal | Flock::Boids => {
                    Target { position_m: [way * 100.0 * d, off_m, 0.0], velocity_mps: [0.0; 3] }
                }
            };
            for place in 0..rows * rows {
                let [back, up] = [place / rows, place % rows].map(|n| f64::from(n) * d);
                let jitter = [0, 1].map(|_| uniform(&mut rng, -0.1, 0.1) * self.radius_m());
                starts.push(Start {
                    position_m: [
                        -way * (GAP * d / 2.0 + back) + jitter[0],
                        up - f64::from(rows - 1) * d / 2.0 + off_m + jitter[1],
                        0.0,
                    ],
                    velocity_mps: [way * side_mps, 0.0, 0.0],
                    places: vec![target],
                    group: None,
                });
            }
        }
        starts
    }

    fn point(&self, point: usize) -> ((Flock, Sides, f64), SafetyKind) {
        (self.lines()[point / WAYS.len()], WAYS[point % WAYS.len()])
    }

    fn run_seed(&self, run: u32) -> u64 {
        Rng::keyed(self.seed, OFFSETS, run, 1).next_u64()
    }

    fn meet(&self, scenario: &Scenario) -> Result<Met> {
        let radii = vec![self.radius_m(); scenario.robots.len()];
        let horizon_m = self.spacing_m;
        let (mut overlaps, mut least_m) = (0, f64::MAX);
        let outcome = simulate(scenario, |_, robots| {
            let places_m: Vec<[f64; 3]> = robots.map(|robot| robot.motion.position_m).collect();
            let gaps = gaps(&places_m, &radii, &[], horizon_m, Space::OPEN);
            overlaps += gaps.overlapping_pairs;
            if let Some(gap_m) = gaps.between_robots_m {
                least_m = f64::min(least_m, gap_m + 2.0 * self.radius_m());
            }
            ControlFlow::Continue(())
        })?;
        Ok(Met { overlaps, least_m, hash: outcome.trace_hash })
    }
}

impl Experiment for Closing {
    const NAME: &'static str = "closing";
    const UNIT: &'static str = "runs";
    type Run = Met;
    type Report = ClosingReport;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "of each case")?;
        check_spacing_and_step(self.spacing_m, self.step_s)?;
        ensure!(!self.speeds.is_empty(), "no cases; give one or more");
        let fastest = 2.0 * FASTEST_MPS / self.spacing_m;
        for &speed in &self.speeds {
            ensure!(
                speed > 0.0 && speed <= fastest,
                "a closing speed of {speed} d/s; it must be more than 0 and at most {fastest:.2}"
            );
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.lines().len() * WAYS.len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self { speeds: _, runs: _, spacing_m, step_s, seed } = self;
        let ((flock, sides, speed), safety) = self.point(point);
        vec![
            ("flock", format!("{flock:?}").to_lowercase().into()),
            ("sides", format!("{sides:?}").to_lowercase().into()),
            ("speed_over_d", speed.into()),
            ("safety", word(safety).into()),
            ("spacing_m", (*spacing_m).into()),
            ("step_s", (*step_s).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    fn seed(&self, _: usize, run: u32) -> u64 {
        self.run_seed(run)
    }

    fn blank(&self, _: usize, _: u32) -> Met {
        Met::default()
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Met>>> {
        jobs.each(|(): &mut (), point, run| {
            let ((flock, sides, speed), safety) = self.point(point);
            Ok(Some(self.meet(&self.scenario(flock, sides, speed, safety, run))?))
        })
    }

    fn report(&self, runs: &[Vec<Met>]) -> ClosingReport {
        let line = |((flock, sides, speed_over_d), ways): (_, &[Vec<Met>])| {
            let [bare, orca] = ways else { return None };
            let runs = bare.len().min(orca.len());
            let meeting = |met: &[Met]| Meeting {
                runs_with_overlap: met.iter().filter(|met| met.overlaps > 0).count(),
                overlaps: met.iter().map(|met| met.overlaps).sum(),
                least_pair_over_d: met.iter().map(|met| met.least_m).fold(f64::MAX, f64::min) / self.spacing_m,
            };
            let [bare, orca] = [bare, orca].map(|met| meeting(&met[..runs]));
            (runs > 0).then_some(Line { flock, sides, speed_over_d, runs, bare, orca })
        };
        ClosingReport {
            seed: self.seed,
            spacing_m: self.spacing_m,
            radius_m: self.radius_m(),
            step_s: self.step_s,
            lines: self.lines().into_iter().zip(runs.chunks(WAYS.len())).filter_map(line).collect(),
        }
    }
}

impl Display for ClosingReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "d = {} m, radius {:.3} m, step {} s, seed {}; each side goes at half the speed of closing",
            self.spacing_m, self.radius_m, self.step_s, self.seed
        )?;
        writeln!(
            f,
            "{:<8}{:<8}{:>5}{:>6} |{:>12}{:>10}{:>8} |{:>12}{:>10}{:>8}",
            "flock", "sides", "d/s", "runs", "bare: runs", "overlaps", "pair/d", "ORCA: runs", "overlaps", "pair/d"
        )?;
        for line in &self.lines {
            let meeting =
                |m: &Meeting| format!("{:>12}{:>10}{:>8.3}", m.runs_with_overlap, m.overlaps, m.least_pair_over_d);
            writeln!(
                f,
                "{:<8}{:<8}{:>5}{:>6} |{} |{}",
                format!("{:?}", line.flock).to_lowercase(),
                format!("{:?}", line.sides).to_lowercase(),
                line.speed_over_d,
                line.runs,
                meeting(&line.bare),
                meeting(&line.orca)
            )?;
        }
        f.write_str("runs: with overlap; overlaps: pairs of bodies, over all ticks and runs; pair/d: least distance of centres (bodies touch at 0.143)\n")?;
        Ok(())
    }
}
