//! Coefficients of the route cost.

use serde::Serialize;
use staya_controller::cost::Gain;
use staya_controller::route::RouteParams;

/// A coefficient of the route cost (eqs. 7, 9 and 10).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Coefficient {
    /// Weight of travel time.
    A0,
    /// Cost of a cell with another robot.
    A1,
    /// Cost of an earlier visit.
    A2,
    /// Cost of the distance from the exit to the target.
    A3,
}

impl Coefficient {
    /// Returns the parameters with this coefficient changed.
    #[must_use]
    pub const fn set(self, mut params: RouteParams, value: Gain) -> RouteParams {
        match self {
            Self::A0 => params.a0 = value,
            Self::A1 => params.a1 = value,
            Self::A2 => params.a2 = value,
            Self::A3 => params.a3 = value,
        }
        params
    }

    /// Name in the paper's formulas.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A0 => "a0",
            Self::A1 => "a1",
            Self::A2 => "a2",
            Self::A3 => "a3",
        }
    }

    /// Value in the parameters.
    #[must_use]
    pub const fn get(self, params: &RouteParams) -> Gain {
        match self {
            Self::A0 => params.a0,
            Self::A1 => params.a1,
            Self::A2 => params.a2,
            Self::A3 => params.a3,
        }
    }
}
