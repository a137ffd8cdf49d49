//! Numbers that an operator or the firmware may change while a robot runs.
//!
//! Each law, safety layer and configuration has one table of [`Parameter`]s. Scenario files,
//! MAVLink, C, Python and the list of parameters in `docs/` use these tables. The macro
//! [`parameters!`](crate::parameters!) binds the rows of a table to the fields of a type:
//!
//! ```
//! use staya_controller::parameters::{Parameters as _, Rejected, SPEED, row};
//! use staya_controller::scalar::Scalar;
//!
//! /// A law that patrols a ring.
//! struct Patrol<S> {
//!     ring_m: S,
//!     speed_mps: S,
//! }
//!
//! staya_controller::parameters! {
//!     impl[S: Scalar] Patrol<S> {
//!         row("ring_m", "PATROL_RING_M", "m", [1.0, 100.0], "radius of the ring") => ring_m,
//!         SPEED => speed_mps,
//!     }
//! }
//!
//! let mut patrol = Patrol { ring_m: 5.0_f32, speed_mps: 0.5 };
//! let ring = patrol.index("ring_m").expect("a row");
//! assert_eq!(patrol.set(ring, 8.0), Ok(()));
//! assert_eq!(patrol.set(ring, 0.0), Err(Rejected::OutOfRange([1.0, 100.0])));
//! assert_eq!(patrol.get(ring), Some(8.0));
//! ```

use crate::cost::Gain;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;

/// A row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The name, at most 16 characters.
    pub name: &'static str,
    /// The name for MAVLink clients, at most 16 characters.
    pub mavlink: &'static str,
    /// The unit, such as `m/s`; empty for a plain number.
    pub unit: &'static str,
    /// The least and the greatest value.
    pub range: [f32; 2],
    /// A description in a few words.
    pub what: &'static str,
    /// The words for the values 0, 1, ..., if the row is a choice; otherwise empty.
    pub words: &'static [&'static str],
    /// Where its value comes from if none is given.
    pub absent: Absent,
}

/// Where the value of a row comes from if none is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absent {
    /// The [`Default`] of the type that has the row.
    Default,
    /// Other values, as these words say.
    Depends(&'static str),
    /// The body has it, under this name, and a law has no other.
    OfBody(&'static str),
    /// It must be given.
    Needed,
}

/// Words for a value that depends on the body.
pub const BY_BODY: &str = "by the body";

/// The words of a switch.
pub const SWITCH: &[&str] = &["false", "true"];

impl Parameter {
    /// The row with a default that depends on other values, as `what` says.
    #[must_use]
    pub const fn depends(self, what: &'static str) -> Self {
        Self { absent: Absent::Depends(what), ..self }
    }

    /// The row of a value that the body has under this name.
    #[must_use]
    pub const fn of_body(self, name: &'static str) -> Self {
        Self { absent: Absent::OfBody(name), ..self }
    }

    /// The row of a value without a default.
    #[must_use]
    pub const fn needed(self) -> Self {
        Self { absent: Absent::Needed, ..self }
    }

    /// Returns whether the row is true or false.
    #[must_use]
    pub fn is_switch(&self) -> bool {
        self.words == SWITCH
    }
}

/// Longest description, bytes.
pub const LONGEST_DESCRIPTION: usize = 63;

/// Creates a row. In a constant, a bad one does not compile.
///
/// # Panics
/// If a name or the description is too long, or the range is empty.
#[must_use]
pub const fn row(
    name: &'static str,
    mavlink: &'static str,
    unit: &'static str,
    range: [f32; 2],
    what: &'static str,
) -> Parameter {
    assert!(name.len() <= 16 && mavlink.len() <= 16 && unit.len() <= 16, "a name has at most 16 characters");
    assert!(what.len() <= LONGEST_DESCRIPTION, "the description is too long");
    let [least, greatest] = range;
    assert!(least < greatest, "the range is empty");
    Parameter { name, mavlink, unit, range, what, words: &[], absent: Absent::Default }
}

/// Creates a row that is one of some words; its values are their positions, from 0.
///
/// # Panics
/// See [`row`]; also if there are fewer than two words.
#[must_use]
pub const fn choice(
    name: &'static str,
    mavlink: &'static str,
    words: &'static [&'static str],
    what: &'static str,
) -> Parameter {
    assert!(words.len() >= 2, "a choice has two words or more");
    Parameter { words, ..row(name, mavlink, "", [0.0, (words.len() - 1) as f32], what) }
}

