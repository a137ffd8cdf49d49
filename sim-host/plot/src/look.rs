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

pub fn looks<'a>(chart: &'a Chart) -> Vec<Look<'a>> {
    let is_interval = |series: &Series| series.kind == Kind::Intervals;
    let intervals = chart.series.iter().filter(|series| is_interval(series)).count();
    let (mut used, mut shown) = (0, 0);
    let look = |series: &'a Series| {
        let (colour, mark) = (series.colour.unwrap_or_else(|| colour::nth(used)), used);
        used += usize::from(series.colour.is_none());
        shown += usize::from(is_interval(series));
        let middle = (intervals + 1) as f64 / 2.0;
        let shift = if is_interval(series) { (shown as f64 - middle) * DODGE } else { 0.0 };
        Look { series, colour, mark, shift }
    };
    chart.series.iter().map(look).collect()
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
        let (fill, edge) = (Some(self.colour), Some(Stroke::new(WHITE, 0.7)));
        let corners: &[Point] = match self.mark % 4 {
            0 => return canvas.circle([x, y], MARK, fill, edge),
            1 => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
            2 => &[[0.0, -1.2], [1.15, 0.9], [-1.15, 0.9]],
            _ => &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]],
        };
        let corners = corners.iter().map(|[dx, dy]| [x + MARK * dx, y + MARK * dy]).collect();
        canvas.polygon(corners, fill, edge);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_bars_are_side_by_side_around_their_x() {
        let shifts = |count: u32| {
            let one = || Series::intervals("", [[1.0, 2.0, 1.0, 3.0]]);
            let chart = (0..count).fold(Chart::new("", "", ""), |chart, _| chart.with(one()));
            looks(&chart).iter().map(|look| look.shift).collect::<Vec<_>>()
        };
        assert_eq!(shifts(1), [0.0]);
        assert_eq!(shifts(2), [-DODGE / 2.0, DODGE / 2.0]);
        assert_eq!(shifts(3), [-DODGE, 0.0, DODGE]);
    }
}
