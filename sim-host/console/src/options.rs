//! Options shared by several commands: named values, routing parameters, coefficients.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Command};
use staya_controller::agent::SafetyKind;
use staya_controller::cost::Gain;
use staya_controller::grid::Norm;
use staya_controller::names::Named;
use staya_controller::push_out::{Evasion, Model};
use staya_controller::route::{ExitRule, Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_sim::terrain::generate::Hills;

/// Arguments with all defaults, so that defaults are declared only once.
///
/// # Panics
/// An option has no default.
pub fn defaults<P: Args>() -> P {
    let line = P::augment_args(Command::new("defaults").no_binary_name(true));
    let matches = line.get_matches_from([""; 0]);
    P::from_arg_matches(&matches).expect("every option has a default")
}

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

/// Safety layer of robots in the plane or in space.
pub fn safety() -> impl TypedValueParser<Value = SafetyKind> {
    one_of(&[
        (SafetyKind::Orca, "ORCA in the plane"),
        (SafetyKind::Fly, "ORCA in space"),
        (SafetyKind::PushOut, "Push-out; for the goal flock"),
        (SafetyKind::None, "Nothing"),
    ])
}

/// Reaction of push-out in a step.
pub fn model() -> impl TypedValueParser<Value = Model> {
    one_of(&[(Model::Radial, "1: along the radius"), (Model::Tangential, "2: turned aside")])
}

/// Number of robots that push-out avoids at once.
pub fn evasion() -> impl TypedValueParser<Value = Evasion> {
    one_of(&[(Evasion::Single, "The nearest in the way"), (Evasion::Multiple, "All")])
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

/// Sharpness of the order of moves: cost difference in ticks that halves a priority; 0 is greedy.
pub fn shuffle(word: &str) -> Result<Sharpness, String> {
    Ok(match gain(word)? {
        Gain::ZERO => Sharpness::Greedy,
        half => Sharpness::HalvedPer(half),
    })
}

fn exit() -> impl TypedValueParser<Value = ExitRule> {
    one_of(&[
        (ExitRule::Best, "Any border cell, by path cost and distance to the target (eq. 10)"),
        (ExitRule::Ray, "Where the ray to the target crosses the border (algorithm 3)"),
    ])
}

/// When a route is searched again.
pub fn replan() -> impl TypedValueParser<Value = Replan> {
    one_of(&[
        (Replan::EachCell, "In each cell (algorithm 1)"),
        (Replan::UntilChanged, "At the end of the planned route or after a change on it (KUZ section 3)"),
    ])
}

/// Routing parameters; `None` means the controller's default.
#[derive(Args, Clone, Debug)]
pub struct RouteOptions {
    /// Border cells of the window that can end a route.
    #[arg(long, default_value = "best", value_parser = exit())]
    exit: ExitRule,
    /// When a robot searches its route again.
    #[arg(long, default_value = "each-cell", value_parser = replan())]
    pub replan: Replan,
    /// Weight of travel time, in steps of 1/16 (0.0625) like the other weights [default: the
    /// controller's].
    #[arg(long, value_name = "NUMBER", value_parser = gain)]
    a0: Option<Gain>,
    /// Cost of a cell with another robot, ticks [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a1: Option<Gain>,
    /// Cost per earlier visit of a cell, ticks [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a2: Option<Gain>,
    /// Cost per cell between exit and target, ticks [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a3: Option<Gain>,
}

impl RouteOptions {
    /// Parameters for a window with this radius and Euclidean moves without corner cutting.
    pub fn params(&self, radius: u8) -> RouteParams {
        let default = RouteParams::default();
        RouteParams {
            radius,
            exit: self.exit,
            a0: self.a0.unwrap_or(default.a0),
            a1: self.a1.unwrap_or(default.a1),
            a2: self.a2.unwrap_or(default.a2),
            a3: self.a3.unwrap_or(default.a3),
            ..default
        }
    }
}

/// Extra cost of a move, in ticks, that halves how often it comes first; 0: greedy.
#[must_use]
pub fn shuffle_ticks(sharpness: Sharpness) -> f64 {
    match sharpness {
        Sharpness::Greedy => 0.0,
        Sharpness::HalvedPer(gain) => f64::from(gain.sixteenths()) / f64::from(Gain::ONE.sixteenths()),
    }
}

/// Parses a coefficient, a decimal number that is a multiple of 1/16.
pub fn gain(word: &str) -> Result<Gain, String> {
    let value: f64 = word.parse().map_err(|_| String::from("give a decimal number, such as 2.5"))?;
    let one = f64::from(Gain::ONE.sixteenths());
    let largest = f64::from(u16::MAX) / one;
    if !(0.0..=largest).contains(&value) {
        return Err(format!("give a number from 0 to {largest}"));
    }
    let sixteenths = value * one;
    let below = libm::floor(sixteenths);
    if sixteenths != below {
        let (low, high) = (below / one, (below + 1.0) / one);
        return Err(format!("coefficients are multiples of 1/16; give {low} or {high}"));
    }
    Ok(Gain::from_sixteenths(sixteenths as u16))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_off_the_grid_is_an_error_with_its_neighbours() {
        assert_eq!(gain("3"), Ok(Gain::from_int(3)));
        assert_eq!(gain("2.5"), Ok(Gain::from_sixteenths(40)));
        assert_eq!(gain("0.0625"), Ok(Gain::from_sixteenths(1)));
        assert_eq!(gain("0"), Ok(Gain::ZERO));
        assert_eq!(gain("4095.9375"), Ok(Gain::from_sixteenths(u16::MAX)));
        assert!(gain("0.1").unwrap_err().ends_with("give 0.0625 or 0.125"));
        for bad in ["-1", "4096", "NaN", "inf"] {
            assert!(gain(bad).unwrap_err().contains("from 0 to 4095.9375"), "{bad}");
        }
        assert!(gain("three").unwrap_err().contains("decimal number"));
    }
}
