//! Layout of a chart: title, note and legend above, axes around, data inside.

use super::canvas::{Anchor, Canvas, Point, Stroke, Text};
use super::chart::{Chart, Kind};
use super::colour::{Colour, GRID, INK, MUTED};
use super::font;
use super::look::{Look, looks};
use super::scale::Axes;
use super::series;

const TITLE: f64 = 15.0;
const HEADLINE: f64 = 18.0;
const LABEL: f64 = 12.5;
const SMALL: f64 = 11.5;
const PAD: f64 = 14.0;
const ROW: f64 = 19.0;
const SAMPLE: f64 = 24.0;
const RAMP: f64 = 45.0;
/// Largest ratio of the width of an SVG reader's sans-serif font to the measured one.
pub const OTHER_FONTS: f64 = 1.15;

/// Lays out pictures of these sizes in rows of `columns`, below the title, which may be empty, and
/// the drawing of `above`, which gets its upper end and returns its lower one. Returns the canvas
/// and the area of each picture.
pub fn sheet(
    title: &str,
    columns: usize,
    sizes: &[[f64; 2]],
    above: impl FnOnce(&mut Canvas, f64) -> f64,
) -> (Canvas, Vec<[f64; 4]>) {
    let most = |sides: &mut dyn Iterator<Item = f64>| sides.fold(0.0, f64::max);
    let widths = (0..columns.min(sizes.len()))
        .map(|column| most(&mut sizes.iter().skip(column).step_by(columns).map(|size| size[0])));
    let widths: Vec<f64> = widths.collect();
    let mut canvas = Canvas::new(widths.iter().sum::<f64>().max(200.0), 0.0, title);
    let mut y = if title.is_empty() { 0.0 } else { PAD + HEADLINE * 1.3 };
    let room = canvas.width - 2.0 * PAD;
    heading(&mut canvas, title, HEADLINE, [PAD, PAD + HEADLINE], room);
    y = above(&mut canvas, y);
    let mut areas = Vec::with_capacity(sizes.len());
    for row in sizes.chunks(columns) {
        let height = most(&mut row.iter().map(|size| size[1]));
        let mut x = 0.0;
        for width in &widths[..row.len()] {
            areas.push([x, y, *width, height]);
            x += width;
        }
        y += height;
    }
    canvas.height = y.max(150.0);
    (canvas, areas)
}

/// Writes a title at a point of its baseline.
pub fn heading(canvas: &mut Canvas, title: &str, size: f64, at: [f64; 2], room: f64) {
    let (title, size) = font::fit(title, size, true, room / OTHER_FONTS);
    canvas.text(Text { bold: true, ..Text::new(at, size, Anchor::Start, title) });
}

/// Writes a small line of text at a point of its baseline.
pub fn note(canvas: &mut Canvas, note: &str, at: [f64; 2], room: f64) {
    let (note, size) = font::fit(note, SMALL, false, room / OTHER_FONTS);
    canvas.text(Text::new(at, size, Anchor::Start, note).muted());
}

pub fn left_margin(chart: &Chart) -> f64 {
    // Labels depend slightly on the height of the axis; the whole height is assumed.
    let axes = Axes::new(chart, &looks(chart), [chart.size[0], chart.size[1]]);
    PAD + label_room(&chart.y_label) + axes.y.widest_label(SMALL) * OTHER_FONTS + 10.0
}

fn label_room(label: &str) -> f64 {
    if label.is_empty() { 0.0 } else { LABEL * 1.6 }
}

/// `area`: left, top, width, height of the chart; `left`: edge of its plotting area.
pub fn draw(chart: &Chart, canvas: &mut Canvas, area: [f64; 4], left: f64) {
    let [x, y, width, height] = area;
    let looks = looks(chart);
    let mut top = y + PAD;
    if !chart.title.is_empty() {
        top += TITLE;
        heading(canvas, &chart.title, TITLE, [x + PAD, top], width - 2.0 * PAD);
        top += 7.0;
    }
    if !chart.note.is_empty() {
        top += SMALL;
        note(canvas, &chart.note, [x + PAD, top], width - 2.0 * PAD);
        top += 7.0;
    }
    let named = looks.iter().filter(|look| !look.series.name.is_empty());
    let entries: Vec<Entry<'_>> = named.map(entry).collect();
    top = legend(canvas, &entries, [x + PAD, top], x + width - PAD, 16.0) + 8.0;

    let right = x + width - PAD - 12.0;
    let mut bottom = y + height - PAD - SMALL - 8.0;
    if !chart.x_label.is_empty() || !chart.x_names.is_empty() {
        bottom -= LABEL * 1.5;
    }
    let left = (x + left).min(right - 40.0);
    let plot = [left, top, right - left, (bottom - top).max(20.0)];
    let axes = Axes::new(chart, &looks, [plot[2], plot[3]]);
    frame(chart, &axes, canvas, plot, y + height - PAD - 1.0, x + PAD);
    if axes.empty {
        let middle = [plot[0] + plot[2] / 2.0, plot[1] + plot[3] / 2.0];
        canvas.text(Text::new(middle, LABEL, Anchor::Middle, "no data").muted().centred());
    }
    series::draw(&looks, &axes, canvas, plot);
}

