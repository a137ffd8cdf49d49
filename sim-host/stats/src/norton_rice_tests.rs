use super::*;
use crate::{Summary, quantile};
use libm::{cos, fabs};
use std::f64::consts::TAU;

/// SplitMix64, Box-Muller.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = sqrt(-2.0 * log(1.0 - self.uniform()));
        radius * cos(TAU * self.uniform())
    }

    /// Lengths of normal vectors of dimension `2m`: Norton-Rice by construction.
    fn lengths(&mut self, n: usize, law: &NortonRice) -> Vec<f64> {
        let dimension = (2.0 * law.m()).round() as usize;
        let sigma = law.beta() / sqrt(law.m());
        let length = |_| {
            let mut square = 0.0;
            for axis in 0..dimension {
                let mean = if axis == 0 { law.alpha() } else { 0.0 };
                let x = mean + sigma * self.normal();
                square += x * x;
            }
            sqrt(square)
        };
        (0..n).map(length).collect()
    }
}

fn law(m: f64, alpha: f64, beta: f64) -> NortonRice {
    NortonRice::new(m, alpha, beta).unwrap()
}

#[test]
fn density_and_distribution_have_their_known_values() {
    // mpmath 1.3, 30 digits.
    for (law, x, pdf, cdf) in [
        (law(1.0, 2.0, 1.0), 1.5, 0.321_670_589_812_155_9, 0.209_232_220_603_23),
        (law(2.5, 300.0, 30.0), 310.0, 0.019_464_202_465_574_93, 0.656_356_237_493_528),
        (law(0.3, 1.0, 1.0), 0.2, 0.618_155_583_309_771_4, 0.206_528_606_844_622),
        (law(1.0, 300.0, 10.0), 350.0, 1.606_031_885_058_992_3e-7, 0.999_999_689_521_319),
    ] {
        assert!(fabs(law.pdf(x) / pdf - 1.0) < 1e-9, "{law:?}: {} {pdf}", law.pdf(x));
        assert!(fabs(law.cdf(x) - cdf) < 1e-7, "{law:?}: {} {cdf}", law.cdf(x));
    }
}

#[test]
fn a_law_without_location_or_shape_is_degenerate() {
    assert!(!law(1.0, 2.0, 1.0).is_degenerate() && !law(0.3, 30.0, 300.0).is_degenerate());
    assert!(law(1.0, 1e-6, 1.0).is_degenerate(), "no location");
    assert!(law(1e-6, 300.0, 1e-3).is_degenerate(), "no shape");
}

#[test]
fn distribution_goes_from_zero_to_one() {
    for law in [law(0.1, 1.0, 1.0), law(1.0, 1e-6, 1.0), law(7.3, 5.0, 100.0), law(40.0, 1.0, 1.0), law(1.0, 1e6, 1e-3)]
    {
        let end = law.alpha() + 20.0 * law.beta() / sqrt(law.m()) + 3.0 * law.beta();
        assert_eq!((law.cdf(-1.0), law.cdf(0.0)), (0.0, 0.0));
        assert!(fabs(law.cdf(end) - 1.0) < 1e-7, "{law:?} {}", law.cdf(end));
        assert!(fabs(law.cdf(f64::INFINITY) - 1.0) < 1e-7);
        let values: Vec<f64> = (0..=50).map(|i| law.cdf(end * f64::from(i) / 50.0)).collect();
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1] + 1e-7), "{law:?}");
        assert!(law.cdf(f64::NAN).is_nan());
    }
}

#[test]
fn density_never_overflows() {
    for law in [law(1.0, 1e8, 1.0), law(1e-3, 1.0, 1.0), law(1e6, 1e3, 1e3), law(1.0, 1e-150, 1e150)] {
        for x in [1e-300, 1e-3, 1.0, 1e3, 1e8, 1e150] {
            let p = law.pdf(x);
            assert!(p >= 0.0 && p.is_finite(), "{law:?} at {x}: {p}");
        }
        assert_eq!((law.pdf(0.0), law.pdf(-1.0), law.pdf(f64::NAN)), (0.0, 0.0, 0.0));
    }
}

#[test]
fn parameters_must_be_positive() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(NortonRice::new(bad, 1.0, 1.0), None);
        assert_eq!(NortonRice::new(1.0, bad, 1.0), None);
        assert_eq!(NortonRice::new(1.0, 1.0, bad), None);
    }
}

#[test]
fn coordinates_are_a_bijection() {
    for law in [law(1.0, 2.0, 1.0), law(0.2, 300.0, 30.0), law(50.0, 1.0, 3.0)] {
        let back = NortonRice::from_coordinates(law.coordinates()).unwrap();
        assert!(fabs(back.m() / law.m() - 1.0) < 1e-9, "{back:?}");
        assert!(fabs(back.alpha() / law.alpha() - 1.0) < 1e-9, "{back:?}");
        assert!(fabs(back.beta() / law.beta() - 1.0) < 1e-9, "{back:?}");
    }
}

