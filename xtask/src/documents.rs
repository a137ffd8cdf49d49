//! The documentation refers only to things that exist: paths, links and their headings, pages in
//! comments, and the code that README.md quotes.

use crate::files;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads every Markdown file of the repository and the comments of its Rust code. The error counts
/// the faults, which are printed by file and line.
pub fn check(root: &Path) -> Result<(), String> {
    let folders = folders(root)?;
    let mut faults = Vec::new();
    for file in &files::sources(root, &["md", "rs"])? {
        let text = files::read(file)?;
        let document = Document { root, file, folders: &folders };
        let found =
            if files::has_extension(file, &["md"]) { document.faults(&text) } else { document.missing_pages(&text) };
        let shown = file.strip_prefix(root).unwrap_or(file).display();
        faults.extend(found.iter().map(|(line, fault)| format!("{shown}:{line}: {fault}")));
    }
    let examples = files::sources(&root.join("examples"), &["rs"])?;
    let examples = examples.iter().map(|file| files::read(file)).collect::<Result<Vec<_>, _>>()?;
    let readme = files::read(&root.join("README.md"))?;
    let quotes = quotes(&readme);
    let strange = quotes.iter().filter(|quote| !examples.iter().any(|example| is_in(quote, example)));
    faults.extend(strange.map(|quote| format!("README.md: in no file of examples/: {}", quote.join(" "))));
    for fault in &faults {
        println!("{fault}");
    }
    if faults.is_empty() { Ok(()) } else { Err(format!("{} references lead nowhere", faults.len())) }
}

/// A Markdown file, and the folders that it may refer to.
struct Document<'a> {
    root: &'a Path,
    file: &'a Path,
    /// The repository's top folders.
    folders: &'a [String],
}

impl Document<'_> {
    /// The references to missing things and the conflict markers, each with its line.
    fn faults(&self, text: &str) -> Vec<(usize, String)> {
        let faults = text.lines().zip(1..).flat_map(|(line, number)| {
            let links = self.broken_links(line).into_iter().map(|link| format!("the link {link} leads nowhere"));
            let paths = self.missing_paths(line).into_iter().map(|path| format!("{path} does not exist"));
            let is_mark = ["<<<<<<< ", ">>>>>>> "].iter().any(|mark| line.starts_with(mark));
            let mark = is_mark.then(|| String::from("a merge has left this mark"));
            links.chain(paths).chain(mark).map(move |fault| (number, fault)).collect::<Vec<_>>()
        });
        faults.collect()
    }

    /// The missing pages, such as `docs/python.md`, that comments of Rust code name.
    fn missing_pages(&self, text: &str) -> Vec<(usize, String)> {
        let comments = text.lines().zip(1..).filter(|(line, _)| line.trim_start().starts_with("//"));
        let names = comments.flat_map(|(line, number)| words(line).map(move |word| (number, word)));
        let pages = names.filter(|(_, name)| name.ends_with(".md") && name.contains('/'));
        let missing = pages.filter(|(_, page)| !self.file.ancestors().any(|folder| folder.join(page).exists()));
        missing.map(|(line, page)| (line, format!("{page} does not exist"))).collect()
    }

    fn broken_links<'t>(&self, line: &'t str) -> Vec<&'t str> {
        let targets = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        targets.filter(|target| !target.contains("://") && !self.leads_somewhere(target)).collect()
    }

    fn leads_somewhere(&self, target: &str) -> bool {
        let (path, heading) = target.split_once('#').unwrap_or((target, ""));
        let file = match path {
            "" => self.file.to_path_buf(),
            path => self.here().join(path),
        };
        heading.is_empty() && file.exists()
            || files::read(&file).is_ok_and(|text| anchors(&text).iter().any(|anchor| anchor == heading))
    }

    /// Words that begin with a top folder, and in backticks files and folders beside, below or
    /// above the last of those in the same line, or in the document's own folder.
    fn missing_paths<'t>(&self, line: &'t str) -> Vec<&'t str> {
        let mut missing = Vec::new();
        let mut near = vec![self.here().join("src"), self.here()];
        for (span, is_code) in line.split('`').zip([false, true].into_iter().cycle()) {
            for word in words(span) {
                let is_placeholder = word.split('/').any(is_placeholder);
                let top = word.split_once('/').map(|(top, _)| top);
                if top.is_some_and(|top| self.folders.iter().any(|folder| folder == top)) {
                    let path = self.root.join(word);
                    if !is_placeholder && !path.exists() && !self.here().join(word).exists() {
                        missing.push(word);
                    }
                    near.extend(path.ancestors().take_while(|at| *at != self.root).map(Path::to_path_buf));
                } else if is_code
                    && word == span
                    && (word.ends_with(".rs") || word.ends_with('/') && word != "/")
                    && !near.iter().any(|folder| folder.join(word).exists())
                {
                    missing.push(word);
                }
            }
        }
        missing
    }

    fn here(&self) -> PathBuf {
        self.file.parent().unwrap_or(self.root).to_path_buf()
    }
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

/// The folders at the top that are the repository's own.
fn folders(root: &Path) -> Result<Vec<String>, String> {
    let folders = files::entries(root)?.into_iter().filter(|path| path.is_dir() && !files::is_made(path));
    Ok(folders.map(|path| files::name(&path)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repo::Repo;

    fn missing(line: &str) -> Vec<String> {
        let root = Repo::find().root;
        let file = root.join("xtask/README.md");
        let folders = folders(&root).expect("the repository");
        let document = Document { root: &root, file: &file, folders: &folders };
        let faults = document.faults(line).into_iter().chain(document.missing_pages(line));
        faults.map(|(_, fault)| fault).collect()
    }

    #[test]
    fn this_repository_has_no_broken_reference() {
        assert_eq!(check(&Repo::find().root), Ok(()));
    }

    #[test]
    fn existing_names_are_accepted() {
        for line in [
            "//! See docs/limits.md and `PROTOCOL.md`.",
            "see `xtask/src/main.rs` (all), `layers.rs`, `size/`, and `src/main.rs`",
            "`xtask/src/size/` beside `layers.rs`; `trace.csv`, `m/s`, `target/firmware/PART/BIN` are not ours",
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
