//! A square region of the velocity plane in a picture.

use super::V;
use staya_plot::canvas::{Anchor, Canvas, Pixels, Point, Shape, Stroke, Text};
use staya_plot::colour::{Colour, INK, MUTED, PALETTE, WHITE};

pub const LEFT: f64 = 48.0;
pub const TOP: f64 = 74.0;
pub const SIDE: f64 = 520.0;
pub const SMALL_SIDE: f64 = 300.0;
pub const PIXELS: u32 = 400;
pub const GAP: f64 = 58.0;
pub const NUMBER: f64 = 11.5;

/// A square region of velocities (m/s) and its position in a picture.
#[derive(Clone, Copy)]
pub struct View {
    /// South-west corner.
    pub corner: V,
    pub side: f64,
    /// Left, top and side, picture units.
    pub area: [f64; 3],
}

impl View {
    pub fn place(&self, velocity: V) -> Point {
        let scale = self.area[2] / self.side;
        let at = (velocity - self.corner) * scale;
        [self.area[0] + at.x, self.area[1] + self.area[2] - at.y]
    }

    pub fn frame(&self) -> [f64; 4] {
        let [x, y, side] = self.area;
        [x, y, side, side]
    }

    pub fn pixels(&self, mut colour: impl FnMut(V) -> [u8; 4]) -> Pixels {
        let step = self.side / f64::from(PIXELS);
        let at = |i: u32| (f64::from(i) + 0.5) * step;
        pixels(PIXELS, PIXELS, |column, row| colour(self.corner + V::new(at(column), at(row))))
    }

    pub fn axes(&self, canvas: &mut Canvas) {
        let step = step(self.side);
        let [left, top, side] = self.area;
        let first = |from: f64| libm::ceil(from / step) * step;
        let marks = |from: f64| {
            let count = libm::floor((from + self.side - first(from)) / step + 1e-9) as u32;
            (0..=count).map(move |i| first(from) + step * f64::from(i))
        };
        let number = |x: f64| {
            let rounded = libm::round(x / step) * step;
            format!("{}", libm::round(rounded * 1e6) / 1e6 + 0.0)
        };
        for x in marks(self.corner.x) {
            let at = self.place(V::new(x, self.corner.y));
            canvas.line(vec![at, [at[0], at[1] + 4.0]], Stroke::new(MUTED, 1.0));
            let text = Text::new([at[0], at[1] + 17.0], NUMBER, Anchor::Middle, number(x));
            canvas.text(Text { colour: MUTED, ..text });
        }
        for y in marks(self.corner.y) {
            let at = self.place(V::new(self.corner.x, y));
            canvas.line(vec![at, [at[0] - 4.0, at[1]]], Stroke::new(MUTED, 1.0));
            let text = Text::new([at[0] - 7.0, at[1]], NUMBER, Anchor::End, number(y)).centred();
            canvas.text(Text { colour: MUTED, ..text });
        }
        let bottom = [left + side / 2.0, top + side + 34.0];
        canvas.text(Text::new(bottom, NUMBER, Anchor::Middle, "east, m/s"));
        canvas.text(Text {
            upwards: true,
            ..Text::new([left - 32.0, top + side / 2.0], NUMBER, Anchor::Middle, "north, m/s")
        });
        canvas.rectangle(self.frame(), None, Some(Stroke::new(MUTED, 1.0)));
    }
}

/// Columns count from the left, rows from below.
pub fn pixels(width: u32, height: u32, mut colour: impl FnMut(u32, u32) -> [u8; 4]) -> Pixels {
    let places = (0..height).rev().flat_map(|row| (0..width).map(move |column| (column, row)));
    let rgba = places.map(|(column, row)| colour(column, row)).collect();
    Pixels { width, height, rgba }
}

pub fn step(side: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(side / 6.0)));
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade);
    steps.into_iter().find(|step| side / step <= 8.0).unwrap_or(decade)
}

pub fn canvas(title: &str, pictures: usize, side: f64, more: f64) -> Canvas {
    let width = LEFT + (side + GAP) * pictures as f64 + more;
    let below = if pictures > 1 { 72.0 } else { 50.0 };
    let mut canvas = Canvas::new(width, TOP + side + below, title);
    canvas.text(Text { bold: true, ..Text::new([16.0, 30.0], 17.0, Anchor::Start, title) });
    canvas
}

pub fn left_of(index: usize) -> f64 {
    LEFT + (SMALL_SIDE + GAP) * index as f64
}

pub fn note(canvas: &mut Canvas, pictures: usize, text: &str) {
    let at = [(left_of(pictures) - GAP + LEFT) / 2.0, TOP + SMALL_SIDE + 58.0];
    let text = Text::new(at, NUMBER, Anchor::Middle, text);
    canvas.text(Text { colour: MUTED, ..text });
}

pub fn picture(canvas: &mut Canvas, view: &View, title: &str, pixels: Pixels) {
    let [left, top, side] = view.area;
    let at = [left + side / 2.0, top - 10.0];
    canvas.text(Text::new(at, 12.5, Anchor::Middle, title));
    image(canvas, view, pixels);
    canvas.clip(None);
    view.axes(canvas);
}

pub fn image(canvas: &mut Canvas, view: &View, pixels: Pixels) {
    let area = view.frame();
    canvas.shapes.push(Shape::Image { area, pixels });
    canvas.clip(Some(area));
}

pub fn opaque(colour: Colour) -> [u8; 4] {
    let [red, green, blue] = colour.rgb;
    [red, green, blue, 255]
}

pub fn grey(component: f64) -> [u8; 4] {
    let shade = (127.5 + 127.5 * component.clamp(-1.0, 1.0)) as u8;
    [shade, shade, shade, 255]
}

pub fn contoured(value: f64) -> [u8; 4] {
    let colour = if value > 0.0 { PALETTE[1] } else { PALETTE[0] };
    let share = (value.abs() / 2.0).min(1.0) * 0.75 + 0.08;
    let fill = WHITE.towards(colour, share);
    let nearest = libm::round(value * 4.0) / 4.0;
    if (value - nearest).abs() > 0.012 {
        opaque(fill)
    } else if nearest == 0.0 {
        opaque(INK)
    } else {
        opaque(fill.towards(INK, 0.3))
    }
}

pub fn label(canvas: &mut Canvas, view: &View, at: V, away: V, name: &str, colour: Colour) {
    let away = away.normalized().unwrap_or(V::new(0.0, 1.0));
    let [x, y] = view.place(at);
    let anchor = match away.x {
        x if x > 0.4 => Anchor::Start,
        x if x < -0.4 => Anchor::End,
        _ => Anchor::Middle,
    };
    let text = Text::new([x + 9.0 * away.x, y - 12.0 * away.y], 12.5, anchor, name).centred();
    canvas.text(Text { colour, halo: Some(WHITE), ..text });
}

pub fn arrow(canvas: &mut Canvas, view: &View, from: V, to: V, stroke: Stroke) {
    let Some(unit) = (to - from).normalized() else {
        canvas.circle(view.place(to), 2.5, Some(stroke.colour), None);
        return;
    };
    let head = (9.0 * view.side / view.area[2]).min((to - from).norm() * 0.6);
    let back = to - unit * head;
    let wing = unit.perp() * (head * 0.4);
    canvas.line(vec![view.place(from), view.place(back)], stroke);
    let corners = [to, back + wing, back - wing].map(|at| view.place(at));
    canvas.polygon(corners.to_vec(), Some(stroke.colour), None);
}
