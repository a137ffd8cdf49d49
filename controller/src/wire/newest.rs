//! Orders assignments by a version number that wraps.

use serde::{Deserialize, Serialize};
/// The version of the newest assignment of one kind by one sender; 2 bytes.
///
/// A version is newer if it is 1 to 127 ahead on the circle of 256 values. A restarted sender may
/// count from anywhere: call [`Newest::forget`] when a [`SequenceWindow`](super::SequenceWindow)
/// reports [`Arrival::Rebooted`](super::Arrival::Rebooted), or when the sender is dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Newest {
    version: Option<u8>,
}

impl Newest {
    /// Creates an instance without a version.
    #[must_use]
    pub const fn new() -> Self {
        Self { version: None }
    }

    /// Records `version` and returns true if it is the first or newer than all before.
    #[must_use = "an assignment that is not newer must not be followed"]
    pub fn admit(&mut self, version: u8) -> bool {
        let is_newer = self.is_news(version);
        if is_newer {
            self.version = Some(version);
        }
        is_newer
    }

    /// Whether [`Newest::admit`] would accept `version`, for assignments that may prove unusable.
    #[must_use]
    pub fn is_news(self, version: u8) -> bool {
        self.version.is_none_or(|newest| version.wrapping_sub(newest).cast_signed() > 0)
    }

    /// The newest version so far; `None` before the first.
    #[must_use]
    pub const fn version(self) -> Option<u8> {
        self.version
    }

    /// Forgets the version, so that any next version is accepted.
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
    fn first_version_is_always_accepted() {
        assert_eq!(Newest::new().version(), None);
        for version in 0..=u8::MAX {
            assert_eq!(after(version).version(), Some(version));
        }
    }

    #[test]
    fn version_1_to_127_ahead_is_newer_from_any_start() {
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
    fn any_version_is_accepted_after_forget() {
        let mut filter = after(100);
        assert!(!filter.admit(7));
        filter.forget();
        assert!(filter.admit(7));
        assert!(!filter.admit(7));
    }

    proptest! {
        /// Each is admitted exactly if it is the highest so far.
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