fn frame(chart: &Chart, axes: &Axes, canvas: &mut Canvas, plot: [f64; 4], x_label_y: f64, y_label_x: f64) {
    let [left, top, width, height] = plot;
    let (right, bottom) = (left + width, top + height);
    let marks = [(&axes.x, width), (&axes.y, height)].map(|(axis, length)| {
        let ticks = axis.ticks.iter().filter(|_| !axes.empty);
        ticks.map(|tick| (tick.label.clone(), length * axis.share(tick.value))).collect()
    });
    grid(canvas, plot, &marks, 0.8);
    let axis = Stroke::new(INK, 1.0);
    canvas.line(vec![[left, top], [left, bottom], [right, bottom]], axis);
    let below = marks[0].iter().map(|(_, along)| vec![[left + along, bottom], [left + along, bottom + 4.0]]);
    let beside = marks[1].iter().map(|(_, up)| vec![[left - 4.0, bottom - up], [left, bottom - up]]);
    canvas.lines(below.chain(beside).collect(), axis);
    let numbers = Numbers {
        marks,
        labels: [&chart.x_label, &chart.y_label],
        sizes: [SMALL, LABEL],
        gaps: [7.0, 8.0],
        ends: [y_label_x, right + PAD + 10.0],
        at: [y_label_x + LABEL * 0.8, x_label_y],
        y_room: height * 1.15,
    };
    numbers.draw(canvas, plot);
}

/// Labels of marks along x and y, each with its distance from the lower left corner of the plot.
pub type Marks = [Vec<(String, f64)>; 2];

/// Draws lines at the marks through the plot (left, top, width, height).
pub fn grid(canvas: &mut Canvas, [left, top, width, height]: [f64; 4], [x, y]: &Marks, line: f64) {
    let (right, bottom) = (left + width, top + height);
    let upright = x.iter().map(|(_, along)| vec![[left + along, top], [left + along, bottom]]);
    let level = y.iter().map(|(_, up)| vec![[left, bottom - up], [right, bottom - up]]);
    canvas.lines(upright.chain(level).collect(), Stroke::new(GRID, line));
}

/// Numbers and labels of two axes.
pub struct Numbers<'a> {
    pub marks: Marks,
    pub labels: [&'a str; 2],
    /// Font sizes of numbers and labels.
    pub sizes: [f64; 2],
    /// Distances of numbers from the axes.
    pub gaps: [f64; 2],
    /// If even the fewest numbers below are too wide, the outer ones move in between.
    pub ends: [f64; 2],
    /// x of the label of y, and y of the label of x.
    pub at: [f64; 2],
    /// Length of the label of y.
    pub y_room: f64,
}

impl Numbers<'_> {
    /// Draws them around the plot (left, top, width, height).
    pub fn draw(self, canvas: &mut Canvas, [left, top, width, height]: [f64; 4]) {
        let (bottom, [small, large]) = (top + height, self.sizes);
        let [x, y] = self.marks;
        // Wide names alternate between two rows; an axis with names has no label.
        let room = x.windows(2).map(|pair| pair[1].1 - pair[0].1).fold(width, f64::min);
        let widest = font::widest(x.iter().map(|(label, _)| label), small) * OTHER_FONTS;
        let needs_rows = self.labels[0].is_empty() && widest > room;
        for (index, (label, along)) in x.into_iter().enumerate() {
            let (label, size) = font::fit(&label, small, false, if needs_rows { 2.0 * room } else { f64::INFINITY });
            let half = font::width(&label, size, false) / 2.0;
            let x = (left + along).max(self.ends[0] + half).min(self.ends[1] - half);
            let below = self.gaps[0] + small + if needs_rows && index % 2 == 1 { 1.3 * small } else { 0.0 };
            canvas.text(Text::new([x, bottom + below], size, Anchor::Middle, label).muted());
        }
        for (label, up) in y {
            let (label, size) = font::fit(&label, small, false, 160.0);
            canvas.text(Text::new([left - self.gaps[1], bottom - up], size, Anchor::End, label).muted().centred());
        }
        let (label, size) = font::fit(self.labels[0], large, false, width);
        canvas.text(Text::new([left + width / 2.0, self.at[1]], size, Anchor::Middle, label));
        let (label, size) = font::fit(self.labels[1], large, false, self.y_room);
        let label = Text::new([self.at[0], top + height / 2.0], size, Anchor::Middle, label);
        canvas.text(Text { upwards: true, ..label });
    }
}

