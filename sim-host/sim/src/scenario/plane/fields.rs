//! The fields of a group of robots, with their place in the file.

use super::super::ScenarioError;
use super::super::ranges::{self, within};
use super::super::source::Source;
use super::table::{BodyTable, GroupTable, PlaneRobotEntry};
use staya_controller::agent::GuidanceKind;
use staya_controller::parameters::Parameters;

/// The fields of a group of robots, with their place in the file.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// The table that defines the group: `plane` or `plane.group[1]`.
    pub table: String,
    pub body: BodyTable,
    pub flock: u8,
}

impl Group {
    /// The robots of `[plane]`. `places` is the size of the largest formation.
    pub fn general(body: &BodyTable, places: u8) -> Self {
        let flock = if body.guidance == GuidanceKind::Formation { 0 } else { places };
        Self { table: "plane".to_owned(), body: body.clone(), flock }
    }

    /// The robots of `[[plane.group]]` number `index`.
    pub fn numbered(index: usize, table: &GroupTable, places: u8) -> Self {
        let flock = match table.body.guidance {
            // A beacon stores a formation place and a flock number in the same field.
            GuidanceKind::Formation => 0,
            // Each group has its own flock; when numbers run out, the last groups share one.
            _ => table.flock.unwrap_or(places.saturating_add(u8::try_from(index + 1).unwrap_or(u8::MAX))),
        };
        Self { table: format!("plane.group[{index}]"), body: table.body.clone(), flock }
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

    /// Path of a field of the group.
    pub fn field(&self, name: &str) -> String {
        format!("{}.{name}", self.table)
    }

    pub fn within(
        &self,
        source: &Source<'_>,
        name: &str,
        value: f64,
        [low, high]: [f64; 2],
        unit: &str,
    ) -> Result<(), ScenarioError> {
        within(source, &self.field(name), value, low, high, unit)
    }

    /// Checks the fields of `table` against the parameters with the same names and stores them.
    pub fn set(
        &self,
        source: &Source<'_>,
        table: &str,
        params: &mut dyn Parameters,
        fields: &[(&str, Option<f64>)],
    ) -> Result<(), ScenarioError> {
        let mut fields = fields.iter();
        fields.try_for_each(|(name, value)| {
            ranges::set(source, &self.field(&format!("{table}.{name}")), *value, params, name)
        })
    }
}
