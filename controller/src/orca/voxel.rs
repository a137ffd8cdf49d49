//! Half-planes by table lookup: the voxel template of the velocity obstacle (FVM, conclusion).
//!
//! Turned so that the neighbour is on the x axis and divided by (R_A + R_B) / tau, a velocity
//! obstacle depends only on the sine (R_A + R_B) / distance of the cone's half angle. So one table
//! of normals (cos, sin) to the nearest border, for |y|, serves every pair of robots.
//!
//! Differences to the paper:
//!
//! - Legs and disc are tangent to the unit disc, so the distance to the border is cos x + sin
//!   y - 1.
//! - The normal is constant along a ray from the disc's centre. So voxels over (sine, direction)
//!   suffice: in 2 KiB their mean angle error is 0.03 degrees, that of (sine, x, |y|) 0.18.
//! - The normal is not the R-function's gradient ([`VelocityObstacle::value`]).
//! - Each lookup interpolates four nodes. The nearest node alone has at least 40 times the error.
//!
//! **A half-plane from the table is always safe.** The looked-up normal lies between those of the
//! two legs, so its line touches the disc and has the whole obstacle behind it. An error only makes
//! the demanded change longer. The half-planes of a pair are opposite.
//!
//! [`VelocityObstacle::value`]: super::VelocityObstacle::value

mod table;
#[cfg(test)]
mod tests;

pub use table::{VelocityObstacleTable, VoxelTable2k};

use super::avoider::HalfSpaces;
use super::{HalfPlane, MovingBall, Params, half_plane};
use crate::geom::Vec2;
use crate::scalar::Scalar;
use table::ONE;

/// Like [`half_plane`], with the normal from [`VoxelTable2k`].
///
/// Overlapping robots get the analytic half-plane. `None` if an input is not finite, or r or a time
/// is not above 0. Bounded work: a search among 20 levels, and four nodes.
#[must_use]
#[inline(never)]
pub fn half_plane_from_table<S: Scalar>(
    own_velocity_mps: Vec2<S>,
    disc: &MovingBall<Vec2<S>>,
    params: &Params<S>,
) -> Option<HalfPlane<S>> {
    let analytic = || half_plane(own_velocity_mps, disc, params);
    let (p, r) = (disc.offset_m, disc.radii_m);
    let v = own_velocity_mps - disc.velocity_mps;
    let distance = p.norm();
    if !(v.is_finite() && r > S::ZERO && distance > r && params.horizon_s > S::ZERO) {
        return analytic();
    }
    let Some(ahead) = p.normalized() else {
        return analytic();
    };
    let sine = r.checked_div(distance)?;
    let rate = S::ONE.checked_div(params.horizon_s)?;
    let w = v - p * rate;
    let (along, across) = (w.dot(ahead), ahead.det(w));
    let Some(normal) = VoxelTable2k::TABLE.normal(sine, Vec2::new(along, across.abs())) else {
        return analytic();
    };
    let side = if across > S::ZERO { normal.y } else { -normal.y };
    let normal = ahead.rotate(normal.x, side);
    let u = r * rate - w.dot(normal);
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfPlane { point, normal })
}

impl<S: Scalar> HalfSpaces<S> for VoxelTable2k {
    type Velocity = Vec2<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec2<S>,
        disc: &MovingBall<Vec2<S>>,
        params: &Params<S>,
    ) -> Option<HalfPlane<S>> {
        half_plane_from_table(own_velocity_mps, disc, params)
    }
}

impl VelocityObstacleTable {
    /// The outward unit normal at the border nearest to the point `w`, w.y >= 0.
    ///
    /// The velocity obstacle has this sine of its half angle and the disc's centre as origin; the
    /// radius does not matter. `None` if an input is not finite. The x component is at most -sine.
    #[must_use]
    pub fn normal<S: Scalar>(&self, sine: S, w: Vec2<S>) -> Option<Vec2<S>> {
        let (level, up) = self.level(sine)?;
        let (direction, on) = self.direction(w)?;
        let first = level * self.directions + direction;
        let lower = self.between(first, on)?;
        let upper = self.between(first + self.directions, on)?;
        let found = unit(mix(lower, upper, up) * S::from_ratio(1, ONE))?;
        if found.x < sine {
            return Some(Vec2::new(-sine, (S::ONE - sine * sine).sqrt()));
        }
        Some(Vec2::new(-found.x, found.y))
    }

    fn level<S: Scalar>(&self, sine: S) -> Option<(usize, S)> {
        let whole = (sine * S::from_i32(ONE)).floor_to_i32()?;
        let above = self.sines.partition_point(|&s| i32::from(s) <= whole);
        let last = self.sines.len().saturating_sub(1);
        let level = above.clamp(1, last.max(1)).saturating_sub(1);
        let [low, high] = *self.sines.get(level..)?.first_chunk::<2>()?;
        let at = |sine: u16| S::from_i32(i32::from(sine)) * S::from_ratio(1, ONE);
        Some((level, (sine - at(low)).checked_div(at(high) - at(low))?))
    }

    /// Directions behind the centre, and the centre itself, count as beside it.
    fn direction<S: Scalar>(&self, w: Vec2<S>) -> Option<(usize, S)> {
        let before = (-w.x).max(S::ZERO);
        let share = before.checked_div(before + w.y).unwrap_or(S::ZERO);
        let last = i32::try_from(self.directions).ok()?.saturating_sub(1);
        let steps = share * S::from_i32(last);
        let node = steps.floor_to_i32()?.clamp(0, last.saturating_sub(1).max(0));
        Some((usize::try_from(node).ok()?, steps - S::from_i32(node)))
    }

    fn between<S: Scalar>(&self, node: usize, on: S) -> Option<Vec2<S>> {
        let [one, next] = *self.normals.get(node..)?.first_chunk::<2>()?;
        let vector = |[x, y]: [i16; 2]| Vec2::new(S::from_i32(x.into()), S::from_i32(y.into()));
        Some(mix(vector(one), vector(next), on))
    }
}

fn mix<S: Scalar>(from: Vec2<S>, to: Vec2<S>, share: S) -> Vec2<S> {
    from + (to - from) * share
}

/// Takes no root if the length is nearly 1, as it is except between distant directions.
fn unit<S: Scalar>(v: Vec2<S>) -> Option<Vec2<S>> {
    let short = S::ONE - v.norm_squared();
    if short.abs() > S::from_ratio(1, 32) {
        return v.normalized();
    }
    // (1 - short)^(-1/2) by its series; the remainder is below 3e-7.
    let cube = S::from_ratio(3, 8) + short * (S::from_ratio(5, 16) + short * S::from_ratio(35, 128));
    Some(v * (S::ONE + short * (S::HALF + short * cube)))
}
