//! Distance functions of simple shapes, positive inside.

use crate::Function;

/// The half-plane to the left of a directed line through two different points.
#[must_use]
pub fn left_of(from: [f64; 2], to: [f64; 2]) -> Function<2> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = libm::hypot(dx, dy);
    Function::new(move |[x, y]| (dx * (y - from[1]) - dy * (x - from[0])) / length)
}

/// A disc.
#[must_use]
pub fn circle(center: [f64; 2], radius: f64) -> Function<2> {
    Function::new(move |[x, y]| radius - libm::hypot(x - center[0], y - center[1]))
}

/// A ball.
#[must_use]
pub fn ball(center: [f64; 3], radius: f64) -> Function<3> {
    Function::new(move |[x, y, z]| radius - libm::hypot(libm::hypot(x - center[0], y - center[1]), z - center[2]))
}

/// A simple polygon, convex or not, with corners in either direction.
#[must_use]
pub fn polygon(corners: Vec<[f64; 2]>) -> Function<2> {
    Function::new(move |at| {
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        let (mut nearest, mut is_inside) = (f64::INFINITY, false);
        for (from, to) in ends {
            nearest = nearest.min(to_segment(at, *from, *to));
            let is_between = (from[1] > at[1]) != (to[1] > at[1]);
            if is_between && at[0] < from[0] + (at[1] - from[1]) / (to[1] - from[1]) * (to[0] - from[0]) {
                is_inside = !is_inside;
            }
        }
        if is_inside { nearest } else { -nearest }
    })
}

fn to_segment(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let (x, y) = (at[0] - from[0], at[1] - from[1]);
    let share = ((x * dx + y * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    libm::hypot(x - share * dx, y - share * dy)
}
