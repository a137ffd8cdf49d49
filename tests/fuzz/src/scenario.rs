//! Scenario files with wrong parts.

use arbitrary::{Result, Unstructured};
use staya_sim::scenario::{Overrides, Scenario};
use std::path::Path;

const FILES: [&str; 3] = [
    include_str!("../../../scenarios/mixed.toml"),
    include_str!("../../../scenarios/revoked.toml"),
    include_str!("../../../scenarios/two-formations.toml"),
];
const PARTS: [&str; 20] = [
    "",
    "-",
    "nan",
    "inf",
    "1e300",
    "70000",
    "true",
    "\"word\"",
    "[]",
    "[1, 2]",
    "{}",
    "{ kind = 1 }",
    "1979-05-27",
    "\n",
    "[plane]\n",
    "[[fault]]\n",
    "loss = 2\n",
    "law",
    "radius_m",
    "\u{e9}",
];
const TYPES: [&str; 11] = ["u8", "u16", "u32", "u64", "usize", "i16", "i32", "f32", "f64", "struct", "enum"];
/// Longer numbers describe worlds that take long to create.
const DIGITS: usize = 3;

/// A file with replaced words is read, or refused with file, line, column, cause and remedy.
pub fn scenario(bytes: &[u8]) {
    let mut choice = Unstructured::new(bytes);
    if let Ok(file) = choice.choose(&FILES)
        && let Ok(text) = mutated(file, &mut choice)
    {
        read(file, &text);
    }
}

fn mutated(file: &str, choice: &mut Unstructured<'_>) -> Result<String> {
    let mut text = file.to_owned();
    for _ in 0..choice.int_in_range(1..=4)? {
        let at = choice.choose_index(text.len() + 1)?;
        let part = if choice.ratio(7_u8, 8_u8)? { choice.choose(&PARTS)? } else { choice.arbitrary::<&str>()? };
        let Some((before, after)) = text.split_at_checked(at) else { continue };
        let from = at - before.chars().rev().take_while(|&c| is_word(c)).count();
        let to = at + after.chars().take_while(|&c| is_word(c)).count();
        text.replace_range(from..to, part);
    }
    Ok(text)
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn read(file: &str, text: &str) {
    let is_large = |word: &str| word.starts_with(|c: char| c.is_ascii_digit()) && word.len() > DIGITS;
    if text.split(|c| !is_word(c)).any(|word| is_large(word) && !PARTS.contains(&word) && !file.contains(word)) {
        return;
    }
    let Err(error) = Scenario::parse(text, Path::new("s.toml"), &Overrides::default()) else { return };
    let error = error.to_string();
    let (place, what) = error.split_once(": ").expect("a place");
    let numbers: Vec<_> =
        place.strip_prefix("s.toml:").expect("the file").split(':').map(str::parse::<usize>).collect();
    assert!(matches!(numbers[..], [Ok(1..), Ok(1..)]), "no line and column: {error}");
    assert!(what.contains("; ") && !what.contains('\n'), "no remedy, or several lines: {error}");
    let mut words = what.split(|c| !is_word(c));
    assert!(!words.any(|word| TYPES.contains(&word) && !text.contains(word)), "a Rust type: {error}");
}
