//! Modules of one folder do not use each other in a circle, in any crate of the workspace. Layers
//! of the controller point down only, and behaviours never import each other. Tests are left out.

use crate::prelude::*;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};

/// The layers of the controller from the lowest up. Modules of one layer may use each other, except
/// where [`APART`] says not.
const LAYERS: [&[&str]; 6] = [
    &[
        "names", "scalar", "digest", "geom", "time", "rand", "grid", "cost", "shuffle", "list", "fixint", "array",
        "obstacle", "land", "robot", "auth",
    ],
    &["body", "neighbor", "parameters", "template", "wire"],
    &["flock", "law"],
    &["route", "formation", "orca", "lattice", "goal_flock", "boids", "push_out", "negotiation"],
    &["safety", "laws"],
    &["supervisor", "agent"],
];
/// The layer of the behaviours.
const APART: usize = 3;

/// A module's names from the crate's root down; empty for the root itself.
type Module = Vec<String>;
/// Each module with the paths in it that begin with `crate`, `super` or `self`, from the root down.
type Modules = BTreeMap<Module, BTreeSet<Module>>;

/// Looks for circles in the crates in these folders.
pub fn check_circles(crates: &[PathBuf]) -> Result<()> {
    let mut faults = Vec::new();
    // Packages of examples or tests alone have no sources.
    for source in crates.iter().map(|folder| folder.join("src")).filter(|source| source.is_dir()) {
        let found = circles(&read(&source)?);
        faults.extend(found.iter().map(|circle| format!("{}: {circle}", source.display())));
    }
    none_of(&faults, "circles")
}

/// Looks for imports of the controller that point up or sideways.
pub fn check_layers(source: &Path) -> Result<()> {
    let mut faults = Vec::new();
    // The crate's root and the list of laws name every module.
    for (module, paths) in read(source)?.iter().filter(|(module, _)| !module.is_empty() && **module != ["laws"]) {
        let found = paths.iter().filter(|path| !path.is_empty()).filter_map(|path| fault(unit(module), unit(path)));
        faults.extend(found.map(|fault| format!("{}: {fault}", module.join("/"))));
    }
    none_of(&faults, "imports point up or sideways")
}

/// The part of a path that has a layer: a module of the root, or an algorithm in the folder of its
/// law. The laws themselves are `laws`.
fn unit(path: &[String]) -> &str {
    match path {
        [laws, folder, rest @ ..] if laws == "laws" && layer(folder).is_some_and(|layer| layer > 0) => {
            if rest.first().is_some_and(|part| part == "law" || part == "settings") { laws } else { folder }
        }
        [first, ..] => first,
        [] => "",
    }
}

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|modules| modules.contains(&module))
}

/// The fault in `user` using `used`, if there is one.
fn fault(user: &str, used: &str) -> Option<String> {
    let (Some(above), Some(below)) = (layer(user), layer(used)) else {
        let stranger = if layer(user).is_none() { user } else { used };
        return Some(format!("`{stranger}` has no layer; give it one in xtask/src/modules.rs"));
    };
    if above < below {
        Some(format!("`{user}` uses `{used}`, which is above it"))
    } else if above == below && above == APART && user != used {
        Some(format!("`{user}` uses `{used}`: behaviours do not know each other"))
    } else {
        None
    }
}

/// Each folder with modules that use each other in a circle, and these modules.
fn circles(modules: &Modules) -> Vec<String> {
    let mut circles = Vec::new();
    for (folder, uses) in uses(modules) {
        let mut left: Vec<&String> = uses.keys().collect();
        // Modules that use or serve none of the others are in no circle.
        let is_bound = |module: &String, others: &[&String]| {
            let uses = |user: &String, used: &String| uses[user].contains(used);
            others.iter().any(|other| uses(module, other)) && others.iter().any(|other| uses(other, module))
        };
        while let Some(at) = left.iter().position(|module| !is_bound(module, &left)) {
            left.remove(at);
        }
        if !left.is_empty() {
            let circle = left.iter().map(|module| module.as_str()).collect::<Vec<_>>().join(", ");
            circles.push(format!("{}: {circle} use each other in a circle", folder.join("/")));
        }
    }
    circles
}

/// For each folder which of its modules use which others of it, by the paths in them and in modules
/// below them.
fn uses(modules: &Modules) -> BTreeMap<Module, BTreeMap<String, BTreeSet<String>>> {
    let mut all: BTreeMap<_, BTreeMap<_, BTreeSet<_>>> = BTreeMap::new();
    for (user, used) in modules.iter().flat_map(|(user, paths)| paths.iter().map(move |used| (user, used))) {
        let common = user.iter().zip(used).take_while(|(a, b)| a == b).count();
        // A module that uses its parent or its child is in no circle.
        if let (Some(above), Some(below)) = (user.get(common), used.get(common))
            && modules.keys().any(|module| module.starts_with(&used[..=common]))
        {
            let uses = all.entry(user[..common].to_vec()).or_default();
            uses.entry(above.clone()).or_default().insert(below.clone());
        }
    }
    all
}

/// Reads the crate whose sources are in a folder.
fn read(source: &Path) -> Result<Modules> {
    let mut code = Code::default();
    let is_wanted =
        |path: &Path| if path.is_dir() { files::name(path) != "bin" } else { files::has_extension(path, &["rs"]) };
    for file in files::below(source, &is_wanted)? {
        let path = file.with_extension("");
        let names = path.strip_prefix(source).unwrap_or(&path).iter();
        let mut module: Module = names.map(|name| name.to_string_lossy().into_owned()).collect();
        if module.last().is_some_and(|name| ["lib", "main", "mod"].contains(&name.as_str())) {
            module.pop();
        }
        let tokens = files::read(&file)?.parse::<TokenStream>();
        code.walk(tokens.map_err(|error| anyhow!("{}: {error}", file.display()))?, &module);
    }
    Ok(code.without_tests())
}

