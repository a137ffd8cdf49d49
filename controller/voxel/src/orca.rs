//! ORCA on functional voxel models: of a velocity obstacle ([`velocity_half_plane`]), of any pair
//! of robots ([`VoxelNeighbor`]), and of land or a room ([`obstacles`]). Functions are positive
//! inside the forbidden region (FVM, eq. 15).

use crate::model::{Local, Model};
use heapless::Vec;
use serde::Serialize;
use staya_controller::geom::Vec2;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{HalfPlane, HalfSpaces, MovingBall, Params, half_plane};
use staya_controller::scalar::Scalar;

/// ORCA's half-plane from the model of a velocity obstacle over relative velocities, m/s (FVM, eqs.
/// 12, 14 and 17): the shortest path out by the local plane, of which the robot makes `share`.
///
/// `None` where the model is undefined, or the function is level. Unlike [`VoxelNeighbor`] it
/// trusts the function to forbid the whole obstacle. Work: [`Model::blend`].
#[must_use]
pub fn velocity_half_plane<S: Scalar>(
    obstacle: &Model<'_, S, 2>,
    own_velocity_mps: Vec2<S>,
    relative_mps: Vec2<S>,
    share: S,
) -> Option<HalfPlane<S>> {
    let local = obstacle.blend([relative_mps.x, relative_mps.y])?;
    let normal = -local.direction()?;
    let point = own_velocity_mps + normal * (local.distance()? * share);
    point.is_finite().then_some(HalfPlane { point, normal })
}

/// Half-planes of moving neighbours from a model of all velocity obstacles
/// (`staya voxel build neighbor`), for an [`Avoider`](staya_controller::orca::Avoider).
///
/// Turned so that the neighbour is on the x axis, with the disc as unit disc, a velocity obstacle
/// depends only on its half angle. The model's variables are the velocity along and beside that
/// axis (without its mirror image), and the tangent of half of the half angle, in which the legs
/// turn evenly; over the sine, errors are twice as large.
///
/// **Each half-plane is safe for any content of the model**: the model's normal (eq. 17) is limited
/// to lie between those of the two legs, and the border touches the disc. An error only makes the
/// demanded change of velocity longer. The half-planes of a pair are opposite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VoxelNeighbor<'a, S: Scalar> {
    model: Model<'a, S, 3>,
}

impl<'a, S: Scalar> VoxelNeighbor<'a, S> {
    /// Creates a source of half-planes from this model.
    #[must_use]
    pub const fn new(model: Model<'a, S, 3>) -> Self {
        Self { model }
    }

    /// The model.
    #[must_use]
    pub const fn model(&self) -> &Model<'a, S, 3> {
        &self.model
    }

    /// The normal at the border nearest to `w`, in disc radii from the disc's centre, `w.y >= 0`.
    fn normal(&self, w: Vec2<S>, sine: S) -> Option<Vec2<S>> {
        let cos = (S::ONE - sine * sine).sqrt();
        let opening = sine.checked_div(S::ONE + cos)?;
        let [[_, right], [_, top], _] = self.model.extent();
        // Along the line to the centre the normal is constant.
        let times = w.x.abs().checked_div(right)?.max(w.y.checked_div(top)?);
        let w = if times > S::ONE { w * S::ONE.checked_div(times)? } else { w };
        let Local { gradient: [x, y, _], .. } =
            self.model.blend([w.x.clamp(-right, right), w.y.min(top), opening.min(S::ONE)])?;
        let normal = -Vec2::new(x, y).normalized()?;
        if normal.y < S::ZERO {
            return Some(Vec2::new(-S::ONE, S::ZERO));
        }
        let is_past_leg = normal.x > -sine;
        Some(if is_past_leg { Vec2::new(-sine, cos) } else { normal })
    }
}

