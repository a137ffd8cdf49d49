//! Scenario files with one wrong value or key. Reading one never panics, and every refusal names
//! file, line, column and remedy without a Rust type.

use super::*;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const VALUES: [&str; 11] = [
    "\"word\"",
    "-1",
    "70000",
    "1e300",
    "nan",
    "true",
    "[]",
    "[1, 2, 3, 4, 5]",
    "[{ x = 1 }]",
    "{ kind = 1 }",
    "1979-05-27",
];

const TYPES: [&str; 18] = [
    "u8",
    "u16",
    "u32",
    "u64",
    "usize",
    "i16",
    "i32",
    "i64",
    "f32",
    "f64",
    "bool",
    "struct",
    "enum",
    "tuple",
    "sequence",
    "map,",
    "identifier",
    "variant",
];

/// The spans of all keys and all values.
fn spans(table: &DeTable<'_>, keys: &mut Vec<Range<usize>>, values: &mut Vec<Range<usize>>) {
    for (key, value) in table {
        keys.push(key.span());
        span(value, keys, values);
    }
}

fn span(value: &Spanned<DeValue<'_>>, keys: &mut Vec<Range<usize>>, values: &mut Vec<Range<usize>>) {
    match value.get_ref() {
        DeValue::Table(table) => spans(table, keys, values),
        DeValue::Array(list) => list.iter().for_each(|element| span(element, keys, values)),
        _ => values.push(value.span()),
    }
}

fn files() -> Vec<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let entries = fs::read_dir(folder).expect("the scenarios").map(|entry| entry.expect("a file").path());
    // A scenario of many robots or of much land takes too long to be read a hundred times.
    let is_small = |path: &Path| {
        let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        !["million", "scale", "scale-plane", "scale-small", "scale-plane-small", "moving-ai-20"].contains(&name)
    };
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "toml") && is_small(path)).collect();
    files.sort();
    files
}

fn check(text: &str, path: &Path) -> bool {
    let Err(error) = Scenario::parse(text, path, &Overrides::default()) else { return false };
    let error = error.to_string();
    let rest = error.strip_prefix(&format!("{}:", path.display())).unwrap_or_else(|| panic!("no file: {error}"));
    let (place, what) = rest.split_once(": ").unwrap_or_else(|| panic!("no place: {error}"));
    let numbers: Vec<_> = place.split(':').map(str::parse::<usize>).collect();
    assert!(matches!(numbers[..], [Ok(1..), Ok(1..)]), "no line and column: {error}");
    assert!(what.contains("; "), "no remedy: {error}");
    let mut words = what.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == ','));
    assert!(!words.any(|word| TYPES.contains(&word)), "a Rust type: {error}");
    true
}

#[test]
fn a_wrong_value_or_key_is_refused_with_its_place() {
    let (mut refused, mut turn) = (0, 0);
    for path in files() {
        let text = fs::read_to_string(&path).expect("a scenario");
        let table = DeTable::parse(&text).expect("TOML");
        let (mut keys, mut values) = (Vec::new(), Vec::new());
        spans(table.get_ref(), &mut keys, &mut values);
        for key in keys {
            let mut text = text.clone();
            text.insert(key.end, 'x');
            refused += usize::from(check(&text, &path));
        }
        for value in values {
            for _ in 0..2 {
                let mut text = text.clone();
                text.replace_range(value.clone(), VALUES[turn % VALUES.len()]);
                refused += usize::from(check(&text, &path));
                turn += 1;
            }
        }
    }
    assert!(refused > 1500, "only {refused} were refused");
}

#[test]
fn written_fields_are_read_back() {
    let odd = "\"a b\" = '\"\\'\nc = \"\\u007f\\n\\u00e9\"\nd = [inf, -0.5, 0x1F, 1979-05-27]\n[[e]]\nf.g = 1\n[[e]]\n[h]\ni = [{}]\n";
    let texts = files().into_iter().map(|path| fs::read_to_string(path).expect("a scenario"));
    for text in texts.chain([odd.to_owned()]) {
        let source = Source::new(Path::new("t.toml"), &text).expect("TOML");
        let written = source.written();
        let again = Source::new(Path::new("t.toml"), &written).unwrap_or_else(|error| panic!("{error} in {written}"));
        assert_eq!(again.json(), source.json(), "{written}");
        assert_eq!(again.written(), written);
    }
}
