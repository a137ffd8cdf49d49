//! How a robot that flies is turned: along its velocity (OLF section VIII.C).

use super::{length, squared};

/// The columns r1, r2, r3 of a rotation: where a body's own axes forward, left and up point in the world.
///
/// r1 is the direction of the velocity, r2 level and to its left, r3 = r1 x r2: the paper's r2 = (0, 0, 1) x r1, of length 1.
/// Straight up or down left is north. `None` for a robot that stands or whose velocity is not finite.
#[must_use]
pub fn attitude(velocity_mps: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    // Speeds whose squares are too small or too large for a number, too.
    let largest = velocity_mps.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    if !(largest > 0.0 && velocity_mps.iter().all(|c| c.is_finite())) {
        return None;
    }
    let unit = |vector: [f64; 3]| {
        let long = length(vector);
        vector.map(|c| c / long)
    };
    let r1 = unit(velocity_mps.map(|c| c / largest));
    let level = [-r1[1], r1[0], 0.0];
    let r2 = if squared(level) > 0.0 { unit(level) } else { [0.0, 1.0, 0.0] };
    let r3 = std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        r1[next] * r2[last] - r1[last] * r2[next]
    });
    Some([r1, r2, r3])
}
