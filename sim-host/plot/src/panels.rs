//! Pictures of one or more charts.

use super::canvas::Canvas;
use super::chart::Chart;
use super::layout;

impl Chart {
    /// Draws the chart.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let [width, height] = self.size;
        let mut canvas = Canvas::new(width, height, &self.title);
        let area = [0.0, 0.0, width, height];
        layout::draw(self, &mut canvas, area, layout::left_margin(self));
        canvas
    }
}

/// Several charts in one picture, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Panels {
    title: String,
    columns: usize,
    charts: Vec<Chart>,
}

impl Panels {
    /// Creates panels without charts, one per row. The title may be empty.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), columns: 1, charts: Vec::new() }
    }

    /// Adds a chart with its own size. Axes of a column are aligned.
    #[must_use]
    pub fn with(mut self, chart: Chart) -> Self {
        self.charts.push(chart);
        self
    }

    /// Sets the number of charts per row, at least 1.
    #[must_use]
    pub fn columns(self, columns: usize) -> Self {
        Self { columns: columns.max(1), ..self }
    }

    /// Draws the charts.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let sizes: Vec<[f64; 2]> = self.charts.iter().map(|chart| chart.size).collect();
        let (mut canvas, areas) = layout::sheet(&self.title, self.columns, &sizes, |_, top| top);
        let lefts: Vec<f64> = self.charts.iter().map(layout::left_margin).collect();
        for (index, (chart, area)) in self.charts.iter().zip(areas).enumerate() {
            let column = lefts.iter().skip(index % self.columns).step_by(self.columns);
            layout::draw(chart, &mut canvas, area, column.copied().fold(0.0, f64::max));
        }
        canvas
    }
}
