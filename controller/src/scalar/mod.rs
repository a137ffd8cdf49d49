//! The numeric trait of the controller, and the four types that implement it.
//!
//! `f32` is the default, `f64` the reference, [`Q16`] serves parts without an FPU, and [`Fast32`]
//! trades accuracy for time. All use the same software routines on every target, and so compute
//! identical bits.
//!
//! NaN fails closed: it passes through arithmetic, `min`, `max` and `clamp` unchanged, is the last
//! in [`Scalar::order`], and conversions to integers return `None`.

#[cfg(feature = "micromath")]
mod fast;
mod fixed;
mod float;
pub(crate) mod integer;
#[cfg(any(test, all(target_arch = "arm", target_abi = "eabihf")))]
mod root;
#[cfg(all(test, feature = "micromath"))]
mod tests;

#[cfg(feature = "micromath")]
pub use fast::Fast32;
pub use fixed::Q16;

use crate::names::named;
use core::cmp::Ordering;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use serde::Serialize;
use serde::de::DeserializeOwned;

named! {
    /// The implementations of [`Scalar`] by name, for scenario files, options and devices.
    #[derive(Default)]
    pub enum NumberFormat {
        /// `f32`.
        #[default]
        F32 = "f32",
        /// [`Q16`], fixed point.
        Q16 = "q16",
        /// `Fast32`, `f32` with approximate functions (feature `micromath`).
        Fast32 = "fast32",
        /// `f64`, the reference.
        F64 = "f64",
    }
}

mod sealed {
    pub trait Sealed {}
}

/// A real number of limited range and precision; sealed. There is no `Div`: the caller must handle
/// a division by zero where it occurs ([`Scalar::checked_div`]).
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Serialize
    + DeserializeOwned
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 1/2.
    const HALF: Self;
    /// Half a turn, radians.
    const PI: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The largest finite number; its negative is in range too.
    const MAX: Self;
    /// The format's name.
    const FORMAT: NumberFormat;
    /// Whether precision is relative, so that squares are as precise as lengths.
    const IS_FLOATING: bool = !matches!(Self::FORMAT, NumberFormat::Q16);

    /// An integer, rounded to nearest; saturates.
    #[must_use]
    fn from_i32(value: i32) -> Self;

    /// The fraction `numerator / denominator`, saturating; in f32, integers above 2^24 are rounded
    /// first. A zero denominator gives an infinity or NaN, in fixed point ±[`Scalar::MAX`].
    #[must_use]
    fn from_ratio(numerator: i32, denominator: i32) -> Self;

    /// From thousandths (mm, mm/s); saturates.
    #[must_use]
    fn from_milli(milli: i32) -> Self;

    /// From millionths (a time in microseconds to seconds).
    #[must_use]
    fn from_micro(micro: i32) -> Self;

    /// To thousandths, rounded to nearest, saturating; NaN gives `None`.
    #[must_use]
    fn to_milli(self) -> Option<i32>;

    /// The nearest number, saturating; NaN gives `None`. Slow without a double-precision FPU.
    #[must_use]
    fn from_f64(value: f64) -> Option<Self>;

    /// The exact value, for hosts.
    #[must_use]
    fn to_f64(self) -> f64;

    /// The nearest number, saturating; NaN gives `None`. Uses integers and single precision only.
    #[must_use]
    fn from_f32(value: f32) -> Option<Self>;

    /// The nearest `f32`.
    #[must_use]
    fn to_f32(self) -> f32;

    /// The bits, for hashes: equal for equal states on every target (there is one NaN).
    #[must_use]
    fn to_bits(self) -> u64;

    /// Neither NaN nor infinite.
    #[must_use]
    fn is_finite(self) -> bool;

    /// `self / other`; `None` when `other` is zero or the result is not finite or out of range.
    #[must_use]
    fn checked_div(self, other: Self) -> Option<Self>;

    /// The greatest integer not above `self`; `None` when it is NaN or does not fit.
    #[must_use]
    fn floor_to_i32(self) -> Option<i32>;

    /// The square root; a negative number (usually a rounding error) counts as 0.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);

    /// The angle of the vector (`x`, `self`) on [-pi, pi], radians; 0 for the zero vector.
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// e to the power of `self`; too large: infinity, in fixed point [`Scalar::MAX`].
    #[must_use]
    fn exp(self) -> Self;

    /// The natural logarithm; `None` unless `self` is more than 0.
    #[must_use]
    fn ln(self) -> Option<Self>;

    /// Length of the vector. Fixed point: exact to one bit and saturating, though the squares do
    /// not fit; floats: infinite beyond 1e19 (f32).
    #[must_use]
    fn norm(components: [Self; 3]) -> Self;

    /// An integer that grows with the length, without a root or overflow; `u64::MAX` for NaN.
    #[must_use]
    fn length_key(components: [Self; 3]) -> u64;

    /// The vector of length 1 with the same direction, to the full precision of the type; `None`
    /// for the zero vector (floats: also below 2e-19) and if a component is not finite.
    #[must_use]
    fn unit(components: [Self; 3]) -> Option<[Self; 3]>;

    /// [`Scalar::unit`] in the plane; zeros instead of `None`.
    #[must_use]
    fn unit_in_plane([x, y]: [Self; 2]) -> [Self; 2] {
        Self::unit([x, y, Self::ZERO]).map_or([Self::ZERO; 2], |[x, y, _]| [x, y])
    }

    /// [`Scalar::unit_in_plane`] and [`Scalar::norm`] of one vector, with one root.
    #[must_use]
    fn unit_and_norm([x, y]: [Self; 2]) -> ([Self; 2], Self) {
        (Self::unit_in_plane([x, y]), Self::norm([x, y, Self::ZERO]))
    }

    /// The magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The smaller one; NaN if either is.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if is_nan(self) || self < other { self } else { other }
    }

    /// The larger one; NaN if either is.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if is_nan(self) || self > other { self } else { other }
    }

    /// The nearest number in [`low`, `high`]; `high` when the interval is empty, NaN for NaN.
    #[must_use]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// A total order by value with NaN last, so that an unknown value is never the least.
    #[must_use]
    fn order(self, other: Self) -> Ordering {
        self.partial_cmp(&other).unwrap_or_else(|| is_nan(self).cmp(&is_nan(other)))
    }
}

/// The nearest number of another scalar type, via `f32`; NaN becomes 0.
#[must_use]
pub fn cast<S: Scalar, T: Scalar>(x: S) -> T {
    T::from_f32(x.to_f32()).unwrap_or(T::ZERO)
}

#[expect(clippy::eq_op, reason = "only NaN differs from itself")]
fn is_nan<S: Scalar>(x: S) -> bool {
    x != x
}
