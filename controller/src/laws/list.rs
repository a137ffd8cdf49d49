//! The laws that can be chosen at run time, by a scenario, over a host link, from C and from
//! Python.

use super::boids::BoidsSettings;
use super::cells::FarMap;
#[cfg(feature = "list_cells")]
use super::cells::GridWorkspace as Workspace;
#[cfg(not(feature = "list_cells"))]
use super::cells::NoWorkspace as Workspace;
use super::formation::FormationSettings;
use super::goal_flock::GoalFlockSettings;
use super::lattice::LatticeSettings;
use super::route::RouteSettings;
use super::waypoint::WaypointSettings;
use crate::law::{Goals, MakesLaw, Motion, SettingsOfLaw, settings};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// The line `Boids(BoidsSettings)` becomes a variant of [`LawSettings`] and one of [`AnyLaw`], and
/// an arm of each of their functions.
macro_rules! list {
    ($($(#[$on:meta])* $variant:ident($settings:ty)),+ $(,)?) => {
        settings! {
            /// A law with the values that it is made from; the laws document them.
            pub enum LawSettings { $($(#[$on])* $variant($settings)),+ }
        }

        crate::laws! {
            /// Any law, on the grid with a map `H`, in the plane or in space.
            #[derive(Clone, Debug, Serialize, Deserialize)]
            #[serde(bound(deserialize = "H: Deserialize<'de>"))]
            #[expect(missing_docs, reason = "each variant's type says it")]
            pub enum AnyLaw[S: Scalar, const CELLS: usize, const M: usize, const L: usize = 0, H: FarMap = ()] of S,
            in Workspace<CELLS>,
            [S: Scalar, const CELLS: usize, const M: usize, const L: usize, H: FarMap] for [S, CELLS, M, L, H] {
                $($(#[$on])* $variant(<$settings as MakesLaw<S, CELLS, M, L, H>>::Law)),+
            }
        }

        impl LawSettings {
            /// Returns the bodies that it moves.
            #[must_use]
            pub const fn motion(&self) -> Motion {
                match self { $($(#[$on])* Self::$variant(_) => <$settings as SettingsOfLaw>::MOTION),+ }
            }

            /// Returns the goals that it takes.
            #[must_use]
            pub const fn goals(&self) -> Goals {
                match self { $($(#[$on])* Self::$variant(_) => <$settings as SettingsOfLaw>::GOALS),+ }
            }

            /// Returns the `CELLS` of a [`CostField`](crate::route::CostField) that it needs; 0 for
            /// none.
            #[must_use]
            pub fn cells(&self) -> usize {
                match self { $($(#[$on])* Self::$variant(settings) => settings.cells()),+ }
            }

            /// Creates the law; laws over cells take the `map`.
            #[inline(never)]
            #[must_use]
            pub fn law<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H: FarMap>(
                &self,
                map: H,
            ) -> AnyLaw<S, CELLS, M, L, H> {
                match self { $($(#[$on])* Self::$variant(settings) => AnyLaw::$variant(MakesLaw::<S, CELLS, M, L, H>::law(settings, map))),+ }
            }
        }
    };
}

list! {
    Waypoint(WaypointSettings),
    #[cfg(feature = "list_flocks")]
    Lattice(LatticeSettings),
    #[cfg(feature = "list_flocks")]
    GoalFlock(GoalFlockSettings),
    #[cfg(feature = "list_flocks")]
    Boids(BoidsSettings),
    #[cfg(feature = "list_cells")]
    Route(RouteSettings),
    #[cfg(feature = "list_cells")]
    Formation(FormationSettings),
}
