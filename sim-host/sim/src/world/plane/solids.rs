//! Spatial index of obstacles.

use super::solid::Solid;

/// Up to this number, obstacles are searched without an index.
const FEW: usize = 8;
/// Bound on the rounding error of a distance, metres, within 2000 km of the origin and more.
const MARGIN_M: f64 = 1e-6;

/// Obstacles with a grid. Each square lists the obstacles within the reach of any position in it.
///
/// Bytes: 4 for each square (at most 16 per obstacle) and for each list entry (at most 256 per
/// obstacle). If more would be needed, squares are larger and lists longer.
#[derive(Clone, Debug)]
pub struct Solids {
    all: Vec<Solid>,
    reach_m: f64,
    grid: Grid,
}

#[derive(Clone, Debug, Default)]
struct Grid {
    low_m: [f64; 2],
    side_m: f64,
    /// Squares along each axis; 0: there is no grid.
    counts: [usize; 2],
    /// Start of each square's list in `listed`, and the end of the last.
    starts: Vec<usize>,
    listed: Vec<u32>,
    /// Half-spaces; they are in every list.
    endless: Vec<u32>,
}

impl Solids {
    /// Creates an index that finds obstacles within `reach_m` of any position.
    #[must_use]
    pub fn new(all: Vec<Solid>, reach_m: f64) -> Self {
        let grid = Grid::lay(&all, reach_m);
        Self { all, reach_m, grid }
    }

    /// All obstacles.
    #[must_use]
    pub fn all(&self) -> &[Solid] {
        &self.all
    }

    /// Search radius of the index, metres.
    #[must_use]
    pub const fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Changes the obstacles and rebuilds the index.
    pub fn change<T>(&mut self, change: impl FnOnce(&mut Vec<Solid>) -> T) -> T {
        let changed = change(&mut self.all);
        self.grid = Grid::lay(&self.all, self.reach_m);
        changed
    }

    /// All obstacles within `within_m` of a position, and possibly others, in their order.
    /// O(obstacles within the reach); O(all) if `within_m` is larger than the reach.
    pub fn near(&self, place_m: [f64; 3], within_m: f64) -> impl Iterator<Item = &Solid> {
        let is_laid = self.grid.counts[0] > 0 && within_m <= self.reach_m;
        let (listed, all) = if is_laid { (self.grid.list(place_m), &[][..]) } else { (&[][..], self.all.as_slice()) };
        listed.iter().map(|&index| &self.all[index as usize]).chain(all)
    }
}

impl Grid {
    fn lay(all: &[Solid], reach_m: f64) -> Self {
        let bounds: Vec<_> = all.iter().map(|solid| bounds(solid).map(|bounds| widened(bounds, reach_m))).collect();
        let Some([low_m, high_m]) = bounds.iter().flatten().copied().reduce(joined) else {
            return Self::default();
        };
        if all.len() <= FEW || u32::try_from(all.len()).is_err() {
            return Self::default();
        }
        let mut grid = Self { low_m, side_m: reach_m.max(1e-3) / 2.0, ..Self::default() };
        // The loop ends because doubling the side leads to a single square.
        let squares = |grid: &Self, [from, to]: [[usize; 2]; 2]| -> f64 {
            (0..2).map(|axis| (to[axis].min(grid.counts[axis] - 1) - from[axis] + 1) as f64).product()
        };
        loop {
            grid.counts = [0, 1].map(|axis| ((high_m[axis] - low_m[axis]) / grid.side_m) as usize + 1);
            let visited: f64 = bounds.iter().flatten().map(|&bounds| squares(&grid, grid.span(bounds))).sum();
            let count = grid.counts[0] as f64 * grid.counts[1] as f64;
            if count <= 16.0 * all.len() as f64 && visited <= 256.0 * all.len() as f64 {
                break;
            }
            grid.side_m *= 2.0;
        }
        grid.fill(all, &bounds, reach_m);
        grid
    }

    fn span(&self, bounds: [[f64; 2]; 2]) -> [[usize; 2]; 2] {
        bounds.map(|corner| {
            [0, 1].map(|axis| {
                let steps = (corner[axis] - self.low_m[axis]) / self.side_m;
                (steps.max(0.0) as usize).min(self.counts[axis] - 1)
            })
        })
    }

    fn fill(&mut self, all: &[Solid], bounds: &[Option<[[f64; 2]; 2]>], reach_m: f64) {
        let mut lists = vec![Vec::new(); self.counts[0] * self.counts[1]];
        let within_m = reach_m + self.side_m * std::f64::consts::FRAC_1_SQRT_2 + MARGIN_M;
        for ((index, solid), bounds) in (0_u32..).zip(all).zip(bounds) {
            let Some(bounds) = bounds else {
                self.endless.push(index);
                lists.iter_mut().for_each(|list| list.push(index));
                continue;
            };
            let [from, to] = self.span(widened(*bounds, MARGIN_M));
            for (column, row) in (from[1]..=to[1]).flat_map(|row| (from[0]..=to[0]).map(move |column| (column, row))) {
                let middle = |cells: usize, axis: usize| self.low_m[axis] + (cells as f64 + 0.5) * self.side_m;
                if flat(solid).distance_m([middle(column, 0), middle(row, 1), 0.0]) <= within_m {
                    lists[row * self.counts[0] + column].push(index);
                }
            }
        }
        self.starts = Vec::with_capacity(lists.len() + 1);
        self.starts.push(0);
        for list in lists {
            self.listed.extend(list);
            self.starts.push(self.listed.len());
        }
    }

