//! The velocity obstacle of two robots (Tolok et al., FVM): errors of half-planes from the voxel
//! template, and [`pictures`] of the paper's figures.

pub mod pictures;
pub(crate) mod view;

use crate::Errors;
use clap::Args;
use serde::Serialize;
use staya_controller::geom::Vec2;
use staya_controller::orca::{Analytic, HalfSpaces, MovingBall, Params, VelocityObstacleTable, VoxelTable2k};
use staya_controller::rand::Rng;
use std::f64::consts::TAU;
use std::fmt;

/// Random pairs of robots: radii 0.1 to 0.5 m, centres within 5 m without overlap, speeds up to 1.5
/// m/s, horizon 2 s, the whole correction. Positions and velocities are uniform in discs.
#[derive(Args, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Number of pairs of robots to compare.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub pairs: u32,
    /// Seed; equal seeds give equal pairs.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Errors of the template against the analytic form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Pairs compared.
    pub pairs: u32,
    /// Seed of the pairs.
    pub seed: u64,
    /// Bytes of the template in flash.
    pub bytes: usize,
    /// Nodes: sines of the half angle, and directions.
    pub nodes: [usize; 2],
    /// Angles between normals, degrees.
    pub angle_deg: Errors,
    /// Differences of the required changes of velocity, in (R_A + R_B) / tau.
    pub distance: Errors,
}

type V = Vec2<f64>;

const PAIRS: u32 = 0x0045_0201;

const PARAMS: Params<f64> = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };

impl Sample {
    fn draw(&self) -> Vec<(Vec2<f64>, MovingBall<V>)> {
        (0..self.pairs)
            .map(|pair| {
                let mut rng = Rng::keyed(self.seed, PAIRS, pair, 0);
                let mut unit = || f64::from(rng.next_u32()) / (f64::from(u32::MAX) + 1.0);
                let radii_m = 0.2 + 0.8 * unit();
                let mut within = |least: f64, most: f64| {
                    let squared = least * least + (most * most - least * least) * unit();
                    let (sin, cos) = libm::sincos(TAU * unit());
                    Vec2::new(cos, sin) * libm::sqrt(squared)
                };
                let own = within(0.0, 1.5);
                let other = MovingBall {
                    offset_m: within(radii_m, 5.0),
                    velocity_mps: within(0.0, 1.5),
                    radii_m,
                    tie: Vec2::ZERO,
                };
                (own, other)
            })
            .collect()
    }

    /// Compares the template with the analytic form.
    #[must_use]
    pub fn report(&self) -> Report {
        let compared = self.draw().into_iter().filter_map(|(own, other)| {
            let exact = Analytic.half_space(own, &other, &PARAMS)?;
            let found = VoxelTable2k.half_space(own, &other, &PARAMS)?;
            let (sin, cos) = (exact.normal.det(found.normal), exact.normal.dot(found.normal));
            let change = found.penetration(own) - exact.penetration(own);
            Some((libm::atan2(sin, cos).abs().to_degrees(), change.abs() * PARAMS.horizon_s / other.radii_m))
        });
        let (angles, distances): (Vec<f64>, Vec<f64>) = compared.unzip();
        let table: VelocityObstacleTable = VoxelTable2k::TABLE;
        Report {
            pairs: self.pairs,
            seed: self.seed,
            bytes: table.bytes(),
            nodes: table.shape(),
            angle_deg: Errors::of(&angles).unwrap_or_default(),
            distance: Errors::of(&distances).unwrap_or_default(),
        }
    }
}

const HEAD: &str = concat!(
    "                                         angle of normals, deg   change of velocity, (R_A+R_B)/tau\n",
    "template         bytes         nodes      mean     p99     max            mean       p99       max\n",
);

impl fmt::Display for Report {
    fn fmt(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            text,
            "half-planes from the voxel template against the exact ones, {} pairs, seed {}",
            self.pairs, self.seed
        )?;
        text.write_str(HEAD)?;
        let [levels, directions] = self.nodes;
        let nodes = format!("{levels} x {directions}");
        let Errors { mean, p99, max } = self.angle_deg;
        write!(text, "{:<14}{:>8}{nodes:>14}{mean:>10.4}{p99:>8.3}{max:>8.3}", "Template2k", self.bytes)?;
        let Errors { mean, p99, max } = self.distance;
        writeln!(text, "{mean:>16.6}{p99:>10.5}{max:>10.5}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_seeds_say_the_same_in_rows_of_equal_length() {
        let sample = Sample { pairs: 2000, seed: 1 };
        let report = sample.report();
        assert_eq!(report, sample.report());
        assert!(report.angle_deg.mean > 0.0 && report.angle_deg.p99 <= report.angle_deg.max);
        assert_ne!(Sample { seed: 2, ..sample }.report().angle_deg, report.angle_deg);
        let text = report.to_string();
        assert_eq!(text.lines().count(), 3 + 1);
        let width = text.lines().last().unwrap().len();
        assert!(text.lines().skip(1).all(|line| line.len() == width), "{text}");
    }
}