type Sample<'a> = dyn Fn(&mut Canvas, Point) + 'a;

/// A sample with its name in a legend.
pub struct Entry<'a> {
    wide: f64,
    name: String,
    /// Draws the sample to the right of a point.
    draw: Box<Sample<'a>>,
}

impl<'a> Entry<'a> {
    /// Creates an entry with a sample of that width.
    pub fn new(wide: f64, name: impl Into<String>, draw: impl Fn(&mut Canvas, Point) + 'a) -> Self {
        Self { wide, name: name.into(), draw: Box::new(draw) }
    }

    /// Creates an entry for a line.
    pub fn line(name: impl Into<String>, stroke: Stroke) -> Self {
        Self::new(SAMPLE, name, move |canvas, [x, y]| canvas.line(vec![[x + 1.0, y], [x + SAMPLE - 1.0, y]], stroke))
    }

    /// Creates an entry for a mark, which is drawn around a point.
    pub fn mark(name: impl Into<String>, draw: impl Fn(&mut Canvas, Point) + 'a) -> Self {
        Self::new(14.0, name, move |canvas, [x, y]| draw(canvas, [x + 7.0, y]))
    }

    /// Creates an entry for a body or place of a colour.
    pub fn disc(name: impl Into<String>, colour: Colour) -> Self {
        Self::mark(name, move |canvas, at| canvas.circle(at, 5.0, Some(colour), None))
    }

    /// Creates an entry for areas of a colour.
    pub fn square(name: impl Into<String>, colour: Colour) -> Self {
        Self::mark(name, move |canvas, [x, y]| {
            canvas.rectangle([x - 6.0, y - 6.0, 12.0, 12.0], Some(colour), Some(Stroke::new(MUTED, 0.8)));
        })
    }

    /// Creates an entry for colours at shares from 0 to 1.
    pub fn ramp(name: impl Into<String>, steps: u32, colour: impl Fn(f64) -> Colour + 'a) -> Self {
        Self::new(RAMP, name, move |canvas, [x, y]| {
            let wide = RAMP / f64::from(steps);
            for step in 0..steps {
                let colour = colour(f64::from(step) / f64::from(steps - 1));
                canvas.rectangle([x + f64::from(step) * wide, y - 5.0, wide, 10.0], Some(colour), None);
            }
            canvas.rectangle([x, y - 5.0, RAMP, 10.0], None, Some(Stroke::new(MUTED, 0.8)));
        })
    }
}

/// Draws entries from left to right in as many rows as needed; returns the lower end of the legend.
pub fn legend(canvas: &mut Canvas, entries: &[Entry<'_>], [left, mut top]: Point, right: f64, gap: f64) -> f64 {
    let mut x = left;
    for Entry { wide, name, draw } in entries {
        let room = right - left - wide - 6.0;
        let (name, size) = font::fit(name, SMALL, false, room / OTHER_FONTS);
        let width = wide + 6.0 + font::width(&name, size, false) * OTHER_FONTS;
        if x > left && x + width > right {
            (x, top) = (left, top + ROW);
        }
        let middle = top + ROW / 2.0;
        draw(canvas, [x, middle]);
        canvas.text(Text::new([x + wide + 6.0, middle], size, Anchor::Start, name).centred());
        x += width + gap;
    }
    if entries.is_empty() { top } else { top + ROW }
}

fn entry<'a>(look: &'a Look<'_>) -> Entry<'a> {
    let (series, name) = (look.series, &look.series.name);
    match series.kind {
        Kind::Line => Entry::line(name, look.stroke()),
        Kind::Bars => Entry::mark(name, |canvas, [x, y]| look.bar(canvas, [x - 7.0, y - 5.0, 14.0, 10.0])),
        Kind::Points | Kind::Intervals => Entry::new(SAMPLE, name, |canvas, [x, y]| {
            let middle = x + SAMPLE / 2.0;
            if series.joined {
                canvas.line(vec![[x + 1.0, y], [x + SAMPLE - 1.0, y]], look.joint());
            }
            if series.kind == Kind::Intervals {
                canvas.lines(series::whisker(middle, y - 7.0, y + 7.0), look.whiskers());
            }
            look.mark(canvas, [middle, y]);
        }),
    }
}
