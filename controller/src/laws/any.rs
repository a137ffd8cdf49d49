//! Law chosen at run time, for simulators and configurable firmware.

use super::boids::BoidsGuidance;
use super::cells::{CellFollower, FarMap, Grid, GridMessage, GridOrder, GridPayload, GridWorkspace};
use super::formation::{FormationGuidance, FormationInPlane};
use super::goal_flock::GoalFlockGuidance;
use super::lattice::LatticeGuidance;
use super::route::RouteGuidance;
use super::waypoint::{WaypointGuidance, WaypointOrder, Waypoints};
use crate::formation::NextMove;
use crate::grid::Dir;
use crate::law::{
    AnySurroundings, BadInput, Decision, Known, Law, MessageOf, OfAnotherLaw, OrderOf, PayloadOf, Protocol, Radio,
    Report, Tools, View,
};
use crate::neighbor::Neighbor;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::{Bytes, Content, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD, Never, ProtocolId};
use serde::{Deserialize, Serialize};

/// A large law: in place in firmware, allocated on a host, so small laws do not pay for its size.
#[cfg(not(feature = "host"))]
type Large<G> = G;
#[cfg(feature = "host")]
type Large<G> = alloc::boxed::Box<G>;

#[cfg(not(feature = "host"))]
pub(crate) const fn large<G>(law: G) -> Large<G> {
    law
}
#[cfg(feature = "host")]
pub(crate) fn large<G>(law: G) -> Large<G> {
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

/// The protocol of an enum of built-in laws: each law speaks its own.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnyProtocol {}

impl Protocol for AnyProtocol {
    const ID: ProtocolId = ProtocolId::NONE;
    type Payload = AnyPayload;
    type Message = AnyMessage;
    type Order = AnyOrder;

    fn subject(message: &AnyMessage) -> u32 {
        match message {
            AnyMessage::Grid(message) => Grid::subject(message),
            AnyMessage::Other(_) => 0,
        }
    }

    fn order_subject(order: &AnyOrder) -> Option<u32> {
        match order {
            AnyOrder::Grid(order) => Grid::order_subject(order),
            AnyOrder::Waypoint(order) => Waypoints::order_subject(order),
            AnyOrder::Other(_) => Some(0),
        }
    }

    fn received(order: &mut AnyOrder, sent: Instant, is_restarted: bool) {
        match order {
            AnyOrder::Grid(order) => Grid::received(order, sent, is_restarted),
            AnyOrder::Waypoint(order) => Waypoints::received(order, sent, is_restarted),
            AnyOrder::Other(_) => {}
        }
    }
}

/// The bytes of a value of a protocol of users.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Raw<const N: usize> {
    /// The protocol.
    pub id: ProtocolId,
    /// The bytes.
    pub bytes: Bytes<N>,
}

/// The payload of any law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnyPayload {
    /// Nothing but the number of the protocol.
    Empty(ProtocolId),
    /// Of a law on the grid.
    Grid(GridPayload),
    /// Of a protocol of users.
    Other(OtherPayload),
}

impl Default for AnyPayload {
    fn default() -> Self {
        Self::Empty(ProtocolId::NONE)
    }
}

/// Made of the payload of one law of an enum.
pub trait FromPayload<T> {
    /// Wraps the payload of a law with protocol `own`.
    fn from_payload(own: ProtocolId, payload: T) -> Self;
}

impl FromPayload<()> for AnyPayload {
    fn from_payload(own: ProtocolId, (): ()) -> Self {
        Self::Empty(own)
    }
}

impl FromPayload<GridPayload> for AnyPayload {
    fn from_payload(_: ProtocolId, payload: GridPayload) -> Self {
        Self::Grid(payload)
    }
}

impl FromPayload<Self> for AnyPayload {
    fn from_payload(_: ProtocolId, payload: Self) -> Self {
        payload
    }
}

/// The payload of a protocol of users.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OtherPayload {
    id: ProtocolId,
    len: u8,
    bytes: [u8; MAX_PAYLOAD],
}

impl OtherPayload {
    pub(crate) fn new(id: ProtocolId, payload: &[u8]) -> Option<Self> {
        let mut other = Self { id, len: u8::try_from(payload.len()).ok()?, ..Self::default() };
        other.bytes.get_mut(..payload.len())?.copy_from_slice(payload);
        Some(other)
    }

    /// The protocol.
    #[must_use]
    pub const fn id(&self) -> ProtocolId {
        self.id
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.len)).unwrap_or_default()
    }
}

/// A message of any law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyMessage {
    Grid(GridMessage),
    Other(Raw<MAX_CONTENT>),
}

