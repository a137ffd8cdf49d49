//! Q16.16: fixed point for parts without an FPU. Integers only, without overflow.

use super::integer::{bow_q32, log2_q32, polynomial_q30};
use super::{NumberFormat, Scalar, sealed};
use core::num::NonZeroU64;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number from -32768 to 32767.99998 in steps of 2^-16 (0.000015), saturating everywhere;
/// products are rounded to nearest. There is neither NaN nor infinity: [`Scalar::is_finite`] is
/// always true.
///
/// Errors against exact functions, each beside the half step of rounding: `sqrt` and `norm` one
/// step (rounded down); `sin_cos`, `atan2`, `ln` one step; `exp` a factor of 1 + 1e-8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Q16(i32);

impl Q16 {
    /// The number `bits` / 65536.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// The number times 65536.
    #[must_use]
    pub const fn bits(self) -> i32 {
        self.0
    }

    fn saturating(bits: i64) -> Self {
        Self::from_bits(bits.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
    }

    fn wide(self) -> i64 {
        self.bits().into()
    }
}

impl Serialize for Q16 {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_i32(self.bits())
    }
}

impl<'de> Deserialize<'de> for Q16 {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        i32::deserialize(deserializer).map(Self::from_bits)
    }
}

#[cfg(feature = "fixed")]
impl From<fixed::types::I16F16> for Q16 {
    fn from(value: fixed::types::I16F16) -> Self {
        Self(value.to_bits())
    }
}

#[cfg(feature = "fixed")]
impl From<Q16> for fixed::types::I16F16 {
    fn from(value: Q16) -> Self {
        Self::from_bits(value.0)
    }
}

impl Add for Q16 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Q16 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Mul for Q16 {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // To nearest: a product that is rounded down would let positions drift.
        Self::saturating((self.wide() * other.wide() + (1 << 15)) >> 16)
    }
}

impl Neg for Q16 {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl AddAssign for Q16 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Q16 {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Q16 {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Q16 {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{}", self.to_f32());
    }
}

impl sealed::Sealed for Q16 {}

impl Scalar for Q16 {
    const ZERO: Self = Self::from_bits(0);
    const ONE: Self = Self::from_bits(1 << 16);
    const TWO: Self = Self::from_bits(2 << 16);
    const HALF: Self = Self::from_bits(1 << 15);
    const PI: Self = Self::from_bits(205_887);
    const EPSILON: Self = Self::from_bits(1);
    const MAX: Self = Self::from_bits(i32::MAX);
    const FORMAT: NumberFormat = NumberFormat::Q16;

    fn from_i32(value: i32) -> Self {
        Self::saturating(i64::from(value) << 16)
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        quotient(numerator, denominator)
            .map_or_else(|| Self::from_i32(numerator.saturating_mul(1 << 16)), Self::saturating)
    }

    fn from_milli(milli: i32) -> Self {
        // 65.536 in Q31; below the limit the product stays under 2^62.
        const STEPS_Q31: i64 = 140_737_488_355;
        let milli = i64::from(milli).clamp(-32_768_000, 32_768_000);
        Self::saturating((milli * STEPS_Q31 + (1 << 30)) >> 31)
    }

    fn from_micro(micro: i32) -> Self {
        const STEPS_Q34: i64 = 1_125_899_907;
        Self::saturating((i64::from(micro) * STEPS_Q34 + (1 << 33)) >> 34)
    }

    fn to_milli(self) -> Option<i32> {
        i32::try_from((self.wide() * 1000 + (1 << 15)) >> 16).ok()
    }

    fn from_f64(value: f64) -> Option<Self> {
        (!value.is_nan()).then(|| Self::from_bits(libm::round(value * 65_536.0) as i32))
    }

    fn to_f64(self) -> f64 {
        f64::from(self.bits()) / 65_536.0
    }

    fn from_f32(value: f32) -> Option<Self> {
        (!value.is_nan()).then(|| Self::from_bits(libm::roundf(value * 65_536.0) as i32))
    }

    fn to_f32(self) -> f32 {
        self.bits() as f32 / 65_536.0
    }

    fn to_bits(self) -> u64 {
        self.bits().cast_unsigned().into()
    }

    fn is_finite(self) -> bool {
        true
    }

    fn checked_div(self, other: Self) -> Option<Self> {
        let bits = quotient(self.bits(), other.bits())?;
        Some(Self::from_bits(i32::try_from(bits).ok()?))
    }

    fn floor_to_i32(self) -> Option<i32> {
        Some(self.bits() >> 16)
    }

    fn sqrt(self) -> Self {
        let radicand = u64::from(self.bits().max(0).cast_unsigned()) << 16;
        Self::from_bits(radicand.isqrt() as i32) // Below 2^24.
    }

    fn sin_cos(self) -> (Self, Self) {
        // 1 / (2 pi) in Q48: the product counts turns in Q64, and whole turns wrap away.
        const TURNS_Q48: i64 = 44_798_133_900_177;
        let turns_q32 = (self.wide().wrapping_mul(TURNS_Q48).cast_unsigned() >> 32) as u32;
        let f = i64::from(turns_q32 & 0x3FFF_FFFF);
        let (rising, falling) = (sin_quarter(f), sin_quarter((1 << 30) - f));
        match turns_q32 >> 30 {
            0 => (rising, falling),
            1 => (falling, -rising),
            2 => (-rising, -falling),
            _ => (-falling, rising),
        }
    }

