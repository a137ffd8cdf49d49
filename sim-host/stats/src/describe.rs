//! Summaries, quantiles, histograms.

use super::special::student_t_quantile;
use libm::{ceil, floor, sqrt};

/// Summary of a sample.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Standard deviation of the sample (divisor count - 1); 0 for one value.
    pub deviation: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Half the width of the 95 % interval of the mean by Student's t; `None` for one value.
    pub mean_error95: Option<f64>,
}

impl Summary {
    /// Describes the values; `None` if there are none or one is not finite. O(n log n).
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mean = mean(values)?;
        let sorted = sorted(values)?;
        let count = values.len();
        let freedom = (count - 1) as f64;
        let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        let deviation = if count > 1 { sqrt(squares / freedom) } else { 0.0 };
        let mean_error95 = (count > 1).then(|| student_t_quantile(0.975, freedom) * deviation / sqrt(count as f64));
        Some(Self {
            count,
            mean,
            median: quantile_sorted(&sorted, 0.5),
            deviation,
            min: sorted[0],
            max: sorted[count - 1],
            mean_error95,
        })
    }

    /// The summary of the values divided by `unit`, which is above 0.
    #[must_use]
    pub fn of_unit(&self, unit: f64) -> Self {
        let Self { mean, median, deviation, min, max, .. } = *self;
        let [mean, median, deviation, min, max] = [mean, median, deviation, min, max].map(|value| value / unit);
        let mean_error95 = self.mean_error95.map(|error| error / unit);
        Self { count: self.count, mean, median, deviation, min, max, mean_error95 }
    }

    /// The 95 % interval of the mean by Student's t: exact for normal values, else approximate. For
    /// one value, both ends are the mean.
    #[must_use]
    pub fn mean_interval95(&self) -> [f64; 2] {
        let error = self.mean_error95.unwrap_or(0.0);
        [self.mean - error, self.mean + error]
    }
}

/// Arithmetic mean; `None` if there are no values or one is not finite.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().sum();
    (!values.is_empty() && values.iter().all(|x| x.is_finite())).then_some(sum / values.len() as f64)
}

/// The value below which a share `p` of the values lies, linear between the order statistics
/// (Hyndman and Fan's type 7, the default of R and NumPy).
///
/// `None` if there are no values, one is not finite, or `p` is outside 0..=1. O(n log n).
#[must_use]
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    let sorted = sorted(values)?;
    (0.0..=1.0).contains(&p).then(|| quantile_sorted(&sorted, p))
}

fn quantile_sorted(sorted: &[f64], p: f64) -> f64 {
    let at = p * (sorted.len() - 1) as f64;
    let low = floor(at);
    let (a, b) = (sorted[low as usize], sorted[ceil(at) as usize]);
    a + (b - a) * (at - low)
}

pub(super) fn sorted(values: &[f64]) -> Option<Vec<f64>> {
    let usable = !values.is_empty() && values.iter().all(|x| x.is_finite());
    usable.then(|| {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted
    })
}

