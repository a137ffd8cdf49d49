//! Modules of one folder do not use each other in a circle, in any crate of the workspace.

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
        let source = root.join(member).join("src");
        let mut modules = BTreeMap::new();
        if source.is_dir() {
            read(&source, &mut Vec::new(), &mut modules).map_err(|error| format!("{member}: {error}"))?;
        }
        for (folder, uses) in uses(&modules) {
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

/// Each module below a folder with the paths that it names, tests left out.
fn read(folder: &Path, above: &mut Module, modules: &mut BTreeMap<Module, Vec<Module>>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && name != "bin" {
            above.push(name);
            read(&path, above, modules)?;
            above.pop();
        } else if path.extension().is_some_and(|extension| extension == "rs") && name != "tests" {
            let mut module = above.clone();
            if !["lib", "main", "mod"].contains(&name.as_str()) {
                module.push(name);
            }
            let named = named(&fs::read_to_string(&path)?, &module);
            modules.insert(module, named);
        }
    }
    Ok(())
}

/// What a file names by paths from `crate`, `super` and `self`, from the crate's root down.
fn named(text: &str, module: &Module) -> Vec<Module> {
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code = lines.collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(start) {
            let before = code.get(..at).unwrap_or_default();
            let is_whole = !before.ends_with(|c: char| c.is_alphanumeric() || "_$:".contains(c));
            if is_whole {
                branches(code.get(at..).unwrap_or_default(), &Vec::new(), &mut found);
            }
        }
    }
    found.into_iter().map(|path| absolute(&path, module)).collect()
}

/// Adds the paths that begin here: `a::b`, `a::{b, c::d}`. Returns what comes behind them.
fn branches<'a>(text: &'a str, before: &Module, found: &mut Vec<Module>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = branches(rest, before, found).trim_start();
            match rest.strip_prefix(',') {
                Some(more) => rest = more,
                None => return rest.strip_prefix('}').unwrap_or(rest),
            }
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
    let (name, rest) = text.split_at(end.unwrap_or(text.len()));
    let mut path = before.clone();
    if name.is_empty() {
        return rest.strip_prefix('*').unwrap_or(rest);
    }
    path.push(name.to_string());
    match rest.strip_prefix("::") {
        Some(rest) => branches(rest, &path, found),
        None => {
            found.push(path);
            // An `as` and a new name.
            let next = rest.find([',', '}', ';', '\n']).unwrap_or(rest.len());
            rest.split_at(next).1
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
        let modules = files.iter().map(|(path, text)| (module(path), named(text, &module(path))));
        let found = uses(&modules.collect());
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
    fn this_repository_has_only_the_known_circles() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        assert_eq!(check(&root), Ok(()));
    }
}
