//! Random terrain with a given configuration entropy S and total edge TE (KUZ section 4; A.
//! Kuznetsov, "Generation of a Random Landscape by given Configuration Entropy and Total Edge",
//! Computational Technologies 22(4), 2017). S depends only on the sizes of the classes, which fall
//! by a constant ratio found by bisection. TE depends only on their places: cells get classes in
//! the order of a field, from white noise (nearly the greatest TE) over smoother fields to stripes,
//! and the first field with at most the target TE is improved by exchanging cells.

use super::super::Terrain;
use super::super::error::{TerrainError, parameter_error};
use super::super::metrics::{entropy, total_edge};
use super::{LAND, LandPlan};
use staya_controller::rand::Rng;
use std::cmp::Reverse;

/// Target metrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByMetrics {
    /// Configuration entropy S, 0..=ln(classes).
    pub entropy: f64,
    /// Tolerance of S. Class sizes are integers, so small maps need a larger tolerance.
    pub entropy_tolerance: f64,
    /// Total edge TE.
    pub total_edge: u64,
    /// Tolerance of TE.
    pub edge_tolerance: u64,
}

const TRIES_PER_CELL: u32 = 200;
/// Larger radii could overflow the sums of [`smooth`].
const MAX_RADIUS: u16 = 1024;

/// Generates terrain with the given S and TE, each within its tolerance. O(size log size) for each
/// of at most about 20 fields, then at most 200 exchanges per cell.
///
/// # Errors
/// A [`TerrainError::Parameter`] if the plan is out of range, or if S or TE cannot be reached; the
/// error contains the possible range.
pub fn by_metrics(plan: &LandPlan, wanted: &ByMetrics) -> Result<Terrain, TerrainError> {
    plan.check()?;
    let sizes = class_sizes(plan, wanted)?;
    let mut rng = plan.rng();
    let noise: Vec<u64> = (0..plan.cells()).map(|_| u64::from(rng.next_u32() >> 16)).collect();

    let mut cells = Vec::new();
    for field in fields(plan, &noise) {
        cells = fill(&field, &sizes);
        if total_edge(&cells, plan.width) <= wanted.total_edge {
            break;
        }
    }
    let mut search = Search::new(plan, cells);
    let start = search.edges;
    search.approach(wanted.total_edge);
    if search.edges.abs_diff(wanted.total_edge) > wanted.edge_tolerance {
        // This search found one end of the possible range; another finds the other.
        let (low, high) = if search.edges > wanted.total_edge {
            let low = search.edges;
            let mut upward = Search::new(plan, fill(&noise, &sizes));
            upward.approach(u64::MAX);
            (low, upward.edges)
        } else {
            let stripes = fields(plan, &noise).last().unwrap_or_default();
            (total_edge(&fill(&stripes, &sizes), plan.width).min(start), search.edges)
        };
        return Err(parameter_error(
            format!(
                "total edge {} is out of reach with entropy {} on {} x {} cells",
                wanted.total_edge, wanted.entropy, plan.width, plan.height
            ),
            format!("choose one from about {low} to {high}, or allow a greater edge tolerance"),
        ));
    }
    Terrain::from_cells(plan.width, plan.height, search.cells)
}

/// Number of cells of each class 1..=l (index 0 is class 1) for the given entropy.
fn class_sizes(plan: &LandPlan, wanted: &ByMetrics) -> Result<Vec<usize>, TerrainError> {
    let cells = plan.cells() as usize;
    let sizes_at = |ratio: f64| {
        let shares: Vec<f64> =
            std::iter::successors(Some(1.0), |share| Some(share * ratio)).take(plan.classes.into()).collect();
        let total: f64 = shares.iter().sum();
        // Rounding the cumulative sums keeps the total exact.
        let mut taken = 0;
        let mut sum = 0.0;
        let round = |share: &f64| {
            sum += share;
            let upto = ((sum / total * cells as f64).round() as usize).min(cells);
            upto - std::mem::replace(&mut taken, upto)
        };
        shares.iter().map(round).collect::<Vec<usize>>()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if entropy(&sizes_at(middle)) < wanted.entropy {
            low = middle;
        } else {
            high = middle;
        }
    }
    let off = |sizes: &[usize]| (entropy(sizes) - wanted.entropy).abs();
    let mut best = sizes_at(low);
    for sizes in [sizes_at(high), sizes_at(1.0)] {
        if off(&sizes) < off(&best) {
            best = sizes;
        }
    }
    if off(&best) <= wanted.entropy_tolerance {
        return Ok(best);
    }
    let most = libm::log(f64::from(plan.classes).min(cells as f64));
    Err(parameter_error(
        format!("entropy {} is out of reach with {} classes on {cells} cells", wanted.entropy, plan.classes),
        format!(
            "choose one from 0 to {most:.4} (the nearest that class sizes give here is {:.4}), or allow a greater entropy tolerance",
            entropy(&best)
        ),
    ))
}

