//! Vectors in the plane and in space. Degenerate geometry gives `None` or a defined value.

use crate::scalar::{Scalar, cast};
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};
use serde::{Deserialize, Serialize};

mod position;
mod torus;

pub use position::Position;
pub use torus::Torus;

/// A vector in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vec2<S> {
    /// East.
    pub x: S,
    /// North.
    pub y: S,
}

/// A vector in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vec3<S> {
    /// East.
    pub x: S,
    /// North.
    pub y: S,
    /// Up.
    pub z: S,
}

impl<S> Vec2<S> {
    /// Creates a vector from its components.
    #[must_use]
    pub const fn new(x: S, y: S) -> Self {
        Self { x, y }
    }
}

impl<S> Vec3<S> {
    /// Creates a vector from its components.
    #[must_use]
    pub const fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }
}

/// The operations that algorithms of any dimension need of [`Vec2`] and [`Vec3`].
#[expect(missing_docs, reason = "the vectors' own methods document them")]
pub trait Vector:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<Self::Scalar, Output = Self>
{
    type Scalar: Scalar;
    const ZERO: Self;
    fn dot(self, other: Self) -> Self::Scalar;
    fn norm(self) -> Self::Scalar;
    fn normalized(self) -> Option<Self>;
    fn unit_and_norm(self) -> (Option<Self>, Self::Scalar);
    fn clamp_norm(self, max: Self::Scalar) -> Self;
    fn is_finite(self) -> bool;
}

macro_rules! impl_vector {
    ($vector:ident { $($c:ident),+ }, $padded:expr) => {
        impl<S: Scalar> $vector<S> {
            /// The zero vector.
            pub const ZERO: Self = Self { $($c: S::ZERO),+ };

            fn padded(self) -> [S; 3] {
                $padded(self)
            }

            /// Scalar product. Fixed point saturates in each term.
            #[must_use]
            pub fn dot(self, other: Self) -> S {
                let mut sum = S::ZERO;
                $(sum += self.$c * other.$c;)+
                sum
            }

            /// Squared length; fixed point saturates from 181 on (see [`Self::length_key`]).
            #[must_use]
            pub fn norm_squared(self) -> S {
                self.dot(self)
            }

            /// Length, without intermediate overflow in fixed point ([`Scalar::norm`]).
            #[must_use]
            pub fn norm(self) -> S {
                S::norm(self.padded())
            }

            /// An integer that grows with the length; NaN is the longest ([`Scalar::length_key`]).
            #[must_use]
            pub fn length_key(self) -> u64 {
                S::length_key(self.padded())
            }

            /// The vector, shortened to `max` if it is longer. Zero if a component is not finite or
            /// `max` is not positive, so that an invalid command causes no motion.
            #[must_use]
            pub fn clamp_norm(self, max: S) -> Self {
                let sensible = self.is_finite() && max > S::ZERO;
                if sensible && self.norm() <= max {
                    self
                } else {
                    let unit = self.normalized().filter(|_| sensible);
                    unit.map_or(Self::ZERO, |unit| unit * max)
                }
            }

            /// Whether all components are finite.
            #[must_use]
            pub fn is_finite(self) -> bool {
                $(self.$c.is_finite())&&+
            }
        }

        impl<S: Scalar> Vector for $vector<S> {
            type Scalar = S;
            const ZERO: Self = Self::ZERO;

            #[inline]
            fn dot(self, other: Self) -> S {
                self.dot(other)
            }

            #[inline]
            fn norm(self) -> S {
                self.norm()
            }

            #[inline]
            fn normalized(self) -> Option<Self> {
                self.normalized()
            }

            #[inline]
            fn unit_and_norm(self) -> (Option<Self>, S) {
                self.unit_and_norm()
            }

            #[inline]
            fn clamp_norm(self, max: S) -> Self {
                self.clamp_norm(max)
            }

            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }

        impl<S: Scalar> Add for $vector<S> {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self { $($c: self.$c + other.$c),+ }
            }
        }

        impl<S: Scalar> Sub for $vector<S> {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self { $($c: self.$c - other.$c),+ }
            }
        }

        impl<S: Scalar> Neg for $vector<S> {
            type Output = Self;
            fn neg(self) -> Self {
                Self { $($c: -self.$c),+ }
            }
        }

        impl<S: Scalar> Mul<S> for $vector<S> {
            type Output = Self;
            fn mul(self, factor: S) -> Self {
                Self { $($c: self.$c * factor),+ }
            }
        }

        impl<S: Scalar> AddAssign for $vector<S> {
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<S: Scalar> SubAssign for $vector<S> {
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
    };
}

impl_vector!(Vec2 { x, y }, |v: Vec2<S>| [v.x, v.y, S::ZERO]);
impl_vector!(Vec3 { x, y, z }, |v: Vec3<S>| [v.x, v.y, v.z]);

impl<S: Scalar> From<Vec3<S>> for Vec2<S> {
    fn from(v: Vec3<S>) -> Self {
        v.xy()
    }
}

