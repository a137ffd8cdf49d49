//! The YAML file of a `map_server` map, which consists of flat `key: value` lines.
//!
//! A hand-written parser: a serde YAML crate has six to twenty dependencies, and does not report
//! the line of a value that is valid YAML but out of range.

use super::super::error::{Place, TerrainError, format_error};
use super::super::text::{finite, lines, quoted, text};
use std::path::Path;

/// Interpretation of pixels between the thresholds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Free, occupied or unknown.
    #[default]
    Trinary,
    /// A pixel between the thresholds has an impassability in proportion to its value.
    Scale,
}

/// Fields of the YAML file.
#[derive(Clone, Debug, PartialEq)]
pub struct Meta {
    /// Path of the image, relative to the YAML file.
    pub image: String,
    /// Side of a pixel, metres; more than 0.
    pub resolution_m: f64,
    /// World position of the south-west corner of the image, metres.
    pub origin_m: [f64; 2],
    /// A pixel is occupied if its probability is greater.
    pub occupied_thresh: f64,
    /// A pixel is free if its probability is less.
    pub free_thresh: f64,
    /// Whether bright pixels are occupied.
    pub negate: bool,
    /// Interpretation of pixels between the thresholds; default `trinary`.
    pub mode: Mode,
    /// Number of classes in mode `scale`, if given (Staya's own key).
    pub classes: Option<u8>,
}

type Entry<'a> = Option<(usize, &'a str)>;

#[derive(Default)]
struct Entries<'a> {
    image: Entry<'a>,
    resolution: Entry<'a>,
    origin: Entry<'a>,
    origin_items: Vec<(usize, &'a str)>,
    occupied_thresh: Entry<'a>,
    free_thresh: Entry<'a>,
    negate: Entry<'a>,
    mode: Entry<'a>,
    classes: Entry<'a>,
}

/// Reads the YAML file of a map. Keys that ROS does not know are ignored, as in ROS.
///
/// # Errors
/// A [`TerrainError::Format`] with the line: a key is missing, duplicated or has an invalid value,
/// the origin is rotated (yaw other than 0), or the mode is `raw`.
pub fn parse_meta(bytes: &[u8], path: &Path) -> Result<Meta, TerrainError> {
    let text = text(bytes, path)?;
    let entries = collect(text, path)?;
    let need = |entry: Entry<'_>, key: &str| -> Result<(usize, String), TerrainError> {
        entry.map(|(line, word)| (line, word.to_owned())).ok_or_else(|| {
            format_error(
                path,
                Place::File,
                format!("{key} is missing"),
                "a map_server file has image, resolution, origin, occupied_thresh, free_thresh, negate",
            )
        })
    };
    let number = |entry: Entry<'_>, key: &str| -> Result<(usize, f64), TerrainError> {
        let (line, word) = need(entry, key)?;
        Ok((line, finite(path, line, key, &word)?))
    };
    let (_, image) = need(entries.image, "image")?;
    let (line, resolution_m) = number(entries.resolution, "resolution")?;
    if resolution_m <= 0.0 {
        return Err(format_error(
            path,
            Place::Line(line),
            format!("resolution is {resolution_m}"),
            "give metres per pixel, more than 0",
        ));
    }
    let (line, occupied_thresh) = number(entries.occupied_thresh, "occupied_thresh")?;
    let (_, free_thresh) = number(entries.free_thresh, "free_thresh")?;
    if free_thresh > occupied_thresh {
        return Err(format_error(
            path,
            Place::Line(line),
            format!("occupied_thresh {occupied_thresh} is less than free_thresh {free_thresh}"),
            "give free_thresh <= occupied_thresh",
        ));
    }
    let (line, word) = need(entries.negate, "negate")?;
    let negate = match word.to_ascii_lowercase().as_str() {
        "0" | "false" => false,
        "1" | "true" => true,
        _ => return Err(choice(path, line, "negate", &word, "give 0 or 1")),
    };
    let mode = match entries.mode {
        None | Some((_, "trinary")) => Mode::Trinary,
        Some((_, "scale")) => Mode::Scale,
        Some((line, word)) => {
            let remedy = "give trinary or scale; raw pixels have no agreed meaning for robots";
            return Err(choice(path, line, "mode", word, remedy));
        }
    };
    let classes = match entries.classes {
        None => None,
        Some((line, word)) => match word.parse() {
            Ok(classes @ 1..=255_u8) => Some(classes),
            _ => {
                let key = "impassability_classes";
                return Err(choice(path, line, key, word, "give a whole number from 1 to 255"));
            }
        },
    };
    Ok(Meta {
        image,
        resolution_m,
        origin_m: origin(&entries, path)?,
        occupied_thresh,
        free_thresh,
        negate,
        mode,
        classes,
    })
}

fn choice(path: &Path, line: usize, key: &str, word: &str, remedy: &str) -> TerrainError {
    let what = format!("{key} is {}", quoted(word));
    format_error(path, Place::Line(line), what, remedy)
}

fn collect<'a>(text: &'a str, path: &Path) -> Result<Entries<'a>, TerrainError> {
    let mut entries = Entries::default();
    let mut in_origin = false;
    for (line, raw) in lines(text) {
        let row = without_comment(raw);
        let bare = row.trim();
        if in_origin && let Some(item) = bare.strip_prefix("- ") {
            entries.origin_items.push((line, item.trim()));
            continue;
        }
        // Indented lines belong to foreign keys.
        let is_top = !row.starts_with([' ', '\t', '-']);
        if bare.is_empty() || bare == "---" || bare == "..." || !is_top {
            continue;
        }
        let Some((key, value)) = bare.split_once(':') else {
            return Err(format_error(
                path,
                Place::Line(line),
                quoted(bare),
                "each line of a map_server file is: key: value",
            ));
        };
        let value = unquoted(value.trim());
        in_origin = key == "origin";
        let entry = match key {
            "image" => &mut entries.image,
            "resolution" => &mut entries.resolution,
            "origin" => &mut entries.origin,
            "occupied_thresh" => &mut entries.occupied_thresh,
            "free_thresh" => &mut entries.free_thresh,
            "negate" => &mut entries.negate,
            "mode" => &mut entries.mode,
            "impassability_classes" => &mut entries.classes,
            _ => continue,
        };
        if entry.replace((line, value)).is_some() {
            return Err(format_error(path, Place::Line(line), format!("{key} is given twice"), "keep one of them"));
        }
    }
    Ok(entries)
}

