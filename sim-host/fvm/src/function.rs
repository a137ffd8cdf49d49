//! Functions of two or three variables, and R-functions, which combine them like Boolean operations
//! combine sets (V. L. Rvachev 1982; in English V. Shapiro 2007, "Semi-analytic geometry with
//! R-functions", Acta Numerica 16).
//!
//! A function stands for the set where it is positive; its zeros are the border. The sign of an
//! R-function depends only on the signs of its arguments.

use std::fmt::{self, Display};
use std::ops::Not;
use std::str::FromStr;
use std::sync::Arc;

/// Rvachev's system R_alpha, which defines "and" and "or". "Not" is -x in all systems.
///
/// x and y: (x + y - sqrt(x^2 + y^2 - 2 alpha x y)) / (1 + alpha); x or y: with + before the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum System {
    /// alpha = 0. Smooth except where both arguments are 0; values are not distances.
    R0,
    /// alpha = 1: minimum and maximum. Distances stay distances; kinks where arguments are equal.
    R1,
    /// Another alpha, -1 < alpha <= 1.
    Alpha(f64),
}

impl System {
    fn alpha(self) -> f64 {
        match self {
            Self::R0 => 0.0,
            Self::R1 => 1.0,
            Self::Alpha(alpha) => alpha,
        }
    }

    /// Conjunction: positive where both arguments are.
    #[must_use]
    pub fn and(self, x: f64, y: f64) -> f64 {
        if self == Self::R1 {
            return if x < y || x.is_nan() { x } else { y };
        }
        let alpha = self.alpha();
        // The part of smaller magnitude follows from the product of both parts: the plain
        // difference is mostly rounding error and can have the wrong sign.
        let (sum, product) = (x + y, x * y);
        let root = libm::sqrt((x * x + y * y - 2.0 * alpha * product).max(0.0));
        if sum > 0.0 { 2.0 * product / (sum + root) } else { (sum - root) / (1.0 + alpha) }
    }

    /// Disjunction: positive where at least one argument is.
    #[must_use]
    pub fn or(self, x: f64, y: f64) -> f64 {
        -self.and(-x, -y)
    }
}

impl Display for System {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::R0 => write!(out, "r0"),
            Self::R1 => write!(out, "r1"),
            Self::Alpha(alpha) => write!(out, "{alpha}"),
        }
    }
}

impl FromStr for System {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "r0" => Ok(Self::R0),
            "r1" => Ok(Self::R1),
            _ => match text.parse() {
                Ok(alpha) if alpha > -1.0 && alpha <= 1.0 => Ok(Self::Alpha(alpha)),
                _ => Err(format!("`{text}` is not r0, r1, or an alpha of R_alpha; give a number above -1, at most 1")),
            },
        }
    }
}

/// A function of `V` variables.
#[derive(Clone)]
pub struct Function<const V: usize>(Arc<dyn Fn([f64; V]) -> f64 + Send + Sync>);

impl<const V: usize> Function<V> {
    /// Wraps a closure.
    #[must_use]
    pub fn new(function: impl Fn([f64; V]) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(function))
    }

    /// Value at a point.
    #[must_use]
    pub fn value(&self, at: [f64; V]) -> f64 {
        (self.0)(at)
    }

    /// Gradient at a point, by differences over `apart` to both sides.
    #[must_use]
    pub fn gradient(&self, at: [f64; V], apart: [f64; V]) -> [f64; V] {
        let mut gradient = [0.0; V];
        for axis in 0..V {
            let (mut before, mut after) = (at, at);
            before[axis] -= apart[axis];
            after[axis] += apart[axis];
            gradient[axis] = (self.value(after) - self.value(before)) / (after[axis] - before[axis]);
        }
        gradient
    }

    /// Conjunction: positive where both functions are.
    #[must_use]
    pub fn and(self, other: Self, system: System) -> Self {
        Self::new(move |at| system.and(self.value(at), other.value(at)))
    }

    /// Disjunction: positive where at least one function is.
    #[must_use]
    pub fn or(self, other: Self, system: System) -> Self {
        Self::new(move |at| system.or(self.value(at), other.value(at)))
    }
}

impl<const V: usize> Not for Function<V> {
    type Output = Self;

    fn not(self) -> Self {
        Self::new(move |at| -self.value(at))
    }
}
