//! Random terrain, as a function of parameters and a seed.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 5 and figure 7 (`uniform`, `natural`), section 4 and
//! its reference 15 (terrain with a given configuration entropy and total edge).

mod by_metrics;
mod hills;

pub use by_metrics::{ByMetrics, by_metrics};
pub use hills::{Hills, natural_by};

use super::error::{TerrainError, parameter_error};
use super::{MAX_SIDE, Terrain};
use crate::file::has_memory;
use staya_controller::grid::Norm;
use staya_controller::rand::Rng;

const LAND: u32 = 0x0054_0001;
const ORDER: u32 = 0x0054_0003;

/// Size, classes and seed of random terrain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LandPlan {
    /// Cells from west to east, 1..=[`MAX_SIDE`].
    pub width: u16,
    /// Cells from south to north, 1..=[`MAX_SIDE`].
    pub height: u16,
    /// Number of classes l, 1..=255: impassability is 1..=l, and no cell is blocked.
    pub classes: u8,
    /// Equal seeds give equal terrain.
    pub seed: u64,
}

impl LandPlan {
    fn check(&self) -> Result<(), TerrainError> {
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&self.width) || !sides.contains(&self.height) {
            return Err(parameter_error(
                format!("a landscape of {} x {} cells", self.width, self.height),
                format!("each side must be 1..={MAX_SIDE}"),
            ));
        }
        // One byte per cell, and four for its index in a random sample.
        let bytes = 5 * u64::from(self.cells());
        if !has_memory(bytes) {
            return Err(parameter_error(
                format!(
                    "a landscape of {} x {} cells needs {} MB of memory, which is not to be had",
                    self.width,
                    self.height,
                    bytes >> 20
                ),
                "give shorter sides, or close other programs",
            ));
        }
        if self.classes == 0 {
            return Err(parameter_error("a landscape of 0 classes", "give the number of classes, 1..=255"));
        }
        Ok(())
    }

    fn cells(&self) -> u32 {
        u32::from(self.width) * u32::from(self.height)
    }

    fn rng(&self) -> Rng {
        Rng::keyed(self.seed, LAND, 0, 0)
    }
}

/// Generates terrain in which the impassability of each cell is independent and uniform in 1..=l
/// (KUZ figure 7c). O(size).
///
/// # Errors
/// A [`TerrainError::Parameter`] if the plan is out of range.
pub fn uniform(plan: &LandPlan) -> Result<Terrain, TerrainError> {
    plan.check()?;
    let mut rng = plan.rng();
    let classes = u32::from(plan.classes);
    let cells = (0..plan.cells()).map(|_| 1 + rng.below(classes) as u8);
    Terrain::from_cells(plan.width, plan.height, cells.collect())
}

/// Puts the cells of a terrain in random order: equal entropy, but no hills. KUZ figure 2 plots
/// uniformly random land over the number of obstacles of natural land with its entropy. O(size).
///
/// # Errors
/// None for a terrain that exists.
pub fn shuffled(land: &Terrain, seed: u64) -> Result<Terrain, TerrainError> {
    let mut cells = land.cells().to_vec();
    let mut rng = Rng::keyed(seed, ORDER, 0, 0);
    for last in (1..cells.len()).rev() {
        cells.swap(last, rng.below(last as u32 + 1) as usize);
    }
    Terrain::from_cells(land.width(), land.height(), cells)
}

/// Generates hills of mud: `obstacles` different random cells have class l, and impassability falls
/// by one per cell, u = max(1, l - floor(distance to the nearest obstacle)) (KUZ figures 7a and
/// 7b). Distances are Euclidean or Chebyshev, by `norm`. O(size + obstacles l^2).
///
/// # Errors
/// A [`TerrainError::Parameter`] for a plan out of range or more obstacles than cells.
pub fn natural(plan: &LandPlan, obstacles: u32, norm: Norm) -> Result<Terrain, TerrainError> {
    check_obstacles(plan, obstacles)?;
    let width = usize::from(plan.width);
    let mut cells = vec![1; plan.cells() as usize];
    let hill = Hill::new(plan.classes, norm);
    for at in sample(plan.cells(), obstacles, &mut plan.rng()) {
        let at = at as usize;
        hill.stamp(&mut cells, width, at % width, at / width);
    }
    Terrain::from_cells(plan.width, plan.height, cells)
}

