use std::fmt::Display;

/// Escapes control characters and other invisible ones in a text from outside, which could change
/// the terminal.
pub fn printable(text: impl Display) -> String {
    let mut printable = String::new();
    for letter in text.to_string().chars() {
        match letter {
            '"' | '\'' => printable.push(letter),
            _ => printable.extend(letter.escape_debug()),
        }
    }
    printable
}
