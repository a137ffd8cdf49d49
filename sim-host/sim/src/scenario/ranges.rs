//! Range checks and conversions shared by several tables.

use super::source::{ScenarioError, Source};

pub(super) fn micros(seconds: f64) -> u32 {
    libm::round(seconds * 1e6) as u32
}

/// Formats a number for an error text: huge and tiny numbers have an exponent.
pub(super) fn short(value: f64) -> String {
    let has_few_digits = value == 0.0 || (1e-6..1e12).contains(&value.abs()) || !value.is_finite();
    if has_few_digits { value.to_string() } else { format!("{value:e}") }
}

/// Checks that `low <= value <= high`.
///
/// # Errors
/// Names the field and the range.
pub fn within(
    source: &Source<'_>,
    field: &str,
    value: f64,
    low: f64,
    high: f64,
    unit: &str,
) -> Result<(), ScenarioError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let what = format!("{} is out of range", short(value));
    Err(source.error(field, what, format!("give {} to {} {unit}", short(low), short(high)).trim_end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_and_tiny_numbers_have_an_exponent() {
        for (value, text) in [
            (1e308, "1e308"),
            (-2.5e-9, "-2.5e-9"),
            (600_000.0, "600000"),
            (0.0, "0"),
            (-1.5, "-1.5"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
