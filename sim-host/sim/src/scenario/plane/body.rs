//! The fields of a group of robots.

use super::super::Draft;
use super::super::grid::moves;
use super::super::law::LawSetup;
use super::super::source::{Checked, Section};
use super::table::{BodyTable, GroupTable, PlaneRobotEntry};
use staya_controller::agent::{Around, LawSettings, Settings as _, WaypointSettings};

/// The fields of a group of robots, with their table in the file.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    pub draft: &'a Draft<'a>,
    /// The table that defines the group: `plane` or `plane.group[1]`.
    pub at: Section<'a>,
    pub body: BodyTable,
    /// The law without the values of the file.
    pub kind: LawSetup,
    pub flock: u8,
}

/// The law of robots in the plane.
const USUAL: &str = WaypointSettings::NAME;

impl<'a> Group<'a> {
    /// The robots of `[plane]`.
    pub fn general(draft: &'a Draft<'a>, body: &BodyTable) -> Self {
        Self::new(draft, "plane", body, 0)
    }

    /// The robots of `[[plane.group]]` number `index`, with a flock number of their own as long as
    /// there are any; then the last groups share one.
    pub fn numbered(draft: &'a Draft<'a>, index: usize, table: &GroupTable) -> Self {
        let flock = table.flock.unwrap_or(u8::try_from(index + 1).unwrap_or(u8::MAX));
        Self::new(draft, &format!("plane.group[{index}]"), &table.body, flock)
    }

    fn new(draft: &'a Draft<'a>, path: &str, body: &BodyTable, flock: u8) -> Self {
        let kind = LawSetup::by_name(body.law.name_or(USUAL), moves(&draft.file.grid), Some(0.0));
        // A name that no law has was refused when it was read.
        let kind = kind.unwrap_or_else(|| LawSetup::BuiltIn(LawSettings::Waypoint(WaypointSettings::default())));
        Self { draft, at: draft.at(path), body: body.clone(), kind, flock }
    }

    /// The law of robots with this body.
    pub fn law(&self, around: &Around) -> Checked<LawSetup> {
        self.body.law.build(&self.at, USUAL, moves(&self.draft.file.grid), around)
    }

    /// Whether each robot has a goal of its own, at which it stays.
    pub fn has_goals(&self) -> bool {
        self.kind.goals().are_own()
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
