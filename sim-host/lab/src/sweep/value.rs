//! Values of scenario fields, and figures of runs.

use staya_sim::scenario::inline;
use staya_stats::Summary;
use std::fmt::{self, Display, Formatter};
use toml::de::DeValue;

/// Value of a scenario field or a table cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A whole number, for integer and floating-point fields.
    Whole(i64),
    /// Any other number.
    Number(f64),
    /// `true` or `false`.
    Truth(bool),
    /// A word or a file name.
    Word(String),
}

const EXACT: f64 = 9_007_199_254_740_992.0;

impl Value {
    pub(crate) fn read(value: &DeValue<'_>) -> Result<Self, String> {
        match value {
            DeValue::Integer(number) => {
                let number = i64::from_str_radix(number.as_str(), number.radix());
                number.map(Self::Whole).map_err(|_| format!("{} is too large", inline(value)))
            }
            DeValue::Float(number) => match number.as_str().parse() {
                Ok(number) if !f64::is_nan(number) => Ok(Self::Number(number)),
                _ => Err("nan is not a value".to_owned()),
            },
            DeValue::Boolean(truth) => Ok(Self::Truth(*truth)),
            DeValue::String(word) => {
                let is_cell = !word.is_empty() && !word.contains([',', '"']) && !word.contains(char::is_control);
                if is_cell { Ok(word.as_ref().into()) } else { Err(format!("{word:?} has no place in a table")) }
            }
            other => Err(format!("{} is neither a number nor a word", inline(other))),
        }
    }

    /// Parses a TOML value; other text is a word.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        match DeValue::parse(text) {
            Ok(value) => Self::read(value.get_ref()),
            Err(_) => Self::read(&DeValue::String(text.into())),
        }
    }

    pub(crate) fn of(number: f64) -> Self {
        let is_whole = libm::trunc(number) == number && number.abs() < EXACT;
        if is_whole { Self::Whole(number as i64) } else { Self::Number(number) }
    }

    /// The value as a number, if it is one.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Whole(number) => Some(*number as f64),
            Self::Number(number) => Some(*number),
            Self::Truth(_) | Self::Word(_) => None,
        }
    }

    /// The value as TOML.
    pub(crate) fn toml(&self) -> String {
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => format!("{number:?}"),
            Self::Truth(truth) => truth.to_string(),
            Self::Word(word) => inline(&DeValue::String(word.into())),
        }
    }
}

impl From<u32> for Value {
    fn from(number: u32) -> Self {
        Self::Whole(number.into())
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::of(number)
    }
}

impl From<bool> for Value {
    fn from(truth: bool) -> Self {
        Self::Truth(truth)
    }
}

impl From<&str> for Value {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl From<String> for Value {
    fn from(word: String) -> Self {
        Self::Word(word)
    }
}

impl Display for Value {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(number) => write!(f, "{number}"),
            Self::Number(number) => Figure(Some(*number)).fmt(f),
            Self::Truth(truth) => write!(f, "{truth}"),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// A figure in a table: the shortest text with the same bits, or empty if it is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure(pub Option<f64>);

impl Figure {
    /// Parses a cell; `None` if it is not a figure.
    #[must_use]
    pub fn read(cell: &str) -> Option<Self> {
        if cell.is_empty() { Some(Self(None)) } else { cell.parse().ok().map(|number| Self(Some(number))) }
    }
}

impl Display for Figure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            None => Ok(()),
            Some(number) => {
                let text = format!("{number:?}");
                f.write_str(text.strip_suffix(".0").unwrap_or(&text))
            }
        }
    }
}

/// A number with at most four decimals.
#[must_use]
pub fn short(number: f64) -> String {
    Figure(format!("{number:.4}").parse().ok()).to_string()
}

/// Figures of one point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Number of the point.
    pub number: u64,
    /// Values of the parameters.
    pub values: Vec<String>,
    /// Number of available runs.
    pub runs: usize,
    /// Measures of each run, in the order of the seeds; none of an impossible run.
    pub of_runs: Vec<Vec<Figure>>,
    /// Summary of each measure; `None` if no run has a value or one is infinite.
    pub figures: Vec<Option<Summary>>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_short_and_words_unquoted() {
        for (value, text) in [
            (Value::of(3.0), "3"),
            (Value::Number(3.0), "3"),
            (Value::of(-0.25), "-0.25"),
            (Value::Number(1e-7), "1e-7"),
            (Value::Number(f64::INFINITY), "inf"),
            (Value::Truth(true), "true"),
            (Value::Word("mavlink".into()), "mavlink"),
        ] {
            assert_eq!(value.to_string(), text);
        }
        for bad in ["a,b", "say \"so\"", "", "a\nb"] {
            assert!(Value::read(&DeValue::String(bad.into())).is_err(), "{bad:?}");
        }
        for bad in ["nan", "[]", "{}", "99999999999999999999"] {
            assert!(Value::parse(bad).is_err(), "{bad}");
        }
    }

    proptest! {
        #[test]
        fn figures_are_read_back_bit_for_bit(number in any::<f64>().prop_filter("has a value", |x| !x.is_nan())) {
            let read = Figure::read(&Figure(Some(number)).to_string()).and_then(|figure| figure.0);
            prop_assert_eq!(read.map(f64::to_bits), Some(number.to_bits()));
        }
    }
}
