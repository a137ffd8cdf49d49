//! Helpers of the text formats: numbered lines, and number parsers with errors.

use super::error::{MAX_SIDE, Place, TerrainError, format_error};
use std::path::Path;

/// Decodes UTF-8 without a byte order mark; an error names the line.
pub(super) fn text<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str, TerrainError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        format_error(
            path,
            Place::Line(line),
            "bytes that are not text",
            "this format is plain UTF-8 or ASCII text: is it another kind of file, or damaged?",
        )
    })
}

pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(at, line)| (at + 1, line.trim_end_matches('\r')))
}

pub(super) fn integer<T: std::str::FromStr>(
    path: &Path,
    line: usize,
    field: &str,
    word: &str,
) -> Result<T, TerrainError> {
    word.parse().map_err(|_| {
        format_error(path, Place::Line(line), format!("{field} is {word:?}"), "give a whole number in range")
    })
}

pub(super) fn side(path: &Path, line: usize, field: &str, word: &str) -> Result<u16, TerrainError> {
    match word.parse() {
        Ok(side @ 1..=MAX_SIDE) => Ok(side),
        _ => Err(format_error(
            path,
            Place::Line(line),
            format!("{field} is {word:?}"),
            format!("give a whole number from 1 to {MAX_SIDE}"),
        )),
    }
}

pub(super) fn finite(path: &Path, line: usize, field: &str, word: &str) -> Result<f64, TerrainError> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format_error(path, Place::Line(line), format!("{field} is {word:?}"), "give a finite number")),
    }
}

/// `word` in quotes for a message, shortened if it is long.
pub(super) fn quoted(word: &str) -> String {
    let mut short: String = word.chars().take(24).collect();
    if short.len() < word.len() {
        short.push_str("...");
    }
    format!("{short:?}")
}
