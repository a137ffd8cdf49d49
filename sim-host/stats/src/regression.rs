//! The curve of KUZ figure 6.

use super::mean;
use libm::log1p;

/// Curve y = a ln(N + 1) + b over the number of obstacles N.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct LogFit {
    /// Slope over ln(N + 1).
    pub a: f64,
    /// Value at N = 0.
    pub b: f64,
    /// Coefficient of determination; 1 if the curve meets every point, also if all y are equal.
    pub r2: f64,
}

impl LogFit {
    /// The paper's curve for six agents on natural terrain (KUZ section 8).
    pub const PAPER: Self = Self { a: 0.901_073, b: -0.673_763, r2: 0.992_729 };

    /// Least squares over points (N, y); `None` unless all are finite, N > -1, and two N differ.
    #[must_use]
    pub fn of(points: &[[f64; 2]]) -> Option<Self> {
        let x: Vec<f64> = points.iter().map(|p| log1p(p[0])).collect();
        let y: Vec<f64> = points.iter().map(|p| p[1]).collect();
        let (mean_x, mean_y) = (mean(&x)?, mean(&y)?);
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            x.iter().zip(&y).map(|(x, y)| term(x - mean_x, y - mean_y)).sum()
        };
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        if xx <= 0.0 || !xx.is_finite() || !yy.is_finite() {
            return None;
        }
        let a = xy / xx;
        let rest = sum(&|x, y| (y - a * x) * (y - a * x));
        Some(Self { a, b: mean_y - a * mean_x, r2: if yy > 0.0 { 1.0 - rest / yy } else { 1.0 } })
    }

    /// Value of the curve at `n` obstacles.
    #[must_use]
    pub fn at(&self, n: f64) -> f64 {
        self.a * log1p(n) + self.b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_the_curve_give_the_curve_back() {
        let points: Vec<_> = [0.0, 10.0, 40.0, 130.0].map(|n| [n, LogFit::PAPER.at(n)]).into();
        let fit = LogFit::of(&points).unwrap();
        assert!((fit.a - LogFit::PAPER.a).abs() < 1e-12);
        assert!((fit.b - LogFit::PAPER.b).abs() < 1e-12);
        assert!((fit.r2 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn r2_is_the_explained_share() {
        let fit = LogFit::of(&[[0.0, 0.0], [1.0, 1.0], [3.0, 0.0]]).unwrap();
        assert!(fit.a.abs() < 1e-12 && fit.r2.abs() < 1e-12, "{fit:?}");
        assert!((fit.b - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn flat_points_are_a_perfect_flat_line() {
        let fit = LogFit::of(&[[0.0, 2.0], [5.0, 2.0]]).unwrap();
        assert_eq!((fit.a, fit.b, fit.r2), (0.0, 2.0, 1.0));
    }

    #[test]
    fn points_that_fix_no_curve_give_none() {
        for points in [
            &[][..],
            &[[1.0, 1.0]],
            &[[2.0, 1.0], [2.0, 5.0]],
            &[[-1.0, 1.0], [2.0, 5.0]],
            &[[-3.0, 1.0], [2.0, 5.0]],
            &[[0.0, f64::NAN], [2.0, 5.0]],
            &[[0.0, 1e300], [2.0, -1e300]],
        ] {
            assert_eq!(LogFit::of(points), None, "{points:?}");
        }
    }
}
