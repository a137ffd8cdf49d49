//! Tests of charts, pictures of runs, and files.

mod charts;
mod colours;
mod flocks;
mod motion;
mod runs;
mod ticks;

use super::canvas::{Anchor, Canvas, Shape};
use super::font;
use std::path::Path;

/// XML with one root, every element closed, and no bare special characters.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut roots = 0;
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        assert!(!open.is_empty() || text.trim().is_empty(), "text outside the root: {text}");
        assert!(!text.contains('>'), "bare > in {text}");
        for (at, _) in text.match_indices('&') {
            let entity = text[at..].split_inclusive(';').next().unwrap();
            assert!(["&amp;", "&lt;", "&gt;"].contains(&entity), "{entity}");
        }
        let end = start + rest[start..].find('>').expect("a tag that ends");
        let tag = &rest[start + 1..end];
        assert!(!tag.contains('<'), "{tag}");
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let attributes = tag.split("base64,").next().unwrap();
        for bad in ["NaN", "inf"] {
            assert!(!attributes.contains(bad), "{bad} in {attributes}");
        }
        let name = tag.trim_start_matches('/').split([' ', '/', '\n']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            roots += usize::from(open.is_empty());
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty(), "left open: {open:?}");
    assert_eq!(roots, 1);
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
}

/// Width, height and RGB.
pub(crate) fn decode(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width, info.height, bytes)
}

fn assert_readable(files: &[std::path::PathBuf]) {
    assert!(files.len().is_multiple_of(2));
    for path in files {
        match path.extension().unwrap().to_str().unwrap() {
            "svg" => assert_well_formed(&std::fs::read_to_string(path).unwrap()),
            "png" => {
                let (width, height, bytes) = decode(path);
                assert_eq!(bytes.len(), (width * height * 3) as usize);
                assert!(bytes.iter().any(|byte| *byte < 255), "nothing drawn");
            }
            other => panic!("{other}"),
        }
    }
}

/// Left, top, right, bottom.
fn text_boxes(canvas: &Canvas) -> Vec<(String, [f64; 4])> {
    let texts = canvas.shapes.iter().filter_map(|shape| match shape {
        Shape::Text(text) => Some(text),
        _ => None,
    });
    texts
        .map(|text| {
            let width = font::width(&text.text, text.size, text.bold);
            let from = match text.anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -width / 2.0,
                Anchor::End => -width,
            };
            let (rise, [x, y]) = (text.size * font::CAPITAL, text.at);
            let area = if text.upwards {
                [x - rise, y - from - width, x, y - from]
            } else {
                [x + from, y - rise, x + from + width, y]
            };
            (text.text.clone(), area)
        })
        .collect()
}

pub(crate) fn assert_texts_apart(canvas: &Canvas) {
    let boxes = text_boxes(canvas);
    for (index, (text, [left, top, right, bottom])) in boxes.iter().enumerate() {
        assert!(
            *left >= 0.0 && *top >= 0.0 && *right <= canvas.width && *bottom <= canvas.height,
            "{text:?} leaves the picture: {left} {top} {right} {bottom}"
        );
        for (other, [l, t, r, b]) in &boxes[index + 1..] {
            let apart = right <= l || r <= left || bottom <= t || b <= top;
            assert!(apart, "{text:?} covers {other:?}");
        }
    }
}
