//! Paths of scenario fields, with functions that read and set them.

use std::fmt::{self, Display, Formatter};
use toml::Value;

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

    /// Value of the field in `scenario`; `None` if it is absent.
    pub fn get<'a>(&self, scenario: &'a toml::Table) -> Option<&'a Value> {
        let mut table = Some(scenario);
        let mut value = None;
        for (name, places) in &self.steps {
            value = table?.get(name);
            for &place in places {
                value = value?.get(place);
            }
            table = value?.as_table();
        }
        value
    }

    /// Sets the field and creates missing tables. The error says what is in the way.
    pub fn set(&self, scenario: &mut toml::Table, to: Value) -> Result<(), String> {
        let Some(((last, places), tables)) = self.steps.split_last() else {
            return Err("it has no name".to_owned());
        };
        let mut table = scenario;
        for (name, places) in tables {
            let entry = table.entry(name).or_insert_with(|| Value::Table(toml::Table::new()));
            table = element(entry, name, places)?
                .as_table_mut()
                .ok_or_else(|| format!("{name} is not a table in the scenario"))?;
        }
        if places.is_empty() {
            table.insert(last.clone(), to);
            return Ok(());
        }
        let list = table.get_mut(last).ok_or_else(|| format!("{last} is not in the scenario"))?;
        *element(list, last, places)? = to;
        Ok(())
    }
}

fn element<'a>(mut value: &'a mut Value, name: &str, places: &[usize]) -> Result<&'a mut Value, String> {
    for &place in places {
        let list = value.as_array_mut().ok_or_else(|| format!("{name} is not a list in the scenario"))?;
        let count = list.len();
        value = list.get_mut(place).ok_or_else(|| format!("{name} has {count} elements, counted from 0"))?;
    }
    Ok(value)
}

impl Display for Field {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENARIO: &str = "ticks = 5\n[plane]\nradius_m = 1\n[[plane.group]]\nfrom_m = [1, 2]\n[[plane.group]]\n";

    fn set(name: &str) -> Result<toml::Table, String> {
        let mut scenario = SCENARIO.parse().expect("TOML");
        Field::read(name).expect("a name").set(&mut scenario, Value::Integer(7)).map(|()| scenario)
    }

    #[test]
    fn a_field_is_found_set_and_made() {
        for name in ["ticks", "plane.radius_m", "plane.group[1].count", "radio.burst.share", "plane.group[0].from_m[1]"]
        {
            let changed = set(name).unwrap_or_else(|what| panic!("{name}: {what}"));
            assert_eq!(Field::read(name).and_then(|field| field.get(&changed).cloned()), Some(Value::Integer(7)));
            let mut before: toml::Table = SCENARIO.parse().expect("TOML");
            Field::read(name).expect("a name").set(&mut before, Value::Integer(7)).expect("a place");
            assert_eq!(before, changed);
        }
        let scenario = SCENARIO.parse().expect("TOML");
        assert_eq!(Field::read("plane.group[2].count").expect("a name").get(&scenario), None);
    }

    #[test]
    fn an_obstruction_on_the_path_is_named() {
        for (name, what) in [
            ("plane.group[2].count", "group has 2 elements, counted from 0"),
            ("plane.radius_m.x", "radius_m is not a table in the scenario"),
            ("ticks[0]", "ticks is not a list in the scenario"),
            ("plane.order[0]", "order is not in the scenario"),
            ("order[0].at_s", "order is not a list in the scenario"),
        ] {
            assert_eq!(set(name).expect_err(name), what);
        }
    }

    #[test]
    fn malformed_paths_are_refused() {
        for bad in ["", ".", "a.", "a[", "a[]", "a[-1]", "a[+1]", "a[01]", "a]0[", "a b", "[0]", "a[0]b", "a..b"] {
            assert_eq!(Field::read(bad), None, "{bad:?}");
        }
    }
}
