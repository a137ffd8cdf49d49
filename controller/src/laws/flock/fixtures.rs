//! Values of the flocks' tests.

use crate::body::Body;
use crate::geom::Vec3;
use crate::neighbor::Nearby;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;

pub(crate) fn number<S: Scalar>(value: f64) -> S {
    S::from_f64(value).unwrap()
}

pub(crate) fn vec3<S: Scalar>([x, y, z]: [f64; 3]) -> Vec3<S> {
    Vec3::new(number(x), number(y), number(z))
}

pub(crate) fn exact<S: Scalar>(v: Vec3<S>) -> Vec3<f64> {
    Vec3::new(v.x.to_f64(), v.y.to_f64(), v.z.to_f64())
}

pub(crate) fn body<S: Scalar>(velocity: [f64; 3]) -> Body<S> {
    Body {
        id: RobotId(1),
        velocity_mps: vec3(velocity),
        radius_m: S::ZERO,
        max_speed_mps: S::from_i32(100),
        max_acceleration_mps2: S::MAX,
        step_s: number(0.02),
    }
}

pub(crate) fn near<S: Scalar>(id: u32, offset: [f64; 3], velocity: [f64; 3]) -> Nearby<S> {
    Nearby {
        id: RobotId(id),
        offset_m: vec3(offset),
        velocity_mps: vec3(velocity),
        radius_m: S::ZERO,
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    }
}
