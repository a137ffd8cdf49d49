//! The configuration of a robot as data, for scenarios and host links; `f32` for any scalar type.

use super::{
    Agent, AgentConfig, AnyHalfPlanes, AnyLaw, AnySafety, FlySafety, LawSettings, OrcaSafety, PushOutSafety, TEMPLATE,
    Unguarded, WAYPOINTS, Waypoint,
};
use crate::grid::Cell;
use crate::names::named;
use crate::neighbor::StalenessInflation;
use crate::orca::{AvoidParams, InSpace};
use crate::push_out::PushOutParams;
use crate::scalar::{Scalar, cast};
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
> = Agent<S, AnyLaw<S, CELLS, M, TEMPLATE, L>, N, AnySafety<S, K>, W>;

/// The complete configuration of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setup {
    /// Id, seed, timing and body.
    pub agent: AgentConfig<f32>,
    /// The law.
    pub law: LawSettings,
    /// The safety layer.
    pub safety: SafetySetup,
    /// The wire format, equal for all robots of a swarm.
    pub format: Format,
}

/// A safety layer with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "the safety layers document them")]
pub enum SafetySetup {
    None,
    Orca { params: AvoidParams<f32>, inflation: StalenessInflation<f32>, source: AnyHalfPlanes },
    Fly { params: AvoidParams<f32>, inflation: StalenessInflation<f32>, downwash: f32 },
    PushOut { params: PushOutParams<f32> },
}

named! {
    /// A safety layer by name.
    #[derive(Default)]
    pub enum SafetyKind {
        /// No safety layer.
        None = "none",
        /// ORCA with exact half-planes.
        #[default]
        Orca = "orca",
        /// ORCA with half-planes from the voxel table (A. Tolok and others, FVM) of 2 KiB.
        Template2k = "template_2k",
        /// ORCA in space, for flying robots.
        Fly = "fly",
        /// Push-out (PAV).
        PushOut = "push_out",
    }
}

impl SafetyKind {
    /// Returns the layer with the parameters that it uses; in space, without downwash.
    #[must_use]
    pub const fn setup(
        self,
        params: AvoidParams<f32>,
        inflation: StalenessInflation<f32>,
        push_out: PushOutParams<f32>,
    ) -> SafetySetup {
        let source = match self {
            Self::None => return SafetySetup::None,
            Self::Fly => return SafetySetup::Fly { params, inflation, downwash: 1.0 },
            Self::PushOut => return SafetySetup::PushOut { params: push_out },
            Self::Orca => AnyHalfPlanes::Analytic,
            Self::Template2k => AnyHalfPlanes::Template2k,
        };
        SafetySetup::Orca { params, inflation, source }
    }
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
        Agent::new(&self.agent.cast(), self.law.law(()), self.safety.safety(), wire)
    }
}

impl SafetySetup {
    /// Returns the name of the layer.
    #[must_use]
    pub const fn kind(&self) -> SafetyKind {
        match self {
            Self::None => SafetyKind::None,
            Self::Orca { source, .. } => match source {
                AnyHalfPlanes::Analytic => SafetyKind::Orca,
                AnyHalfPlanes::Template2k => SafetyKind::Template2k,
            },
            Self::Fly { .. } => SafetyKind::Fly,
            Self::PushOut { .. } => SafetyKind::PushOut,
        }
    }

    /// Creates the safety layer.
    #[must_use]
    pub fn safety<S: Scalar, const K: usize>(&self) -> AnySafety<S, K> {
        match self {
            Self::None => AnySafety::Unguarded(Unguarded),
            Self::Orca { params, inflation, source } => {
                AnySafety::Orca(OrcaSafety::with_source(params.cast(), inflation.cast(), *source))
            }
            Self::Fly { params, inflation, downwash } => {
                let source = InSpace { downwash: cast(*downwash) };
                AnySafety::Fly(FlySafety::with_source(params.cast(), inflation.cast(), source))
            }
            Self::PushOut { params } => AnySafety::PushOut(PushOutSafety::new(params.cast())),
        }
    }
}
