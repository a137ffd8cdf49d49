//! A table of a settings file, by the present names of its fields.

use super::{Field, Limits, Node, Wrong, listed, word};
use toml::de::{DeTable, DeValue};

/// A table that is being read.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    node: &'a Node<'a>,
    table: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// The fields of `node`.
    ///
    /// # Errors
    /// It is not a table, or has a field that is not `known`.
    pub fn new(node: &'a Node<'a>, known: &[&'static str]) -> Result<Self, Wrong> {
        let fields = Self::any(node)?;
        // The table of a law that does not exist: the error is about the law.
        let law = known.contains(&"law").then(|| fields.table.get("law")?.get_ref().as_str()).flatten();
        let is_known = |name: &str| known.contains(&present(name)) || Some(name) == law;
        let Some((key, _)) = fields.table.iter().find(|(key, _)| !is_known(key.get_ref())) else {
            return Ok(fields);
        };
        let name = key.get_ref();
        let mut wrong = Wrong::unknown("field", name, known, "this table has").at(key.span());
        if let Some((_, new)) = RENAMED.iter().find(|(old, new)| old == name && known.contains(new)) {
            wrong.remedy = Some(format!("the field is called `{new}` now"));
        }
        Err(wrong.under(name))
    }

    /// The fields of `node`, whatever they are called.
    ///
    /// # Errors
    /// It is not a table.
    pub fn any(node: &'a Node<'a>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::Table(table) => Ok(Self { node, table }),
            _ => Err(Wrong::not(node, "a table")),
        }
    }

    /// Reads a field whose numbers are within a range. `None`: it is absent and has no value then.
    ///
    /// # Errors
    /// See [`Field::read`].
    pub fn read<T: Field>(&self, name: &str, limits: Option<&Limits>) -> Result<Option<T>, Wrong> {
        let Some((key, node)) = self.field(name) else { return Ok(T::absent()) };
        match T::read(node) {
            Ok(value) => within(node, limits).map(|()| Some(value)),
            Err(wrong) => Err(wrong),
        }
        .map_err(|wrong| wrong.under(key))
    }

    fn field(&self, name: &str) -> Option<(&'a str, &'a Node<'a>)> {
        let found = self.table.iter().find(|(key, _)| present(key.get_ref()) == name);
        found.map(|(key, node)| (key.get_ref().as_ref(), node))
    }

    /// Reads the value of a field by `read`; an error carries the field's place.
    ///
    /// # Errors
    /// Those of `read`; also a missing field.
    pub fn of<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Result<T, Wrong>) -> Result<T, Wrong> {
        let Some((key, node)) = self.table.iter().find(|(key, _)| key.get_ref() == name) else {
            return Err(self.missing(name));
        };
        read(node).map_err(|wrong| wrong.under(key.get_ref()))
    }

    /// Whether a field is there.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.table.keys().any(|key| present(key.get_ref()) == name)
    }

    /// Reads a field that must be there.
    ///
    /// # Errors
    /// It is missing, or see [`Field::read`].
    pub fn need<T: Field>(&self, name: &str) -> Result<T, Wrong> {
        self.read(name, None)?.ok_or_else(|| self.missing(name))
    }

    /// Reads the field `kind` and checks that the others are those of this kind.
    ///
    /// # Errors
    /// See [`Field::read`]; also an unknown kind.
    pub fn kind<K: Copy>(
        node: &'a Node<'a>,
        kinds: &[(&'static str, (K, &[&'static str]))],
    ) -> Result<(K, Self), Wrong> {
        let table = Self::any(node)?;
        let Some((key, kind)) = table.table.get_key_value("kind") else { return Err(table.missing("kind")) };
        let (kind, known) = word(kind, kinds).map_err(|wrong| wrong.under(key.get_ref()))?;
        Ok((kind, Self::new(node, known)?))
    }

    /// The error about a table that has none of several fields, or more than one.
    #[must_use]
    pub fn unclear(&self, names: &[&str]) -> Wrong {
        let mut given: Vec<_> = self.table.keys().filter(|key| names.contains(&key.get_ref().as_ref())).collect();
        given.sort_by_key(|key| key.span().start);
        let wrong = match given[..] {
            [first, key, ..] => {
                Wrong::about(format!("`{}` is given, too", first.get_ref())).at(key.span()).under(key.get_ref())
            }
            _ => Wrong::new(self.node, "a field is missing"),
        };
        Wrong { remedy: Some("give exactly one of ".to_owned() + &listed(names)), ..wrong }
    }

    /// The error about a missing field.
    #[must_use]
    pub fn missing(&self, name: &str) -> Wrong {
        Wrong::new(self.node, format!("missing field `{name}`"))
    }
}

fn within(node: &Node<'_>, limits: Option<&Limits>) -> Result<(), Wrong> {
    limits.map_or(Ok(()), |limits| limits.check_node(node))
}

/// Earlier names of fields, each with the present one.
const RENAMED: [(&str, &str); 16] = [
    ("eyes", "sensing"),
    ("claims", "plausibility"),
    ("remember_s", "stands_after_s"),
    // Of behaviours alone.
    ("margin", "margin_m"),
    ("spacing", "spacing_m"),
    ("alpha", "c1_alpha"),
    ("beta", "c1_beta"),
    ("gamma", "c1_gamma"),
    ("min_distance", "min_distance_m"),
    ("neighborhood", "neighborhood_m"),
    ("goal_gain", "k1"),
    ("center_gain", "k2"),
    ("repulsion_gain", "k3"),
    ("speed", "speed_mps"),
    ("crowded", "crowded_m"),
    ("closest", "closest_m"),
];

/// Present name of a field that has another one in older files.
fn present(name: &str) -> &str {
    match name {
        "doubt_mps" => "inflation_mps",
        "doubt_m" => "inflation_m",
        name => name,
    }
}
