//! The YAML file of a `map_server` map: a table of values, and the origin as a list.
//!
//! Reads the events of a parser, since they have lines; serde loses the line of a value that is
//! valid YAML but out of range.

use super::super::error::{Place, TerrainError, format_error};
use super::super::text::{finite, quoted, text};
use saphyr_parser::{Event, Parser, StrInput};
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

/// A value of the file, with the line where it begins.
struct Entry {
    line: usize,
    value: Value,
}

enum Value {
    Text(String),
    /// The items, if each of them is a text.
    List(Option<Vec<(usize, String)>>),
    Table,
    Alias,
}

impl Value {
    /// Its kind, for an error text.
    fn words(&self) -> String {
        match self {
            Self::Text(text) => quoted(text),
            Self::List(_) => "a list".to_owned(),
            Self::Table => "a table".to_owned(),
            Self::Alias => "an alias (*name), which is not read".to_owned(),
        }
    }
}

/// The entries at the top of a file.
struct Entries<'a> {
    path: &'a Path,
    found: Vec<(String, Entry)>,
}

const KEYS: [&str; 8] =
    ["image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate", "mode", "impassability_classes"];

impl Entries<'_> {
    fn get(&self, key: &str) -> Option<&Entry> {
        self.found.iter().find(|(name, _)| name == key).map(|(_, entry)| entry)
    }

    fn need(&self, key: &str) -> Result<&Entry, TerrainError> {
        self.get(key).ok_or_else(|| {
            format_error(
                self.path,
                Place::File,
                format!("{key} is missing"),
                "a map_server file has image, resolution, origin, occupied_thresh, free_thresh, negate at its top",
            )
        })
    }

    fn refuse<T>(&self, line: usize, what: String, remedy: &str) -> Result<T, TerrainError> {
        Err(format_error(self.path, Place::Line(line), what, remedy))
    }

    fn text<'e>(&self, key: &str, entry: &'e Entry) -> Result<&'e str, TerrainError> {
        match &entry.value {
            Value::Text(text) if !text.is_empty() => Ok(text),
            Value::Text(_) => self.refuse(entry.line, format!("{key} is empty"), "give its value"),
            other => self.refuse(entry.line, format!("{key} is {}", other.words()), "give one value"),
        }
    }

    /// A number with the line where it stands.
    fn number(&self, key: &str) -> Result<(usize, f64), TerrainError> {
        let entry = self.need(key)?;
        Ok((entry.line, finite(self.path, entry.line, key, self.text(key, entry)?)?))
    }

    fn threshold(&self, key: &str) -> Result<(usize, f64), TerrainError> {
        let (line, share) = self.number(key)?;
        if !(0.0..=1.0).contains(&share) {
            let remedy = "give a probability from 0 to 1: 65 % is 0.65";
            return self.refuse(line, format!("{key} is {share}"), remedy);
        }
        Ok((line, share))
    }

    /// The origin: x, y, yaw.
    fn origin_m(&self) -> Result<[f64; 2], TerrainError> {
        let (entry, remedy) = (self.need("origin")?, "give origin: [x, y, yaw] in metres and radians");
        let [x, y, yaw] = match &entry.value {
            Value::List(Some(items)) => match &items[..] {
                [x, y, yaw] => [x, y, yaw],
                _ => {
                    let what = format!("origin has {} of three numbers", items.len());
                    return self.refuse(entry.line, what, remedy);
                }
            },
            Value::List(None) => return self.refuse(entry.line, "origin is not a list of numbers".into(), remedy),
            other => return self.refuse(entry.line, format!("origin is {}", other.words()), remedy),
        };
        let number = |(line, word): &(usize, String)| finite(self.path, *line, "origin", word);
        if number(yaw)? != 0.0 {
            let remedy = "rotated maps are not supported: resample the picture so that north is up and give yaw 0";
            return self.refuse(yaw.0, format!("the origin is turned by {} radians", yaw.1), remedy);
        }
        Ok([number(x)?, number(y)?])
    }
}

