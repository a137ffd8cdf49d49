//! Text for terminals: control characters of file names and file contents are shown, not obeyed.
//!
//! A file may be called anything, and a scenario may come from anywhere. With an escape sequence in
//! a name, a message could move the cursor, change its own text, or set the title of the window.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

/// Paths in messages.
pub trait Shown {
    /// Displays the path on one line: every control character is escaped, line feeds too.
    fn shown(&self) -> impl fmt::Display + '_;
}

impl Shown for Path {
    fn shown(&self) -> impl fmt::Display + '_ {
        // Also replaces bytes that are not UTF-8.
        escaped(self.to_string_lossy(), |_| false)
    }
}

/// A text of one line, for messages that quote files: every control character is escaped.
#[must_use]
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(Cow::Borrowed(text), |_| false)
}

/// The text for a terminal: control characters are escaped as in Rust, except line feeds and tabs,
/// which lay out messages of several lines.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(Cow::Borrowed(text), |letter| matches!(letter, '\n' | '\t'))
}

fn escaped(text: Cow<'_, str>, is_kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_harmful = |letter: char| is_obeyed(letter) && !is_kept(letter);
    if !text.contains(is_harmful) {
        return text;
    }
    let mut safe = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        if is_harmful(letter) {
            safe.extend(letter.escape_default());
        } else {
            safe.push(letter);
        }
    }
    Cow::Owned(safe)
}

/// Control characters, and those that reorder the text around them or begin a line.
fn is_obeyed(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn control_characters_are_escaped_and_own_lines_stay() {
        assert_eq!(printable("a: b\n  c\td\u{e9}"), "a: b\n  c\td\u{e9}");
        assert_eq!(printable("\u{1b}[2Ja\r\u{7f}\u{9b}0m"), "\\u{1b}[2Ja\\r\\u{7f}\\u{9b}0m");
        assert_eq!(printable("\u{202e}txt.exe"), "\\u{202e}txt.exe");
    }

    #[test]
    fn paths_are_on_one_line() {
        assert_eq!(Path::new("a/b\u{e9} c.toml").shown().to_string(), "a/b\u{e9} c.toml");
        assert_eq!(Path::new("a\nstaya: fine\t\u{1b}c").shown().to_string(), "a\\nstaya: fine\\t\\u{1b}c");
    }

    proptest! {
        #[test]
        fn no_text_has_a_character_that_a_terminal_obeys(text in any::<String>()) {
            prop_assert!(!printable(&text).contains(|c: char| c.is_control() && c != '\n' && c != '\t'));
            prop_assert!(!Path::new(&text).shown().to_string().contains(char::is_control));
        }
    }
}
