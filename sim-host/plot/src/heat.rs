//! Heat maps.

use super::canvas::{Anchor, Canvas, Stroke, Text, extent};
use super::colour::{INK, WHITE};
use super::crowd::colour;
use super::font;
use super::layout::{Numbers, heading, note};
use super::ticks;

const PAD: f64 = 14.0;
const TITLE: f64 = 15.0;
const LABEL: f64 = 12.5;
const SMALL: f64 = 11.5;
const BAR: f64 = 16.0;
const SHADES: u32 = 64;
const GAP: f64 = 18.0;

/// Coloured squares over two axes, with a scale.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Title.
    pub title: String,
    /// Note below the title; may be empty.
    pub note: String,
    /// Label of the columns.
    pub x_label: String,
    /// Label of the rows.
    pub y_label: String,
    /// Value of each column, from left to right.
    pub columns: Vec<String>,
    /// Value of each row, from bottom to top.
    pub rows: Vec<String>,
    /// Value of each square, row by row from the bottom; `None` is white.
    pub values: Vec<Option<f64>>,
}

impl HeatMap {
    /// Draws the heat map with 720 x 480 units.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let [width, height] = [720.0, 480.0];
        let mut canvas = Canvas::new(width, height, &self.title);
        heading(&mut canvas, &self.title, TITLE, [PAD, PAD + TITLE], width - 2.0 * PAD);
        let below = PAD + TITLE + 7.0 + SMALL;
        note(&mut canvas, &self.note, [PAD, below], width - 2.0 * PAD);
        let found = self.values.iter().flatten().filter(|value| value.is_finite());
        let [[low, _], [high, _]] = extent(found.map(|value| [*value; 2]));
        if low > high {
            let middle = [width / 2.0, height / 2.0];
            canvas.text(Text::new(middle, LABEL, Anchor::Middle, "no data").muted());
            return canvas;
        }
        let [low, high] = ticks::sound(low, high);
        let marks = ticks::linear(low, high, 6);
        let left = PAD + LABEL * 1.8 + font::widest(&self.rows, SMALL).min(160.0) + 10.0;
        let right = width - PAD - font::widest(marks.iter().map(|mark| &mark.label), SMALL) - 10.0 - BAR - GAP;
        let (top, bottom) = (below + 14.0, height - PAD - LABEL * 1.6 - SMALL - 12.0);
        let plot = [left, top, right - left, bottom - top];
        let share = |value: f64| (value - low) / (high - low);
        self.squares(&mut canvas, plot, &share);
        self.names(&mut canvas, plot, height);
        let at = |share: f64| bottom - share * (bottom - top);
        for shade in 0..SHADES {
            let [from, to] = [shade, shade + 1].map(|edge| f64::from(edge) / f64::from(SHADES));
            canvas.rectangle([right + GAP, at(to), BAR, at(from) - at(to)], Some(colour((from + to) / 2.0)), None);
        }
        for mark in marks {
            let y = at(share(mark.value));
            canvas.line(vec![[right + GAP + BAR, y], [right + GAP + BAR + 4.0, y]], Stroke::new(INK, 1.0));
            canvas.text(Text::new([right + GAP + BAR + 8.0, y], SMALL, Anchor::Start, mark.label).muted().centred());
        }
        canvas
    }

    fn squares(&self, canvas: &mut Canvas, [left, top, width, height]: [f64; 4], share: &dyn Fn(f64) -> f64) {
        let [across, up] = [width / self.columns.len() as f64, height / self.rows.len() as f64];
        for (index, value) in self.values.iter().enumerate() {
            let Some(value) = value.filter(|value| value.is_finite()) else {
                continue;
            };
            let (column, row) = (index % self.columns.len(), index / self.columns.len());
            let [x, y] = [left + column as f64 * across, top + height - (row + 1) as f64 * up];
            canvas.rectangle([x, y, across, up], Some(colour(share(value))), Some(Stroke::new(WHITE, 1.0)));
            let text = short(value);
            if font::width(&text, SMALL, false) + 8.0 <= across && SMALL + 4.0 <= up {
                let ink = if share(value) > 0.45 { WHITE } else { INK };
                let middle = [x + across / 2.0, y + up / 2.0];
                canvas.text(Text { colour: ink, ..Text::new(middle, SMALL, Anchor::Middle, text) }.centred());
            }
        }
        canvas.rectangle([left, top, width, height], None, Some(Stroke::new(INK, 1.0)));
    }

    /// Overlapping labels are skipped.
    fn names(&self, canvas: &mut Canvas, plot: [f64; 4], picture: f64) {
        let [_, _, width, height] = plot;
        let sides = [(&self.columns, width), (&self.rows, height)];
        let needed = [font::widest(&self.columns, SMALL) + 10.0, SMALL + 3.0];
        let marks = [0, 1].map(|axis| {
            let (names, length) = sides[axis];
            let side = length / names.len() as f64;
            let every = (needed[axis] / side).ceil().max(1.0) as usize;
            let names = names.iter().enumerate().step_by(every);
            names.map(|(index, name)| (name.clone(), (index as f64 + 0.5) * side)).collect()
        });
        let numbers = Numbers {
            marks,
            labels: [&self.x_label, &self.y_label],
            sizes: [SMALL, LABEL],
            gaps: [7.0, 8.0],
            ends: [f64::NEG_INFINITY, f64::INFINITY],
            at: [PAD + LABEL * 0.8, picture - PAD - 1.0],
            y_room: height,
        };
        numbers.draw(canvas, plot);
    }
}

