//! Cost-to-go of a whole known map as a table in flash: the price of every cell for one goal.
//!
//! A grid of nodes with 12 bits each holds the travel time to the goal, found on the map before the
//! mission (`staya terrain model`, `staya_sim::terrain::model`); between nodes it is blended, as in
//! the functional voxel method (FVM, figure 1a: the way by descent). 4096 bytes hold 52 x 52 nodes.
//! All arithmetic is in integers, so that a route is the same on every target.
//!
//! 30 November 2026: nodes hold values, not planes as in `staya-voxel`. A plane takes 4 bytes, so
//! 4 KiB would hold 32 x 32 of them, and a path by descent on such a model loses 1 to 3 %
//! (`staya experiment fvm-path`), not 0.1 %. The law needs no gradient. It is a module of the
//! controller because laws read it.
//!
//! | bytes | content |
//! | --- | --- |
//! | 0..4 | `CTG` and [`VERSION`] |
//! | 4..6 | nodes from west to east and from south to north, each 2 to 255 |
//! | 6..10 | cells from west to east and from south to north, each 2 to 32767 |
//! | 10..14 | south-west cell of the map, x and y |
//! | 14..18 | the goal, x and y |
//! | 18..22 | value of a count, in 1/256 of a [`UNIT`](crate::grid::UNIT)th tick |
//! | 22..26 | CRC-32 (ISO-HDLC) of all other bytes |
//! | from 26 | nodes, row by row from the south-west, two in three bytes, the lower bits first |
//!
//! Numbers are little-endian.

#[cfg(test)]
mod tests;

use super::{FarLand, Gains, Outlook};
use crate::cost::{Cost, EXCLUDED};
use crate::grid::Cell;
use core::fmt::{self, Display};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use serde::{Serialize, Serializer};

/// Version of the format; others are rejected.
pub const VERSION: u8 = 1;
/// Length of the header, bytes.
pub const HEADER_LEN: usize = 26;
/// The largest count of a node.
pub const MOST: u16 = (1 << 12) - 1;
const MAGIC: [u8; 3] = *b"CTG";
const CHECKED: usize = 22;
/// Without a table: slower, but 1 KiB of flash less.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The header of a table, before its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Nodes along x and y, 2 to 255.
    pub nodes: [u8; 2],
    /// Cells along x and y, 2 to 32767.
    pub cells: [u16; 2],
    /// South-west cell of the map.
    pub origin: Cell,
    /// The goal.
    pub goal: Cell,
    /// Value of a count of a node, in 1/256 of a [`UNIT`](crate::grid::UNIT)th tick; above 0.
    pub unit: u32,
}

/// Why bytes are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableError {
    /// The bytes do not begin like a table.
    NotATable,
    /// Another version of the format.
    Version(u8),
    /// A field of the header is out of range; its first byte.
    Field(u8),
    /// The length differs from that of a table with this header.
    Length {
        /// Length of a table with this header, bytes.
        needed: usize,
        /// Actual length, bytes.
        found: usize,
    },
    /// The checksum differs: the bytes are damaged.
    Damaged,
}

impl Display for TableError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let again = "make it again with `staya terrain model`";
        match *self {
            Self::NotATable => write!(out, "these bytes hold no costs to go: {again}"),
            Self::Version(version) => write!(out, "version {version} of the format; this reads {VERSION}: {again}"),
            Self::Field(byte) => write!(out, "the header's field at byte {byte} is out of range: {again}"),
            Self::Length { needed, found } => {
                write!(out, "{found} bytes where the table has {needed}: copy it again, whole")
            }
            Self::Damaged => write!(out, "damaged, the checksum differs: copy it again, or {again}"),
        }
    }
}

impl core::error::Error for TableError {}

impl Header {
    /// Length of a table with this header, bytes.
    #[must_use]
    pub fn length(&self) -> usize {
        let [columns, rows] = self.nodes.map(usize::from);
        HEADER_LEN.saturating_add(columns.saturating_mul(rows).saturating_mul(3).div_ceil(2))
    }

