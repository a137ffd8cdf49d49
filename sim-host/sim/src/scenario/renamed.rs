//! Fields of earlier versions, for errors that print what to write instead and for `staya migrate`.

use super::read::Node;
use super::source::{Checked, Source};
use super::write::inline;
use std::borrow::Cow;
use toml::de::{DeTable, DeValue};

/// Values of laws with other names: the law's table, the earlier and the present name.
pub const VALUES: [(&str, &str, &str); 9] = [
    ("lattice", "c_alpha", "c1_alpha"),
    ("lattice", "c_beta", "c1_beta"),
    ("lattice", "c_gamma", "c1_gamma"),
    ("goal_flock", "arrival_m", "tolerance_m"),
    ("formation", "gain", "place_gain"),
    ("formation", "eps", "eps_cells"),
    ("formation", "lead", "lead_cells"),
    ("formation_paper", "gain", "place_gain"),
    ("formation_paper", "eps", "eps_cells"),
];

/// The law of formations that earlier files call so.
#[must_use]
pub fn formation_law(name: &str) -> &'static str {
    match name {
        "paper" => "formation_paper",
        "lookahead" => "formation_lookahead",
        _ => "formation",
    }
}

/// The present name of a value of a law.
#[must_use]
pub fn value<'a>(law: &str, name: &'a str) -> Cow<'a, str> {
    let law = if law == "formation_lookahead" { "formation" } else { law };
    VALUES.iter().find(|(table, old, _)| *table == law && *old == name).map_or(name.into(), |(.., new)| (*new).into())
}

fn text<'t>(table: &'t DeTable<'_>, name: &str) -> Option<&'t str> {
    table.get(name)?.get_ref().as_str()
}

/// The first field of an earlier version: its path, and the line to write with its table.
fn first_old(root: &DeTable<'_>) -> Option<(String, String, String)> {
    let plane = root.get("plane").and_then(|node| node.get_ref().as_table());
    let place = if plane.is_some() { "plane" } else { "grid" };
    let line = |name: &str, node: &Node<'_>| format!("{name} = {}", inline(node.get_ref()));
    let of_formation = |root: &DeTable<'_>| {
        let table = root.get("formation").and_then(|node| node.get_ref().as_table());
        formation_law(table.and_then(|table| text(table, "law")).unwrap_or_default())
    };
    for (name, node) in root {
        let Some(table) = node.get_ref().as_table() else { continue };
        let first = table.iter().next().map(|(key, node)| (key.get_ref().as_ref(), node));
        let found = match (name.get_ref().as_ref(), first) {
            ("law", _) => {
                let own = text(table, "name").unwrap_or("NAME");
                Some(("law".to_owned(), format!("law = \"{own}\""), format!("[{place}]")))
            }
            ("route", Some(("radius", node))) => {
                Some(("route.radius".to_owned(), line("radius", node), "[grid]".to_owned()))
            }
            ("route", Some((key, node))) => {
                let in_formation = root.get("formation").is_some()
                    || root.get("robots").is_some_and(|robots| {
                        robots.get_ref().as_table().is_some_and(|robots| robots.contains_key("formation"))
                    })
                    || plane.and_then(|plane| text(plane, "law")) == Some("formation");
                let law = if in_formation { of_formation(root) } else { "route" };
                Some((format!("route.{key}"), line(key, node), format!("[{place}.{law}]")))
            }
            ("formation", Some(("rho", node))) => {
                Some(("formation.rho".to_owned(), line("rho", node), "[robots.formation]".to_owned()))
            }
            ("formation", Some(("law", node))) => {
                let law = formation_law(node.get_ref().as_str().unwrap_or_default());
                Some(("formation.law".to_owned(), format!("law = \"{law}\""), format!("[{place}]")))
            }
            ("formation", Some((key, node))) => {
                let law = of_formation(root);
                Some((format!("formation.{key}"), line(&value(law, key), node), format!("[{place}.{law}]")))
            }
            _ => None,
        };
        if found.is_some() {
            return found;
        }
    }
    let groups = plane.and_then(|plane| plane.get("group")).map(|node| node.get_ref());
    let groups = match groups {
        Some(DeValue::Array(list)) => list.iter().filter_map(|node| node.get_ref().as_table()).collect(),
        _ => Vec::new(),
    };
    let groups = (0..).zip(groups).map(|(index, group): (u32, _)| (format!("plane.group[{index}]"), group));
    let places = ["grid", "plane"].map(|name| Some((name.to_owned(), root.get(name)?.get_ref().as_table()?)));
    for (path, group) in places.into_iter().flatten().chain(groups) {
        if let Some(node) = group.get("guidance") {
            return Some((format!("{path}.guidance"), line("law", node), format!("[{path}]")));
        }
        for (law, old, new) in VALUES {
            let table = group.get(law).and_then(|node| node.get_ref().as_table());
            if let Some(node) = table.and_then(|table| table.get(old)) {
                return Some((format!("{path}.{law}.{old}"), line(new, node), format!("[{path}.{law}]")));
            }
        }
    }
    None
}

/// Refuses fields of earlier versions.
pub(super) fn refuse(source: &Source<'_>) -> Checked {
    let Some((field, line, table)) = first_old(source.root()) else { return Ok(()) };
    let remedy = format!("write `{line}` in {table}; `staya migrate FILE` rewrites a file");
    Err(source.error(&field, "this field is of an earlier version", remedy))
}