fn fields<'a>(plan: &'a LandPlan, noise: &'a [u64]) -> impl Iterator<Item = Vec<u64>> + 'a {
    let longest = plan.width.max(plan.height);
    let radii = std::iter::successors(Some(1_u16), |radius| Some(radius + (radius / 2).max(1)));
    let smoothed = radii
        .take_while(move |radius| *radius <= MAX_RADIUS.min(longest / 2))
        .map(move |radius| smooth(noise, plan.width, radius));
    let width = u32::from(plan.width);
    let stripes = (0..plan.cells()).map(move |at| {
        let across = if plan.width > plan.height { at % width } else { at / width };
        u64::from(across)
    });
    std::iter::once(noise.to_vec()).chain(smoothed).chain(std::iter::once_with(move || stripes.collect()))
}

/// Two passes of a box filter of `radius` (as sums), on a torus to avoid borders.
fn smooth(field: &[u64], width: u16, radius: u16) -> Vec<u64> {
    let (width, radius) = (usize::from(width), usize::from(radius));
    let mut field = field.to_vec();
    for _ in 0..2 {
        for row in field.chunks_exact_mut(width) {
            let summed = sums(row, radius);
            row.copy_from_slice(&summed);
        }
        for x in 0..width {
            let column: Vec<u64> = field[x..].iter().step_by(width).copied().collect();
            for (y, sum) in sums(&column, radius).into_iter().enumerate() {
                field[y * width + x] = sum;
            }
        }
    }
    field
}

/// Sums over a ring from `radius` before to `radius` after each place (at most once round).
fn sums(ring: &[u64], radius: usize) -> Vec<u64> {
    let length = ring.len();
    let radius = radius.min((length - 1) / 2);
    let mut sum: u64 = (0..=2 * radius).map(|at| ring[(at + length - radius) % length]).sum();
    (0..length)
        .map(|at| {
            let here = sum;
            sum += ring[(at + radius + 1) % length];
            sum -= ring[(at + length - radius) % length];
            here
        })
        .collect()
}

fn fill(field: &[u64], sizes: &[usize]) -> Vec<u8> {
    let mut order: Vec<u32> = (0..field.len() as u32).collect();
    order.sort_unstable_by_key(|at| (Reverse(field[*at as usize]), *at));
    let mut cells = vec![1; field.len()];
    for (class, size) in (1..=u8::MAX).zip(sizes) {
        for _ in 0..*size {
            if let Some(at) = order.pop() {
                cells[at as usize] = class;
            }
        }
    }
    cells
}

struct Search {
    cells: Vec<u8>,
    width: usize,
    edges: u64,
    rng: Rng,
}

impl Search {
    fn new(plan: &LandPlan, cells: Vec<u8>) -> Self {
        Self {
            edges: total_edge(&cells, plan.width),
            cells,
            width: plan.width.into(),
            rng: Rng::keyed(plan.seed, LAND, 0, 1),
        }
    }

    /// Exchanges random pairs of cells unless that moves TE away from `wanted`.
    fn approach(&mut self, wanted: u64) {
        let total = self.cells.len() as u32;
        for _ in 0..u64::from(total) * u64::from(TRIES_PER_CELL) {
            if self.edges == wanted {
                return;
            }
            let (a, b) = (self.rng.below(total) as usize, self.rng.below(total) as usize);
            if self.cells[a] == self.cells[b] {
                continue;
            }
            // A side shared by a and b counts twice before and twice after.
            let before = self.sides(a) + self.sides(b);
            self.cells.swap(a, b);
            let edges = self.edges + self.sides(a) + self.sides(b) - before;
            if edges.abs_diff(wanted) <= self.edges.abs_diff(wanted) {
                self.edges = edges;
            } else {
                self.cells.swap(a, b);
            }
        }
    }