    /// Writes a table: `count` gives the node in a column and a row, at most [`MOST`]. Returns its
    /// length; `None` if the bytes are too few or a field is out of range.
    #[must_use]
    pub fn write(&self, bytes: &mut [u8], mut count: impl FnMut(u8, u8) -> u16) -> Option<usize> {
        let bytes = bytes.get_mut(..self.length())?;
        bytes.fill(0);
        let [columns, rows] = self.nodes;
        let [width, height] = self.cells;
        let numbers = [width, height, self.origin.x.cast_unsigned(), self.origin.y.cast_unsigned()];
        let numbers = numbers.into_iter().chain([self.goal.x.cast_unsigned(), self.goal.y.cast_unsigned()]);
        let head = MAGIC.into_iter().chain([VERSION, columns, rows]).chain(numbers.flat_map(u16::to_le_bytes));
        for (byte, value) in bytes.iter_mut().zip(head.chain(self.unit.to_le_bytes())) {
            *byte = value;
        }
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        for (at, (column, row)) in nodes.enumerate() {
            let value = count(column, row).min(MOST);
            let first = HEADER_LEN.checked_add(at.checked_mul(3)? >> 1)?;
            let shifted = if at & 1 == 0 { value } else { value << 4 };
            for (byte, part) in bytes.get_mut(first..)?.iter_mut().zip(shifted.to_le_bytes()) {
                *byte |= part;
            }
        }
        let sum = checksum(bytes).to_le_bytes();
        for (byte, part) in bytes.get_mut(CHECKED..HEADER_LEN)?.iter_mut().zip(sum) {
            *byte = part;
        }
        Self::read(bytes).ok().map(|_| bytes.len())
    }

    fn read(bytes: &[u8]) -> Result<Self, TableError> {
        let (magic, rest) = bytes.split_first_chunk::<3>().ok_or(TableError::NotATable)?;
        let (&version, _) = rest.split_first().ok_or(TableError::NotATable)?;
        if *magic != MAGIC {
            return Err(TableError::NotATable);
        }
        if version != VERSION {
            return Err(TableError::Version(version));
        }
        let short = TableError::Length { needed: HEADER_LEN, found: bytes.len() };
        let head = bytes.first_chunk::<HEADER_LEN>().ok_or(short)?;
        let number = |at: usize| {
            let pair = head.get(at..).and_then(|rest| rest.first_chunk::<2>());
            pair.map_or(0, |pair| u16::from_le_bytes(*pair))
        };
        let cell = |at: usize| Cell::new(number(at).cast_signed(), number(at.saturating_add(2)).cast_signed());
        let [columns, rows] = number(4).to_le_bytes();
        let unit = u32::from(number(18)) | u32::from(number(20)) << 16;
        let header =
            Self { nodes: [columns, rows], cells: [number(6), number(8)], origin: cell(10), goal: cell(14), unit };
        let is_side = |cells: u16| (2..=i16::MAX.cast_unsigned()).contains(&cells);
        let is_inside =
            |at: i16, origin: i16, cells: u16| u32::from(at.abs_diff(origin)) < u32::from(cells) && at >= origin;
        let (goal, origin, [width, height]) = (header.goal, header.origin, header.cells);
        for (byte, is_sound) in [
            (4, columns >= 2 && rows >= 2),
            (6, is_side(width) && is_side(height)),
            (14, is_inside(goal.x, origin.x, width) && is_inside(goal.y, origin.y, height)),
            (18, unit > 0),
        ] {
            if !is_sound {
                return Err(TableError::Field(byte));
            }
        }
        if bytes.len() != header.length() {
            return Err(TableError::Length { needed: header.length(), found: bytes.len() });
        }
        let stored = u32::from(number(CHECKED)) | u32::from(number(CHECKED.saturating_add(2))) << 16;
        if stored == checksum(bytes) { Ok(header) } else { Err(TableError::Damaged) }
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(bytes.get(..CHECKED).unwrap_or(&[]));
    digest.update(bytes.get(HEADER_LEN..).unwrap_or(&[]));
    digest.finalize()
}

/// Cost-to-go of a map for one goal, in bytes `B`: `&'static [u8]` in flash.
///
/// Digests of states omit it, as it never changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CostToGo<B> {
    bytes: B,
    header: Header,
    /// Nodes per cell along x and y, 1/65536.
    per_cell: [u32; 2],
}

