//! SHA-256 (FIPS 180-4) of a few hundred bytes.

use sha2::block_api::compress256;

pub(super) const BLOCK: usize = 64;

/// FIPS 180-4, section 5.3.3.
const START: [u32; 8] =
    [0x6A09_E667, 0xBB67_AE85, 0x3C6E_F372, 0xA54F_F53A, 0x510E_527F, 0x9B05_688C, 0x1F83_D9AB, 0x5BE0_CD19];

/// A hash in progress; 104 bytes.
#[derive(Clone)]
pub struct Sha256 {
    state: [u32; 8],
    block: [u8; BLOCK],
    len: u64,
}

impl Sha256 {
    /// Creates a hash of no bytes.
    #[must_use]
    pub const fn new() -> Self {
        Self::from_state(START, 0)
    }

    #[expect(clippy::arithmetic_side_effects, reason = "called with 0 and 1")]
    pub(super) const fn from_state(state: [u32; 8], blocks: u64) -> Self {
        Self { state, block: [0; BLOCK], len: blocks * BLOCK as u64 }
    }

    /// Valid only after a whole number of blocks.
    pub(super) const fn state(&self) -> [u32; 8] {
        self.state
    }

    /// Adds bytes. O(their number).
    pub fn update(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.push(*byte);
        }
    }

    /// The hash of all bytes added.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "64 less 8")]
    pub fn finish(mut self) -> [u8; 32] {
        let bits = self.len.wrapping_mul(8).to_be_bytes();
        self.push(0x80);
        while self.at() != BLOCK - bits.len() {
            self.push(0);
        }
        self.update(&bits);
        let mut hash = [0; 32];
        for (bytes, word) in hash.as_chunks_mut().0.iter_mut().zip(self.state) {
            *bytes = word.to_be_bytes();
        }
        hash
    }

    const fn at(&self) -> usize {
        self.len as usize & (BLOCK - 1)
    }

    fn push(&mut self, byte: u8) {
        let at = self.at();
        if let Some(slot) = self.block.get_mut(at) {
            *slot = byte;
        }
        self.len = self.len.wrapping_add(1);
        if at == BLOCK - 1 {
            compress256(&mut self.state, core::slice::from_ref(&self.block));
        }
    }
}

impl Default for Sha256 {
    fn default() -> Self {
        Self::new()
    }
}
