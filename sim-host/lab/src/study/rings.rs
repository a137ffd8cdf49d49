//! Rings of a lattice of triangles whose links have the length 1.

/// A place at the origin, and rings of a lattice around it.
pub(super) fn rings([first, last]: [u32; 2]) -> impl Iterator<Item = [f64; 2]> {
    std::iter::once(0).chain(first..=last).flat_map(ring)
}

/// Places of ring `number` of a lattice, `number` links from the origin. Ring after ring, each
/// place has as many neighbours before it as possible.
pub(super) fn ring(number: u32) -> impl Iterator<Item = [f64; 2]> {
    let corner = move |side: u32| {
        let (sin, cos) = libm::sincos(f64::from(side) * std::f64::consts::FRAC_PI_3);
        [cos, sin].map(|c| c * f64::from(number))
    };
    let along = move |side: u32, step: u32| {
        let share = f64::from(step) / f64::from(number.max(1));
        let (from, to) = (corner(side), corner(side + 1));
        [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * share)
    };
    // A side begins after its first corner, which the side before has.
    let sides = (0..6).flat_map(move |side| (1..=number).map(move |step| along(side, step)));
    sides.chain((number == 0).then_some([0.0; 2]))
}
