//! The safety layers that can be chosen at run time: one line of `list!` each.

use super::settings::{FlySettings, MakesLayer, OrcaSettings, PushOutSettings, TableSettings, UnguardedSettings};
use super::{Safety, SafetyInput};
use crate::geom::Vec3;
use crate::law::settings;
use crate::neighbor::StalenessInflation;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// The line `Orca(OrcaSettings)` becomes a variant of [`LayerSettings`] and one of [`AnySafety`],
/// and an arm of each of their functions.
macro_rules! list {
    ($($(#[$on:meta])* $variant:ident($settings:ty)),+ $(,)?) => {
        settings! {
            /// A safety layer with the values that it is made from; the layers document them.
            #[derive(Copy)]
            pub enum LayerSettings { $($(#[$on])* $variant($settings)),+ }
        }

        /// Any safety layer, with at most `K` half-planes.
        #[derive(Clone, Debug, Serialize, Deserialize)]
        #[serde(bound(deserialize = ""))]
        #[expect(missing_docs, reason = "each variant's type says it")]
        pub enum AnySafety<S: Scalar, const K: usize> {
            $($(#[$on])* $variant(<$settings as MakesLayer<S, K>>::Layer)),+
        }

        impl<S: Scalar, const K: usize> AnySafety<S, K> {
            fn inside(&self) -> &dyn Safety<S> {
                match self { $($(#[$on])* Self::$variant(layer) => layer),+ }
            }

            fn inside_mut(&mut self) -> &mut dyn Safety<S> {
                match self { $($(#[$on])* Self::$variant(layer) => layer),+ }
            }
        }

        impl LayerSettings {
            /// Creates the layer.
            #[inline(never)]
            #[must_use]
            pub fn layer<S: Scalar, const K: usize>(&self) -> AnySafety<S, K> {
                match self { $($(#[$on])* Self::$variant(settings) => AnySafety::$variant(MakesLayer::<S, K>::layer(settings))),+ }
            }
        }
    };
}

list! {
    None(UnguardedSettings),
    Orca(OrcaSettings),
    #[cfg(feature = "list_table")]
    Template2k(TableSettings),
    #[cfg(feature = "list_space")]
    Fly(FlySettings),
    #[cfg(feature = "list_push_out")]
    PushOut(PushOutSettings),
}

impl<S: Scalar, const K: usize> Safety<S> for AnySafety<S, K> {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S> {
        self.inside_mut().keep_clear(input, rng)
    }

    fn inflation(&self) -> Option<StalenessInflation<S>> {
        self.inside().inflation()
    }

    fn downwash(&self) -> S {
        self.inside().downwash()
    }

    fn waits_for_turn(&self) -> bool {
        self.inside().waits_for_turn()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside_mut().parameters(visit);
    }
}

impl LayerSettings {
    /// Returns the settings of ORCA, if it is ORCA in the plane or in space.
    #[must_use]
    pub const fn orca(&self) -> Option<&OrcaSettings> {
        match self {
            Self::Orca(orca) => Some(orca),
            #[cfg(feature = "list_table")]
            Self::Template2k(TableSettings(orca)) => Some(orca),
            #[cfg(feature = "list_space")]
            Self::Fly(FlySettings { orca, .. }) => Some(orca),
            _ => None,
        }
    }

    /// As [`Self::orca`], to change them.
    #[must_use]
    pub const fn orca_mut(&mut self) -> Option<&mut OrcaSettings> {
        match self {
            Self::Orca(orca) => Some(orca),
            #[cfg(feature = "list_table")]
            Self::Template2k(TableSettings(orca)) => Some(orca),
            #[cfg(feature = "list_space")]
            Self::Fly(FlySettings { orca, .. }) => Some(orca),
            _ => None,
        }
    }

    /// Returns whether its robots fly.
    #[must_use]
    pub const fn flies(&self) -> bool {
        match self {
            #[cfg(feature = "list_space")]
            Self::Fly(_) => true,
            _ => false,
        }
    }

    /// Returns whether there is none.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        matches!(self, Self::None(_))
    }
}
