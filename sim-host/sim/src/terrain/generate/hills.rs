//! Interpretations of "natural" terrain. KUZ section 5 describes "several cells of the greatest
//! impassability, surrounded by less impassable ones, ... and so on". Of its references with the
//! generators, 14 (CEUR Workshop Proceedings 1904) was not used. 15 ("Generation of a Random
//! Landscape by given Configuration Entropy and Total Edge") was used as far as its abstract tells,
//! in `papers/kuz/generators`. Each variant here interprets "and so on" differently; `staya
//! experiment land-entropy` compares their entropy with the paper's.

use super::{LandPlan, check_obstacles, sample};
use crate::terrain::Terrain;
use crate::terrain::error::TerrainError;
use staya_controller::grid::Norm;
use staya_controller::names::Named;
use staya_controller::rand::Rng;

const ROUGH: u32 = 0x0054_0002;
/// Scale of the slopes of rough hills.
const ONE: u64 = 256;

/// Decrease of impassability from the highest class l to 1 with distance d from an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hills {
    /// By one per cell: l - floor d.
    #[default]
    Even,
    /// By one per cell, with d rounded: l - round d.
    Rounded,
    /// By one per two cells: l - floor(d / 2).
    Wide,
    /// By one per cell; overlapping hills add up.
    Added,
    /// By a random slope for each cell: l - floor(q d), q uniform from 0 to 2.
    Rough,
}

impl Named for Hills {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("even", Self::Even),
        ("rounded", Self::Rounded),
        ("wide", Self::Wide),
        ("added", Self::Added),
        ("rough", Self::Rough),
    ];

    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, hills)| *hills == self).map_or("", |(name, _)| name)
    }
}

/// Generates natural terrain; see [`natural`](super::natural). O(size * obstacles).
///
/// # Errors
/// See [`natural`](super::natural).
pub fn natural_by(plan: &LandPlan, obstacles: u32, norm: Norm, hills: Hills) -> Result<Terrain, TerrainError> {
    if hills == Hills::Even {
        return super::natural(plan, obstacles, norm);
    }
    check_obstacles(plan, obstacles)?;
    let width = u32::from(plan.width);
    let drawn = sample(plan.cells(), obstacles, &mut plan.rng());
    let top = u64::from(plan.classes);
    let mut rough = Rng::keyed(plan.seed, ROUGH, 0, 0);
    let cell = |at: u32| {
        let square = |obstacle: &u32| {
            let across = u64::from((at % width).abs_diff(obstacle % width));
            let along = u64::from((at / width).abs_diff(obstacle / width));
            match norm {
                Norm::Euclidean => across * across + along * along,
                Norm::Chebyshev => across.max(along) * across.max(along),
            }
        };
        let nearest = || drawn.iter().map(square).min();
        let slope = u64::from(rough.below(2 * ONE as u32));
        let fall = match hills {
            Hills::Even => nearest().map(u64::isqrt),
            Hills::Rounded => nearest().map(|square| (4 * square).isqrt().div_ceil(2)),
            Hills::Wide => nearest().map(|square| square.isqrt() / 2),
            Hills::Rough => nearest().map(|square| (square * slope * slope).isqrt() / ONE),
            Hills::Added => {
                let height = |square: u64| top.saturating_sub(1 + square.isqrt());
                let sum: u64 = drawn.iter().map(|obstacle| height(square(obstacle))).sum();
                Some(top.saturating_sub(1 + sum))
            }
        };
        top.saturating_sub(fall.unwrap_or(top)).max(1) as u8
    };
    Terrain::from_cells(plan.width, plan.height, (0..plan.cells()).map(cell).collect())
}

#[cfg(test)]
mod tests {
    use super::super::natural;
    use super::*;
    use crate::terrain::metrics::Metrics;

    const PLAN: LandPlan = LandPlan { width: 100, height: 100, classes: 9, seed: 1 };

    #[test]
    fn variants_of_a_hill_differ_as_documented() {
        let plan = LandPlan { width: 31, height: 1, ..PLAN };
        let row = |hills| {
            let land = natural_by(&plan, 1, Norm::Euclidean, hills).expect("land");
            // Other cells around it may be as high.
            let peak = natural(&plan, 1, Norm::Euclidean).expect("land");
            let top = peak.cells().iter().position(|&u| u == 9).expect("an obstacle");
            let side = if top < 15 {
                land.cells()[top..].to_vec()
            } else {
                land.cells()[..=top].iter().rev().copied().collect()
            };
            side[..5].to_vec()
        };
        assert_eq!(row(Hills::Even), [9, 8, 7, 6, 5]);
        assert_eq!(row(Hills::Rounded), [9, 8, 7, 6, 5]);
        assert_eq!(row(Hills::Added), [9, 8, 7, 6, 5]);
        assert_eq!(row(Hills::Wide), [9, 9, 8, 8, 7]);
        let rough = row(Hills::Rough);
        assert!(rough[0] == 9 && rough.iter().zip(0..).all(|(&u, d)| u >= 9 - 2 * d), "{rough:?}");
        let (one, other) = (natural_by(&PLAN, 40, Norm::Chebyshev, Hills::Even), natural(&PLAN, 40, Norm::Chebyshev));
        assert_eq!(one.expect("land"), other.expect("land"));
        assert!(natural_by(&PLAN, 10_001, Norm::Euclidean, Hills::Wide).is_err());
    }

    #[test]
    fn rough_hills_have_the_entropy_of_the_paper_within_a_fifth() {
        for (obstacles, paper) in [(10, 1.52), (33, 1.80), (70, 1.98), (130, 2.13)] {
            let of = |seed| {
                let land = natural_by(&LandPlan { seed, ..PLAN }, obstacles, Norm::Euclidean, Hills::Rough);
                Metrics::of(&land.expect("land")).entropy
            };
            let mean = (0..8).map(of).sum::<f64>() / 8.0;
            assert!((mean - paper).abs() < 0.2, "{obstacles}: {mean}");
        }
    }
}
