//! Rewrites scenarios of earlier versions: `law = "NAME"` with a table for its values, instead of
//! `guidance`, `[law]`, `[route]` and `[formation]`. Comments and the order of fields stay.

use staya_sim::scenario::{formation_law, renamed_value};
use std::cell::Cell;
use toml_edit::{Decor, DocumentMut, Item, Key, Table, TableLike, TomlError, value};

/// The text in today's terms; `None`: it is already, or it is no scenario. Values that no robot has
/// a use for stay where they are.
///
/// # Errors
/// The text is not TOML.
pub fn migrated(text: &str) -> Result<Option<String>, TomlError> {
    let mut file: DocumentMut = text.parse()?;
    let root = file.as_table_mut();
    let are_tables = ["grid", "plane"].iter().all(|name| root.get(name).is_none_or(Item::is_table_like));
    if are_tables {
        rewrite(root);
    }
    let changed = file.to_string();
    Ok((changed != text).then_some(changed))
}

/// Tables of earlier versions that concern all robots.
struct Old {
    own: Option<Own>,
    route: Given,
    formation: Given,
    /// The law of formations.
    sort: &'static str,
}

/// A table whose values become those of laws.
struct Given {
    table: Option<Item>,
    is_used: Cell<bool>,
}

impl Given {
    /// Takes the table from the file.
    fn take(root: &mut Table, name: &str) -> Self {
        let is_table = root.get(name).is_some_and(Item::is_table_like);
        Self { table: if is_table { root.remove(name) } else { None }, is_used: Cell::new(false) }
    }

    /// Takes a field, with its key.
    fn field(&mut self, name: &str) -> Option<(Key, Item)> {
        let table = self.table.as_mut()?.as_table_like_mut()?;
        Some((table.key(name)?.clone(), table.remove(name)?))
    }

    /// Puts values back that no law has taken.
    fn put_back(self, root: &mut Table, name: &str) {
        let is_left =
            |table: &Item| !self.is_used.get() && table.as_table_like().is_some_and(|table| !table.is_empty());
        if let Some(table) = self.table.filter(is_left) {
            root.insert(name, table);
        }
    }
}

/// A law that the program adds.
struct Own {
    name: String,
    parameters: Option<Item>,
    /// The comment above its table.
    comment: String,
}

impl Own {
    fn of(law: &Item) -> Option<Self> {
        let name = law.get("name")?.as_str()?.to_owned();
        let prefix = law.as_table().and_then(|table| table.decor().prefix()?.as_str()).unwrap_or_default();
        Some(Self {
            name,
            parameters: law.get("parameters").cloned(),
            comment: prefix.trim_start_matches('\n').to_owned(),
        })
    }
}

fn rewrite(root: &mut Table) {
    let own = root.get("law").and_then(Own::of);
    if own.is_some() {
        root.remove("law");
    }
    let (mut route, mut formation) = (Given::take(root, "route"), Given::take(root, "formation"));
    let sort = formation.field("law");
    let sort = formation_law(sort.as_ref().and_then(|(_, law)| law.as_str()).unwrap_or_default());
    if let Some((key, radius)) = route.field("radius") {
        put(part(root, "grid"), &key, radius);
    }
    if let Some((key, rho)) = formation.field("rho") {
        for_shapes(root, &mut |shape| put(shape, &key, rho.clone()));
    }
    let old = Old { own, route, formation, sort };
    let in_formation = root.get("robots").is_some_and(|robots| robots.get("formation").is_some());
    match root.get_mut("plane").and_then(Item::as_table_like_mut) {
        Some(plane) => {
            group(plane, &old, "waypoint");
            let groups = plane.get_mut("group");
            for_each(groups, &mut |table| group(table, &old, ""));
        }
        None => {
            let (had_grid, usual) = (root.contains_key("grid"), if in_formation { old.sort } else { "route" });
            let grid = part(root, "grid");
            if in_formation && old.sort != "formation" {
                let _ = grid.insert("law", value(old.sort));
            }
            group(grid, &old, usual);
            if !had_grid && grid.is_empty() {
                root.remove("grid");
            }
        }
    }
    old.route.put_back(root, "route");
    old.formation.put_back(root, "formation");
}

