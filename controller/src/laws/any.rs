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
    Tools, View,
};
use crate::neighbor::Neighbor;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::{Bytes, Content, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD, Never, ProtocolId};
use serde::{Deserialize, Serialize};

/// A large law: in place in firmware, allocated on a host, so small laws do not pay for its size.
#[cfg(not(feature = "host"))]
pub type Large<G> = G;
#[cfg(feature = "host")]
#[expect(missing_docs, reason = "as without the feature")]
pub type Large<G> = alloc::boxed::Box<G>;

#[cfg(not(feature = "host"))]
pub(crate) const fn large<G>(law: G) -> Large<G> {
    law
}
#[cfg(feature = "host")]
pub(crate) fn large<G>(law: G) -> Large<G> {
    Large::new(law)
}

#[doc(hidden)]
pub const fn inside<G>(law: &Large<G>) -> &G {
    law
}

#[doc(hidden)]
pub const fn inside_mut<G>(law: &mut Large<G>) -> &mut G {
    law
}

/// Declares an enum of laws that is itself a law with [`AnyProtocol`]: one memory for any of them.
///
/// `of`: its scalar type. `in`: its scratch memory, which is `AsMut` of that of each law. Then the
/// generics of the `impl`, with bounds and as arguments. A law in [`Large`] is marked `large`.
///
/// ```
/// use staya_controller::agent::{CELLS, GridWorkspace, Law, RouteGuidance, WaypointGuidance};
///
/// staya_controller::laws! {
///     /// Drives, or goes from cell to cell.
///     #[derive(Clone, Debug)]
///     pub enum Rover[] of f32, in GridWorkspace<CELLS>, [] for [] {
///         Drives(WaypointGuidance<f32>),
///         Steps(RouteGuidance<CELLS, 32>),
///     }
/// }
/// fn is_law(_: impl Law<f32>) {}
/// is_law(Rover::Drives(WaypointGuidance::new(0.5, 0.02)));
/// ```
#[macro_export]
macro_rules! laws {
    (
        $(#[$about:meta])*
        $visible:vis enum $name:ident[$($declared:tt)*] of $number:ty,
        in $workspace:ty, [$($bounds:tt)*] for [$($arguments:tt)*] {
            $($(#[$attribute:meta])* $variant:ident($law:ty $(, $large:ident)?)),+ $(,)?
        }
    ) => {
        $(#[$about])*
        $visible enum $name<$($declared)*> {
            $($(#[$attribute])* $variant($law)),+
        }

        impl<$($bounds)*> $crate::agent::Law<$number> for $name<$($arguments)*> {
            type Surroundings<'a> = $crate::agent::AnySurroundings<'a, $number>;
            type Protocol = $crate::agent::AnyProtocol;
            type Workspace = $workspace;

            fn decide(
                &mut self,
                view: &$crate::agent::View<'_, $number, $crate::agent::AnyProtocol>,
                here: &$crate::agent::AnySurroundings<'_, $number>,
                tools: $crate::agent::Tools<'_, $number, Self>,
            ) -> Result<$crate::agent::Decision<$number>, $crate::agent::BadInput> {
                let $crate::agent::Tools { rng, mut radio, workspace } = tools;
                let sends = (rng, &mut radio);
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::decide(
                        $crate::laws!(@inside_mut law $($large)?), view, here, sends, workspace.as_mut(),
                    ),
                )+}
            }

            fn payload(
                &mut self,
                here: &$crate::agent::AnySurroundings<'_, $number>,
                heading: $crate::grid::Dir,
                radio: &mut $crate::agent::Radio<'_, $crate::agent::AnyProtocol>,
            ) -> $crate::agent::AnyPayload {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::payload(
                        $crate::laws!(@inside_mut law $($large)?), here, heading, radio,
                    ),
                )+}
            }

            #[inline(never)]
            fn receive(
                &mut self,
                from: $crate::robot::RobotId,
                message: &$crate::agent::AnyMessage,
                radio: &mut $crate::agent::Radio<'_, $crate::agent::AnyProtocol>,
            ) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::receive::<$number, _>(
                        $crate::laws!(@inside_mut law $($large)?), from, message, radio,
                    ),
                )+}
            }

            #[inline(never)]
            fn order(&mut self, order: &$crate::agent::AnyOrder) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::order::<$number, _>(
                        $crate::laws!(@inside_mut law $($large)?), order,
                    ),
                )+}
            }

            fn needs(&self, id: $crate::robot::RobotId) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::needs($crate::laws!(@inside law $($large)?), id)
                    }
                )+}
            }

            fn report(&self) -> $crate::agent::Report {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::report($crate::laws!(@inside law $($large)?))
                    }
                )+}
            }

            fn expects(&self, id: $crate::robot::RobotId) -> Option<$crate::grid::Cell> {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::expects($crate::laws!(@inside law $($large)?), id)
                    }
                )+}
            }

            fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn $crate::parameters::Parameters)) {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::parameters($crate::laws!(@inside_mut law $($large)?), visit)
                    }
                )+}
            }
        }
    };
    (@inside $law:ident) => { $law };
    (@inside $law:ident large) => { $crate::agent::dispatch::inside($law) };
    (@inside_mut $law:ident) => { $law };
    (@inside_mut $law:ident large) => { $crate::agent::dispatch::inside_mut($law) };
}

