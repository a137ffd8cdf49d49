//! Damages files, and finds words that an error message must not contain.

use staya_controller::rand::Rng;

/// A file with one change that depends on `seed` and `number`: flipped bits, a cut or doubled part,
/// a part of another place, or, in a text, a deleted, doubled or changed line or a huge number.
#[must_use]
pub fn mutant(bytes: &[u8], seed: u32, number: u32) -> Vec<u8> {
    let mut rng = Rng::keyed(1, seed, number, 0);
    match std::str::from_utf8(bytes) {
        Ok(text) if rng.below(4) > 0 => of_text(text, &mut rng),
        _ => of_bytes(bytes, &mut rng),
    }
}

fn of_bytes(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut place = |bytes: &[u8]| rng.below(bytes.len().max(1) as u32) as usize;
    let (one, two) = (place(&bytes), place(&bytes));
    let (from, to) = (one.min(two), one.max(two));
    match place(&[0; 5]) {
        0 => bytes.truncate(one),
        1 => drop(bytes.drain(from..to)),
        2 => bytes.extend_from_within(from..to),
        3 if one < bytes.len() => bytes[one] = place(&[0; 256]) as u8,
        _ => {
            for _ in 0..=place(&[0; 3]) {
                let at = place(&bytes);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << place(&[0; 8]);
                }
            }
        }
    }
    bytes
}

fn of_text(text: &str, rng: &mut Rng) -> Vec<u8> {
    let lines: Vec<&str> = text.lines().collect();
    let mut below = |limit: usize| rng.below(limit.max(1) as u32) as usize;
    let (one, two) = (below(lines.len()), below(lines.len()));
    let (Some(first), Some(second)) = (lines.get(one), lines.get(two)) else {
        return text.into();
    };
    let with = |new: &[&str]| [&lines[..one], new, &lines[one + 1..]].concat().join("\n").into_bytes();
    match below(4) {
        0 => with(&[]),
        1 => with(&[second, first]),
        2 => match (first.split_once('='), second.split_once('=')) {
            (Some((name, _)), Some((_, value))) => with(&[&format!("{name}={value}")]),
            _ => with(&[second]),
        },
        _ => {
            let digits: Vec<usize> = first.match_indices(|c: char| c.is_ascii_digit()).map(|(at, _)| at).collect();
            let Some(&at) = digits.get(below(digits.len())) else {
                return with(&["x = 1"]);
            };
            let more = ["e9", "e300", "e-9", "0000000000", "00000000000000000000", "-"][below(6)];
            with(&[&format!("{}{more}{}", &first[..=at], &first[at + 1..])])
        }
    }
}

/// The first word of a message that names a type of the program.
#[must_use]
pub fn type_name(message: &str) -> Option<&str> {
    const NAMES: [&str; 20] = [
        "u8",
        "u16",
        "u32",
        "u64",
        "i8",
        "i16",
        "i32",
        "i64",
        "f32",
        "f64",
        "usize",
        "struct",
        "enum",
        "tuple",
        "variant",
        "identifier",
        "visitor",
        "newtype",
        "Option",
        "sequence",
    ];
    let is_camel_case = |word: &str| {
        let mut parts = word.as_bytes().windows(3);
        parts.any(|part| part[0].is_ascii_lowercase() && part[1].is_ascii_uppercase() && part[2].is_ascii_lowercase())
    };
    let mut words = message.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    words.find(|word| NAMES.contains(word) || is_camel_case(word) && *word != "ImageMagick")
}