fn short(value: f64) -> String {
    let size = value.abs();
    if size >= 1e6 || (size < 1e-3 && size > 0.0) {
        format!("{value:.1e}")
    } else if libm::trunc(value) == value || size >= 100.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.*}", if size >= 10.0 { 1 } else { 2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Shape;

    fn map(columns: usize, rows: usize, value: impl Fn(usize) -> Option<f64>) -> HeatMap {
        let names = |count: usize| (0..count).map(|number| number.to_string()).collect();
        HeatMap {
            title: "Arrived".into(),
            note: String::new(),
            x_label: "loss".into(),
            y_label: "delay".into(),
            columns: names(columns),
            rows: names(rows),
            values: (0..columns * rows).map(value).collect(),
        }
    }

    fn texts(canvas: &Canvas) -> Vec<&str> {
        let text = canvas.shapes.iter().filter_map(|shape| match shape {
            Shape::Text(text) => Some(text.text.as_str()),
            _ => None,
        });
        text.collect()
    }

    #[test]
    fn each_square_with_a_value_is_coloured_and_labelled() {
        let canvas = map(3, 2, |index| (index != 4).then_some(10.25 * index as f64)).draw();
        let said = texts(&canvas);
        for figure in ["0", "10.2", "20.5", "30.8", "51.2"] {
            assert!(said.contains(&figure), "{figure} {said:?}");
        }
        assert!(!said.contains(&"41"), "{said:?}");
        let place = |figure: &str| {
            canvas.shapes.iter().find_map(|shape| match shape {
                Shape::Text(text) if text.text == figure => Some(text.at[1]),
                _ => None,
            })
        };
        assert!(place("10.2") > place("51.2"));
    }

    #[test]
    fn any_number_of_values_can_be_drawn() {
        assert!(texts(&map(2, 2, |_| None).draw()).contains(&"no data"));
        assert!(texts(&map(1, 1, |_| Some(f64::NAN)).draw()).contains(&"no data"));
        assert!(texts(&map(1, 1, |_| Some(7.0)).draw()).contains(&"7"));
        let many = map(100, 100, |index| Some(index as f64)).draw();
        assert!(texts(&many).len() < 200, "{}", texts(&many).len());
    }
}