impl<S: Scalar> HalfSpaces<S> for VoxelNeighbor<'_, S> {
    type Velocity = Vec2<S>;

    /// Overlapping robots have no cone: use the formula.
    #[inline(never)]
    fn half_space(
        &self,
        own_velocity_mps: Vec2<S>,
        disc: &MovingBall<Vec2<S>>,
        params: &Params<S>,
    ) -> Option<HalfPlane<S>> {
        let look_up = || {
            let (p, r) = (disc.offset_m, disc.radii_m);
            let v = own_velocity_mps - disc.velocity_mps;
            let distance = p.norm();
            let is_sound = v.is_finite() && r > S::ZERO && distance > r && params.horizon_s > S::ZERO;
            let ahead = if is_sound { p.normalized()? } else { return None };
            let rate = S::ONE.checked_div(params.horizon_s)?;
            let radius = r * rate;
            let per_radius = S::ONE.checked_div(radius)?;
            let w = v - p * rate;
            let across = ahead.det(w);
            let normal = self.normal(Vec2::new(w.dot(ahead), across.abs()) * per_radius, r.checked_div(distance)?)?;
            let side = if across > S::ZERO { normal.y } else { -normal.y };
            let normal = ahead.rotate(normal.x, side);
            let point = own_velocity_mps + normal * ((radius - w.dot(normal)) * params.share);
            point.is_finite().then_some(HalfPlane { point, normal })
        };
        look_up().or_else(|| half_plane(own_velocity_mps, disc, params))
    }
}

/// Number of directions that [`obstacles`] probes, in addition to the robot's own position.
pub const PROBES: usize = 8;

/// The obstacles around a robot from a model of land or a room, metres: planes, nearest first.
///
/// In a corner the nearest border is not enough, so the model is also evaluated at [`PROBES`]
/// points at the distance `reach_m` (the distance covered in a step or two, plus the radius; a
/// larger value detects corners sooner). A plane found there that is nearer than the nearest border
/// is ignored: it only touches something round, and would forbid free space.
///
/// `None` where the model is undefined: stop, or use a larger model. Work: nine times
/// [`Model::blend`].
#[must_use]
pub fn obstacles<S: Scalar>(
    model: &Model<'_, S, 2>,
    position_m: Vec2<S>,
    reach_m: S,
) -> Option<Vec<Obstacle<S>, { PROBES + 1 }>> {
    let plane = |offset: Vec2<S>| {
        let at = position_m + offset;
        let local = model.blend([at.x, at.y])?;
        let normal = -local.direction()?;
        let distance = -local.distance()? - offset.dot(normal);
        Some((normal, distance))
    };
    let (normal, nearest) = plane(Vec2::ZERO)?;
    let mut found = Vec::<(Vec2<S>, S), { PROBES + 1 }>::new();
    insert(&mut found, (normal, nearest));
    let diagonal = S::from_ratio(70_711, 100_000);
    let (one, zero) = (S::ONE, S::ZERO);
    for (x, y) in [
        (one, zero),
        (diagonal, diagonal),
        (zero, one),
        (-diagonal, diagonal),
        (-one, zero),
        (-diagonal, -diagonal),
        (zero, -one),
        (diagonal, -diagonal),
    ] {
        let Some((normal, distance)) = plane(Vec2::new(x, y) * reach_m) else {
            continue;
        };
        let is_behind = distance >= nearest - reach_m * S::from_ratio(1, 64);
        let is_new = found.iter().all(|(other, _)| other.dot(normal) < S::from_ratio(99, 100));
        if is_behind && is_new {
            insert(&mut found, (normal, distance));
        }
    }
    let mut planes = Vec::new();
    for &(normal, distance_m) in &found {
        let _ = planes.push(Obstacle::Plane { normal: normal.extend(S::ZERO), distance_m });
    }
    Some(planes)
}

/// Inserts a plane behind nearer ones. `swap` and `sort` would leave panics in firmware.
fn insert<S: Scalar, const N: usize>(found: &mut Vec<(Vec2<S>, S), N>, plane: (Vec2<S>, S)) {
    let _ = found.push(plane);
    let mut at = found.len().saturating_sub(1);
    while let Some(before) = at.checked_sub(1)
        && let Some([nearer, farther]) = found.get_mut(before..=at)
        && farther.1 < nearer.1
    {
        core::mem::swap(nearer, farther);
        at = before;
    }
}
