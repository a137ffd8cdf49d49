//! Thresholds (PAV, conclusion): the K1 / K2 above which a crowd is separate robots instead of a
//! group. The paper's program chooses such thresholds, but neither method nor values are given.
//!
//! Here, group order is the excess over independent robots (K2 = 0, all else equal) of the share of
//! the largest group, and of company. The threshold is the first crossing of half the peak behind
//! the peak over K1 / K2, interpolated geometrically.

use super::setting::{Setting, short, varying};
use crate::experiment::Maybe;
use serde::Serialize;
use std::fmt::{self, Formatter};

#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    pub setting: Setting,
    pub together: Option<f64>,
    pub company: Option<f64>,
}

/// Threshold of one curve over K1 / K2.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Threshold {
    /// Common setting of the points; K1 and K2 are 0.
    #[serde(skip)]
    pub setting: Setting,
    /// Parameters in which curves differ, as text.
    pub curve: String,
    /// Threshold of the share of the largest group.
    pub together: Crossing,
    /// Threshold of company.
    pub company: Crossing,
}

/// Peak, and crossing of half the peak.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Crossing {
    /// Excess over independent robots.
    pub peak: Option<f64>,
    pub peak_k1_over_k2: Option<f64>,
    /// `null` if no point is below half the peak, or no peak is above 0.
    pub k1_over_k2: Option<f64>,
}

impl Crossing {
    #[must_use]
    pub fn of(curve: &[[f64; 2]]) -> Self {
        let mut best: Option<usize> = None;
        for (index, [_, value]) in curve.iter().enumerate() {
            if best.is_none_or(|best| *value > curve[best][1]) {
                best = Some(index);
            }
        }
        let Some(best) = best else {
            return Self::default();
        };
        let [ratio, peak] = curve[best];
        let half = peak / 2.0;
        let mut steps = curve[best..].windows(2).filter(|_| peak > 0.0);
        let step = steps.find(|step| step[1][1] <= half);
        let crossed = step.map(|step| {
            let [[x, y], [next_x, next_y]] = [step[0], step[1]];
            let part = (y - half) / (y - next_y);
            if x > 0.0 { x * libm::pow(next_x / x, part) } else { next_x * part }
        });
        Self { peak: Some(peak), peak_k1_over_k2: Some(ratio), k1_over_k2: crossed }
    }
}

pub(super) fn of(points: &[Gain]) -> Vec<Threshold> {
    let mut curves: Vec<Setting> = Vec::new();
    for point in points {
        let common = point.setting.without_gains();
        if !curves.contains(&common) {
            curves.push(common);
        }
    }
    let differ = varying(&curves);
    let thresholds = curves.iter().map(|&setting| {
        let own = || points.iter().filter(move |point| point.setting.without_gains() == setting);
        let crossing = |value: fn(&Gain) -> Option<f64>| {
            let values = own().filter_map(|point| Some([point.setting.ratio()?, value(point)?]));
            let mut curve: Vec<[f64; 2]> = values.filter(|[ratio, _]| *ratio >= 0.0).collect();
            curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
            (curve.len(), Crossing::of(&curve))
        };
        let (count, together) = crossing(|point| point.together);
        let given = setting.given();
        let words = differ
            .iter()
            .filter(|place| **place > 1)
            .map(|&place| format!("{} {}", short(given[place].0), given[place].1));
        let curve = words.collect::<Vec<_>>().join(", ");
        (count, Threshold { setting, curve, together, company: crossing(|point| point.company).1 })
    });
    thresholds.filter(|(count, _)| *count >= 3).map(|(_, threshold)| threshold).collect()
}

pub(super) fn table(f: &mut Formatter<'_>, thresholds: &[Threshold]) -> fmt::Result {
    if thresholds.is_empty() {
        return Ok(());
    }
    writeln!(
        f,
        "\nthresholds: the K1/K2 above the peak at which the advantage of a group over independent robots (K2 = 0) is half"
    )?;
    writeln!(f, "{:<40}{:>28}{:>28}", "", "together", "company")?;
    let heads = format!("{:>9}{:>8}{:>11}", "peak", "at", "threshold");
    writeln!(f, "{:<40}{heads}{heads}", "curve")?;
    for threshold in thresholds {
        write!(f, "{:<40}", if threshold.curve.is_empty() { "all" } else { &threshold.curve })?;
        for (crossing, digits) in [(&threshold.together, 3), (&threshold.company, 1)] {
            write!(
                f,
                "{:>9}{:>8}{:>11}",
                Maybe(crossing.peak, digits),
                Maybe(crossing.peak_k1_over_k2, 2),
                Maybe(crossing.k1_over_k2, 2)
            )?;
        }
        writeln!(f)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_peak_is_interpolated_geometrically_behind_the_peak() {
        let curve = [[0.0, 0.2], [0.25, 0.8], [1.0, 0.6], [4.0, 0.2], [16.0, 0.1]];
        let crossing = Crossing::of(&curve);
        assert_eq!((crossing.peak, crossing.peak_k1_over_k2), (Some(0.8), Some(0.25)));
        let at = crossing.k1_over_k2.unwrap();
        assert!((at - 2.0).abs() < 1e-9, "{at}");
    }

    #[test]
    fn curves_that_never_fall_or_never_rise_above_0_have_no_threshold() {
        assert_eq!(Crossing::of(&[[0.1, 0.9], [1.0, 0.9], [10.0, 0.9]]).k1_over_k2, None);
        assert_eq!(Crossing::of(&[[0.1, -0.1], [1.0, -0.3], [10.0, -0.9]]).k1_over_k2, None);
        assert_eq!(Crossing::of(&[]).peak, None);
    }
}
