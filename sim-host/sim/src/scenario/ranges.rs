//! Range checks and conversions shared by several tables.

pub(super) use super::de::short;
use super::source::{ScenarioError, Source};
use staya_controller::agent::Parameter;

pub(super) fn micros(seconds: f64) -> u32 {
    libm::round(seconds * 1e6) as u32
}

/// The values that an operator may give a parameter during a run, as decimal numbers.
pub(super) fn range(parameter: Parameter) -> [f64; 2] {
    // The nearest double of a float such as 0.001 is greater than the decimal number.
    parameter.range().map(|end| end.to_string().parse().unwrap_or(f64::from(end)))
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
