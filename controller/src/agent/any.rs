//! Law and safety layer chosen at run time, for simulators and configurable firmware.

use super::cell_follower::CellFollower;
use super::flock_guidance::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
use super::formation_guidance::{FormationGuidance, FormationInPlane};
use super::law::{BadInput, Decision, Law, MessageOf, OrderOf, Report, Tools, View};
use super::orca_safety::{FlySafety, OrcaSafety};
use super::other_safety::PushOutSafety;
use super::protocol::{AnyOrder, AnyProtocol, GridMessage, Radio};
use super::route_guidance::{GridWorkspace, RouteGuidance};
use super::safety::{Safety, SafetyInput, Unguarded};
use super::waypoint_guidance::WaypointGuidance;
use super::{AnySurroundings, FarMap, Protocol};
use crate::formation::NextMove;
use crate::geom::{Vec2, Vec3};
use crate::neighbor::StalenessInflation;
use crate::orca::{self, HalfPlane, HalfSpaces, MovingBall};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
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

fn inside<G>(law: &Large<G>) -> &G {
    law
}

fn inside_mut<G>(law: &mut Large<G>) -> &mut G {
    law
}

/// Any law, on the grid with a map `H`, in the plane or in space.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyLaw<S, const CELLS: usize, const M: usize, const F: usize, const L: usize = 0, H = ()> {
    Waypoint(WaypointGuidance<S>),
    Lattice(LatticeGuidance<S>),
    GoalFlock(GoalFlockGuidance<S>),
    Boids(BoidsGuidance<S>),
    Route(Large<CellFollower<S, RouteGuidance<CELLS, M, L, H>>>),
    Formation(Large<FormationInPlane<S, CELLS, M, F, L, H>>),
    RouteOnGrid(RouteGuidance<CELLS, M, L, H>),
    FormationOnGrid(Large<FormationGuidance<CELLS, M, F, L, NextMove, H>>),
}

macro_rules! each {
    ($any:expr, $inside:ident($large:ident) => $action:expr) => {
        match $any {
            AnyLaw::Waypoint($inside) => $action,
            AnyLaw::Lattice($inside) => $action,
            AnyLaw::GoalFlock($inside) => $action,
            AnyLaw::Boids($inside) => $action,
            AnyLaw::Route(law) => each!($large(law), $inside => $action),
            AnyLaw::Formation(law) => each!($large(law), $inside => $action),
            AnyLaw::RouteOnGrid($inside) => $action,
            AnyLaw::FormationOnGrid(law) => each!($large(law), $inside => $action),
        }
    };
    ($large:expr, $inside:ident => $action:expr) => {{
        let $inside = $large;
        $action
    }};
}

/// Decides with one law of an enum of laws. The last argument is `()` or the scratch memory.
///
/// # Errors
/// [`BadInput`] also for surroundings of another kind.
pub fn decide_as<S: Scalar, L>(
    law: &mut L,
    view: &View<'_, S>,
    here: &AnySurroundings<'_, S>,
    (rng, radio): (&mut Rng, &mut Radio<'_, GridMessage>),
    workspace: &mut L::Workspace,
) -> Result<Decision<S>, BadInput>
where
    L: Law<S, Protocol: Protocol<Payload = ()>>,
{
    let here = L::Surroundings::try_from(*here).map_err(|_| BadInput)?;
    law.decide(view, &here, Tools { rng, radio: radio.of(), workspace })
}

/// Gives a message to one law of an enum of laws.
pub fn receive_as<S: Scalar, L: Law<S>>(law: &mut L, from: RobotId, message: GridMessage) -> bool
where
    MessageOf<L, S>: TryFrom<GridMessage>,
{
    message.try_into().is_ok_and(|message| law.receive(from, message))
}

/// Gives an order to one law of an enum of laws.
pub fn order_as<S: Scalar, L: Law<S>>(law: &mut L, order: AnyOrder) -> bool
where
    OrderOf<L, S>: TryFrom<AnyOrder>,
{
    order.try_into().is_ok_and(|order| law.order(order))
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H: FarMap> Law<S>
    for AnyLaw<S, CELLS, M, F, L, H>
{
    type Surroundings<'a> = AnySurroundings<'a, S>;
    type Protocol = AnyProtocol;
    type Workspace = GridWorkspace<CELLS>;

    fn decide(
        &mut self,
        view: &View<'_, S>,
        here: &AnySurroundings<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        let sends = (rng, &mut radio);
        match self {
            Self::Waypoint(law) => decide_as(law, view, here, sends, &mut ()),
            Self::Lattice(law) => decide_as(law, view, here, sends, &mut ()),
            Self::GoalFlock(law) => decide_as(law, view, here, sends, &mut ()),
            Self::Boids(law) => decide_as(law, view, here, sends, &mut ()),
            Self::Route(law) => decide_as(inside_mut(law), view, here, sends, workspace),
            Self::Formation(law) => decide_as(inside_mut(law), view, here, sends, workspace),
            Self::RouteOnGrid(law) => decide_as(law, view, here, sends, workspace),
            Self::FormationOnGrid(law) => decide_as(inside_mut(law), view, here, sends, workspace),
        }
    }

    fn payload(&mut self, radio: &mut Radio<'_, GridMessage>) {
        each!(self, law(inside_mut) => Law::<S>::payload(law, &mut radio.of()));
    }

    fn receive(&mut self, from: RobotId, message: GridMessage) -> bool {
        each!(self, law(inside_mut) => receive_as::<S, _>(law, from, message))
    }

    fn order(&mut self, order: AnyOrder) -> bool {
        each!(self, law(inside_mut) => order_as::<S, _>(law, order))
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(self, law(inside) => Law::<S>::needs(law, id))
    }

    fn report(&self) -> Report {
        each!(self, law(inside) => Law::<S>::report(law))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, law(inside_mut) => Law::<S>::parameters(law, visit));
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
