//! Parameters of a running robot that an operator or its firmware can change.

use super::{Agent, AgentConfig, Law, Perception, Safety};
use crate::parameters::{Parameters, RADIUS, Rejected, row};
use crate::scalar::Scalar;
use crate::wire::Wire;

crate::parameters! {
    impl[S: Scalar] AgentConfig<S> {
        RADIUS => radius_m,
        row("beacon_period_s", "BEACON_S", "s", [0.001, 60.0], "time between two beacons") => beacon_period,
    }
}

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Calls `visit` with each table of parameters: those of the agent, its law and its layer.
    pub fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.config);
        self.law.parameters(visit);
        self.safety.parameters(visit);
    }

    /// Returns the current value, or `None` if this robot does not have the parameter.
    pub fn parameter(&mut self, name: &str) -> Option<f32> {
        let mut found = None;
        self.parameters(&mut |table| found = found.or_else(|| table.get(table.index(name)?)));
        found
    }

    /// Changes a parameter from the next step on, in each table that has it.
    ///
    /// # Errors
    /// [`Rejected`] if no table accepts the value.
    pub fn set_parameter(&mut self, name: &str, value: f32) -> Result<(), Rejected> {
        let mut answer = Err(Rejected::Unknown);
        self.parameters(&mut |table| {
            if let Some(index) = table.index(name) {
                let set = table.set(index, value);
                answer = answer.or(set);
            }
        });
        answer
    }
}
