//! Kinds of scenes and their weights.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Number of scenes after which the kinds repeat.
pub const PERIOD: u32 = 500;

macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $kind:ident = $name:literal, $weight:literal;)*) => {
        /// The trouble of a scene.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Kind {
            $($(#[doc = $doc])* $kind),*
        }

        impl Kind {
            /// Each kind with its name and its number of scenes in [`PERIOD`].
            pub const ALL: &[(Self, &'static str, u32)] = &[$((Self::$kind, $name, $weight)),*];
        }
    };
}

kinds! {
    /// Links fade.
    Fades = "fades", 46;
    /// Links fade, and single packets are lost.
    FadesAndLoss = "fades-and-loss", 26;
    /// At least four of five packets are lost.
    Loss = "loss", 28;
    /// Packets arrive late, by different times.
    Jitter = "jitter", 26;
    /// Robots die while links fade or the radio is dead.
    DeathsInFades = "deaths-in-fades", 16;
    /// Crowds pass a door.
    Door = "door", 18;
    /// Crowds pass each other in a corridor.
    Corridor = "corridor", 16;
    /// Bodies with inertia, some also with a lag, while links fade.
    Inertia = "inertia", 28;
    /// The radio reaches a few metres, and links fade.
    Range = "range", 28;
    /// All packets are lost for a time.
    Blackout = "blackout", 28;
    /// Two robots use one number.
    SameNumber = "same-number", 16;
    /// Lattices with hardly more space than the robots need.
    Dense = "dense", 16;
    /// 64 to 200 robots.
    Many = "many", 12;
    /// Half-planes from a table.
    Template = "template", 16;
    /// Bodies that do not give way.
    Intruder = "intruder", 20;
    /// Robots of different sizes and speeds.
    Mixed = "mixed", 20;
    /// Flyers.
    Space = "space", 20;
    /// Robots die.
    Deaths = "deaths", 16;
    /// Robots restart.
    Restarts = "restarts", 16;
    /// Robots start late.
    LateStarts = "late-starts", 16;
    /// Packets overtake each other or arrive twice.
    Reorder = "reorder", 16;
    /// Two radios lose most packets in both directions.
    WeakRadios = "weak-radios", 12;
    /// A transmitter is dead from the start.
    Mute = "mute", 12;
    /// A transmitter is dead for a time.
    MuteForATime = "mute-for-a-time", 10;
    /// A receiver is dead, for a time or from the start.
    Deaf = "deaf", 6;
    /// A few links are dead in both directions.
    DeadLink = "dead-link", 8;
    /// A few links are dead in one direction.
    OneWay = "one-way", 8;
}

impl Kind {
    /// The kind of the scene with this seed.
    ///
    /// # Panics
    /// Never: the weights add up to [`PERIOD`].
    #[must_use]
    pub fn of(seed: u32) -> Self {
        // 211 and the period have no common divisor, so that the kinds of a few seeds are mixed.
        let mut place = (seed % PERIOD) * 211 % PERIOD;
        let kind = Self::ALL.iter().find(|(.., weight)| {
            let is_here = place < *weight;
            place = place.wrapping_sub(*weight);
            is_here
        });
        kind.expect("the weights add up").0
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, ..)| *kind == self).map_or("", |(_, name, _)| name)
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.iter().find(|(_, known, _)| *known == name);
        known.map(|(kind, ..)| *kind).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|(_, name, _)| *name).collect();
            format!("there is no kind {name:?}; give one of {}", names.join(", "))
        })
    }
}