    fn list(&self, [x, y, _]: [f64; 3]) -> &[u32] {
        let [column, row] = [(x - self.low_m[0]) / self.side_m, (y - self.low_m[1]) / self.side_m];
        let [columns, rows] = self.counts;
        // Outside the grid no obstacle is within reach; NaN positions also end here.
        if !(column >= 0.0 && column < columns as f64 && row >= 0.0 && row < rows as f64) {
            return &self.endless;
        }
        let square = row as usize * columns + column as usize;
        &self.listed[self.starts[square]..self.starts[square + 1]]
    }
}

/// Projection to the plane, which does not increase distances.
fn flat(solid: &Solid) -> Solid {
    match *solid {
        Solid::Ball { center_m: [x, y, _], radius_m } => Solid::Ball { center_m: [x, y, 0.0], radius_m },
        other => other,
    }
}

fn bounds(solid: &Solid) -> Option<[[f64; 2]; 2]> {
    match *solid {
        Solid::Wall([a, b]) => Some([[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]]),
        Solid::Ball { center_m: [x, y, _], radius_m } => Some(widened([[x, y], [x, y]], radius_m)),
        Solid::Plane { .. } => None,
    }
}

fn widened([low, high]: [[f64; 2]; 2], by_m: f64) -> [[f64; 2]; 2] {
    [low.map(|x| x - by_m), high.map(|x| x + by_m)]
}

fn joined(one: [[f64; 2]; 2], other: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let pick =
        |corner: usize, pick: fn(f64, f64) -> f64| [0, 1].map(|axis| pick(one[corner][axis], other[corner][axis]));
    [pick(0, f64::min), pick(1, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn solid() -> impl Strategy<Value = Solid> {
        let at = -50.0..50.0_f64;
        let point = [at.clone(), at.clone()];
        prop_oneof![
            3 => (point.clone(), -3.0..3.0_f64, 0.01..4.0_f64).prop_map(|([x, y], z, radius_m)| {
                Solid::Ball { center_m: [x, y, z], radius_m }
            }),
            3 => (point.clone(), [-4.0..4.0_f64, -4.0..4.0_f64])
                .prop_map(|([x, y], [dx, dy])| Solid::Wall([[x, y], [x + dx, y + dy]])),
            1 => [point.clone(), point.clone()].prop_map(Solid::Wall),
            1 => (point, 0.0..6.0_f64).prop_map(|([x, y], angle)| Solid::Plane {
                point_m: [x, y, 0.0],
                normal: [libm::cos(angle), libm::sin(angle), 0.0],
            }),
        ]
    }

    proptest! {
        #[test]
        fn the_index_finds_the_same_obstacles_as_a_full_search(
            all in proptest::collection::vec(solid(), 0..60),
            reach_m in 0.0..20.0_f64,
            share in 0.0..1.2_f64,
            places in proptest::collection::vec([-80.0..80.0_f64, -80.0..80.0, -2.0..2.0], 20),
            by_m in [-9.0..9.0_f64, -9.0..9.0],
        ) {
            let mut solids = Solids::new(all.clone(), reach_m);
            let mut all = all;
            for _ in 0..2 {
                for &place in &places {
                    let within_m = reach_m * share;
                    let is_near = |solid: &&Solid| solid.distance_m(place) <= within_m;
                    let found: Vec<_> = solids.near(place, within_m).filter(is_near).collect();
                    let expected: Vec<_> = all.iter().filter(is_near).collect();
                    prop_assert_eq!(found, expected);
                }
                let moved = |list: &mut Vec<Solid>| list.iter_mut().for_each(|solid| *solid = solid.moved(by_m));
                solids.change(moved);
                moved(&mut all);
            }
        }
    }

    #[test]
    fn few_of_many_obstacles_are_visited() {
        let ball = |index: u32| Solid::Ball {
            center_m: [f64::from(index % 40) * 10.0, f64::from(index / 40) * 10.0, 0.0],
            radius_m: 1.0,
        };
        let solids = Solids::new((0..1600).map(ball).collect(), 3.0);
        let looked: Vec<_> = (0..400).map(|x| solids.near([f64::from(x), 133.0, 0.0], 3.0).count()).collect();
        assert!(looked.iter().all(|&count| count <= 4) && looked.contains(&1), "{looked:?}");
    }

    #[test]
    fn distant_or_dense_obstacles_fit_into_memory() {
        let far = |index: u32| Solid::Wall([[f64::from(index), -1e6], [-f64::from(index), 1e6]]);
        let solids = Solids::new((0..1000).map(far).collect(), 1.0);
        assert!(solids.grid.listed.len() <= 256_000 && solids.grid.starts.len() <= 16_001);
        assert_eq!(solids.near([0.0, 0.0, 0.0], 0.5).filter(|solid| solid.distance_m([0.0; 3]) <= 0.5).count(), 1000);
        assert_eq!(solids.near([f64::NAN; 3], 0.5).count(), 0);
    }
}
