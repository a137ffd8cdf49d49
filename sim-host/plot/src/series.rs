//! Draws the data of a chart.

use super::canvas::{Canvas, Point};
use super::chart::Kind;
use super::look::Look;
use super::scale::Axes;
use std::collections::BTreeSet;

/// Denser lines are thinned; points per unit of width.
const POINTS_PER_UNIT: f64 = 4.0;

pub fn whisker(x: f64, top: f64, bottom: f64) -> Vec<Vec<Point>> {
    vec![vec![[x, top], [x, bottom]], vec![[x - 3.0, top], [x + 3.0, top]], vec![[x - 3.0, bottom], [x + 3.0, bottom]]]
}

/// Bars are at the bottom, then lines, then marks.
pub fn draw(looks: &[Look<'_>], axes: &Axes, canvas: &mut Canvas, plot: [f64; 4]) {
    let [left, top, width, height] = plot;
    let bottom = top + height;
    let place = |look: &Look<'_>, x: f64, y: f64| -> Option<Point> {
        let at = [left + width * axes.x.share(x) + look.shift, bottom - height * axes.y.share(y)];
        // SVG readers lose precision for coordinates far outside.
        at.iter().all(|value| value.is_finite() && value.abs() < 1e6).then_some(at)
    };
    // Lines at the edge keep their full width.
    canvas.clip(Some([left - 1.0, top - 1.0, width + 2.0, height + 2.0]));
    for look in looks.iter().filter(|look| look.series.kind == Kind::Bars) {
        for [from, value, to, _] in &look.series.values {
            let (Some([x, y]), Some([right, zero])) = (place(look, *from, *value), place(look, *to, 0.0)) else {
                continue;
            };
            // If zero is not on the axis, bars start at its edge.
            let zero = zero.clamp(top, bottom);
            let (upper, lower) = (y.min(zero), y.max(zero));
            let width = (right - x).abs();
            let gap = (width * 0.06).min(1.0);
            look.bar(canvas, [x.min(right) + gap / 2.0, upper, width - gap, lower - upper]);
        }
    }
    let others = || looks.iter().filter(|look| look.series.kind != Kind::Bars);
    for look in others() {
        let lines = || connected(look.series.values.iter().map(|[x, y, ..]| place(look, *x, *y)));
        if look.series.kind == Kind::Line {
            let most = (width * POINTS_PER_UNIT) as usize;
            canvas.lines(lines().into_iter().map(|line| thin(line, most)).collect(), look.stroke());
        } else if look.series.joined {
            canvas.lines(lines(), look.joint());
        }
        if look.series.kind == Kind::Intervals {
            let bars = look.series.values.iter().filter_map(|[x, _, low, high]| {
                let ([x, bottom], [_, top]) = (place(look, *x, *low)?, place(look, *x, *high)?);
                Some(whisker(x, top, bottom))
            });
            canvas.lines(bars.flatten().collect(), look.whiskers());
        }
    }
    canvas.clip(None);
    let inside =
        |[x, y]: &Point| (left - 0.5..=left + width + 0.5).contains(x) && (top - 0.5..=bottom + 0.5).contains(y);
    for look in others().filter(|look| look.series.kind != Kind::Line) {
        let points = look.series.values.iter().filter_map(|[x, y, ..]| place(look, *x, *y));
        let mut taken = BTreeSet::new();
        for point in points.filter(inside) {
            if taken.insert(point.map(|value| (value * 2.0) as i32)) {
                look.mark(canvas, point);
            }
        }
    }
}

fn connected(points: impl Iterator<Item = Option<Point>>) -> Vec<Vec<Point>> {
    let mut lines = vec![Vec::new()];
    for point in points {
        match (point, lines.last_mut()) {
            (Some(point), Some(line)) => line.push(point),
            (None, Some(line)) if line.is_empty() => {}
            _ => lines.push(Vec::new()),
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

/// Keeps the first, lowest, highest and last point of each interval, without visible change.
fn thin(line: Vec<Point>, most: usize) -> Vec<Point> {
    if line.len() <= most.max(4) {
        return line;
    }
    let run = (4 * line.len()).div_ceil(most.max(4));
    line.chunks(run)
        .flat_map(|points| {
            let by_y = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
            let keep: BTreeSet<usize> =
                [Some(0), (0..points.len()).min_by(by_y), (0..points.len()).max_by(by_y), points.len().checked_sub(1)]
                    .into_iter()
                    .flatten()
                    .collect();
            keep.into_iter().map(|index| points[index])
        })
        .collect()
}
