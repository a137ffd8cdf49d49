//! A plane that closes around itself (V. A. Starovoitova 2018, STA, section 2.4).

use super::{Position, Vec2};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A plane without edges: a robot that leaves on one side enters on the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Torus<S> {
    /// Size along x and y, metres. An axis whose size is not above 0 does not wrap.
    pub size_m: [S; 2],
}

impl<S: Scalar> Torus<S> {
    /// The position in [0, size) along both axes, metres; 0 for NaN or 2^31 turns away.
    #[must_use]
    pub fn wrap(&self, place_m: Vec2<S>) -> Vec2<S> {
        let [width, height] = self.size_m;
        Vec2::new(wrap(place_m.x, width), wrap(place_m.y, height))
    }

    /// The shortest vector that differs from `offset_m` by whole turns. An exact half keeps its
    /// sign, so that two robots see each other in opposite directions.
    #[must_use]
    pub fn shortest(&self, offset_m: Vec2<S>) -> Vec2<S> {
        let [width, height] = self.size_m;
        Vec2::new(shortest(offset_m.x, width), shortest(offset_m.y, height))
    }

    /// The image of `place` nearest to `own`: at most half a turn away along each axis, with its
    /// height unchanged. Exact for sizes in whole millimetres.
    #[must_use]
    pub fn image(&self, place: Position, own: Position) -> Position {
        let ([x, y, z], [own_x, own_y, _]) = (place.mm, own.mm);
        let [width, height] = self.size_m;
        let near = |mm: i32, own: i32, size: S| {
            let size_mm = size.to_milli().filter(|size_mm| *size_mm > 0);
            let ahead = size_mm.and_then(|size_mm| mm.wrapping_sub(own).checked_rem_euclid(size_mm));
            let (Some(ahead), Some(size_mm)) = (ahead, size_mm) else {
                return mm;
            };
            let back = ahead.wrapping_sub(size_mm);
            // An exact half keeps its sign, as in [`Torus::shortest`].
            let is_behind = ahead > size_mm >> 1 || ahead.wrapping_add(back) == 0 && mm < own;
            own.wrapping_add(if is_behind { back } else { ahead })
        };
        Position::from_mm([near(x, own_x, width), near(y, own_y, height), z])
    }
}

fn wrap<S: Scalar>(x: S, size: S) -> S {
    let wraps = size > S::ZERO;
    if !wraps || (x >= S::ZERO && x < size) {
        return x;
    }
    let wrapped = x - size * turns(x, size);
    // Rounding may move a value just below 0 onto the far edge.
    if wrapped >= S::ZERO && wrapped < size { wrapped } else { S::ZERO }
}

fn shortest<S: Scalar>(x: S, size: S) -> S {
    let half = size * S::HALF;
    let wraps = size > S::ZERO;
    if !wraps || x.abs() <= half {
        return x;
    }
    let near = if x > S::ZERO { x - size } else { x + size };
    if near.abs() <= half {
        return near;
    }
    let from_edge = wrap(x, size);
    if from_edge > half { from_edge - size } else { from_edge }
}

/// Rounded down; 0 if they cannot be counted.
fn turns<S: Scalar>(x: S, size: S) -> S {
    let turns = x.checked_div(size).and_then(S::floor_to_i32);
    turns.map_or(S::ZERO, S::from_i32)
}
