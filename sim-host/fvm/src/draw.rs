//! Pictures of models: M-images with one pixel per voxel, and an overview sheet.

use crate::orca::view::{grey, pixels};
use anyhow::{Context as _, Result, bail};
use staya_controller::scalar::Scalar;
use staya_plot::canvas::{Anchor, Canvas, Pixels, Shape, Stroke, Text};
use staya_plot::colour::{Colour, INK, MUTED, PALETTE, WHITE};
use staya_sim::record::write_atomically;
use staya_sim::shown::Shown as _;
use staya_voxel::{HEADER_LEN, Header, Model};
use std::path::{Path, PathBuf};

const NAMES: [&[&str]; 2] = [
    &["cos alpha", "cos beta", "cos gamma", "cos delta"],
    &["cos alpha", "cos beta", "cos gamma", "cos epsilon", "cos delta"],
];

/// Writes a PNG for each component, `STEM-1.png` and so on: one pixel per voxel, north up, 8 or 16
/// bits of grey from -1 (black) to 1 (white). Layers of three variables are stacked from the
/// bottom.
///
/// # Errors
/// The model is invalid, or a file cannot be written.
pub fn m_images(bytes: &[u8], stem: &Path) -> Result<Vec<PathBuf>> {
    let header = Header::read(bytes)?;
    let (width, rows) = (usize::from(header.nodes[0]), usize::from(header.nodes[1]) * usize::from(header.nodes[2]));
    let (length, components) = (header.component_len(), header.components());
    let nodes = bytes.get(HEADER_LEN..).unwrap_or(&[]);
    let mut files = Vec::new();
    for component in 0..components {
        let mut grey = Vec::with_capacity(width * rows * length);
        for row in (0..rows).rev() {
            for column in 0..width {
                let at = ((row * width + column) * components + component) * length;
                if length == 1 {
                    let level = i16::from(nodes[at].cast_signed()) + (1 << (header.depth - 1));
                    grey.push((level << (8 - header.depth)) as u8);
                } else {
                    let level = i32::from(i16::from_le_bytes([nodes[at], nodes[at + 1]])) + (1 << (header.depth - 1));
                    grey.extend(((level << (16 - header.depth)) as u16).to_be_bytes());
                }
            }
        }
        let path = suffixed(stem, &format!("-{}.png", component + 1));
        let mut picture = Vec::new();
        let mut encoder = png::Encoder::new(&mut picture, width as u32, rows as u32);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(if length == 1 { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
        let written = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(&grey)?;
            writer.finish()
        });
        written.with_context(|| path.shown().to_string())?;
        write_atomically(&path, &picture)?;
        files.push(path);
    }
    Ok(files)
}

fn suffixed(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

const SIDE: f64 = 300.0;
const GAP: f64 = 34.0;
const TOP: f64 = 62.0;
const PIXELS: u32 = 360;
/// Value of the full colour, a share of the longer axis.
const LEVEL: f64 = 0.35;
/// Values between two lines, a share of the one of the full colour.
const LINES: f64 = 0.25;

/// Draws values and border, first-order distance, and M-images. Of three variables, it shows the
/// layer nearest to `slice`, by default the middle one.
///
/// # Errors
/// The model is invalid, an axis is too long for its numbers or too short, or the slice is outside
/// the third axis.
pub fn sheet(bytes: &[u8], title: &str, slice: Option<f64>) -> Result<Canvas> {
    if Header::read(bytes)?.variables == 2 {
        let model = Model::<f64, 2>::from_bytes(bytes)?;
        let [nx, ny, _] = Header::read(bytes)?.nodes;
        let [x, y] = drawable(model.extent())?;
        let value = |x: f64, y: f64| model.blend([x, y]).map(|local| local.value);
        let distance = |x: f64, y: f64| model.blend([x, y])?.distance();
        let node =
            |column: u16, row: u16| model.node([column, row]).map(|(slopes, free)| [&slopes[..], &free].concat());
        let fields: [Field<'_>; 2] = [("value", &value), ("distance to the border, to first order", &distance)];
        return Ok(Sheet { extent: [x, y], nodes: [nx, ny], fields: &fields, names: NAMES[0], node: &node }.draw(title));
    }
    let model = Model::<f64, 3>::from_bytes(bytes)?;
    let [nx, ny, nz] = Header::read(bytes)?.nodes;
    let [x, y, [low, high]] = drawable(model.extent())?;
    let at = slice.unwrap_or(0.5 * (low + high));
    if !(low..=high).contains(&at) {
        bail!("no slice at {at}; give {low} to {high} along the third axis");
    }
    let layer = libm::round((at - low) / (high - low) * f64::from(nz - 1)) as u16;
    let value = |x: f64, y: f64| model.blend([x, y, at]).map(|local| local.value);
    let node =
        |column: u16, row: u16| model.node([column, row, layer]).map(|(slopes, free)| [&slopes[..], &free].concat());
    let fields: [Field<'_>; 1] = [("value", &value)];
    let title = format!("{title}, third variable {at:.3}");
    Ok(Sheet { extent: [x, y], nodes: [nx, ny], fields: &fields, names: NAMES[1], node: &node }.draw(&title))
}

/// Refuses axes without a finite length, from which the size of the picture would follow.
fn drawable<const V: usize>(extent: [[f64; 2]; V]) -> Result<[[f64; 2]; V]> {
    let is_drawable = |[low, high]: [f64; 2]| low < high && high <= f64::from(f32::MAX);
    match (1..).zip(extent).find(|(_, ends)| !is_drawable(*ends)) {
        Some((axis, [low, high])) => bail!(
            "axis {axis} of the model goes from {low:e} to {high:e}; build it again with different ends, at most {:e}",
            f32::MAX
        ),
        None => Ok(extent),
    }
}

type Field<'a> = (&'a str, &'a dyn Fn(f64, f64) -> Option<f64>);

struct Sheet<'a> {
    extent: [[f64; 2]; 2],
    nodes: [u16; 2],
    fields: &'a [Field<'a>],
    names: &'a [&'a str],
    node: &'a dyn Fn(u16, u16) -> Option<Vec<f64>>,
}

