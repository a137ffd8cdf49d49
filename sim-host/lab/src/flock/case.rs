//! Scenarios of the paper's five simulations and of two others.

use super::{Plan, Point, Reference};
use crate::arena::{Arena, FASTEST_MPS, distance_m, normal, starts, uniform};
use anyhow::{Context as _, Result};
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::agent::{GuidanceSetup, SafetyKind};
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, ReferenceMotion};
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::PushOutParams;
use staya_controller::rand::Rng;
use staya_sim::scenario::{Scenario, Target};
use staya_sim::world::plane::Solid;

const STARTS: u32 = 0x0046_0101;
const TREES: u32 = 0x0046_0102;
/// The paper's d, in its units, which positions and speeds below have.
const UNITS: f64 = 7.0;

/// A simulation of the paper (OLF section VIII), or one of two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "lower")]
pub enum Case {
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
    /// Like E, through a gap for one robot (by default 8/7 d); not in the paper.
    Gap,
    /// Like E, through 30 balls at random places, at least 8/7 d apart; not in the paper.
    Forest,
}

impl Case {
    /// The paper's cases, in its order.
    pub const ALL: [Self; 5] = [Self::Free, Self::Fragment, Self::Rendezvous3d, Self::Split, Self::Squeeze];

    /// Name in options and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Fragment => "fragment",
            Self::Rendezvous3d => "rendezvous3d",
            Self::Split => "split",
            Self::Squeeze => "squeeze",
            Self::Gap => "gap",
            Self::Forest => "forest",
        }
    }

    pub(super) const fn title(self) -> &'static str {
        match self {
            Self::Free => "Flocking in free space by algorithm 2",
            Self::Fragment => "Fragmentation by algorithm 1",
            Self::Rendezvous3d => "Rendezvous in space by algorithm 2",
            Self::Split => "Split and rejoin by algorithm 3",
            Self::Squeeze => "Squeezing manoeuvre by algorithm 3",
            Self::Gap => "Through a gap for one by algorithm 3",
            Self::Forest => "Through a forest by algorithm 3",
        }
    }

    fn balls(self, gap: f64, seed: u64, run: u32) -> Vec<[f64; 3]> {
        match self {
            Self::Free | Self::Fragment | Self::Rendezvous3d => Vec::new(),
            Self::Split => vec![
                [100.0, 20.0, 10.0],
                [110.0, 60.0, 4.0],
                [120.0, 40.0, 2.0],
                [130.0, -20.0, 5.0],
                [150.0, 40.0, 5.0],
                [160.0, 0.0, 3.0],
            ],
            Self::Squeeze => vec![[150.0, 30.0, 25.0], [150.0, 100.0, 25.0]],
            Self::Gap => {
                let off = gap * UNITS / 2.0 + 30.0;
                vec![[150.0, 60.0 - off, 30.0], [150.0, 60.0 + off, 30.0]]
            }
            Self::Forest => forest(&mut Rng::keyed(seed, TREES, run, 0)),
        }
    }

    pub(super) const fn has_balls(self) -> bool {
        !matches!(self, Self::Free | Self::Fragment | Self::Rendezvous3d)
    }

    /// The paper's setting; unspecified values are the best of those tried.
    pub(super) fn setting(self) -> Setting {
        let flat = |x: f64, y: f64, vx: f64, vy: f64| ([x, y, 0.0], [vx, vy, 0.0]);
        match self {
            Self::Free => Setting {
                robots: 150,
                seconds: 30.0,
                algorithm: Algorithm::Two,
                gains: [50.0, 200.0, 1.0],
                moving: Some(flat(0.0, 0.0, -1.5, -1.5)),
                fixed: None,
                obstacle_ratio: 0.6,
                moments: [0.0, 0.03, 0.08, 0.15, 0.4, 1.0],
            },
            Self::Fragment => Setting {
                robots: 40,
                seconds: 60.0,
                algorithm: Algorithm::One,
                gains: [1.0, 200.0, 1.0],
                moving: None,
                fixed: None,
                obstacle_ratio: 0.6,
                moments: [0.0, 0.05, 0.1, 0.2, 0.5, 1.0],
            },
            Self::Rendezvous3d => Setting {
                robots: 50,
                seconds: 60.0,
                algorithm: Algorithm::Two,
                gains: [10.0, 200.0, 0.2],
                moving: Some(([0.0; 3], [1.0, 0.0, 1.0])),
                fixed: None,
                obstacle_ratio: 0.6,
                moments: [0.0, 0.1, 1.0, 0.0, 0.1, 1.0],
            },
            Self::Split => Setting {
                robots: 150,
                seconds: 180.0,
                algorithm: Algorithm::Three,
                gains: [10.0, 200.0, 2.0],
                moving: Some(flat(20.0, 20.0, 3.0, 0.0)),
                fixed: Some(flat(200.0, 30.0, 5.0, 0.0)),
                obstacle_ratio: 0.6,
                moments: [0.0, 0.0625, 0.16, 0.25, 0.35, 1.0],
            },
            Self::Squeeze => Setting {
                robots: 150,
                seconds: 420.0,
                algorithm: Algorithm::Three,
                gains: [10.0, 200.0, 2.0],
                moving: Some(flat(60.0, 60.0, 3.0, 0.0)),
                fixed: Some(flat(230.0, 60.0, 6.0, 0.0)),
                obstacle_ratio: 0.6,
                moments: [0.0, 0.06, 0.115, 0.17, 0.285, 1.0],
            },
            Self::Gap => Setting { obstacle_ratio: 3.0 / 7.0, ..Self::Squeeze.setting() },
            Self::Forest => Setting {
                fixed: Some(flat(290.0, 60.0, 6.0, 0.0)),
                obstacle_ratio: 3.0 / 7.0,
                ..Self::Squeeze.setting()
            },
        }
    }

    fn draw(self, rng: &mut Rng) -> ([f64; 3], [f64; 3]) {
        let at_rest = [0.0; 3];
        match self {
            Self::Free | Self::Fragment => {
                // The paper gives no width for B; this one gives about as many parts as figure 8.
                let wide = if self == Self::Free { 50.0 } else { 20.0 };
                let at = [normal(rng, wide), normal(rng, wide), 0.0];
                let mut speed = || uniform(rng, -2.0, -1.0);
                (at, [speed(), speed(), 0.0])
            }
            Self::Rendezvous3d => {
                let mut along = || normal(rng, 30.0);
                ([along(), along(), along()], at_rest)
            }
            Self::Split => {
                let mut along = || uniform(rng, -40.0, 80.0);
                ([along(), along(), 0.0], at_rest)
            }
            Self::Squeeze | Self::Gap | Self::Forest => {
                let mut along = || uniform(rng, 0.0, 120.0);
                ([along(), along(), 0.0], at_rest)
            }
        }
    }

    pub(super) fn solids(self, (spacing_m, gap): (f64, f64), seed: u64, run: u32) -> Vec<Solid> {
        let unit_m = spacing_m / UNITS;
        let ball = |[x, y, radius]: [f64; 3]| Solid::Ball {
            center_m: [x * unit_m, y * unit_m, 0.0],
            radius_m: radius * unit_m,
        };
        self.balls(gap, seed, run).into_iter().map(ball).collect()
    }
}

