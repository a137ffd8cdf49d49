//! Pictures as SVG. Text stays text in the reader's sans-serif font.

use super::canvas::{Anchor, Canvas, Point, Shape, Stroke, Text};
use super::colour::Colour;
use super::raster;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::{Display, Write as _};
use std::io;

/// Writes a picture; an error if an image in it has no pixels or too many.
pub fn text(canvas: &Canvas) -> io::Result<String> {
    let [width, height] = [canvas.width, canvas.height].map(Number);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\">\n<title>{}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n",
        Escaped(&canvas.title),
    );
    let mut clips = 0;
    let mut clipped = false;
    for shape in &canvas.shapes {
        // Writing to a string cannot fail.
        let _ = match shape {
            Shape::Path { lines, closed, stroke, fill } => {
                out.push_str("<path d=\"");
                lines.iter().for_each(|line| path(&mut out, line, *closed));
                writeln!(out, "\"{}/>", Paint(*stroke, *fill))
            }
            Shape::Circle { centre: [x, y], radius, stroke, fill } => {
                let ([x, y, r], paint) = ([*x, *y, *radius].map(Number), Paint(*stroke, *fill));
                writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{paint}/>")
            }
            Shape::Text(text) => element(&mut out, text),
            Shape::Image { area, pixels } => {
                let [x, y, width, height] = area.map(Number);
                let png = STANDARD.encode(raster::encode_rgba(pixels)?);
                writeln!(
                    out,
                    "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
                     style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{png}\"/>"
                )
            }
            Shape::Clip(area) => {
                if clipped {
                    out.push_str("</g>\n");
                }
                clipped = area.is_some();
                area.map_or(Ok(()), |area| {
                    clips += 1;
                    let [x, y, width, height] = area.map(Number);
                    writeln!(
                        out,
                        "<clipPath id=\"c{clips}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>\n\
                         <g clip-path=\"url(#c{clips})\">"
                    )
                })
            }
        };
    }
    if clipped {
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn path(out: &mut String, points: &[Point], closed: bool) {
    for (index, [x, y]) in points.iter().enumerate() {
        let command = if index == 0 { 'M' } else { 'L' };
        let _ = write!(out, "{command}{} {}", Number(*x), Number(*y));
    }
    match points {
        // A line of length 0: its round ends form a dot.
        [_] => out.push_str("h0"),
        _ if closed => out.push('Z'),
        _ => {}
    }
}

fn element(out: &mut String, text: &Text) -> std::fmt::Result {
    let [x, y] = text.at.map(Number);
    write!(out, "<text font-size=\"{}\"", Number(text.size))?;
    if text.upwards {
        write!(out, " transform=\"translate({x} {y}) rotate(-90)\"")?;
    } else {
        write!(out, " x=\"{x}\" y=\"{y}\"")?;
    }
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => out.push_str(" text-anchor=\"middle\""),
        Anchor::End => out.push_str(" text-anchor=\"end\""),
    }
    if text.bold {
        out.push_str(" font-weight=\"bold\"");
    }
    let stroke = text.halo.map(|halo| Stroke::new(halo, text.size * super::raster::HALO));
    write!(out, "{}", Paint(stroke, Some(text.colour)))?;
    if stroke.is_some() {
        out.push_str(" paint-order=\"stroke\"");
    }
    writeln!(out, ">{}</text>", Escaped(&text.text))
}

struct Paint(Option<Stroke>, Option<Colour>);

impl Display for Paint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.1 {
            Some(fill) => colour(f, "fill", fill)?,
            None => f.write_str(" fill=\"none\"")?,
        }
        if let Some(stroke) = self.0 {
            colour(f, "stroke", stroke.colour)?;
            if (stroke.width - 1.0).abs() > 1e-9 {
                write!(f, " stroke-width=\"{}\"", Number(stroke.width))?;
            }
            if let Some([dash, gap]) = stroke.dash {
                // Round ends would fill the gaps.
                let (dash, gap) = (Number(dash), Number(gap));
                write!(f, " stroke-dasharray=\"{dash} {gap}\" stroke-linecap=\"butt\"")?;
            }
        }
        Ok(())
    }
}

fn colour(f: &mut std::fmt::Formatter<'_>, name: &str, colour: Colour) -> std::fmt::Result {
    let [red, green, blue] = colour.rgb;
    write!(f, " {name}=\"#{red:02x}{green:02x}{blue:02x}\"")?;
    if colour.alpha < 255 {
        let share = Number(f64::from(colour.alpha) / 255.0);
        write!(f, " {name}-opacity=\"{share}\"")?;
    }
    Ok(())
}

/// At most two decimals; NaN and infinity, which SVG does not have, become 0.
struct Number(f64);

impl Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hundredths = libm::round(self.0 * 100.0);
        if hundredths == 0.0 || !hundredths.is_finite() {
            return f.write_str("0");
        }
        // The shortest decimal that reads back as this number has at most two decimals.
        write!(f, "{}", hundredths / 100.0)
    }
}

/// Escapes XML and removes characters that XML forbids.
struct Escaped<'a>(&'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.chars().try_for_each(|letter| match letter {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '\n' | '\t' => f.write_char(' '),
            '\u{fffe}' | '\u{ffff}' => Ok(()),
            other if other.is_control() => Ok(()),
            other => f.write_char(other),
        })
    }
}