impl Sheet<'_> {
    fn draw(&self, title: &str) -> Canvas {
        let [[west, east], [south, north]] = self.extent;
        let longest = (east - west).max(north - south);
        let (width, height) = (SIDE * (east - west) / longest, SIDE * (north - south) / longest);
        let pictures = self.fields.len() + self.names.len();
        let columns = 3.min(pictures);
        let rows = pictures.div_ceil(columns);
        let mut canvas =
            Canvas::new(GAP + (width + GAP) * columns as f64, TOP + (height + GAP + 16.0) * rows as f64 + 22.0, title);
        canvas.text(Text { bold: true, ..Text::new([GAP, 28.0], 16.0, Anchor::Start, title) });
        let place = |index: usize| {
            let (row, column) = (index / columns, index % columns);
            [GAP + (width + GAP) * column as f64, TOP + (height + GAP + 16.0) * row as f64, width, height]
        };
        let scale = f64::from(PIXELS) / longest;
        let [across, up] = [east - west, north - south].map(|side| (libm::round(side * scale) as u32).max(1));
        for (index, (name, field)) in self.fields.iter().enumerate() {
            let along = |pixel: u32, pixels: u32| (f64::from(pixel) + 0.5) / f64::from(pixels);
            let pixels = pixels(across, up, |column, row| {
                let (x, y) = (west + (east - west) * along(column, across), south + (north - south) * along(row, up));
                field(x, y).map_or([0; 4], |value| contoured(value, LEVEL * longest, 1.2 / scale))
            });
            self.show(&mut canvas, place(index), name, pixels);
        }
        let [nx, ny] = self.nodes;
        for (component, name) in self.names.iter().enumerate() {
            let pixels = pixels(nx.into(), ny.into(), |column, row| {
                let node = (self.node)(column as u16, row as u16);
                node.and_then(|node| node.get(component).copied()).map_or([0, 0, 0, 255], grey)
            });
            self.show(&mut canvas, place(self.fields.len() + component), name, pixels);
        }
        let lines = rounded(LINES * LEVEL * longest);
        let note = format!("orange: above 0, blue: below, black: 0, a line each {lines}; cos: black -1, white 1");
        canvas.text(Text::new([GAP, canvas.height - 12.0], 11.5, Anchor::Start, note).muted());
        canvas
    }

    /// Draws an image with its name above and the ends of both axes below.
    fn show(&self, canvas: &mut Canvas, area: [f64; 4], name: &str, pixels: Pixels) {
        let [left, top, width, height] = area;
        let middle = left + width / 2.0;
        canvas.text(Text::new([middle, top - 7.0], 12.5, Anchor::Middle, name));
        canvas.shapes.push(Shape::Image { area, pixels });
        canvas.rectangle([left, top, width, height], None, Some(Stroke::new(MUTED, 1.0)));
        let [x, y] = self.extent.map(|[low, high]| format!("{} to {}", rounded(low), rounded(high)));
        canvas.text(Text::new([middle, top + height + 16.0], 11.0, Anchor::Middle, format!("x {x}, y {y}")).muted());
    }
}

/// With four digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

fn contoured(value: f64, most: f64, line: f64) -> [u8; 4] {
    let colour = if value > 0.0 { PALETTE[1] } else { PALETTE[0] };
    let fill = WHITE.towards(colour, Scalar::min(value.abs() / most, 1.0) * 0.7 + 0.08);
    let step = LINES * most;
    let off = (value - step * libm::round(value / step)).abs();
    let Colour { rgb: [red, green, blue], .. } = if value.abs() < line {
        INK
    } else if off < 0.5 * line {
        fill.towards(INK, 0.3)
    } else {
        fill
    };
    [red, green, blue, 255]
}
