//! Measurements during a run.

use super::{Case, Plan};
use crate::experiment::rows::{Each, Record};
use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};
use staya_controller::agent::GuidanceSetup;
use staya_sim::metrics::flock::{EnergyMeter, FlockMeasure, FlockMeter, gaps};
use staya_sim::nearby::Space;
use staya_sim::record::{RobotRow, write_atomically};
use staya_sim::scenario::Scenario;
use staya_sim::world::plane::Solid;
use std::fs::create_dir_all;
use std::path::Path;

/// From then on distances of pairs count: random starts may nearly coincide.
const SETTLED_S: f64 = 2.0;

/// Measurements of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The flock before the first tick and after each.
    pub trace: Vec<Option<FlockMeasure>>,
    /// Structural Hamiltonian at the same moments, per robot, in the paper's units.
    pub energies: Vec<f64>,
    /// Smallest distance of two centres after 2 s, metres; infinite if all were beyond d.
    pub least_pair_m: f64,
    /// Pairs of overlapping bodies, summed over ticks.
    pub overlaps: usize,
    /// Smallest clearance from obstacles, metres, negative inside; infinite without obstacles.
    pub least_clearance_m: f64,
    /// Robots whose centre was ever inside an obstacle.
    pub inside: usize,
    /// Robots past all obstacles at the end.
    pub past: usize,
    /// Moments to draw.
    pub frames: Vec<Frame>,
    /// Results for the row, computed from the trace.
    pub verdict: Verdict,
    /// Trace hash.
    pub hash: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    pub alpha_from: Option<usize>,
    pub connected_from: Option<usize>,
    pub most_parts: usize,
    pub parts: usize,
    pub connectivity: f64,
    /// Metres.
    pub radius_m: f64,
    pub deviation_energy: f64,
    /// (m/s)^2.
    pub velocity_mismatch: f64,
    /// Per robot at start and end, in the paper's units.
    pub hamiltonian: [f64; 2],
    pub hamiltonian_rise: f64,
}

