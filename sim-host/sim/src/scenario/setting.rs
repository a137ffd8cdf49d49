//! Settings that replace fields of a scenario file: `radio.loss=0.3`.

use super::{Field, Overrides, Scenario, ScenarioError, Source};
use crate::file::{TEXT, read_text};
use std::path::Path;
use std::str::FromStr;
use toml::Value;

/// A field path with its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    field: Field,
    value: Value,
}

impl FromStr for Setting {
    type Err = String;

    /// Parses `FIELD=VALUE` with a TOML value; other text is a string, for use in shells.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("give FIELD=VALUE, as in radio.loss=0.3")?;
        let name = name.trim();
        let field = Field::read(name)
            .ok_or_else(|| format!("{name:?} names no field; give one as in radio.loss or plane.group[0].count"))?;
        let table = format!("value = {value}").parse::<toml::Table>().ok();
        let value = match table.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value")) {
            Some(value) => value,
            None => Value::String(value.trim().to_owned()),
        };
        Ok(Self { field, value })
    }
}

impl Scenario {
    /// Like [`Scenario::load`], with settings applied.
    ///
    /// # Errors
    /// See [`Scenario::load`]; also two settings of one field. The line is that of the field in the
    /// file, if it is there.
    pub fn load_with(path: &Path, overrides: &Overrides, settings: &[Setting]) -> Result<Self, ScenarioError> {
        Self::parse_with(&read(path)?, path, overrides, settings)
    }

    /// Like [`Scenario::load_with`], for the text of a file `path` that need not exist.
    ///
    /// # Errors
    /// See [`Scenario::load_with`].
    pub fn parse_with(
        text: &str,
        path: &Path,
        overrides: &Overrides,
        settings: &[Setting],
    ) -> Result<Self, ScenarioError> {
        if settings.is_empty() {
            return Self::build(text, path, overrides, 0);
        }
        let source = Source::new(path, text)?;
        let ticks = source.root().get("ticks").and_then(|ticks| ticks.get_ref().as_integer());
        let ticks = ticks.and_then(|ticks| u32::from_str_radix(ticks.as_str(), ticks.radix()).ok());
        Self::build(&set(&source, settings)?, path, overrides, ticks.unwrap_or_default()).map_err(|error| match error {
            ScenarioError::Field { field, what, remedy, .. } => {
                let is_set = settings.iter().any(|setting| is_about(&field, setting.field.name()));
                let by = if is_set { " (by --set)" } else { "" };
                source.error(&field, format!("{what}{by}"), remedy)
            }
            error @ ScenarioError::Io { .. } => error,
        })
    }
}

/// Reads a scenario file and applies settings. Without settings, the text is unchanged.
///
/// # Errors
/// The file cannot be read, is not TOML, or has another value where a table of the field should be.
pub fn text_with(path: &Path, settings: &[Setting]) -> Result<String, ScenarioError> {
    let text = read(path)?;
    if settings.is_empty() { Ok(text) } else { with_settings(&text, path, settings) }
}

/// Applies settings to a scenario's text; comments are lost. `path` appears in errors.
///
/// # Errors
/// See [`text_with`].
pub fn with_settings(text: &str, path: &Path, settings: &[Setting]) -> Result<String, ScenarioError> {
    set(&Source::new(path, text)?, settings)
}

fn read(path: &Path) -> Result<String, ScenarioError> {
    read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })
}

fn set(source: &Source<'_>, settings: &[Setting]) -> Result<String, ScenarioError> {
    let mut table: toml::Table =
        source.text().parse().map_err(|error: toml::de::Error| source.error("", error.message(), "check the file"))?;
    for (index, Setting { field, value }) in settings.iter().enumerate() {
        if settings[index + 1..].iter().any(|later| is_below(field.name(), later.field.name())) {
            return Err(source.error(field.name(), "it is set twice (by --set)", "give one --set of this field"));
        }
        field.set(&mut table, value.clone()).map_err(|what| {
            source.error(field.name(), format!("{what} (by --set)"), "name a field as the scenario's file has it")
        })?;
    }
    Ok(toml::to_string(&table).unwrap_or_default())
}

