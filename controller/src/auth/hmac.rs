//! HMAC-SHA256 (RFC 2104).

use super::sha256::BLOCK;
use super::{Key, Sha256};
use core::fmt;

/// Computes codes with one key; 64 bytes. The two blocks of the key are hashed once.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub struct Mac {
    inner: [u32; 8],
    outer: [u32; 8],
}

impl Mac {
    /// Prepares a key. Two blocks of SHA-256.
    #[must_use]
    pub fn new(key: &Key) -> Self {
        Self { inner: keyed(key, 0x36), outer: keyed(key, 0x5C) }
    }

    /// The code of a message in parts: two blocks of SHA-256 up to 55 bytes, then one per 64.
    #[must_use]
    pub fn of(&self, message: &[&[u8]]) -> [u8; 32] {
        let mut inner = Sha256::from_state(self.inner, 1);
        for part in message {
            inner.update(part);
        }
        let mut outer = Sha256::from_state(self.outer, 1);
        outer.update(&inner.finish());
        outer.finish()
    }
}

impl fmt::Debug for Mac {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Mac(secret)")
    }
}

fn keyed(key: &Key, pad: u8) -> [u32; 8] {
    let mut block = [pad; BLOCK];
    for (byte, secret) in block.iter_mut().zip(key.as_bytes()) {
        *byte ^= secret;
    }
    let mut hash = Sha256::new();
    hash.update(&block);
    hash.state()
}
