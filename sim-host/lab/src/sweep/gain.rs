//! Gains of a figure over an axis: its means minus those at one value of the axis, else equal.

use crate::sweep::plan::{GainTable, Plan};
use crate::sweep::value::{Point, short};
use serde::Serialize;

/// Gains at all values of an axis, with equal values of the other axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// The figure.
    pub figure: String,
    /// Values of the other axes.
    pub others: String,
    /// Values of the axis with their gains.
    pub gains: Vec<(f64, f64)>,
    /// Value of the axis, from the reference to the peak, at which the gain is half of the peak,
    /// interpolated geometrically; `None` if no gain is above 0.
    pub half_at: Option<f64>,
}

/// Computes the gains of a table in the order of the points.
#[must_use]
pub fn gains(plan: &Plan, points: &[Point], table: &GainTable) -> Vec<Gain> {
    let Some((axis, figure)) = plan.find(&table.over).zip(plan.measures().iter().position(|it| *it == table.figure))
    else {
        return Vec::new();
    };
    let mut curves: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for point in points {
        let mut others = point.values.clone();
        let value = others.remove(axis);
        let Some((value, summary)) = value.parse().ok().zip(point.figures[figure]) else { continue };
        let others = others.join(" ");
        match curves.iter_mut().find(|(known, _)| *known == others) {
            Some((_, curve)) => curve.push((value, summary.mean)),
            None => curves.push((others, vec![(value, summary.mean)])),
        }
    }
    let gain = |(others, mut curve): (String, Vec<(f64, f64)>)| {
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (_, from) = *curve.iter().find(|(value, _)| *value == table.from)?;
        curve.iter_mut().for_each(|(_, mean)| *mean -= from);
        Some(Gain { figure: table.figure.clone(), others, half_at: half_at(&curve, table.from), gains: curve })
    };
    curves.into_iter().filter_map(gain).collect()
}

fn half_at(curve: &[(f64, f64)], from: f64) -> Option<f64> {
    let start = curve.iter().position(|(value, _)| *value == from)?;
    let (best, &(_, peak)) = curve.iter().enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    let way: Vec<_> =
        if best >= start { curve[start..=best].to_vec() } else { curve[best..=start].iter().rev().copied().collect() };
    // The last crossing before the peak.
    let step = way.windows(2).rev().find(|step| peak > 0.0 && step[0].1 <= peak / 2.0)?;
    let [(x, y), (next_x, next_y)] = [step[0], step[1]];
    let part = (peak / 2.0 - y) / (next_y - y);
    Some(if x > 0.0 && next_x > 0.0 { x * libm::pow(next_x / x, part) } else { x + (next_x - x) * part })
}

/// The gains as lines of a table.
#[must_use]
pub fn text(table: &GainTable, gains: &[Gain]) -> String {
    let mut text = format!("gain of {} over {} = {}\n", table.figure, table.over, short(table.from));
    for Gain { others, gains, half_at, .. } in gains {
        let cells: Vec<_> = gains.iter().map(|(value, gain)| format!("{}: {}", short(*value), short(*gain))).collect();
        let half = half_at.map_or("-".to_owned(), short);
        text += &format!("  {others}  {}  half of the peak at {half}\n", cells.join("  "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::half_at;

    #[test]
    fn half_of_the_peak_is_interpolated_geometrically_before_the_peak() {
        let curve = [(0.0, 0.0), (1.0, 0.2), (4.0, 0.6), (16.0, 0.8), (64.0, 0.1)];
        let at = half_at(&curve, 0.0).unwrap();
        assert!((at - 2.0).abs() < 1e-9, "{at}");
        let reversed = curve.map(|(value, gain)| (-value, gain)).into_iter().rev().collect::<Vec<_>>();
        let at = half_at(&reversed, 0.0).unwrap();
        assert!((at + 2.5).abs() < 1e-9, "{at}");
    }

    #[test]
    fn a_curve_that_never_rises_has_no_half() {
        assert_eq!(half_at(&[(0.0, 0.0), (1.0, -0.1), (2.0, -0.3)], 0.0), None);
        assert_eq!(half_at(&[(1.0, 0.0)], 0.0), None);
    }
}
