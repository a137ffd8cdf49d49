//! The keys of a robot: its own key, and the swarm's key in one generation, or two during a change.

use super::{KeyAssignment, KeyPhase};
use crate::auth::{Key, Mac, Seed};
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Group {
    generation: u16,
    #[serde(with = "crate::digest::uncounted")]
    mac: Mac,
    #[serde(with = "crate::digest::uncounted")]
    seed: Option<Seed>,
}

/// The key with which a frame was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Signer {
    /// The swarm's key of this generation, which any of its robots may hold.
    Swarm(u16),
    /// The robot's own key, which its operator holds.
    Operator,
}

/// The keys of a robot. During a key change the robot accepts two generations and sends with one:
///
/// | last phase received | accepts | sends with |
/// | --- | --- | --- |
/// | [`KeyPhase::Hear`] | both | the old key |
/// | [`KeyPhase::Speak`] | both | the new key |
/// | [`KeyPhase::Forget`] | the new key | the new key |
///
/// A phase includes all phases before it, so a robot that was switched off needs only one message.
/// An assignment of an earlier generation has no effect.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ring {
    speaks: Group,
    /// The previous or the next generation.
    also: Option<Group>,
    #[serde(with = "crate::digest::uncounted")]
    own: Option<Mac>,
}

impl Ring {
    /// Creates a ring with only the swarm's first key.
    #[must_use]
    pub fn new(key: &Key) -> Self {
        Self { speaks: Group { generation: 0, mac: Mac::new(key), seed: None }, also: None, own: None }
    }

    /// Creates a ring with only the swarm's key of `generation`.
    #[must_use]
    pub fn of_generation(generation: u16, seed: &Seed) -> Self {
        Self { speaks: Group::new(generation, seed), also: None, own: None }
    }

    /// Adds the robot's own key.
    #[must_use]
    pub fn with_own(mut self, own: &Key) -> Self {
        self.own = Some(Mac::new(own));
        self
    }

    /// The robot's own key, if it has one.
    #[must_use]
    pub const fn own(&self) -> Option<&Mac> {
        self.own.as_ref()
    }

    /// The key that the robot sends with.
    #[must_use]
    pub const fn speaks(&self) -> &Mac {
        &self.speaks.mac
    }

    /// The generation that the robot sends with.
    #[must_use]
    pub const fn generation(&self) -> u16 {
        self.speaks.generation
    }

    /// The latest generation that the robot has, and the stage of its change.
    #[must_use]
    pub fn held(&self) -> (u16, KeyPhase) {
        match &self.also {
            Some(also) if also.generation > self.speaks.generation => (also.generation, KeyPhase::Hear),
            Some(_) => (self.speaks.generation, KeyPhase::Speak),
            None => (self.speaks.generation, KeyPhase::Forget),
        }
    }

    /// The seeds to store after each change, if keys have them: first the one for
    /// [`Self::of_generation`] at the next start, then the one for [`Self::hear`].
    #[must_use]
    pub fn seeds(&self) -> [Option<(u16, &Seed)>; 2] {
        [Some(&self.speaks), self.also.as_ref()].map(|group| {
            let Group { generation, seed, .. } = group?;
            Some((*generation, seed.as_ref()?))
        })
    }

    /// Finds the key for which `is_made` returns true, most likely first; at most three calls.
    pub fn signer(&self, is_made: impl Fn(&Mac) -> bool) -> Option<Signer> {
        let groups = [Some(&self.speaks), self.also.as_ref()];
        let group = groups.into_iter().flatten().find(|group| is_made(&group.mac));
        let own = || self.own.as_ref().filter(|own| is_made(own)).map(|_| Signer::Operator);
        group.map(|group| Signer::Swarm(group.generation)).or_else(own)
    }

    /// Also accepts a generation later than all others; the generation `u16::MAX` does not exist.
    pub fn hear(&mut self, generation: u16, seed: &Seed) {
        if generation > self.held().0 && generation < u16::MAX {
            self.also = Some(Group::new(generation, seed));
        }
    }

    /// Like [`Self::hear`], with a key that was not derived from a seed.
    pub fn hear_key(&mut self, generation: u16, key: &Key) {
        if generation > self.held().0 && generation < u16::MAX {
            self.also = Some(Group { generation, mac: Mac::new(key), seed: None });
        }
    }

    /// Sends with this generation from now on, if it is held and later than the present one.
    pub fn speak(&mut self, generation: u16) {
        if let Some(also) = &mut self.also
            && also.generation == generation
            && generation > self.speaks.generation
        {
            core::mem::swap(also, &mut self.speaks);
        }
    }

    /// Rejects all earlier generations from now on, if the robot sends with this one.
    pub fn forget_before(&mut self, generation: u16) {
        if self.speaks.generation == generation && self.also.as_ref().is_some_and(|also| also.generation < generation) {
            self.also = None;
        }
    }

    /// Executes an assignment of the operator and returns whether its key was encrypted for this
    /// robot. Earlier generations have no effect. Twelve blocks of SHA-256.
    pub fn apply(&mut self, told: &KeyAssignment) -> bool {
        let seed = self.own.as_ref().and_then(|own| Seed::unwrap(own, told.generation, &told.wrapped));
        let Some(seed) = seed else {
            return false;
        };
        self.hear(told.generation, &seed);
        if told.phase >= KeyPhase::Speak {
            self.speak(told.generation);
        }
        if told.phase == KeyPhase::Forget {
            self.forget_before(told.generation);
        }
        true
    }
}

impl Group {
    fn new(generation: u16, seed: &Seed) -> Self {
        Self { generation, mac: Mac::new(&seed.key(generation)), seed: Some(seed.clone()) }
    }
}

#[cfg(test)]
mod tests;
