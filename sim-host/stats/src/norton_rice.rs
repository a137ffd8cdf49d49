//! The Norton-Rice law of arrival times (KUZ section 5), its fit and its test.

use super::describe::sorted;
use super::optimize::minimize;
use super::special::{gamma_q, ln_bessel_i_scaled};
use libm::{ceil, exp, log, pow, sqrt};

const PARAMETERS: usize = 3;
const MIN_SAMPLES: usize = 10;
/// Expected samples in a bin of the test, at least.
const MIN_EXPECTED: f64 = 8.0;
/// Evaluations per start; a fit needs 100 to 300.
const MAX_EVALS: usize = 2000;

/// A Norton-Rice law; alpha and beta have the unit of x.
///
/// With s = beta^2 / m, p(x) = (alpha / s) (x / alpha)^m exp(-(alpha^2 + x^2) / 2s) I_{m-1}(x alpha
/// / s) for x > 0. X^2 / s is a noncentral chi-square with 2m degrees of freedom and noncentrality
/// alpha^2 / s. m = 1 is Rice's law, alpha -> 0 Nakagami's.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct NortonRice {
    m: f64,
    alpha: f64,
    beta: f64,
}

/// Below this share, a parameter of a fit has no effect on the density.
const NOTHING: f64 = 1e-3;

/// Why samples have no fit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Fewer than 10 samples.
    #[error("a Norton-Rice law needs at least {MIN_SAMPLES} samples, got {0}: make more runs")]
    TooFew(usize),
    /// A sample that is not finite or not above 0.
    #[error("sample {index} is {value}: a Norton-Rice law has finite values above 0 only")]
    NotPositive {
        /// Index of the sample.
        index: usize,
        /// Value of the sample.
        value: f64,
    },
    /// All samples are equal (to about 1e-6 relative).
    #[error("all samples are equal, they determine no Norton-Rice law")]
    Constant,
}

/// Result of the chi-square test.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Goodness {
    /// Smallest chi-square that a law of the family reaches.
    pub chi2: f64,
    /// Degrees of freedom: bins - 1 - 3.
    pub freedom: usize,
    /// Probability of a chi-square at least as large if the family is the true one.
    pub p_value: f64,
}

impl NortonRice {
    /// Creates a law; `None` unless all parameters are finite and above 0.
    #[must_use]
    pub fn new(m: f64, alpha: f64, beta: f64) -> Option<Self> {
        let usable = [m, alpha, beta].iter().all(|p| p.is_finite() && *p > 0.0);
        usable.then_some(Self { m, alpha, beta })
    }

    /// Shape m: half the degrees of freedom.
    #[must_use]
    pub const fn m(&self) -> f64 {
        self.m
    }

    /// Location alpha, in the unit of x.
    #[must_use]
    pub const fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Spread beta, in the unit of x.
    #[must_use]
    pub const fn beta(&self) -> f64 {
        self.beta
    }

