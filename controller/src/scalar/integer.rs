//! Integer kernels: polynomials and the binary logarithm, for fixed point and random numbers.

use core::num::NonZeroU64;

/// Coefficients in Q30 (constant term first), `x` in Q32, 0..=1; partial sums must stay below 2.
pub(super) fn polynomial_q30(coefficients: &[i64], x_q32: i64) -> i64 {
    coefficients.iter().rev().fold(0, |sum, c| c + ((sum * x_q32) >> 32))
}

/// x + x (1 - x) p(x) in Q32: exact at both ends, so that pieces join without a step.
pub(super) fn bow_q32(p_q30: &[i64], x_q32: i64) -> i64 {
    let hump = (x_q32 * ((1 << 32) - x_q32)) >> 32;
    x_q32 + ((hump * polynomial_q30(p_q30, x_q32)) >> 30)
}

/// log2(k) in Q6.32, off by less than 8e-6; exact at the powers of two.
pub(crate) fn log2_q32(k: NonZeroU64) -> u64 {
    // k = 2^e (1 + x), log2(k) = e + x + x (1 - x) p(x); p interpolates at the Chebyshev nodes.
    const P_Q30: [i64; 5] = [475_296_191, -296_964_243, 197_676_760, -104_369_674, 27_585_783];
    let zeros = k.leading_zeros();
    let x = ((k.get() << zeros << 1) >> 32) as i64;
    (u64::from(63 - zeros) << 32) + bow_q32(&P_Q30, x).cast_unsigned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn log2_is_exact_at_powers_of_two() {
        for e in 0..64 {
            let power = NonZeroU64::MIN.get() << e;
            assert_eq!(NonZeroU64::new(power).map(log2_q32), Some(e << 32));
        }
    }

    proptest! {
        #[test]
        fn log2_agrees_with_libm(k in 1..=u64::MAX, shift in 0..64u32) {
            let k = NonZeroU64::new(k >> shift).unwrap_or(NonZeroU64::MIN);
            let error = log2_q32(k) as f64 / 4_294_967_296.0 - libm::log2(k.get() as f64);
            prop_assert!(error.abs() < 8e-6);
        }
    }
}
