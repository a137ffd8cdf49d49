//! Ranges of axes, and positions of values on them.

use super::canvas::extent;
use super::chart::{Chart, Kind};
use super::font;
use super::look::Look;
use super::ticks::{self, Tick};

const NUMBER: f64 = 11.5;

/// Overhang of numbers at the ends of the x axis, less than the margins there.
const OVERHANG: f64 = 24.0;

#[derive(Clone, Debug)]
pub struct Axis {
    range: [f64; 2],
    logarithmic: bool,
    pub ticks: Vec<Tick>,
}

impl Axis {
    /// 0 at the start of the axis, 1 at the end.
    pub fn share(&self, value: f64) -> f64 {
        let at = |value: f64| {
            if self.logarithmic { libm::log10(value) } else { value }
        };
        let [low, high] = self.range.map(at);
        (at(value) - low) / (high - low)
    }

    pub fn widest_label(&self, size: f64) -> f64 {
        font::widest(self.ticks.iter().map(|tick| &tick.label), size)
    }

    fn labels_fit(&self, length: f64) -> bool {
        let span = |tick: &Tick| {
            let half = font::width(&tick.label, NUMBER, false) / 2.0;
            let at = length * self.share(tick.value);
            [at - half, at + half]
        };
        let spans: Vec<[f64; 2]> = self.ticks.iter().map(span).collect();
        let inside = spans.iter().all(|[from, to]| *from >= -OVERHANG && *to <= length + OVERHANG);
        inside && spans.windows(2).all(|pair| pair[0][1] + 14.0 <= pair[1][0])
    }
}

#[derive(Clone, Debug)]
pub struct Axes {
    pub x: Axis,
    pub y: Axis,
    pub empty: bool,
}

impl Axes {
    pub fn new(chart: &Chart, looks: &[Look<'_>], [width, height]: [f64; 2]) -> Self {
        let extent = Extent::new(chart, looks);
        let axis = |range: [f64; 2], logarithmic: bool, most: usize| {
            let ticks = if logarithmic { ticks::logarithmic } else { ticks::linear };
            Axis { range, logarithmic, ticks: ticks(range[0], range[1], most) }
        };
        let x_range = x_range(chart, &extent);
        let x = |most: usize| axis(x_range, chart.log_x, most);
        let most = ((width / 50.0) as usize).clamp(2, 14);
        let mut x = (2..=most).rev().map(x).find(|axis| axis.labels_fit(width)).unwrap_or_else(|| x(2));
        if !chart.x_names.is_empty() {
            let names = (1_u32..).zip(&chart.x_names);
            x.ticks = names.map(|(at, name)| Tick { value: at.into(), label: name.clone() }).collect();
        }
        // Counts have no fractions.
        let most = ((height / 36.0).min(extent.count) as usize).clamp(1, 10);
        let y = axis(y_range(chart, &extent, most), chart.log_y, most);
        Self { x, y, empty: extent.x.is_none() }
    }
}

struct Extent {
    x: Option<[f64; 2]>,
    y: Option<[f64; 2]>,
    marks: bool,
    bars: bool,
    /// Greatest height of bars if all heights are whole numbers, else infinite.
    count: f64,
}

impl Extent {
    fn new(chart: &Chart, looks: &[Look<'_>]) -> Self {
        let is_shown = |value: f64, log: bool| value.is_finite() && (value > 0.0 || !log);
        let points = looks.iter().flat_map(|look| look.series.values.iter().map(|value| (look.series.kind, *value)));
        let points = points.flat_map(|(kind, [x, y, low, high])| match kind {
            Kind::Bars => [[x, y], [low, 0.0], [x, y]],
            _ => [[x, y], [x, low], [x, high]],
        });
        let shown = points.filter(|&[x, y]| is_shown(x, chart.log_x) && is_shown(y, chart.log_y));
        let shown: Vec<[f64; 2]> = shown.collect();
        // Data outside the chosen x range do not stretch y.
        let is_inside = |[x, _]: &[f64; 2]| chosen(chart.x_range).is_none_or(|[low, high]| (low..=high).contains(x));
        let range =
            |[low, high]: [[f64; 2]; 2], axis: usize| (low[axis] <= high[axis]).then(|| [low[axis], high[axis]]);
        let kinds = || looks.iter().map(|look| look.series.kind);
        let bars = looks.iter().filter(|look| look.series.kind == Kind::Bars).flat_map(|look| &look.series.values);
        let heights: Vec<f64> = bars.map(|[_, height, ..]| *height).collect();
        let is_count = !heights.is_empty() && heights.iter().all(|height| libm::trunc(*height) == *height);
        Self {
            x: range(extent(shown.iter().copied()), 0),
            y: range(extent(shown.into_iter().filter(is_inside)), 1),
            marks: kinds().any(|kind| [Kind::Points, Kind::Intervals].contains(&kind)),
            bars: kinds().any(|kind| kind == Kind::Bars),
            count: if is_count { heights.into_iter().fold(1.0, f64::max) } else { f64::INFINITY },
        }
    }
}

fn chosen(range: Option<[f64; 2]>) -> Option<[f64; 2]> {
    range.filter(|[low, high]| low < high && low.is_finite() && high.is_finite())
}

fn x_range(chart: &Chart, extent: &Extent) -> [f64; 2] {
    let wanted = chosen(chart.x_range);
    let [low, high] = wanted.or(extent.x).unwrap_or([0.0, 1.0]);
    if chart.log_x {
        return log_range([low, high], wanted.is_none() && extent.marks);
    }
    let [low, high] = ticks::sound(low, high);
    let share = match (wanted, extent.marks, extent.bars) {
        (None, true, _) => 0.03,
        (None, false, true) => 0.01,
        _ => 0.0,
    };
    [low - (high - low) * share, high + (high - low) * share]
}

/// At least a factor of 2 around a single value, with a margin.
fn log_range([low, high]: [f64; 2], room: bool) -> [f64; 2] {
    let low = if low > 0.0 { low } else { f64::MIN_POSITIVE.max(high / 1e3) };
    let (low, high) = (low.clamp(1e-150, 1e150), high.clamp(1e-150, 1e150));
    let factor = if high / low < 1.0 + 1e-9 {
        1.5
    } else if room {
        libm::pow(high / low, 0.03)
    } else {
        1.0
    };
    [low / factor, high * factor]
}

fn y_range(chart: &Chart, extent: &Extent, most: usize) -> [f64; 2] {
    if chart.log_y {
        return log_range(extent.y.unwrap_or([1.0, 10.0]), true);
    }
    let [low, high] = extent.y.unwrap_or([0.0, 1.0]);
    // Zero is included if it takes at most half of the axis.
    let (low, high) = if low > 0.0 && low <= high / 2.0 {
        (0.0, high)
    } else if high < 0.0 && high >= low / 2.0 {
        (low, 0.0)
    } else {
        (low, high)
    };
    // A constant 0 is at the bottom, not in the middle.
    if low == 0.0 && high == 0.0 {
        return [0.0, 1.0];
    }
    ticks::enclosing(low, high, most)
}
