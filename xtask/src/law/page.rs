//! The blocks of code of docs/laws.md: files, lines of files, commands, and code for C and Python.

use crate::prelude::*;

/// The page, from the top of the repository.
const PAGE: &str = "docs/laws.md";

/// A block of code.
#[derive(Debug, PartialEq, Eq)]
pub struct Block {
    /// The file that it is, or `diff` changes: the line above the block has it.
    pub path: Option<PathBuf>,
    /// The word behind the fence; empty for commands.
    pub language: String,
    pub text: String,
}

/// The page in its order.
pub struct Page(Vec<Block>);

impl Page {
    /// Reads the page of a repository.
    pub fn read(root: &Path) -> Result<Self> {
        Ok(Self(blocks(&files::read(&root.join(PAGE))?)))
    }

    /// Files that the page writes or changes.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.0.iter().filter_map(|block| block.path.as_deref())
    }

    /// The code in a language that belongs to no file.
    pub fn code(&self, language: &str) -> Result<&str> {
        let found = self.0.iter().find(|block| block.path.is_none() && block.language == language);
        found.map(|block| block.text.as_str()).with_context(|| format!("{PAGE} has no code in {language:?}"))
    }

    /// Writes the page's files into a copy of the repository, and the lines that it adds to others
    /// unless `leaves_out` has their file.
    pub fn plant(&self, repo: &Repo, copy: &Repo, leaves_out: &[&str]) -> Result<()> {
        let (mut unplaced, leaves_out) =
            (Vec::new(), |file: &Path| leaves_out.iter().any(|path| file == Path::new(path)));
        repo.copy(&copy.root, |file, mut bytes| {
            let diffs = self.0.iter().filter(|block| block.language == "diff" && block.path.as_deref() == Some(file));
            for block in diffs.filter(|_| !leaves_out(file)) {
                match patched(&String::from_utf8_lossy(&bytes), &block.text) {
                    Some(text) => bytes = text.into_bytes(),
                    None => unplaced.push(format!("{PAGE}: {} does not have once\n{}", file.display(), block.text)),
                }
            }
            bytes
        })?;
        none_of(&unplaced, "changes have no place")?;
        for (block, path) in self.0.iter().filter_map(|block| Some((block, block.path.as_ref()?))) {
            if block.language != "diff" {
                ensure!(!repo.root.join(path).exists(), "{PAGE}: {} exists already", path.display());
                files::update(&copy.root.join(path), block.text.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// The blocks of a page. A line that is nothing but a path in bold code heads a file.
fn blocks(page: &str) -> Vec<Block> {
    let (mut blocks, mut head, mut open) = (Vec::new(), None, None::<Block>);
    for line in page.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => {
                open = Some(Block { path: head.take(), language: language.to_owned(), text: String::new() });
            }
            (None, Some(block)) => block.text.extend([line, "\n"]),
            (None, None) if line.is_empty() => {}
            (None, None) => {
                head = line.strip_prefix("**`").and_then(|rest| rest.strip_suffix("`**")).map(PathBuf::from)
            }
        }
    }
    blocks
}

/// A text with the lines of a diff that begin with `+`, between those that begin with a blank and
/// are in the text once, in this order and without a gap.
fn patched(text: &str, diff: &str) -> Option<String> {
    let join = |lines: Vec<&str>| lines.concat();
    let lines = || diff.split_inclusive('\n').filter(|line| line.len() > 1);
    let before = join(lines().filter_map(|line| line.strip_prefix(' ')).collect());
    let after = join(lines().filter_map(|line| line.strip_prefix(['+', ' '])).collect());
    (text.matches(&before).count() == 1 && before.len() < after.len()).then(|| text.replace(&before, &after))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "# A page\n\nWords\n\n**`a/b.rs`**\n\n```rust\nfn b() {}\n```\n\nMore\n\n```\nrun a\nrun b c\n```\n";

    #[test]
    fn blocks_have_the_path_above_them() {
        let block = |path: Option<&str>, language: &str, text: &str| Block {
            path: path.map(PathBuf::from),
            language: language.to_owned(),
            text: text.to_owned(),
        };
        let wanted = [block(Some("a/b.rs"), "rust", "fn b() {}\n"), block(None, "", "run a\nrun b c\n")];
        assert_eq!(blocks(TEXT), wanted);
        // A path above other words heads nothing.
        assert_eq!(blocks("**`a.rs`**\n\nwords\n\n```\nx\n```\n"), [block(None, "", "x\n")]);
    }

    #[test]
    fn lines_are_added_where_the_diff_says() {
        assert_eq!(patched("a\nb\nc\n", " a\n+x\n+y\n b\n").as_deref(), Some("a\nx\ny\nb\nc\n"));
        for diff in [" b\n+x\n a\n", " a\n+x\n c\n", " d\n+x\n", " a\n"] {
            assert_eq!(patched("a\nb\nc\n", diff), None, "{diff}");
        }
        assert_eq!(patched("a\na\n", " a\n+x\n"), None);
    }
}
