//! Guidance law and safety layer chosen at run time, for simulators and configurable firmware.

use super::cell_follower::CellFollower;
use super::flock_guidance::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
use super::formation_guidance::{FormationGuidance, FormationInPlane};
use super::guidance::{BadInput, Decision, Guidance, GuidanceInput, Teamwork, ToAny};
use super::orca_safety::{FlySafety, OrcaSafety};
use super::other_safety::PushOutSafety;
#[cfg(feature = "published")]
use super::published_formation::PublishedFormation;
use super::route_guidance::{GridWorkspace, RouteGuidance};
use super::safety::{Safety, SafetyInput, Unguarded};
use super::waypoint_guidance::WaypointGuidance;
use super::{AnySurroundings, Surroundings, Waypoint};
#[cfg(feature = "published")]
use crate::formation::Course;
use crate::geom::{Vec2, Vec3};
use crate::grid::Cell;
use crate::neighbor::StalenessInflation;
use crate::orca::{self, HalfPlane, HalfSpaces, MovingBall};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// A large law: in place in firmware, allocated on a host, so small laws do not pay for its size.
#[cfg(not(feature = "host"))]
type Large<G> = G;
#[cfg(feature = "host")]
type Large<G> = alloc::boxed::Box<G>;

#[cfg(not(feature = "host"))]
pub(in crate::agent) const fn large<G>(law: G) -> Large<G> {
    law
}
#[cfg(feature = "host")]
pub(in crate::agent) fn large<G>(law: G) -> Large<G> {
    Large::new(law)
}

const fn inside<G>(law: &mut Large<G>) -> &mut G {
    law
}

/// Any guidance law, on the grid, in the plane or in space.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyGuidance<S, const CELLS: usize, const M: usize, const F: usize, const L: usize = 0> {
    Waypoint(WaypointGuidance<S>),
    Lattice(LatticeGuidance<S>),
    GoalFlock(GoalFlockGuidance<S>),
    Boids(BoidsGuidance<S>),
    Route(Large<CellFollower<S, RouteGuidance<CELLS, M, L>>>),
    Formation(Large<FormationInPlane<S, CELLS, M, F, L>>),
    RouteOnGrid(RouteGuidance<CELLS, M, L>),
    FormationOnGrid(Large<FormationGuidance<CELLS, M, F, L>>),
    #[cfg(feature = "published")]
    Published(Large<PublishedFormation<CELLS, M, F>>),
    #[cfg(feature = "published")]
    LooksAhead(Large<FormationGuidance<CELLS, M, F, L, Course>>),
}

