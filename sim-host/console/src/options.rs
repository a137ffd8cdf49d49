//! Options shared by several commands: named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use staya_controller::grid::Norm;
use staya_controller::names::Named;
use staya_sim::terrain::generate::Hills;

/// Name of a value on the command line and in reports, with dashes.
pub fn word(value: impl Named) -> String {
    value.name().replace('_', "-")
}

/// Parser of named values that lists them with their help.
pub fn one_of<T: Named + Send + Sync>(values: &'static [(T, &'static str)]) -> impl TypedValueParser<Value = T> {
    let possible = values.iter().map(|(value, help)| {
        let possible = PossibleValue::new(&*word(*value).leak()).alias(value.name());
        if help.is_empty() { possible } else { possible.help(*help) }
    });
    PossibleValuesParser::new(possible).map(|given| T::from_name(&given).expect("one of the possible values"))
}

/// Norm of the plane.
pub fn norm() -> impl TypedValueParser<Value = Norm> {
    one_of(&[(Norm::Euclidean, "A diagonal move is sqrt 2 long"), (Norm::Chebyshev, "A diagonal move is 1 long")])
}

/// Shape of natural terrain.
pub fn hills() -> impl TypedValueParser<Value = Hills> {
    one_of(&[
        (Hills::Even, "Impassability falls by one each cell"),
        (Hills::Rounded, "As even, with rounded distances"),
        (Hills::Wide, "Impassability falls by one every second cell"),
        (Hills::Added, "Impassability falls by one each cell, overlapping hills add up"),
        (Hills::Rough, "Impassability falls by a random 0 to 2 each cell"),
    ])
}
