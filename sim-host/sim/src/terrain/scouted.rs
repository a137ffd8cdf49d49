//! Incomplete and partly wrong maps of a terrain (KUZ section 3).

use super::Terrain;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::rand::Rng;

const PATCH: u32 = 0x004C_0002;

/// Differences between a map and the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scouted {
    /// Share of patches that the map does not show, 0 to 1.
    pub unknown: f64,
    /// Share of patches that show other terrain, 0 to 1; both shares add up to at most 1.
    pub wrong: f64,
    /// Side of a patch, cells, 1 or more.
    pub patch_cells: u16,
    /// Assumed crossing time of unknown cells, ticks, 1 to 255.
    pub assumed: u8,
    /// Equal seeds give equal maps.
    pub seed: u64,
}

impl Scouted {
    /// Creates the map of `land`. O(cells).
    #[must_use]
    pub fn map(&self, land: &Terrain) -> Terrain {
        let mut map = land.clone();
        let side = self.patch_cells.max(1);
        let (width, height) = (land.width(), land.height());
        for row in 0..height.div_ceil(side) {
            for column in 0..width.div_ceil(side) {
                let mut rng = Rng::keyed(self.seed, PATCH, column.into(), row.into());
                // A 32-bit integer is exact in `f64`.
                let lot = f64::from(rng.next_u64() as u32) / f64::from(u32::MAX) - f64::EPSILON;
                let is_unknown = lot < self.unknown;
                if !is_unknown && lot >= self.unknown + self.wrong {
                    continue;
                }
                let [dx, dy] = [width, height].map(|side| rng.below(side.into()));
                let columns = column * side..(column * side).saturating_add(side).min(width);
                for y in row * side..(row * side).saturating_add(side).min(height) {
                    for x in columns.clone() {
                        let far = |at: u16, by: u32, side: u16| ((u32::from(at) + by) % u32::from(side)) as i16;
                        let elsewhere = Cell::new(far(x, dx, width), far(y, dy, height));
                        let class = if is_unknown { self.assumed } else { land.get(elsewhere) };
                        map.set(Cell::new(x as i16, y as i16), class);
                    }
                }
            }
        }
        map
    }
}

/// Median class of the open cells, 1 if there are none; the default for unknown cells. O(cells).
#[must_use]
pub fn usual_class(land: &Terrain) -> u8 {
    let mut counts = [0_usize; 256];
    land.cells().iter().for_each(|&class| counts[usize::from(class)] += 1);
    counts[usize::from(BLOCKED)] = 0;
    let half = counts.iter().sum::<usize>().div_ceil(2);
    let mut sum = 0;
    let median = counts.iter().position(|count| {
        sum += count;
        sum >= half && sum > 0
    });
    median.map_or(1, |class| class as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn land() -> Terrain {
        let cells = (0..50_u32 * 40).map(|at| (Rng::keyed(3, 0, at, 0).below(10)) as u8).collect();
        Terrain::from_cells(50, 40, cells).expect("fits")
    }

    fn scouted(unknown: f64, wrong: f64, patch_cells: u16) -> Scouted {
        Scouted { unknown, wrong, patch_cells, assumed: 77, seed: 1 }
    }

    #[test]
    fn shares_of_cells_are_unknown_or_wrong() {
        let (land, all) = (land(), 2000.0);
        assert_eq!(scouted(0.0, 0.0, 1).map(&land), land);
        assert!(scouted(1.0, 0.0, 3).map(&land).cells().iter().all(|&class| class == 77));
        for patch in [1, 4] {
            let map = scouted(0.3, 0.2, patch).map(&land);
            let unknown = map.cells().iter().filter(|&&class| class == 77).count() as f64 / all;
            let differ = map.cells().iter().zip(land.cells()).filter(|(map, land)| map != land).count() as f64 / all;
            assert!((unknown - 0.3).abs() < 0.1, "{patch}: {unknown}");
            assert!((differ - 0.48).abs() < 0.1, "{patch}: {differ}");
        }
    }

    #[test]
    fn wrong_cells_come_in_patches_and_depend_on_the_seed() {
        let flat = Terrain::from_cells(12, 12, vec![1; 144]).expect("fits");
        let map = scouted(0.5, 0.0, 4).map(&flat);
        for cell in (0..12).flat_map(|y| (0..12).map(move |x| Cell::new(x, y))) {
            assert_eq!(map.get(cell), map.get(Cell::new(cell.x / 4 * 4, cell.y / 4 * 4)));
        }
        assert_ne!(map, Scouted { seed: 2, ..scouted(0.5, 0.0, 4) }.map(&flat));
    }

    #[test]
    fn the_usual_class_is_the_median_of_open_cells() {
        let usual = |cells: Vec<u8>| usual_class(&Terrain::from_cells(cells.len() as u16, 1, cells).expect("fits"));
        assert_eq!(usual(vec![0, 0, 0, 2, 3, 9]), 3);
        assert_eq!(usual(vec![4]), 4);
        assert_eq!(usual(vec![0, 0]), 1);
    }
}
