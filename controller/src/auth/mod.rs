//! Who may speak: a key that the whole swarm shares, codes made with it, and what is remembered against replays.
//!
//! Built on RustCrypto's SHA-256 compression function. Padding and HMAC are written here, in a few lines that visibly never
//! panic, so that the linker's proof of that does not hang on what the optimiser makes of the buffers of `digest` and `hmac`.

mod guard;
mod hmac;
mod keys;
mod sha256;

pub use guard::{Freshness, ReplayGuard};
pub use hmac::Mac;
pub use keys::{Master, SEED_LEN, Seed, WRAPPED_LEN};
pub use sha256::Sha256;

use core::fmt;
use core::hint::black_box;

/// Bytes of a [`Key`].
pub const KEY_LEN: usize = 32;

/// A secret of 32 bytes. It comes from configuration; it is never printed, logged or part of a digest of state. Serde
/// writes it, so the saved state of a robot is as secret as its key.
#[derive(Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Key([u8; KEY_LEN]);

impl Key {
    /// The key of these bytes.
    #[must_use]
    pub const fn new(bytes: [u8; KEY_LEN]) -> Self {
        Self(bytes)
    }

    /// The key of a passphrase: its SHA-256, as ground stations make it (MAVProxy's `signing setup`, Mission Planner). O(length).
    #[must_use]
    pub fn of_passphrase(passphrase: &[u8]) -> Self {
        let mut hash = Sha256::new();
        hash.update(passphrase);
        Self(hash.finish())
    }

    /// The secret itself.
    #[must_use]
    pub const fn as_bytes(&self) -> &[u8; KEY_LEN] {
        &self.0
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Key(secret)")
    }
}

/// Whether two codes are the same, in a time that does not tell where they differ.
#[must_use]
pub fn is_same<const N: usize>(a: &[u8; N], b: &[u8; N]) -> bool {
    let differences = a.iter().zip(b).fold(0, |sum, (a, b)| sum | (a ^ b));
    black_box(differences) == 0
}

#[cfg(test)]
mod tests;
