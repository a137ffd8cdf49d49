//! Counts the phrases that break the project's language rules, and lines that are too long.

use crate::documents::prose;
use crate::prelude::*;
use regex::{Regex, RegexBuilder};

/// The most phrases that may break a rule.
const BROKEN: usize = 26;
/// The most lines of comments and pages that exceed [`COLUMNS`].
const LONG_LINES: usize = 0;
const COLUMNS: usize = 100;

const EXTENSIONS: [&str; 12] = ["rs", "md", "py", "pyi", "toml", "js", "html", "h", "c", "sh", "x", "ipynb"];

/// The phrases that break a rule.
const PHRASES: &str = include_str!("../language.txt");

/// The rules of [`PHRASES`]: their names, phrases and exceptions.
struct Rules {
    phrases: Vec<(&'static str, Regex, Regex)>,
    /// Where a word begins inside a name in camel case.
    hump: Regex,
}

/// Prints each finding by file and line, and the counts beside their limits. The error names the
/// counts above their limit.
pub fn check(root: &Path) -> Result<()> {
    let rules = Rules::new();
    let (mut broken, mut long_lines, mut comments) = (0, 0, 0);
    for file in files::sources(root, &EXTENSIONS)? {
        let text = files::read(&file)?;
        let shown = file.strip_prefix(root).unwrap_or(&file).display();
        for (line, number) in text.lines().zip(1..) {
            for rule in rules.broken(line) {
                broken += 1;
                println!("{shown}:{number}: [{rule}] {}", line.trim());
            }
        }
        let mut limited: Vec<(usize, &str)> = Vec::new();
        if files::has_extension(&file, &["md"]) {
            limited.extend(by_hand(&text));
        } else if files::has_extension(&file, &["rs"]) {
            limited.extend((1..).zip(text.lines()).filter(|(_, line)| line.trim_start().starts_with("//")));
            comments += limited.len();
        }
        for (number, line) in limited.into_iter().filter(|(_, line)| is_long(line)) {
            long_lines += 1;
            println!("{shown}:{number}: [columns] {}", line.trim());
        }
    }
    println!("{comments} lines of comments");
    let counts = [
        (broken, BROKEN, "phrases against the rules"),
        (long_lines, LONG_LINES, "lines of comments and pages that are too long"),
    ];
    let shown = counts.map(|(count, limit, what)| (count > limit, format!("{count} {what}, at most {limit}")));
    shown.iter().for_each(|(_, line)| println!("{line}"));
    let faults: Vec<String> = shown.into_iter().filter_map(|(is_fault, line)| is_fault.then_some(line)).collect();
    ensure!(faults.is_empty(), "{}", faults.join("; "));
    Ok(())
}

/// The lines of a page outside blocks of code and rows of tables that a command prints.
fn by_hand(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_printed = false;
    prose(text).filter(move |(_, line)| {
        is_printed = (is_printed || line.ends_with(": written by cargo xtask bless -->")) && *line != "<!-- end -->";
        !(is_printed && line.starts_with('|'))
    })
}

/// Whether a line can and should be wrapped: a path or an address cannot.
fn is_long(line: &str) -> bool {
    line.chars().count() > COLUMNS && line.trim_start_matches(['/', '!', ' ']).trim_end().contains(' ')
}

impl Rules {
    fn new() -> Self {
        let regex = |text: &str| RegexBuilder::new(text).case_insensitive(true).build().expect("xtask/language.txt");
        let lines = PHRASES.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(": "));
        let phrases = lines.map(|(rule, phrase)| {
            let (phrase, exception) = phrase.split_once(" !! ").unwrap_or((phrase, "$^"));
            (rule, regex(phrase), regex(exception))
        });
        Self { phrases: phrases.collect(), hump: Regex::new(r"(\p{Ll})(\p{Lu})").expect("sound") }
    }

    /// The rule of each phrase in the line that breaks one. `NoRoute` is two words, `no_route` is
    /// one.
    fn broken(&self, line: &str) -> Vec<&'static str> {
        let line = self.hump.replace_all(line, "$1 $2");
        let found = self.phrases.iter().flat_map(|(rule, phrase, exception)| {
            let breaks = phrase.find_iter(&line).filter(|found| !exception.is_match(&line[found.start()..]));
            breaks.map(|_| *rule)
        });
        found.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rules that a sentence breaks. A `+` in it keeps this file itself from being counted.
    fn broken(sentence: &str) -> Vec<&'static str> {
        Rules::new().broken(&sentence.replace('+', ""))
    }

    #[test]
    fn rows_of_printed_tables_are_not_written_by_hand() {
        let page = "| a |\n<!-- x: written by cargo xtask bless -->\n| b |\nc\n<!-- end -->\n| d |\n";
        let lines: Vec<_> = by_hand(page).map(|(number, _)| number).collect();
        assert_eq!(lines, [1, 2, 4, 5, 6]);
    }

    #[test]
    fn each_rule_has_a_sentence_that_breaks_it() {
        for (sentence, rule) in [
            ("/// Wh+o stands gives way.", "head"),
            ("a list of wh+om it hears", "head"),
            ("by wh+at is known", "head"),
            ("Nobo+dy moves.", "people"),
            ("Event::Nobo+dyHeard", "people"),
            ("A robot keeps hi+s place.", "people"),
            ("No+ one knows on+e's place.", "people"),
            ("This is n+o wall.", "is no"),
            ("The run goe+s on.", "words"),
            ("It is t+o the bit equal.", "words"),
            ("The price was tol+d.", "words"),
            ("The field is ne+w.", "history"),
        ] {
            assert!(broken(sentence).contains(&rule), "{sentence}");
        }
    }

    #[test]
    fn plain_sentences_break_no_rule() {
        for sentence in [
            "A stationary robot gives way. What kind is it? What is a beacon?",
            "Robots that it hears, and whether the others are known: `what`.",
            "No robot moves; the robot keeps its place.",
            "There is no wall, and 3 is no less than 2; it is not a wall.",
            "The run continues. It goes on the list, the same in all bits.",
            "The new field has a default; robots are told apart.",
        ] {
            assert_eq!(broken(sentence), [""; 0], "{sentence}");
        }
    }

    #[test]
    fn addresses_and_lines_of_100_columns_are_not_long() {
        let line = |columns: usize| format!("/// a {}", "b".repeat(columns - 6));
        assert!(!is_long(&line(COLUMNS)) && is_long(&line(COLUMNS + 1)));
        assert!(!is_long(&format!("    // https://{}", line(COLUMNS).replace(' ', "/"))));
    }
}