#[test]
fn fit_finds_the_parameters_that_made_the_samples() {
    for (seed, truth) in [(1, law(1.0, 2.0, 1.0)), (2, law(2.0, 200.0, 150.0)), (3, law(0.5, 1.0, 0.6))] {
        let samples = Random(seed).lengths(4000, &truth);
        let fit = NortonRice::fit(&samples).unwrap();
        assert!(fabs(fit.alpha() / truth.alpha() - 1.0) < 0.1, "{truth:?} {fit:?}");
        assert!(fabs(fit.beta() / truth.beta() - 1.0) < 0.1, "{truth:?} {fit:?}");
        assert!(fabs(fit.m() / truth.m() - 1.0) < 0.15, "{truth:?} {fit:?}");
    }
}

#[test]
fn fit_of_narrow_samples_finds_the_density_if_not_m() {
    let truth = law(1.0, 300.0, 20.0);
    let samples = Random(4).lengths(1000, &truth);
    let fit = NortonRice::fit(&samples).unwrap();
    for p in [0.1, 0.5, 0.9] {
        let x = quantile(&samples, p).unwrap();
        assert!(fabs(fit.cdf(x) - p) < 0.015, "{fit:?} {p} {}", fit.cdf(x));
    }
    let likelihood = |law: &NortonRice| samples.iter().map(|&x| law.ln_pdf(x)).sum::<f64>();
    assert!(likelihood(&fit) >= likelihood(&truth));
}

#[test]
fn fit_is_a_matter_of_scale_only() {
    let samples = Random(5).lengths(300, &law(1.0, 2.0, 1.0));
    let base = NortonRice::fit(&samples).unwrap();
    for scale in [1e-150, 1e-3, 1e150] {
        let scaled: Vec<f64> = samples.iter().map(|x| x * scale).collect();
        let fit = NortonRice::fit(&scaled).unwrap();
        assert!(fabs(fit.alpha() / scale / base.alpha() - 1.0) < 1e-3, "{fit:?}");
        assert!(fabs(fit.m() / base.m() - 1.0) < 1e-2, "{fit:?}");
    }
}

#[test]
fn samples_without_a_fit_say_why() {
    assert_eq!(NortonRice::fit(&[1.0; 9]), Err(FitError::TooFew(9)));
    assert_eq!(NortonRice::fit(&[1.0; 20]), Err(FitError::Constant));
    let mut samples = [1.0; 20];
    for value in [0.0, -3.0, f64::INFINITY] {
        samples[7] = value;
        assert_eq!(NortonRice::fit(&samples), Err(FitError::NotPositive { index: 7, value }));
    }
}

#[test]
fn p_values_of_the_family_are_uniform() {
    let truth = law(1.0, 300.0, 60.0);
    let mut random = Random(6);
    let p_values: Vec<f64> = (0..80)
        .map(|_| {
            let samples = random.lengths(200, &truth);
            let fit = NortonRice::fit(&samples).unwrap();
            fit.goodness(&samples).unwrap().p_value
        })
        .collect();
    let summary = Summary::of(&p_values).unwrap();
    assert!((0.4..0.6).contains(&summary.mean), "{summary:?}");
    assert!((0.2..0.36).contains(&summary.deviation), "{summary:?}");
    let rejected = p_values.iter().filter(|p| **p < 0.05).count();
    assert!(rejected <= 10, "{rejected} of 80");
}

#[test]
fn other_laws_are_refused() {
    let mut random = Random(7);
    let two_peaks: Vec<f64> =
        (0..1000).map(|i| if i % 2 == 0 { 5.0 } else { 9.0 } + random.normal()).map(|x: f64| x.max(0.1)).collect();
    let fit = NortonRice::fit(&two_peaks).unwrap();
    let goodness = fit.goodness(&two_peaks).unwrap();
    assert!(goodness.p_value < 1e-6, "{goodness:?}");
}

#[test]
fn whole_ticks_do_not_look_like_another_law() {
    let truth = law(1.0, 300.0, 20.0);
    let ticks: Vec<f64> = Random(8).lengths(1000, &truth).into_iter().map(f64::round).collect();
    let fit = NortonRice::fit(&ticks).unwrap();
    let goodness = fit.goodness(&ticks).unwrap();
    assert!(goodness.p_value > 0.02 && goodness.freedom > 15, "{goodness:?}");
}

#[test]
fn too_few_samples_have_no_test() {
    let samples = Random(9).lengths(39, &law(1.0, 2.0, 1.0));
    let fit = NortonRice::fit(&samples).unwrap();
    assert_eq!(fit.goodness(&samples), None);
    assert_eq!(fit.goodness(&[]), None);
    assert_eq!(fit.goodness(&[f64::NAN; 100]), None);
    assert_eq!(fit.goodness(&[3.0; 100]), None);
}
