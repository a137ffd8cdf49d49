//! The configuration of a robot as data, for scenarios and host links; `f32` for any scalar type.

use super::{
    Agent, AgentConfig, AnyHalfPlanes, AnyLaw, AnySafety, BoidsGuidance, CellFollower, FlySafety, FormationGuidance,
    FormationInPlane, GoalFlockGuidance, LatticeGuidance, OrcaSafety, PushOutSafety, RouteGuidance, TEMPLATE,
    Unguarded, WAYPOINTS, Waypoint, WaypointGuidance,
};
use crate::boids::BoidsParams;
use crate::formation::{FormationParams, NextMove};
use crate::goal_flock::GoalParams;
use crate::grid::Cell;
use crate::lattice::{LatticeParams, ReferenceMotion};
use crate::laws::any::large;
use crate::names::named;
use crate::neighbor::StalenessInflation;
use crate::orca::{AvoidParams, InSpace};
use crate::push_out::PushOutParams;
use crate::route::{Replan, RouteParams};
use crate::scalar::{Scalar, cast};
use crate::shuffle::Sharpness;
use crate::template::Template;
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
    /// The guidance law.
    pub guidance: GuidanceSetup,
    /// The safety layer.
    pub safety: SafetySetup,
    /// The wire format, equal for all robots of a swarm.
    pub format: Format,
}

/// Configuration of windowed routing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RouteSetup {
    /// Costs of a route.
    pub params: RouteParams,
    /// When to repeat the search.
    pub replan: Replan,
    /// How strictly the order of moves follows their weights.
    pub sharpness: Sharpness,
}

/// Configuration of boids, as input of [`BoidsParams::new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BoidsSetup {
    /// Distance below which a boid turns away, metres.
    pub crowded_m: f32,
    /// Distance up to which a neighbour counts, metres.
    pub closest_m: f32,
    /// Largest turn towards the mean heading and the centre, radians per step.
    pub max_turn: f32,
    /// Largest turn away, radians per step.
    pub max_turn_away: f32,
}

impl BoidsSetup {
    /// The values of the paper at a scale of one metre: 30, 150, 0.05, 0.02.
    pub const PAPER: Self = Self { crowded_m: 30.0, closest_m: 150.0, max_turn: 0.05, max_turn_away: 0.02 };

    /// Returns the parameters in the given scalar type.
    #[must_use]
    pub fn params<S: Scalar>(&self) -> BoidsParams<S> {
        BoidsParams::new(cast(self.crowded_m), cast(self.closest_m), cast(self.max_turn), cast(self.max_turn_away))
    }
}

/// A guidance law with its parameters. Speeds in m/s, lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "the constructors of the laws document them")]
pub enum GuidanceSetup {
    Waypoint {
        speed_mps: f32,
        tolerance_m: f32,
    },
    Lattice {
        params: LatticeParams<f32>,
        motion: ReferenceMotion<f32>,
    },
    GoalFlock {
        params: GoalParams<f32>,
        arrival_m: f32,
        seed: u64,
    },
    Boids {
        params: BoidsSetup,
        speed_mps: f32,
    },
    /// In the plane with a speed, cell by cell without one.
    Route {
        route: RouteSetup,
        speed_mps: Option<f32>,
    },
    Formation {
        route: RouteSetup,
        formation: FormationParams,
        template: Template<TEMPLATE>,
        speed_mps: Option<f32>,
    },
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
    /// A guidance law by name.
    #[derive(Default)]
    pub enum GuidanceKind {
        /// Straight to the goal.
        #[default]
        Waypoint = "waypoint",
        /// The alpha flock (R. Olfati-Saber, OLF), with the first goal as its reference.
        Lattice = "lattice",
        /// The goal flock (V. E. and V. V. Pavlovsky, PAV).
        GoalFlock = "goal_flock",
        /// Boids (V. A. Starovoitova, STA).
        Boids = "boids",
        /// Windowed routing on the grid (A. V. Kuznetsov, KUZ), cell by cell.
        Route = "route",
        /// Windowed routing on the grid in formation.
        Formation = "formation",
    }
}

impl GuidanceKind {
    /// Returns whether the law plans on the grid.
    #[must_use]
    pub const fn is_on_grid(self) -> bool {
        matches!(self, Self::Route | Self::Formation)
    }

    /// Returns whether each robot has a goal of its own, at which it stays.
    #[must_use]
    pub const fn has_goals(self) -> bool {
        matches!(self, Self::Waypoint | Self::Route | Self::Formation)
    }
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
        Agent::new(&self.agent.cast(), self.guidance.law(()), self.safety.safety(), wire)
    }

    /// Returns the `CELLS` of a [`CostField`](crate::route::CostField) that it needs; 0 for none.
    #[must_use]
    pub fn cells(&self) -> usize {
        match &self.guidance {
            GuidanceSetup::Route { route, .. } | GuidanceSetup::Formation { route, .. } => route.cells(),
            _ => 0,
        }
    }
}

impl GuidanceSetup {
    /// Returns the name of the law.
    #[must_use]
    pub const fn kind(&self) -> GuidanceKind {
        match self {
            Self::Waypoint { .. } => GuidanceKind::Waypoint,
            Self::Lattice { .. } => GuidanceKind::Lattice,
            Self::GoalFlock { .. } => GuidanceKind::GoalFlock,
            Self::Boids { .. } => GuidanceKind::Boids,
            Self::Route { .. } => GuidanceKind::Route,
            Self::Formation { .. } => GuidanceKind::Formation,
        }
    }

    /// Creates the law; laws on the grid take the `map`.
    #[must_use]
    pub fn law<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H>(
        &self,
        map: H,
    ) -> AnyLaw<S, CELLS, M, TEMPLATE, L, H> {
        match self {
            Self::Waypoint { speed_mps, tolerance_m } => {
                AnyLaw::Waypoint(WaypointGuidance::new(cast(*speed_mps), cast(*tolerance_m)))
            }
            Self::Lattice { params, motion } => {
                AnyLaw::Lattice(LatticeGuidance::following(params.cast(), motion.cast()))
            }
            Self::GoalFlock { params, arrival_m, seed } => {
                AnyLaw::GoalFlock(GoalFlockGuidance::new(params.cast(), cast(*arrival_m), *seed))
            }
            Self::Boids { params, speed_mps } => AnyLaw::Boids(BoidsGuidance::new(params.params(), cast(*speed_mps))),
            Self::Route { route, speed_mps } => {
                let guidance = route.law(map);
                match speed_mps {
                    Some(speed) => AnyLaw::Route(large(CellFollower::new(guidance, cast(*speed)))),
                    None => AnyLaw::RouteOnGrid(guidance),
                }
            }
            Self::Formation { route, formation, template, speed_mps } => {
                let guidance = FormationGuidance::steered(route.params, *formation, template.clone(), NextMove, map);
                let guidance = guidance.sharpness(route.sharpness);
                match speed_mps {
                    Some(speed) => AnyLaw::Formation(large(FormationInPlane::new(guidance, cast(*speed)))),
                    None => AnyLaw::FormationOnGrid(large(guidance)),
                }
            }
        }
    }
}

impl RouteSetup {
    const fn cells(&self) -> usize {
        let side = 2 * self.params.radius as usize + 3;
        side * side
    }

    /// Creates the law on the grid, with a map.
    #[must_use]
    pub const fn law<const CELLS: usize, const M: usize, const L: usize, H>(
        &self,
        map: H,
    ) -> RouteGuidance<CELLS, M, L, H> {
        RouteGuidance::with_map(self.params, map).replan(self.replan).sharpness(self.sharpness)
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
