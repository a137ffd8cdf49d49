//! The zone that one robot or obstacle keeps free around itself, and the steps around it.

use super::{Model, TOLERANCE_MM};
use crate::body::Body;
use crate::geom::{Vec2, Vec3};
use crate::neighbor::{Nearby, tie};
use crate::obstacle::Obstacle;
use crate::robot::RobotId;
use crate::scalar::Scalar;

/// The side on which to pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Side {
    /// By the rule of the model: the side that the step already favours.
    Rule,
    /// The other side: the larger angle, or sideways to the left.
    Left,
    /// Sideways to the right, for model 1 only.
    Right,
}

/// All sides in the order of trying.
pub const SIDES: [Side; 3] = [Side::Rule, Side::Left, Side::Right];

/// Relative to the robot's centre, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape<S> {
    /// Around a robot, a ball or the end of a wall.
    Ball { center: Vec3<S>, radius: S, otherwise: Otherwise<S> },
    /// Behind a plane: a half-space or the side of a wall.
    Half { normal: Vec3<S>, room: S },
}

/// The exit from the exact centre of a ball; a tie takes a sine and is rarely needed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Otherwise<S> {
    Way(Vec3<S>),
    /// Backwards, or east if the robot stands still.
    Back(Vec3<S>),
    Tie(RobotId, RobotId),
}

impl<S: Scalar> Otherwise<S> {
    /// Not inlined: it has few and distant callers.
    #[inline(never)]
    fn way(self) -> Vec3<S> {
        match self {
            Self::Way(way) => way,
            Self::Back(velocity) => {
                let east = Vec3::new(S::ONE, S::ZERO, S::ZERO);
                (-velocity).normalized().unwrap_or(east)
            }
            Self::Tie(own, other) => tie(own, other).extend(S::ZERO),
        }
    }
}

/// A region that a robot's centre should stay out of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Zone<S> {
    shape: Shape<S>,
    /// Only the horizontal part of a step matters.
    pub(super) is_upright: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Path<S> {
    step: Vec3<S>,
    direction: Option<Vec3<S>>,
    length: S,
}

impl<S: Scalar> Path<S> {
    pub(super) fn new(step: Vec3<S>) -> Self {
        Self { step, direction: step.normalized(), length: step.norm() }
    }
}

impl<S: Scalar> Zone<S> {
    /// Around another robot: `min_distance_m`, at least both radii. `None` for the robot itself.
    #[must_use]
    pub fn of_robot(other: &Nearby<S>, body: &Body<S>, min_distance_m: S) -> Option<Self> {
        let radii = body.radius_m + other.radius_m;
        let is_sound = other.offset_m.is_finite() && other.id != body.id;
        is_sound.then(|| Self {
            shape: Shape::Ball {
                center: other.offset_m,
                radius: at_least(min_distance_m, radii),
                otherwise: Otherwise::Tie(body.id, other.id),
            },
            is_upright: false,
        })
    }

    /// Around the part of an obstacle that is nearest to `step`: `min_distance_m`, at least the own
    /// radius, from its border. `None` if it is not finite.
    #[must_use]
    pub fn of_obstacle(obstacle: &Obstacle<S>, body: &Body<S>, min_distance_m: S, step: Vec3<S>) -> Option<Self> {
        let margin = at_least(min_distance_m, body.radius_m);
        let (shape, is_upright) = match *obstacle {
            Obstacle::Ball { center_m, radius_m } => {
                let is_sound = center_m.is_finite() && radius_m >= S::ZERO && radius_m.is_finite();
                let shape = Shape::Ball {
                    center: center_m,
                    radius: radius_m + margin,
                    otherwise: Otherwise::Back(body.velocity_mps),
                };
                (is_sound.then_some(shape)?, false)
            }
            Obstacle::Plane { normal, distance_m } => {
                let shape = Shape::Half { normal: normal.normalized()?, room: distance_m - margin };
                (distance_m.is_finite().then_some(shape)?, false)
            }
            Obstacle::Wall(ends) => (wall(ends, margin, step.xy())?, true),
        };
        Some(Self { shape, is_upright })
    }