impl Record for Run {
    fn figures(&mut self, each: &mut Each<'_>) {
        let v = &mut self.verdict;
        each("alpha_from", "iteration from which on alpha-flocking holds; empty: it does not", &mut v.alpha_from);
        each("connected_from", "iteration from which on all are connected", &mut v.connected_from);
        each("most_parts", "largest number of connected parts at any time", &mut v.most_parts);
        each("parts", "connected parts at the end", &mut v.parts);
        each("connectivity", "relative connectivity C at the end", &mut v.connectivity);
        each("radius_m", "cohesion radius R at the end", &mut v.radius_m);
        each("deviation_energy", "E~ at the end", &mut v.deviation_energy);
        each("velocity_mismatch", "K~ at the end, (m/s)^2", &mut v.velocity_mismatch);
        let [first, last] = &mut v.hamiltonian;
        each("hamiltonian.first", "structural Hamiltonian H per robot at the start, in the paper's units", first);
        each("hamiltonian.last", "the same at the end", last);
        each("hamiltonian_rise", "largest rise of H in a tick over what it loses in all", &mut v.hamiltonian_rise);
        each(
            "least_pair_m",
            "least distance of two centres after 2 s; inf: none came within d",
            &mut self.least_pair_m,
        );
        each("overlaps", "overlapping pairs, summed over ticks", &mut self.overlaps);
        each("least_clearance_m", "least distance of a centre from an obstacle", &mut self.least_clearance_m);
        each("inside", "robots whose centre was ever in an obstacle", &mut self.inside);
        each("past", "robots past all obstacles at the end", &mut self.past);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

impl Run {
    /// Writes the run to a file and creates its folder.
    pub fn keep(&self, file: &Path) -> Result<()> {
        let bytes = postcard::to_stdvec(self).context("a run as bytes")?;
        let folder = file.parent().unwrap_or(Path::new(""));
        create_dir_all(folder).with_context(|| folder.display().to_string())?;
        Ok(write_atomically(file, &bytes)?)
    }

    /// `None` if the file is missing or has another trace hash.
    pub fn kept(file: &Path, hash: u64) -> Option<Self> {
        let run: Self = postcard::from_bytes(&std::fs::read(file).ok()?).ok()?;
        (run.hash == hash && !run.trace.is_empty()).then_some(run)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    pub tick: u32,
    pub places_m: Vec<[f64; 3]>,
    pub velocities_mps: Vec<[f64; 3]>,
}

fn behind_m(solids: &[Solid]) -> Option<f64> {
    let end = |solid: &Solid| match *solid {
        Solid::Ball { center_m, radius_m } => Some(center_m[0] + radius_m),
        Solid::Wall(_) | Solid::Plane { .. } => None,
    };
    solids.iter().filter_map(end).reduce(f64::max)
}

pub struct Watch {
    spacing_m: f64,
    radius_m: f64,
    settled: u32,
    behind_m: Option<f64>,
    solids: Vec<Solid>,
    meter: FlockMeter<3>,
    energy: Option<EnergyMeter<3>>,
    wanted: Vec<u32>,
    places_m: Vec<[f64; 3]>,
    velocities_mps: Vec<[f64; 3]>,
    was_inside: Vec<bool>,
    run: Run,
}

impl Watch {
    pub fn new(plan: &Plan, case: Case, scenario: &Scenario, draws: bool) -> Self {
        let spacing_m = plan.spacing_m;
        let moments = case.setting().moments;
        let solids = scenario.plane.as_ref().map_or_else(Vec::new, |plane| plane.solids.clone());
        let energy = scenario.plane.as_ref().and_then(|plane| match &plane.general.guidance {
            GuidanceSetup::Lattice { params, .. } => EnergyMeter::new(&params.cast()),
            _ => None,
        });
        let at = |share: f64| libm::round(share * f64::from(scenario.ticks)) as u32;
        Self {
            spacing_m,
            radius_m: plan.radius_m(),
            settled: crate::arena::ticks(SETTLED_S, plan.step_s),
            behind_m: behind_m(&solids),
            solids,
            energy,
            meter: FlockMeter::new(spacing_m, 1.2 * spacing_m, Space::OPEN),
            wanted: if draws { moments.map(at).to_vec() } else { Vec::new() },
            places_m: Vec::new(),
            velocities_mps: Vec::new(),
            was_inside: vec![false; scenario.robots.len()],
            run: Run { least_pair_m: f64::INFINITY, least_clearance_m: f64::INFINITY, ..Run::default() },
        }
    }

    pub fn look(&mut self, tick: u32, robots: &mut dyn Iterator<Item = RobotRow>) {
        self.places_m.clear();
        self.velocities_mps.clear();
        for robot in robots {
            self.places_m.push(robot.motion.position_m);
            self.velocities_mps.push(robot.motion.velocity_mps);
        }
        self.measure(tick);
    }

    pub fn see(&mut self, tick: u32, places_m: &[[f64; 3]], velocities_mps: &[[f64; 3]]) {
        self.places_m.clear();
        self.velocities_mps.clear();
        self.places_m.extend_from_slice(places_m);
        self.velocities_mps.extend_from_slice(velocities_mps);
        self.measure(tick);
    }

    fn measure(&mut self, tick: u32) {
        let measure = self.meter.look(&self.places_m, &self.velocities_mps);
        self.run.trace.push(measure);
        let energy = self.energy.as_mut().and_then(|meter| meter.look(&self.places_m, &self.velocities_mps));
        self.run.energies.push(energy.map_or(f64::NAN, |energy| energy.hamiltonian() / self.places_m.len() as f64));
        self.look_at_pairs(tick);
        for (place, was_inside) in self.places_m.iter().zip(&mut self.was_inside) {
            for solid in &self.solids {
                let distance_m = solid.distance_m(*place);
                self.run.least_clearance_m = self.run.least_clearance_m.min(distance_m);
                *was_inside |= distance_m < 0.0;
            }
        }
        if self.wanted.contains(&tick) {
            self.run.frames.push(Frame {
                tick,
                places_m: self.places_m.clone(),
                velocities_mps: self.velocities_mps.clone(),
            });
        }
    }

    fn look_at_pairs(&mut self, tick: u32) {
        let radii = vec![self.radius_m; self.places_m.len()];
        let horizon_m = self.spacing_m - 2.0 * self.radius_m;
        let gaps = gaps(&self.places_m, &radii, &[], horizon_m, Space::OPEN);
        self.run.overlaps += gaps.overlapping_pairs;
        if let Some(gap_m) = gaps.between_robots_m.filter(|_| tick >= self.settled) {
            let apart_m = gap_m + 2.0 * self.radius_m;
            self.run.least_pair_m = self.run.least_pair_m.min(apart_m);
        }
    }

    pub fn finish(mut self, hash: u64) -> Run {
        let is_past = |place: &&[f64; 3]| self.behind_m.is_some_and(|x| place[0] > x);
        self.run.past = self.places_m.iter().filter(is_past).count();
        self.run.inside = self.was_inside.iter().filter(|inside| **inside).count();
        self.run.hash = hash;
        self.run
    }
}
