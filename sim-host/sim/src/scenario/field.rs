//! Paths of scenario fields, with a function that sets them.

use super::read::Node;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Path of a field, such as `radio.loss` or `plane.group[0].count`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field(String);

impl Field {
    /// Parses a path; `None` if it is malformed.
    pub fn read(name: &str) -> Option<Self> {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let is_index = |place: &str| {
            let digits = place.strip_prefix('[').and_then(|place| place.strip_suffix(']'));
            digits.is_some_and(|digits| digits.parse().is_ok_and(|index: usize| index.to_string() == digits))
        };
        let is_step = |step: &str| {
            let (name, indices) = step.split_at(step.find('[').unwrap_or(step.len()));
            !name.is_empty() && name.chars().all(is_name) && indices.split_inclusive(']').all(is_index)
        };
        name.split('.').all(is_step).then(|| Self(name.to_owned()))
    }

    /// The path through these tables to a field.
    pub(super) fn of(steps: &[&str]) -> Self {
        Self(steps.join("."))
    }

    /// The path as text.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// Whether `field` is this field or a part of it.
    pub fn has(&self, field: &str) -> bool {
        is_below(field, &self.0)
    }

    /// Whether `field` is this field, a part of it, or a table with it.
    pub fn is_about(&self, field: &str) -> bool {
        !field.is_empty() && (is_below(field, &self.0) || is_below(&self.0, field))
    }

    /// Sets the field and creates missing tables. Its place is that of the replaced value or else
    /// of the table. The error says what is in the way.
    pub(super) fn set<'a>(&self, root: &mut Node<'a>, to: DeValue<'a>) -> Result<(), String> {
        let (mut node, mut name) = (root, "");
        for step in self.0.split(['.', '[']) {
            let span = node.span();
            node = match (node.get_mut(), step.strip_suffix(']')) {
                (DeValue::Table(table), None) => {
                    let key = Spanned::new(span.clone(), step.to_owned().into());
                    table.entry(key).or_insert_with(|| Spanned::new(span, DeValue::Table(DeTable::new())))
                }
                (DeValue::Array(list), Some(index)) => {
                    let count = list.len();
                    let element = index.parse().ok().and_then(|index: usize| list.get_mut(index));
                    element.ok_or_else(|| format!("{name} has {count} elements, counted from 0"))?
                }
                (_, None) => return Err(format!("{name} is not a table in the scenario")),
                (_, Some(_)) => return Err(format!("{name} is not a list in the scenario")),
            };
            if !step.ends_with(']') {
                name = step;
            }
        }
        *node = moved(to, &node.span());
        Ok(())
    }
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
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests;
