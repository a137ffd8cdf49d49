//! The configuration of a robot as data, for scenarios and host links; `f32` for any scalar type.

use super::{Agent, AgentConfig, AnyLaw, AnySafety, LawSettings, LayerSettings, WAYPOINTS, Waypoint};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::wire::{Format, FromFormat, Postcard, Wire};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// An agent with any law and safety layer: `CELLS` of a search, `M` remembered visits, `N`
/// neighbours, `K` half-planes, wire format `W`, `L` learned costs.
pub type AnyAgent<
    S,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    W = Postcard,
    const L: usize = 0,
> = Agent<S, AnyLaw<S, CELLS, M, L>, N, AnySafety<S, K>, W>;

/// The complete configuration of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setup {
    /// Id, seed, timing and body.
    pub agent: AgentConfig<f32>,
    /// The law.
    pub law: LawSettings,
    /// The safety layer.
    pub safety: LayerSettings,
    /// The wire format, equal for all robots of a swarm.
    pub format: Format,
}

/// The task of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Task {
    /// Go to this cell, or keep the formation whose top leader heads there.
    Cell(Cell),
    /// Go to these waypoints, given with their indices.
    Waypoints(Vec<(u8, Waypoint<f32>), WAYPOINTS>),
}

impl Setup {
    /// Creates the agent. Returns `None` if `W` cannot use the configured wire format.
    #[must_use]
    pub fn agent<
        S: Scalar,
        const CELLS: usize,
        const M: usize,
        const N: usize,
        const K: usize,
        W: FromFormat,
        const L: usize,
    >(
        &self,
    ) -> Option<AnyAgent<S, CELLS, M, N, K, W, L>> {
        Some(self.speaking(W::from_format(self.format)?))
    }

    /// Creates the agent with the given `wire`, ignoring [`Setup::format`].
    #[must_use]
    pub fn speaking<
        S: Scalar,
        const CELLS: usize,
        const M: usize,
        const N: usize,
        const K: usize,
        W: Wire,
        const L: usize,
    >(
        &self,
        wire: W,
    ) -> AnyAgent<S, CELLS, M, N, K, W, L> {
        Agent::new(&self.agent.cast(), self.law.law(()), self.safety.layer(), wire)
    }
}