impl<S: Scalar> Vec2<S> {
    /// The vector of length 1 with the same direction, if one exists ([`Scalar::unit`]).
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        let [x, y] = S::unit_in_plane([self.x, self.y]);
        Some(Self { x, y }).filter(|unit| *unit != Self::ZERO)
    }

    /// [`Self::normalized`] and [`Self::norm`], with one root.
    #[must_use]
    pub fn unit_and_norm(self) -> (Option<Self>, S) {
        let ([x, y], norm) = S::unit_and_norm([self.x, self.y]);
        (Some(Self { x, y }).filter(|unit| *unit != Self::ZERO), norm)
    }

    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Vec2<T> {
        Vec2 { x: cast(self.x), y: cast(self.y) }
    }

    /// Determinant of the columns `self`, `other`: positive when `other` points to the left.
    #[must_use]
    pub fn det(self, other: Self) -> S {
        self.x * other.y - self.y * other.x
    }

    /// The vector turned by a quarter to the left.
    #[must_use]
    pub fn perp(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// The vector turned counter-clockwise by the angle with this cosine and sine.
    #[must_use]
    pub fn rotate(self, cos: S, sin: S) -> Self {
        Self::new(self.x * cos - self.y * sin, self.x * sin + self.y * cos)
    }

    /// The vector in space above this one.
    #[must_use]
    pub const fn extend(self, z: S) -> Vec3<S> {
        Vec3::new(self.x, self.y, z)
    }
}

impl<S: Scalar> Vec3<S> {
    /// The vector of length 1 with the same direction, if one exists ([`Scalar::unit`]).
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        S::unit(self.padded()).map(|[x, y, z]| Self { x, y, z })
    }

    /// [`Self::normalized`] and [`Self::norm`].
    #[must_use]
    pub fn unit_and_norm(self) -> (Option<Self>, S) {
        (self.normalized(), self.norm())
    }

    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Vec3<T> {
        Vec3 { x: cast(self.x), y: cast(self.y), z: cast(self.z) }
    }

    /// Converts from thousandths, such as millimetres to metres.
    #[must_use]
    pub fn from_milli(milli: [i32; 3]) -> Self {
        let [x, y, z] = milli.map(S::from_milli);
        Self::new(x, y, z)
    }

    /// Vector product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// The vector in the plane below this one.
    #[must_use]
    pub const fn xy(self) -> Vec2<S> {
        Vec2::new(self.x, self.y)
    }
}

#[cfg(all(test, feature = "micromath"))]
mod tests {
    use super::*;
    use crate::scalar::{Fast32, Q16};
    use proptest::prelude::*;

    fn vec2<S: Scalar>(x: f64, y: f64) -> Option<Vec2<S>> {
        Some(Vec2::new(S::from_f64(x)?, S::from_f64(y)?))
    }

    #[test]
    fn zero_vector_has_no_direction() {
        fn check<S: Scalar>() {
            assert_eq!(Vec2::<S>::ZERO.normalized(), None);
            assert_eq!(Vec3::<S>::ZERO.normalized(), None);
            assert_eq!(Vec2::<S>::ZERO.norm(), S::ZERO);
            assert_eq!(Vec2::<S>::ZERO.clamp_norm(S::ONE), Vec2::ZERO);
        }
        check::<f32>();
        check::<f64>();
        check::<Q16>();
        check::<Fast32>();
    }