/// Gives a group its law, with the values of its table. `usual`: the law of a group without one.
fn group(group: &mut dyn TableLike, old: &Old, usual: &str) {
    if let Some(Own { name, parameters, comment }) = &old.own {
        // It was the law of all robots, whatever their guidance; groups inherit it.
        for field in ["guidance", "lattice", "goal_flock", "boids"] {
            let _ = group.remove(field);
        }
        if usual.is_empty() {
            return;
        }
        put(group, &Key::new("law").with_leaf_decor(Decor::new(comment, " ")), value(name));
        if let Some(parameters) = parameters {
            let _ = group.insert(name, parameters.clone());
        }
        return;
    }
    rename(group, "guidance", "law");
    for table in ["lattice", "goal_flock"] {
        if let Some(values) = group.get_mut(table).and_then(Item::as_table_like_mut) {
            let names: Vec<String> = values.iter().map(|(name, _)| name.to_owned()).collect();
            names.iter().for_each(|name| rename(values, name, &renamed_value(table, name)));
        }
    }
    let law = group.get("law").and_then(Item::as_str).unwrap_or(usual).to_owned();
    let tables: &[&Given] = match law.as_str() {
        "route" => &[&old.route],
        "formation" | "formation_paper" | "formation_lookahead" => &[&old.formation, &old.route],
        _ => &[],
    };
    for given in tables {
        given.is_used.set(true);
        let values = given.table.as_ref().and_then(Item::as_table_like).filter(|values| !values.is_empty());
        let Some(values) = values else { continue };
        if group.get(&law).is_none()
            && let Some(Item::Table(table)) = &given.table
        {
            // With the place and the comments of its header.
            let mut header = table.clone();
            header.clear();
            let _ = group.insert(&law, Item::Table(header));
        }
        let into = part(group, &law);
        for (name, value) in values.iter() {
            let decor = values.key(name).map(|key| key.leaf_decor().clone()).unwrap_or_default();
            put(into, &Key::new(renamed_value(&law, name)).with_leaf_decor(decor), value.clone());
        }
    }
}

/// Inserts a field with the comments of its key.
fn put(table: &mut dyn TableLike, key: &Key, item: Item) {
    let _ = table.insert(key.get(), item);
    if let Some(mut inserted) = table.key_mut(key.get()) {
        inserted.leaf_decor_mut().clone_from(key.leaf_decor());
    }
}

/// The table of this name, which is made if there is none.
fn part<'t>(table: &'t mut dyn TableLike, name: &str) -> &'t mut dyn TableLike {
    if table.get(name).is_none() {
        let mut new = Table::new();
        // No header for a table that holds tables alone.
        new.set_implicit(true);
        let _ = table.insert(name, Item::Table(new));
    }
    let part = table.get_mut(name).and_then(Item::as_table_like_mut);
    part.unwrap_or_else(|| unreachable!("{name} is a table"))
}

/// Calls `change` with a table, or with each of a list of tables.
fn for_each(item: Option<&mut Item>, change: &mut dyn FnMut(&mut dyn TableLike)) {
    match item {
        Some(Item::ArrayOfTables(list)) => list.iter_mut().for_each(|table| change(table)),
        Some(Item::Value(toml_edit::Value::Array(list))) => {
            list.iter_mut().filter_map(|value| value.as_inline_table_mut()).for_each(|table| change(table));
        }
        Some(item) => item.as_table_like_mut().into_iter().for_each(change),
        None => {}
    }
}

/// Calls `give` with the shape of each formation.
fn for_shapes(root: &mut Table, give: &mut dyn FnMut(&mut dyn TableLike)) {
    for_each(root.get_mut("robots").and_then(|robots| robots.get_mut("formation")), give);
    let groups = root.get_mut("plane").and_then(|plane| plane.get_mut("group"));
    for_each(groups, &mut |group| {
        for_each(group.get_mut("robots").and_then(|robots| robots.get_mut("formation")), give);
    });
}

