//! A row of a table, for C.

use crate::memory::plain;
use core::ffi::c_char;
use staya_controller::parameters::{LONGEST_DESCRIPTION, Parameter};

const _: () = assert!(LONGEST_DESCRIPTION < 64);

/// A parameter of a running robot, or a row of a setup's law or layer. Texts end with a zero.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaParameter {
    /// The name, such as "speed_mps".
    pub name: [c_char; 20],
    /// The unit; empty for a plain number.
    pub unit: [c_char; 20],
    /// A description in a few words.
    pub text: [c_char; 64],
    /// If the row is a choice: the words for 0, 1, ..., separated by blanks.
    pub words: [c_char; 64],
    /// The least value.
    pub least: f32,
    /// The greatest value.
    pub greatest: f32,
    /// The present value.
    pub value: f32,
}

plain!(StayaParameter);

impl StayaParameter {
    pub(crate) fn new(row: &Parameter, value: f32) -> Self {
        let [least, greatest] = row.range;
        let words = text(row.words.iter().flat_map(|word| [" ", *word]).skip(1));
        Self { name: text([row.name]), unit: text([row.unit]), text: text([row.what]), words, least, greatest, value }
    }
}

/// Consecutive texts, as many letters as fit before a zero.
pub(crate) fn text<'a, const N: usize>(pieces: impl IntoIterator<Item = &'a str>) -> [c_char; N] {
    let mut letters = [0; N];
    for (letter, byte) in letters.iter_mut().take(N - 1).zip(pieces.into_iter().flat_map(str::bytes)) {
        *letter = byte as c_char;
    }
    letters
}
