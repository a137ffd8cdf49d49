//! The keys that a robot has: the swarm's, of one generation or of two while they change, and its own.

use super::{KeyAssignment, KeyPhase};
use crate::auth::{Key, Mac, Seed};
use serde::{Deserialize, Serialize};

/// The swarm's key of one generation.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Group {
    generation: u16,
    #[serde(with = "crate::digest::uncounted")]
    mac: Mac,
    #[serde(with = "crate::digest::uncounted")]
    seed: Option<Seed>,
}

/// By which key a frame was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Signer {
    /// The swarm's, of this generation: any robot that has it.
    Swarm(u16),
    /// The robot's own: its operator.
    Operator,
}

/// The keys of a robot. While a key is rolled it hears two generations and speaks one:
///
/// | told | hears | speaks |
/// | --- | --- | --- |
/// | [`KeyPhase::Hear`] | both | the old one |
/// | [`KeyPhase::Speak`] | both | the new one |
/// | [`KeyPhase::Forget`] | the new one | the new one |
///
/// A phase that comes without those before it brings them along, so that a robot that was off takes one message. Nothing goes back: of two generations
/// the later one stays, and who is told of an earlier one changes nothing.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ring {
    speaks: Group,
    /// The generation before, or the one to come.
    also: Option<Group>,
    #[serde(with = "crate::digest::uncounted")]
    own: Option<Mac>,
}

impl Ring {
    /// Of the swarm's first key, and no other.
    #[must_use]
    pub fn new(key: &Key) -> Self {
        Self { speaks: Group { generation: 0, mac: Mac::new(key), seed: None }, also: None, own: None }
    }

    /// Of the swarm's key of a generation.
    #[must_use]
    pub fn of_generation(generation: u16, seed: &Seed) -> Self {
        Self { speaks: Group::new(generation, seed), also: None, own: None }
    }

    /// The same with a key of its own.
    #[must_use]
    pub fn with_own(mut self, own: &Key) -> Self {
        self.own = Some(Mac::new(own));
        self
    }

    /// Its own key, if it has one.
    #[must_use]
    pub const fn own(&self) -> Option<&Mac> {
        self.own.as_ref()
    }

    /// What it speaks with.
    #[must_use]
    pub const fn speaks(&self) -> &Mac {
        &self.speaks.mac
    }

    /// The generation that it speaks.
    #[must_use]
    pub const fn generation(&self) -> u16 {
        self.speaks.generation
    }

    /// How far it is: the latest generation that it has, and what it does with it.
    #[must_use]
    pub fn held(&self) -> (u16, KeyPhase) {
        match &self.also {
            Some(also) if also.generation > self.speaks.generation => (also.generation, KeyPhase::Hear),
            Some(_) => (self.speaks.generation, KeyPhase::Speak),
            None => (self.speaks.generation, KeyPhase::Forget),
        }
    }

    /// What to keep in lasting memory after each change, for [`Self::of_generation`] at the next start and [`Self::hear`]: the seed that it speaks
    /// with, and the other one. `None` for a key that was not made of a seed.
    #[must_use]
    pub fn seeds(&self) -> [Option<(u16, &Seed)>; 2] {
        [Some(&self.speaks), self.also.as_ref()].map(|group| {
            let Group { generation, seed, .. } = group?;
            Some((*generation, seed.as_ref()?))
        })
    }

    /// By which key `is_made` says that a frame was made; the most likely one is asked first. At most three codes.
    pub fn signer(&self, is_made: impl Fn(&Mac) -> bool) -> Option<Signer> {
        let groups = [Some(&self.speaks), self.also.as_ref()];
        let group = groups.into_iter().flatten().find(|group| is_made(&group.mac));
        let own = || self.own.as_ref().filter(|own| is_made(own)).map(|_| Signer::Operator);
        group.map(|group| Signer::Swarm(group.generation)).or_else(own)
    }

    /// Hears a later generation than all before, too; the last one that there is a number for is none.
    pub fn hear(&mut self, generation: u16, seed: &Seed) {
        if generation > self.held().0 && generation < u16::MAX {
            self.also = Some(Group::new(generation, seed));
        }
    }

    /// Hears a later generation too, by a key that was made in another way.
    pub fn hear_key(&mut self, generation: u16, key: &Key) {
        if generation > self.held().0 && generation < u16::MAX {
            self.also = Some(Group { generation, mac: Mac::new(key), seed: None });
        }
    }

    /// Speaks this generation, if it is later than the one that it speaks.
    pub fn speak(&mut self, generation: u16) {
        if let Some(also) = &mut self.also
            && also.generation == generation
            && generation > self.speaks.generation
        {
            core::mem::swap(also, &mut self.speaks);
        }
    }

    /// Does not hear earlier generations than this one any more, if it speaks it.
    pub fn forget_before(&mut self, generation: u16) {
        if self.speaks.generation == generation && self.also.as_ref().is_some_and(|also| also.generation < generation) {
            self.also = None;
        }
    }

    /// Does what its operator says; whether the key was made for this robot. What is older than what it has changes nothing.
    ///
    /// Bounded work: twelve blocks of SHA-256.
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
