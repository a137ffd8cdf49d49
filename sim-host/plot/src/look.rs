//! Style of series: colours, marks and lines.

use super::canvas::{Canvas, Point, Stroke};
use super::chart::{Chart, Kind, Series};
use super::colour::{self, Colour, WHITE};

const MARK: f64 = 3.4;
/// Horizontal offset between series with intervals, so that error bars do not overlap.
const DODGE: f64 = 4.0;
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    pub series: &'a Series,
    pub colour: Colour,
    /// Circle, square, triangle or diamond.
    pub mark: usize,
    pub shift: f64,
}

pub fn looks(chart: &Chart) -> Vec<Look<'_>> {
    let is_interval = |series: &Series| series.kind == Kind::Intervals;
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
            // A series in the style of the previous one has its offset too.
            shown += usize::from(is_own(series));
            shift = (shown as f64 - (own + 1) as f64 / 2.0) * DODGE;
        }
        looks.push(Look { series, colour, mark, shift });
    }
    looks
}

impl Look<'_> {
    pub fn stroke(&self) -> Stroke {
        let stroke = Stroke::new(self.colour, 1.8);
        if self.series.dashed { stroke.dashed(6.0, 4.0) } else { stroke }
    }

    pub fn joint(&self) -> Stroke {
        let stroke = Stroke::new(self.colour, 1.3);
        if self.series.dashed { stroke.dashed(5.0, 3.5) } else { stroke }
    }

    pub fn whiskers(&self) -> Stroke {
        Stroke::new(self.colour, 1.2)
    }

    /// Transparent, so that items behind stay visible.
    pub fn bar(&self, canvas: &mut Canvas, area: [f64; 4]) {
        canvas.rectangle(area, Some(self.colour.with_alpha(90)), Some(Stroke::new(self.colour, 0.8)));
    }

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
            2 => vec![[x, y - m * 1.2], [x + m * 1.15, y + m * 0.9], [x - m * 1.15, y + m * 0.9]],
            _ => vec![[x, y - m * 1.3], [x + m * 1.3, y], [x, y + m * 1.3], [x - m * 1.3, y]],
        };
        canvas.polygon(corners, fill, edge);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `true` means "like the previous one".
    fn shifts(series: &[bool]) -> Vec<f64> {
        let chart = series.iter().fold(Chart::new("", "", ""), |chart, &like| {
            let one = Series::intervals("", [[1.0, 2.0, 1.0, 3.0]]);
            chart.with(if like { one.like_previous() } else { one })
        });
        looks(&chart).iter().map(|look| look.shift).collect()
    }

    #[test]
    fn error_bars_are_side_by_side_around_their_x() {
        let half = DODGE / 2.0;
        assert_eq!(shifts(&[false]), [0.0]);
        assert_eq!(shifts(&[false, false]), [-half, half]);
        assert_eq!(shifts(&[false, true]), [0.0, 0.0]);
        assert_eq!(shifts(&[false, true, false, true]), [-half, -half, half, half]);
        assert_eq!(shifts(&[false, false, false]), [-DODGE, 0.0, DODGE]);
    }
}
