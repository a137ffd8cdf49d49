//! Ranges of axes, and positions of values on them.

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
        let mut this = Self { x: None, y: None, marks: false, bars: false, count: f64::INFINITY };
        for Look { series, .. } in looks {
            this.marks |= [Kind::Points, Kind::Intervals].contains(&series.kind);
            let is_bars = series.kind == Kind::Bars;
            this.bars |= is_bars;
            if is_bars && series.values.iter().all(|[_, height, ..]| libm::trunc(*height) == *height) {
                this.count = series.values.iter().map(|[_, height, ..]| *height).fold(1.0, f64::max);
            }
            for [x, y, low, high] in &series.values {
                if series.kind == Kind::Bars {
                    this.add(chart, *x, *y);
                    this.add(chart, *low, 0.0);
                } else {
                    [y, low, high].iter().for_each(|value| this.add(chart, *x, **value));
                }
            }
        }
        this
    }

    fn add(&mut self, chart: &Chart, x: f64, y: f64) {
        let is_shown = |value: f64, log: bool| value.is_finite() && (value > 0.0 || !log);
        if !is_shown(x, chart.log_x) || !is_shown(y, chart.log_y) {
            return;
        }
        let widen = |range: Option<[f64; 2]>, value: f64| match range {
            Some([low, high]) => Some([low.min(value), high.max(value)]),
            None => Some([value; 2]),
        };
        self.x = widen(self.x, x);
        // Data outside the chosen x range do not stretch y.
        if chosen(chart.x_range).is_none_or(|[low, high]| (low..=high).contains(&x)) {
            self.y = widen(self.y, y);
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
        let wanted = chosen(chart.y_range);
        let range = wanted.or(extent.y).unwrap_or([1.0, 10.0]);
        return log_range(range, wanted.is_none());
    }
    if let Some([low, high]) = chosen(chart.y_range) {
        return ticks::sound(low, high);
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
