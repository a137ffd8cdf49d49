//! Writes parsed fields as TOML text.

use toml::de::{DeTable, DeValue};

/// A whole file: plain fields, then a header for each table and each element of a list of tables.
pub(super) fn file(root: &DeTable<'_>) -> String {
    let (mut plain, mut tables) = (String::new(), String::new());
    for (name, node) in root {
        let name = key(name.get_ref());
        match node.get_ref() {
            DeValue::Table(table) => tables += &format!("\n[{name}]\n{}", lines(table)),
            DeValue::Array(list) if !list.is_empty() && list.iter().all(|node| node.get_ref().is_table()) => {
                let elements = list.iter().filter_map(|node| node.get_ref().as_table());
                tables.extend(elements.map(|table| format!("\n[[{name}]]\n{}", lines(table))));
            }
            value => plain += &format!("{name} = {}\n", inline(value)),
        }
    }
    plain + &tables
}

fn lines(table: &DeTable<'_>) -> String {
    fields(table).map(|field| field + "\n").collect()
}

/// `name = value` for each field.
pub fn fields(table: &DeTable<'_>) -> impl Iterator<Item = String> {
    table.iter().map(|(name, node)| format!("{} = {}", key(name.get_ref()), inline(node.get_ref())))
}

/// A value in one line.
pub fn inline(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Integer(value) => value.to_string(),
        DeValue::Float(value) => value.to_string(),
        DeValue::Datetime(value) => value.to_string(),
        DeValue::Array(list) => {
            let elements: Vec<_> = list.iter().map(|node| inline(node.get_ref())).collect();
            format!("[{}]", elements.join(", "))
        }
        DeValue::Table(table) => format!("{{ {} }}", fields(table).collect::<Vec<_>>().join(", ")),
    }
}

fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

/// A JSON string is a TOML string, except for the character that only TOML escapes.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}
