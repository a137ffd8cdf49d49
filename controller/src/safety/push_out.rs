//! Push-out as a safety layer.

use super::{Safety, SafetyInput};
use crate::geom::Vec3;
use crate::parameters::Parameters;
use crate::push_out::{PushOutParams, push_out};
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Push-out (V. E. and V. V. Pavlovsky, PAV): corrects steps that lead too near to the current
/// positions of other robots, without a prediction of their motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct PushOutSafety<S> {
    params: PushOutParams<S>,
}

impl<S: Scalar> PushOutSafety<S> {
    /// Creates a layer with these parameters.
    #[must_use]
    pub const fn new(params: PushOutParams<S>) -> Self {
        Self { params }
    }
}

impl<S: Scalar> Safety<S> for PushOutSafety<S> {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, _: &mut Rng) -> Vec3<S> {
        push_out(&self.params, &input.body, input.wish_mps, input.nearby, input.obstacles)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
    }
}
