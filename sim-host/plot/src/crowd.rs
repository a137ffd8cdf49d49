//! Large swarms: the number of visits of each cell instead of a line per robot.

use super::canvas::Pixels;
use super::colour::Colour;
use super::map::Map;

/// Colours for one visit, half of the most visits (logarithmic scale), and the most visits.
const RAMP: [Colour; 3] = [
    Colour::hex(0x7c_c4_ee).with_alpha(150),
    Colour::hex(0x00_72_b2).with_alpha(215),
    Colour::hex(0x08_1d_38).with_alpha(240),
];

pub fn colour(share: f64) -> Colour {
    if share < 0.5 { RAMP[0].towards(RAMP[1], share * 2.0) } else { RAMP[1].towards(RAMP[2], share * 2.0 - 1.0) }
}

pub struct Density {
    columns: u32,
    rows: u32,
    entered: Vec<u32>,
}

impl Density {
    /// Paths are straight between two positions, in metres. O(squares + visited squares).
    pub fn new<'a>(map: &Map<'_>, ways: impl Iterator<Item = &'a [[f64; 2]]>) -> Self {
        let [columns, rows, _] = map.raster();
        let mut this = Self { columns, rows, entered: vec![0; columns as usize * rows as usize] };
        for way in ways {
            let squares: Vec<[i64; 2]> = way.iter().map(|position| map.square(*position)).collect();
            squares.first().into_iter().for_each(|square| this.enter(*square));
            squares.windows(2).for_each(|pair| walk(pair[0], pair[1], |square| this.enter(square)));
        }
        this
    }

    fn enter(&mut self, [x, y]: [i64; 2]) {
        let (columns, rows) = (i64::from(self.columns), i64::from(self.rows));
        if (0..columns).contains(&x) && (0..rows).contains(&y) {
            let count = &mut self.entered[(y * columns + x) as usize];
            *count = count.saturating_add(1);
        }
    }

    pub fn most(&self) -> u32 {
        self.entered.iter().copied().max().unwrap_or(0)
    }

    pub fn pixels(&self) -> Pixels {
        let decades = libm::log10(f64::from(self.most().max(2)));
        let pixel = |count: &u32| match count {
            0 => [0; 4],
            count => {
                let Colour { rgb: [red, green, blue], alpha } = colour(libm::log10(f64::from(*count)) / decades);
                [red, green, blue, alpha]
            }
        };
        Pixels { width: self.columns, height: self.rows, rgba: self.entered.iter().map(pixel).collect() }
    }
}

fn walk(from: [i64; 2], to: [i64; 2], mut visit: impl FnMut([i64; 2])) {
    let by = [to[0] - from[0], to[1] - from[1]];
    let steps = by[0].abs().max(by[1].abs());
    for step in 1..=steps {
        let along = |axis: usize| from[axis] + (2 * by[axis] * step + steps).div_euclid(2 * steps);
        visit([along(0), along(1)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::terrain::Terrain;

    #[test]
    fn straight_paths_visit_each_square_once() {
        for (to, middle) in [([4, 2], [2, 1]), ([-4, 0], [-2, 0]), ([0, -4], [0, -2])] {
            let mut seen = Vec::new();
            walk([0, 0], to, |square| seen.push(square));
            assert_eq!((seen.len(), seen[1], seen[3]), (4, middle, to));
        }
        walk([3, 3], [3, 3], |_| panic!("a stationary robot visits no square"));
    }

    #[test]
    fn paths_are_counted_north_up_and_clipped_to_the_map() {
        let terrain = Terrain::from_cells(3, 2, vec![1; 6]).unwrap();
        let map = Map::new(&terrain, [0.0; 2]);
        let ways: [&[[f64; 2]]; 4] = [
            &[[0.5, 0.5], [2.5, 0.5], [2.5, 0.5]],
            &[[2.5, 0.5], [9.5, 0.5]],
            &[[-1e300, 0.5], [f64::INFINITY, 1e300]],
            &[],
        ];
        let density = Density::new(&map, ways[..2].iter().copied().chain([ways[3]]));
        assert_eq!(density.entered, [0, 0, 0, 1, 1, 2]);
        assert_eq!(density.most(), 2);
        let image = density.pixels();
        assert_eq!(image.rgba[0], [0; 4]);
        assert!(image.rgba[5][0] < image.rgba[4][0], "more visits are darker");
        let wild = Density::new(&map, ways[2..3].iter().copied());
        assert!(wild.most() <= 1);
    }
}
