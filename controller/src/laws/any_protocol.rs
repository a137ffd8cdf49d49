//! Payloads, messages and orders of any law, for an enum of laws.

use super::cells::{Grid, GridMessage, GridOrder, GridPayload};
use super::waypoint::{WaypointOrder, Waypoints};
use crate::law::{OfAnotherLaw, Protocol};
use crate::time::Instant;
use crate::wire::{Bytes, Content, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD, Never, ProtocolId};
use serde::{Deserialize, Serialize};

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