/// Whether `field` is `above`, or a part of it.
fn is_below(field: &str, above: &str) -> bool {
    field.strip_prefix(above).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

fn is_about(field: &str, set: &str) -> bool {
    !field.is_empty() && (is_below(field, set) || is_below(set, field))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENARIO: &str = "name = 't'\nticks = 5\n\n[terrain]\nuniform = { width = 9, height = 9, classes = 1 }\n\n[radio]\nloss = 0.1\n\n\
        [[robots.list]]\nid = 1\nstart = [0, 0]\ngoal = [5, 5]\n";

    fn load(settings: &[&str]) -> Result<Scenario, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.toml");
        std::fs::write(&path, SCENARIO).expect("written");
        let settings: Vec<Setting> = settings.iter().map(|text| text.parse().expect("a setting")).collect();
        Scenario::load_with(&path, &Overrides::default(), &settings)
            .map_err(|error| error.to_string().replace(&format!("{}", path.display()), "t.toml"))
    }

    #[test]
    fn a_field_is_set_once() {
        assert_eq!(load(&[]).expect("sound").ticks, 5);
        let set = load(&["ticks=7", "radio.range_m = 3.5", "name=other", "robots.list[0].goal=[6, 5]"]);
        let set = set.expect("sound");
        assert_eq!((set.ticks, set.radio.range_m, &*set.name), (7, 3.5, "other"));
        assert_eq!((set.robots[0].goal.x, set.radio.loss), (6, 0.1));
        let part = load(&["radio={ loss = 0.3 }", "radio.range_m=2"]).expect("a table, then a field of it");
        assert_eq!((part.radio.loss, part.radio.range_m), (0.3, 2.0));
        for settings in [["radio.loss=0.2", " radio.loss = 0.2"], ["radio.loss=0.2", "radio={ loss = 0.3 }"]] {
            let error = load(&settings).expect_err("twice");
            assert_eq!(error, "t.toml:8: radio.loss: it is set twice (by --set); give one --set of this field");
        }
    }

    #[test]
    fn errors_name_the_line_and_the_setting() {
        let error = |settings: &[&str]| load(settings).expect_err("wrong");
        let loss = error(&["radio.loss=1.5"]);
        assert!(loss.starts_with("t.toml:8: radio.loss: ") && loss.contains("(by --set)"), "{loss}");
        let unknown = error(&["radio.lost=1"]);
        assert!(unknown.contains("lost") && unknown.contains("scenarios/README.md"), "{unknown}");
        let none = error(&["robots.list[1].goal=[1, 1]"]);
        assert!(none.contains("list has 1 elements, counted from 0 (by --set)"), "{none}");
        let word = error(&["ticks=many"]);
        assert!(word.contains("ticks") && word.contains("is not a whole number"), "{word}");
        // Errors in the file itself are not attributed to the command line.
        let other = error(&["radio.range_m=5", "robots.list[0].start=[99, 0]"]);
        assert!(other.contains("robots.list[0].start"), "{other}");
    }

    #[test]
    fn text_with_settings_parses_to_the_same_scenario() {
        let settings = ["ticks=7", "radio.loss=0.25"].map(|text| text.parse().expect("a setting"));
        let (path, none) = (Path::new("t.toml"), Overrides::default());
        let set = Scenario::parse_with(SCENARIO, path, &none, &settings).expect("sound");
        assert_eq!((set.ticks, set.radio.loss), (7, 0.25));
        let text = with_settings(SCENARIO, path, &settings).expect("a scenario");
        let read = Scenario::parse(&text, path, &none).expect("sound");
        assert_eq!((read.ticks, read.radio.loss), (7, 0.25));
        let wrong = ["radio.loss=2".parse().expect("a setting")];
        let error = Scenario::parse_with(SCENARIO, path, &none, &wrong).expect_err("wrong").to_string();
        assert!(error.starts_with("t.toml:8: radio.loss: ") && error.contains("(by --set)"), "{error}");
    }

    #[test]
    fn settings_are_parsed_as_toml_or_as_strings() {
        let value = |text: &str| text.parse::<Setting>().map(|setting| setting.value);
        assert_eq!(value("a.b=3"), Ok(Value::Integer(3)));
        assert_eq!(value("a=0.5"), Ok(Value::Float(0.5)));
        assert_eq!(value("a=true"), Ok(Value::Boolean(true)));
        assert_eq!(value("a='3'"), Ok(Value::String("3".to_owned())));
        assert_eq!(value("a=x = 3"), Ok(Value::String("x = 3".to_owned())));
        assert_eq!(value("a=1\nb=2"), Ok(Value::String("1\nb=2".to_owned())));
        assert_eq!(value("a="), Ok(Value::String(String::new())));
        assert!(value("a").is_err_and(|what| what.contains("FIELD=VALUE")));
        assert!(value("a..b=1").is_err_and(|what| what.contains("names no field")));
    }
}
