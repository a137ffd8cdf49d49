//! `f32` and `f64` through libm: software routines, hence the same bits on every target.

use super::{NumberFormat, Scalar, sealed};
use libm::sqrt;

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
use super::root::sqrtf;
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
use libm::sqrtf;

macro_rules! impl_scalar {
    ($float:ident, $format:ident, $nan_bits:expr, $floor:ident, $round:ident, $sqrt:ident, $sincos:ident, $atan2:ident, $exp:ident, $log:ident) => {
        impl sealed::Sealed for $float {}

        impl Scalar for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const PI: Self = core::$float::consts::PI;
            const EPSILON: Self = $float::EPSILON;
            const MAX: Self = $float::MAX;
            const FORMAT: NumberFormat = NumberFormat::$format;

            fn from_i32(value: i32) -> Self {
                value as $float
            }

            fn from_ratio(numerator: i32, denominator: i32) -> Self {
                // Not through f64: that would link its software division into firmware.
                numerator as $float / denominator as $float
            }

            fn from_milli(milli: i32) -> Self {
                milli as $float / 1e3
            }

            fn from_micro(micro: i32) -> Self {
                micro as $float / 1e6
            }

            fn to_milli(self) -> Option<i32> {
                (!self.is_nan()).then(|| libm::$round(self * 1e3) as i32)
            }

            fn from_f64(value: f64) -> Option<Self> {
                let nearest = value as $float;
                (!value.is_nan()).then(|| nearest.clamp(-$float::MAX, $float::MAX))
            }

            fn to_f64(self) -> f64 {
                self.into()
            }

            fn from_f32(value: f32) -> Option<Self> {
                let nearest = $float::from(value);
                (!value.is_nan()).then(|| nearest.clamp(-$float::MAX, $float::MAX))
            }

            fn to_f32(self) -> f32 {
                self as f32
            }

            fn to_bits(self) -> u64 {
                // The sign and payload of a computed NaN differ between processors.
                if self.is_nan() { $nan_bits } else { $float::to_bits(self).into() }
            }

            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }

            fn checked_div(self, other: Self) -> Option<Self> {
                let quotient = self / other;
                quotient.is_finite().then_some(quotient)
            }

            fn floor_to_i32(self) -> Option<i32> {
                let floor = libm::$floor(self);
                (-2_147_483_648.0..2_147_483_648.0).contains(&floor).then_some(floor as i32)
            }

            fn sqrt(self) -> Self {
                // Correctly rounded, so that a hardware root (VSQRT) gives the same bits.
                if self < 0.0 { 0.0 } else { $sqrt(self) }
            }

            fn sin_cos(self) -> (Self, Self) {
                libm::$sincos(self)
            }

            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }

            fn exp(self) -> Self {
                libm::$exp(self)
            }

            fn ln(self) -> Option<Self> {
                (self > 0.0).then(|| libm::$log(self))
            }

            fn norm([x, y, z]: [Self; 3]) -> Self {
                $sqrt(x * x + y * y + z * z)
            }

            fn length_key([x, y, z]: [Self; 3]) -> u64 {
                let squared = x * x + y * y + z * z;
                // The bits of non-negative floats have the order of their values.
                if squared.is_nan() { u64::MAX } else { $float::to_bits(squared).into() }
            }

            fn unit([x, y, z]: [Self; 3]) -> Option<[Self; 3]> {
                let squared = x * x + y * y + z * z;
                // A subnormal square has lost the bits that the direction needs.
                (squared.is_normal()).then(|| {
                    let scale = 1.0 / $sqrt(squared);
                    [x * scale, y * scale, z * scale]
                })
            }

            #[inline(never)]
            fn unit_in_plane(components: [Self; 2]) -> [Self; 2] {
                Self::unit_and_norm(components).0
            }

            #[inline]
            fn unit_and_norm([x, y]: [Self; 2]) -> ([Self; 2], Self) {
                const NORMAL: core::ops::RangeInclusive<$float> = $float::MIN_POSITIVE..=$float::MAX;
                let squared = x * x + y * y;
                let norm = $sqrt(squared);
                let unit = if NORMAL.contains(&squared) {
                    let scale = 1.0 / norm;
                    [x * scale, y * scale]
                } else {
                    [0.0; 2]
                };
                (unit, norm)
            }
        }
    };
}

impl_scalar!(f32, F32, 0x7FC0_0000, floorf, roundf, sqrtf, sincosf, atan2f, expf, logf);
impl_scalar!(f64, F64, 0x7FF8_0000_0000_0000, floor, round, sqrt, sincos, atan2, exp, log);