/// Gives a field another name, in its place and with its comments.
fn rename(table: &mut dyn TableLike, old: &str, new: &str) {
    if old == new || table.get(old).is_none() {
        return;
    }
    let names: Vec<String> = table.iter().map(|(name, _)| name.to_owned()).collect();
    for name in names {
        let Some(key) = table.key(&name).cloned() else { continue };
        let Some(item) = table.remove(&name) else { continue };
        let renamed = if name == old { Key::new(new).with_leaf_decor(key.leaf_decor().clone()) } else { key };
        put(table, &renamed, item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(old: &str) -> String {
        let new = migrated(old).expect("TOML").expect("changes");
        assert_eq!(migrated(&new).expect("TOML"), None, "a second time");
        new
    }

    /// The values, whatever their order and their tables look like.
    fn same(text: &str) -> Vec<String> {
        fn add(path: &str, table: &dyn TableLike, all: &mut Vec<String>) {
            for (name, item) in table.iter() {
                let path = format!("{path}.{name}");
                match (item.as_table_like(), item) {
                    (Some(table), _) => add(&path, table, all),
                    (None, Item::ArrayOfTables(list)) => list.iter().for_each(|table| add(&path, table, all)),
                    (None, item) => all.push(format!("{path} = {}", item.to_string().trim())),
                }
            }
        }
        let (file, mut all): (DocumentMut, _) = (text.parse().expect("TOML"), Vec::new());
        add("", file.as_table(), &mut all);
        all.sort();
        all
    }

    #[test]
    fn a_scenario_of_today_does_not_change() {
        for text in ["", "name = \"a\" # b\n[plane]\nlaw   = \"route\"\n[plane.route]\na3 = 2\n"] {
            assert_eq!(migrated(text).expect("TOML"), None, "{text}");
        }
    }

    #[test]
    fn the_files_of_this_project_are_of_today() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut count = 0;
        for folder in ["scenarios", "companions", "papers/olf/flock", "papers/kuz/figure-6"] {
            for file in std::fs::read_dir(root.join(folder)).expect("a folder") {
                let path = file.expect("a file").path();
                if path.extension().is_some_and(|extension| extension == "toml") {
                    let text = std::fs::read_to_string(&path).expect("a text");
                    assert_eq!(migrated(&text).expect("TOML"), None, "{}", path.display());
                    count += 1;
                }
            }
        }
        assert!(count > 40, "{count} files");
    }

    #[test]
    fn a_law_keeps_its_place_and_its_comment() {
        let old = "[plane]\nradius_m = 1\nguidance = \"lattice\" # a flock\nsafety = \"none\"\n\n# Gains.\n[plane.lattice]\n\
                   spacing_m = 1\nc_alpha = 3 # soft\n";
        let expected = old.replace("guidance", "law").replace("c_alpha", "c1_alpha");
        assert_eq!(new(old), expected);
    }

    #[test]
    fn tables_of_the_grid_belong_to_its_law() {
        let old = "[robots.formation]\nrows = 2\n\n# The paper's.\n[formation]\nlaw = \"paper\"\nrho = 1\neps = 3\n\n[route]\n\
                   radius = 4\nhalved_per_ticks = 0.5\n";
        let expected = "[robots.formation]\nrows = 2\nrho = 1\n\n# The paper's.\n[grid.formation_paper]\neps_cells = 3\n\
                        halved_per_ticks = 0.5\n\n[grid]\nradius = 4\nlaw = \"formation_paper\"\n";
        assert_eq!(same(&new(old)), same(expected));
    }

    #[test]
    fn nothing_is_lost_that_has_no_place_today() {
        for text in ["grid = 3\n[route]\na3 = 2\n", "law = 3\n", "route = 3\n", "[law]\nparameters = { a = 1 }\n"] {
            assert_eq!(migrated(text).expect("TOML"), None, "{text}");
        }
        let unused = "[plane]\nlaw = \"boids\"\n[route]\na3 = 2\n";
        assert_eq!(same(&migrated(unused).expect("TOML").unwrap_or(unused.to_owned())), same(unused));
    }

    #[test]
    fn an_own_law_replaces_the_guidance_of_all_robots() {
        let old = "law.name = \"convoy\"\nlaw.parameters.gap_m = 2\n[plane]\nguidance = \"boids\"\n[plane.boids]\ncrowded_m = 1\n\
                   [[plane.group]]\nguidance = \"route\"\nradius_m = 1\n";
        let expected = "[plane]\nlaw = \"convoy\"\nconvoy = { gap_m = 2 }\n[[plane.group]]\nradius_m = 1\n";
        assert_eq!(same(&new(old)), same(expected));
    }
}