/// Reads the YAML file of a map: block or flow style, of which the first document counts, as in
/// ROS. Keys that ROS does not know are ignored, as in ROS.
///
/// # Errors
/// A [`TerrainError::Format`] with the line: a key is missing, duplicated or has an invalid value,
/// a threshold is not a probability, the origin is rotated (yaw other than 0), or the mode is
/// `raw`.
pub fn parse_meta(bytes: &[u8], path: &Path) -> Result<Meta, TerrainError> {
    let entries = collect(text(bytes, path)?, path)?;
    let image = entries.text("image", entries.need("image")?)?.to_owned();
    let (line, resolution_m) = entries.number("resolution")?;
    if resolution_m <= 0.0 {
        let what = format!("resolution is {resolution_m}");
        return entries.refuse(line, what, "give metres per pixel, more than 0");
    }
    let (line, occupied_thresh) = entries.threshold("occupied_thresh")?;
    let (_, free_thresh) = entries.threshold("free_thresh")?;
    if free_thresh > occupied_thresh {
        let what = format!("occupied_thresh {occupied_thresh} is less than free_thresh {free_thresh}");
        return entries.refuse(line, what, "give free_thresh <= occupied_thresh");
    }
    let entry = entries.need("negate")?;
    let word = entries.text("negate", entry)?;
    let negate = match word.to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "off" => false,
        "1" | "true" | "yes" | "on" => true,
        _ => return entries.refuse(entry.line, format!("negate is {}", quoted(word)), "give 0 or 1"),
    };
    let mode = match entries.get("mode") {
        None => Mode::Trinary,
        Some(entry) => match entries.text("mode", entry)? {
            "trinary" => Mode::Trinary,
            "scale" => Mode::Scale,
            word => {
                let remedy = "give trinary or scale; raw pixels have no agreed meaning for robots";
                return entries.refuse(entry.line, format!("mode is {}", quoted(word)), remedy);
            }
        },
    };
    let key = "impassability_classes";
    let classes = match entries.get(key) {
        None => None,
        Some(entry) => match entries.text(key, entry)? {
            word if matches!(word.parse(), Ok(1..=255_u8)) => word.parse().ok(),
            word => {
                let remedy = "give a whole number from 1 to 255";
                return entries.refuse(entry.line, format!("{key} is {}", quoted(word)), remedy);
            }
        },
    };
    let origin_m = entries.origin_m()?;
    Ok(Meta { image, resolution_m, origin_m, occupied_thresh, free_thresh, negate, mode, classes })
}

/// The keys of a map at the top of the first document.
fn collect<'a>(text: &str, path: &'a Path) -> Result<Entries<'a>, TerrainError> {
    let mut entries = Entries { path, found: Vec::new() };
    let mut events = Events { parser: Parser::new_from_str(text), path, last_line: text.lines().count().max(1) };
    loop {
        match events.next()? {
            (_, Event::MappingStart(..)) => break,
            (_, Event::StreamEnd | Event::DocumentEnd) => return Ok(entries),
            (line, Event::Scalar(..) | Event::SequenceStart(..) | Event::Alias(_)) => {
                let what = "the file is not a table of keys and values".to_owned();
                return entries.refuse(line, what, SHAPE);
            }
            _ => {}
        }
    }
    loop {
        let (line, key) = match events.next()? {
            (_, Event::MappingEnd) => return Ok(entries),
            (line, Event::Scalar(key, ..)) => (line, key.into_owned()),
            (line, event) => {
                events.value(line, event)?;
                (line, String::new())
            }
        };
        let (value_line, event) = events.next()?;
        let value = events.value(value_line, event)?;
        if key == "<<" {
            let what = "a merge (<<) is not read".to_owned();
            return entries.refuse(line, what, "write the keys and values themselves");
        }
        if !KEYS.contains(&key.as_str()) {
            continue;
        }
        if let Some(first) = entries.get(&key) {
            let what = format!("{key} is given twice, before at line {}", first.line);
            return entries.refuse(line, what, "keep one of them");
        }
        entries.found.push((key, Entry { line: value_line, value }));
    }
}

