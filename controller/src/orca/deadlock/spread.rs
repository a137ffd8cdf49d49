use crate::geom::Vec3;
use crate::orca::dimension::Situation;
use crate::robot::RobotId;
use crate::scalar::Scalar;

/// The wish, turned by 25 degrees to the right and, depending on the robot's number, up or down.
///
/// Applies while a robot that is at most `horizon_s` away at joint speed lies within 45 degrees of
/// the wish, and the goal is farther than that robot. This breaks the symmetry of paths that all
/// cross in one point. O(nearby).
pub fn spread<S: Scalar>(horizon_s: S, situation: &Situation<'_, Vec3<S>>) -> Vec3<S> {
    if meets_robot(horizon_s, situation) { turned(situation.body.id, situation.wish) } else { situation.wish }
}

fn meets_robot<S: Scalar>(horizon_s: S, situation: &Situation<'_, Vec3<S>>) -> bool {
    let Some(ahead) = situation.wish.normalized() else {
        return false;
    };
    let goal = situation.goal.map_or(S::MAX, Vec3::norm);
    // cos 45 degrees.
    let narrow = S::from_ratio(70_711, 100_000);
    let body = situation.body;
    situation.nearby.iter().any(|other| {
        let distance = other.offset_m.norm();
        let radii = body.radius_m + other.radius_m;
        let reach = radii + (body.max_speed_mps + other.velocity_mps.norm()) * horizon_s;
        let is_ahead = other.offset_m.dot(ahead) > narrow * distance;
        is_ahead && distance <= reach && distance < goal
    })
}

/// Turns to the right as seen from above: to the east if straight up, to the west if straight down.
fn turned<S: Scalar>(own: RobotId, wish: Vec3<S>) -> Vec3<S> {
    let (cos, sin) = (S::from_ratio(90_631, 100_000), S::from_ratio(42_262, 100_000));
    let east = if wish.z > S::ZERO { S::ONE } else { -S::ONE };
    let right = wish.cross(Vec3::new(S::ZERO, S::ZERO, S::ONE));
    let right = right.normalized().unwrap_or(Vec3::new(east, S::ZERO, S::ZERO));
    let Some(above) = right.cross(wish).normalized() else {
        return wish;
    };
    // Multiples of the golden ratio spread evenly over a turn of 2^32.
    let spread = own.0.wrapping_mul(0x9E37_79B9) >> 16;
    let share = S::from_ratio(spread.cast_signed() - (1 << 15), 1 << 16);
    let (up, level) = (share * S::PI * S::HALF).sin_cos();
    wish * cos + (right * level + above * up) * (wish.norm() * sin)
}