fn forest(rng: &mut Rng) -> Vec<[f64; 3]> {
    let mut trees: Vec<[f64; 3]> = Vec::new();
    while trees.len() < 30 {
        let [x, y, radius] = [uniform(rng, 135.0, 230.0), uniform(rng, -20.0, 140.0), uniform(rng, 2.0, 10.0)];
        let gap = |other: &[f64; 3]| distance_m([x, y, 0.0], [other[0], other[1], 0.0]) - radius - other[2];
        if trees.iter().all(|other| gap(other) >= 8.0) {
            trees.push([x, y, radius]);
        }
    }
    trees
}

/// Lengths are in the paper's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub robots: u32,
    pub seconds: f64,
    pub algorithm: Algorithm,
    /// c1 of alpha-, beta- and gamma-agents.
    pub gains: [f64; 3],
    /// Initial place and velocity.
    pub moving: Option<([f64; 3], [f64; 3])>,
    /// Place and velocity.
    pub fixed: Option<([f64; 3], [f64; 3])>,
    /// d' / d.
    pub obstacle_ratio: f64,
    /// Shares of the run time.
    pub moments: [f64; 6],
}

impl Plan {
    /// Radius of a body, metres: a fourteenth of the spacing, or half of the paper's unit.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.spacing_m / 14.0
    }

    pub(super) fn scenario(&self, point: Point, run: u32) -> Result<Scenario> {
        let Point { case, reference } = point;
        let setting = case.setting();
        let unit_m = self.spacing_m / UNITS;
        let metres = |vector: [f64; 3]| vector.map(|x| x * unit_m);
        let (reference, motion) = match (setting.fixed, reference) {
            (Some(fixed), Some(Reference::Static)) => (Some(fixed), ReferenceMotion::Static),
            (Some(fixed), Some(Reference::Resting)) => {
                (Some(fixed), ReferenceMotion::Resting((self.rest * self.spacing_m) as f32))
            }
            _ => (setting.moving, ReferenceMotion::Dynamic),
        };
        let targets: Vec<Target> = reference
            .iter()
            .map(|&(place, velocity)| Target { position_m: metres(place), velocity_mps: metres(velocity) })
            .collect();
        let robots = self.robots.unwrap_or(setting.robots);
        let radius_m = self.radius_m();
        let starts = starts(
            robots,
            2.0 * radius_m,
            &targets,
            |robot| Rng::keyed(self.seed, STARTS + case as u32, run, robot),
            |rng| {
                let (place, velocity) = case.draw(rng);
                (metres(place), metres(velocity))
            },
        )
        .with_context(|| format!("{robots} robots find no room; give fewer, or another spacing"))?;
        let [alpha, beta, gamma] = self.gains(case);
        let gain = |c1: f64| Gain::critical(c1 as f32);
        let damped = |c1: f64, c2: Option<f64>| match c2 {
            Some(c2) => Gain { position: c1 as f32, velocity: c2 as f32 },
            None => gain(c1),
        };
        let c2_alpha = self.c2_alpha.or((setting.algorithm == Algorithm::One).then_some(alpha));
        let params = LatticeParams {
            algorithm: match setting.algorithm {
                Algorithm::Three if self.takes_turns => Algorithm::ThreeInTurn,
                other => other,
            },
            alpha: damped(alpha, c2_alpha),
            beta: gain(beta),
            gamma: damped(gamma, self.c2_gamma),
            obstacle_ratio: self.obstacle_ratio(case) as f32,
            ..LatticeParams::new(self.spacing_m as f32)
        };
        let horizon_s = self.horizon_s as f32;
        let arena = Arena {
            name: case.name(),
            seed: self.run_seed(case, run),
            step_s: self.step_s,
            seconds: self.seconds.unwrap_or(setting.seconds),
            radius_m,
            max_speed_mps: match case {
                // The safety layer for space avoids all robots within reach at the highest speed.
                Case::Rendezvous3d => FASTEST_MPS.min(12.0 * unit_m),
                _ => FASTEST_MPS,
            },
            // ORCA looks beyond the 1.2 d of the law.
            range_m: 3.0 * self.spacing_m,
            loss: self.loss,
            sight_m: 3.0 * self.spacing_m,
            guidance: GuidanceSetup::Lattice { params, motion },
            safety: match (self.safety, case) {
                (SafetyKind::Orca, Case::Rendezvous3d) => SafetyKind::Fly,
                (safety, _) => safety,
            },
            orca: AvoidParams { horizon_s, wall_horizon_s: horizon_s, ..AvoidParams::default() },
            push_out: PushOutParams::new(1.0),
            solids: case.solids((self.spacing_m, self.gap), self.seed, run),
        };
        let setup = arena.setup(starts);
        Ok(arena.scenario(setup))
    }

    pub(super) fn run_seed(&self, case: Case, run: u32) -> u64 {
        Rng::keyed(self.seed, STARTS, run, case as u32).next_u64()
    }

    pub(super) fn obstacle_ratio(&self, case: Case) -> f64 {
        self.obstacle_ratio.unwrap_or(case.setting().obstacle_ratio)
    }

    pub(super) fn gains(&self, case: Case) -> [f64; 3] {
        let own = case.setting().gains;
        let [alpha, beta, gamma] = own;
        [self.c_alpha.unwrap_or(alpha), self.c_beta.unwrap_or(beta), self.c_gamma.unwrap_or(gamma)]
    }
}
