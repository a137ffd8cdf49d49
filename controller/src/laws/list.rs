//! The laws that can be chosen at run time: one line of [`LawSettings`] and of [`AnyLaw`] each.

use super::any::{Large, large};
use super::boids::{BoidsGuidance, BoidsSettings};
use super::cells::{CellFollower, FarMap, GridWorkspace};
use super::formation::{FormationGuidance, FormationInPlane, FormationSettings};
use super::goal_flock::{GoalFlockGuidance, GoalFlockSettings};
use super::lattice::{LatticeGuidance, LatticeSettings};
use super::route::{RouteGuidance, RouteSettings};
use super::waypoint::{WaypointGuidance, WaypointSettings};
use crate::formation::NextMove;
use crate::law::{Around, Contradiction, Goals, Motion, Settings};
use crate::parameters::Parameters;
use crate::scalar::{Scalar, cast};
use crate::template::TEMPLATE;
use serde::{Deserialize, Serialize};

/// An enum of [`Settings`], with what each of them has. The line `Boids(BoidsSettings)` becomes a
/// variant, an entry of `ALL`, and an arm of each function.
macro_rules! settings {
    ($(#[$about:meta])* pub enum $name:ident { $($variant:ident($settings:ty)),+ $(,)? }) => {
        $(#[$about])*
        pub enum $name {
            $($variant($settings)),+
        }

        impl $name {
            /// The names of the laws, each with its description in a sentence.
            pub const ALL: &'static [(&'static str, &'static str)] = &[
                $((<$settings as Settings>::NAME, <$settings as Settings>::WHAT)),+
            ];

            /// Returns the settings of the law with this name, with its defaults.
            #[must_use]
            pub fn by_name(name: &str) -> Option<Self> {
                $(if name == <$settings as Settings>::NAME {
                    return Some(Self::$variant(Default::default()));
                })+
                None
            }

            /// Returns the name of the law.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => <$settings as Settings>::NAME),+ }
            }

            /// Returns the bodies that it moves.
            #[must_use]
            pub const fn motion(&self) -> Motion {
                match self { $(Self::$variant(_) => <$settings as Settings>::MOTION),+ }
            }

            /// Returns the goals that it takes.
            #[must_use]
            pub const fn goals(&self) -> Goals {
                match self { $(Self::$variant(_) => <$settings as Settings>::GOALS),+ }
            }

            /// Calls `visit` with each table.
            pub fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
                match self { $(Self::$variant(settings) => settings.tables(visit)),+ }
            }

            /// Sets the values that depend on others and are not given.
            ///
            /// # Errors
            /// [`Contradiction`] of given values.
            pub fn adapt(
                &mut self,
                is_given: &dyn Fn(&str) -> bool,
                around: &Around,
            ) -> Result<(), Contradiction> {
                match self { $(Self::$variant(settings) => settings.adapt(is_given, around)),+ }
            }
        }
    };
}

settings! {
    /// A law with the values that it is made from; the laws document them.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[expect(missing_docs, reason = "each variant's type says it")]
    pub enum LawSettings {
        Waypoint(WaypointSettings),
        Lattice(LatticeSettings),
        GoalFlock(GoalFlockSettings),
        Boids(BoidsSettings),
        Route(RouteSettings),
        Formation(FormationSettings),
    }
}

crate::laws! {
    /// Any law, on the grid with a map `H`, in the plane or in space.
    #[derive(Clone, Debug, Serialize, Deserialize)]
    #[expect(missing_docs, reason = "each variant's type says it")]
    pub enum AnyLaw[S, const CELLS: usize, const M: usize, const F: usize, const L: usize = 0, H = ()] of S,
    in GridWorkspace<CELLS>,
    [S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H: FarMap]
    for [S, CELLS, M, F, L, H] {
        Waypoint(WaypointGuidance<S>),
        Lattice(LatticeGuidance<S>),
        GoalFlock(GoalFlockGuidance<S>),
        Boids(BoidsGuidance<S>),
        Route(Large<CellFollower<S, RouteGuidance<CELLS, M, L, H>>>, large),
        Formation(Large<FormationInPlane<S, CELLS, M, F, L, H>>, large),
        RouteOnGrid(RouteGuidance<CELLS, M, L, H>),
        FormationOnGrid(Large<FormationGuidance<CELLS, M, F, L, NextMove, H>>, large),
    }
}

impl LawSettings {
    /// Creates the law; laws over cells take the `map`.
    #[must_use]
    pub fn law<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H>(
        &self,
        map: H,
    ) -> AnyLaw<S, CELLS, M, TEMPLATE, L, H> {
        match self {
            Self::Waypoint(settings) => AnyLaw::Waypoint(settings.law()),
            Self::Lattice(settings) => AnyLaw::Lattice(settings.law()),
            Self::GoalFlock(settings) => AnyLaw::GoalFlock(settings.law()),
            Self::Boids(settings) => AnyLaw::Boids(settings.law()),
            Self::Route(settings) => match settings.speed_mps {
                Some(speed) => AnyLaw::Route(large(CellFollower::new(settings.law(map), cast(speed)))),
                None => AnyLaw::RouteOnGrid(settings.law(map)),
            },
            Self::Formation(settings) => match settings.route.speed_mps {
                Some(speed) => {
                    AnyLaw::Formation(large(FormationInPlane::new(settings.law(NextMove, map), cast(speed))))
                }
                None => AnyLaw::FormationOnGrid(large(settings.law(NextMove, map))),
            },
        }
    }

    /// Returns the `CELLS` of a [`CostField`](crate::route::CostField) that it needs; 0 for none.
    #[must_use]
    pub const fn cells(&self) -> usize {
        match self {
            Self::Route(settings) => settings.cells(),
            Self::Formation(settings) => settings.route.cells(),
            _ => 0,
        }
    }
}
