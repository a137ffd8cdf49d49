//! Land by a probabilistic cellular automaton, as the abstract of A. Kuznetsov 2017 ("Generation of
//! a random landscape by given configuration entropy and Total Edge", reference 15 of KUZ) tells:
//! it fills the land row by row, with a probability of an "extraordinary" new class.
//!
//! The abstract does not give the rule of the other cells. Here they take the class of a neighbour
//! that is already filled. The paper derives the ratio of classes from the entropy; here it is that
//! of a given land. With a probability of 1 it is the first algorithm of the abstract, random
//! filling in this ratio.

use staya_controller::rand::Rng;
use staya_sim::terrain::{Terrain, TerrainError};

const CELLS: u32 = 0x0045_0005;

/// Land of the size and, on average, of the classes of `land`. O(size).
///
/// # Errors
/// None for a land that exists.
pub(super) fn fill(land: &Terrain, extraordinary: f64, seed: u64) -> Result<Terrain, TerrainError> {
    let (width, count) = (usize::from(land.width()), land.cells().len());
    let mut rng = Rng::keyed(seed, CELLS, 0, 0);
    let mut cells: Vec<u8> = Vec::with_capacity(count);
    for at in 0..count {
        let west = (at % width > 0).then(|| cells[at - 1]);
        let south = at.checked_sub(width).map(|south| cells[south]);
        let neighbor = match (west, south) {
            (Some(west), Some(south)) => Some(if rng.below(2) == 0 { west } else { south }),
            (west, south) => west.or(south),
        };
        let is_new = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 <= extraordinary;
        let drawn = land.cells()[rng.below(count as u32) as usize];
        cells.push(neighbor.filter(|_| !is_new).unwrap_or(drawn));
    }
    Terrain::from_cells(land.width(), land.height(), cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::terrain::metrics::Metrics;

    #[test]
    fn classes_keep_their_shares_and_edges_fall_with_the_probability() {
        let classes: Vec<u8> = (0..10_000).map(|at| if at % 10 < 6 { 1 } else { 1 + (at % 3) as u8 }).collect();
        let land = Terrain::from_cells(100, 100, classes).unwrap();
        let of = |probability: f64| Metrics::of(&fill(&land, probability, 3).unwrap());
        let [all, some, few] = [1.0, 0.3, 0.05].map(of);
        assert!((all.entropy - Metrics::of(&land).entropy).abs() < 0.02, "{all:?}");
        assert!((some.entropy - all.entropy).abs() < 0.1, "{some:?}");
        assert!(few.total_edge * 2 < some.total_edge && some.total_edge * 3 < 2 * all.total_edge, "{some:?} {few:?}");
        assert_eq!(fill(&land, 0.3, 3).unwrap(), fill(&land, 0.3, 3).unwrap());
        let one = fill(&land, 0.0, 3).unwrap();
        assert!(one.cells().iter().all(|class| *class == one.cells()[0]));
    }
}
