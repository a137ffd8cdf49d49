//! A picture as a list of shapes, drawn once and written both as SVG and as PNG.
//!
//! Coordinates are in picture units (one pixel of the SVG at its natural size), x to the right,
//! y down. Shapes cover those before them.

use super::colour::Colour;
use super::font;

/// A point of the picture.
pub type Point = [f64; 2];

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width.
    pub width: f64,
    /// Lengths of dash and gap; `None`: solid.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    #[must_use]
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: None }
    }

    /// The same line with dashes.
    #[must_use]
    pub const fn dashed(self, dash: f64, gap: f64) -> Self {
        Self { dash: Some([dash, gap]), ..self }
    }
}

/// Alignment of a text at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Where the baseline begins, has its middle, or ends: see [`Text::anchor`].
    pub at: Point,
    /// Content.
    pub text: String,
    /// Font size.
    pub size: f64,
    /// Bold letters.
    pub bold: bool,
    /// Which part of the text is at [`Text::at`].
    pub anchor: Anchor,
    /// Its colour.
    pub colour: Colour,
    /// Reads upwards instead of to the right.
    pub upwards: bool,
    /// A margin around the letters that keeps them readable on a picture.
    pub halo: Option<Colour>,
}

impl Text {
    /// Regular ink from left to right.
    #[must_use]
    pub fn new(at: Point, size: f64, anchor: Anchor, text: impl Into<String>) -> Self {
        Self {
            at,
            text: text.into(),
            size,
            bold: false,
            anchor,
            colour: super::colour::INK,
            upwards: false,
            halo: None,
        }
    }

    /// The same text with its capitals centred on [`Text::at`] vertically.
    #[must_use]
    pub fn centred(mut self) -> Self {
        let half = self.size * font::CAPITAL / 2.0;
        self.at[usize::from(!self.upwards)] += half;
        self
    }
}

/// Pixels to place in a picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue and opacity (not multiplied) of each pixel.
    pub rgba: Vec<[u8; 4]>,
}

/// One thing in a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Lines through points, or areas when filled.
    Path {
        /// Each is drawn by itself; a single point with a stroke is a dot.
        lines: Vec<Vec<Point>>,
        /// Whether ends meet.
        closed: bool,
        /// The outline.
        stroke: Option<Stroke>,
        /// The inside.
        fill: Option<Colour>,
    },
    /// A circle.
    Circle {
        /// Its centre.
        centre: Point,
        /// Its radius.
        radius: f64,
        /// The outline.
        stroke: Option<Stroke>,
        /// The inside.
        fill: Option<Colour>,
    },
    /// A line of text.
    Text(Text),
    /// A picture in the picture; its pixels stay sharp squares.
    Image {
        /// Left, top, width, height.
        area: [f64; 4],
        /// Content.
        pixels: Pixels,
    },
    /// Clips later shapes to left, top, width, height; `None` ends the clipping.
    Clip(Option<[f64; 4]>),
}

/// A picture as a list of shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// Title of the picture and of the SVG.
    pub title: String,
    /// Shapes, the lowest first.
    pub shapes: Vec<Shape>,
}

impl Canvas {
    /// An empty white picture.
    #[must_use]
    pub fn new(width: f64, height: f64, title: impl Into<String>) -> Self {
        Self { width, height, title: title.into(), shapes: Vec::new() }
    }

    /// Draws a line through points.
    pub fn line(&mut self, points: Vec<Point>, stroke: Stroke) {
        self.lines(vec![points], stroke);
    }

    /// Draws lines of one style.
    pub fn lines(&mut self, lines: Vec<Vec<Point>>, stroke: Stroke) {
        if lines.iter().any(|line| !line.is_empty()) {
            self.shapes.push(Shape::Path { lines, closed: false, stroke: Some(stroke), fill: None });
        }
    }

    /// Draws an area with or without outline.
    pub fn polygon(&mut self, points: Vec<Point>, fill: Option<Colour>, stroke: Option<Stroke>) {
        self.shapes.push(Shape::Path { lines: vec![points], closed: true, stroke, fill });
    }

    /// Draws a rectangle: left, top, width, height.
    pub fn rectangle(&mut self, [x, y, width, height]: [f64; 4], fill: Option<Colour>, stroke: Option<Stroke>) {
        let (right, bottom) = (x + width, y + height);
        self.polygon(vec![[x, y], [right, y], [right, bottom], [x, bottom]], fill, stroke);
    }

    /// Draws a circle.
    pub fn circle(&mut self, centre: Point, radius: f64, fill: Option<Colour>, stroke: Option<Stroke>) {
        self.shapes.push(Shape::Circle { centre, radius, stroke, fill });
    }

    /// Writes a line of text.
    pub fn text(&mut self, text: Text) {
        if !text.text.is_empty() {
            self.shapes.push(Shape::Text(text));
        }
    }

    /// Clips later shapes to left, top, width, height; `None` ends the clipping.
    pub fn clip(&mut self, area: Option<[f64; 4]>) {
        self.shapes.push(Shape::Clip(area));
    }
}