    /// Whether the law is an end of its family: without location (alpha = 0, Nakagami's law), or
    /// with a shape m of 0. Samples whose best law is there follow a law of two parameters.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        self.m < NOTHING || self.alpha < NOTHING * sqrt(self.mean_square())
    }

    /// Logarithm of the density; minus infinity for `x <= 0`. Stable for large arguments.
    #[must_use]
    pub fn ln_pdf(&self, x: f64) -> f64 {
        if x <= 0.0 || x.is_nan() {
            return f64::NEG_INFINITY;
        }
        let Self { m, alpha, beta } = *self;
        let scale = m / (beta * beta);
        // The Bessel function's e^z is part of the square.
        log(alpha * scale) + m * log(x / alpha) - scale * (x - alpha) * (x - alpha) / 2.0
            + ln_bessel_i_scaled(m - 1.0, scale * alpha * x)
    }

    /// Density, per unit of x.
    #[must_use]
    pub fn pdf(&self, x: f64) -> f64 {
        exp(self.ln_pdf(x))
    }

    /// Probability of a value of at most `x`, to about 1e-7; NaN for NaN.
    #[must_use]
    pub fn cdf(&self, x: f64) -> f64 {
        if x.is_nan() {
            return x;
        }
        self.mass(0.0, x).min(1.0)
    }

    /// Probability of a value between `a` and `b`, by Gauss-Legendre quadrature over panels half a
    /// sigma wide. At most about 40 panels of 8 points: X is the length of a normal vector, so all
    /// but 1e-17 of its probability lies within 10 sigma of the root of the mean square.
    fn mass(&self, a: f64, b: f64) -> f64 {
        let sigma = self.beta / sqrt(self.m);
        let center = sqrt(self.mean_square());
        let low = a.max(center - 10.0 * sigma).max(0.0);
        let high = b.min(center + 10.0 * sigma);
        if high <= low {
            return 0.0;
        }
        let panels = ceil((high - low) / (sigma / 2.0)).max(1.0);
        let edge = |i: f64| low + (high - low) * (i / panels);
        (0..panels as u32).map(|i| self.panel(edge(f64::from(i)), edge(f64::from(i) + 1.0))).sum()
    }

    fn panel(&self, a: f64, b: f64) -> f64 {
        // Near 0 the density grows like x^(2m - 1); the substitution t = x^(2m) removes the edge.
        let power = if self.m < 1.0 { 2.0 * self.m } else { 1.0 };
        let (a, b) = (pow(a, power), pow(b, power));
        let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
        let integrand = |t: f64| {
            let x = pow(t, 1.0 / power);
            self.pdf(x) * x / (power * t)
        };
        GAUSS_LEGENDRE_8
            .iter()
            .map(|&[node, weight]| weight * half * (integrand(middle - node * half) + integrand(middle + node * half)))
            .sum()
    }

    fn mean_square(&self) -> f64 {
        self.alpha * self.alpha + 2.0 * self.beta * self.beta
    }

    /// Coordinates in which the likelihood is round: ln of mean A and variance V of X^2, and the
    /// logit of r = alpha^2 / mean square, from Nakagami (0) to ever smaller m (1).
    ///
    /// alpha^2 = A r, beta^2 = A (1 - r) / 2, m = (1 - r^2) A^2 / V. Any real coordinates are a
    /// law, so the search needs no bounds.
    fn coordinates(&self) -> [f64; PARAMETERS] {
        let a = self.mean_square();
        let r = self.alpha * self.alpha / a;
        let rest = 2.0 * self.beta * self.beta / a;
        [log(a), log(rest * (1.0 + r) * a * a / self.m), log(r / rest)]
    }

    fn from_coordinates([ln_a, ln_v, logit]: [f64; PARAMETERS]) -> Option<Self> {
        // Beyond +-30 the law does not change, and digits are lost.
        let odds = exp(logit.clamp(-30.0, 30.0));
        let (r, rest) = (odds / (1.0 + odds), 1.0 / (1.0 + odds));
        let a = exp(ln_a);
        Self::new(rest * (1.0 + r) * exp(2.0 * ln_a - ln_v), sqrt(a * r), sqrt(a * rest / 2.0))
    }

    /// Maximum-likelihood fit: Nelder-Mead from the sample's moments and three shapes. O(n), some
    /// hundred passes.
    ///
    /// If the deviation is small compared with the mean, the law is nearly normal: the density is
    /// well determined, m alone is not.
    ///
    /// # Errors
    /// See [`FitError`].
    pub fn fit(samples: &[f64]) -> Result<Self, FitError> {
        let n = samples.len();
        if n < MIN_SAMPLES {
            return Err(FitError::TooFew(n));
        }
        if let Some(index) = samples.iter().position(|x| !(*x > 0.0 && x.is_finite())) {
            let value = samples[index];
            return Err(FitError::NotPositive { index, value });
        }
        let largest = samples.iter().copied().fold(0.0, f64::max);
        let mean_square = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / n as f64;
        let square = |x: f64| (x / largest) * (x / largest);
        let scale = largest * sqrt(mean_square(&mut samples.iter().map(|&x| square(x))));
        let scaled: Vec<f64> = samples.iter().map(|x| x / scale).collect();
        let variance = mean_square(&mut scaled.iter().map(|x| (x * x - 1.0) * (x * x - 1.0)));
        if variance <= 1e-12 {
            return Err(FitError::Constant);
        }
        let unlikeliness = |at| {
            Self::from_coordinates(at)
                .map_or(f64::INFINITY, |law: Self| -scaled.iter().map(|&x| law.ln_pdf(x)).sum::<f64>())
        };
        let rice = sqrt((1.0 - variance).max(0.25));
        let (best, _) = [0.1, 0.5, rice]
            .map(|r| {
                let start = [0.0, log(variance), log(r / (1.0 - r))];
                minimize(unlikeliness, start, [sqrt(variance) / 4.0, 0.2, 1.0], 1e-7, MAX_EVALS)
            })
            .into_iter()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .ok_or(FitError::Constant)?;
        let law = Self::from_coordinates(best).ok_or(FitError::Constant)?;
        Self::new(law.m, law.alpha * scale, law.beta * scale).ok_or(FitError::Constant)
    }

    /// Pearson's chi-square test of the family, valid after a fit. `self` is the fitted law.
    ///
    /// The bins have about equal expected counts under `self`: 2 n^(2/5) bins, with at least 8
    /// expected samples each. Their edges lie halfway between neighbouring samples, so that whole
    /// ticks are never on an edge. A maximum-likelihood fit does not minimise chi-square, which
    /// therefore has no chi-square law (Chernoff and Lehmann 1954). This test minimises it over the
    /// three parameters, starting at `self`, which gives bins - 1 - 3 degrees of freedom (Fisher
    /// 1924).
    ///
    /// `None` if a sample is not finite, or if the samples fill fewer than 5 bins (fewer than 40
    /// samples, or very few different values).
    #[must_use]
    pub fn goodness(&self, samples: &[f64]) -> Option<Goodness> {
        let sorted = sorted(samples)?;
        let (edges, counts) = self.bins(&sorted);
        let freedom = counts.len().checked_sub(1 + PARAMETERS).filter(|&f| f > 0)?;
        let n = sorted.len() as f64;
        let chi2 = |at: [f64; PARAMETERS]| -> f64 {
            let Some(law) = Self::from_coordinates(at) else {
                return f64::INFINITY;
            };
            edges
                .windows(2)
                .zip(&counts)
                .map(|(edge, &count)| {
                    let expected = n * law.mass(edge[0], edge[1]);
                    let off = count as f64 - expected;
                    off * off / expected
                })
                .sum()
        };
        let start = self.coordinates();
        let relative = exp(start[1] / 2.0 - start[0]);
        let step = [relative / sqrt(n), 2.0 / sqrt(n), 0.5];
        let (_, chi2) = minimize(chi2, start, step, 1e-6, MAX_EVALS);
        Some(Goodness { chi2, freedom, p_value: gamma_q(freedom as f64 / 2.0, chi2 / 2.0) })
    }

    /// Edges (from 0 to infinity) and counts of the bins.
    fn bins(&self, sorted: &[f64]) -> (Vec<f64>, Vec<usize>) {
        let n = sorted.len() as f64;
        let wanted = (2.0 * pow(n, 0.4)).min(n / MIN_EXPECTED);
        let (mut edges, mut counts) = (vec![0.0], Vec::new());
        let (mut below, mut at, mut counted) = (0.0, 0.0, 0);
        let mut last_edge_below = 0.0;
        for (index, pair) in sorted.windows(2).enumerate() {
            if pair[0] == pair[1] {
                continue;
            }
            let edge = pair[0] + (pair[1] - pair[0]) / 2.0;
            below += self.mass(at, edge);
            at = edge;
            let share = 1.0 / wanted;
            if below - last_edge_below >= share * 0.999 && 1.0 - below >= share * 0.999 {
                edges.push(edge);
                counts.push(index + 1 - counted);
                counted = index + 1;
                last_edge_below = below;
            }
        }
        edges.push(f64::INFINITY);
        counts.push(sorted.len() - counted);
        (edges, counts)
    }
}

/// Positive nodes and weights of the 8-point rule on -1..=1.
const GAUSS_LEGENDRE_8: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_27],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

#[cfg(test)]
#[path = "norton_rice_tests.rs"]
mod tests;
