//! The numbers that laws and safety layers are made from, as hosts read them from files, C and
//! Python.

use crate::grid::Norm;
use crate::parameters::Parameters;

/// The bodies that a law moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// By velocities, in the plane or in space.
    Velocities,
    /// From cell to cell: on the grid, or over cells in the plane.
    Cells,
}

/// The goals that a law takes from a scenario or an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goals {
    /// None.
    None,
    /// A cell at which it stays.
    Cell,
    /// A waypoint at which it stays, with others on the way.
    Waypoints,
    /// Up to this many, which it shares with the robots of its flock.
    Shared(u8),
}

impl Goals {
    /// Returns whether each robot has a goal of its own, at which it stays.
    #[must_use]
    pub const fn are_own(self) -> bool {
        matches!(self, Self::Cell | Self::Waypoints)
    }

    /// Returns the number of goals that an operator can move.
    #[must_use]
    pub const fn movable(self) -> u8 {
        match self {
            Self::None | Self::Cell => 0,
            Self::Waypoints => 1,
            Self::Shared(count) => count,
        }
    }
}

/// Properties of bodies, radio and cells on which values depend if they are not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Radius of the body, metres.
    pub radius_m: f32,
    /// Highest speed of the body, m/s.
    pub max_speed_mps: f32,
    /// Highest speed of any robot, m/s.
    pub fastest_mps: f32,
    /// Least look-ahead of the body ([`Body::least_horizon_s`](crate::body::Body)), seconds.
    pub brake_s: f32,
    /// Whether each robot has a goal of its own, at which it stays.
    pub has_goal: bool,
    /// Cruising speed of the body, m/s; `None`: it moves from cell to cell.
    pub cruise_mps: Option<f32>,
    /// Distance at which its goal counts as reached, metres.
    pub tolerance_m: f32,
    /// Age of the beacons of others when they arrive, seconds.
    pub delay_s: f32,
    /// Beacons of a robot that arrive in a second.
    pub rate_hz: f32,
    /// Seed of draws that all robots make alike.
    pub seed: u64,
    /// Sight of the robot in each direction, cells.
    pub radius: u8,
    /// Length of a diagonal move.
    pub norm: Norm,
    /// Whether a diagonal move may pass a blocked orthogonal neighbour.
    pub corner_cutting: bool,
}

/// Values that contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// The name of the row to change.
    pub row: &'static str,
    /// The fault in a few words.
    pub what: &'static str,
    /// How to correct it.
    pub remedy: &'static str,
    /// The least value that does not contradict, if that is the remedy.
    pub least: Option<f32>,
}

impl Contradiction {
    /// A fault with a remedy in words.
    #[must_use]
    pub const fn new(row: &'static str, what: &'static str, remedy: &'static str) -> Self {
        Self { row, what, remedy, least: None }
    }
}

/// The numbers and choices that a law or a safety layer is made from; `Default` has those that do
/// not depend on anything.
pub trait Settings: Clone + Default {
    /// The name of the law or the layer in scenarios, C and Python.
    const NAME: &'static str;

    /// The name of the table of its values, if that is another one.
    const SECTION: &'static str = Self::NAME;

    /// The law or the layer in a sentence.
    const WHAT: &'static str;

    /// Calls `visit` with each table; names differ in all of them.
    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters));

    /// Sets the values that depend on others and are not given.
    ///
    /// # Errors
    /// [`Contradiction`] of given values.
    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction>;
}

/// [`Settings`] of a law.
pub trait SettingsOfLaw: Settings {
    /// The bodies that it moves.
    const MOTION: Motion;

    /// The goals that it takes.
    const GOALS: Goals;

    /// Returns the `CELLS` of a [`CostField`](crate::route::CostField) that it needs; 0 for none.
    fn cells(&self) -> usize {
        0
    }
}

/// [`Settings`] from which a law of scalar type `S` is made: `CELLS` of a search, `M` remembered
/// visits, `L` learned costs, a map `H`.
pub trait MakesLaw<S, const CELLS: usize, const M: usize, const L: usize, H>: SettingsOfLaw {
    /// The law, wherever its robots move.
    type Law;

    /// Creates the law; laws over cells take the `map`.
    fn law(&self, map: H) -> Self::Law;
}

/// Declares an enum of [`Settings`], with what each of them has. The line `Boids(BoidsSettings)`
/// becomes a variant, an entry of `ALL`, and an arm of each function.
macro_rules! settings {
    ($(#[$about:meta])* pub enum $name:ident {
        $($(#[$on:meta])* $variant:ident($settings:ty)),+ $(,)?
    }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[expect(missing_docs, reason = "each variant's type says it")]
        pub enum $name {
            $($(#[$on])* $variant($settings)),+
        }

        impl $name {
            /// All names, each with its description in a sentence.
            pub const ALL: &'static [(&'static str, &'static str)] = &[
                $($(#[$on])* (<$settings as $crate::law::Settings>::NAME, <$settings as $crate::law::Settings>::WHAT)),+
            ];

            /// Returns the settings with this name and their defaults.
            #[must_use]
            pub fn by_name(name: &str) -> Option<Self> {
                $($(#[$on])* if name == <$settings as $crate::law::Settings>::NAME {
                    return Some(Self::$variant(Default::default()));
                })+
                None
            }

            /// Returns the name.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self { $($(#[$on])* Self::$variant(_) => <$settings as $crate::law::Settings>::NAME),+ }
            }

            /// Returns the name of the table of the values.
            #[must_use]
            pub const fn section(&self) -> &'static str {
                match self { $($(#[$on])* Self::$variant(_) => <$settings as $crate::law::Settings>::SECTION),+ }
            }

            /// Calls `visit` with each table of values.
            pub fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn $crate::parameters::Parameters)) {
                match self { $($(#[$on])* Self::$variant(settings) => $crate::law::Settings::tables(settings, visit)),+ }
            }

            /// Sets the values that depend on others and are not given.
            ///
            /// # Errors
            /// [`Contradiction`](crate::law::Contradiction) of given values.
            pub fn adapt(
                &mut self,
                is_given: &dyn Fn(&str) -> bool,
                around: &$crate::law::Around,
            ) -> Result<(), $crate::law::Contradiction> {
                match self { $($(#[$on])* Self::$variant(settings) => $crate::law::Settings::adapt(settings, is_given, around)),+ }
            }
        }
    };
}
pub(crate) use settings;