    fn atan2(self, x: Self) -> Self {
        const PI_Q30: i64 = 3_373_259_426;
        let (dx, dy) = (x.bits().unsigned_abs(), self.bits().unsigned_abs());
        let Some(longer) = NonZeroU64::new(dx.max(dy).into()) else {
            return Self::ZERO;
        };
        let ratio_q31 = (u64::from(dx.min(dy)) << 31) / longer;
        let octant = atan_unit(ratio_q31.cast_signed());
        let quadrant = if dy > dx { (PI_Q30 >> 1) - octant } else { octant };
        let half = if x.bits() < 0 { PI_Q30 - quadrant } else { quadrant };
        let angle = Self::saturating((half + (1 << 13)) >> 14);
        if self.bits() < 0 { -angle } else { angle }
    }

    fn exp(self) -> Self {
        const LOG2_E_Q30: i64 = 1_549_082_005;
        // 2^(1 - x) at the Chebyshev nodes, see `bow_q32`.
        const P_Q30: [i64; 5] = [-329_480_750, -71_537_286, -11_959_599, -1_567_696, -235_034];
        let log2_q46 = self.wide() * LOG2_E_Q30;
        let fraction_q32 = (log2_q46 >> 14) & 0xFFFF_FFFF;
        let power_q32 = (1 << 32) + bow_q32(&P_Q30, fraction_q32);
        match 16 - (log2_q46 >> 46) {
            shift @ 2..=40 => Self::saturating((power_q32 + (1 << (shift - 1))) >> shift),
            shift if shift < 2 => Self::MAX,
            _ => Self::ZERO,
        }
    }

    fn ln(self) -> Option<Self> {
        const LN_2_Q30: i64 = 744_261_118;
        let bits = NonZeroU64::new(u64::try_from(self.bits()).ok()?)?;
        // From -16 to 15 in Q28: the product stays under 2^62.
        let log2_q28 = (log2_q32(bits).cast_signed() - (16 << 32)) >> 4;
        Some(Self::saturating((log2_q28 * LN_2_Q30 + (1 << 41)) >> 42))
    }

    fn norm(components: [Self; 3]) -> Self {
        Self::saturating(Self::length_key(components).isqrt().cast_signed())
    }

    fn length_key(components: [Self; 3]) -> u64 {
        // At most 3 * 2^62.
        let squares = components.map(|c| u64::from(c.bits().unsigned_abs()).pow(2));
        squares.iter().sum()
    }

    fn unit(components: [Self; 3]) -> Option<[Self; 3]> {
        // The longest component has 31 bits: squares fit, and short vectors keep their precision.
        let all = components.map(|c| c.bits().unsigned_abs()).iter().fold(0, |a, b| a | b);
        let shift = all.leading_zeros();
        if all == 0 {
            return None;
        }
        let wide = components.map(|c| (c.wide() << shift) >> 1);
        let squares = wide.map(|c| c.unsigned_abs().pow(2));
        // From 2^30 to sqrt 3 * 2^31.
        let norm = NonZeroU64::new(squares.iter().sum::<u64>().isqrt())?;
        let inverse_q62 = ((1 << 62) / norm).cast_signed();
        Some(wide.map(|c| Self::saturating((c * inverse_q62 + (1 << 45)) >> 46)))
    }
}

/// In steps of 2^-16, rounded to nearest.
fn quotient(numerator: i32, denominator: i32) -> Option<i64> {
    let denominator_abs = NonZeroU64::new(denominator.unsigned_abs().into())?;
    let halves = (u64::from(numerator.unsigned_abs()) << 17) / denominator_abs;
    let magnitude = ((halves + 1) >> 1).cast_signed();
    let negative = (numerator < 0) != (denominator < 0);
    Some(if negative { -magnitude } else { magnitude })
}

/// sin(pi/2 f) for `f` in Q30, 0..=1; off by less than 7e-9 before rounding.
fn sin_quarter(f_q30: i64) -> Q16 {
    // f p(f^2), p interpolates at the Chebyshev nodes.
    const P_Q30: [i64; 5] = [1_686_629_706, -693_598_305, 85_566_398, -5_018_824, 162_856];
    let sine_q30 = (f_q30 * polynomial_q30(&P_Q30, (f_q30 * f_q30) >> 28)) >> 30;
    Q16::saturating((sine_q30 + (1 << 13)) >> 14)
}

/// atan(r) in Q30 for `r` in Q31, 0..=1; off by less than 5e-7.
fn atan_unit(r_q31: i64) -> i64 {
    // r p(r^2), p interpolates at the Chebyshev nodes.
    const P_Q30: [i64; 7] =
        [1_073_740_992, -357_831_743, 213_374_408, -144_395_341, 89_256_349, -39_041_715, 8_212_357];
    (r_q31 * polynomial_q30(&P_Q30, (r_q31 * r_q31) >> 30)) >> 31
}
