//! Payloads, messages and orders of any law, for an enum of laws.

use super::cells::{Grid, GridMessage, GridOrder, GridPayload};
use super::waypoint::{WaypointOrder, Waypoints};
use crate::law::Protocol;
use crate::time::Instant;
use crate::wire::{Bytes, Content, MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD, ProtocolId};
use core::any::Any;
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

/// A protocol whose values an enum of laws can carry. For one of users: `impl InAny for Bids {}`.
pub trait InAny: Protocol {
    /// Returns the payload as one of any law.
    fn wrap(payload: Self::Payload) -> AnyPayload {
        let encoded = payload.encode::<MAX_PAYLOAD>(Self::ID);
        encoded.and_then(|(id, bytes)| AnyPayload::decode(ProtocolId::NONE, id, &bytes)).unwrap_or_default()
    }

    /// Returns the payload, if it is one of this protocol.
    fn payload(any: AnyPayload) -> Option<Self::Payload> {
        match any {
            AnyPayload::Empty(id) => Content::decode(Self::ID, id, &[]),
            AnyPayload::Grid(_) => None,
            AnyPayload::Other(other) => Content::decode(Self::ID, other.id, other.bytes()),
        }
    }

    /// Returns the message, if it is one of this protocol.
    fn message(any: &AnyMessage) -> Option<Self::Message> {
        match any {
            AnyMessage::Grid(_) => None,
            AnyMessage::Other(raw) => Content::decode(Self::ID, raw.id, &raw.bytes),
        }
    }

    /// Returns the order, if it is one of this protocol.
    fn order_in(any: &AnyOrder) -> Option<Self::Order> {
        match any {
            AnyOrder::Grid(order) => same(order),
            AnyOrder::Waypoint(order) => same(order),
            AnyOrder::Other(raw) => Content::decode(Self::ID, raw.id, &raw.bytes),
        }
    }
}

/// The value, if it has this type.
fn same<T: 'static, U: Clone + 'static>(value: &T) -> Option<U> {
    (value as &dyn Any).downcast_ref().cloned()
}

/// Reads the payloads of all laws that say nothing.
fn nothing(any: AnyPayload) -> Option<()> {
    matches!(any, AnyPayload::Empty(_)).then_some(())
}

impl InAny for () {
    fn payload(any: AnyPayload) -> Option<()> {
        nothing(any)
    }
}

impl InAny for Waypoints {
    fn payload(any: AnyPayload) -> Option<()> {
        nothing(any)
    }
}

impl InAny for Grid {
    fn wrap(payload: GridPayload) -> AnyPayload {
        AnyPayload::Grid(payload)
    }

    fn payload(any: AnyPayload) -> Option<GridPayload> {
        if let AnyPayload::Grid(payload) = any { Some(payload) } else { None }
    }

    fn message(any: &AnyMessage) -> Option<GridMessage> {
        if let AnyMessage::Grid(message) = any { Some(message.clone()) } else { None }
    }
}

impl InAny for AnyProtocol {
    fn wrap(payload: AnyPayload) -> AnyPayload {
        payload
    }

    fn payload(any: AnyPayload) -> Option<AnyPayload> {
        Some(any)
    }

    fn message(any: &AnyMessage) -> Option<AnyMessage> {
        Some(any.clone())
    }

    fn order_in(any: &AnyOrder) -> Option<AnyOrder> {
        Some(any.clone())
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

impl From<GridOrder> for AnyOrder {
    fn from(order: GridOrder) -> Self {
        Self::Grid(order)
    }
}

impl From<WaypointOrder> for AnyOrder {
    fn from(order: WaypointOrder) -> Self {
        Self::Waypoint(order)
    }
}

impl From<GridMessage> for AnyMessage {
    fn from(message: GridMessage) -> Self {
        Self::Grid(message)
    }
}
