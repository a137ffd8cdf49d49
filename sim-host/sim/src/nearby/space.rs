//! The space that points lie in, and the numbers they are made of.

use staya_controller::scalar::Scalar;

/// `f32` or `f64`: what the host computes with.
pub trait Real: Scalar {
    /// The quotient; by IEEE rules also for zero.
    #[must_use]
    fn over(self, divisor: Self) -> Self;

    /// Its integer part if that is in `0..count`, else the nearer end of that range; 0 for NaN.
    #[must_use]
    fn cell(self, count: u32) -> u32;

    /// The number minus a whole multiple of `period`: in `0..period`.
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
                // The cast cuts the fraction off and saturates; NaN gives 0.
                (self as u32).min(count.saturating_sub(1))
            }

            fn modulo(self, period: Self) -> Self {
                // Exact but for the last addition, which may round up to the period itself.
                let rest = self.rem_euclid(period);
                if rest == period { 0.0 } else { rest }
            }
        }
    };
}

impl_real!(f32);
impl_real!(f64);

/// Endless space, or a torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space<R, const D: usize> {
    /// After how much each axis repeats; `None`: never.
    period: Option<[R; D]>,
}

impl<R: Real, const D: usize> Space<R, D> {
    /// The space without an end.
    pub const OPEN: Self = Self { period: None };

    /// A torus with these circumferences; `None` when one is not finite and above 0.
    #[must_use]
    pub fn torus(period: [R; D]) -> Option<Self> {
        let is_sound = |&side: &R| Scalar::is_finite(side) && side > R::ZERO;
        period.iter().all(is_sound).then_some(Self { period: Some(period) })
    }

    /// The circumferences of a torus.
    #[must_use]
    pub const fn period(&self) -> Option<[R; D]> {
        self.period
    }

    /// The place with its coordinates in `0..period`; in the open the same place.
    #[must_use]
    pub fn fold(&self, at: [R; D]) -> [R; D] {
        match self.period {
            Some(period) => std::array::from_fn(|axis| at[axis].modulo(period[axis])),
            None => at,
        }
    }

    /// The way from one folded place to another, the shortest around the torus.
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

/// A difference of folded coordinates, the shorter way around.
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

/// More than rounding can lose in differences of such coordinates.
#[must_use]
pub fn margin<R: Real>(coordinate: R, length: R) -> R {
    (coordinate.abs() + length) * R::EPSILON * R::from_i32(8)
}
