//! The space of the points, and the numeric trait of their coordinates.

use staya_controller::scalar::Scalar;

/// `f32` or `f64`, with the operations that the search needs.
pub trait Real: Scalar {
    /// Quotient by IEEE rules, also for zero.
    #[must_use]
    fn over(self, divisor: Self) -> Self;

    /// Integer part, clamped to `0..count`; 0 for NaN.
    #[must_use]
    fn cell(self, count: u32) -> u32;

    /// The number minus a multiple of `period`: in `0..period`.
    #[must_use]
    fn modulo(self, period: Self) -> Self;
}

macro_rules! impl_real {
    ($float:ident) => {
        impl Real for $float {
            fn over(self, divisor: Self) -> Self {
                self / divisor
            }

            fn cell(self, count: u32) -> u32 {
                // The cast truncates and saturates; NaN gives 0.
                (self as u32).min(count.saturating_sub(1))
            }

            fn modulo(self, period: Self) -> Self {
                // Exact except for the last addition, which may round up to the period.
                let rest = self.rem_euclid(period);
                if rest == period { 0.0 } else { rest }
            }
        }
    };
}

impl_real!(f32);
impl_real!(f64);

/// Open space, or a torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space<R, const D: usize> {
    period: Option<[R; D]>,
}

impl<R: Real, const D: usize> Space<R, D> {
    /// Unbounded space.
    pub const OPEN: Self = Self { period: None };

    /// Creates a torus with these periods; `None` unless all are finite and above 0.
    #[must_use]
    pub fn torus(period: [R; D]) -> Option<Self> {
        let is_sound = |&side: &R| Scalar::is_finite(side) && side > R::ZERO;
        period.iter().all(is_sound).then_some(Self { period: Some(period) })
    }

    /// Periods of a torus.
    #[must_use]
    pub const fn period(&self) -> Option<[R; D]> {
        self.period
    }

    /// Position with its coordinates in `0..period`; unchanged in open space.
    #[must_use]
    pub fn fold(&self, at: [R; D]) -> [R; D] {
        match self.period {
            Some(period) => std::array::from_fn(|axis| at[axis].modulo(period[axis])),
            None => at,
        }
    }

    /// Vector from one folded position to another, the shortest on a torus.
    #[must_use]
    #[inline]
    pub fn offset(&self, from: [R; D], to: [R; D]) -> [R; D] {
        std::array::from_fn(|axis| {
            let way = to[axis] - from[axis];
            match self.period {
                Some(period) => shortest(way, period[axis]),
                None => way,
            }
        })
    }
}

#[inline]
fn shortest<R: Real>(way: R, period: R) -> R {
    let half = period * R::HALF;
    if way > half {
        way - period
    } else if way < -half {
        way + period
    } else {
        way
    }
}

/// Upper bound of the rounding error in differences of such coordinates.
#[must_use]
pub fn margin<R: Real>(coordinate: R, length: R) -> R {
    (coordinate.abs() + length) * R::EPSILON * R::from_i32(8)
}
