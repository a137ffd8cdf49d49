//! The documentation refers only to things that exist: paths, links and their headings, pages in
//! comments, and the code that README.md quotes.

use crate::law;
use crate::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Reads every Markdown file of the repository and the comments of its Rust code. The error counts
/// the faults, which are printed by file and line.
pub fn check(root: &Path) -> Result<()> {
    let pages = Pages::of(root)?;
    let mut faults = Vec::new();
    for file in &files::sources(root, &["md", "rs"])? {
        let shown = file.strip_prefix(root).unwrap_or(file).display();
        let found = pages.faults(file, &files::read(file)?);
        faults.extend(found.iter().map(|(line, fault)| format!("{shown}:{line}: {fault}")));
    }
    let examples = files::sources(&root.join("examples"), &["rs"])?;
    let examples = examples.iter().map(|file| files::read(file)).collect::<Result<Vec<_>, _>>()?;
    let readme = files::read(&root.join("README.md"))?;
    let quotes = quotes(&readme);
    let strange = quotes.iter().filter(|quote| !examples.iter().any(|example| is_in(quote, example)));
    faults.extend(strange.map(|quote| format!("README.md: in no file of examples/: {}", quote.join(" "))));
    none_of(&faults, "references lead nowhere")
}

/// The files and folders that texts can refer to.
struct Pages {
    /// Paths from the top of the repository down.
    paths: BTreeSet<PathBuf>,
}

impl Pages {
    fn of(root: &Path) -> Result<Self> {
        let files = files::below(root, &|path| !path.is_dir() || !files::is_made(path))?;
        let files = files.iter().filter_map(|file| file.strip_prefix(root).ok());
        // One page writes files into a copy.
        let law = law::Page::read(root)?;
        let paths = files.chain(law.paths()).flat_map(Path::ancestors).filter(|path| !path.as_os_str().is_empty());
        Ok(Self { paths: paths.map(Path::to_path_buf).collect() })
    }

    /// The faults of a file by line: in Markdown links and paths that lead nowhere and conflict
    /// markers, in comments of Rust code missing pages such as `docs/python.md`.
    fn faults(&self, file: &Path, text: &str) -> Vec<(usize, String)> {
        let mut faults = Vec::new();
        let is_code = files::has_extension(file, &["rs"]);
        for (number, line) in
            (1..).zip(text.lines()).filter(|(_, line)| !is_code || line.trim_start().starts_with("//"))
        {
            let mut missing: Vec<&str> = if is_code {
                words(line).filter(|word| word.ends_with(".md") && word.contains('/')).collect()
            } else {
                let links = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
                let broken = links.filter(|link| !link.contains("://") && !leads_somewhere(file, link));
                faults.extend(broken.map(|link| (number, format!("the link {link} leads nowhere"))));
                let is_mark = line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ");
                faults.extend(is_mark.then(|| (number, String::from("a merge has left this mark"))));
                self.paths_in(line)
            };
            missing.retain(|path| !self.paths.iter().any(|known| known.ends_with(path)));
            faults.extend(missing.iter().map(|path| (number, format!("{path} does not exist"))));
        }
        faults
    }

    /// Words that begin with a top folder, and in backticks code and folders of any place.
    fn paths_in<'t>(&self, line: &'t str) -> Vec<&'t str> {
        let spans: Vec<&str> = line.split('`').skip(1).step_by(2).collect();
        let is_path = |word: &&str| {
            let is_below = word.split_once('/').is_some_and(|(top, _)| self.paths.contains(Path::new(top)));
            let is_named = word.ends_with(".rs") || word.ends_with('/') && *word != "/";
            (is_below || is_named && spans.contains(word)) && !word.split('/').any(is_placeholder)
        };
        words(line).filter(is_path).collect()
    }
}

/// Whether the target of a link in a file exists, with its heading.
fn leads_somewhere(file: &Path, link: &str) -> bool {
    let (path, heading) = link.split_once('#').unwrap_or((link, ""));
    let page = if path.is_empty() { file.to_path_buf() } else { file.with_file_name(path) };
    heading.is_empty() && page.exists()
        || files::read(&page).is_ok_and(|text| anchors(&text).iter().any(|anchor| anchor == heading))
}

