//! How the data of a chart look.

use super::canvas::{Canvas, Point, Stroke};
use super::chart::{Chart, Data, Series};
use super::colour::{self, Colour, WHITE};
use super::scale::Axes;
use std::collections::BTreeSet;

/// Half the width of a mark.
const MARK: f64 = 3.4;
/// How far series with intervals stand from each other, so that bars at the same x do not hide each other.
const DODGE: f64 = 4.0;
/// Lines with more points than this per unit of width are thinned.
const POINTS_PER_UNIT: f64 = 4.0;

/// A series with its colour and mark.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// What is shown.
    pub series: &'a Series,
    /// Its colour.
    pub colour: Colour,
    /// Which mark it has: circle, square, triangle, diamond.
    mark: usize,
    /// Added to x in the picture.
    shift: f64,
}

/// The looks of a chart's series: colours and marks in turn, unless chosen.
pub fn looks(chart: &Chart) -> Vec<Look<'_>> {
    let is_interval = |series: &Series| matches!(series.data, Data::Intervals(_));
    let is_own = |series: &Series| is_interval(series) && !series.like_previous;
    let own = chart.series.iter().filter(|s| is_own(s)).count();
    let (mut used, mut shown) = (0, 0);
    let mut looks: Vec<Look<'_>> = Vec::with_capacity(chart.series.len());
    for series in &chart.series {
        let previous = looks.last().filter(|_| series.like_previous);
        let (colour, mark) = match (series.colour, previous) {
            (Some(colour), _) => (colour, used),
            (None, Some(previous)) => (previous.colour, previous.mark),
            (None, None) => {
                used += 1;
                (colour::nth(used - 1), used - 1)
            }
        };
        let mut shift = 0.0;
        if is_interval(series) {
            // One that looks like the series before it stands where that one stands.
            shown += usize::from(is_own(series));
            shift = (shown as f64 - (own + 1) as f64 / 2.0) * DODGE;
        }
        looks.push(Look {
            series,
            colour,
            mark,
            shift,
        });
    }
    looks
}

impl Look<'_> {
    /// The line of a line series.
    pub fn stroke(&self) -> Stroke {
        let stroke = Stroke::new(self.colour, 1.8);
        if self.series.dashed {
            stroke.dashed(6.0, 4.0)
        } else {
            stroke
        }
    }

    /// The line between marks.
    pub fn joint(&self) -> Stroke {
        let stroke = Stroke::new(self.colour, 1.3);
        if self.series.dashed {
            stroke.dashed(5.0, 3.5)
        } else {
            stroke
        }
    }

    /// The lines of error bars.
    pub fn whiskers(&self) -> Stroke {
        Stroke::new(self.colour, 1.2)
    }

    /// The inside of bars: what is behind them stays visible.
    pub fn fill(&self) -> Colour {
        self.colour.with_alpha(90)
    }

    /// Draws the mark.
    pub fn mark(&self, canvas: &mut Canvas, [x, y]: Point) {
        let edge = Some(Stroke::new(WHITE, 0.7));
        let fill = Some(self.colour);
        let m = MARK;
        let corners = match self.mark % 4 {
            0 => return canvas.circle([x, y], m, fill, edge),
            1 => vec![
                [x - m * 0.9, y - m * 0.9],
                [x + m * 0.9, y - m * 0.9],
                [x + m * 0.9, y + m * 0.9],
                [x - m * 0.9, y + m * 0.9],
            ],
            2 => vec![
                [x, y - m * 1.2],
                [x + m * 1.15, y + m * 0.9],
                [x - m * 1.15, y + m * 0.9],
            ],
            _ => vec![
                [x, y - m * 1.3],
                [x + m * 1.3, y],
                [x, y + m * 1.3],
                [x - m * 1.3, y],
            ],
        };
        canvas.polygon(corners, fill, edge);
    }
}

/// The three lines of an error bar.
pub fn whisker(x: f64, top: f64, bottom: f64) -> Vec<Vec<Point>> {
    vec![
        vec![[x, top], [x, bottom]],
        vec![[x - 3.0, top], [x + 3.0, top]],
        vec![[x - 3.0, bottom], [x + 3.0, bottom]],
    ]
}

/// Draws all series into a plotting area: bars lowest, then lines, then marks.
pub fn draw(looks: &[Look<'_>], axes: &Axes, canvas: &mut Canvas, plot: [f64; 4]) {
    let [left, top, width, height] = plot;
    let bottom = top + height;
    let place = |look: &Look<'_>, x: f64, y: f64| -> Option<Point> {
        let at = [
            left + width * axes.x.share(x) + look.shift,
            bottom - height * axes.y.share(y),
        ];
        // Far outside, coordinates would lose their precision in a reader.
        at.iter()
            .all(|value| value.is_finite() && value.abs() < 1e6)
            .then_some(at)
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
    let inside = |[x, y]: &Point| {
        (left - 0.5..=left + width + 0.5).contains(x) && (top - 0.5..=bottom + 0.5).contains(y)
    };
    for look in looks {
        let points: Vec<Point> = match &look.series.data {
            Data::Points(points) => points
                .iter()
                .filter_map(|[x, y]| place(look, *x, *y))
                .collect(),
            Data::Intervals(points) => points
                .iter()
                .filter_map(|[x, y, ..]| place(look, *x, *y))
                .collect(),
            Data::Line(_) | Data::Bars(_) => continue,
        };
        // Marks that would cover each other to half a unit are drawn once.
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
        // An axis that does not show zero has its bars stand on its edge.
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

/// Runs of neighbours that exist.
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

/// At most about `most` points that look the same: of each run of neighbours the first, lowest, highest and last.
fn thin(line: Vec<Point>, most: usize) -> Vec<Point> {
    if line.len() <= most.max(4) {
        return line;
    }
    let run = (4 * line.len()).div_ceil(most.max(4));
    line.chunks(run)
        .flat_map(|points| {
            let by_y = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
            let keep: BTreeSet<usize> = [
                Some(0),
                (0..points.len()).min_by(by_y),
                (0..points.len()).max_by(by_y),
                points.len().checked_sub(1),
            ]
            .into_iter()
            .flatten()
            .collect();
            keep.into_iter().map(|index| points[index])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the marks of series stand beside their true place; `true`: like the previous one.
    fn shifts(series: &[bool]) -> Vec<f64> {
        let chart = series.iter().fold(Chart::new("", "", ""), |chart, &like| {
            let one = Series::intervals("", [[1.0, 2.0, 1.0, 3.0]]);
            chart.with(if like { one.like_previous() } else { one })
        });
        looks(&chart).iter().map(|look| look.shift).collect()
    }

    #[test]
    fn error_bars_stand_side_by_side_around_their_place() {
        let half = DODGE / 2.0;
        assert_eq!(shifts(&[false]), [0.0]);
        assert_eq!(shifts(&[false, false]), [-half, half]);
        assert_eq!(shifts(&[false, true]), [0.0, 0.0]);
        assert_eq!(
            shifts(&[false, true, false, true]),
            [-half, -half, half, half]
        );
        assert_eq!(shifts(&[false, false, false]), [-DODGE, 0.0, DODGE]);
    }
}