/// An order to any law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyOrder {
    Grid(GridOrder),
    Waypoint(WaypointOrder),
    Other(Raw<MAX_ORDER>),
}

impl Content for AnyPayload {
    fn encode<const N: usize>(&self, _: ProtocolId) -> Option<(ProtocolId, Bytes<N>)> {
        match self {
            Self::Empty(id) => Some((*id, Bytes::new())),
            Self::Grid(payload) => payload.encode(Grid::ID),
            Self::Other(other) => Some((other.id, Bytes::from_slice(other.bytes()).ok()?)),
        }
    }

    fn decode(_: ProtocolId, id: ProtocolId, bytes: &[u8]) -> Option<Self> {
        match id {
            _ if bytes.is_empty() => Some(Self::Empty(id)),
            Grid::ID => Content::decode(id, id, bytes).map(Self::Grid),
            _ => OtherPayload::new(id, bytes).map(Self::Other),
        }
    }
}

impl<const N: usize> Raw<N> {
    pub(crate) fn new(id: ProtocolId, bytes: &[u8]) -> Option<Self> {
        Some(Self { id, bytes: Bytes::from_slice(bytes).ok()? })
    }

    fn encode<const M: usize>(&self) -> Option<(ProtocolId, Bytes<M>)> {
        Some((self.id, Bytes::from_slice(&self.bytes).ok()?))
    }
}

impl Content for AnyMessage {
    fn encode<const N: usize>(&self, _: ProtocolId) -> Option<(ProtocolId, Bytes<N>)> {
        match self {
            Self::Grid(message) => message.encode(Grid::ID),
            Self::Other(raw) => raw.encode(),
        }
    }

    fn decode(_: ProtocolId, id: ProtocolId, bytes: &[u8]) -> Option<Self> {
        match id {
            Grid::ID => Content::decode(id, id, bytes).map(Self::Grid),
            ProtocolId::NONE | Waypoints::ID => None,
            _ => Raw::new(id, bytes).map(Self::Other),
        }
    }
}

impl Content for AnyOrder {
    fn encode<const N: usize>(&self, _: ProtocolId) -> Option<(ProtocolId, Bytes<N>)> {
        match self {
            Self::Grid(order) => order.encode(Grid::ID),
            Self::Waypoint(order) => order.encode(Waypoints::ID),
            Self::Other(raw) => raw.encode(),
        }
    }

    fn decode(_: ProtocolId, id: ProtocolId, bytes: &[u8]) -> Option<Self> {
        match id {
            Grid::ID => Content::decode(id, id, bytes).map(Self::Grid),
            Waypoints::ID => Content::decode(id, id, bytes).map(Self::Waypoint),
            ProtocolId::NONE => None,
            _ => Raw::new(id, bytes).map(Self::Other),
        }
    }
}

macro_rules! one_of {
    ($any:ident { $($variant:ident($one:ty)),+ }) => {$(
        impl From<$one> for $any {
            fn from(one: $one) -> Self {
                Self::$variant(one)
            }
        }

        impl TryFrom<$any> for $one {
            type Error = OfAnotherLaw;
            fn try_from(any: $any) -> Result<Self, OfAnotherLaw> {
                match any {
                    $any::$variant(one) => Ok(one),
                    _ => Err(OfAnotherLaw),
                }
            }
        }
    )+};
}

impl TryFrom<AnyPayload> for GridPayload {
    type Error = OfAnotherLaw;
    fn try_from(any: AnyPayload) -> Result<Self, OfAnotherLaw> {
        if let AnyPayload::Grid(payload) = any { Ok(payload) } else { Err(OfAnotherLaw) }
    }
}

one_of!(AnyMessage { Grid(GridMessage) });
one_of!(AnyOrder { Grid(GridOrder), Waypoint(WaypointOrder) });

impl TryFrom<AnyPayload> for () {
    type Error = OfAnotherLaw;
    fn try_from(any: AnyPayload) -> Result<Self, OfAnotherLaw> {
        if matches!(any, AnyPayload::Empty(_)) { Ok(()) } else { Err(OfAnotherLaw) }
    }
}

impl From<Never> for AnyMessage {
    fn from(never: Never) -> Self {
        match never {}
    }
}

macro_rules! never {
    ($($any:ty),+) => {$(
        impl TryFrom<$any> for Never {
            type Error = OfAnotherLaw;
            fn try_from(_: $any) -> Result<Self, OfAnotherLaw> {
                Err(OfAnotherLaw)
            }
        }
    )+};
}
never!(AnyMessage, AnyOrder);

/// The robots of an enum of laws with payload `P` as one of its laws knows them.
pub struct Narrow<'a, S, P>(pub &'a dyn Known<S, P>);

