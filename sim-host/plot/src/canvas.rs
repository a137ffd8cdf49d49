//! A picture as a list of shapes, written both as SVG and as PNG.
//!
//! Coordinates are in picture units (pixels of the SVG at its natural size), x to the right, y
//! down. Later shapes cover earlier ones.

use super::colour::{Colour, MUTED, WHITE};
use super::font;

/// A point of the picture, x and y.
pub type Point = [f64; 2];

/// Lowest and highest coordinates of points, infinite without any; NaN does not count.
pub(crate) fn extent<const N: usize>(points: impl IntoIterator<Item = [f64; N]>) -> [[f64; N]; 2] {
    points.into_iter().fold([[f64::INFINITY; N], [f64::NEG_INFINITY; N]], |[low, high], at| {
        [std::array::from_fn(|axis| low[axis].min(at[axis])), std::array::from_fn(|axis| high[axis].max(at[axis]))]
    })
}

/// The longer horizontal side of an extent.
pub(crate) fn longest<const N: usize>([low, high]: [[f64; N]; 2]) -> f64 {
    (high[0] - low[0]).max(high[1] - low[1])
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub colour: Colour,
    /// Width in units.
    pub width: f64,
    /// Lengths of dash and gap; `None`: solid.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// Creates a solid line.
    #[must_use]
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: None }
    }

    /// Returns the line with dashes.
    #[must_use]
    pub const fn dashed(self, dash: f64, gap: f64) -> Self {
        Self { dash: Some([dash, gap]), ..self }
    }
}

/// Alignment of a text at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the point.
    Start,
    /// The middle of the text is at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Point on the baseline: start, middle or end of the text, by [`Text::anchor`].
    pub at: Point,
    /// The letters.
    pub text: String,
    /// Font size.
    pub size: f64,
    /// Bold letters.
    pub bold: bool,
    /// Part of the text that is at [`Text::at`].
    pub anchor: Anchor,
    /// Colour of the letters.
    pub colour: Colour,
    /// Whether the text reads upwards instead of to the right.
    pub upwards: bool,
    /// Colour of a margin around the letters, which keeps them readable on a picture.
    pub halo: Option<Colour>,
}

impl Text {
    /// Creates a text in regular ink from left to right.
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

    /// Returns the text in the grey of numbers and notes.
    #[must_use]
    pub fn muted(self) -> Self {
        Self { colour: MUTED, ..self }
    }

    /// Centres the capitals on [`Text::at`] vertically.
    #[must_use]
    pub fn centred(mut self) -> Self {
        let half = self.size * font::CAPITAL / 2.0;
        self.at[usize::from(!self.upwards)] += half;
        self
    }
}

/// Pixels of an image inside a picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Red, green, blue and opacity of each pixel; colours are not multiplied by the opacity.
    pub rgba: Vec<[u8; 4]>,
}

/// One shape of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Lines through points, or filled areas.
    Path {
        /// Separate lines; a single point with a stroke is a dot.
        lines: Vec<Vec<Point>>,
        /// Whether the last point is joined to the first one.
        closed: bool,
        /// Style of the outline.
        stroke: Option<Stroke>,
        /// Colour of the inside.
        fill: Option<Colour>,
    },
    /// A circle.
    Circle {
        /// Centre of the circle.
        centre: Point,
        /// Radius in units.
        radius: f64,
        /// Style of the outline.
        stroke: Option<Stroke>,
        /// Colour of the inside.
        fill: Option<Colour>,
    },
    /// A line of text.
    Text(Text),
    /// An image; its pixels stay sharp squares.
    Image {
        /// Left, top, width, height.
        area: [f64; 4],
        /// Pixels of the image.
        pixels: Pixels,
    },
    /// Clips later shapes to left, top, width, height; `None` ends the clipping.
    Clip(Option<[f64; 4]>),
}

/// A picture as a list of shapes, in units; written by [`Canvas::write`].
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
    /// Creates an empty white picture.
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

    /// Draws a diagonal cross with a white margin of that width.
    pub fn cross(&mut self, [x, y]: Point, arm: f64, margin: f64, stroke: Stroke) {
        let lines = vec![vec![[x - arm, y - arm], [x + arm, y + arm]], vec![[x - arm, y + arm], [x + arm, y - arm]]];
        self.lines(lines.clone(), Stroke::new(WHITE, margin));
        self.lines(lines, stroke);
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
