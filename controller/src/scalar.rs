//! The one numeric trait.
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
}

/// The one numeric trait.
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
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// An integer; saturates.
    fn from_i32(value: i32) -> Self;
    /// `self / other`, or `None` for division by zero or a non-finite result.
    fn checked_div(self, other: Self) -> Option<Self>;
    /// The greatest integer not above `self`; `None` when it is not finite or does not fit.
    fn floor_to_i32(self) -> Option<i32>;
    /// From thousandths (mm, mm/s); saturates.
    fn from_milli(milli: i32) -> Self;
    /// To thousandths, rounded to nearest, saturating; NaN gives `None`.
    fn to_milli(self) -> Option<i32>;
    /// Finite.
    fn is_finite(self) -> bool;
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const HALF: Self = 0.5;
    fn from_i32(value: i32) -> Self {
        value as f32
    }
    fn checked_div(self, other: Self) -> Option<Self> {
        let q = self / other;
        q.is_finite().then_some(q)
    }
    fn floor_to_i32(self) -> Option<i32> {
        let f = libm::floorf(self);
        (f >= -2147483648.0 && f < 2147483648.0).then_some(f as i32)
    }
    fn from_milli(milli: i32) -> Self {
        milli as f32 / 1000.0
    }
    fn to_milli(self) -> Option<i32> {
        (!self.is_nan()).then(|| libm::roundf(self * 1000.0) as i32)
    }
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
}
