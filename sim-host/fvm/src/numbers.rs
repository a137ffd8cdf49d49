//! Numbers with commas in options.

use anyhow::{Result, anyhow};

pub fn numbers(text: &str) -> Result<Vec<f64>> {
    let number = |word: &str| {
        let word = word.trim();
        word.parse().map_err(|_| anyhow!("`{word}` is not a number; give numbers with commas, such as 1.5,-2"))
    };
    text.split(',').map(number).collect()
}

pub fn fixed<const V: usize>(text: &str) -> Result<[f64; V]> {
    let found = numbers(text)?.try_into();
    found.map_err(|_| anyhow!("`{text}`: give {V} numbers with commas, such as 1.5,-2"))
}
