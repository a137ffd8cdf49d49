//! Groups inherit fields of `[plane]`.

use super::super::law::LawPart;
use super::super::layer::{section, sections};
use super::super::table::Fields as _;
use super::table::BodyTable;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Gives each `[[plane.group]]` the fields of `[plane]` that it lacks, with their places in the
/// text. It gets the table of a law or a safety layer only if its own is the same. O(groups).
pub fn inherit(root: &mut DeTable<'_>) {
    let Some(DeValue::Table(plane)) = root.get_mut("plane").map(Spanned::get_mut) else { return };
    let names = BodyTable::names();
    let general: Vec<_> = plane.iter().filter(|(key, _)| names.contains(&key.get_ref().as_ref())).collect();
    let general: Vec<_> = general.into_iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    let general_of = |name: &str| general.iter().find(|(key, _)| key.get_ref() == name)?.1.get_ref().as_str();
    let (law, layer) = (general_of("law"), section(general_of("safety").unwrap_or("orca")));
    let Some(DeValue::Array(groups)) = plane.get_mut("group").map(Spanned::get_mut) else { return };
    for group in groups.iter_mut() {
        let DeValue::Table(group) = group.get_mut() else { continue };
        let own = |name: &str| group.get(name).and_then(|value| value.get_ref().as_str());
        let has_law = own("law").is_none_or(|own| Some(own) == law);
        let has_layer = own("safety").is_none_or(|own| section(own) == layer);
        for (key, value) in &general {
            let is_inherited = match key.get_ref().as_ref() {
                name if sections().contains(&name) => has_layer,
                name => has_law || !LawPart::<false>::names().contains(&name),
            };
            if is_inherited && !group.contains_key(key.get_ref().as_ref()) {
                group.insert(key.clone(), value.clone());
            }
        }
    }
}