/// Whether a part of a path stands for others, as in `scenarios/NAME.toml` or `scenarios/*.toml`.
fn is_placeholder(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default();
    part.contains('*') || !stem.is_empty() && stem != "README" && stem.chars().all(|c| c.is_uppercase() || c == '_')
}

/// The words of a line, which may be paths.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|c: char| !(c.is_alphanumeric() || "_-./*".contains(c)));
    words.map(|word| word.trim_end_matches('.'))
}

/// The lines of a page outside blocks of code, with their numbers.
pub fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// The names of a page's headings in links, by GitHub's rules: repeated headings are numbered.
fn anchors(text: &str) -> Vec<String> {
    let mut seen = BTreeMap::new();
    let numbered = prose(text).filter_map(|(_, line)| anchor(line)).map(|name| {
        let count: &mut usize = seen.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name}-{}", *count - 1) }
    });
    numbered.collect()
}

/// The name of a heading in links; `None` for other lines.
fn anchor(line: &str) -> Option<String> {
    let heading = line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with('#'))?;
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    Some(kept.collect::<String>().to_lowercase().replace(' ', "-"))
}

/// The blocks of Rust, as lines without indentation.
fn quotes(text: &str) -> Vec<Vec<&str>> {
    let blocks = text.split("\n```rust\n").skip(1);
    blocks.filter_map(|rest| rest.split("\n```").next()).map(|block| block.lines().map(str::trim).collect()).collect()
}

/// Whether these lines follow each other in the text, however indented.
fn is_in(quote: &[&str], text: &str) -> bool {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    lines.windows(quote.len().max(1)).any(|window| window == quote)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repo::Repo;

    fn missing(line: &str) -> Vec<String> {
        let root = Repo::find().root;
        let pages = Pages::of(&root).expect("the repository");
        let faults =
            ["xtask/README.md", "xtask/src/x.rs"].into_iter().flat_map(|file| pages.faults(&root.join(file), line));
        faults.map(|(_, fault)| fault).collect()
    }

    #[test]
    fn existing_names_are_accepted() {
        for line in [
            "//! See docs/limits.md and `PROTOCOL.md`.",
            "see `xtask/src/main.rs` (all), `modules.rs`, `size/`, and `src/main.rs`",
            "`xtask/src/size/` beside `modules.rs`; `trace.csv`, `m/s`, `target/firmware/PART/BIN` are not ours",
            "`scenarios/NAME.toml`, `scenarios/bridge-*.toml`, [a page](../README.md), [a part](../ARCHITECTURE.md#one-tick), [far](https://a.b/c)",
        ] {
            assert_eq!(missing(line), [""; 0], "{line}");
        }
    }

    #[test]
    fn missing_names_are_reported() {
        assert_eq!(missing("<<<<<<< HEAD"), ["a merge has left this mark"]);
        for (line, path) in [
            ("cargo run -- run scenarios/nowhere.toml.", "scenarios/nowhere.toml"),
            ("`xtask/src/main.rs` and `nowhere.rs`", "nowhere.rs"),
            ("`nowhere/`", "nowhere/"),
            ("/// See nowhere/page.md.", "nowhere/page.md"),
        ] {
            assert_eq!(missing(line), [format!("{path} does not exist")]);
        }
        for link in ["../nowhere.md", "../ARCHITECTURE.md#nowhere", "#nowhere"] {
            assert_eq!(missing(&format!("[x]({link})")), [format!("the link {link} leads nowhere")]);
        }
    }

    #[test]
    fn quotes_are_found_however_indented() {
        let quotes = quotes("text\n```rust\nlet a = 1;\nif a {\n}\n```\nmore");
        assert_eq!(quotes, [["let a = 1;", "if a {", "}"]]);
        assert!(is_in(&quotes[0], "fn main() {\n    let a = 1;\n    if a {\n    }\n}"));
        assert!(!is_in(&quotes[0], "let a = 1;\nlet b = 2;\nif a {\n}"));
    }

    #[test]
    fn headings_are_named_as_on_github() {
        let page = "# `a_b`: c (d), E\n```sh\n# code\n```\n## Same\n## Same\n#define\n";
        assert_eq!(anchors(page), ["a_b-c-d-e", "same", "same-1"]);
    }
}
