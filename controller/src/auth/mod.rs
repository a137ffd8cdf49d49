//! Authentication: a key that the whole swarm shares, codes made with it, and replay protection.
//!
//! Padding and HMAC are implemented here around RustCrypto's SHA-256 compression function, in a few
//! lines that visibly never panic: the linker's proof then does not depend on the optimiser.

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

/// Length of a [`Key`] in bytes.
pub const KEY_LEN: usize = 32;

/// A secret of 32 bytes, never printed, logged or part of a digest of state. Serde serializes it,
/// so the saved state of a robot is as secret as its key.
#[derive(Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Key(#[serde(with = "crate::array")] [u8; KEY_LEN]);

impl Key {
    /// Wraps key bytes.
    #[must_use]
    pub const fn new(bytes: [u8; KEY_LEN]) -> Self {
        Self(bytes)
    }

    /// The key of a passphrase: its SHA-256, as in MAVProxy and Mission Planner. O(length).
    #[must_use]
    pub fn of_passphrase(passphrase: &[u8]) -> Self {
        let mut hash = Sha256::new();
        hash.update(passphrase);
        Self(hash.finish())
    }

    /// The secret bytes.
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

/// Compares two codes in constant time.
#[must_use]
pub fn is_same<const N: usize>(a: &[u8; N], b: &[u8; N]) -> bool {
    let differences = a.iter().zip(b).fold(0, |sum, (a, b)| sum | (a ^ b));
    black_box(differences) == 0
}

#[cfg(test)]
mod tests;
