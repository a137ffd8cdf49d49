//! Special functions: incomplete gamma and beta, Student's t, the modified Bessel function. They
//! use `libm` alone, so they have the same bits on every machine.

use libm::{exp, fabs, lgamma, log, log1p, sqrt};
use std::f64::consts::TAU;

/// Relative size of a negligible term.
const EPS: f64 = 1e-16;
/// Keeps Lentz's continued fractions away from a division by zero.
const TINY: f64 = 1e-300;
/// Terms after which a series or fraction is cut off; the arguments used here need far fewer.
const MAX_TERMS: u32 = 100_000;

/// Q(a, x) = Gamma(a, x) / Gamma(a), the upper regularised incomplete gamma function.
///
/// The p-value of a chi-square c with k degrees of freedom is Q(k/2, c/2). NaN unless `a > 0` and
/// `x >= 0`. O(sqrt(a)) terms.
#[must_use]
pub fn gamma_q(a: f64, x: f64) -> f64 {
    // The series converges fast below the law's mean, the fraction above.
    if x < a + 1.0 { 1.0 - gamma_p_series(a, x) } else { gamma_q_fraction(a, x) }
}

/// ln of x^a e^-x / Gamma(a + 1).
fn ln_gamma_step(a: f64, x: f64) -> f64 {
    a * log(x) - x - lgamma(a + 1.0)
}

fn gamma_p_series(a: f64, x: f64) -> f64 {
    if !(a > 0.0 && x >= 0.0) {
        return f64::NAN;
    }
    if x == 0.0 {
        return 0.0;
    }
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..MAX_TERMS {
        term *= x / (a + f64::from(k));
        sum += term;
        if term < sum * EPS {
            break;
        }
    }
    sum * exp(ln_gamma_step(a, x))
}

/// Lentz's algorithm (DLMF 8.9.2).
fn gamma_q_fraction(a: f64, x: f64) -> f64 {
    if !(a > 0.0 && x >= 0.0) {
        return f64::NAN;
    }
    if x.is_infinite() {
        return 0.0;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut product = d;
    for k in 1..MAX_TERMS {
        let k = f64::from(k);
        let numerator = k * (a - k);
        b += 2.0;
        d = 1.0 / away_from_zero(numerator * d + b);
        c = away_from_zero(b + numerator / c);
        product *= d * c;
        if fabs(d * c - 1.0) < EPS * 4.0 {
            break;
        }
    }
    product * a * exp(ln_gamma_step(a, x))
}

fn away_from_zero(x: f64) -> f64 {
    if fabs(x) < TINY { TINY } else { x }
}

/// I_x(a, b), the regularised incomplete beta function (DLMF 8.17.22). NaN unless `a > 0`, `b > 0`
/// and `0 <= x <= 1`.
#[must_use]
pub fn beta_regularized(x: f64, a: f64, b: f64) -> f64 {
    if !(a > 0.0 && b > 0.0 && (0.0..=1.0).contains(&x)) {
        return f64::NAN;
    }
    if x == 0.0 || x == 1.0 {
        return x;
    }
    // The fraction converges fast below the mean only; the other side follows by symmetry.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_regularized(1.0 - x, b, a);
    }
    let front = lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x);
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut product = d;
    for k in 1..MAX_TERMS {
        let k = f64::from(k);
        let even = k * (b - k) * x / ((a + 2.0 * k - 1.0) * (a + 2.0 * k));
        let odd = -(a + k) * (a + b + k) * x / ((a + 2.0 * k) * (a + 2.0 * k + 1.0));
        for numerator in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + numerator * d);
            c = away_from_zero(1.0 + numerator / c);
            product *= c * d;
        }
        if fabs(c * d - 1.0) < EPS * 4.0 {
            break;
        }
    }
    exp(front) * product / a
}

