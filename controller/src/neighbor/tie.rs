//! Which way to go when two robots are in the same place.

use crate::geom::Vec2;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;

const PURPOSE: u32 = 0x7469_6573; // "ties"

/// The way that robot `own` goes when `other` is in the very same place: a unit vector in the plane, the opposite
/// one for the other robot, so that the pair comes apart without a word. Zero for a robot and itself.
///
/// Each pair has its own direction: several robots in one place do not end up in a line. Constant work.
#[must_use]
pub fn tie<S: Scalar>(own: RobotId, other: RobotId) -> Vec2<S> {
    const STEPS: i32 = 1 << 15;
    let (low, high) = (own.0.min(other.0), own.0.max(other.0));
    if low == high {
        return Vec2::ZERO;
    }
    let draw = Rng::keyed(0, PURPOSE, low, high).below(STEPS.unsigned_abs());
    let (sin, cos) = (S::PI * S::from_ratio(draw.cast_signed(), STEPS)).sin_cos();
    let way = Vec2::new(cos, sin);
    if own.0 == low { way } else { -way }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Q16;

    #[test]
    fn the_two_of_a_pair_go_opposite_ways_and_pairs_differ() {
        let (a, b, c) = (RobotId(3), RobotId(9), RobotId(4));
        let way = tie::<f64>(a, b);
        assert!((way.norm() - 1.0).abs() < 1e-12);
        assert_eq!(tie::<f64>(b, a), -way);
        assert_eq!(tie::<f64>(a, a), Vec2::ZERO);
        assert!((tie::<f64>(a, c) - way).norm() > 0.01);
        let fixed = tie::<Q16>(a, b);
        assert!((fixed.x.to_f64() - way.x).abs() < 1e-4 && (fixed.y.to_f64() - way.y).abs() < 1e-4);
    }
}
