//! Straight lines through points.

/// The line of least squares, y = slope x + intercept.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Line {
    /// Change of y per unit of x.
    pub slope: f64,
    /// Value of y at x = 0.
    pub intercept: f64,
    /// Coefficient of determination: the share of the variance of y that the line explains, 0 to 1.
    pub r2: f64,
}

impl Line {
    /// Fits a line to points (x, y). O(n).
    ///
    /// `None` if there are fewer than three points, a coordinate is not finite, or all x or all y
    /// are equal: two points are always on a line, and without variance there is nothing to
    /// explain.
    #[must_use]
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        if points.len() < 3 || points.iter().flatten().any(|value| !value.is_finite()) {
            return None;
        }
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
        let means = [mean(0), mean(1)];
        let moment = |a: usize, b: usize| -> f64 {
            points.iter().map(|point| (point[a] - means[a]) * (point[b] - means[b])).sum()
        };
        let [xx, xy, yy] = [moment(0, 0), moment(0, 1), moment(1, 1)];
        let slope = xy / xx;
        let line = Self { slope, intercept: means[1] - slope * means[0], r2: xy * xy / (xx * yy) };
        (line.slope.is_finite() && line.intercept.is_finite() && line.r2.is_finite()).then_some(line)
    }
}

#[cfg(test)]
mod tests {
    use super::Line;

    #[test]
    fn points_on_a_line_are_explained_fully_and_others_by_the_square_of_their_correlation() {
        let exact = Line::fit(&[[0.0, 1.0], [1.0, 3.0], [4.0, 9.0]]).unwrap();
        assert!((exact.slope - 2.0).abs() < 1e-12 && (exact.intercept - 1.0).abs() < 1e-12, "{exact:?}");
        assert!((exact.r2 - 1.0).abs() < 1e-12, "{exact:?}");
        let even = Line::fit(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]).unwrap();
        assert_eq!((even.slope, even.r2), (0.0, 0.0));
        // By hand: moments 2, 1.5 and 1.5 about the means 1 and 2 / 3.
        let loose = Line::fit(&[[0.0, 0.0], [1.0, 0.5], [2.0, 1.5]]).unwrap();
        assert!((loose.slope - 0.75).abs() < 1e-12 && (loose.r2 - 27.0 / 28.0).abs() < 1e-12, "{loose:?}");
    }

    #[test]
    fn points_that_determine_no_line_or_explain_nothing_have_no_fit() {
        assert_eq!(Line::fit(&[]), None);
        assert_eq!(Line::fit(&[[0.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(Line::fit(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(Line::fit(&[[0.0, 2.0], [1.0, 2.0], [2.0, 2.0]]), None);
        assert_eq!(Line::fit(&[[0.0, f64::NAN], [1.0, 2.0], [2.0, 3.0]]), None);
        assert_eq!(Line::fit(&[[0.0, 1e300], [1.0, 2.0], [2.0, 3.0]]), None);
    }

    /// The points of a published curve have its coefficients again (KUZ, figure 6).
    #[test]
    fn a_published_curve_over_a_logarithm_is_found_again() {
        let curve = [10.0, 20.0, 40.0, 70.0, 100.0, 130.0].map(|n: f64| {
            let x = libm::log1p(n);
            [x, 0.901_073 * x - 0.673_763]
        });
        let line = Line::fit(&curve).unwrap();
        assert!((line.slope - 0.901_073).abs() < 1e-9 && (line.intercept + 0.673_763).abs() < 1e-9, "{line:?}");
    }
}
