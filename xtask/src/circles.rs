//! Modules of one folder do not use each other in a circle, in any crate of the workspace.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A module's names from the crate's root down; none for the root itself.
type Module = Vec<String>;
/// Which modules of a folder use which others of the same folder.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// Reads every crate of the workspace. The error counts the circles, which are printed with their folder.
pub fn check(root: &Path) -> Result<(), String> {
    let manifest = fs::read_to_string(root.join("Cargo.toml")).map_err(|error| error.to_string())?;
    let manifest: toml::Table = manifest.parse().map_err(|error| format!("{error}"))?;
    let members = manifest.get("workspace").and_then(|workspace| workspace.get("members"));
    let members = members.and_then(toml::Value::as_array).into_iter().flatten();
    let mut found = BTreeSet::new();
    for member in members.filter_map(toml::Value::as_str) {
        for (folder, uses) in uses(&modules(&root.join(member).join("src"))?) {
            let place = [member, "src"].into_iter().chain(folder.iter().map(String::as_str));
            let place = place.collect::<Vec<_>>().join("/");
            found.extend(circles(&uses).into_iter().map(|circle| (place.clone(), circle)));
        }
    }
    let faults: Vec<String> =
        found.iter().map(|(place, circle)| format!("{place}: {circle} use each other in a circle")).collect();
    faults.iter().for_each(|fault| println!("{fault}"));
    faults.first().map_or(Ok(()), |first| Err(first.clone()))
}

/// The modules of the crate whose sources are in a folder, each with the paths that it names. Tests are left out.
pub fn modules(source: &Path) -> Result<BTreeMap<Module, Vec<Module>>, String> {
    let mut code = Code::default();
    if source.is_dir() {
        code.read(source, &mut Vec::new())?;
    }
    Ok(code.without_tests())
}

/// The code of a crate, as far as it has been read.
#[derive(Default)]
struct Code {
    /// What each module names by paths from `crate`, `super` and `self`.
    named: BTreeMap<Module, Vec<Module>>,
    /// Modules that are declared for tests only.
    tests: BTreeSet<Module>,
}

impl Code {
    fn read(&mut self, folder: &Path, above: &mut Module) -> Result<(), String> {
        let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
        for entry in fs::read_dir(folder).map_err(wrong)? {
            let path = entry.map_err(wrong)?.path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "bin" {
                above.push(name);
                self.read(&path, above)?;
                above.pop();
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let mut module = above.clone();
                if !["lib", "main", "mod"].contains(&name.as_str()) {
                    module.push(name);
                }
                self.file(&fs::read_to_string(&path).map_err(wrong)?, &module)
                    .map_err(|error| format!("{}: {error}", path.display()))?;
            }
        }
        Ok(())
    }

    fn file(&mut self, text: &str, module: &Module) -> Result<(), String> {
        let tokens: TokenStream = text.parse().map_err(|error| format!("{error}"))?;
        self.walk(tokens, module);
        Ok(())
    }

    fn walk(&mut self, tokens: TokenStream, module: &Module) {
        self.named.entry(module.clone()).or_default();
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let (mut rest, mut is_foreign) = (tokens.as_slice(), false);
        while let [first, after @ ..] = rest {
            rest = after;
            match after {
                [TokenTree::Group(attribute), item @ ..] if is(first, "#") && is_for_tests(attribute.stream()) => {
                    rest = self.skip(item, module);
                }
                [TokenTree::Ident(name), TokenTree::Group(body), after @ ..] if is(first, "mod") => {
                    self.walk(body.stream(), &below(module, name));
                    rest = after;
                }
                [colon, ..] if is(colon, ":") && ["crate", "super", "self"].iter().any(|start| is(first, start)) => {
                    let mut found = Vec::new();
                    rest = branches(&tokens[tokens.len() - after.len() - 1..], &Vec::new(), &mut found);
                    if !is_foreign {
                        let found = found.into_iter().map(|path| absolute(&path, module));
                        self.named.entry(module.clone()).or_default().extend(found);
                    }
                }
                _ => {
                    if let TokenTree::Group(group) = first {
                        self.walk(group.stream(), module);
                    }
                }
            }
            is_foreign = is(first, "$");
        }
    }

