//! Optimal reciprocal collision avoidance as a safety layer.

use super::{Safety, SafetyInput};
use crate::geom::Vec3;
use crate::neighbor::StalenessInflation;
use crate::orca::{Analytic, AvoidParams, Avoider, Dimension, HalfSpaces, InSpace};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// An [`Avoider`] as a safety layer; its source `P` acts in the plane (heights unchanged) or in
/// space.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = "P: serde::Deserialize<'de>, Avoider<S, K, P>: serde::Deserialize<'de>"))]
pub struct OrcaSafety<S: Scalar, const K: usize, P: HalfSpaces<S> = Analytic> {
    avoider: Avoider<S, K, P>,
    inflation: StalenessInflation<S>,
}

/// ORCA for flying robots, with at most `K` half-spaces.
pub type FlySafety<S, const K: usize> = OrcaSafety<S, K, InSpace<S>>;

impl<S: Scalar, const K: usize> OrcaSafety<S, K> {
    /// Creates a layer in the plane; `inflation` is the growth of the balls of silent neighbours.
    #[must_use]
    pub const fn new(params: AvoidParams<S>, inflation: StalenessInflation<S>) -> Self {
        Self::with_source(params, inflation, Analytic)
    }
}

impl<S: Scalar, const K: usize> FlySafety<S, K> {
    /// Creates a layer in space. For rotors, use [`OrcaSafety::with_source`] with
    /// [`InSpace::downwash`] so that robots avoid each other's downwash.
    #[must_use]
    pub const fn in_space(params: AvoidParams<S>, inflation: StalenessInflation<S>) -> Self {
        Self::with_source(params, inflation, InSpace { downwash: S::ONE })
    }
}

impl<S: Scalar, const K: usize, P: HalfSpaces<S>> OrcaSafety<S, K, P> {
    /// Creates a layer with constraints from `source`.
    #[must_use]
    pub const fn with_source(params: AvoidParams<S>, inflation: StalenessInflation<S>, source: P) -> Self {
        Self { avoider: Avoider::with_source(params, source), inflation }
    }

    /// The avoider, for inspection.
    #[must_use]
    pub const fn avoider(&self) -> &Avoider<S, K, P> {
        &self.avoider
    }
}

impl<S: Scalar, const K: usize, P: HalfSpaces<S>> Safety<S> for OrcaSafety<S, K, P> {
    #[inline(never)]
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S> {
        let solution = self.avoider.velocity(
            &input.body,
            input.wish_mps.into(),
            input.way_m.map(Into::into),
            input.nearby,
            input.obstacles,
            rng,
        );
        solution.velocity_mps.at_height(input.wish_mps.z)
    }

    fn inflation(&self) -> Option<StalenessInflation<S>> {
        Some(self.inflation)
    }

    fn downwash(&self) -> S {
        self.avoider.source().downwash()
    }

    fn waits_for_turn(&self) -> bool {
        self.avoider.waits_for_turn()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self.avoider.params_mut());
    }
}
