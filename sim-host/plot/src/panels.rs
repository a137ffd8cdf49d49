//! Pictures of one or more charts.

use super::canvas::Canvas;
use super::chart::Chart;
use super::layout;
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

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

    /// Writes `<stem>.svg` and `<stem>.png` and returns the paths; see [`Canvas::write`].
    ///
    /// # Errors
    /// The directory or a file cannot be written.
    pub fn write(&self, stem: &Path) -> Result<Vec<PathBuf>, Error> {
        self.draw().write(stem)
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
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let column = |index: usize| self.charts.iter().skip(index).step_by(self.columns);
        let columns = self.columns.min(self.charts.len());
        let widths: Vec<f64> = (0..columns).map(|index| most(&mut column(index).map(|chart| chart.size[0]))).collect();
        let lefts: Vec<f64> = (0..columns).map(|index| most(&mut column(index).map(layout::left_margin))).collect();
        let rows: Vec<&[Chart]> = self.charts.chunks(self.columns).collect();
        let heights: Vec<f64> = rows.iter().map(|row| most(&mut row.iter().map(|chart| chart.size[1]))).collect();
        let (width, top) = (widths.iter().sum::<f64>().max(200.0), layout::headline_height(&self.title));
        let height = (top + heights.iter().sum::<f64>()).max(150.0);
        let mut canvas = Canvas::new(width, height, &self.title);
        layout::headline(&mut canvas, &self.title, width);
        let mut y = top;
        for (row, height) in rows.into_iter().zip(heights) {
            let mut x = 0.0;
            for ((chart, width), left) in row.iter().zip(&widths).zip(&lefts) {
                layout::draw(chart, &mut canvas, [x, y, *width, height], *left);
                x += width;
            }
            y += height;
        }
        canvas
    }

    /// Writes `<stem>.svg` and `<stem>.png` and returns the paths; see [`Canvas::write`].
    ///
    /// # Errors
    /// The directory or a file cannot be written.
    pub fn write(&self, stem: &Path) -> Result<Vec<PathBuf>, Error> {
        self.draw().write(stem)
    }
}