impl<B: AsRef<[u8]>> CostToGo<B> {
    /// Opens and checks the table in these bytes: O(length).
    ///
    /// # Errors
    /// [`TableError`].
    pub fn from_bytes(bytes: B) -> Result<Self, TableError> {
        let header = Header::read(bytes.as_ref())?;
        let per_cell = |nodes: u8, cells: u16| {
            let steps = u32::from(nodes).saturating_sub(1) << 16;
            steps.checked_div(u32::from(cells).saturating_sub(1)).unwrap_or(0)
        };
        let ([columns, rows], [width, height]) = (header.nodes, header.cells);
        Ok(Self { bytes, header, per_cell: [per_cell(columns, width), per_cell(rows, height)] })
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// The header.
    #[must_use]
    pub const fn header(&self) -> &Header {
        &self.header
    }

    /// Travel time from `cell` to the goal, in 1/256 of a [`UNIT`](crate::grid::UNIT)th tick, by
    /// four nodes; off the map that of the nearest cell on it.
    #[must_use]
    pub fn at(&self, cell: Cell) -> u64 {
        let Header { nodes: [columns, rows], cells: [width, height], origin, .. } = self.header;
        let [per_x, per_y] = self.per_cell;
        let along = |at: i16, origin: i16, cells: u16, per_cell: u32, nodes: u8| {
            let cells = u32::from(cells).saturating_sub(1);
            let offset = if at > origin { u32::from(at.abs_diff(origin)).min(cells) } else { 0 };
            let place = offset.saturating_mul(per_cell);
            let node = (place >> 16).min(u32::from(nodes).saturating_sub(2));
            // 256ths of the way to the next node.
            (node, (place.saturating_sub(node << 16) >> 8).min(256))
        };
        let (x, east) = along(cell.x, origin.x, width, per_x, columns);
        let (y, north) = along(cell.y, origin.y, height, per_y, rows);
        let first = y.saturating_mul(columns.into()).saturating_add(x);
        let [south, above] = [first, first.saturating_add(columns.into())].map(|at| {
            let (west, beside) = (self.node(at), self.node(at.saturating_add(1)));
            west * (256 - east) + beside * east
        });
        // 12 bits of the node and 16 of the weights.
        let blend = south * (256 - north) + above * north;
        (u64::from(blend) * u64::from(self.header.unit)) >> 16
    }

    fn node(&self, at: u32) -> u32 {
        let first = HEADER_LEN.saturating_add((at as usize).saturating_mul(3) >> 1);
        let pair = self.bytes.as_ref().get(first..).and_then(|rest| rest.first_chunk::<2>());
        let pair = u32::from(pair.map_or(0, |pair| u16::from_le_bytes(*pair)));
        if at & 1 == 0 { pair & u32::from(MOST) } else { pair >> 4 }
    }
}

/// Prices by a table, for the weights of a route.
struct Priced<'a, B> {
    table: &'a CostToGo<B>,
    gains: Gains,
}

impl<B: AsRef<[u8]>> Outlook for Priced<'_, B> {
    fn price(&self, cell: Cell, _straight: Cost) -> Cost {
        let price = self.table.at(cell).saturating_mul(self.gains.a0.sixteenths().into()) >> 8;
        price.min((EXCLUDED - 1).into()) as Cost
    }
}

impl<B: AsRef<[u8]> + fmt::Debug> FarLand for CostToGo<B> {
    fn look(&self, gains: &Gains, _target: Cell, to: &mut dyn FnMut(&dyn Outlook)) {
        to(&Priced { table: self, gains: *gains });
    }

    fn is_whole(&self) -> bool {
        true
    }
}

impl<B: AsRef<[u8]>> Serialize for CostToGo<B> {
    fn serialize<T: Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        serializer.serialize_bytes(self.bytes())
    }
}

#[cfg(feature = "host")]
impl<'de, B: AsRef<[u8]> + From<alloc::vec::Vec<u8>>> serde::Deserialize<'de> for CostToGo<B> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bytes;
        impl serde::de::Visitor<'_> for Bytes {
            type Value = alloc::vec::Vec<u8>;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("bytes")
            }

            fn visit_bytes<E: serde::de::Error>(self, bytes: &[u8]) -> Result<Self::Value, E> {
                Ok(bytes.to_vec())
            }
        }
        let bytes = deserializer.deserialize_bytes(Bytes)?;
        Self::from_bytes(bytes.into()).map_err(serde::de::Error::custom)
    }
}