    #[test]
    fn invalid_vectors_and_limits_clamp_to_zero() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let v = Vec3::new(1.0, bad, 0.0);
            assert!(!v.is_finite() && v.normalized().is_none());
            assert_eq!(v.clamp_norm(1.0), Vec3::ZERO);
        }
        let v = Vec2::new(1.0f32, 0.0);
        for limit in [0.0, -1.0, f32::NAN] {
            assert_eq!(v.clamp_norm(limit), Vec2::ZERO);
        }
        assert_eq!(v.clamp_norm(f32::INFINITY), v);
        // The square overflows: no direction, hence no motion.
        assert_eq!(Vec2::new(1e30f32, 0.0).clamp_norm(1.0), Vec2::ZERO);
    }

    #[test]
    fn fixed_point_lengths_survive_the_overflow_of_squares() {
        let v = vec2::<Q16>(12_000.0, -16_000.0).map(Vec2::norm);
        assert_eq!(v, Some(Q16::from_i32(20_000)));
        let corner = Vec3::new(Q16::MAX, Q16::MAX, Q16::MAX);
        assert_eq!(corner.norm(), Q16::MAX);
        assert_eq!(corner.norm_squared(), Q16::MAX);
        let third = 1.0 / 3f64.sqrt();
        let error = |unit: Vec3<Q16>| (unit.x.to_f64() - third).abs();
        assert!(corner.normalized().is_some_and(|unit| error(unit) < 8e-6));
    }

    #[test]
    fn quarter_turns_are_counter_clockwise() {
        let east = Vec2::new(1.0f32, 0.0);
        let north = Vec2::new(0.0, 1.0);
        assert_eq!(east.perp(), north);
        assert_eq!(east.rotate(0.0, 1.0), north);
        assert_eq!((east.det(north), north.det(east)), (1.0, -1.0));
        let up = Vec3::new(0.0, 0.0, 1.0);
        assert_eq!(east.extend(0.0).cross(north.extend(0.0)), up);
        assert_eq!(up.xy(), Vec2::ZERO);
    }

    #[test]
    fn places_far_from_the_origin_differ_by_exact_millimetres() {
        fn check<S: Scalar>() {
            let here = Position::from_mm([1_000_000_000, -1_000_000_000, 7]);
            let there = Position::from_mm([1_000_000_001, -1_000_002_000, 7]);
            let way = there.since::<S>(here);
            assert_eq!([way.x, way.y, way.z].map(S::to_milli), [Some(1), Some(-2000), Some(0)]);
            assert_eq!(here.moved(way), Some(there));
        }
        check::<f32>();
        check::<f64>();
        check::<Q16>();
        assert_eq!(Position::ORIGIN.moved(Vec3::new(f32::NAN, 0.0, 0.0)), None);
        let edge = Position::from_metres([1e9, -1e9, 0.001]);
        assert_eq!(edge, Some(Position::from_mm([i32::MAX, i32::MIN, 1])));
    }

    #[test]
    fn operators_work_by_component() {
        let (a, b) = (Vec3::new(1.0f64, 2.0, 3.0), Vec3::new(0.5, -4.0, 8.0));
        assert_eq!(a + b, Vec3::new(1.5, -2.0, 11.0));
        assert_eq!(a - b, Vec3::new(0.5, 6.0, -5.0));
        assert_eq!(-a * 2.0, Vec3::new(-2.0, -4.0, -6.0));
        assert_eq!(a.dot(b), 16.5);
        let mut c = a;
        c += b;
        c -= a;
        assert_eq!(c, b);
    }

    fn agrees<S: Scalar>(v: [f64; 2], w: [f64; 2], tolerance: f64) -> Result<(), TestCaseError> {
        let [Some(p), Some(q)] = [v, w].map(|[x, y]| vec2::<S>(x, y)) else {
            return Err(TestCaseError::reject("not a number"));
        };
        let [a, b] = [p, q].map(|v| Vec2::new(v.x.to_f64(), v.y.to_f64()));
        let near = |got: S, exact: f64, scale: f64| {
            let error = (got.to_f64() - exact).abs();
            prop_assert!(error <= tolerance * scale.max(1.0), "{got:?} {exact} {error:e}");
            Ok(())
        };
        let (long, wide) = (a.norm(), b.norm());
        near(p.norm(), long, long)?;
        near(p.dot(q), a.dot(b), long * wide)?;
        near(p.det(q), a.det(b), long * wide)?;
        near((p + q).norm(), (a + b).norm(), long + wide)?;
        if let Some(unit) = p.normalized() {
            near(unit.norm(), 1.0, 1.0)?;
            near(unit.det(p), 0.0, long)?;
        }
        let limit = S::TWO;
        let clamped = p.clamp_norm(limit);
        near(clamped.norm(), long.min(2.0), 2.0)?;
        near(clamped.det(p), 0.0, long)?;
        let (sin, cos) = q.x.sin_cos();
        let turned = p.rotate(cos, sin);
        near(turned.norm(), long, long)?;
        near(turned.dot(q.rotate(cos, sin)), a.dot(b), long * wide)?;
        near(p.perp().dot(p), 0.0, long * long)?;
        let (p3, q3) = (p.extend(S::ONE), q.extend(-S::ONE));
        let cross = p3.cross(q3);
        near(cross.dot(p3), 0.0, (long + 1.0) * (long + 1.0) * (wide + 1.0))
    }

    proptest! {
        #[test]
        fn f32_agrees_with_f64(v: [i16; 2], w: [i16; 2]) {
            let [v, w] = [v, w].map(|v| v.map(|c| f64::from(c) / 7.0));
            agrees::<f32>(v, w, 1e-6)?;
        }

        #[test]
        fn f64_is_consistent(v: [i16; 2], w: [i16; 2]) {
            let [v, w] = [v, w].map(|v| v.map(|c| f64::from(c) / 7.0));
            agrees::<f64>(v, w, 1e-14)?;
        }

        #[test]
        fn q16_agrees_with_f64(v: [i8; 2], w: [i8; 2]) {
            // Products of three lengths stay in range; six steps of 2^-16 add up.
            let [v, w] = [v, w].map(|v| v.map(|c| f64::from(c) / 14.0));
            agrees::<Q16>(v, w, 1e-4)?;
        }

        #[test]
        fn fast32_agrees_with_f64(v: [i16; 2], w: [i16; 2]) {
            let [v, w] = [v, w].map(|v| v.map(|c| f64::from(c) / 7.0));
            agrees::<Fast32>(v, w, 1e-2)?;
        }

        #[test]
        fn clamped_vectors_are_finite_for_any_bits(bits: [u32; 3], limit: u32) {
            let [x, y, z] = bits.map(f32::from_bits);
            let clamped = Vec3::new(x, y, z).clamp_norm(f32::from_bits(limit));
            prop_assert!(clamped.is_finite());
        }
    }
}
