//! The fields of a group of robots.

use super::super::Draft;
use super::super::source::Section;
use super::table::{BodyTable, GroupTable, PlaneRobotEntry};
use staya_controller::agent::GuidanceKind;

/// The fields of a group of robots, with their table in the file.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    pub draft: &'a Draft<'a>,
    /// The table that defines the group: `plane` or `plane.group[1]`.
    pub at: Section<'a>,
    pub body: BodyTable,
    pub flock: u8,
}

impl<'a> Group<'a> {
    /// The robots of `[plane]`. `places` is the size of the largest formation.
    pub fn general(draft: &'a Draft<'a>, body: &BodyTable, places: u8) -> Self {
        let flock = if body.guidance == GuidanceKind::Formation { 0 } else { places };
        Self { draft, at: draft.at("plane"), body: body.clone(), flock }
    }

    /// The robots of `[[plane.group]]` number `index`.
    pub fn numbered(draft: &'a Draft<'a>, index: usize, table: &GroupTable, places: u8) -> Self {
        let flock = match table.body.guidance {
            // A beacon stores a formation place and a flock number in the same field.
            GuidanceKind::Formation => 0,
            // Each group has its own flock; when numbers run out, the last groups share one.
            _ => table.flock.unwrap_or(places.saturating_add(u8::try_from(index + 1).unwrap_or(u8::MAX))),
        };
        Self { draft, at: draft.at(format!("plane.group[{index}]")), body: table.body.clone(), flock }
    }

    /// The group of a listed robot that has a body of its own.
    pub fn of_entry(&self, entry: &PlaneRobotEntry) -> Option<Self> {
        (entry.radius_m.is_some() || entry.max_speed_mps.is_some()).then(|| {
            let mut own = self.clone();
            own.body.radius_m = entry.radius_m.unwrap_or(own.body.radius_m);
            own.body.max_speed_mps = entry.max_speed_mps.unwrap_or(own.body.max_speed_mps);
            own
        })
    }
}
