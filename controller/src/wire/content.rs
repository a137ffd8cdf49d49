//! Payloads, messages and orders of laws as bytes of a frame.

use core::fmt::Debug;
use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Maximum length of a payload in bytes: a sealed beacon with it has 60 bytes.
pub const MAX_PAYLOAD: usize = 16;
/// Maximum length of a message to one robot in bytes, so that a pending one takes 36 bytes.
pub const MAX_MESSAGE: usize = 12;
/// Maximum length of a message to all robots, and of an order, in bytes.
pub const MAX_CONTENT: usize = 38;
/// Maximum length of an order in bytes.
pub const MAX_ORDER: usize = 34;

/// At most `N` bytes.
pub type Bytes<const N: usize> = Vec<u8, N, u8>;

/// The number of a protocol in each frame, so that no robot decodes the bytes of another protocol.
/// 0: none; 1 to 63: Staya's; 64 to 255: free for users, whose numbers can collide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct ProtocolId(pub u8);

impl ProtocolId {
    /// The protocol of laws that say nothing.
    pub const NONE: Self = Self(0);
}

/// A payload, a message or an order of a protocol: any small value that serde supports.
///
/// Postcard encodes an integer of more than 8 bits in up to 3, 5 or 10 bytes depending on its type,
/// a float in 4 or 8.
///
/// ```
/// use serde::{Deserialize, Serialize};
/// use staya_controller::wire::{Content, MAX_PAYLOAD, ProtocolId};
///
/// #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
/// struct Bid { task: u8, price_mm: u32 }
/// impl Content for Bid {}
///
/// let (bid, own) = (Bid { task: 3, price_mm: u32::MAX }, ProtocolId(64));
/// let (id, bytes) = bid.encode::<MAX_PAYLOAD>(own).unwrap();
/// assert_eq!((id, bytes.len()), (own, 6));
/// assert_eq!(Bid::decode(own, id, &bytes), Some(bid));
/// assert_eq!(Bid::decode(ProtocolId(65), id, &bytes), None);
/// ```
pub trait Content: Clone + Debug + Serialize + DeserializeOwned + 'static {
    /// Whether there are such values; the code for others is not linked.
    const EXISTS: bool = true;

    /// Returns the protocol, `own` unless this is an enum of several ones, and the bytes; `None` if
    /// there are more than `N`. O(N).
    fn encode<const N: usize>(&self, own: ProtocolId) -> Option<(ProtocolId, Bytes<N>)> {
        let mut buffer = [0; N];
        let bytes = postcard::to_slice(self, &mut buffer).ok()?;
        Some((own, Bytes::from_slice(bytes).ok()?))
    }

    /// Decodes bytes of protocol `id`; `None` unless they are exactly one value of `own`. O(bytes).
    fn decode(own: ProtocolId, id: ProtocolId, bytes: &[u8]) -> Option<Self> {
        if id != own {
            return None;
        }
        Self::read(bytes).or_else(|| {
            let (value, rest) = postcard::take_from_bytes(bytes).ok()?;
            rest.is_empty().then_some(value)
        })
    }

    /// Decodes exactly what postcard would, faster; `None`: postcard decodes.
    #[doc(hidden)]
    fn read(_: &[u8]) -> Option<Self> {
        None
    }
}

macro_rules! content {
    ($($number:ty),*) => {$(impl Content for $number {})*};
}
content!((), bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64);

impl<T: Content> Content for Option<T> {}

/// No message and no order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Never {}

impl Content for Never {
    const EXISTS: bool = false;

    fn encode<const N: usize>(&self, _: ProtocolId) -> Option<(ProtocolId, Bytes<N>)> {
        match *self {}
    }

    fn decode(_: ProtocolId, _: ProtocolId, _: &[u8]) -> Option<Self> {
        None
    }
}