    fn sides(&self, at: usize) -> u64 {
        let here = self.cells[at];
        let x = at % self.width;
        let west = (x > 0).then(|| self.cells[at - 1]);
        let east = (x + 1 < self.width).then(|| self.cells[at + 1]);
        let south = at.checked_sub(self.width).map(|south| self.cells[south]);
        let north = self.cells.get(at + self.width).copied();
        let differs = |side: &Option<u8>| side.is_some_and(|u| u != here);
        [west, east, south, north].iter().filter(|side| differs(side)).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::metrics::Metrics;
    use super::*;

    const PLAN: LandPlan = LandPlan { width: 60, height: 40, classes: 9, seed: 5 };

    fn wanted(entropy: f64, total_edge: u64) -> ByMetrics {
        ByMetrics { entropy, entropy_tolerance: 0.01, total_edge, edge_tolerance: 2 }
    }

    #[test]
    fn targets_are_met_from_stripes_to_checkerboards() {
        for (entropy, edges) in [
            (0.3, 100),
            (0.3, 700),
            (1.0, 200),
            (1.0, 400),
            (1.0, 2500),
            (1.8, 600),
            (1.8, 4300),
            (2.19, 400),
            (2.19, 1000),
            (2.19, 4100),
            (2.19, 4690),
        ] {
            let land = by_metrics(&PLAN, &wanted(entropy, edges)).unwrap();
            let metrics = Metrics::of(&land);
            assert!((metrics.entropy - entropy).abs() <= 0.01, "S {entropy}: {metrics:?}");
            assert!(metrics.total_edge.abs_diff(edges) <= 2, "TE {edges}: {metrics:?}");
            assert_eq!(metrics.blocked, 0);
        }
    }

    #[test]
    fn the_result_depends_only_on_plan_and_seed() {
        let land = |seed| by_metrics(&LandPlan { seed, ..PLAN }, &wanted(1.5, 1500)).unwrap();
        assert_eq!(land(1), land(1));
        assert_ne!(land(1), land(2));
    }

    #[test]
    fn unreachable_targets_are_refused_with_the_possible_range() {
        let message = |plan: &LandPlan, wanted: &ByMetrics| by_metrics(plan, wanted).unwrap_err().to_string();
        let high = message(&PLAN, &wanted(2.3, 1000));
        assert!(high.contains("entropy 2.3 is out of reach") && high.contains("0 to 2.1972"), "{high}");
        assert!(message(&PLAN, &wanted(-0.1, 0)).contains("0 to 2.1972"));
        assert!(message(&PLAN, &wanted(f64::NAN, 0)).contains("0 to 2.1972"));
        // Stripes across 40 rows: eight borders of 40 sides, some with a step.
        let smooth = message(&PLAN, &wanted(2.19, 100));
        assert!(smooth.contains("choose one from about 3"), "{smooth}");
        let rough = message(&PLAN, &wanted(2.19, 4710));
        assert!(rough.contains("total edge 4710 is out of reach"), "{rough}");
        assert!(rough.contains(" to 4700") || rough.contains(" to 469"), "{rough}");
        let dull = message(&PLAN, &wanted(0.0, 10));
        assert!(dull.contains("choose one from about 0 to 0"), "{dull}");
    }

    #[test]
    fn the_smallest_terrains_are_generated() {
        let one = LandPlan { width: 1, height: 1, ..PLAN };
        assert_eq!(by_metrics(&one, &wanted(0.0, 0)).unwrap().cells(), [1]);
        let two = LandPlan { width: 2, height: 1, classes: 2, seed: 0 };
        let cells = by_metrics(&two, &wanted(libm::log(2.0), 1)).unwrap();
        assert_eq!(Metrics::of(&cells).total_edge, 1);
        assert!(by_metrics(&two, &wanted(0.3, 1)).is_err());
        let column = LandPlan { width: 1, height: 50, classes: 3, seed: 0 };
        let land = by_metrics(&column, &ByMetrics { entropy_tolerance: 0.05, ..wanted(1.0, 20) }).unwrap();
        assert!(Metrics::of(&land).total_edge.abs_diff(20) <= 2);
    }
}
