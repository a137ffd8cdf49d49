//! What a guidance law of somebody's own tells robots of its kind, beside what beacons say.

use core::fmt::Debug;
use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Bytes of a payload, at most.
pub const MAX_PAYLOAD: usize = 16;

/// What a law tells its neighbours behind each beacon: any small value that serde knows. `()` is nothing, and costs nothing.
///
/// Its default is what a neighbour's is taken for until it has been heard. On the air it is in postcard's encoding: an integer of more
/// than 8 bits takes up to 3, 5 or 10 bytes by its size, a float 4 or 8. A value that takes more than [`MAX_PAYLOAD`] bytes is not
/// said: [`PayloadBytes::of`] tells.
///
/// ```
/// use serde::{Deserialize, Serialize};
/// use staya_controller::wire::PayloadBytes;
///
/// #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
/// struct Bid { task: u8, price_mm: u32 }
///
/// let bid = Bid { task: 3, price_mm: u32::MAX };
/// let bytes = PayloadBytes::of(&bid).unwrap();
/// assert_eq!(bytes.as_slice().len(), 6);
/// assert_eq!(bytes.get(), Some(bid));
/// ```
pub trait Payload: Copy + Debug + Default + Send + Sync + Serialize + DeserializeOwned {}

impl<P: Copy + Debug + Default + Send + Sync + Serialize + DeserializeOwned> Payload for P {}

/// A payload as it is on the air.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PayloadBytes(Vec<u8, MAX_PAYLOAD>);

impl PayloadBytes {
    /// A value's bytes; `None` when they are more than [`MAX_PAYLOAD`]. O([`MAX_PAYLOAD`]).
    #[must_use]
    pub fn of(payload: &impl Payload) -> Option<Self> {
        let mut buffer = [0; MAX_PAYLOAD];
        let bytes = postcard::to_slice(payload, &mut buffer).ok()?;
        Self::new(bytes)
    }

    /// These bytes; `None` when they are too many.
    #[must_use]
    pub fn new(bytes: &[u8]) -> Option<Self> {
        Vec::from_slice(bytes).ok().map(Self)
    }

    /// The value; `None` when these are not exactly the bytes of one. O([`MAX_PAYLOAD`]).
    #[must_use]
    pub fn get<P: Payload>(&self) -> Option<P> {
        let (payload, rest) = postcard::take_from_bytes(&self.0).ok()?;
        rest.is_empty().then_some(payload)
    }

    /// The bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        &self.0
    }
}
