//! Derived keys: each robot's own key, the swarm's key of each generation, and the encryption of a
//! new key for sending.
//!
//! ```text
//! own key of robot i      = HMAC(master, "staya robot"  i:u32)
//! seed of generation g    = HMAC(master, "staya swarm"  g:u16), its first 16 bytes
//! the swarm's key of g    = HMAC(seed 0^16, "staya key" g:u16)
//! sent to robot i         = V, seed xor HMAC(own, "staya mask" g V)
//! V                       = HMAC(own, "staya wrap" g seed)       (16 bytes of each)
//! ```
//!
//! Integers are little-endian. V is a synthetic initialisation vector (RFC 5297, section 2.6, with
//! HMAC instead of CMAC and AES, so that firmware links one primitive): without the own key an
//! attacker can neither read nor forge a sent seed; equal seeds give equal bytes. A captured robot
//! reveals its own key and the swarm's current key, but not the master, other own keys, or
//! generations not sent to it.

use super::{KEY_LEN, Key, Mac, is_same};
use crate::robot::RobotId;
use core::fmt;

/// Length of a [`Seed`] in bytes.
pub const SEED_LEN: usize = 16;
/// Length of an encrypted seed in bytes.
pub const WRAPPED_LEN: usize = 2 * SEED_LEN;

/// The operator's secret, from which all other keys are derived.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Master(Mac);

impl Master {
    /// Derives the master from a secret. Two blocks of SHA-256.
    #[must_use]
    pub fn new(secret: &Key) -> Self {
        Self(Mac::new(secret))
    }

    /// The own key of a robot, which it shares only with its operator. Two blocks of SHA-256.
    #[must_use]
    pub fn own_key(&self, robot: RobotId) -> Key {
        Key::new(self.0.of(&[b"staya robot", &robot.0.to_le_bytes()]))
    }

    /// The seed of the swarm's key of a generation. Two blocks of SHA-256.
    #[must_use]
    pub fn seed(&self, generation: u16) -> Seed {
        Seed(first(self.0.of(&[b"staya swarm", &generation.to_le_bytes()])))
    }
}

/// The secret from which the swarm's key of one generation is derived; 128 random bits.
#[derive(Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Seed([u8; SEED_LEN]);

impl Seed {
    /// Restores a stored seed.
    #[must_use]
    pub const fn new(bytes: [u8; SEED_LEN]) -> Self {
        Self(bytes)
    }

    /// The secret bytes, to be stored.
    #[must_use]
    pub const fn as_bytes(&self) -> &[u8; SEED_LEN] {
        &self.0
    }

    /// The swarm's key of that generation. Four blocks of SHA-256.
    #[must_use]
    pub fn key(&self, generation: u16) -> Key {
        let mut secret = [0; KEY_LEN];
        for (byte, seed) in secret.iter_mut().zip(self.0) {
            *byte = seed;
        }
        Key::new(Mac::new(&Key::new(secret)).of(&[b"staya key", &generation.to_le_bytes()]))
    }

    /// Encrypts the seed for the robot with this own key. Four blocks of SHA-256.
    #[must_use]
    pub fn wrap(&self, own: &Mac, generation: u16) -> [u8; WRAPPED_LEN] {
        let check = check(own, generation, self);
        let mut wrapped = [0; WRAPPED_LEN];
        for (byte, value) in wrapped.iter_mut().zip(check.iter().chain(&masked(own, generation, &check, &self.0))) {
            *byte = *value;
        }
        wrapped
    }

    /// Decrypts a seed that was encrypted with this own key, if it was. Four blocks of SHA-256.
    #[must_use]
    pub fn unwrap(own: &Mac, generation: u16, wrapped: &[u8; WRAPPED_LEN]) -> Option<Self> {
        let (check_sent, hidden) = wrapped.split_first_chunk::<SEED_LEN>()?;
        let seed = Self(masked(own, generation, check_sent, hidden.first_chunk()?));
        is_same(&check(own, generation, &seed), check_sent).then_some(seed)
    }
}

impl fmt::Debug for Seed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Seed(secret)")
    }
}

fn check(own: &Mac, generation: u16, seed: &Seed) -> [u8; SEED_LEN] {
    first(own.of(&[b"staya wrap", &generation.to_le_bytes(), &seed.0]))
}

fn masked(own: &Mac, generation: u16, check: &[u8; SEED_LEN], bytes: &[u8; SEED_LEN]) -> [u8; SEED_LEN] {
    let mut mask: [u8; SEED_LEN] = first(own.of(&[b"staya mask", &generation.to_le_bytes(), check]));
    for (byte, value) in mask.iter_mut().zip(bytes) {
        *byte ^= value;
    }
    mask
}

fn first(code: [u8; 32]) -> [u8; SEED_LEN] {
    let mut half = [0; SEED_LEN];
    for (byte, value) in half.iter_mut().zip(code) {
        *byte = value;
    }
    half
}
