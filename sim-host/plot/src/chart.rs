//! Content of charts.
//!
//! ```ignore
//! use staya_plot::{Chart, Panels, Series};
//! # fn main() -> Result<(), staya_sim::record::Error> {
//! let mut loss = Chart::new("Route loss on natural land", "obstacles", "loss (%)")
//!     .with(Series::intervals("measured", [[10.0, 4.1, 3.9, 4.3], [40.0, 9.0, 8.6, 9.4]])
//!         .joined())
//!     .with(Series::reference("paper", [[10.0, 5.0], [40.0, 11.0]]));
//! loss.note = "1000 runs each, 95 % intervals".into();
//! let times = Chart::new("Arrival times", "ticks", "runs")
//!     .with(Series::bars("runs", [[0.0, 10.0, 3.0], [10.0, 20.0, 8.0]]));
//! loss.draw().write("out/loss".as_ref())?;
//! Panels::new("Routes").with(loss).with(times).draw().write("out/routes".as_ref())?;
//! # Ok(()) }
//! ```

use super::colour::{Colour, MUTED};

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Line,
    Points,
    Intervals,
    Bars,
}

/// A set of values with one style and one entry in the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// x, y, low, high, in the order in which they are joined; of bars from x, height, to x. Values
    /// that are not finite are skipped and leave gaps in lines.
    pub(super) values: Vec<[f64; 4]>,
    pub(super) colour: Option<Colour>,
    pub(super) dashed: bool,
    pub(super) joined: bool,
}

impl Series {
    fn new(name: impl Into<String>, kind: Kind, values: impl Iterator<Item = [f64; 4]>) -> Self {
        let (name, values) = (name.into(), values.collect());
        Self { name, kind, values, colour: None, dashed: false, joined: false }
    }

    /// A line through `[x, y]` in this order. An empty name keeps it out of the legend.
    #[must_use]
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self::new(name, Kind::Line, points.into_iter().map(|[x, y]| [x, y, y, y]))
    }

    /// Marks at `[x, y]`.
    #[must_use]
    pub fn points(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self::new(name, Kind::Points, points.into_iter().map(|[x, y]| [x, y, y, y]))
    }

    /// Marks with error bars at `[x, y, low, high]`, such as a mean and its 95 % interval.
    #[must_use]
    pub fn intervals(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 4]>) -> Self {
        Self::new(name, Kind::Intervals, points.into_iter())
    }

    /// Bars `[from x, to x, height]`, such as a histogram.
    #[must_use]
    pub fn bars(name: impl Into<String>, bars: impl IntoIterator<Item = [f64; 3]>) -> Self {
        Self::new(name, Kind::Bars, bars.into_iter().map(|[from, to, height]| [from, height, to, 0.0]))
    }

    /// A dashed grey line through `[x, y]`, for a goal or values from elsewhere.
    #[must_use]
    pub fn reference(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self::line(name, points).dashed().colour(MUTED)
    }

    /// Joins the marks of [`Series::points`] and [`Series::intervals`] by a thin line.
    #[must_use]
    pub fn joined(self) -> Self {
        Self { joined: true, ..self }
    }

    /// Draws the line with dashes.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// Uses this colour instead of the next one of the palette.
    #[must_use]
    pub fn colour(self, colour: Colour) -> Self {
        Self { colour: Some(colour), ..self }
    }
}

/// A chart with linear or logarithmic axes, ticks at multiples of 1, 2 or 5 x 10^k, and a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub(super) title: String,
    /// A small line of text under the title; may be empty.
    pub note: String,
    pub(super) x_label: String,
    pub(super) y_label: String,
    /// Lowest and highest x; `None` fits all data.
    pub x_range: Option<[f64; 2]>,
    pub(super) x_names: Vec<String>,
    /// Whether the x axis is logarithmic; values of 0 and below are skipped.
    pub log_x: bool,
    /// Whether the y axis is logarithmic; values of 0 and below are skipped, and bars too.
    pub log_y: bool,
    pub(super) size: [f64; 2],
    pub(super) series: Vec<Series>,
}

impl Chart {
    /// Creates an empty chart of 720 x 420 units (two PNG pixels each). Labels include the unit.
    #[must_use]
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            note: String::new(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            x_range: None,
            x_names: Vec::new(),
            log_x: false,
            log_y: false,
            size: [720.0, 420.0],
            series: Vec::new(),
        }
    }

    /// Adds a series above the previous ones.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Writes names instead of the numbers 1, 2, ... below the x axis, which has no label then.
    #[must_use]
    pub fn names(self, names: Vec<String>) -> Self {
        let x_range = Some([0.5, names.len() as f64 + 0.5]);
        Self { x_names: names, x_range, x_label: String::new(), ..self }
    }

    /// Sets width and height in units, limited to 200 x 150 and 4000 x 4000.
    #[must_use]
    pub fn size(self, width: f64, height: f64) -> Self {
        let within = |side: f64, least: f64| {
            if side.is_nan() { least } else { side.clamp(least, 4000.0) }
        };
        let size = [within(width, 200.0), within(height, 150.0)];
        Self { size, ..self }
    }
}
