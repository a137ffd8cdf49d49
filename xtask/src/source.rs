//! The sources of crates as tokens: the paths that each module names, and the lines that hold code.
//! Tests are left out.

use crate::files;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module's names from the crate's root down; empty for the root itself.
pub type Module = Vec<String>;

/// The content of a module.
#[derive(Default)]
pub struct Content {
    /// Paths in it that begin with `crate`, `super` or `self`, from the crate's root down.
    pub named: Vec<Module>,
    /// Lines with code; neither blank nor comment.
    pub lines: BTreeSet<usize>,
}

/// The folders of the workspace's crates, from its top.
pub fn members(root: &Path) -> Result<Vec<String>, String> {
    let manifest: toml::Table = files::read(&root.join("Cargo.toml"))?.parse().map_err(|error| format!("{error}"))?;
    let members = manifest.get("workspace").and_then(|workspace| workspace.get("members"));
    let members = members.and_then(toml::Value::as_array).into_iter().flatten();
    Ok(members.filter_map(toml::Value::as_str).map(String::from).collect())
}

/// The modules of the crate whose sources are in a folder.
pub fn modules(source: &Path) -> Result<BTreeMap<Module, Content>, String> {
    let mut code = Code::default();
    if source.is_dir() {
        code.read(source)?;
    }
    Ok(code.without_tests())
}

/// The code of a crate, as far as it has been read.
#[derive(Default)]
pub struct Code {
    modules: BTreeMap<Module, Content>,
    /// Modules that are declared for tests only.
    tests: BTreeSet<Module>,
}

impl Code {
    fn read(&mut self, source: &Path) -> Result<(), String> {
        let is_code = |path: &Path| files::has_extension(path, &["rs"]);
        let is_wanted = |path: &Path| if path.is_dir() { files::name(path) != "bin" } else { is_code(path) };
        for file in files::below(source, &is_wanted)? {
            let module = file.with_extension("");
            let names = module.strip_prefix(source).unwrap_or(&module).iter();
            let mut module: Module = names.map(|name| name.to_string_lossy().into_owned()).collect();
            if module.last().is_some_and(|name| ["lib", "main", "mod"].contains(&name.as_str())) {
                module.pop();
            }
            self.file(&files::read(&file)?, &module).map_err(|error| format!("{}: {error}", file.display()))?;
        }
        Ok(())
    }

    /// Reads one file.
    pub fn file(&mut self, text: &str, module: &Module) -> Result<(), String> {
        let tokens: TokenStream = text.parse().map_err(|error| format!("{error}"))?;
        self.walk(tokens, module);
        Ok(())
    }

    fn walk(&mut self, tokens: TokenStream, module: &Module) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let (mut rest, mut is_foreign) = (tokens.as_slice(), false);
        while let [first, after @ ..] = rest {
            let before = rest;
            rest = after;
            match after {
                [TokenTree::Group(attribute), item @ ..] if is(first, "#") && is_for_tests(attribute.stream()) => {
                    rest = self.skip(item, module);
                }
                [TokenTree::Group(comment), after @ ..] if is(first, "#") && is_comment(comment.stream()) => {
                    rest = after
                }
                [mark, TokenTree::Group(comment), after @ ..] if is(mark, "!") && is_comment(comment.stream()) => {
                    rest = after;
                }
                [TokenTree::Ident(name), TokenTree::Group(body), after @ ..] if is(first, "mod") => {
                    self.mark(module, &before[..3], false);
                    self.walk(body.stream(), &below(module, name));
                    rest = after;
                }
                [colon, ..] if is(colon, ":") && ["crate", "super", "self"].iter().any(|start| is(first, start)) => {
                    let mut found = Vec::new();
                    rest = branches(before, &Vec::new(), &mut found);
                    self.mark(module, &before[..before.len() - rest.len()], true);
                    if !is_foreign {
                        let found = found.into_iter().map(|path| absolute(&path, module));
                        self.modules.entry(module.clone()).or_default().named.extend(found);
                    }
                }
                _ => {
                    self.mark(module, &before[..1], false);
                    if let TokenTree::Group(group) = first {
                        self.walk(group.stream(), module);
                    }
                }
            }
            is_foreign = is(first, "$");
        }
    }

    /// Counts the lines of these tokens and, of a group, those of its brackets; with `inside` also
    /// those between them.
    fn mark(&mut self, module: &Module, tokens: &[TokenTree], inside: bool) {
        for token in tokens {
            let spans = match token {
                TokenTree::Group(group) => {
                    if inside {
                        self.mark(module, &group.stream().into_iter().collect::<Vec<_>>(), inside);
                    }
                    [group.span_open(), group.span_close()]
                }
                token => [token.span(); 2],
            };
            let lines = spans.into_iter().flat_map(|span| span.start().line..=span.end().line);
            self.modules.entry(module.clone()).or_default().lines.extend(lines);
        }
    }

    /// The tokens behind an item that only tests have, or behind a field or another element of a
    /// list.
    fn skip<'a>(&mut self, tokens: &'a [TokenTree], module: &Module) -> &'a [TokenTree] {
        const ITEMS: [&str; 12] =
            ["fn", "mod", "use", "struct", "enum", "impl", "trait", "const", "static", "type", "extern", "macro_rules"];
        let is_end = |at: usize, token: &TokenTree| match token {
            TokenTree::Punct(mark) if mark.as_char() == ',' => {
                !tokens[..at].iter().any(|token| ITEMS.iter().any(|item| is(token, item)))
            }
            TokenTree::Group(group) => {
                let is_more = tokens.get(at + 1).is_some_and(|next| is(next, ";"));
                group.delimiter() == Delimiter::Brace && !is_more
            }
            token => is(token, ";"),
        };
        let end = tokens.iter().enumerate().position(|(at, token)| is_end(at, token));
        let (item, rest) = tokens.split_at(end.map_or(tokens.len(), |end| end + 1));
        if let [.., keyword, TokenTree::Ident(name), _] = item
            && is(keyword, "mod")
        {
            // An attribute names a file of another name: `#[path = "tests.rs"]`.
            let text = item.iter().map(ToString::to_string).collect::<String>();
            let file = text.split_once("path = \"").and_then(|(_, rest)| rest.split_once(".rs\""));
            self.tests.insert(file.map_or_else(|| below(module, name), |(file, _)| below(module, file)));
        }
        rest
    }

    /// The modules that are there without tests.
    pub fn without_tests(mut self) -> BTreeMap<Module, Content> {
        self.modules.retain(|module, _| !self.tests.iter().any(|test| module.starts_with(test)));
        self.modules
    }
}

