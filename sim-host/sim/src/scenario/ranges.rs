//! Range checks and conversions shared by several tables.

use super::read::out_of;
pub(super) use super::read::short;
use super::source::{ScenarioError, Source};
use staya_controller::parameters::{Parameter, Parameters};

pub(super) fn micros(seconds: f64) -> u32 {
    libm::round(seconds * 1e6) as u32
}

/// Range of a parameter as decimal numbers: the nearest double of a float such as 0.001 is greater.
pub(super) fn range(row: &Parameter) -> [f64; 2] {
    row.range.map(|end| end.to_string().parse().unwrap_or(f64::from(end)))
}

/// The row of a table with this name.
///
/// # Panics
/// If the table does not have it.
pub(super) fn row(table: &'static [Parameter], name: &str) -> &'static Parameter {
    table.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no parameter {name}"))
}

/// The unit of a parameter in the words of error texts.
pub(super) fn unit(row: &Parameter) -> &'static str {
    match row.unit {
        "m" => "metres",
        "s" => "seconds",
        "rad" => "radians",
        unit => unit,
    }
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
    let (what, remedy) = out_of(value, &(low..=high), unit);
    Err(source.error(field, what, remedy))
}

/// Checks the value of `field` against the range of a parameter and stores it.
///
/// # Errors
/// Names the field and the range.
///
/// # Panics
/// If `params` do not have a parameter with this name.
pub(super) fn set(
    source: &Source<'_>,
    field: &str,
    value: Option<f64>,
    params: &mut dyn Parameters,
    name: &str,
) -> Result<(), ScenarioError> {
    let Some(value) = value else { return Ok(()) };
    let index = params.index(name).expect("the table has this parameter");
    let row = &params.table()[index];
    let [low, high] = range(row);
    within(source, field, value, low, high, unit(row))?;
    // The callers reject values that contradict each other.
    let _ = params.store(index, value as f32);
    Ok(())
}
