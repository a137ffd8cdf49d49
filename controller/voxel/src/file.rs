//! The binary format of models, in files and in flash.
//!
//! | bytes | content |
//! | --- | --- |
//! | 0..4 | `FVM` and a zero |
//! | 4..6 | [`VERSION`] |
//! | 6 | variables: 2 or 3 |
//! | 7 | bits of a component: 4 to 16 |
//! | 8..14 | nodes along each axis, 2 or more; 1 along an unused axis |
//! | 14..16 | zero |
//! | 16..28 | coordinates of the first node |
//! | 28..40 | steps between nodes |
//! | 40..44 | unit of values |
//! | 44..48 | CRC-32 (ISO-HDLC) of all other bytes |
//! | from 48 | the components of each node, the first axis fastest |
//!
//! Numbers are little-endian, coordinates and units `f32`.

use core::fmt::{self, Display};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// Version of the format; other versions are rejected.
pub const VERSION: u16 = 1;
/// Length of the header in bytes, before the components.
pub const HEADER_LEN: usize = 48;
const MAGIC: [u8; 4] = *b"FVM\0";
const CHECKED: usize = 44;
/// Without a table: slower, but 1 KiB of flash less.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The header of a model, before its components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// Variables of the function: 2 or 3.
    pub variables: u8,
    /// Bits of each stored component, including its sign: 4 to 16.
    pub depth: u8,
    /// Nodes along each axis: 2 or more; 1 along an unused axis.
    pub nodes: [u16; 3],
    /// Coordinates of the first node, in the function's own units.
    pub first: [f32; 3],
    /// Step between nodes; more than 0, for an unused axis 0.
    pub step: [f32; 3],
    /// Unit of the values; more than 0.
    pub unit: f32,
}

/// Why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileError {
    /// The length differs from that in the header.
    Length {
        /// Length in bytes of a model with this header.
        needed: usize,
        /// Actual length in bytes.
        found: usize,
    },
    /// The bytes do not begin like a model.
    NotAModel,
    /// Another version of the format.
    Version(u16),
    /// The function has another number of variables than required.
    Variables {
        /// Required number.
        needed: u8,
        /// Actual number.
        found: u8,
    },
    /// A field of the header is invalid; its first byte.
    Field(usize),
    /// The bytes are damaged.
    Checksum {
        /// The checksum in the header.
        stored: u32,
        /// The checksum of the bytes.
        computed: u32,
    },
}

impl Display for FileError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let again = "make it again with `staya voxel build`";
        match *self {
            Self::Length { needed, found } => {
                write!(out, "{found} bytes where the model has {needed}: copy the file again, whole")
            }
            Self::NotAModel => write!(out, "the first four bytes are not `FVM` and a zero: no functional voxel model"),
            Self::Version(version) => {
                write!(out, "version {version} of the format (bytes 4 and 5); this program reads {VERSION}: {again}")
            }
            Self::Variables { needed, found } => {
                write!(out, "a function of {found} variables (byte 6) where one of {needed} is needed")
            }
            Self::Field(byte) => write!(out, "the header's field at byte {byte} makes no sense: {again}"),
            Self::Checksum { stored, computed } => {
                write!(out, "damaged: the checksum (byte {CHECKED}) is {stored:08x}, the bytes give {computed:08x}; ")?;
                write!(out, "copy the file again, or {again}")
            }
        }
    }
}

impl core::error::Error for FileError {}

impl Header {
    /// Components of a node: one for each variable, that of the function and the free one.
    #[must_use]
    pub const fn components(&self) -> usize {
        self.variables as usize + 2
    }

    /// Length of a component in bytes.
    #[must_use]
    pub const fn component_len(&self) -> usize {
        if self.depth > 8 { 2 } else { 1 }
    }

    /// Total number of nodes; saturates.
    #[must_use]
    pub fn count(&self) -> usize {
        self.nodes.iter().fold(1, |count: usize, &along| count.saturating_mul(along.into()))
    }

    /// Length of the whole model in bytes; saturates.
    #[must_use]
    pub fn model_len(&self) -> usize {
        let node = self.components().saturating_mul(self.component_len());
        self.count().saturating_mul(node).saturating_add(HEADER_LEN)
    }

    /// The header with a checksum of zero: write the [`checksum`] of the model to bytes 44 to 47.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; HEADER_LEN] {
        let mut bytes = [0; HEADER_LEN];
        let numbers = self.first.iter().chain(&self.step).chain([&self.unit]);
        let fields = MAGIC
            .into_iter()
            .chain(VERSION.to_le_bytes())
            .chain([self.variables, self.depth])
            .chain(self.nodes.into_iter().flat_map(u16::to_le_bytes))
            .chain([0; 2])
            .chain(numbers.flat_map(|number| number.to_le_bytes()));
        for (byte, field) in bytes.iter_mut().zip(fields) {
            *byte = field;
        }
        bytes
    }

    /// Reads and checks the header, the length and the checksum of a whole model: O(length).
    ///
    /// # Errors
    /// [`FileError`], for the first error found.
    pub fn read(bytes: &[u8]) -> Result<Self, FileError> {
        let found = bytes.len();
        if bytes.first_chunk::<4>().is_some_and(|magic| *magic != MAGIC) {
            return Err(FileError::NotAModel);
        }
        let (Some(head), Some(stored)) = (bytes.first_chunk::<HEADER_LEN>(), u32_at(bytes, CHECKED)) else {
            return Err(FileError::Length { needed: HEADER_LEN, found });
        };
        let word = |at: usize| u16_at(head, at).unwrap_or(0);
        let number = |at: usize| u32_at(head, at).map_or(f32::NAN, f32::from_bits);
        if word(4) != VERSION {
            return Err(FileError::Version(word(4)));
        }
        let [variables, depth] = word(6).to_le_bytes();
        let header = Self {
            variables,
            depth,
            nodes: [word(8), word(10), word(12)],
            first: [number(16), number(20), number(24)],
            step: [number(28), number(32), number(36)],
            unit: number(40),
        };
        header.check()?;
        let needed = header.model_len();
        if needed != found {
            return Err(FileError::Length { needed, found });
        }
        let computed = checksum(bytes);
        if stored == computed { Ok(header) } else { Err(FileError::Checksum { stored, computed }) }
    }

    fn check(&self) -> Result<(), FileError> {
        let ensure = |is_sound: bool, byte| if is_sound { Ok(()) } else { Err(FileError::Field(byte)) };
        ensure(matches!(self.variables, 2 | 3), 6)?;
        ensure(matches!(self.depth, 4..=16), 7)?;
        let axes = self.nodes.iter().zip(&self.first).zip(&self.step);
        for (axis, ((&nodes, &first), &step)) in axes.enumerate() {
            let is_there = axis < usize::from(self.variables);
            let four = axis.saturating_mul(4);
            ensure(if is_there { nodes >= 2 } else { nodes == 1 }, axis.saturating_mul(2).saturating_add(8))?;
            ensure(first.is_finite(), four.saturating_add(16))?;
            let is_step = if is_there { step.is_normal() && step > 0.0 } else { step == 0.0 };
            ensure(is_step, four.saturating_add(28))?;
        }
        ensure(self.unit.is_normal() && self.unit > 0.0, 40)
    }
}

/// CRC-32 of a model's bytes except those of its checksum. O(length).
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(bytes.get(..CHECKED).unwrap_or(bytes));
    digest.update(bytes.get(HEADER_LEN..).unwrap_or(&[]));
    digest.finalize()
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|two| u16::from_le_bytes(*two))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|four| u32::from_le_bytes(*four))
}