    /// What comes behind an item that only tests have, or behind a field or another element of a list.
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
            // A file of another name is told in an attribute: `#[path = "tests.rs"]`.
            let text = item.iter().map(ToString::to_string).collect::<String>();
            let file = text.split_once("path = \"").and_then(|(_, rest)| rest.split_once(".rs\""));
            self.tests.insert(file.map_or_else(|| below(module, name), |(file, _)| below(module, file)));
        }
        rest
    }

    /// The modules that are there without tests.
    fn without_tests(mut self) -> BTreeMap<Module, Vec<Module>> {
        self.named.retain(|module, _| !self.tests.iter().any(|test| module.starts_with(test)));
        self.named
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

/// In each folder of modules: who uses whom, by what they or modules below them name.
fn uses(modules: &BTreeMap<Module, Vec<Module>>) -> BTreeMap<Module, Uses> {
    let mut all: BTreeMap<Module, Uses> = BTreeMap::new();
    for (user, named) in modules {
        for used in named {
            let common = user.iter().zip(used).take_while(|(a, b)| a == b).count();
            let (Some(above), Some(below)) = (user.get(common), used.get(common)) else {
                continue; // a module uses what it is in, or what is in it
            };
            let is_module =
                modules.keys().any(|module| used.get(..=common).is_some_and(|used| module.starts_with(used)));
            if is_module {
                let folder = user.iter().take(common).cloned().collect();
                let uses = all.entry(folder).or_default();
                uses.entry(above.clone()).or_default().insert(below.clone());
            }
        }
    }
    all
}

/// Each set of modules that all reach each other, in alphabetical order.
fn circles(uses: &Uses) -> BTreeSet<String> {
    let reached = |start: &String| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(module) = next.pop() {
            let fresh = uses.get(module).into_iter().flatten();
            next.extend(fresh.filter(|used| seen.insert((*used).clone())));
        }
        seen
    };
    let reach: BTreeMap<&String, BTreeSet<String>> = uses.keys().map(|module| (module, reached(module))).collect();
    let circle = |start: &String| {
        let mut members = reach.get(start)?.clone();
        members.retain(|member| reach.get(member).is_some_and(|back| back.contains(start)));
        (!members.is_empty()).then(|| members.into_iter().collect::<Vec<_>>().join(", "))
    };
    uses.keys().filter_map(circle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(path: &str) -> Module {
        path.split('/').filter(|name| !name.is_empty()).map(String::from).collect()
    }

    fn of(files: &[(&str, &str)]) -> Vec<(String, String)> {
        let mut code = Code::default();
        files.iter().for_each(|(path, text)| code.file(text, &module(path)).expect("sound code"));
        let found = uses(&code.without_tests());
        let all =
            found.iter().flat_map(|(folder, uses)| circles(uses).into_iter().map(|circle| (folder.join("/"), circle)));
        all.collect()
    }

    #[test]
    fn circles_of_any_length_and_depth_are_found() {
        let circle = |folder: &str, modules: &str| vec![(folder.to_string(), modules.to_string())];
        assert_eq!(of(&[("a", "use crate::b;"), ("b", "use crate::a::T;")]), circle("", "a, b"));
        let three = [
            ("x/a", "use super::b;"),
            ("x/b", "fn f(_: crate::x::c::T) {}"),
            ("x/c", "use super::{q::R, a as z};"),
            ("x/q", ""),
        ];
        assert_eq!(of(&three), circle("x", "a, b, c"));
        assert_eq!(
            of(&[("a/i", "use crate::{b::{c, d}, e};"), ("b", ""), ("e/f", "use crate::a;")]),
            circle("", "a, e")
        );
    }

    #[test]
    fn parents_comments_tests_and_strangers_make_no_circle() {
        assert_eq!(of(&[("a", "pub use b::T; use self::b::U;"), ("a/b", "use super::V; use crate::a::W;")]), []);
        assert_eq!(of(&[("a", "use crate::b;"), ("b", "// crate::a\n#[cfg(test)] use crate::a;")]), []);
        assert_eq!(of(&[("a", "use crate::b;"), ("b", "use other_crate::a; use $crate::a; use crate::A;")]), []);
    }

    #[test]
    fn only_the_item_behind_a_test_attribute_is_left_out() {
        let circle = [(String::new(), String::from("a, b"))];
        for head in [
            "#[cfg(test)] mod tests;",
            "#[cfg(test)]\n#[path = \"x.rs\"]\nmod tests { fn f() { \"}\"; } }",
            "#[cfg(test)] use crate::{c, d};",
            "#[cfg(test)] pub(super) fn f<A, B>(a: [u8; 3]) -> A { '{'; a }",
            "#[cfg(all(test, feature = \"x\"))] const A: u8 = { 1 };",
            "struct S { #[cfg(test)] field: Vec<u8>, other: u8 }",
        ] {
            assert_eq!(of(&[("a", &format!("{head} use crate::b;")), ("b", "use crate::a;")]), circle, "{head}");
        }
        for tests in
            ["mod tests { use crate::b; }", "mod tests; #[cfg(test)] use crate::b;", "fn f() -> crate::b::T {}"]
        {
            assert_eq!(of(&[("a", &format!("#[cfg(test)] {tests}")), ("b", "use crate::a;")]), []);
        }
        // A file that only tests have is none of the others' business.
        let files = [("a", "#[cfg(test)] mod oracle;"), ("a/oracle", "use crate::b;"), ("b", "use crate::a;")];
        assert_eq!(of(&files), []);
    }

    #[test]
    fn this_repository_has_only_the_known_circles() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        assert_eq!(check(&root), Ok(()));
    }
}
