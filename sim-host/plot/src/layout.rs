//! Layout of a chart: title, note and legend above, axes around, data inside.

use super::canvas::{Anchor, Canvas, Stroke, Text};
use super::chart::{Chart, Data};
use super::colour::{GRID, INK, MUTED};
use super::font;
use super::look::{Look, looks};
use super::scale::{Axes, Axis};
use super::series;

const TITLE: f64 = 15.0;
const HEADLINE: f64 = 18.0;
const LABEL: f64 = 12.5;
const SMALL: f64 = 11.5;
const PAD: f64 = 14.0;
const ROW: f64 = 19.0;
const SAMPLE: f64 = 24.0;
/// Largest ratio of the width of an SVG reader's sans-serif font to the measured one.
pub const OTHER_FONTS: f64 = 1.15;

pub fn headline_height(title: &str) -> f64 {
    if title.is_empty() { 0.0 } else { PAD + HEADLINE * 1.3 }
}

pub fn headline(canvas: &mut Canvas, title: &str, width: f64) {
    let baseline = PAD + HEADLINE;
    heading(canvas, title, HEADLINE, [PAD, baseline], width - 2.0 * PAD);
}

pub fn heading(canvas: &mut Canvas, title: &str, size: f64, at: [f64; 2], room: f64) {
    let (title, size) = font::fit(title, size, true, room / OTHER_FONTS);
    canvas.text(Text { bold: true, ..Text::new(at, size, Anchor::Start, title) });
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
        let (note, size) = font::fit(&chart.note, SMALL, false, (width - 2.0 * PAD) / OTHER_FONTS);
        canvas.text(Text { colour: MUTED, ..Text::new([x + PAD, top], size, Anchor::Start, note) });
        top += 7.0;
    }
    top = legend(&looks, canvas, [x + PAD, top], x + width - PAD) + 8.0;

    let right = x + width - PAD - 12.0;
    let mut bottom = y + height - PAD - SMALL - 8.0;
    if !chart.x_label.is_empty() {
        bottom -= LABEL * 1.5;
    }
    let left = (x + left).min(right - 40.0);
    let plot = [left, top, right - left, (bottom - top).max(20.0)];
    let axes = Axes::new(chart, &looks, [plot[2], plot[3]]);
    frame(chart, &axes, canvas, plot, y + height - PAD - 1.0, x + PAD);
    if axes.empty {
        let middle = [plot[0] + plot[2] / 2.0, plot[1] + plot[3] / 2.0];
        canvas.text(Text { colour: MUTED, ..Text::new(middle, LABEL, Anchor::Middle, "no data") }.centred());
    }
    series::draw(&looks, &axes, canvas, plot);
}

fn frame(chart: &Chart, axes: &Axes, canvas: &mut Canvas, plot: [f64; 4], x_label_y: f64, y_label_x: f64) {
    let [left, top, width, height] = plot;
    let (right, bottom) = (left + width, top + height);
    let (ticks_x, ticks_y) = if axes.empty { (&[][..], &[][..]) } else { (&axes.x.ticks[..], &axes.y.ticks[..]) };
    let at_x = |axis: &Axis, value| left + width * axis.share(value);
    let at_y = |axis: &Axis, value| bottom - height * axis.share(value);
    let grid = ticks_x.iter().map(|tick| {
        let x = at_x(&axes.x, tick.value);
        vec![[x, top], [x, bottom]]
    });
    let grid = grid.chain(ticks_y.iter().map(|tick| {
        let y = at_y(&axes.y, tick.value);
        vec![[left, y], [right, y]]
    }));
    canvas.lines(grid.collect(), Stroke::new(GRID, 0.8));
    let axis = Stroke::new(INK, 1.0);
    canvas.line(vec![[left, top], [left, bottom], [right, bottom]], axis);
    let marks = ticks_x.iter().map(|tick| {
        let x = at_x(&axes.x, tick.value);
        vec![[x, bottom], [x, bottom + 4.0]]
    });
    let marks = marks.chain(ticks_y.iter().map(|tick| {
        let y = at_y(&axes.y, tick.value);
        vec![[left - 4.0, y], [left, y]]
    }));
    canvas.lines(marks.collect(), axis);
    for tick in ticks_x {
        // If even the fewest numbers are too wide, the outer ones move inwards.
        let half = font::width(&tick.label, SMALL, false) / 2.0;
        let ends = [y_label_x + half, right + PAD + 10.0 - half];
        let x = at_x(&axes.x, tick.value).max(ends[0]).min(ends[1]);
        canvas.text(number([x, bottom + 7.0 + SMALL], Anchor::Middle, &tick.label));
    }
    for tick in ticks_y {
        let at = [left - 8.0, at_y(&axes.y, tick.value)];
        canvas.text(number(at, Anchor::End, &tick.label).centred());
    }
    let (label, size) = font::fit(&chart.x_label, LABEL, false, width);
    let middle = [left + width / 2.0, x_label_y];
    canvas.text(Text::new(middle, size, Anchor::Middle, label));
    let (label, size) = font::fit(&chart.y_label, LABEL, false, height * 1.15);
    canvas.text(Text {
        upwards: true,
        ..Text::new([y_label_x + LABEL * 0.8, top + height / 2.0], size, Anchor::Middle, label)
    });
}

fn number(at: [f64; 2], anchor: Anchor, label: &str) -> Text {
    Text { colour: MUTED, ..Text::new(at, SMALL, anchor, label) }
}

/// Returns the lower end of the legend.
fn legend(looks: &[Look<'_>], canvas: &mut Canvas, at: [f64; 2], right: f64) -> f64 {
    let [left, mut top] = at;
    let mut x = left;
    for look in looks.iter().filter(|look| !look.series.name.is_empty()) {
        let room = right - left - SAMPLE - 6.0;
        let (name, size) = font::fit(&look.series.name, SMALL, false, room / OTHER_FONTS);
        let width = SAMPLE + 6.0 + font::width(&name, size, false) * OTHER_FONTS;
        if x > left && x + width > right {
            x = left;
            top += ROW;
        }
        let middle = top + ROW / 2.0;
        sample(look, canvas, [x, middle]);
        let text = Text::new([x + SAMPLE + 6.0, middle], size, Anchor::Start, name);
        canvas.text(text.centred());
        x += width + 16.0;
    }
    if x > left { top + ROW } else { top }
}

fn sample(look: &Look<'_>, canvas: &mut Canvas, [x, y]: [f64; 2]) {
    let middle = [x + SAMPLE / 2.0, y];
    let ends = vec![[x + 1.0, y], [x + SAMPLE - 1.0, y]];
    match look.series.data {
        Data::Line(_) => canvas.line(ends, look.stroke()),
        Data::Points(_) | Data::Intervals(_) => {
            if look.series.joined {
                canvas.line(ends, look.joint());
            }
            if matches!(look.series.data, Data::Intervals(_)) {
                canvas.lines(series::whisker(middle[0], y - 7.0, y + 7.0), look.whiskers());
            }
            look.mark(canvas, middle);
        }
        Data::Bars(_) => canvas.rectangle(
            [x + 5.0, y - 5.0, SAMPLE - 10.0, 10.0],
            Some(look.fill()),
            Some(Stroke::new(look.colour, 0.8)),
        ),
    }
}