macro_rules! each {
    ($any:expr, $inside:ident => $action:expr) => {
        match $any {
            AnyGuidance::Waypoint($inside) => $action,
            AnyGuidance::Lattice($inside) => $action,
            AnyGuidance::GoalFlock($inside) => $action,
            AnyGuidance::Boids($inside) => $action,
            AnyGuidance::Route($inside) => $action,
            AnyGuidance::Formation($inside) => $action,
            AnyGuidance::RouteOnGrid($inside) => $action,
            AnyGuidance::FormationOnGrid($inside) => $action,
            #[cfg(feature = "published")]
            AnyGuidance::Published($inside) => $action,
            #[cfg(feature = "published")]
            AnyGuidance::LooksAhead($inside) => $action,
        }
    };
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize> Teamwork
    for AnyGuidance<S, CELLS, M, F, L>
{
    fn redirect(&mut self) {
        each!(self, law => law.redirect());
    }

    fn note_stop(&mut self, is_asked: bool) {
        each!(self, law => law.note_stop(is_asked));
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_restarted: bool) -> bool {
        each!(self, law => law.assign_template(part, is_restarted))
    }

    fn goal_offset(&self) -> Cell {
        each!(self, law => law.goal_offset())
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(self, law => law.needs(id))
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize> Guidance<S>
    for AnyGuidance<S, CELLS, M, F, L>
{
    type Input<'a> = AnySurroundings<'a, S>;
    type Destination = ToAny;
    type Workspace = GridWorkspace<CELLS>;
    type Payload = ();

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S>,
        here: &AnySurroundings<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        let plane = || here.in_plane().ok_or(BadInput);
        let grid = || match here {
            AnySurroundings::OnGrid(grid) => Ok(grid),
            AnySurroundings::InPlane(_) | AnySurroundings::InCells(_) => Err(BadInput),
        };
        let cells = || match here {
            AnySurroundings::InCells(cells) => Ok(cells),
            AnySurroundings::OnGrid(_) | AnySurroundings::InPlane(_) => Err(BadInput),
        };
        match self {
            Self::Waypoint(law) => law.decide(input, &plane()?, rng, &mut ()),
            Self::Lattice(law) => law.decide(input, &plane()?, rng, &mut ()),
            Self::GoalFlock(law) => law.decide(input, &plane()?, rng, &mut ()),
            Self::Boids(law) => law.decide(input, &plane()?, rng, &mut ()),
            Self::Route(law) => law.decide(input, cells()?, rng, workspace),
            Self::Formation(law) => law.decide(input, cells()?, rng, workspace),
            Self::RouteOnGrid(law) => law.decide(input, grid()?, rng, workspace),
            Self::FormationOnGrid(law) => law.decide(input, grid()?, rng, workspace),
            #[cfg(feature = "published")]
            Self::Published(law) => law.decide(input, grid()?, rng, workspace),
            #[cfg(feature = "published")]
            Self::LooksAhead(law) => law.decide(input, grid()?, rng, workspace),
        }
    }

    fn goes_to_cells(&self) -> bool {
        !matches!(self, Self::Waypoint(_) | Self::Lattice(_) | Self::GoalFlock(_) | Self::Boids(_))
    }

    fn goes_by_velocity(&self) -> bool {
        !self.goes_to_cells() || matches!(self, Self::Route(_) | Self::Formation(_))
    }

    fn has_own_goal(&self) -> bool {
        match self {
            Self::Waypoint(law) => law.has_own_goal(),
            Self::Lattice(law) => law.has_own_goal(),
            Self::GoalFlock(law) => law.has_own_goal(),
            Self::Boids(law) => law.has_own_goal(),
            _ => false,
        }
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        each!(self, law => law.assign_waypoint(index, waypoint))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        match self {
            Self::Waypoint(law) => law.parameters(visit),
            Self::Lattice(law) => law.parameters(visit),
            Self::GoalFlock(law) => law.parameters(visit),
            Self::Boids(law) => law.parameters(visit),
            Self::Route(law) => law.parameters(visit),
            Self::Formation(law) => law.parameters(visit),
            Self::RouteOnGrid(law) => Guidance::<S>::parameters(law, visit),
            Self::FormationOnGrid(law) => Guidance::<S>::parameters(inside(law), visit),
            #[cfg(feature = "published")]
            Self::Published(law) => Guidance::<S>::parameters(inside(law), visit),
            #[cfg(feature = "published")]
            Self::LooksAhead(law) => Guidance::<S>::parameters(inside(law), visit),
        }
    }
}

/// Any source of half-planes: the formula, or the voxel table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyHalfPlanes {
    #[default]
    Analytic,
    Template2k,
}

impl<S: Scalar> HalfSpaces<S> for AnyHalfPlanes {
    type Velocity = Vec2<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec2<S>,
        disc: &MovingBall<Vec2<S>>,
        params: &orca::Params<S>,
    ) -> Option<HalfPlane<S>> {
        let own = own_velocity_mps;
        match self {
            Self::Analytic => orca::half_plane(own, disc, params),
            Self::Template2k => orca::VoxelTable2k.half_space(own, disc, params),
        }
    }
}

/// Any safety layer, with at most `K` half-planes.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = ""))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnySafety<S: Scalar, const K: usize> {
    Unguarded(Unguarded),
    Orca(OrcaSafety<S, K, AnyHalfPlanes>),
    Fly(FlySafety<S, K>),
    PushOut(PushOutSafety<S>),
}

impl<S: Scalar, const K: usize> Safety<S> for AnySafety<S, K> {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S> {
        match self {
            Self::Unguarded(safety) => safety.keep_clear(input, rng),
            Self::Orca(safety) => safety.keep_clear(input, rng),
            Self::Fly(safety) => safety.keep_clear(input, rng),
            Self::PushOut(safety) => safety.keep_clear(input, rng),
        }
    }

    fn inflation(&self) -> Option<StalenessInflation<S>> {
        match self {
            Self::Orca(safety) => safety.inflation(),
            Self::Fly(safety) => safety.inflation(),
            Self::Unguarded(_) | Self::PushOut(_) => None,
        }
    }

    fn waits_for_turn(&self) -> bool {
        match self {
            Self::Orca(safety) => safety.waits_for_turn(),
            Self::Unguarded(_) | Self::Fly(_) | Self::PushOut(_) => false,
        }
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        match self {
            Self::Unguarded(_) => {}
            Self::Orca(safety) => safety.parameters(visit),
            Self::Fly(safety) => safety.parameters(visit),
            Self::PushOut(safety) => safety.parameters(visit),
        }
    }
}
