//! Attitude of a flying robot that points along its velocity (OLF section VIII.C).

use super::{length, squared};

/// Columns r1, r2, r3 of the rotation from body axes (forward, left, up) to world axes. r1 points
/// along the velocity, r2 is level and to its left ((0, 0, 1) x r1, normalised; north in vertical
/// flight), and r3 = r1 x r2. `None` if the robot is stationary or its velocity is not finite.
#[must_use]
pub fn attitude(velocity_mps: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    // Scaling avoids overflow and underflow of squares.
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
