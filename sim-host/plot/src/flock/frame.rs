//! Title, axes and scale of a snapshot.

use super::Snapshot;
use crate::canvas::{Canvas, Stroke, longest};
use crate::colour::INK;
use crate::font;
use crate::layout::{self, Numbers};
use crate::ticks::{self, Tick};

const PAD: f64 = 12.0;
const TITLE: f64 = 13.5;
const LABEL: f64 = 11.5;
const SMALL: f64 = 10.5;
/// Fraction of the larger side of the content.
const MARGIN: f64 = 0.04;

/// Transformation from metres to the picture.
pub struct Frame {
    /// Left, top, width, height.
    pub plot: [f64; 4],
    area: [f64; 4],
    /// Metres at the lower left corner of `plot`.
    low: [f64; 2],
    pub scale: f64,
    ticks: [Vec<Tick>; 2],
}

impl Frame {
    pub fn new(snapshot: &Snapshot, area: [f64; 4]) -> Self {
        let [x, y, width, height] = area;
        let is_range = |[low, high]: &[[f64; 2]; 2]| {
            (0..2).all(|axis| low[axis] < high[axis] && (high[axis] - low[axis]).is_finite())
        };
        let chosen = snapshot.view_m.map(|[x, y]| [[x[0], y[0]], [x[1], y[1]]]);
        let [low, high] = chosen.filter(is_range).unwrap_or_else(|| {
            let [low, high] = snapshot.extent().unwrap_or([[0.0; 2], [1.0; 2]]);
            let margin = (longest([low, high]) * MARGIN).max(1e-6);
            [low.map(|c| c - margin), high.map(|c| c + margin)]
        });
        // Ranges too wide for ticks are replaced.
        let [x_range, y_range] = [0, 1].map(|axis| ticks::sound(low[axis], high[axis]));
        let top = y + PAD + if snapshot.title.is_empty() { 0.0 } else { TITLE + 8.0 };
        let bottom = y + height - PAD - LABEL - SMALL - 14.0;
        // The left margin depends on the widest number, which depends little on the exact ticks.
        let rough = ticks::linear(y_range[0], y_range[1], marks(bottom - top, 34.0));
        let widest = font::widest(rough.iter().map(|tick| &tick.label), SMALL);
        let left = x + PAD + LABEL * 1.5 + widest * layout::OTHER_FONTS + 6.0;
        let right = x + width - PAD - 10.0;
        let room = [(right - left).max(20.0), (bottom - top).max(20.0)];
        let sides = [x_range[1] - x_range[0], y_range[1] - y_range[0]];
        let scale = (room[0] / sides[0]).min(room[1] / sides[1]);
        let shown = room.map(|units| units / scale);
        let middle = [x_range, y_range].map(|[low, high]| low + (high - low) / 2.0);
        let low = [0, 1].map(|axis| middle[axis] - shown[axis] / 2.0);
        let ticks = [0, 1].map(|axis| {
            let spacing = [52.0, 34.0][axis];
            ticks::linear(low[axis], low[axis] + shown[axis], marks(room[axis], spacing))
        });
        Self { plot: [left, top, room[0], room[1]], area, low, scale, ticks }
    }

    /// `None` if the position is not finite or so far outside that SVG readers lose precision.
    pub fn at(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let [left, top, _, height] = self.plot;
        let at = [left + (place[0] - self.low[0]) * self.scale, top + height - (place[1] - self.low[1]) * self.scale];
        at.iter().all(|c| c.is_finite() && c.abs() < 1e5).then_some(at)
    }

    pub fn draw(&self, snapshot: &Snapshot, canvas: &mut Canvas) {
        let [x, y, area_width, area_height] = self.area;
        if !snapshot.title.is_empty() {
            let at = [x + PAD, y + PAD + TITLE];
            layout::heading(canvas, &snapshot.title, TITLE, at, area_width - 2.0 * PAD);
        }
        let marks = [0, 1].map(|axis| {
            let ticks = self.ticks[axis].iter();
            ticks.map(|tick| (tick.label.clone(), (tick.value - self.low[axis]) * self.scale)).collect()
        });
        layout::grid(canvas, self.plot, &marks, 0.7);
        canvas.rectangle(self.plot, None, Some(Stroke::new(INK, 0.9)));
        let numbers = Numbers {
            marks,
            labels: [&snapshot.labels[0], &snapshot.labels[1]],
            sizes: [SMALL, LABEL],
            gaps: [4.0, 6.0],
            ends: [f64::NEG_INFINITY, x + area_width - 2.0],
            at: [x + PAD + LABEL * 0.8, y + area_height - PAD + 2.0],
            y_room: self.plot[3],
        };
        numbers.draw(canvas, self.plot);
    }
}

fn marks(length: f64, spacing: f64) -> usize {
    ((length / spacing) as usize).clamp(2, 12)
}
