//! Parameters that several experiments have, as options of the command line.

use clap::{Args, ValueEnum};
use staya_controller::cost::Gain;
use staya_controller::grid::Norm;
use staya_controller::route::{ExitRule, Replan, RouteParams};
use staya_sim::scenario::SafetyName;

/// The safety layer of robots in the plane or in space, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SafetyArg {
    /// ORCA in the plane.
    Orca,
    /// ORCA in space.
    Fly,
    /// Push-out; for the goal flock.
    PushOut,
    /// Nothing.
    None,
}

impl From<SafetyArg> for SafetyName {
    fn from(word: SafetyArg) -> Self {
        match word {
            SafetyArg::Orca => Self::Orca,
            SafetyArg::Fly => Self::Fly,
            SafetyArg::PushOut => Self::PushOut,
            SafetyArg::None => Self::None,
        }
    }
}

/// The exit rule as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ExitArg {
    /// Any border cell, by path cost and distance to the target (eq. 10).
    Best,
    /// Where the ray to the target crosses the border (algorithm 3).
    Ray,
}

/// When to search anew, as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReplanArg {
    /// In each cell (algorithm 1).
    EachCell,
    /// At the end of the planned way or when something changed on it (KUZ section 3).
    UntilChanged,
}

/// Route parameters; what is not given is the controller's default.
#[derive(Args, Clone, Debug)]
pub struct RouteOptions {
    /// Which cells of the window's border end a route.
    #[arg(long, value_enum, default_value = "best")]
    exit: ExitArg,
    /// When the robot searches its way anew.
    #[arg(long, value_enum, default_value = "each-cell")]
    replan: ReplanArg,
    /// Weight of travel time; this and the others in steps of 1/16 (0.0625) [default: the controller's].
    #[arg(long, value_name = "NUMBER", value_parser = gain)]
    a0: Option<Gain>,
    /// Ticks that a cell with another robot costs [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a1: Option<Gain>,
    /// Ticks per earlier visit of a cell [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a2: Option<Gain>,
    /// Ticks per cell between exit and target [default: the controller's].
    #[arg(long, value_name = "TICKS", value_parser = gain)]
    a3: Option<Gain>,
}

impl RouteOptions {
    /// The parameters for a window of that radius, with the default moves (Euclidean, no corner cutting).
    pub fn params(&self, radius: u8) -> RouteParams {
        let default = RouteParams::default();
        RouteParams {
            radius,
            exit: match self.exit {
                ExitArg::Best => ExitRule::Best,
                ExitArg::Ray => ExitRule::Ray,
            },
            a0: self.a0.unwrap_or(default.a0),
            a1: self.a1.unwrap_or(default.a1),
            a2: self.a2.unwrap_or(default.a2),
            a3: self.a3.unwrap_or(default.a3),
            ..default
        }
    }

    /// When to search anew.
    pub fn replan(&self) -> Replan {
        match self.replan {
            ReplanArg::EachCell => Replan::EachCell,
            ReplanArg::UntilChanged => Replan::UntilChanged,
        }
    }
}

/// Reads a coefficient: a decimal number that is a whole number of sixteenths.
pub fn gain(word: &str) -> Result<Gain, String> {
    let value: f64 = word
        .parse()
        .map_err(|_| String::from("give a decimal number, such as 2.5"))?;
    let one = f64::from(Gain::ONE.sixteenths());
    let largest = f64::from(u16::MAX) / one;
    if !(0.0..=largest).contains(&value) {
        return Err(format!("give a number from 0 to {largest}"));
    }
    let sixteenths = value * one;
    let below = libm::floor(sixteenths);
    if sixteenths != below {
        let (low, high) = (below / one, (below + 1.0) / one);
        return Err(format!(
            "coefficients are whole sixteenths; give {low} or {high}"
        ));
    }
    Ok(Gain::from_sixteenths(sixteenths as u16))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_sixteenths_or_errors_with_the_neighbours() {
        assert_eq!(gain("3"), Ok(Gain::from_int(3)));
        assert_eq!(gain("2.5"), Ok(Gain::from_sixteenths(40)));
        assert_eq!(gain("0.0625"), Ok(Gain::from_sixteenths(1)));
        assert_eq!(gain("0"), Ok(Gain::ZERO));
        assert_eq!(gain("4095.9375"), Ok(Gain::from_sixteenths(u16::MAX)));
        assert!(gain("0.1").unwrap_err().ends_with("give 0.0625 or 0.125"));
        for bad in ["-1", "4096", "NaN", "inf"] {
            assert!(
                gain(bad).unwrap_err().contains("from 0 to 4095.9375"),
                "{bad}"
            );
        }
        assert!(gain("three").unwrap_err().contains("decimal number"));
    }
}

/// The norm as a word of the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum NormArg {
    /// A diagonal move is sqrt 2 long.
    Euclidean,
    /// A diagonal move is 1 long.
    Chebyshev,
}

impl From<NormArg> for Norm {
    fn from(norm: NormArg) -> Self {
        match norm {
            NormArg::Euclidean => Self::Euclidean,
            NormArg::Chebyshev => Self::Chebyshev,
        }
    }
}
