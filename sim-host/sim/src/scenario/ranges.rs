//! Range checks and conversions shared by several tables.

pub(super) use super::de::short;
use super::source::{ScenarioError, Source};

pub(super) fn micros(seconds: f64) -> u32 {
    libm::round(seconds * 1e6) as u32
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