fn check_obstacles(plan: &LandPlan, obstacles: u32) -> Result<(), TerrainError> {
    plan.check()?;
    if obstacles > plan.cells() {
        return Err(parameter_error(
            format!("{obstacles} obstacles on {} cells", plan.cells()),
            "give fewer obstacles, or more land",
        ));
    }
    Ok(())
}

/// `count` different numbers below `total` in random order; all sets are equally likely.
fn sample(total: u32, count: u32, rng: &mut Rng) -> Vec<u32> {
    if u64::from(count) * 4 < u64::from(total) {
        let mut taken = std::collections::HashSet::new();
        let mut drawn = Vec::with_capacity(count as usize);
        while drawn.len() < count as usize {
            let number = rng.below(total);
            if taken.insert(number) {
                drawn.push(number);
            }
        }
        drawn
    } else {
        let mut all: Vec<u32> = (0..total).collect();
        for at in 0..count {
            all.swap(at as usize, (at + rng.below(total - at)) as usize);
        }
        all.truncate(count as usize);
        all
    }
}

struct Hill {
    reach: usize,
    square: Vec<u8>,
}

impl Hill {
    fn new(classes: u8, norm: Norm) -> Self {
        let reach = u32::from(classes.saturating_sub(2));
        let offsets = || (0..=2 * reach).map(|at| at.abs_diff(reach));
        let square = offsets().flat_map(|dy| {
            offsets().map(move |dx| {
                let distance = match norm {
                    Norm::Chebyshev => dx.max(dy),
                    Norm::Euclidean => (dx * dx + dy * dy).isqrt(),
                };
                u32::from(classes).saturating_sub(distance).max(1) as u8
            })
        });
        Self { reach: reach as usize, square: square.collect() }
    }

