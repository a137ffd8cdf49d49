//! Title, axes and scale of a snapshot.

use super::{Snapshot, marks};
use crate::canvas::{Anchor, Canvas, Point, Stroke, Text};
use crate::colour::INK;
use crate::font;
use crate::layout::{self, Numbers};
use crate::ticks::{self, Tick};
use crate::view::{Span, View};

const PAD: f64 = 12.0;
const TITLE: f64 = 13.5;
const LABEL: f64 = 11.5;
const SMALL: f64 = 10.5;
/// Room around the floor for its numbers, units.
const NUMBERS: f64 = 28.0;
/// Distances of the numbers and labels from the floor, units.
const BESIDE: f64 = 14.0;
const OUTSIDE: f64 = 32.0;

/// Position of the content in the picture.
pub struct Frame {
    /// Left, top, width, height.
    pub plot: [f64; 4],
    pub view: View,
    area: [f64; 4],
    span: Span,
}

impl Frame {
    pub fn new(snapshot: &Snapshot, area: [f64; 4]) -> Self {
        let [x, y, width, height] = area;
        let mut span = snapshot.span();
        // Ranges too wide for ticks are replaced.
        let sound = [0, 1, 2].map(|axis| ticks::sound(span[0][axis], span[1][axis]));
        let axes = if snapshot.is_space { 3 } else { 2 };
        for (axis, [low, high]) in sound.into_iter().enumerate().take(axes) {
            (span[0][axis], span[1][axis]) = (low, high);
        }
        let top = y + PAD + if snapshot.title.is_empty() { 0.0 } else { TITLE + 8.0 };
        let right = x + width - PAD - 10.0;
        let [left, bottom] = if snapshot.is_space {
            [x + PAD, y + height - PAD]
        } else {
            let bottom = y + height - PAD - LABEL - SMALL - 14.0;
            // The left margin depends on the widest number, which depends little on the exact
            // ticks.
            let rough = ticks::linear(span[0][1], span[1][1], marks_in(bottom - top, 34.0));
            let widest = font::widest(rough.iter().map(|tick| &tick.label), SMALL);
            [x + PAD + LABEL * 1.5 + widest * layout::OTHER_FONTS + 6.0, bottom]
        };
        let plot = [left, top, (right - left).max(20.0), (bottom - top).max(20.0)];
        let room = if snapshot.is_space { NUMBERS } else { 0.0 };
        let inner = [left + room, top + room / 2.0, plot[2] - 2.0 * room, plot[3] - 1.5 * room];
        Self { plot, view: View::new(snapshot.is_space, span, inner.map(|side| side.max(1.0))), area, span }
    }

    pub fn draw(&self, snapshot: &Snapshot, canvas: &mut Canvas) {
        let [x, y, width, height] = self.area;
        if !snapshot.title.is_empty() {
            layout::heading(canvas, &snapshot.title, TITLE, [x + PAD, y + PAD + TITLE], width - 2.0 * PAD);
        }
        if snapshot.is_space {
            return self.numbers(canvas);
        }
        let [left, top, wide, high] = self.plot;
        let low = self.view.metres([left, top + high]);
        let marks = [(0, wide, 52.0), (1, high, 34.0)].map(|(axis, side, spacing)| {
            let ticks = ticks::linear(low[axis], low[axis] + side / self.view.scale, marks_in(side, spacing));
            let along = |tick: Tick| (tick.label, (tick.value - low[axis]) * self.view.scale);
            ticks.into_iter().map(along).collect()
        });
        layout::grid(canvas, self.plot, &marks, 0.7);
        canvas.rectangle(self.plot, None, Some(Stroke::new(INK, 0.9)));
        let numbers = Numbers {
            marks,
            labels: [&snapshot.labels[0], &snapshot.labels[1]],
            sizes: [SMALL, LABEL],
            gaps: [4.0, 6.0],
            ends: [f64::NEG_INFINITY, x + width - 2.0],
            at: [x + PAD + LABEL * 0.8, y + height - PAD + 2.0],
            y_room: self.plot[3],
        };
        numbers.draw(canvas, self.plot);
    }

    /// Writes the numbers of the floor at its front edges, and those of the height at its left end.
    fn numbers(&self, canvas: &mut Canvas) {
        let [low, high] = self.span;
        let middle = [0, 1].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0);
        let [x, y, z] = marks::ticks(self.span);
        // Places of texts, which cover no other one.
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let mut write = |at: Option<Point>, [dx, dy]: Point, by: f64, text: &str| {
            let Some([x, y]) = at else { return };
            let anchor = if dx < -0.9 { Anchor::End } else { Anchor::Middle };
            let is_label = text.ends_with(')');
            let size = if is_label { LABEL } else { SMALL };
            let (x, y, wide) = (x + by * dx, y + by * dy, font::width(text, size, false));
            let left = if anchor == Anchor::End { x - wide } else { x - wide / 2.0 };
            let area = [left, y - size / 2.0, left + wide, y + size / 2.0];
            let is_free =
                |[l, t, r, b]: &[f64; 4]| area[0] > *r + 3.0 || *l > area[2] + 3.0 || area[1] > *b || *t > area[3];
            if taken.iter().all(is_free) {
                taken.push(area);
                let text = Text::new([x, y], size, anchor, text).centred();
                canvas.text(if is_label { text } else { text.muted() });
            }
        };
        // Away from the middle of the floor, in the picture.
        let away = |edge: [f64; 2]| {
            let ends = [middle, edge].map(|[x, y]| self.view.at([x, y, low[2]]));
            if let [Some(from), Some(to)] = ends { marks::direction(from, to) } else { [0.0, 1.0] }
        };
        let (south, west) = (away([middle[0], low[1]]), away([low[0], middle[1]]));
        let at = |x: f64, y: f64, z: f64| self.view.at([x, y, z]);
        for tick in x {
            write(at(tick.value, low[1], low[2]), south, BESIDE, &tick.label);
        }
        for tick in y {
            write(at(low[0], tick.value, low[2]), west, BESIDE, &tick.label);
        }
        for tick in z {
            write(at(low[0], high[1], tick.value), [-1.0, 0.0], 6.0, &tick.label);
        }
        write(at(middle[0], low[1], low[2]), south, OUTSIDE, "x (m)");
        write(at(low[0], middle[1], low[2]), west, OUTSIDE, "y (m)");
        write(at(low[0], high[1], high[2]), [0.0, -1.0], BESIDE, "z (m)");
    }
}

fn marks_in(length: f64, spacing: f64) -> usize {
    ((length / spacing) as usize).clamp(2, 12)
}