/// Quantile of Student's t with `freedom` degrees at probability `p`.
///
/// Bisection over the incomplete beta function, to about 1e-12 relative. NaN unless `0 < p < 1` and
/// `freedom > 0`.
#[must_use]
pub fn student_t_quantile(p: f64, freedom: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && freedom > 0.0) {
        return f64::NAN;
    }
    if p < 0.5 {
        return -student_t_quantile(1.0 - p, freedom);
    }
    // P(|T| > t) = I_x(freedom / 2, 1 / 2) with x = freedom / (freedom + t^2).
    let tail = 2.0 * (1.0 - p);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if beta_regularized(middle, freedom / 2.0, 0.5) < tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    sqrt(freedom * (1.0 - high) / high)
}

/// ln(e^-z I_nu(z)), the modified Bessel function of the first kind, scaled against overflow.
///
/// NaN unless `nu > -1` and `z >= 0`. Below |(nu, z)| = 60 the ascending series (DLMF 10.25.2, at
/// most about 100 terms, all positive), above it the uniform expansion for large order (DLMF
/// 10.41.3) up to the fourth term; in powers of 1/sqrt(nu^2 + z^2) it is valid for small orders
/// too. Relative error of I_nu below 1e-9.
#[must_use]
pub fn ln_bessel_i_scaled(nu: f64, z: f64) -> f64 {
    if !(nu > -1.0 && z >= 0.0) || z.is_infinite() {
        return f64::NAN;
    }
    let s = sqrt(nu * nu + z * z);
    if s < 60.0 {
        let quarter = z * z / 4.0;
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..MAX_TERMS {
            let k = f64::from(k);
            term *= quarter / (k * (k + nu));
            sum += term;
            if term < sum * EPS {
                break;
            }
        }
        // z^0 is 1 even at z = 0, where the product below would be 0 times infinity.
        let power = if nu == 0.0 { 0.0 } else { nu * log(z / 2.0) };
        return power - lgamma(nu + 1.0) + log(sum) - z;
    }
    // I_-nu differs from I_nu by e^-2z here, far below the expansion's error.
    let nu = fabs(nu);
    let q = nu * nu / (s * s);
    let series = 1.0
        + (3.0 - 5.0 * q) / 24.0 / s
        + (81.0 + q * (-462.0 + q * 385.0)) / 1152.0 / (s * s)
        + (30_375.0 + q * (-369_603.0 + q * (765_765.0 - q * 425_425.0))) / 414_720.0 / (s * s * s)
        + (4_465_125.0 + q * (-94_121_676.0 + q * (349_922_430.0 + q * (-446_185_740.0 + q * 185_910_725.0))))
            / 39_813_120.0
            / (s * s * s * s);
    // This form of s - z has no cancellation.
    let excess = nu * nu / (s + z);
    let order = if nu == 0.0 { 0.0 } else { nu * log(z / (nu + s)) };
    excess + order - 0.5 * log(TAU * s) + log(series)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(got: f64, want: f64, relative: f64) {
        let off = fabs(got - want);
        assert!(off <= relative * fabs(want), "{got} is not {want}");
    }

    #[test]
    fn bessel_has_its_known_logarithms_on_both_sides_of_the_switch() {
        for (nu, z, want) in [
            (0.0, 0.1, -0.097_501_560_766_123_76),
            (0.0, 1.0, -0.764_085_641_492_821_4),
            (1.0, 1.0, -1.570_647_987_490_831_2),
            (0.0, 10.0, -2.057_027_916_881_304_4),
            (0.0, 59.9, -2.963_172_244_193_299),
            (0.0, 60.1, -2.964_845_975_731_632_3),
            (0.0, 100.0, -3.220_267_310_057_416_4),
            (5.0, 100.0, -3.345_872_367_419_918_4),
            (0.5, 3.0, -1.470_726_506_907_687_1),
            (-0.5, 3.0, -1.465_768_992_400_997_1),
            (-0.9, 0.2, -0.284_662_094_280_308_36),
            (-0.9, 80.0, -3.113_473_977_726_444),
            (-0.999, 0.001, 0.685_372_640_485_105_8),
            (2.5, 40.0, -2.839_314_826_351_581_3),
            (30.0, 5.0, -51.968_531_494_124_23),
            (59.0, 1.0, -226.425_345_990_111_03),
            (61.0, 1.0, -236.016_993_172_966_72),
            (61.0, 0.001, -656.395_097_315_879_8),
            (45.0, 45.0, -24.017_442_038_372_007),
            (100.0, 100.0, -50.110_667_929_208_45),
            (1000.0, 1.0, -6_606.275_109_297_89),
            (1000.0, 5000.0, -104.857_914_118_717_02),
            (0.0, 1e6, -7.826_693_687_186_747),
            (50.0, 1e8, -10.129_291_403_930_917),
        ] {
            let off = fabs(ln_bessel_i_scaled(nu, z) - want);
            assert!(off < 1e-9 + 1e-13 * fabs(want), "I_{nu}({z}): {off:e}");
        }
    }

    #[test]
    fn bessel_at_zero_is_one_zero_or_infinite_by_order() {
        assert_eq!(ln_bessel_i_scaled(0.0, 0.0), 0.0);
        assert_eq!(ln_bessel_i_scaled(0.3, 0.0), f64::NEG_INFINITY);
        assert_eq!(ln_bessel_i_scaled(100.0, 0.0), f64::NEG_INFINITY);
        assert_eq!(ln_bessel_i_scaled(-0.3, 0.0), f64::INFINITY);
        for (nu, z) in [(-1.0, 1.0), (0.0, -1.0), (f64::NAN, 1.0), (0.0, f64::NAN), (0.0, f64::INFINITY)] {
            assert!(ln_bessel_i_scaled(nu, z).is_nan());
        }
    }

    #[test]
    fn incomplete_gamma_has_its_known_values() {
        for (a, x, want) in [
            (0.5, 0.1, 0.654_720_846_018_577),
            (0.5, 3.0, 0.014_305_878_435_429_64),
            (1.0, 1.0, 0.367_879_441_171_442_3),
            (5.0, 2.0, 0.947_346_982_656_288_8),
            (5.0, 20.0, 1.694_474_393_006_738_5e-5),
            (13.5, 13.5, 0.463_794_815_620_558_24),
            (100.0, 80.0, 0.982_891_686_964_867),
            (100.0, 130.0, 0.002_750_408_367_306_526),
            (1e4, 1e4, 0.498_670_191_660_044_8),
            (1e4, 10_500.0, 4.275_872_455_059_647e-7),
        ] {
            assert_close(gamma_q(a, x), want, 1e-10);
        }
        assert_eq!((gamma_q(2.0, 0.0), gamma_q(2.0, f64::INFINITY)), (1.0, 0.0));
        for (a, x) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert!(gamma_q(a, x).is_nan(), "{a} {x}");
        }
    }

    #[test]
    fn incomplete_beta_has_its_known_values() {
        for (x, a, b, want) in [
            (0.3, 2.0, 3.0, 0.3483),
            (0.9, 2.0, 3.0, 0.9963),
            (0.01, 0.5, 0.5, 0.063_768_560_858_519_85),
            (0.5, 50.0, 60.0, 0.830_907_293_901_669_4),
            (0.999, 100.0, 0.5, 0.655_043_516_324_429_6),
            (0.0, 1.0, 1.0, 0.0),
            (1.0, 1.0, 1.0, 1.0),
        ] {
            assert_close(beta_regularized(x, a, b), want, 1e-12);
        }
        assert!(beta_regularized(1.1, 1.0, 1.0).is_nan());
        assert!(beta_regularized(0.5, 0.0, 1.0).is_nan());
    }

    #[test]
    fn student_quantiles_are_those_of_the_table() {
        for (freedom, want) in [
            (1.0, 12.706_204_736),
            (2.0, 4.302_652_730),
            (4.0, 2.776_445_105),
            (30.0, 2.042_272_456),
            (999.0, 1.962_341_461),
            (1e6, 1.959_966_356_6),
        ] {
            assert_close(student_t_quantile(0.975, freedom), want, 1e-8);
            assert_close(student_t_quantile(0.025, freedom), -want, 1e-8);
        }
        assert!(student_t_quantile(0.5, 3.0).abs() < 1e-9);
        for (p, freedom) in [(0.0, 1.0), (1.0, 1.0), (0.9, 0.0), (f64::NAN, 1.0)] {
            assert!(student_t_quantile(p, freedom).is_nan());
        }
    }
}
