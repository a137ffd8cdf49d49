//! Random draws of scenes.

use staya_controller::rand::Rng;

const PURPOSE: u32 = 0x0053_0001;

/// Draws of one scene, a function of its seed.
#[derive(Debug)]
pub struct Draw(Rng);

impl Draw {
    /// Creates the draws of the scene with this seed.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        Self(Rng::keyed(seed.into(), PURPOSE, 0, 0))
    }

    /// A number from `low` to `high`, each equally likely.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.below(1_000_001)) / 1e6
    }

    /// A number from `low` to `high`, both above 0, each order of magnitude equally likely.
    pub fn spread(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.within(0.0, 1.0))
    }

    /// A whole number from `low` to `high`.
    pub fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + self.0.below(high - low + 1)
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    /// One of the values.
    pub fn one<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.whole(0, values.len() as u32 - 1) as usize]
    }

    /// Puts the values into random order.
    pub fn shuffle<T>(&mut self, values: &mut [T]) {
        for at in (1..values.len()).rev() {
            values.swap(at, self.whole(0, at as u32) as usize);
        }
    }
}