/// The code of a crate, as far as it has been read.
#[derive(Default)]
struct Code {
    modules: Modules,
    /// Modules that are declared for tests only.
    tests: Vec<Module>,
}

impl Code {
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
                [TokenTree::Ident(name), TokenTree::Group(body), after @ ..] if is(first, "mod") => {
                    self.walk(body.stream(), &below(module, name));
                    rest = after;
                }
                [colon, ..] if is(colon, ":") && ["crate", "super", "self"].iter().any(|start| is(first, start)) => {
                    let mut found = Vec::new();
                    rest = branches(before, &Vec::new(), &mut found);
                    if !is_foreign {
                        let found = found.into_iter().map(|path| absolute(&path, module));
                        self.modules.entry(module.clone()).or_default().extend(found);
                    }
                }
                _ => {
                    self.modules.entry(module.clone()).or_default();
                    if let TokenTree::Group(group) = first {
                        self.walk(group.stream(), module);
                    }
                }
            }
            is_foreign = is(first, "$");
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
            self.tests.push(file.map_or_else(|| below(module, name), |(file, _)| below(module, file)));
        }
        rest
    }

    /// The modules that are there without tests.
    fn without_tests(mut self) -> Modules {
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
    let is_from_root = path.first().is_some_and(|name| name == "crate");
    let mut base = if is_from_root { Vec::new() } else { module.clone() };
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

    fn module(path: &str) -> Module {
        path.split('/').filter(|name| !name.is_empty()).map(String::from).collect()
    }

    /// The circles of a crate with these modules.
    fn of(files: &[(&str, &str)]) -> Vec<String> {
        let mut code = Code::default();
        files.iter().for_each(|(path, text)| code.walk(text.parse().expect("sound code"), &module(path)));
        circles(&code.without_tests())
    }

    #[test]
    fn circles_of_any_length_and_depth_are_found() {
        let circle = |folder: &str, modules: &str| [format!("{folder}: {modules} use each other in a circle")];
        assert_eq!(of(&[("a", "use crate::b;"), ("b", "use crate::a::T;")]), circle("", "a, b"));
        let three = [
            ("x/a", "use super::b;"),
            ("x/b", "fn f(_: crate::x::c::T) {}"),
            ("x/c", "use super::{q::R, a as z};"),
            ("x/q", ""),
            ("x/r", "use super::a;"),
        ];
        assert_eq!(of(&three), circle("x", "a, b, c"));
        let nested = [("a/i", "use crate::{b::{c, d}, e};"), ("b", ""), ("e/f", "use crate::a;")];
        assert_eq!(of(&nested), circle("", "a, e"));
    }

    #[test]
    fn parents_comments_tests_and_strangers_make_no_circle() {
        for second in [
            "// crate::a\n#[cfg(test)] use crate::a;",
            "use other_crate::a; use $crate::a; use crate::A;",
            "#[cfg(test)] mod tests { use crate::a; }",
            "#[cfg(test)] mod tests; #[cfg(test)] use crate::a;",
            "#[cfg(test)] fn f() -> crate::a::T {}",
        ] {
            assert_eq!(of(&[("a", "use crate::b;"), ("b", second)]), [""; 0], "{second}");
        }
        assert_eq!(of(&[("a", "pub use b::T; use self::b::U;"), ("a/b", "use super::V; use crate::a::W;")]), [""; 0]);
        let files = [("a", "#[cfg(test)] mod oracle;"), ("a/oracle", "use crate::b;"), ("b", "use crate::a;")];
        assert_eq!(of(&files), [""; 0], "a file that only tests have");
    }

    #[test]
    fn only_the_item_behind_a_test_attribute_is_left_out() {
        for head in [
            "#[cfg(test)] mod tests;",
            "#[cfg(test)]\n#[path = \"x.rs\"]\nmod tests { fn f() { \"}\"; } }",
            "#[cfg(test)] use crate::{c, d};",
            "#[cfg(test)] pub(super) fn f<A, B>(a: [u8; 3]) -> A { '{'; a }",
            "#[cfg(all(test, feature = \"x\"))] const A: u8 = { 1 };",
            "struct S { #[cfg(test)] field: Vec<u8>, other: u8 }",
        ] {
            assert_eq!(of(&[("a", &format!("{head} use crate::b;")), ("b", "use crate::a;")]).len(), 1, "{head}");
        }
    }

    #[test]
    fn imports_point_down() {
        for (user, used) in [("agent", "route"), ("agent", "supervisor"), ("route", "route"), ("laws", "route")] {
            assert_eq!(fault(user, used), None, "{user} {used}");
        }
        for (user, used) in [("grid", "route"), ("wire", "agent"), ("route", "formation"), ("lattice", "boids")] {
            assert!(fault(user, used).is_some(), "{user} {used}");
        }
        assert!(fault("route", "helpers").unwrap().contains("no layer"));
    }

    #[test]
    fn a_law_is_above_its_algorithm() {
        for (path, above) in [
            ("laws/route/field/queue", "route"),
            ("laws/formation/law/in_plane", "laws"),
            ("laws/cells/protocol", "laws"),
            ("agent/step", "agent"),
        ] {
            assert_eq!(unit(&module(path)), above);
        }
    }
}
