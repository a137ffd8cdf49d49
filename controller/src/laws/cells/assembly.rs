//! Splits a formation template into parts for transmission and reassembles it.

use crate::fixint;
use crate::grid::Cell;
use crate::list;
use crate::robot::RobotId;
use crate::template::{Template, TemplateEntry};
use crate::wire::Newest;
use heapless::Vec;
use serde::{Deserialize, Serialize, Serializer};

/// Entries in one [`TemplatePart`]: as many as fit into a frame of 60 bytes.
pub const TEMPLATE_PART: usize = 2;

/// One part of a formation template, sent by the swarm's operator to one robot.
///
/// All parts except the last are full, so the number of a part determines where its entries belong.
/// See [`TemplatePart::split`] and [`TemplateAssembler`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TemplatePart {
    /// Counts the templates of this sender, wraps. Parts of different versions never mix.
    pub version: u8,
    /// The number of this part, 0..`parts`.
    pub part: u8,
    /// The number of parts in the template.
    pub parts: u8,
    /// The robot's place in the formation.
    pub slot: u8,
    /// Cell difference from the place of the top leader to the place of this robot.
    #[serde(with = "fixint")]
    pub offset: Cell,
    /// The neighbours within the geodesic radius that this part lists.
    pub entries: Vec<TemplateEntry, TEMPLATE_PART>,
}

const MAX_PARTS: usize = u64::BITS as usize;

/// Entries in the largest template that [`TemplatePart::split`] accepts.
pub const MAX_TEMPLATE: usize = MAX_PARTS * TEMPLATE_PART;

const NO_ENTRY: TemplateEntry = TemplateEntry { offset: Cell::new(0, 0), id: RobotId::NONE, hops: 0 };

/// Why a part was rejected. The parts collected before are unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PartError {
    /// The number of the part is not below the number of parts, or there are no parts.
    Number,
    /// A part before the last is not full, or the last of several is empty.
    Length,
    /// The whole template has more entries than fit.
    TooLarge,
    /// An entry is 0 hops away: the robot would be its own neighbour.
    NoHops,
    /// The part contradicts an earlier part of the same version.
    Contradiction,
}

impl core::fmt::Display for PartError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Number => "the number of the part is not below the number of parts",
            Self::Length => "a part before the last is not full, or the last of several is empty",
            Self::TooLarge => "the template has more entries than fit; give it a smaller geodesic radius",
            Self::NoHops => "an entry is 0 hops away, but no robot is its own neighbour",
            Self::Contradiction => "the part contradicts an earlier one; each change needs a new version",
        })
    }
}

impl core::error::Error for PartError {}

impl TemplatePart {
    /// Splits a template into parts of one frame each, to be sent in any order.
    ///
    /// # Errors
    /// [`PartError::TooLarge`] for more than [`MAX_TEMPLATE`] entries, [`PartError::NoHops`] if an
    /// entry is 0 hops away.
    pub fn split(
        version: u8,
        slot: u8,
        offset: Cell,
        entries: &[TemplateEntry],
    ) -> Result<impl Iterator<Item = Self>, PartError> {
        let parts = entries.chunks(TEMPLATE_PART).len().max(1);
        if parts > MAX_PARTS {
            return Err(PartError::TooLarge);
        }
        if entries.iter().any(|entry| entry.hops == 0) {
            return Err(PartError::NoHops);
        }
        let parts = u8::try_from(parts).map_err(|_| PartError::TooLarge)?;
        let mut chunks = entries.chunks(TEMPLATE_PART);
        Ok((0..parts).map(move |part| Self {
            version,
            part,
            parts,
            slot,
            offset,
            entries: list::collect(chunks.next().unwrap_or_default().iter().copied()),
        }))
    }

    fn start(&self) -> usize {
        usize::from(self.part) * TEMPLATE_PART
    }

    fn is_last(&self) -> bool {
        self.part.checked_add(1) == Some(self.parts)
    }

    /// Entries in the whole template: exact for the last part, otherwise the least possible number.
    #[expect(clippy::arithmetic_side_effects, reason = "a part has at most 255 before it, of few entries each")]
    fn total(&self) -> usize {
        if self.is_last() {
            self.start() + self.entries.len()
        } else {
            usize::from(self.parts).saturating_sub(1) * TEMPLATE_PART + 1
        }
    }

