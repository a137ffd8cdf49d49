//! Modules of one folder do not use each other in a circle, in any crate of the workspace.

use crate::source::{Content, Module, members, modules};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Which modules of a folder use which others of the same folder.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// Reads every crate of the workspace. The error names the first circle; all are printed with their
/// folder.
pub fn check(root: &Path) -> Result<(), String> {
    let mut found = BTreeSet::new();
    for member in members(root)? {
        for (folder, uses) in uses(&modules(&root.join(&member).join("src"))?) {
            let place = [member.as_str(), "src"].into_iter().chain(folder.iter().map(String::as_str));
            let place = place.collect::<Vec<_>>().join("/");
            let faults = circles(&uses).into_iter();
            found.extend(faults.map(|circle| format!("{place}: {circle} use each other in a circle")));
        }
    }
    found.iter().for_each(|fault| println!("{fault}"));
    found.into_iter().next().map_or(Ok(()), Err)
}

/// The uses between the modules of each folder, by the paths in them and in modules below them.
fn uses(modules: &BTreeMap<Module, Content>) -> BTreeMap<Module, Uses> {
    let mut all: BTreeMap<Module, Uses> = BTreeMap::new();
    for (user, Content { named, .. }) in modules {
        for used in named {
            let common = user.iter().zip(used).take_while(|(a, b)| a == b).count();
            let (Some(above), Some(below)) = (user.get(common), used.get(common)) else {
                continue; // a module uses its parent or its child
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
    use crate::source::Code;

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
