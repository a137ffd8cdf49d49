//! The square root of an `f32` on parts with an FPU, in half of the instructions of libm's, which
//! computes with integers. (`core` does not offer the FPU's own root without unsafe code.)

/// The correctly rounded root, hence the bits of `libm::sqrtf`.
pub(super) fn sqrtf(x: f32) -> f32 {
    const HALF_BIAS: u32 = 0x1FC0_0000;
    /// Balances the error of the guess: at most 3.5 %.
    const LESS: u32 = 0x0004_C000;
    /// The next error lies between 0 and 6.4e-4; slightly less than a half balances it.
    const BALANCED: f32 = 0.499_84;
    const EXPONENT: u32 = 0x7F80_0000;
    const ONE: u32 = 0x0080_0000;
    let bits = x.to_bits();
    if bits.wrapping_sub(ONE) >= EXPONENT - ONE {
        return special(x);
    }
    // Heron's method. The second step is within one unit in the last place.
    let half = (bits >> 1).wrapping_add(HALF_BIAS);
    let guess = f32::from_bits(half.wrapping_sub(LESS));
    let root = (guess + x / guess) * BALANCED;
    let root = ((root + x / root) * 0.5).to_bits();
    // As integers, root^2 and x differ by less than 2^31: the lower halves show by how much.
    let integer = root.wrapping_sub(half & EXPONENT).wrapping_add(ONE);
    let square = if bits & ONE == 0 { bits << 24 } else { bits << 23 };
    let left = square.wrapping_sub(integer.wrapping_mul(integer)).cast_signed();
    let integer = integer.cast_signed();
    let (up, down) = (u32::from(left > integer), u32::from(left.wrapping_add(integer) <= 0));
    f32::from_bits(root.wrapping_add(up).wrapping_sub(down))
}

/// Zeros, subnormal numbers, infinities, negative numbers and NaN.
#[cold]
#[inline(never)]
fn special(x: f32) -> f32 {
    if x > 0.0 && x < f32::MIN_POSITIVE {
        // 2^24 and 2^-12.
        sqrtf(x * 16_777_216.0) * (1.0 / 4_096.0)
    } else if x >= 0.0 {
        x
    } else {
        f32::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(bits: u32) {
        let x = f32::from_bits(bits);
        let (root, exact) = (sqrtf(x), libm::sqrtf(x));
        assert!(root.to_bits() == exact.to_bits() || root.is_nan() && exact.is_nan(), "{x:e}: {root:e}, {exact:e}");
    }

    #[test]
    fn root_is_correctly_rounded_for_all_fractions() {
        // A root depends on the fraction and on whether the exponent is odd.
        (0x3F80_0000..0x4080_0000).for_each(check);
    }

    #[test]
    fn root_is_correctly_rounded_for_all_exponents_and_special_values() {
        for exponent in 0..512 {
            for fraction in [0, 1, 2, 0x1234, 0x35_04F3, 0x35_04F4, 0x40_0000, 0x7F_FFFE, 0x7F_FFFF] {
                check(exponent << 23 | fraction);
            }
        }
    }
}