/// Creates a row that is true or false.
///
/// # Panics
/// See [`row`].
#[must_use]
pub const fn switch(name: &'static str, mavlink: &'static str, what: &'static str) -> Parameter {
    choice(name, mavlink, SWITCH, what)
}

/// Radius of the ball around the body.
pub const RADIUS: Parameter =
    row("radius_m", "RADIUS_M", "m", [0.001, 65.0], "radius that others keep clear of; not less than the body's");
/// Cruising speed; the speed limit of the body holds too.
pub const SPEED: Parameter = row("speed_mps", "SPEED_MPS", "m/s", [0.0, 32.0], "preferred speed").of_body("cruise_mps");
/// Distance at which the robot counts as arrived.
pub const TOLERANCE: Parameter =
    row("tolerance_m", "TOLERANCE_M", "m", [0.001, 10_000.0], "distance at which a place counts as reached");
/// Minimum distance of push-out and of the goal flock (`R_MinDist`).
pub const MIN_DISTANCE: Parameter =
    row("min_distance_m", "MIN_DIST_M", "m", [0.001, 1000.0], "least distance of two robots' centres").needed();

/// A table and its current values.
pub trait Parameters {
    /// The rows.
    fn table(&self) -> &'static [Parameter];

    /// Returns the value of row `index`.
    fn get(&self, index: usize) -> Option<f32>;

    /// Stores a value within the range of row `index`. Returns false, without a change, if there is
    /// no such row or, with `checks`, if the value contradicts other parameters.
    fn store(&mut self, index: usize, value: f32, checks: bool) -> bool;

    /// Returns whether the values go together.
    fn is_sound(&self) -> bool {
        true
    }

    /// Changes the value of row `index`.
    ///
    /// # Errors
    /// [`Rejected`]; the value is unchanged.
    fn set(&mut self, index: usize, value: f32) -> Result<(), Rejected> {
        let Parameter { range: [least, greatest], .. } = self.table().get(index).ok_or(Rejected::Unknown)?;
        if !(least..=greatest).contains(&&value) {
            return Err(Rejected::OutOfRange([*least, *greatest]));
        }
        if self.store(index, value, true) { Ok(()) } else { Err(Rejected::Contradiction) }
    }

    /// Returns the index of the row with this name. O(rows).
    fn index(&self, name: &str) -> Option<usize> {
        self.table().iter().position(|row| row.name == name)
    }
}

/// Why a parameter was not changed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rejected {
    /// The robot does not have this parameter.
    Unknown,
    /// The value is outside these limits.
    OutOfRange([f32; 2]),
    /// The value contradicts other parameters.
    Contradiction,
}

/// A field that can be a parameter.
pub trait Value: Copy {
    /// Returns the number in the unit of its row.
    fn number(self) -> f32;

    /// Returns the value nearest to a number in the unit of its row.
    fn nearest(number: f32) -> Self;
}

impl<S: Scalar> Value for S {
    fn number(self) -> f32 {
        cast(self)
    }

    fn nearest(number: f32) -> Self {
        cast(number)
    }
}

impl Value for bool {
    fn number(self) -> f32 {
        u8::from(self).into()
    }

    fn nearest(number: f32) -> Self {
        number >= 0.5
    }
}

impl Value for u8 {
    fn number(self) -> f32 {
        self.into()
    }

    fn nearest(number: f32) -> Self {
        (number + 0.5) as Self
    }
}

impl Value for u16 {
    fn number(self) -> f32 {
        self.into()
    }

    fn nearest(number: f32) -> Self {
        (number + 0.5) as Self
    }
}

/// Rounded to sixteenths.
impl Value for Gain {
    fn number(self) -> f32 {
        self.sixteenths().number() / 16.0
    }

    fn nearest(number: f32) -> Self {
        Self::from_sixteenths(Value::nearest(number * 16.0))
    }
}