/// The line up to a `#` at its start or after whitespace, outside quotes.
fn without_comment(row: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (at, letter) in row.char_indices() {
        match quote {
            Some(open) if letter == open => quote = None,
            Some(_) => {}
            None if matches!(letter, '"' | '\'') => quote = Some(letter),
            None if letter == '#' && before.is_whitespace() => return &row[..at],
            None => {}
        }
        before = letter;
    }
    row
}

fn unquoted(value: &str) -> &str {
    ['"', '\''].into_iter().find_map(|quote| value.strip_prefix(quote)?.strip_suffix(quote)).unwrap_or(value)
}

/// Parses the origin: `[x, y, yaw]` in one line, or three lines with a dash.
fn origin(entries: &Entries<'_>, path: &Path) -> Result<[f64; 2], TerrainError> {
    let place = entries.origin.map_or(Place::File, |(line, _)| Place::Line(line));
    let in_line = entries.origin.and_then(|(line, value)| {
        let items = value.strip_prefix('[')?.strip_suffix(']')?;
        Some(items.split(',').map(|item| (line, item.trim())).collect())
    });
    let items: Vec<(usize, &str)> = in_line.unwrap_or_else(|| entries.origin_items.clone());
    let [x, y, yaw] = items[..] else {
        return Err(format_error(
            path,
            place,
            "origin is missing or has no three numbers",
            "give origin: [x, y, yaw] in metres and radians",
        ));
    };
    let number = |(line, word): (usize, &str)| finite(path, line, "origin", word);
    if number(yaw)? != 0.0 {
        return Err(format_error(
            path,
            place,
            format!("the origin is turned by {} radians", yaw.1),
            "rotated maps are not supported: resample the picture so that north is up and give yaw 0",
        ));
    }
    Ok([number(x)?, number(y)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FILE: &str = "# a map\nimage: \"my #1 map.pgm\" # named\nresolution: 0.1\norigin: [-1, 2.5, 0.0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n";

    fn meta(text: &str) -> Result<Meta, TerrainError> {
        parse_meta(text.as_bytes(), Path::new("m.yaml"))
    }

    #[test]
    fn a_typical_file_is_read() {
        let expected = Meta {
            image: "my #1 map.pgm".into(),
            resolution_m: 0.1,
            origin_m: [-1.0, 2.5],
            occupied_thresh: 0.65,
            free_thresh: 0.196,
            negate: false,
            mode: Mode::Trinary,
            classes: None,
        };
        assert_eq!(meta(FILE).unwrap(), expected);
    }

    #[test]
    fn dash_lists_foreign_keys_and_document_marks_are_accepted() {
        let text = FILE.replace("[-1, 2.5, 0.0]", "\n- -1\n  - 2.5\n- 0.0");
        let text = format!("---\r\n{text}mode: scale\nother:\n  deep: 1\n  - x\nimpassability_classes: 12\n...\n");
        let meta = meta(&text).unwrap();
        assert_eq!(meta.origin_m, [-1.0, 2.5]);
        assert_eq!((meta.mode, meta.classes), (Mode::Scale, Some(12)));
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases = [
            (FILE.replace("negate: 0\n", ""), "m.yaml: negate is missing; a map_server file has"),
            (FILE.replace("negate: 0", "negate: 2"), "m.yaml:7: negate is \"2\"; give 0 or 1"),
            (FILE.replace("0.1\n", "0\n"), "m.yaml:3: resolution is 0; give metres per pixel"),
            (FILE.replace("0.1\n", ".nan\n"), "m.yaml:3: resolution is \".nan\"; give a finite number"),
            (FILE.replace("2.5, 0.0", "2.5, 1.57"), "m.yaml:4: the origin is turned by 1.57 radians; rotated maps"),
            (FILE.replace("2.5, 0.0", "2.5"), "m.yaml:4: origin is missing or has no three numbers"),
            (FILE.replace("0.196", "0.9"), "m.yaml:5: occupied_thresh 0.65 is less than free_thresh 0.9"),
            (format!("{FILE}mode: raw"), "m.yaml:8: mode is \"raw\"; give trinary or scale"),
            (format!("{FILE}negate: 1"), "m.yaml:8: negate is given twice"),
            (format!("{FILE}impassability_classes: 256"), "m.yaml:8: impassability_classes is \"256\""),
            (format!("{FILE}what is this"), "m.yaml:8: \"what is this\"; each line"),
            (String::new(), "m.yaml: image is missing"),
        ];
        for (text, expected) in cases {
            let message = meta(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_file_or_an_error(bytes: Vec<u8>) {
            let _ = parse_meta(&bytes, Path::new("m.yaml"));
        }

        #[test]
        fn any_lines_are_a_file_or_an_error(
            lines in "((image|origin|negate|resolution|mode|free_thresh):? ?[\\[\\]0-9,.'\"# -]{0,8}\n){0,8}",
        ) {
            let _ = meta(&lines);
            let _ = meta(&format!("{FILE}{lines}"));
        }
    }
}
