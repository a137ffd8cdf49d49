//! Land that stands in the way of the radio.

use super::params::Shadow;
use crate::terrain::Terrain;
use staya_controller::grid::{BLOCKED, Cell};

/// The land of a tick, as high as its classes say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hills<'a> {
    land: &'a Terrain,
    shadow: Shadow,
}

impl Shadow {
    /// Of this land, if there is any.
    pub(super) fn over(self, land: Option<&Terrain>) -> Option<Hills<'_>> {
        land.map(|land| Hills { land, shadow: self })
    }
}

impl Hills<'_> {
    /// Whether the straight line between two antennas passes above all cells between those of the
    /// two robots. O(cells on the line).
    pub(super) fn are_below(&self, from_m: [f64; 3], to_m: [f64; 3]) -> bool {
        let [start, end] = [from_m, to_m].map(|at_m| self.place(at_m));
        let [from, to] = [start, end].map(|[x, y, _]| [x, y].map(cell_of));
        let [dx, dy, dz] = [0, 1, 2].map(|axis| end[axis] - start[axis]);
        let height = |share: f64| start[2] + share * dz;
        let (mut at, mut entered) = (from, 0.0);
        let [mut across_x, mut across_y] = [Crossings::new(start[0], dx), Crossings::new(start[1], dy)];
        while at != to {
            let left = across_x.next.min(across_y.next);
            // Rounding may have led past the last cell.
            if left > 1.0 {
                return true;
            }
            if at != from && self.top_m(at) > height(entered).min(height(left)) {
                return false;
            }
            // A line through a corner passes on to the cell across it.
            let is_across = [across_x.next <= left, across_y.next <= left];
            for (axis, crossings) in [&mut across_x, &mut across_y].into_iter().enumerate() {
                if is_across[axis] {
                    at[axis] += crossings.go_on();
                }
            }
            entered = left;
        }
        true
    }

    /// A place in cells, with the height of its antenna in metres.
    fn place(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [west, south] = self.land.origin_m;
        let [column, row] = [(x - west) / self.land.cell_m, (y - south) / self.land.cell_m];
        // A body in an impassable cell is shut in at the foot of it.
        let at = [column, row].map(cell_of);
        let ground_m = if self.class(at) == Some(BLOCKED) { 0.0 } else { self.top_m(at) };
        [column, row, z + ground_m + self.shadow.antenna_m]
    }

    /// Off the map the land is as low as its lowest class.
    fn top_m(&self, at: [i64; 2]) -> f64 {
        match self.class(at) {
            Some(BLOCKED) => self.shadow.wall_m,
            Some(class) => f64::from(class - 1) * self.shadow.class_m,
            None => 0.0,
        }
    }

    fn class(&self, [x, y]: [i64; 2]) -> Option<u8> {
        let cell = Cell::new(i16::try_from(x).ok()?, i16::try_from(y).ok()?);
        self.land.index(cell).map(|index| self.land.cells()[index])
    }
}

fn cell_of(at: f64) -> i64 {
    libm::floor(at) as i64
}

/// Where a line crosses the borders of cells along one axis, as shares of its length.
struct Crossings {
    next: f64,
    every: f64,
    step: i64,
}

impl Crossings {
    fn new(from: f64, way: f64) -> Self {
        let every = 1.0 / way.abs();
        let over = from - libm::floor(from);
        let border = if way > 0.0 { 1.0 - over } else { over };
        let next = if way == 0.0 { f64::INFINITY } else { border * every };
        Self { next, every, step: if way > 0.0 { 1 } else { -1 } }
    }

