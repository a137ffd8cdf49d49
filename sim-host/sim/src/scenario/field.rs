//! Paths of scenario fields, with a function that sets them.

use super::read::Node;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Path of a field, such as `radio.loss` or `plane.group[0].count`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    name: String,
    /// Table names down to the field, each with the list indices that follow it.
    steps: Vec<(String, Vec<usize>)>,
}

impl Field {
    /// Parses a path; `None` if it is malformed.
    pub fn read(name: &str) -> Option<Self> {
        let steps = name.split('.').map(|step| {
            let (name, places) = step.split_at(step.find('[').unwrap_or(step.len()));
            let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
            let places = places.split_inclusive(']').map(|place| {
                let digits = place.strip_prefix('[')?.strip_suffix(']')?;
                digits.parse().ok().filter(|place: &usize| place.to_string() == digits)
            });
            let places = places.collect::<Option<Vec<usize>>>()?;
            (!name.is_empty() && name.chars().all(is_name)).then(|| (name.to_owned(), places))
        });
        Some(Self { name: name.to_owned(), steps: steps.collect::<Option<_>>()? })
    }

    /// The path as text.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether `field` is this field or a part of it.
    pub fn has(&self, field: &str) -> bool {
        is_below(field, &self.name)
    }

    /// Whether `field` is this field, a part of it, or a table with it.
    pub fn is_about(&self, field: &str) -> bool {
        !field.is_empty() && (is_below(field, &self.name) || is_below(&self.name, field))
    }

    /// Sets the field and creates missing tables. Its place is that of the replaced value or else
    /// of the table. The error says what is in the way.
    pub(super) fn set<'a>(&self, root: &mut DeTable<'a>, to: DeValue<'a>) -> Result<(), String> {
        let Some(((last, places), tables)) = self.steps.split_last() else {
            return Err("it has no name".to_owned());
        };
        let (mut table, mut span) = (root, 0..0);
        for (name, places) in tables {
            let key = Spanned::new(span.clone(), name.clone().into());
            let entry = table.entry(key).or_insert_with(|| Spanned::new(span, DeValue::Table(DeTable::new())));
            let node = element(entry, name, places)?;
            span = node.span();
            let DeValue::Table(inner) = node.get_mut() else {
                return Err(format!("{name} is not a table in the scenario"));
            };
            table = inner;
        }
        if places.is_empty() {
            let span = table.get(last.as_str()).map_or(span, Spanned::span);
            let key = Spanned::new(span.clone(), last.clone().into());
            table.insert(key, moved(to, &span));
            return Ok(());
        }
        let list = table.get_mut(last.as_str()).ok_or_else(|| format!("{last} is not in the scenario"))?;
        let node = element(list, last, places)?;
        *node = moved(to, &node.span());
        Ok(())
    }
}

fn element<'t, 'a>(mut node: &'t mut Node<'a>, name: &str, places: &[usize]) -> Result<&'t mut Node<'a>, String> {
    for &place in places {
        let DeValue::Array(list) = node.get_mut() else {
            return Err(format!("{name} is not a list in the scenario"));
        };
        let count = list.len();
        node = list.get_mut(place).ok_or_else(|| format!("{name} has {count} elements, counted from 0"))?;
    }
    Ok(node)
}

/// A value of another text with all its parts at `span`.
fn moved<'a>(value: DeValue<'a>, span: &Range<usize>) -> Node<'a> {
    let inner = |node: Node<'a>| moved(node.into_inner(), span);
    let value = match value {
        DeValue::Array(list) => DeValue::Array(list.into_iter().map(inner).collect()),
        DeValue::Table(table) => {
            let entry = |(key, node): (Spanned<_>, _)| (Spanned::new(span.clone(), key.into_inner()), inner(node));
            DeValue::Table(table.into_iter().map(entry).collect())
        }
        value => value,
    };
    Spanned::new(span.clone(), value)
}

/// Whether `field` is `above`, or a part of it.
fn is_below(field: &str, above: &str) -> bool {
    field.strip_prefix(above).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

impl Display for Field {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

#[cfg(test)]
mod tests;
