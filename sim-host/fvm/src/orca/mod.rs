//! The velocity obstacle of two robots (Tolok et al., FVM): errors of half-planes from voxel
//! templates, and [`pictures`] as in the paper.

pub mod pictures;
mod view;

use serde::Serialize;
use staya_controller::geom::Vec2;
use staya_controller::orca::{
    Analytic, HalfSpaces, MovingBall, Params, VelocityObstacleTable, VoxelTable, VoxelTable2k, VoxelTable8k,
    VoxelTable16k, VoxelTable64k,
};
use staya_controller::rand::Rng;
use staya_stats::{mean, quantile};
use std::f64::consts::TAU;
use std::fmt;

/// Random pairs of robots: radii of 0.1 to 0.5 m, centres within 5 m without overlap, speeds up to
/// 1.5 m/s (all uniform, positions and velocities in discs), a horizon of 2 s, the whole
/// correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Number of pairs.
    pub pairs: u32,
    /// Seed; equal seeds give equal pairs.
    pub seed: u64,
}

/// Statistics of errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub max: f64,
}

/// Errors of one template size against the formula.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Size {
    /// Name of the type.
    pub name: &'static str,
    /// Size in flash, bytes.
    pub bytes: usize,
    /// Nodes: sines of the half angle, and directions.
    pub nodes: [usize; 2],
    /// Angles between normals, degrees.
    pub angle_deg: Errors,
    /// Differences of the required changes of velocity, in (R_A + R_B) / tau.
    pub distance: Errors,
}

/// Errors of all template sizes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Number of pairs.
    pub pairs: u32,
    /// Seed of the pairs.
    pub seed: u64,
    /// Templates, the smallest first.
    pub sizes: Vec<Size>,
}

type V = Vec2<f64>;

const PAIRS: u32 = 0x0045_0201;

const PARAMS: Params<f64> = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };

impl Sample {
    /// Own velocity and neighbour of each pair.
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

    /// Compares each template size with the formula.
    #[must_use]
    pub fn report(&self) -> Report {
        let pairs = self.draw();
        Report {
            pairs: self.pairs,
            seed: self.seed,
            sizes: vec![
                size::<VoxelTable2k>("Template2k", &pairs, VoxelTable2k),
                size::<VoxelTable8k>("Template8k", &pairs, VoxelTable8k),
                size::<VoxelTable16k>("Template16k", &pairs, VoxelTable16k),
                size::<VoxelTable64k>("Template64k", &pairs, VoxelTable64k),
            ],
        }
    }
}

fn size<T: VoxelTable>(
    name: &'static str,
    pairs: &[(Vec2<f64>, MovingBall<V>)],
    template: impl HalfSpaces<f64, Velocity = V>,
) -> Size {
    let table: VelocityObstacleTable = T::TABLE;
    let compared = pairs.iter().filter_map(|(own, other)| {
        let exact = Analytic.half_space(*own, other, &PARAMS)?;
        let found = template.half_space(*own, other, &PARAMS)?;
        let (sin, cos) = (exact.normal.det(found.normal), exact.normal.dot(found.normal));
        let change = found.penetration(*own) - exact.penetration(*own);
        Some((libm::atan2(sin, cos).abs().to_degrees(), change.abs() * PARAMS.horizon_s / other.radii_m))
    });
    let (angles, distances): (Vec<f64>, Vec<f64>) = compared.unzip();
    Size {
        name,
        bytes: table.bytes(),
        nodes: table.shape(),
        angle_deg: Errors::of(&angles),
        distance: Errors::of(&distances),
    }
}

impl Errors {
    /// All zero without values.
    fn of(values: &[f64]) -> Self {
        Self {
            mean: mean(values).unwrap_or(0.0),
            p99: quantile(values, 0.99).unwrap_or(0.0),
            max: values.iter().copied().fold(0.0, f64::max),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            text,
            "half-planes from voxel templates against the exact ones, {} pairs, seed {}",
            self.pairs, self.seed
        )?;
        writeln!(text, "{:36}{:>26}{:>36}", "", "angle of normals, deg", "change of velocity, (R_A+R_B)/tau")?;
        writeln!(
            text,
            "{:<14}{:>8}{:>14}{:>10}{:>8}{:>8}{:>16}{:>10}{:>10}",
            "template", "bytes", "nodes", "mean", "p99", "max", "mean", "p99", "max"
        )?;
        for size in &self.sizes {
            let [levels, directions] = size.nodes;
            let nodes = format!("{levels} x {directions}");
            let Errors { mean, p99, max } = size.angle_deg;
            write!(text, "{:<14}{:>8}{nodes:>14}{mean:>10.4}{p99:>8.3}{max:>8.3}", size.name, size.bytes)?;
            let Errors { mean, p99, max } = size.distance;
            writeln!(text, "{mean:>16.6}{p99:>10.5}{max:>10.5}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_templates_have_smaller_mean_errors_and_equal_seeds_equal_reports() {
        let sample = Sample { pairs: 2000, seed: 1 };
        let report = sample.report();
        assert_eq!(report, sample.report());
        for pair in report.sizes.windows(2) {
            assert!(pair[0].bytes < pair[1].bytes);
            assert!(pair[0].angle_deg.mean > pair[1].angle_deg.mean);
        }
        for size in &report.sizes {
            assert!(size.angle_deg.mean > 0.0 && size.angle_deg.p99 <= size.angle_deg.max);
        }
        assert_ne!(Sample { seed: 2, ..sample }.report().sizes, report.sizes);
    }

    #[test]
    fn the_table_has_a_row_for_each_size() {
        let sample = Sample { pairs: 100, seed: 3 };
        let text = sample.report().to_string();
        assert_eq!(text.lines().count(), 3 + 4);
        assert!(text.contains("Template64k"));
        let width = text.lines().last().unwrap().len();
        assert!(text.lines().skip(1).all(|line| line.len() == width), "{text}");
    }
}
