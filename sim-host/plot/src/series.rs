//! Draws the data of a chart.

use super::canvas::{Canvas, Point, Stroke};
use super::chart::Data;
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
    for look in looks {
        if let Data::Bars(bars) = &look.series.data {
            draw_bars(look, bars, &|x, y| place(look, x, y), canvas, plot);
        }
    }
    for look in looks {
        let place = |x: f64, y: f64| place(look, x, y);
        match &look.series.data {
            Data::Line(points) => {
                let lines = connected(points.iter().map(|[x, y]| place(*x, *y)));
                let most = (width * POINTS_PER_UNIT) as usize;
                let lines = lines.into_iter().map(|line| thin(line, most)).collect();
                canvas.lines(lines, look.stroke());
            }
            Data::Points(points) if look.series.joined => {
                let lines = connected(points.iter().map(|[x, y]| place(*x, *y)));
                canvas.lines(lines, look.joint());
            }
            Data::Intervals(points) => {
                if look.series.joined {
                    let lines = connected(points.iter().map(|[x, y, ..]| place(*x, *y)));
                    canvas.lines(lines, look.joint());
                }
                let bars = points.iter().filter_map(|[x, _, low, high]| {
                    let ([x, bottom], [_, top]) = (place(*x, *low)?, place(*x, *high)?);
                    Some(whisker(x, top, bottom))
                });
                canvas.lines(bars.flatten().collect(), look.whiskers());
            }
            Data::Points(_) | Data::Bars(_) => {}
        }
    }
    canvas.clip(None);
    let inside =
        |[x, y]: &Point| (left - 0.5..=left + width + 0.5).contains(x) && (top - 0.5..=bottom + 0.5).contains(y);
    for look in looks {
        let points: Vec<Point> = match &look.series.data {
            Data::Points(points) => points.iter().filter_map(|[x, y]| place(look, *x, *y)).collect(),
            Data::Intervals(points) => points.iter().filter_map(|[x, y, ..]| place(look, *x, *y)).collect(),
            Data::Line(_) | Data::Bars(_) => continue,
        };
        let mut taken = BTreeSet::new();
        for point in points.into_iter().filter(inside) {
            if taken.insert(point.map(|value| (value * 2.0) as i32)) {
                look.mark(canvas, point);
            }
        }
    }
}

fn draw_bars(
    look: &Look<'_>,
    bars: &[[f64; 3]],
    place: &dyn Fn(f64, f64) -> Option<Point>,
    canvas: &mut Canvas,
    [_, top, _, height]: [f64; 4],
) {
    for [from, to, value] in bars {
        let (Some([x, y]), Some([right, zero])) = (place(*from, *value), place(*to, 0.0)) else {
            continue;
        };
        // If zero is not on the axis, bars start at its edge.
        let zero = zero.clamp(top, top + height);
        let (upper, lower) = (y.min(zero), y.max(zero));
        let width = (right - x).abs();
        let gap = (width * 0.06).min(1.0);
        canvas.rectangle(
            [x.min(right) + gap / 2.0, upper, width - gap, lower - upper],
            Some(look.fill()),
            Some(Stroke::new(look.colour, 0.8)),
        );
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
