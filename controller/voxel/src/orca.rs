//! ORCA on functional voxel models: of a velocity obstacle ([`velocity_half_plane`]), of any pair
//! of robots ([`VoxelNeighbor`], in space [`VoxelInSpace`]), and of land or a room ([`obstacles`]).
//! Functions are positive inside the forbidden region (FVM, eq. 15).

use crate::model::{Local, Model, ModelIn};
use heapless::Vec;
use serde::Serialize;
use staya_controller::geom::{Vec2, Vec3, Vector};
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{HalfPlane, HalfSpace, HalfSpaces, InSpace, MovingBall, Params, half_plane, half_space};
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

/// Half-planes of moving neighbours from a model in borrowed bytes: `&'static [u8]` in flash.
pub type VoxelNeighbor<'a, S> = VoxelNeighborIn<&'a [u8], S>;

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
#[serde(bound = "")]
pub struct VoxelNeighborIn<B, S> {
    model: ModelIn<B, S, 3>,
}

impl<B, S> VoxelNeighborIn<B, S> {
    /// Creates a source of half-planes from this model.
    #[must_use]
    pub const fn new(model: ModelIn<B, S, 3>) -> Self {
        Self { model }
    }

    /// The model.
    #[must_use]
    pub const fn model(&self) -> &ModelIn<B, S, 3> {
        &self.model
    }
}

impl<B: AsRef<[u8]>, S: Scalar> VoxelNeighborIn<B, S> {
    /// Whether the model is defined for all pairs of robots; for others the formula is used.
    #[must_use]
    pub fn covers_all_pairs(&self) -> bool {
        let [[left, right], [bottom, top], [least, most]] = self.model.extent();
        left <= -right && right > S::ZERO && bottom <= S::ZERO && top > S::ZERO && least <= S::ZERO && most >= S::ONE
    }

    /// The half-space of a ball: a velocity obstacle in space is that of the plane, turned about
    /// the axis to the neighbour, so the normal lies in the plane of this axis and the relative
    /// velocity. Otherwise as in the plane.
    #[must_use]
    pub fn of_ball(
        &self,
        own_velocity_mps: Vec3<S>,
        ball: &MovingBall<Vec3<S>>,
        params: &Params<S>,
    ) -> Option<HalfSpace<Vec3<S>>> {
        let look_up = || {
            let Approach { ahead, w, radius, sine } = Approach::new(own_velocity_mps, ball, params)?;
            let per_radius = S::ONE.checked_div(radius)?;
            let along = w.dot(ahead);
            let across = w - ahead * along;
            // Straight towards the neighbour there is no such plane; the formula has a rule.
            let side = across.normalized()?;
            let normal = self.normal(Vec2::new(along, across.norm()) * per_radius, sine)?;
            let normal = ahead * normal.x + side * normal.y;
            let point = own_velocity_mps + normal * ((radius - w.dot(normal)) * params.share);
            point.is_finite().then_some(HalfSpace { point, normal })
        };
        look_up().or_else(|| half_space(own_velocity_mps, ball, params))
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

impl<B: AsRef<[u8]>, S: Scalar> HalfSpaces<S> for VoxelNeighborIn<B, S> {
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
            let Approach { ahead, w, radius, sine } = Approach::new(own_velocity_mps, disc, params)?;
            let per_radius = S::ONE.checked_div(radius)?;
            let across = ahead.det(w);
            let normal = self.normal(Vec2::new(w.dot(ahead), across.abs()) * per_radius, sine)?;
            let side = if across > S::ZERO { normal.y } else { -normal.y };
            let normal = ahead.rotate(normal.x, side);
            let point = own_velocity_mps + normal * ((radius - w.dot(normal)) * params.share);
            point.is_finite().then_some(HalfPlane { point, normal })
        };
        look_up().or_else(|| half_plane(own_velocity_mps, disc, params))
    }
}

/// A relative velocity as seen from the disc, or ball, of the velocities that collide just at the
/// horizon.
struct Approach<V: Vector> {
    /// Unit vector to the neighbour.
    ahead: V,
    /// From the disc's centre, m/s.
    w: V,
    /// The disc's radius, m/s.
    radius: V::Scalar,
    /// Of half of the cone's angle.
    sine: V::Scalar,
}

impl<S: Scalar, V: Vector<Scalar = S>> Approach<V> {
    /// `None` if the robots overlap or an input is invalid.
    fn new(own_velocity_mps: V, ball: &MovingBall<V>, params: &Params<S>) -> Option<Self> {
        let (p, r) = (ball.offset_m, ball.radii_m);
        let v = own_velocity_mps - ball.velocity_mps;
        let distance = p.norm();
        let is_sound = v.is_finite() && r > S::ZERO && distance > r && params.horizon_s > S::ZERO;
        let ahead = if is_sound { p.normalized()? } else { return None };
        let rate = S::ONE.checked_div(params.horizon_s)?;
        Some(Self { ahead, w: v - p * rate, radius: r * rate, sine: r.checked_div(distance)? })
    }
}

/// Half-spaces of flying neighbours from the same model ([`VoxelNeighborIn::of_ball`]): the method
/// does not depend on the number of dimensions (FVM, conclusion).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(bound(serialize = "S: Serialize"))]
pub struct VoxelInSpace<B, S> {
    /// The model.
    pub neighbor: VoxelNeighborIn<B, S>,
    /// The space.
    pub space: InSpace<S>,
}

impl<B: AsRef<[u8]>, S: Scalar> HalfSpaces<S> for VoxelInSpace<B, S> {
    type Velocity = Vec3<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec3<S>,
        ball: &MovingBall<Vec3<S>>,
        params: &Params<S>,
    ) -> Option<HalfSpace<Vec3<S>>> {
        self.space.stretched(own_velocity_mps, ball, |own, ball| self.neighbor.of_ball(own, ball, params))
    }

    fn downwash(&self) -> S {
        HalfSpaces::<S>::downwash(&self.space)
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