impl<S, P, Q: TryFrom<P>> Known<S, Q> for Narrow<'_, S, P>
where
    S: Scalar,
{
    fn count(&self) -> usize {
        self.0.count()
    }

    fn at(&self, index: usize) -> Option<Neighbor<S, Q>> {
        self.0.at(index).map(|robot| robot.map(|payload| payload.try_into().ok()))
    }

    fn find(&self, id: RobotId) -> Option<Neighbor<S, Q>> {
        self.0.find(id).map(|robot| robot.map(|payload| payload.try_into().ok()))
    }
}

/// Decides with one law of an enum of laws with protocol `P`. The last argument is `()` or the
/// scratch memory.
///
/// # Errors
/// [`BadInput`] also for surroundings of another kind.
pub fn decide_as<S: Scalar, L: Law<S>, P: Protocol>(
    law: &mut L,
    view: &View<'_, S, P>,
    here: &AnySurroundings<'_, S>,
    (rng, radio): (&mut Rng, &mut Radio<'_, P>),
    workspace: &mut L::Workspace,
) -> Result<Decision<S>, BadInput>
where
    PayloadOf<L, S>: TryFrom<P::Payload>,
{
    let here = L::Surroundings::try_from(*here).map_err(|_| BadInput)?;
    let known = Narrow(view.known);
    law.decide(&view.with(&known), &here, Tools { rng, radio: radio.of(), workspace })
}

/// Asks one law of an enum of laws for its payload.
pub fn payload_as<S: Scalar, L: Law<S>, P: Protocol>(
    law: &mut L,
    here: &AnySurroundings<'_, S>,
    heading: Dir,
    radio: &mut Radio<'_, P>,
) -> P::Payload
where
    P::Payload: FromPayload<PayloadOf<L, S>>,
{
    let Ok(here) = L::Surroundings::try_from(*here) else { return Default::default() };
    P::Payload::from_payload(<L::Protocol as Protocol>::ID, law.payload(&here, heading, &mut radio.of()))
}

/// Gives a message to one law of an enum of laws.
pub fn receive_as<S: Scalar, L: Law<S>, P: Protocol>(
    law: &mut L,
    from: RobotId,
    message: &P::Message,
    radio: &mut Radio<'_, P>,
) -> bool
where
    MessageOf<L, S>: TryFrom<P::Message>,
{
    message.clone().try_into().is_ok_and(|message| law.receive(from, &message, &mut radio.of()))
}

/// Gives an order to one law of an enum of laws.
pub fn order_as<S: Scalar, L: Law<S>, O: Clone>(law: &mut L, order: &O) -> bool
where
    OrderOf<L, S>: TryFrom<O>,
{
    order.clone().try_into().is_ok_and(|order| law.order(&order))
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H: FarMap> Law<S>
    for AnyLaw<S, CELLS, M, F, L, H>
{
    type Surroundings<'a> = AnySurroundings<'a, S>;
    type Protocol = AnyProtocol;
    type Workspace = GridWorkspace<CELLS>;

    fn decide(
        &mut self,
        view: &View<'_, S, AnyProtocol>,
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

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        each!(self, law(inside_mut) => payload_as(law, here, heading, radio))
    }

    #[inline(never)]
    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        let (AnyMessage::Grid(message), radio) = (message, &mut radio.of()) else { return false };
        match self {
            Self::Route(law) => inside_mut(law).receive(from, message, radio),
            Self::Formation(law) => inside_mut(law).receive(from, message, radio),
            Self::RouteOnGrid(law) => Law::<S>::receive(law, from, message, radio),
            Self::FormationOnGrid(law) => Law::<S>::receive(inside_mut(law), from, message, radio),
            Self::Waypoint(_) | Self::Lattice(_) | Self::GoalFlock(_) | Self::Boids(_) => false,
        }
    }

    #[inline(never)]
    fn order(&mut self, order: &AnyOrder) -> bool {
        match (self, order) {
            (Self::Waypoint(law), AnyOrder::Waypoint(order)) => law.order(order),
            (Self::Lattice(law), AnyOrder::Waypoint(order)) => law.order(order),
            (Self::GoalFlock(law), AnyOrder::Waypoint(order)) => law.order(order),
            (Self::Route(law), AnyOrder::Grid(order)) => inside_mut(law).order(order),
            (Self::Formation(law), AnyOrder::Grid(order)) => inside_mut(law).order(order),
            (Self::RouteOnGrid(law), AnyOrder::Grid(order)) => Law::<S>::order(law, order),
            (Self::FormationOnGrid(law), AnyOrder::Grid(order)) => Law::<S>::order(inside_mut(law), order),
            _ => false,
        }
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