/// Whether this is that word or mark.
fn is(token: &TokenTree, text: &str) -> bool {
    !matches!(token, TokenTree::Group(_)) && token.to_string() == text
}

/// Whether an attribute is `cfg(test)` or `cfg(all(test, ...))`.
fn is_for_tests(attribute: TokenStream) -> bool {
    let text = attribute.to_string().replace(' ', "");
    text == "cfg(test)" || text.starts_with("cfg(all(test,")
}

/// Whether an attribute is the documentation of an item.
fn is_comment(attribute: TokenStream) -> bool {
    attribute.to_string().starts_with("doc =")
}

/// A module's child.
fn below(module: &Module, name: impl ToString) -> Module {
    [module.as_slice(), &[name.to_string()]].concat()
}

/// Adds the paths that begin here: `a::b`, `a::{b, c::d}`, `a::*`. Returns what comes behind them.
fn branches<'a>(tokens: &'a [TokenTree], before: &Module, found: &mut Vec<Module>) -> &'a [TokenTree] {
    match tokens {
        [TokenTree::Ident(name), colon, _, rest @ ..] if is(colon, ":") => branches(rest, &below(before, name), found),
        [TokenTree::Ident(name), rest @ ..] => {
            found.push(below(before, name));
            rest
        }
        [TokenTree::Group(list), rest @ ..] => {
            let list: Vec<TokenTree> = list.stream().into_iter().collect();
            for branch in list.split(|token| is(token, ",")) {
                branches(branch, before, found);
            }
            rest
        }
        rest => {
            found.push(before.clone());
            rest
        }
    }
}

/// A path as the module means it, from the crate's root.
fn absolute(path: &[String], module: &Module) -> Module {
    let mut base = match path.first().map(String::as_str) {
        Some("crate") => Vec::new(),
        _ => module.clone(),
    };
    for name in path {
        match name.as_str() {
            "crate" | "self" => {}
            "super" => drop(base.pop()),
            name => base.push(name.to_string()),
        }
    }
    base
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_code_are_neither_blank_nor_comments_nor_tests() {
        let text = "//! A crate.\n\n/// A function.\nfn f() {\n    // why\n    let a = \"\n//\";\n}\n\n\
            #[cfg(test)]\nmod tests {\n    fn g() {}\n}\nuse crate::{\n    a,\n};\n";
        let mut code = Code::default();
        code.file(text, &Vec::new()).expect("sound code");
        let lines = |content: Content| content.lines.into_iter().collect::<Vec<_>>();
        let modules: Vec<_> = code.without_tests().into_values().map(lines).collect();
        assert_eq!(modules, [vec![4, 6, 7, 8, 14, 15, 16]]);
    }
}
