//! Planarity of proximity graphs (OLF, theorem 4).

use crate::nearby::{Cells, Query, Search as _, Space};

/// Pairs of links that cross between their ends. `None` if a place is not in the plane, i.e. has a
/// third coordinate that is not 0. O(links x links close by).
#[must_use]
pub fn crossings<const D: usize>(places_m: &[[f64; D]], links: &[(u32, u32)]) -> Option<usize> {
    if D < 2 || places_m.iter().any(|place| place.iter().skip(2).any(|z| *z != 0.0)) {
        return None;
    }
    let at = |robot: u32| [places_m[robot as usize][0], places_m[robot as usize][1]];
    let ends: Vec<[[f64; 2]; 2]> = links.iter().map(|&(a, b)| [at(a), at(b)]).collect();
    let middle = |[a, b]: [[f64; 2]; 2]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
    let middles: Vec<[f64; 2]> = ends.iter().map(|&link| middle(link)).collect();
    let length = |[a, b]: [[f64; 2]; 2]| libm::hypot(b[0] - a[0], b[1] - a[1]);
    // The middles of links that cross are no farther apart than the longest link.
    let radius = ends.iter().map(|&link| length(link)).fold(0.0, f64::max);
    if radius == 0.0 {
        return Some(0);
    }
    let mut cells = Cells::new(Space::OPEN, radius);
    cells.rebuild(&middles);
    let (mut found, mut count) = (Vec::new(), 0);
    for (link, &at) in (0..).zip(&middles) {
        cells.within(&Query { at, radius, most: usize::MAX, except: Some(link) }, &mut found);
        let later = found.iter().filter(|other| other.index > link);
        count += later.filter(|other| cross(ends[link as usize], ends[other.index as usize])).count();
    }
    Some(count)
}

/// Whether the insides of two segments have exactly one point in common.
fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
