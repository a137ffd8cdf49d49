//! Layers of the controller point down only, and behaviours never import each other.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The layers from the lowest up. Modules of one layer may use each other, except where
/// [`APART`] says not.
const LAYERS: [&[&str]; 4] = [
    &[
        "names", "scalar", "digest", "geom", "time", "rand", "grid", "cost", "shuffle", "list", "fixint", "obstacle",
        "land", "robot", "auth",
    ],
    &["body", "neighbor", "template", "wire"],
    &["route", "formation", "orca", "flock", "push_out"],
    &["supervisor", "agent"],
];
/// The layer of the behaviours.
const APART: usize = 2;

/// Reads every source file of the controller. The error lists each import that points up or
/// sideways, by file and line.
pub fn check(source: &Path) -> Result<(), String> {
    let mut faults = String::new();
    let mut files = Vec::new();
    list(source, &mut files).map_err(|error| format!("{}: {error}", source.display()))?;
    files.sort();
    for file in &files {
        let Some(module) = module_of(file.strip_prefix(source).unwrap_or(file)) else {
            continue; // lib.rs names every module
        };
        let text = fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
        for (line, used) in imports(&text) {
            if let Some(fault) = fault(&module, used) {
                let _ = writeln!(faults, "{}:{line}: {fault}", file.display());
            }
        }
    }
    if faults.is_empty() {
        return Ok(());
    }
    print!("{faults}");
    Err(format!("{} imports against the layers", faults.lines().count()))
}

/// The top-level module that a file belongs to; `None` for the crate's root.
fn module_of(file: &Path) -> Option<String> {
    let first = file.iter().next()?.to_str()?;
    let name = first.strip_suffix(".rs").unwrap_or(first);
    (name != "lib").then(|| name.to_string())
}

/// The top-level modules named by `crate::` paths in code, with their line numbers.
fn imports(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().zip(1..).flat_map(|(line, number)| {
        let code = line.split("//").next().unwrap_or("");
        code.split("crate::").skip(1).map(move |rest| {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            (number, rest.get(..end.unwrap_or(rest.len())).unwrap_or(""))
        })
    })
}

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|modules| modules.contains(&module))
}

/// What is wrong with `user` using `used`, if anything is.
fn fault(user: &str, used: &str) -> Option<String> {
    if user == used {
        return None;
    }
    if used.is_empty() {
        return Some(String::from("name the module right after `crate::`"));
    }
    let (Some(above), Some(below)) = (layer(user), layer(used)) else {
        let stranger = if layer(user).is_none() { user } else { used };
        return Some(format!("`{stranger}` has no layer; give it one in xtask/src/layers.rs"));
    };
    if above < below {
        Some(format!("`{user}` uses `{used}`, which is above it"))
    } else if above == below && above == APART {
        Some(format!("`{user}` uses `{used}`: behaviours do not know each other"))
    } else {
        None
    }
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_point_down() {
        assert_eq!(fault("agent", "route"), None);
        assert_eq!(fault("agent", "supervisor"), None);
        assert_eq!(fault("route", "grid"), None);
        assert_eq!(fault("route", "route"), None);
        assert!(fault("grid", "route").is_some());
        assert!(fault("wire", "agent").is_some());
        assert!(fault("route", "formation").is_some());
        assert!(fault("route", "").unwrap().contains("crate::"));
        assert!(fault("route", "helpers").unwrap().contains("no layer"));
    }

    #[test]
    fn paths_in_code_count_and_comments_do_not() {
        let text = "use crate::grid::Cell;\n/// See [`crate::agent`].\nlet a = crate::time::now(crate::rand::f());";
        let found: Vec<_> = imports(text).collect();
        assert_eq!(found, [(1, "grid"), (3, "time"), (3, "rand")]);
    }

    #[test]
    fn a_file_belongs_to_its_top_module() {
        assert_eq!(module_of(Path::new("route/exits.rs")).as_deref(), Some("route"));
        assert_eq!(module_of(Path::new("grid.rs")).as_deref(), Some("grid"));
        assert_eq!(module_of(Path::new("lib.rs")), None);
    }
}