const SHAPE: &str = "each key stands at the top, followed by a colon, a space and its value";

struct Events<'a> {
    parser: Parser<'a, StrInput<'a>>,
    path: &'a Path,
    last_line: usize,
}

impl<'a> Events<'a> {
    /// The next event with its line.
    fn next(&mut self) -> Result<(usize, Event<'a>), TerrainError> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => Ok((span.start.line(), event)),
            Some(Err(error)) => {
                // Users do not know the parser's terms.
                let terms = [["flow sequence", "list in brackets"], ["block mapping", "list of keys"]];
                let what = terms.iter().fold(error.info().to_owned(), |what, [from, to]| what.replace(from, to));
                let what = format!("this is not YAML: {what}");
                let line = error.marker().line().min(self.last_line);
                Err(format_error(self.path, Place::Line(line), what, SHAPE))
            }
            None => Ok((1, Event::StreamEnd)),
        }
    }

    /// The value that begins with an event.
    fn value(&mut self, line: usize, event: Event<'a>) -> Result<Value, TerrainError> {
        let is_list = match event {
            Event::Scalar(text, ..) => return Ok(Value::Text(text.into_owned())),
            Event::Alias(_) => return Ok(Value::Alias),
            Event::SequenceStart(..) => true,
            _ => false,
        };
        let (mut depth, mut items) = (1, Some(Vec::new()));
        while depth > 0 {
            match self.next()? {
                (line, Event::Scalar(text, ..)) => {
                    items.iter_mut().for_each(|items| items.push((line, text.clone().into_owned())));
                }
                (_, Event::SequenceStart(..) | Event::MappingStart(..)) => (depth, items) = (depth + 1, None),
                (_, Event::SequenceEnd | Event::MappingEnd) => depth -= 1,
                (_, Event::StreamEnd) => {
                    let what = "the file ends inside this value".to_owned();
                    return Err(format_error(self.path, Place::Line(line), what, SHAPE));
                }
                _ => items = None,
            }
        }
        Ok(if is_list { Value::List(items) } else { Value::Table })
    }
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
        let text = FILE.replace("[-1, 2.5, 0.0]", "\n  - -1\n  - 2.5\n  - 0.0");
        let text = format!("---\r\n{text}mode: scale\nother:\n  deep: 1\n  x: [1]\nimpassability_classes: 12\n...\n");
        let meta = meta(&text).unwrap();
        assert_eq!(meta.origin_m, [-1.0, 2.5]);
        assert_eq!((meta.mode, meta.classes), (Mode::Scale, Some(12)));
    }

    #[test]
    fn all_ways_to_write_the_same_table_are_read_alike() {
        let expected = meta(FILE).unwrap();
        let flow = "{negate: 0, image: 'my #1 map.pgm', resolution: 1.0e-1,\n origin: [-1,\n 2.5, 0],\n \
                    occupied_thresh: 0.65, free_thresh: 0.196}";
        let indented: String = FILE.lines().map(|line| format!("  {line}\n")).collect();
        let ways = [
            flow.to_owned(),
            format!("---\n{flow}\n...\n"),
            format!("%YAML 1.1\n---\n{FILE}"),
            format!("%YAML 1.2\n# ROS\n---\n{FILE}...\n"),
            indented,
            FILE.replace('\n', "\r\n"),
            format!("\u{feff}{FILE}"),
            FILE.replace("[-1, 2.5, 0.0]", "[\n  -1,\n  2.5, # north\n  0.0]"),
            FILE.replace("[-1, 2.5, 0.0]", "[\n  -1,\n  2.5,\n  0.0,\n]"),
            FILE.replace("[-1, 2.5, 0.0]", "\n- -1\n- 2.5\n- 0.0"),
            FILE.replace("resolution: 0.1", "\"resolution\": \"0.1\""),
            FILE.replace("resolution: 0.1", "resolution:\n  0.1"),
            FILE.replace("resolution: 0.1", "resolution: !!float 0.1"),
            FILE.replace("negate: 0", "negate: false"),
            FILE.replace("\"my #1 map.pgm\" # named", ">-\n  my #1\n  map.pgm"),
            format!("{FILE}---\nimage: other.pgm\n"),
        ];
        for text in ways {
            assert_eq!(meta(&text).unwrap_or_else(|error| panic!("{text}\n{error}")), expected, "{text}");
        }
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases = [
            (FILE.replace("negate: 0\n", ""), "m.yaml: negate is missing; a map_server file has"),
            (FILE.replace("negate: 0", "negate: 2"), "m.yaml:7: negate is \"2\"; give 0 or 1"),
            (FILE.replace("0.1\n", "0\n"), "m.yaml:3: resolution is 0; give metres per pixel"),
            (FILE.replace("0.1\n", ".nan\n"), "m.yaml:3: resolution is \".nan\"; give a finite number"),
            (FILE.replace("2.5, 0.0", "2.5, 1.57"), "m.yaml:4: the origin is turned by 1.57 radians; rotated maps"),
            (FILE.replace("2.5, 0.0", "2.5"), "m.yaml:4: origin has 2 of three numbers; give origin"),
            (FILE.replace("0.196", "0.9"), "m.yaml:5: occupied_thresh 0.65 is less than free_thresh 0.9"),
            (format!("{FILE}mode: raw"), "m.yaml:8: mode is \"raw\"; give trinary or scale"),
            (format!("{FILE}negate: 1"), "m.yaml:8: negate is given twice, before at line 7"),
            (format!("{FILE}impassability_classes: 256"), "m.yaml:8: impassability_classes is \"256\""),
            (format!("{FILE}what is this"), "m.yaml:8: this is not YAML: "),
            (
                FILE.replace("0.65", "65").replace("0.196", "19.6"),
                "m.yaml:5: occupied_thresh is 65; give a probability",
            ),
            (FILE.replace("0.196", "19.6"), "m.yaml:6: free_thresh is 19.6; give a probability from 0 to 1"),
            (FILE.replace("0.65", "1.01"), "m.yaml:5: occupied_thresh is 1.01"),
            (FILE.replace("0.196", "-0.1"), "m.yaml:6: free_thresh is -0.1"),
            (FILE.replace("resolution: 0.1", "resolution:"), "m.yaml:3: resolution is empty; give its value"),
            (FILE.replace("0.1\n", "[0.1]\n"), "m.yaml:3: resolution is a list; give one value"),
            (FILE.replace("[-1, 2.5, 0.0]", "-1 2.5 0"), "m.yaml:4: origin is \"-1 2.5 0\"; give origin: [x, y"),
            (FILE.replace("[-1, 2.5, 0.0]", "[[-1, 2.5, 0.0]]"), "m.yaml:4: origin is not a list of numbers"),
            (FILE.replace("[-1, 2.5, 0.0]", "[-1, 2.5, 0.0"), "m.yaml:5: this is not YAML: illegal placement"),
            (FILE.replace("2.5", "2,5"), "m.yaml:4: origin has 4 of three numbers"),
            (format!("a: &a 0.1\n{}", FILE.replace("0.1\n", "*a\n")), "m.yaml:4: resolution is an alias"),
            (format!("{FILE}<<: {{x: 1}}"), "m.yaml:8: a merge (<<) is not read"),
            (format!("map:\n  {}", FILE.replace('\n', "\n  ")), "m.yaml: image is missing"),
            (FILE.replace("resolution: 0.1", "resolution:\t0.1\n\tmode: scale"), "m.yaml:"),
            ("- image\n".to_owned(), "m.yaml:1: the file is not a table"),
            ("just words".to_owned(), "m.yaml:1: the file is not a table"),
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

        #[test]
        fn any_punctuation_is_a_file_or_an_error(text in "[a:,?!&*<>|%@`{}\\[\\]\"'# \t\n.-]{0,40}") {
            let _ = meta(&text);
            let _ = meta(&format!("{FILE}{text}"));
        }
    }
}