    /// How deep `step` leads into the zone, metres; not above 0 if it does not. If the robot is
    /// already too near, the deepest point counts, or the end of a step that leads out.
    #[must_use]
    pub fn depth(&self, step: Vec3<S>) -> S {
        let step = self.part(step);
        match self.shape {
            Shape::Half { normal, room } => -(room + step.dot(normal)),
            Shape::Ball { center, radius, .. } => radius - (center - deepest(center, radius, &Path::new(step))).norm(),
        }
    }

    pub(super) fn depth_from(&self, path: &Path<S>, floor: S) -> S {
        let depth = match self.shape {
            Shape::Ball { center, radius, .. } if !self.is_upright => {
                let way = center - deepest(center, radius, path);
                // Most zones are far away: no root needed.
                let border = Vec3::new((radius - floor).max(S::ZERO), S::ZERO, S::ZERO);
                if way.length_key() > border.length_key() {
                    return floor;
                }
                radius - way.norm()
            }
            _ => self.depth(path.step),
        };
        depth.max(floor)
    }

    /// The step around the zone; `None` if the model has none on that side.
    #[must_use]
    pub fn evade(&self, step: Vec3<S>, model: Model, side: Side) -> Option<Vec3<S>> {
        let part = self.part(step);
        let evading = match (model, self.shape) {
            (Model::Radial, _) if side == Side::Left => Some(sideways(part)),
            (Model::Radial, _) if side == Side::Right => Some(-sideways(part)),
            (Model::Radial, shape) => Some(push_radially(shape, part)),
            (Model::Tangential, _) if side == Side::Right => None,
            (Model::Tangential, shape) => turn(shape, part, side == Side::Rule),
        };
        evading.map(|evading| evading + (step - part))
    }

    fn part(&self, step: Vec3<S>) -> Vec3<S> {
        if self.is_upright { step.xy().extend(S::ZERO) } else { step }
    }
}

fn at_least<S: Scalar>(distance: S, bodies: S) -> S {
    if bodies > distance && bodies.is_finite() { bodies } else { distance }
}

/// A wall is a half-space and a post at its ends; takes the nearer one to the step.
fn wall<S: Scalar>([a, b]: [Vec2<S>; 2], margin: S, step: Vec2<S>) -> Option<Shape<S>> {
    let is_sound = a.is_finite() && b.is_finite();
    if !is_sound {
        return None;
    }
    let east = Vec2::new(S::ONE, S::ZERO);
    let along = (b - a).normalized().unwrap_or(east);
    let left = along.perp();
    let normal = if a.dot(left) > S::ZERO { -left } else { left };
    let room = (-a).dot(normal);
    let after = room + step.dot(normal);
    // The end of the step, or where it crosses the wall's line.
    let part = if after < S::ZERO { room.checked_div(room - after).unwrap_or(S::ZERO) } else { S::ONE };
    let at = (step * part - a).dot(along);
    if at >= S::ZERO && at <= (b - a).norm() {
        return Some(Shape::Half { normal: normal.extend(S::ZERO), room: room - margin });
    }
    let end = if at < S::ZERO { a } else { b };
    Some(Shape::Ball { center: end.extend(S::ZERO), radius: margin, otherwise: Otherwise::Way(normal.extend(S::ZERO)) })
}

/// The point of the step nearest to the centre, or its end if the robot is inside and moves out.
fn deepest<S: Scalar>(center: Vec3<S>, radius: S, path: &Path<S>) -> Vec3<S> {
    let Some(direction) = path.direction else {
        return Vec3::ZERO;
    };
    let along = center.dot(direction).clamp(S::ZERO, path.length);
    let goes_deeper = along > S::ZERO;
    if !goes_deeper && center.norm() < radius { path.step } else { direction * along }
}

/// Of the same length, to the left in the plane; east for a vertical step.
fn sideways<S: Scalar>(step: Vec3<S>) -> Vec3<S> {
    let left = step.xy().perp().normalized();
    let left = left.unwrap_or(Vec2::new(S::ONE, S::ZERO));
    left.extend(S::ZERO) * step.norm()
}

