//! Renders pictures as anti-aliased PNG.

use super::canvas::{Anchor, Canvas, Pixels, Point, Shape, Stroke, Text};
use super::colour::{Colour, WHITE};
use super::font;
use std::io;
use tiny_skia::{
    FillRule, FilterQuality, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, PixmapPaint,
    PremultipliedColorU8, Rect, StrokeDash, Transform,
};

/// PNG pixels per picture unit.
pub const SCALE: f64 = 2.0;
/// Width of the stroke that makes a halo, as a fraction of the font size.
pub const HALO: f64 = 0.25;

/// Renders a picture on white; an error if it has no pixels or too many.
pub fn png(canvas: &Canvas) -> io::Result<Vec<u8>> {
    let mut white = empty(canvas, SCALE)?;
    white.fill(plain(WHITE));
    let pixmap = onto(white, canvas, SCALE);
    let rgb: Vec<u8> = pixmap.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    Ok(encode_png(pixmap.width(), pixmap.height(), png::ColorType::Rgb, &rgb)?)
}

/// Encodes an image; an error if it has no pixels or too many.
pub fn encode_rgba(pixels: &Pixels) -> io::Result<Vec<u8>> {
    Ok(encode_png(pixels.width, pixels.height, png::ColorType::Rgba, pixels.rgba.as_flattened())?)
}

fn encode_png(width: u32, height: u32, colour: png::ColorType, pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

/// Renders a picture without background, `scale` pixels per unit.
pub fn layer(canvas: &Canvas, scale: f64) -> io::Result<Pixels> {
    let pixmap = onto(empty(canvas, scale)?, canvas, scale);
    let plain = pixmap.pixels().iter().map(|pixel| pixel.demultiply());
    let rgba = plain.map(|pixel| [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]).collect();
    Ok(Pixels { width: pixmap.width(), height: pixmap.height(), rgba })
}

/// Renders a picture over existing pixels or an empty background, one pixel per unit.
pub fn over(ground: Option<Pixmap>, canvas: &Canvas) -> io::Result<Pixmap> {
    let pixmap = ground.map_or_else(|| empty(canvas, 1.0), Ok)?;
    Ok(onto(pixmap, canvas, 1.0))
}

/// Of 4 bytes each.
const MOST_PIXELS: u64 = 1 << 28;

fn empty(canvas: &Canvas, scale: f64) -> io::Result<Pixmap> {
    let [width, height] = [canvas.width, canvas.height].map(|side| libm::ceil(side * scale) as u32);
    let is_small = u64::from(width) * u64::from(height) <= MOST_PIXELS;
    is_small.then(|| Pixmap::new(width, height)).flatten().ok_or_else(|| {
        io::Error::other(format!("a picture of {width} x {height} pixels is not possible; choose another size"))
    })
}

fn onto(pixmap: Pixmap, canvas: &Canvas, scale: f64) -> Pixmap {
    let scale = scale as f32;
    let mut brush = Brush { transform: Transform::from_scale(scale, scale), pixmap, mask: None };
    for shape in &canvas.shapes {
        brush.shape(shape);
    }
    brush.pixmap
}

struct Brush {
    pixmap: Pixmap,
    transform: Transform,
    mask: Option<Mask>,
}

impl Brush {
    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Path { lines, closed, stroke, fill } => {
                let mut builder = PathBuilder::new();
                lines.iter().for_each(|line| add_line(&mut builder, line, *closed));
                self.path(builder.finish(), *fill, *stroke, self.transform);
            }
            Shape::Circle { centre: [x, y], radius, stroke, fill } => {
                let path = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32);
                self.path(path, *fill, *stroke, self.transform);
            }
            Shape::Text(text) => self.text(text),
            Shape::Image { area, pixels } => self.image(*area, pixels),
            Shape::Clip(area) => self.mask = area.and_then(|area| self.mask(area)),
        }
    }

    fn path(&mut self, path: Option<Path>, fill: Option<Colour>, stroke: Option<Stroke>, transform: Transform) {
        let Some(path) = path else { return };
        let mask = self.mask.as_ref();
        if let Some(fill) = fill {
            let paint = paint(fill);
            self.pixmap.fill_path(&path, &paint, FillRule::Winding, transform, mask);
        }
        if let Some(stroke) = stroke {
            let dash = stroke.dash.map(|lengths| lengths.map(|l| l as f32));
            let pen = tiny_skia::Stroke {
                width: stroke.width as f32,
                line_cap: if dash.is_some() { LineCap::Butt } else { LineCap::Round },
                line_join: LineJoin::Round,
                dash: dash.and_then(|lengths| StrokeDash::new(lengths.to_vec(), 0.0)),
                ..tiny_skia::Stroke::default()
            };
            let paint = paint(stroke.colour);
            self.pixmap.stroke_path(&path, &paint, &pen, transform, mask);
        }
    }

    fn text(&mut self, text: &Text) {
        let width = font::width(&text.text, text.size, text.bold);
        let shift = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -width / 2.0,
            Anchor::End => -width,
        };
        let [x, y] = text.at.map(|value| value as f32);
        let mut transform = self.transform.pre_translate(x, y);
        if text.upwards {
            transform = transform.pre_concat(Transform::from_rotate(-90.0));
        }
        transform = transform.pre_translate(shift as f32, 0.0);
        let outline = font::outline(&text.text, text.size, text.bold);
        if let Some(halo) = text.halo {
            let stroke = Stroke::new(halo, text.size * HALO);
            self.path(outline.clone(), None, Some(stroke), transform);
        }
        self.path(outline, Some(text.colour), None, transform);
    }

    fn image(&mut self, [x, y, width, height]: [f64; 4], pixels: &Pixels) {
        let Some(mut image) = Pixmap::new(pixels.width, pixels.height) else {
            return;
        };
        for (pixel, [r, g, b, a]) in image.pixels_mut().iter_mut().zip(&pixels.rgba) {
            let times = |value: u8| ((u32::from(value) * u32::from(*a) + 127) / 255) as u8;
            if let Some(colour) = PremultipliedColorU8::from_rgba(times(*r), times(*g), times(*b), *a) {
                *pixel = colour;
            }
        }
        let transform = self
            .transform
            .pre_translate(x as f32, y as f32)
            .pre_scale(width as f32 / pixels.width as f32, height as f32 / pixels.height as f32);
        let paint = PixmapPaint { quality: FilterQuality::Nearest, ..PixmapPaint::default() };
        let mask = self.mask.as_ref();
        self.pixmap.draw_pixmap(0, 0, image.as_ref(), &paint, transform, mask);
    }

    fn mask(&self, [x, y, width, height]: [f64; 4]) -> Option<Mask> {
        let mut mask = Mask::new(self.pixmap.width(), self.pixmap.height())?;
        let rect = Rect::from_xywh(x as f32, y as f32, width as f32, height as f32)?;
        let path = PathBuilder::from_rect(rect);
        mask.fill_path(&path, FillRule::Winding, true, self.transform);
        Some(mask)
    }
}

fn add_line(builder: &mut PathBuilder, points: &[Point], closed: bool) {
    for (index, point) in points.iter().enumerate() {
        let [x, y] = point.map(|value| value as f32);
        if index == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
    }
    match points {
        // A line of length 0: its round ends form a dot.
        [[x, y]] => builder.line_to(*x as f32, *y as f32),
        _ if closed => builder.close(),
        _ => {}
    }
}

fn plain(colour: Colour) -> tiny_skia::Color {
    let [red, green, blue] = colour.rgb;
    tiny_skia::Color::from_rgba8(red, green, blue, colour.alpha)
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(plain(colour));
    paint
}