/// Seconds, rounded to microseconds.
impl Value for Duration {
    fn number(self) -> f32 {
        Scalar::from_micro(self.as_micros())
    }

    fn nearest(seconds: f32) -> Self {
        Self::from_micros((seconds * 1e6) as i32)
    }
}

/// Makes enums of [`named!`](crate::names) fields of a [`choice`] with their names as words.
#[cfg(feature = "agent")]
macro_rules! worded {
    ($($name:ty),+ $(,)?) => { $(
        impl $crate::parameters::Value for $name {
            fn number(self) -> f32 {
                let place = <Self as $crate::names::Named>::NAMES.iter().position(|(_, value)| *value == self);
                u8::try_from(place.unwrap_or(0)).map_or(0.0, f32::from)
            }

            fn nearest(number: f32) -> Self {
                let named = <Self as $crate::names::Named>::NAMES.get((number + 0.5) as usize);
                named.map_or_else(Self::default, |(_, value)| *value)
            }
        }
    )+ };
}
#[cfg(feature = "agent")]
pub(crate) use worded;

/// Implements [`Parameters`](crate::parameters::Parameters) for a type: each row is a
/// [`Parameter`](crate::parameters::Parameter), `=>` and a field, with `/ N` if the field counts
/// N-ths of the unit. After `where`, a method that returns whether all fields go together.
#[macro_export]
macro_rules! parameters {
    (impl[$($generics:tt)*] $type:ty $(, where $is_sound:ident)? {
        $($row:expr => $($field:ident).+ $(/ $parts:expr)?),+ $(,)?
    }) => {
        impl<$($generics)*> $type {
            /// Parameters that may change while a robot runs.
            pub const TABLE: &'static [$crate::parameters::Parameter] = &[$($row),+];
        }

        impl<$($generics)*> $crate::parameters::Parameters for $type {
            fn table(&self) -> &'static [$crate::parameters::Parameter] {
                Self::TABLE
            }

            fn get(&self, index: usize) -> Option<f32> {
                let values = [$($crate::parameters::Value::number(self.$($field).+) $(/ $parts)?),+];
                values.get(index).copied()
            }

            fn store(&mut self, index: usize, value: f32, checks: bool) -> bool {
                let mut rows = 0_usize..;
                $(
                    if rows.next() == Some(index) {
                        let before = self.$($field).+;
                        self.$($field).+ = $crate::parameters::Value::nearest(value $(* $parts)?);
                        if checks && !$crate::parameters::Parameters::is_sound(self) {
                            self.$($field).+ = before;
                            return false;
                        }
                        return true;
                    }
                )+
                false
            }

            $(fn is_sound(&self) -> bool {
                self.$is_sound()
            })?
        }
    };
}

#[cfg(all(test, feature = "agent"))]
mod tests {
    use super::*;
    use crate::formation::FormationParams;
    use crate::route::RouteParams;

    fn set(table: &mut dyn Parameters, name: &str, value: f32) -> Result<Option<f32>, Rejected> {
        let index = table.index(name).expect(name);
        table.set(index, value)?;
        Ok(table.get(index))
    }

    #[test]
    fn gains_and_cells_are_rounded_to_the_nearest_part() {
        let (mut route, mut formation) = (RouteParams::default(), FormationParams::default());
        for (value, rounded) in [(0.7, 0.6875), (0.72, 0.75), (3.0, 3.0)] {
            assert_eq!(set(&mut route, "a2", value), Ok(Some(rounded)));
            assert_eq!(set(&mut formation, "place_gain", value), Ok(Some(rounded)));
        }
        for (value, rounded) in [(4.4, 4.0), (4.6, 5.0)] {
            assert_eq!(set(&mut formation, "eps_cells", value), Ok(Some(rounded)));
        }
        assert_eq!(set(&mut route, "a2", -1.0), Err(Rejected::OutOfRange([0.0, 4095.0])));
    }

    #[test]
    fn a_value_that_contradicts_another_one_is_not_stored() {
        let mut formation = FormationParams::default();
        assert_eq!(set(&mut formation, "resume_cells", 100.0), Err(Rejected::Contradiction));
        assert_eq!(formation, FormationParams::default());
        assert_eq!(formation.set(99, 1.0), Err(Rejected::Unknown));
    }
}
