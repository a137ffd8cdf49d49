//! Layers of the controller point down only, and behaviours never import each other.

use crate::source::{Content, modules};
use std::collections::BTreeSet;
use std::path::Path;

/// The layers from the lowest up. Modules of one layer may use each other, except where
/// [`APART`] says not.
const LAYERS: [&[&str]; 6] = [
    &[
        "names", "scalar", "digest", "geom", "time", "rand", "grid", "cost", "shuffle", "list", "fixint", "obstacle",
        "land", "robot", "auth",
    ],
    &["body", "neighbor", "parameters", "template", "wire"],
    &["flock", "law"],
    &["route", "formation", "orca", "lattice", "goal_flock", "boids", "push_out", "negotiation"],
    &["safety", "laws"],
    &["supervisor", "agent"],
];
/// The layer of the behaviours.
const APART: usize = 3;

/// Reads every source file of the controller. The error counts the imports that point up or
/// sideways, which are printed.
pub fn check(source: &Path) -> Result<(), String> {
    let mut faults = BTreeSet::new();
    for (module, Content { named, .. }) in modules(source)? {
        // The crate's root and the list of laws name every module.
        if module.is_empty() || *module == ["laws"] {
            continue;
        }
        let user = unit(&module);
        for used in named.iter().filter(|path| !path.is_empty()).map(|path| unit(path)) {
            faults.extend(fault(user, used).map(|fault| format!("{}: {fault}", module.join("/"))));
        }
    }
    faults.iter().for_each(|fault| println!("{fault}"));
    if faults.is_empty() { Ok(()) } else { Err(format!("{} imports against the layers", faults.len())) }
}

/// What has a layer: a module of the root, or an algorithm in the folder of its law. The laws
/// themselves are `laws`.
fn unit(path: &[String]) -> &str {
    match path {
        [laws, folder, rest @ ..] if laws == "laws" && layer(folder).is_some() => {
            if rest.first().is_some_and(|part| part == "law") { laws } else { folder }
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
    if user == used {
        return None;
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
        assert_eq!(fault("laws", "route"), None);
        assert!(fault("lattice", "boids").is_some());
        assert!(fault("route", "helpers").unwrap().contains("no layer"));
    }

    #[test]
    fn a_law_is_above_its_algorithm() {
        let unit = |path: &str| super::unit(&path.split('/').map(String::from).collect::<Vec<_>>()).to_owned();
        assert_eq!(unit("laws/route/field/queue"), "route");
        assert_eq!(unit("laws/formation/law/in_plane"), "laws");
        assert_eq!(unit("laws/cells/protocol"), "laws");
        assert_eq!(unit("agent/step"), "agent");
    }

    #[test]
    fn the_controller_has_layers() {
        assert_eq!(check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../controller/src")), Ok(()));
    }
}