fn is_straight<S: Scalar>(across: Vec3<S>, step: Vec3<S>) -> bool {
    across.norm() <= step.norm() * S::from_ratio(1, 100)
}

fn push_radially<S: Scalar>(shape: Shape<S>, step: Vec3<S>) -> Vec3<S> {
    // A robot on the border counts as outside.
    let inside = -S::from_milli(TOLERANCE_MM);
    match shape {
        Shape::Half { normal, room } => {
            let inwards = step.dot(normal);
            let is_straight = is_straight(step - normal * inwards, step);
            if inwards < S::ZERO && is_straight && room >= inside {
                return sideways(step);
            }
            step - normal * (room + inwards)
        }
        Shape::Ball { center, radius, otherwise } => {
            let Some(ahead) = center.normalized() else {
                return otherwise.way() * radius;
            };
            let distance = center.norm();
            let inwards = step.dot(ahead);
            if distance - radius < inside {
                let point = if inwards > S::ZERO { Vec3::ZERO } else { step };
                let away = (point - center).normalized().unwrap_or(-ahead);
                return center + away * radius;
            }
            if inwards > S::ZERO && is_straight(step - ahead * inwards, step) {
                return sideways(step);
            }
            let point = deepest(center, radius, &Path::new(step)) - center;
            let away = point.normalized().unwrap_or(-ahead);
            // The border beyond the tangent point cannot be reached in a straight line.
            let horizon = radius.checked_div(distance).unwrap_or(S::ONE);
            if -away.dot(ahead) < horizon {
                // On the border the tangent point is here: along it, as far as pushed.
                let gap = distance - radius;
                let reach = match gap < -inside {
                    true => (center + away * radius).norm(),
                    false => (gap * (distance + radius)).sqrt(),
                };
                let direction = step.normalized().unwrap_or(ahead);
                if let Some(tangent) = turn(shape, direction * reach, true) {
                    return tangent;
                }
            }
            center + away * radius
        }
    }
}

/// To the border at the same length, by the smaller angle or on the other side.
fn turn<S: Scalar>(shape: Shape<S>, step: Vec3<S>, is_smaller: bool) -> Option<Vec3<S>> {
    let direction = step.normalized()?;
    let length = step.norm();
    let (axis, along) = match shape {
        Shape::Half { normal, room } => (normal, (-room).clamp(-length, length)),
        Shape::Ball { center, radius, otherwise } => {
            let axis = center.normalized().unwrap_or_else(|| -otherwise.way());
            (axis, length * cosine(center.norm(), radius, length))
        }
    };
    let across = direction - axis * direction.dot(axis);
    let across = if is_straight(across, direction) { sideways(direction) } else { across.normalized()? };
    // The rounding error of a nearly straight step along the axis would lead in.
    let across = (across - axis * across.dot(axis)).normalized()?;
    let width = ((length - along) * (length + along)).sqrt();
    let width = if is_smaller { width } else { -width };
    Some(axis * along + across * width)
}

/// Of the angle between the centre at `distance` and a step that ends on the border or touches it.
fn cosine<S: Scalar>(distance: S, radius: S, length: S) -> S {
    // A robot on the border counts as outside: a chord would lead in.
    let gap = distance - radius;
    let gap = if gap < S::ZERO && gap >= -S::from_milli(TOLERANCE_MM) { S::ZERO } else { gap };
    let sum = distance + radius;
    let over = |x: S| x.checked_div(distance);
    if gap >= S::ZERO && length * length >= gap * sum {
        let squared = over(gap).zip(over(sum)).map(|(a, b)| a * b);
        return squared.unwrap_or(S::ZERO).sqrt();
    }
    // (s^2 + D^2 - R^2) / (2 s D), in factors that do not overflow.
    let terms = || {
        let near = over(length)? * S::HALF;
        let far = gap.checked_div(length)? * over(sum)? * S::HALF;
        Some(near + far)
    };
    terms().map_or(-S::ONE, |cos| cos.clamp(-S::ONE, S::ONE))
}
