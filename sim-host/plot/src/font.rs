//! Text on computers without fonts: outlines of Noto Sans (SIL Open Font License).

use std::sync::LazyLock;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, OutlineBuilder};

/// Height of capitals and digits as a share of the font size.
pub const CAPITAL: f64 = 0.714;

static FACES: LazyLock<[Face<'static>; 2]> = LazyLock::new(|| {
    [notosans::REGULAR_TTF, notosans::BOLD_TTF]
        .map(|bytes| Face::parse(bytes, 0).expect("a font that is compiled in and tested"))
});

#[must_use]
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let face = &FACES[usize::from(bold)];
    let units: u32 = text.chars().map(|letter| u32::from(advance(face, letter))).sum();
    f64::from(units) * size / f64::from(face.units_per_em())
}

/// Width of the widest text.
pub fn widest<'a>(texts: impl IntoIterator<Item = &'a String>, size: f64) -> f64 {
    texts.into_iter().map(|text| width(text, size, false)).fold(0.0, f64::max)
}

fn advance(face: &Face<'_>, letter: char) -> u16 {
    let glyph = face.glyph_index(letter).unwrap_or_default();
    face.glyph_hor_advance(glyph).unwrap_or(0)
}

/// Outline of a line of text, y down, baseline at 0; `None` if nothing is visible.
#[must_use]
pub fn outline(text: &str, size: f64, bold: bool) -> Option<Path> {
    let face = &FACES[usize::from(bold)];
    let mut pen = Pen { path: PathBuilder::new(), scale: size as f32 / f32::from(face.units_per_em()), x: 0.0 };
    for letter in text.chars() {
        // Unknown letters become the font's empty box (glyph 0).
        let glyph = face.glyph_index(letter).unwrap_or_default();
        face.outline_glyph(glyph, &mut pen);
        pen.x += f32::from(advance(face, letter)) * pen.scale;
    }
    pen.path.finish()
}

struct Pen {
    path: PathBuilder,
    scale: f32,
    x: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, -y * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// Shrinks a text to at least 70 %, then shortens it, until it fits. Returns text and size.
#[must_use]
pub fn fit(text: &str, size: f64, bold: bool, room: f64) -> (String, f64) {
    let full = width(text, size, bold);
    if full <= room {
        return (text.to_owned(), size);
    }
    let smaller = size * (room / full).max(0.7);
    let mut short = text.to_owned();
    let mut shown = short.clone();
    while width(&shown, smaller, bold) > room && short.pop().is_some() {
        shown = format!("{}…", short.trim_end());
    }
    (shown, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_every_letter_that_charts_use() {
        let used = "AZaz09 .,:;%()[]/+-±–×·²³µ°ΔΦδελρσ→≤≥…′";
        for face in FACES.iter() {
            for letter in used.chars() {
                assert!(face.glyph_index(letter).is_some(), "{letter}");
            }
            let capital = f64::from(face.capital_height().unwrap());
            assert!((capital / f64::from(face.units_per_em()) - CAPITAL).abs() < 1e-3);
        }
    }

    #[test]
    fn outlines_are_as_wide_as_measured() {
        for (text, bold) in [("Hill 42", false), ("formation", true), ("Φ ≤ ½", false)] {
            let bounds = outline(text, 20.0, bold).unwrap().bounds();
            let wide = width(text, 20.0, bold);
            assert!((f64::from(bounds.right()) - wide).abs() < 3.0, "{text}");
            assert!(bounds.bottom() < 6.0 && bounds.top() > -20.0, "{text}");
        }
        assert!(outline("", 20.0, false).is_none());
        assert!(outline("   ", 20.0, false).is_none());
    }

    #[test]
    fn long_text_is_shrunk_then_shortened() {
        assert_eq!(fit("abc", 10.0, false, 100.0), ("abc".into(), 10.0));
        let long = "a title that is too long";
        let room = width(long, 10.0, true) * 0.8;
        let (text, size) = fit(long, 10.0, true, room);
        assert_eq!(text, long);
        assert!((size - 8.0).abs() < 1e-9);
        let (text, size) = fit(long, 10.0, true, room / 2.0);
        assert!(text.ends_with('…') && text.len() > 5, "{text}");
        assert!(width(&text, size, true) <= room / 2.0);
        assert_eq!(fit("abc", 10.0, false, 0.0).0, "…");
    }
}
