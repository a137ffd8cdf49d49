//! The place of a robot in a formation, and the relative places of its neighbours there.

use crate::fixint;
use crate::grid::{Cell, DIAGONAL, Dir, UNIT};
use crate::list::sink_last;
use crate::robot::RobotId;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Neighbours in a template of default capacity.
pub const TEMPLATE: usize = 8;

/// The place of one robot in the formation, and those of at most `F` neighbours (KUZ section 3).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Template<const F: usize> {
    /// Index of the robot's place in the formation.
    pub slot: u8,
    /// Cell difference from the top leader's place to this robot's place.
    pub offset: Cell,
    /// The neighbours within the geodesic radius, in the order of the sender.
    pub entries: Vec<TemplateEntry, F>,
}

/// The place of one neighbour, relative to the own place (KUZ section 3: template).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TemplateEntry {
    /// Desired cell difference, neighbour minus own robot.
    #[serde(with = "fixint")]
    pub offset: Cell,
    /// The robot that should be there; [`RobotId::NONE`] if any robot may be.
    pub id: RobotId,
    /// Geodesic distance from the own place in the graph of the formation, 1..=rho.
    pub hops: u8,
}

/// The reasons why a graph gives no template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TemplateError {
    /// The requested place is not in the graph, or its index exceeds 255.
    NoSuchPlace,
    /// An edge names a place that does not exist, or joins a place to itself.
    BadEdge,
    /// More than `F` neighbours are within the geodesic radius; use a smaller radius or a larger F.
    TooMany,
}

impl core::fmt::Display for TemplateError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NoSuchPlace => "the graph has no such place, or more than 255",
            Self::BadEdge => "an edge names a place that does not exist, or joins a place to itself",
            Self::TooMany => "more neighbours than the template holds; give it a smaller geodesic radius or a larger F",
        })
    }
}

impl core::error::Error for TemplateError {}

impl<const F: usize> Template<F> {
    /// Builds the template of the robot at place `own` of a formation graph (KUZ section 2: Phi):
    /// all robots within the geodesic radius `rho`, sorted by distance, then by place.
    ///
    /// `places` are cells in any common frame, the top leader's first. `edges` are pairs of indices
    /// into `places`. The robot at index i has the id i + 1. O(rho * edges * F).
    ///
    /// # Errors
    /// See [`TemplateError`].
    pub fn from_graph(places: &[Cell], edges: &[(u16, u16)], own: usize, rho: u8) -> Result<Self, TemplateError> {
        let place = |index: usize| places.get(index).copied();
        let (top, here) = place(0).zip(place(own)).ok_or(TemplateError::NoSuchPlace)?;
        let slot = u8::try_from(own).map_err(|_| TemplateError::NoSuchPlace)?;
        let mut template = Self { slot, offset: here - top, entries: Vec::new() };
        for hops in 1..=rho {
            let before = template.entries.len();
            for &(a, b) in edges {
                let (a, b) = (usize::from(a), usize::from(b));
                if a == b || place(a).is_none() {
                    return Err(TemplateError::BadEdge);
                }
                for (from, to) in [(a, b), (b, a)] {
                    let there = place(to).ok_or(TemplateError::BadEdge)?;
                    let is_reached = if hops == 1 { from == own } else { template.hops_to(from) == Some(hops - 1) };
                    if !is_reached || to == own || template.hops_to(to).is_some() {
                        continue;
                    }
                    let entry = TemplateEntry { offset: there - here, id: number(to), hops };
                    let full = template.entries.push(entry).is_err();
                    if full {
                        return Err(TemplateError::TooMany);
                    }
                }
            }
            for end in before..template.entries.len() {
                if let Some(ring) = template.entries.get_mut(before..=end) {
                    sink_last(ring, |one, next| one.id > next.id);
                }
            }
        }
        Ok(template)
    }

    fn hops_to(&self, place: usize) -> Option<u8> {
        let id = number(place);
        self.entries.iter().find(|entry| entry.id == id).map(|entry| entry.hops)
    }

    /// Returns the formation turned from east to `heading`; see [`rotated`]. (KUZ section 3 fixes
    /// the frame.) Turns by odd multiples of 45 degrees can merge places less than two cells apart.
    #[must_use]
    pub fn turned(mut self, heading: Dir) -> Self {
        self.offset = rotated(self.offset, heading);
        for entry in &mut self.entries {
            entry.offset = rotated(entry.offset, heading);
        }
        self
    }
}

fn number(place: usize) -> RobotId {
    RobotId(u32::try_from(place).unwrap_or(u32::MAX).saturating_add(1))
}

/// Turns `offset` from east to `heading`, counter-clockwise, rounded to whole cells.
#[must_use]
pub fn rotated(offset: Cell, heading: Dir) -> Cell {
    let (x, y) = (i32::from(offset.x), i32::from(offset.y));
    let (cos, sin) = {
        let ahead = heading.offset();
        (i32::from(ahead.x), i32::from(ahead.y))
    };
    if heading == Dir::Stay {
        return offset;
    }
    let (turned_x, turned_y) = (x * cos - y * sin, x * sin + y * cos);
    let scale = |value: i32| {
        if heading.is_diagonal() {
            // Divided by sqrt 2 = DIAGONAL / UNIT, rounded to nearest, halves away from 0.
            let (unit, diagonal) = (UNIT.cast_signed(), DIAGONAL.cast_signed());
            let half = if value < 0 { -diagonal } else { diagonal };
            (2 * value * unit + half).checked_div(2 * diagonal).unwrap_or(0)
        } else {
            value
        }
    };
    let narrow = |value: i32| value.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    Cell::new(narrow(scale(turned_x)), narrow(scale(turned_y)))
}
