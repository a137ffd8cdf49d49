//! Which of two assignments is the newer one, by a version that wraps.

use serde::{Deserialize, Serialize};
/// The version of the newest assignment so far; 2 bytes.
///
/// One for each sender and kind of assignment, since each sender counts its own. A version is newer
/// when it is less than half the circle (1 to 127) ahead; one that is exactly 128 away counts as
/// old from both sides. A sender that starts anew may count from anywhere: its owner calls
/// [`Newest::forget`] when a [`SequenceWindow`](super::SequenceWindow) says
/// [`Arrival::Rebooted`](super::Arrival::Rebooted), or when it forgets the sender.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Newest {
    version: Option<u8>,
}

impl Newest {
    /// Nothing was assigned yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { version: None }
    }

    /// Whether `version` is newer than all before, or the first; remembers it if so. An assignment
    /// that comes again or late is not. Constant work.
    #[must_use = "an assignment that is not newer must not be followed"]
    pub fn admit(&mut self, version: u8) -> bool {
        let is_newer = self.is_news(version);
        if is_newer {
            self.version = Some(version);
        }
        is_newer
    }

    /// Whether [`Newest::admit`] would admit `version`; remembers nothing. For what may prove to be of no use. Constant work.
    #[must_use]
    pub fn is_news(self, version: u8) -> bool {
        self.version.is_none_or(|newest| version.wrapping_sub(newest).cast_signed() > 0)
    }

    /// The newest version so far; `None` before the first.
    #[must_use]
    pub const fn version(self) -> Option<u8> {
        self.version
    }

    /// Takes the next version as the first, whatever it is.
    pub fn forget(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn after(version: u8) -> Newest {
        let mut newest = Newest::new();
        assert!(newest.admit(version));
        newest
    }

    #[test]
    fn first_version_is_newest_whatever_it_is() {
        assert_eq!(Newest::new().version(), None);
        for version in 0..=u8::MAX {
            assert_eq!(after(version).version(), Some(version));
        }
    }

    #[test]
    fn newer_is_1_to_127_ahead_from_anywhere_on_the_circle() {
        for newest in 0..=u8::MAX {
            for ahead in 0..=u8::MAX {
                let version = newest.wrapping_add(ahead);
                let mut filter = after(newest);
                let is_newer = (1..=127).contains(&ahead);
                assert_eq!(filter.is_news(version), is_newer, "{newest} + {ahead}");
                assert_eq!(filter.version(), Some(newest), "asking changes nothing");
                assert_eq!(filter.admit(version), is_newer, "{newest} + {ahead}");
                let kept = if is_newer { version } else { newest };
                assert_eq!(filter.version(), Some(kept));
            }
        }
    }

    #[test]
    fn forgotten_count_starts_anywhere() {
        let mut filter = after(100);
        assert!(!filter.admit(7));
        filter.forget();
        assert!(filter.admit(7));
        assert!(!filter.admit(7));
    }

    proptest! {
        /// Versions counted by the sender, delivered late by up to 100: each is admitted exactly
        /// when it is the highest so far.
        #[test]
        fn late_and_repeated_versions_never_replace_a_newer_one(
            start: u8, lateness in vec((0..3_u32, 0..100_u32), 1..300),
        ) {
            let (mut sent, mut highest) = (0_u32, None);
            let mut filter = Newest::new();
            for (step, late) in lateness {
                sent += step;
                let count = sent.saturating_sub(late);
                let version = start.wrapping_add(count as u8);
                let is_newer = highest.is_none_or(|highest| count > highest);
                prop_assert_eq!(filter.admit(version), is_newer);
                highest = highest.max(Some(count));
            }
        }
    }
}
