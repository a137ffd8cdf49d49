//! Vectors in the plane and in space. Degenerate geometry is a value, never a NaN in disguise.

use crate::scalar::Scalar;
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec2<S> {
    /// East.
    pub x: S,
    /// North.
    pub y: S,
}

/// A vector in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<S> {
    /// East.
    pub x: S,
    /// North.
    pub y: S,
    /// Up.
    pub z: S,
}

impl<S> Vec2<S> {
    /// The vector with these components.
    #[must_use]
    pub const fn new(x: S, y: S) -> Self {
        Self { x, y }
    }
}

impl<S> Vec3<S> {
    /// The vector with these components.
    #[must_use]
    pub const fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }
}

/// What both kinds of vectors can do, written once over their components.
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

            /// Squared length; fixed point saturates from a length of 181 on: compare with
            /// [`Self::length_key`].
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

            /// The vector of length 1 with the same direction; `None` for the zero vector and when
            /// a component is not finite ([`Scalar::unit`]).
            #[must_use]
            pub fn normalized(self) -> Option<Self> {
                let [x, y, z] = S::unit(self.padded())?;
                Some(Vec3::new(x, y, z).into())
            }

            /// The vector itself if it is at most `max` long, else shortened to `max`.
            ///
            /// Zero when a component is not finite or `max` is not positive: a command that makes
            /// no sense moves nobody.
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

/// Drops the height.
impl<S: Scalar> From<Vec3<S>> for Vec2<S> {
    fn from(v: Vec3<S>) -> Self {
        v.xy()
    }
}

impl<S: Scalar> Vec2<S> {
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
