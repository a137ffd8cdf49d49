//! Data that a custom guidance law sends to robots with the same law.

use core::fmt::Debug;
use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Maximum length of a payload in bytes.
pub const MAX_PAYLOAD: usize = 16;

/// The data that a law sends after each beacon: any small value that serde supports, or `()`.
///
/// A neighbour has the default value until its first payload arrives. Postcard encodes an integer
/// of more than 8 bits in up to 3, 5 or 10 bytes depending on its type, a float in 4 or 8. A value
/// of more than [`MAX_PAYLOAD`] bytes is not sent; [`PayloadBytes::of`] reports this.
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

/// An encoded payload.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PayloadBytes(Vec<u8, MAX_PAYLOAD>);

impl PayloadBytes {
    /// Encodes a value; `None` if it takes more than [`MAX_PAYLOAD`] bytes. O([`MAX_PAYLOAD`]).
    #[must_use]
    pub fn of(payload: &impl Payload) -> Option<Self> {
        let mut buffer = [0; MAX_PAYLOAD];
        let bytes = postcard::to_slice(payload, &mut buffer).ok()?;
        Self::new(bytes)
    }

    /// Wraps encoded bytes; `None` if there are more than [`MAX_PAYLOAD`].
    #[must_use]
    pub fn new(bytes: &[u8]) -> Option<Self> {
        Vec::from_slice(bytes).ok().map(Self)
    }

    /// Decodes the value; `None` unless the bytes are exactly one value. O([`MAX_PAYLOAD`]).
    #[must_use]
    pub fn get<P: Payload>(&self) -> Option<P> {
        let (payload, rest) = postcard::take_from_bytes(&self.0).ok()?;
        rest.is_empty().then_some(payload)
    }

    /// The encoded bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        &self.0
    }
}