/// Counts in bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Left edge of the first bin.
    pub low: f64,
    /// Width of each bin; more than 0.
    pub width: f64,
    /// Values in each bin.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// Counts the values in at most `max_bins` bins between the smallest and the largest. Bins of
    /// whole numbers have whole widths and edges halfway between numbers, so that each has equally
    /// many.
    ///
    /// `None` if there are no values, one is not finite, or `max_bins` is 0.
    #[must_use]
    pub fn new(values: &[f64], max_bins: usize) -> Option<Self> {
        let sorted = sorted(values)?;
        let (min, max) = (sorted[0], sorted[sorted.len() - 1]);
        if max_bins == 0 || !(max - min).is_finite() {
            return None;
        }
        let whole = sorted.iter().all(|&x| floor(x) == x);
        let (low, width) = if whole {
            (min - 0.5, ceil((max - min + 1.0) / max_bins as f64))
        } else {
            (min, (max - min) / max_bins as f64)
        };
        if low + width == low {
            let half = (libm::fabs(min) * 1e-9).max(0.5);
            return Some(Self { low: min - half, width: 2.0 * half, counts: vec![sorted.len() as u64] });
        }
        let bins = (ceil((max - low) / width) as usize).clamp(1, max_bins);
        let mut counts = vec![0; bins];
        for x in sorted {
            counts[(floor((x - low) / width) as usize).min(bins - 1)] += 1;
        }
        Some(Self { low, width, counts })
    }

    /// Middle and density (share of the values per unit of x) of each bin: the total area is 1.
    #[must_use]
    pub fn density(&self) -> Vec<[f64; 2]> {
        let total: u64 = self.counts.iter().sum();
        let middle = |bin: usize| self.low + (bin as f64 + 0.5) * self.width;
        let density = |count: u64| count as f64 / (total as f64 * self.width);
        (0..).zip(&self.counts).map(|(bin, &count)| [middle(bin), density(count)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_and_nan_have_no_summary() {
        assert_eq!(Summary::of(&[]), None);
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(Summary::of(&[1.0, bad]), None);
            assert_eq!(quantile(&[bad], 0.5), None);
            assert_eq!(Histogram::new(&[bad], 3), None);
        }
        assert_eq!(quantile(&[1.0], 1.1), None);
        assert_eq!(quantile(&[1.0], f64::NAN), None);
    }

    #[test]
    fn one_value_is_its_own_summary_without_an_interval() {
        let one = Summary::of(&[4.0]).unwrap();
        assert_eq!((one.mean, one.median, one.deviation), (4.0, 4.0, 0.0));
        assert_eq!(one.mean_error95, None);
        assert_eq!(one.mean_interval95(), [4.0, 4.0]);
    }

    #[test]
    fn interval_is_that_of_the_t_table() {
        let five = Summary::of(&[5.0, 1.0, 4.0, 2.0, 3.0]).unwrap();
        assert!((five.mean_error95.unwrap() - 1.963_243).abs() < 1e-6);
        assert_eq!((five.mean, five.median), (3.0, 3.0));
        assert_eq!((five.min, five.max), (1.0, 5.0));
    }

    #[test]
    fn quantiles_are_linear_between_order_statistics() {
        let values = [4.0, 1.0, 3.0, 2.0];
        for (p, want) in [(0.0, 1.0), (0.25, 1.75), (0.5, 2.5), (0.9, 3.7), (1.0, 4.0)] {
            assert!((quantile(&values, p).unwrap() - want).abs() < 1e-12, "{p}");
        }
    }

    #[test]
    fn histogram_counts_everything_once_and_has_area_one() {
        let values: Vec<f64> = (0..997).map(|i| f64::from(i * i % 613) / 7.0).collect();
        for bins in [1, 2, 30, 5000] {
            let histogram = Histogram::new(&values, bins).unwrap();
            assert!(histogram.counts.len() <= bins);
            assert_eq!(histogram.counts.iter().sum::<u64>(), 997);
            let area: f64 = histogram.density().iter().map(|[_, d]| d * histogram.width).sum();
            assert!((area - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn bins_of_whole_numbers_hold_equally_many_of_them() {
        let values: Vec<f64> = (0..100).map(f64::from).collect();
        let histogram = Histogram::new(&values, 30).unwrap();
        assert_eq!((histogram.low, histogram.width), (-0.5, 4.0));
        assert_eq!(histogram.counts, [4; 25]);
    }

    #[test]
    fn equal_values_fill_one_bin() {
        for x in [0.0, 0.3, 7.0, -1e300] {
            let histogram = Histogram::new(&[x, x, x], 10).unwrap();
            assert_eq!(histogram.counts, [3], "{x}");
            assert!(histogram.low < x && x < histogram.low + histogram.width, "{x}");
        }
        assert_eq!(Histogram::new(&[-1e308, 1e308], 10), None);
    }
}
