use crate::geom::Vec2;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;

const PURPOSE: u32 = 0x7469_6573; // "ties"

/// Returns the direction in which robot `own` moves if `other` is at exactly the same position: a
/// unit vector in the plane, opposite for the other robot; zero if both ids are equal. It depends
/// on the pair, so several robots at one position do not form a line. Constant work.
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
    fn a_pair_separates_in_opposite_directions_that_differ_between_pairs() {
        let (a, b, c) = (RobotId(3), RobotId(9), RobotId(4));
        let way = tie::<f64>(a, b);
        assert!((way.norm() - 1.0).abs() < 1e-12);
        assert_eq!(tie::<f64>(b, a), -way);
        assert_eq!(tie::<f64>(a, a), Vec2::ZERO);
        assert!((tie::<f64>(a, c) - way).norm() > 0.01);
        let fixed = tie::<Q16>(a, b);
        assert!((fixed.x.to_f64() - way.x).abs() < 1e-4 && (fixed.y.to_f64() - way.y).abs() < 1e-4);
    }

    #[test]
    fn the_directions_of_many_pairs_cover_half_a_turn_evenly() {
        let mut counts = [0; 4];
        for other in 2..402 {
            let way = tie::<f64>(RobotId(1), RobotId(other));
            let angle = libm::atan2(way.y, way.x) / core::f64::consts::PI;
            assert!((0.0..1.0).contains(&angle), "{angle}");
            counts[(angle * 4.0) as usize] += 1;
        }
        assert!(counts.iter().all(|count| (70..130).contains(count)), "{counts:?}");
    }
}
