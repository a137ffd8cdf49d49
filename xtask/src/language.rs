//! Counts the phrases that break the project's language rules, lines that are too long, and the
//! words of pages.

use crate::documents::prose;
use crate::files;
use std::collections::HashMap;
use std::path::Path;

/// The most phrases that may break a rule.
const BROKEN: usize = 40;
/// The most lines of comments and pages that exceed [`COLUMNS`].
const LONG_LINES: usize = 0;
/// The most words in all pages.
const WORDS: usize = 30_000;
const COLUMNS: usize = 100;

const EXTENSIONS: [&str; 12] = ["rs", "md", "py", "pyi", "toml", "js", "html", "h", "c", "sh", "x", "ipynb"];

/// The phrases that break a rule.
const PHRASES: &str = include_str!("../language.txt");

/// Rules and the rest of their phrases, by the first word in a phrase.
type Rules<'a> = HashMap<&'a str, Vec<(&'a str, &'a str)>>;

/// Prints each finding by file and line, and the counts beside their limits. The error names the
/// counts above their limit.
pub fn check(root: &Path) -> Result<(), String> {
    let rules = rules();
    let (mut broken, mut long_lines, mut words, mut comments) = (0, 0, 0, 0);
    for file in files::sources(root, &EXTENSIONS)? {
        let text = files::read(&file)?;
        let shown = file.strip_prefix(root).unwrap_or(&file).display();
        for (line, number) in text.lines().zip(1..) {
            for rule in broken_rules(&rules, line) {
                broken += 1;
                println!("{shown}:{number}: [{rule}] {}", line.trim());
            }
        }
        let mut limited: Vec<(usize, &str)> = Vec::new();
        if files::has_extension(&file, &["md"]) {
            words += text.split_whitespace().count();
            limited.extend(prose(&text));
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
        (words, WORDS, "words in pages"),
    ];
    let shown = counts.map(|(count, limit, what)| (count > limit, format!("{count} {what}, at most {limit}")));
    shown.iter().for_each(|(_, line)| println!("{line}"));
    let faults: Vec<String> = shown.into_iter().filter_map(|(is_fault, line)| is_fault.then_some(line)).collect();
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ")) }
}

/// Whether a line can and should be wrapped: a path or an address cannot.
fn is_long(line: &str) -> bool {
    line.chars().count() > COLUMNS && line.trim_start_matches(['/', '!', ' ']).trim_end().contains(' ')
}

/// The rules of [`PHRASES`].
fn rules() -> Rules<'static> {
    let mut rules = Rules::new();
    for (rule, phrase) in PHRASES.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(": "))
    {
        let (first, rest) = phrase.split_once(' ').unwrap_or((phrase, ""));
        first.split('|').for_each(|word| rules.entry(word).or_default().push((rule, rest)));
    }
    rules
}

/// The rule of each phrase in the line that breaks one.
fn broken_rules<'a>(rules: &Rules<'a>, line: &str) -> Vec<&'a str> {
    let tokens = tokens(line);
    let mut broken = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let small = token.to_lowercase();
        let any_case = rules.get(small.as_str()).filter(|_| small != *token);
        let phrases = rules.get(token).into_iter().chain(any_case).flatten();
        broken.extend(phrases.filter(|(_, rest)| follows(&tokens, at, rest)).map(|(rule, _)| *rule));
    }
    broken
}

/// Whether the rest of a phrase follows the token `first`.
fn follows(tokens: &[&str], first: usize, rest: &str) -> bool {
    let mut next = first + 1;
    let is_in = |list: &str, token: &&str| list.split('|').any(|word| word.eq_ignore_ascii_case(token));
    rest.split_whitespace().all(|slot| match slot.split_at(1) {
        ("!", list) => !tokens.get(next).is_some_and(|token| is_in(list, token)),
        ("^", list) => !tokens[..first].last().is_some_and(|token| is_in(list, token)),
        ("~", list) => !tokens[next..].iter().any(|token| is_in(list, token)),
        _ => {
            next += 1;
            let fits =
                |token: &&str| if slot == "*" { token.starts_with(char::is_lowercase) } else { is_in(slot, token) };
            tokens.get(next - 1).is_some_and(fits)
        }
    })
}

/// The words and marks of a line. `NoRoute` is two words, `no_route` is one.
fn tokens(line: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let pairs = line.char_indices().zip(std::iter::once(' ').chain(line.chars()));
    let starts = pairs
        .filter(|((_, c), before)| !(is_word(*c) && is_word(*before)) || before.is_lowercase() && c.is_uppercase());
    let cuts: Vec<usize> = starts.map(|((at, _), _)| at).chain([line.len()]).collect();
    cuts.windows(2).map(|cut| line[cut[0]..cut[1]].trim()).filter(|token| !token.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rules that a sentence breaks. A `+` in it keeps this file itself from being counted.
    fn broken(sentence: &str) -> Vec<&'static str> {
        broken_rules(&rules(), &sentence.replace('+', ""))
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
