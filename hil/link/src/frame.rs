//! Framing: one message per frame, protected by a CRC, between zero bytes.
//!
//! ```text
//! frame   = 0x00 COBS(content) 0x00
//! content = version:u8 kind:u8 body:postcard crc:u32
//! ```
//!
//! - COBS, version and CRC are the same in every version of the link, so that a frame of another
//!   version is not taken for a damaged one. Integers are little-endian.
//! - The leading zero ends any noise or boot text before the frame.
//! - CRC-32C (Castagnoli; iSCSI) detects every error of 1 to 5 bits in contents of up to 655 bytes
//!   and of 1 to 3 bits in longer ones; others pass with a probability of 1 in 4 * 10^9.
//! - COBS (Cheshire, Baker 1999, "Consistent overhead byte stuffing", section 3) with blocks of 254
//!   bytes, byte by byte: no second buffer, no panic.

use crc::{CRC_32_ISCSI, Crc, Digest, Table};
use heapless::Vec;
use postcard::ser_flavors::Flavor;
use serde::Serialize;

/// Version of the link protocol.
pub const VERSION: u8 = 12;

/// Bytes of version, kind and CRC.
pub const OVERHEAD: usize = 1 + 1 + CRC_LEN;
const CRC_LEN: usize = 4;
const BLOCK: usize = 254;
/// Code of a full block, without a zero after it.
const FULL: u8 = 0xFF;

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// Largest length of a frame with `content` bytes of content.
#[must_use]
pub const fn frame_len(content: usize) -> usize {
    // Two delimiters, a code per block, and one after a full last block.
    2 + content + content.div_ceil(BLOCK) + 1
}

/// Reason for rejecting a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// The content is longer than the receive buffer.
    TooLong,
    /// The last COBS block does not end at the end of the frame.
    Cobs,
    /// The CRC does not match or is missing: damaged or truncated.
    Crc,
    /// An intact frame of another link version.
    Version(u8),
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::TooLong => "the frame has more content than there is room for",
            Self::Cobs => "the frame's stuffing does not end where the frame ends",
            Self::Crc => "the frame's CRC is wrong: damaged or cut",
            Self::Version(version) => {
                return write!(f, "the frame is of version {version} of the link, not {VERSION}");
            }
        })
    }
}

impl core::error::Error for FrameError {}

/// The body does not fit the frame's buffer; the frame is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl core::fmt::Display for TooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the body does not fit into the frame")
    }
}

impl core::error::Error for TooLong {}

/// An encoded frame of at most `N` bytes.
#[derive(Clone, Debug, Default)]
pub struct Frame<const N: usize> {
    bytes: Vec<u8, N>,
}

impl<const N: usize> Frame<N> {
    /// Creates an empty frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Vec::new() }
    }

    /// The encoded frame, delimiters included; empty before the first [`Frame::fill`].
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Replaces the frame by one with this `kind` and `body`. O(bytes).
    ///
    /// # Errors
    /// [`TooLong`] if the frame has more than `N` bytes; the frame is then empty.
    pub fn fill<T: Serialize + ?Sized>(&mut self, kind: u8, body: &T) -> Result<(), TooLong> {
        self.bytes.clear();
        let writer = Stuffer::new(&mut self.bytes).ok_or(TooLong)?;
        let filled = postcard::serialize_with_flavor(&(VERSION, kind, body), writer);
        if filled.is_err() {
            self.bytes.clear();
            return Err(TooLong);
        }
        Ok(())
    }
}

/// Updates the CRC and applies COBS to each byte of the content.
struct Stuffer<'a, const N: usize> {
    out: &'a mut Vec<u8, N>,
    code_at: usize,
    /// Distance to the next byte.
    code: u8,
    crc: Digest<'static, u32, Table<1>>,
}

impl<'a, const N: usize> Stuffer<'a, N> {
    fn new(out: &'a mut Vec<u8, N>) -> Option<Self> {
        out.extend_from_slice(&[0, 0]).ok()?;
        Some(Self { out, code_at: 1, code: 1, crc: CRC.digest() })
    }

    /// Not inlined: every field of every message calls it.
    #[inline(never)]
    fn check_and_stuff(&mut self, byte: u8) -> Option<()> {
        self.crc.update(&[byte]);
        self.stuff(byte)
    }

    fn stuff(&mut self, byte: u8) -> Option<()> {
        if byte != 0 {
            self.out.push(byte).ok()?;
            self.code = self.code.wrapping_add(1);
            if self.code != FULL {
                return Some(());
            }
        }
        *self.out.get_mut(self.code_at)? = self.code;
        self.code_at = self.out.len();
        self.code = 1;
        self.out.push(0).ok()
    }

    fn finish(mut self) -> Option<()> {
        let crc = core::mem::replace(&mut self.crc, CRC.digest()).finalize();
        for byte in crc.to_le_bytes() {
            self.stuff(byte)?;
        }
        *self.out.get_mut(self.code_at)? = self.code;
        self.out.push(0).ok()
    }
}

impl<const N: usize> Flavor for Stuffer<'_, N> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.check_and_stuff(byte).ok_or(postcard::Error::SerializeBufferFull)
    }

    fn finalize(self) -> postcard::Result<()> {
        self.finish().ok_or(postcard::Error::SerializeBufferFull)
    }
}

/// Decoder: finds frames with at most `N` bytes of content in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Deframer<const N: usize> {
    content: Vec<u8, N>,
    /// Bytes before the next COBS code.
    left: u8,
    zero_follows: bool,
    has_begun: bool,
    is_too_long: bool,
    is_over: bool,
}

impl<const N: usize> Default for Deframer<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Deframer<N> {
    /// Creates a decoder that waits for a frame to start.
    #[must_use]
    pub const fn new() -> Self {
        Self { content: Vec::new(), left: 0, zero_follows: false, has_begun: false, is_too_long: false, is_over: false }
    }

    /// Takes one byte. At the end of a frame, returns its kind and body, or the reason for
    /// rejecting it. O(1), then O(`N`).
    pub fn push(&mut self, byte: u8) -> Option<Result<(u8, &[u8]), FrameError>> {
        if self.is_over {
            self.content.clear();
            self.left = 0;
            self.zero_follows = false;
            self.has_begun = false;
            self.is_too_long = false;
            self.is_over = false;
        }
        if byte == 0 {
            if !self.has_begun {
                return None;
            }
            self.is_over = true;
            return Some(self.finish());
        }
        if self.left == 0 {
            if self.zero_follows {
                self.keep(0);
            }
            self.has_begun = true;
            self.left = byte.wrapping_sub(1);
            self.zero_follows = byte != FULL;
        } else {
            self.keep(byte);
            self.left = self.left.wrapping_sub(1);
        }
        None
    }

    fn keep(&mut self, byte: u8) {
        self.is_too_long |= self.content.push(byte).is_err();
    }

    fn finish(&self) -> Result<(u8, &[u8]), FrameError> {
        if self.is_too_long {
            return Err(FrameError::TooLong);
        }
        if self.left > 0 {
            return Err(FrameError::Cobs);
        }
        let (checked, crc) = self.content.split_last_chunk::<CRC_LEN>().ok_or(FrameError::Crc)?;
        if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
            return Err(FrameError::Crc);
        }
        match checked {
            [VERSION, kind, body @ ..] => Ok((*kind, body)),
            [version, ..] if *version != VERSION => Err(FrameError::Version(*version)),
            _ => Err(FrameError::Crc),
        }
    }
}