    fn stamp(&self, cells: &mut [u8], width: usize, x: usize, y: usize) {
        let side = 2 * self.reach + 1;
        let height = cells.len() / width;
        let columns = x.saturating_sub(self.reach)..(x + self.reach + 1).min(width);
        for row in y.saturating_sub(self.reach)..(y + self.reach + 1).min(height) {
            let start = (row + self.reach - y) * side + columns.start + self.reach - x;
            let hill = &self.square[start..start + columns.len()];
            let land = &mut cells[row * width..][columns.clone()];
            for (u, here) in land.iter_mut().zip(hill) {
                *u = (*u).max(*here);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::metrics::{Metrics, class_counts, obstacles_of_entropy};
    use super::*;
    use proptest::prelude::*;
    use staya_controller::grid::Cell;

    const PLAN: LandPlan = LandPlan { width: 100, height: 100, classes: 9, seed: 1 };

    fn by_definition(land: &Terrain, classes: u8, obstacles: &[Cell], norm: Norm) -> Vec<u8> {
        let cell = |at: usize| {
            let width = usize::from(land.width());
            Cell::new((at % width) as i16, (at / width) as i16)
        };
        let distance = |a: Cell, b: Cell| match norm {
            Norm::Chebyshev => u64::from(a.chebyshev(b)),
            Norm::Euclidean => a.distance_squared(b).isqrt(),
        };
        (0..land.cells().len())
            .map(|at| {
                let nearest = obstacles.iter().map(|o| distance(cell(at), *o)).min();
                let out = nearest.unwrap_or(u64::MAX);
                u64::from(classes).saturating_sub(out).max(1) as u8
            })
            .collect()
    }

    proptest! {
        #[test]
        fn natural_terrain_follows_the_definition(
            width in 1..40_u16,
            height in 1..40_u16,
            classes in 1..=12_u8,
            share in 0..=100_u32,
            seed: u64,
            norm in prop_oneof![Just(Norm::Euclidean), Just(Norm::Chebyshev)],
        ) {
            let plan = LandPlan { width, height, classes, seed };
            let obstacles = plan.cells() * share / 100;
            let land = natural(&plan, obstacles, norm).unwrap();
            let drawn = sample(plan.cells(), obstacles, &mut plan.rng());
            let mut unique = drawn.clone();
            unique.sort_unstable();
            unique.dedup();
            prop_assert_eq!(unique.len() as u32, obstacles);
            let at = |n: u32| Cell::new((n % u32::from(width)) as i16, (n / u32::from(width)) as i16);
            let cells: Vec<Cell> = drawn.into_iter().map(at).collect();
            prop_assert_eq!(land.cells(), by_definition(&land, classes, &cells, norm));
        }
    }

    #[test]
    fn the_result_depends_only_on_plan_and_seed() {
        assert_eq!(uniform(&PLAN).unwrap(), uniform(&PLAN).unwrap());
        let other = LandPlan { seed: 2, ..PLAN };
        assert_ne!(uniform(&PLAN).unwrap(), uniform(&other).unwrap());
        let land = |plan| natural(plan, 40, Norm::Euclidean).unwrap();
        assert_eq!(land(&PLAN), land(&PLAN));
        assert_ne!(land(&PLAN), land(&other));
    }

    #[test]
    fn uniform_terrain_has_equal_shares_and_the_greatest_entropy() {
        let land = uniform(&PLAN).unwrap();
        let counts = class_counts(land.cells());
        // Binomial with mean 1111 and deviation 31.4: five deviations.
        assert!(counts[1..=9].iter().all(|n| n.abs_diff(1111) < 157), "{counts:?}");
        assert_eq!(counts[1..=9].iter().sum::<usize>(), 10_000);
        assert!(libm::log(9.0) - Metrics::of(&land).entropy < 1e-3);
    }

    #[test]
    fn natural_entropy_agrees_with_the_corrected_formula() {
        let mean = |obstacles: u32| {
            let s = (0..50).map(|seed| {
                let land = natural(&LandPlan { seed, ..PLAN }, obstacles, Norm::Euclidean).unwrap();
                Metrics::of(&land).entropy
            });
            s.sum::<f64>() / 50.0
        };
        for obstacles in [70, 90, 110] {
            let formula = libm::log(f64::from(obstacles) / obstacles_of_entropy(0.0)) / 4.22769;
            assert!((mean(obstacles) - formula).abs() < 0.06, "{obstacles}");
        }
    }

    #[test]
    fn plans_at_the_limits_work_and_others_are_refused() {
        let tiny = LandPlan { width: 1, height: 1, classes: 1, seed: 0 };
        assert_eq!(natural(&tiny, 0, Norm::Euclidean).unwrap().cells(), [1]);
        assert_eq!(natural(&tiny, 1, Norm::Euclidean).unwrap().cells(), [1]);
        assert!(natural(&tiny, 2, Norm::Euclidean).is_err());
        assert_eq!(uniform(&tiny).unwrap().cells(), [1]);
        assert!(uniform(&LandPlan { classes: 0, ..tiny }).is_err());
        assert!(uniform(&LandPlan { width: 0, ..tiny }).is_err());
        assert!(uniform(&LandPlan { height: 32_768, ..tiny }).is_err());
        let steep = LandPlan { width: 3, height: 3, classes: 255, seed: 0 };
        assert_eq!(natural(&steep, 9, Norm::Chebyshev).unwrap().cells(), [255; 9]);
        let stripe = LandPlan { height: 1, ..PLAN };
        assert_eq!(natural(&stripe, 100, Norm::Euclidean).unwrap().cells(), [9; 100]);
    }
}