laws! {
    /// Any law, on the grid with a map `H`, in the plane or in space.
    #[derive(Clone, Debug, Serialize, Deserialize)]
    #[expect(missing_docs, reason = "each variant's type says it")]
    pub enum AnyLaw[S, const CELLS: usize, const M: usize, const F: usize, const L: usize = 0, H = ()] of S,
    in GridWorkspace<CELLS>,
    [S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H: FarMap]
    for [S, CELLS, M, F, L, H] {
        Waypoint(WaypointGuidance<S>),
        Lattice(LatticeGuidance<S>),
        GoalFlock(GoalFlockGuidance<S>),
        Boids(BoidsGuidance<S>),
        Route(Large<CellFollower<S, RouteGuidance<CELLS, M, L, H>>>, large),
        Formation(Large<FormationInPlane<S, CELLS, M, F, L, H>>, large),
        RouteOnGrid(RouteGuidance<CELLS, M, L, H>),
        FormationOnGrid(Large<FormationGuidance<CELLS, M, F, L, NextMove, H>>, large),
    }
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

        impl<'a> TryFrom<&'a $any> for &'a $one {
            type Error = OfAnotherLaw;
            fn try_from(any: &'a $any) -> Result<Self, OfAnotherLaw> {
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

        impl<'a> TryFrom<&'a $any> for &'a Never {
            type Error = OfAnotherLaw;
            fn try_from(_: &'a $any) -> Result<Self, OfAnotherLaw> {
                Err(OfAnotherLaw)
            }
        }
    )+};
}
never!(AnyMessage, AnyOrder);

/// The robots of an enum of laws as one of its laws knows them.
struct Narrow<'a, S>(&'a dyn Known<S, AnyPayload>);

impl<S: Scalar, Q: TryFrom<AnyPayload>> Known<S, Q> for Narrow<'_, S> {
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

/// What [`laws!`](crate::laws!) calls for each of its laws.
#[doc(hidden)]
pub mod dispatch {
    use super::*;

    pub use super::{inside, inside_mut};

    /// Decides.
    ///
    /// # Errors
    /// [`BadInput`] also for surroundings of another kind.
    pub fn decide<S: Scalar, L: Law<S>>(
        law: &mut L,
        view: &View<'_, S, AnyProtocol>,
        here: &AnySurroundings<'_, S>,
        (rng, radio): (&mut Rng, &mut Radio<'_, AnyProtocol>),
        workspace: &mut L::Workspace,
    ) -> Result<Decision<S>, BadInput>
    where
        PayloadOf<L, S>: TryFrom<AnyPayload>,
    {
        let here = L::Surroundings::try_from(*here).map_err(|_| BadInput)?;
        let known = Narrow(view.known);
        law.decide(&view.with(&known), &here, Tools { rng, radio: radio.of(), workspace })
    }

    /// Asks for the payload.
    pub fn payload<S: Scalar, L: Law<S>>(
        law: &mut L,
        here: &AnySurroundings<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload
    where
        AnyPayload: FromPayload<PayloadOf<L, S>>,
    {
        let Ok(here) = L::Surroundings::try_from(*here) else { return AnyPayload::default() };
        AnyPayload::from_payload(<L::Protocol as Protocol>::ID, law.payload(&here, heading, &mut radio.of()))
    }

    /// Gives a message.
    pub fn receive<S: Scalar, L: Law<S>>(
        law: &mut L,
        from: RobotId,
        message: &AnyMessage,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> bool
    where
        for<'a> &'a MessageOf<L, S>: TryFrom<&'a AnyMessage>,
    {
        <&MessageOf<L, S>>::try_from(message).is_ok_and(|message| law.receive(from, message, &mut radio.of()))
    }

    /// Gives an order.
    pub fn order<S: Scalar, L: Law<S>>(law: &mut L, order: &AnyOrder) -> bool
    where
        for<'a> &'a OrderOf<L, S>: TryFrom<&'a AnyOrder>,
    {
        <&OrderOf<L, S>>::try_from(order).is_ok_and(|order| law.order(order))
    }
}