    fn check(&self, capacity: usize) -> Result<(), PartError> {
        let len = self.entries.len();
        let is_length_right = if self.is_last() { len > 0 || self.parts == 1 } else { len == TEMPLATE_PART };
        if self.part >= self.parts {
            Err(PartError::Number)
        } else if !is_length_right {
            Err(PartError::Length)
        } else if self.total() > capacity {
            Err(PartError::TooLarge)
        } else if self.entries.iter().any(|entry| entry.hops == 0) {
            Err(PartError::NoHops)
        } else {
            Ok(())
        }
    }
}

/// Collects the parts of the newest template of one sender for one robot; 12 `F` + 24 bytes.
///
/// Pass only parts addressed to the robot by a sender that it obeys, in any order and with repeats.
/// A newer version (see [`Newest`]) discards all collected parts; older versions are ignored. Lost
/// versions do no harm: the sender resends them, or sends newer ones.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TemplateAssembler<const F: usize> {
    #[serde(serialize_with = "as_slice")]
    #[serde(deserialize_with = "of_slice")]
    entries: [TemplateEntry; F],
    /// Bit p: part p has arrived.
    there: u64,
    /// Valid once the last part has arrived.
    len: usize,
    newest: Newest,
    parts: u8,
    slot: u8,
    offset: Cell,
}

/// Serde does not support arrays of arbitrary length.
fn as_slice<const F: usize, Z: Serializer>(entries: &[TemplateEntry; F], serializer: Z) -> Result<Z::Ok, Z::Error> {
    entries.as_slice().serialize(serializer)
}

fn of_slice<'de, const F: usize, D: serde::Deserializer<'de>>(from: D) -> Result<[TemplateEntry; F], D::Error> {
    let entries: Vec<TemplateEntry, F> = serde::Deserialize::deserialize(from)?;
    let count = entries.len();
    entries.into_array().map_err(|_| serde::de::Error::invalid_length(count, &"as many entries as there is room for"))
}

impl<const F: usize> Default for TemplateAssembler<F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const F: usize> TemplateAssembler<F> {
    const FITS: () = assert!(F <= MAX_TEMPLATE, "more entries than parts can carry");

    /// Creates an assembler without parts.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::FITS;
        Self {
            entries: [NO_ENTRY; F],
            there: 0,
            len: 0,
            newest: Newest::new(),
            parts: 0,
            slot: 0,
            offset: Cell::new(0, 0),
        }
    }

    /// Stores a part. Returns the template once, with the part that completes it. O(`F`).
    ///
    /// # Errors
    /// Why the part was rejected, see [`PartError`]. A rejected part changes nothing.
    #[expect(clippy::arithmetic_side_effects, reason = "as in `total`")]
    pub fn put(&mut self, part: &TemplatePart) -> Result<Option<Template<F>>, PartError> {
        part.check(F)?;
        if self.newest.admit(part.version) {
            *self =
                Self { newest: self.newest, parts: part.parts, slot: part.slot, offset: part.offset, ..Self::new() };
        } else if self.newest.version() != Some(part.version) {
            return Ok(None);
        }
        let same = (self.parts, self.slot, self.offset) == (part.parts, part.slot, part.offset);
        if !same {
            return Err(PartError::Contradiction);
        }
        let end = part.start() + part.entries.len();
        let bit = 1_u64.checked_shl(part.part.into()).ok_or(PartError::TooLarge)?;
        let place = self.entries.get_mut(part.start()..end).ok_or(PartError::TooLarge)?;
        if self.there & bit != 0 {
            let again = *place == *part.entries && (!part.is_last() || self.len == end);
            return if again { Ok(None) } else { Err(PartError::Contradiction) };
        }
        for (place, entry) in place.iter_mut().zip(&part.entries) {
            *place = *entry;
        }
        self.there |= bit;
        if part.is_last() {
            self.len = end;
        }
        Ok(self.complete())
    }

    fn complete(&self) -> Option<Template<F>> {
        if self.there.count_ones() != u32::from(self.parts) {
            return None;
        }
        Some(Template {
            slot: self.slot,
            offset: self.offset,
            entries: Vec::from_slice(self.entries.get(..self.len)?).ok()?,
        })
    }
}

#[cfg(test)]
mod tests;