    /// Crosses a border. Returns the step to the next cell.
    fn go_on(&mut self) -> i64 {
        self.next += self.every;
        self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHADOW: Shadow = Shadow { class_m: 0.5, antenna_m: 0.5, wall_m: f64::INFINITY };

    fn valley(classes: &[u8]) -> Terrain {
        Terrain::from_cells(classes.len() as u16, 1, classes.to_vec()).expect("cells")
    }

    fn sees(classes: &[u8], shadow: Shadow) -> bool {
        let land = valley(classes);
        let last = classes.len() as f64 - 0.5;
        let hills = shadow.over(Some(&land)).expect("land");
        let (one, other) = ([0.5, 0.5, 0.0], [last, 0.5, 0.0]);
        assert_eq!(hills.are_below(one, other), hills.are_below(other, one));
        hills.are_below(one, other)
    }

    #[test]
    fn a_hill_between_two_robots_hides_them_if_it_is_higher_than_the_line_between_their_antennas() {
        assert!(sees(&[1, 1, 1, 1, 1], SHADOW));
        assert!(sees(&[1, 1, 2, 1, 1], SHADOW), "as high as the antennas");
        assert!(!sees(&[1, 1, 3, 1, 1], SHADOW));
        assert!(sees(&[3, 1, 3, 1, 3], SHADOW), "from hill to hill");
        assert!(sees(&[9, 1, 1, 1, 1], SHADOW), "its own hill does not count");
        assert!(sees(&[9, 5, 1, 1, 1], SHADOW), "the line falls as fast as the land");
        assert!(!sees(&[9, 8, 1, 1, 1], SHADOW));
        assert!(!sees(&[1, 1, BLOCKED, 1, 1], SHADOW));
        assert!(sees(&[1, 1, BLOCKED, 1, 1], Shadow { wall_m: 0.5, ..SHADOW }));
        assert!(sees(&[1, 9], SHADOW), "robots in neighbouring cells hear each other");
        assert!(sees(&[9, 1, 5, 1, 9], Shadow { wall_m: 0.5, ..SHADOW }), "hills may be higher than walls");
    }

    #[test]
    fn bodies_above_the_land_see_over_it() {
        let land = valley(&[1, 1, 9, 1, 1]);
        let hills = SHADOW.over(Some(&land)).expect("land");
        let sees_from = |z: f64| hills.are_below([0.5, 0.5, z], [4.5, 0.5, z]);
        assert_eq!([3.4, 3.6].map(sees_from), [false, true]);
    }

    #[test]
    fn without_land_nothing_is_in_the_way() {
        assert!(SHADOW.over(None).is_none());
    }

    proptest! {
        /// Beside a walk in small steps, which may miss a corner that it steps over.
        #[test]
        fn the_walk_from_cell_to_cell_agrees_with_small_steps(
            classes in proptest::collection::vec(1..=9_u8, 64),
            ends in any::<[[u16; 2]; 2]>(),
        ) {
            let land = Terrain::from_cells(8, 8, classes).expect("cells");
            let hills = SHADOW.over(Some(&land)).expect("land");
            let [from_m, to_m] = ends.map(|[x, y]| [f64::from(x) / 8192.0, f64::from(y) / 8192.0, 0.0]);
            let is_below = hills.are_below(from_m, to_m);
            let [start, end] = [from_m, to_m].map(|at_m| hills.place(at_m));
            let cells = [start, end].map(|[x, y, _]| [x, y].map(cell_of));
            let hidden = (0..=4000).any(|step| {
                let share = f64::from(step) / 4000.0;
                let [x, y, z] = [0, 1, 2].map(|axis| start[axis] + share * (end[axis] - start[axis]));
                let cell = [x, y].map(cell_of);
                !cells.contains(&cell) && hills.top_m(cell) > z + 1e-9
            });
            prop_assert!(!(hidden && is_below), "a hidden robot is heard");
            // Small steps miss at most a corner.
            prop_assert!(is_below || hidden || hills.grazes(start, end), "a visible robot is not heard");
            prop_assert!(is_below == hills.are_below(to_m, from_m) || hills.grazes(start, end));
        }
    }

    impl Hills<'_> {
        /// Whether the line passes a cell for less than a small step, or touches its top.
        fn grazes(&self, start: [f64; 3], end: [f64; 3]) -> bool {
            let near = |at: f64| (at - at.round()).abs() < 5e-3;
            (0..=4000).any(|step| {
                let share = f64::from(step) / 4000.0;
                let [x, y, z] = [0, 1, 2].map(|axis| start[axis] + share * (end[axis] - start[axis]));
                let top = self.top_m([x, y].map(cell_of));
                near(x) && near(y) || (top - z).abs() < 5e-3
            })
        }
    }
}
