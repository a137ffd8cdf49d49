//! Terrain metrics: configuration entropy, total edge and its density.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 4, definitions 2 and 3. Blocked cells are a class.

use super::Terrain;
use serde::Serialize;

/// Metrics of a terrain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Number of cells M.
    pub cells: usize,
    /// Number of classes that occur.
    pub classes: usize,
    /// Number of blocked cells.
    pub blocked: usize,
    /// Configuration entropy S = -sum p ln p over the classes, 0..=ln(classes).
    pub entropy: f64,
    /// Total edge TE: sides between neighbouring cells (4 neighbours) of different classes.
    pub total_edge: u64,
    /// Total edge density TED = TE / M, 0..=2.
    pub total_edge_density: f64,
}

impl Metrics {
    /// Computes the metrics of a terrain. O(size).
    #[must_use]
    pub fn of(terrain: &Terrain) -> Self {
        let counts = class_counts(terrain.cells());
        let total_edge = total_edge(terrain.cells(), terrain.width());
        let cells = terrain.cells().len();
        Self {
            cells,
            classes: counts.iter().filter(|count| **count > 0).count(),
            blocked: counts[0],
            entropy: entropy(&counts),
            total_edge,
            total_edge_density: total_edge as f64 / cells as f64,
        }
    }
}

/// Number of cells of each class, indexed by impassability.
#[must_use]
pub fn class_counts(cells: &[u8]) -> [usize; 256] {
    let mut counts = [0; 256];
    for u in cells {
        counts[usize::from(*u)] += 1;
    }
    counts
}

/// Configuration entropy of class sizes; 0 for no cells.
#[must_use]
pub fn entropy(counts: &[usize]) -> f64 {
    let cells: usize = counts.iter().sum();
    let terms = counts.iter().filter(|count| **count > 0).map(|count| {
        let share = *count as f64 / cells as f64;
        -share * libm::log(share)
    });
    // A single class gives -1 * 0; avoid negative zero in reports.
    terms.sum::<f64>().max(0.0)
}

/// Sides between cells of different classes in rows of `width` cells.
#[must_use]
pub fn total_edge(cells: &[u8], width: u16) -> u64 {
    let mut edges = 0;
    let mut before: &[u8] = &[];
    for row in cells.chunks(usize::from(width).max(1)) {
        edges += row.windows(2).filter(|pair| pair[0] != pair[1]).count();
        edges += row.iter().zip(before).filter(|(a, b)| a != b).count();
        before = row;
    }
    edges as u64
}

/// Number of obstacles N(S) of `natural` terrain (100 x 100, 9 classes) with entropy `s`.
///
/// KUZ section 5 gives N = 0.00160518 e^(4.22769 S), which contradicts figure 7 (S = 1.6 with N =
/// 14, S = 1.8 with N = 33). The printed factor has one zero too many: 0.0160518 gives 13.9 and
/// 32.4, and S = 1.98 at N = 70 as in the text.
#[must_use]
pub fn obstacles_of_entropy(s: f64) -> f64 {
    0.016_051_8 * libm::exp(4.227_69 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn metrics(width: u16, cells: &[u8]) -> Metrics {
        let height = cells.len() as u16 / width;
        Metrics::of(&Terrain::from_cells(width, height, cells.to_vec()).unwrap())
    }

    #[test]
    fn flat_land_has_neither_entropy_nor_edges() {
        let flat = metrics(3, &[1; 6]);
        assert_eq!((flat.entropy, flat.total_edge, flat.classes), (0.0, 0, 1));
        assert!(flat.entropy.is_sign_positive());
        assert_eq!(metrics(1, &[0]).blocked, 1);
    }

    #[test]
    fn the_entropy_of_equal_shares_is_the_logarithm_of_their_number() {
        let board = metrics(4, &[1, 2, 1, 2, 2, 1, 2, 1]);
        assert!((board.entropy - libm::log(2.0)).abs() < 1e-15);
        assert_eq!(board.total_edge, 10);
        assert_eq!(board.total_edge_density, 1.25);
        let nine: Vec<u8> = (1..=9).collect();
        assert!((metrics(3, &nine).entropy - libm::log(9.0)).abs() < 1e-15);
        assert_eq!(metrics(3, &nine).total_edge, 12);
    }

    #[test]
    fn edges_count_each_side_once_and_no_diagonals() {
        assert_eq!(metrics(3, &[1, 1, 1, 1, 2, 1, 1, 1, 1]).total_edge, 4);
        assert_eq!(metrics(2, &[1, 2, 2, 1]).total_edge, 4);
        assert_eq!(metrics(2, &[1, 1, 2, 2]).total_edge, 2);
        assert_eq!(metrics(1, &[1, 2, 2, 3]).total_edge, 2);
    }

    #[test]
    fn corrected_obstacle_formula_agrees_with_figure_7() {
        assert!((obstacles_of_entropy(1.6) - 13.9).abs() < 0.05);
        assert!((obstacles_of_entropy(1.8) - 32.4).abs() < 0.05);
        assert!((obstacles_of_entropy(1.98) - 70.0).abs() < 1.0);
    }

    proptest! {
        #[test]
        fn metrics_are_bounded_and_independent_of_class_labels(
            width in 1..8_u16,
            classes in prop::collection::vec(0..4_u8, 40),
            rows in 1..6_usize,
        ) {
            let land = &classes[..usize::from(width) * rows];
            let m = metrics(width, land);
            prop_assert!(m.entropy <= libm::log(m.classes as f64) + 1e-12);
            prop_assert!(m.total_edge_density <= 2.0);
            let renamed: Vec<u8> = land.iter().map(|u| 7 - u).collect();
            let r = metrics(width, &renamed);
            prop_assert!((m.entropy - r.entropy).abs() < 1e-12);
            prop_assert_eq!(m.total_edge, r.total_edge);
        }
    }
}
