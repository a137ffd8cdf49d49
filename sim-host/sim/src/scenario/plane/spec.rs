//! What a file says of robots that are alike, wherever it says it.

use super::super::ScenarioError;
use super::super::source::Source;
use super::table::{
    BoidsTable, GoalFlockTable, GroupTable, LatticeTable, OrcaTable, PlaneRobotEntry, PlaneTable, PushOutTable,
};
use super::within;
use staya_controller::agent::{GuidanceKind, SafetyKind};

/// What a file says of a group, with what it leaves to `[plane]` filled in.
#[derive(Clone, Debug)]
pub(super) struct Spec {
    /// The tables that say it, what counts most first: `plane.group[1]`, `plane`.
    tables: Vec<String>,
    pub radius_m: f64,
    pub max_speed_mps: f64,
    pub max_acceleration_mps2: f64,
    pub cruise_mps: Option<f64>,
    pub tolerance_m: Option<f64>,
    pub sight_m: f64,
    pub guidance: GuidanceKind,
    pub safety: SafetyKind,
    pub orca: OrcaTable,
    pub push_out: Option<PushOutTable>,
    pub lattice: Option<LatticeTable>,
    pub goal_flock: Option<GoalFlockTable>,
    pub boids: Option<BoidsTable>,
    pub flock: u8,
}

impl Spec {
    /// What `[plane]` says, beside formations that have up to `places` places.
    pub fn general(table: &PlaneTable, places: u8) -> Self {
        Self {
            tables: vec!["plane".to_owned()],
            radius_m: table.radius_m,
            max_speed_mps: table.max_speed_mps,
            max_acceleration_mps2: table.max_acceleration_mps2,
            cruise_mps: table.cruise_mps,
            tolerance_m: table.tolerance_m,
            sight_m: table.sight_m,
            guidance: table.guidance,
            safety: table.safety,
            orca: table.orca,
            push_out: table.push_out,
            lattice: table.lattice,
            goal_flock: table.goal_flock,
            boids: table.boids,
            flock: if table.guidance == GuidanceKind::Formation { 0 } else { places },
        }
    }

    /// What `plane.group[index]` says instead. Tables of a guidance law or a safety layer that it does not share are not
    /// its own.
    pub fn group(&self, index: usize, group: &GroupTable, places: u8) -> Self {
        let guidance = group.guidance.unwrap_or(self.guidance);
        let safety = group.safety.unwrap_or(self.safety);
        let goes_alike = guidance == self.guidance;
        let is_orca = |safety| !matches!(safety, SafetyKind::None | SafetyKind::PushOut);
        let both_orca = is_orca(safety) && is_orca(self.safety);
        let both_push_out = safety == self.safety;
        Self {
            tables: self.below(format!("plane.group[{index}]")),
            radius_m: group.radius_m.unwrap_or(self.radius_m),
            max_speed_mps: group.max_speed_mps.unwrap_or(self.max_speed_mps),
            max_acceleration_mps2: group.max_acceleration_mps2.unwrap_or(self.max_acceleration_mps2),
            cruise_mps: group.cruise_mps.or(self.cruise_mps),
            tolerance_m: group.tolerance_m.or(self.tolerance_m),
            sight_m: group.sight_m.unwrap_or(self.sight_m),
            guidance,
            safety,
            orca: group.orca.unwrap_or(if both_orca { self.orca } else { OrcaTable::default() }),
            push_out: group.push_out.or(self.push_out.filter(|_| both_push_out)),
            lattice: group.lattice.or(self.lattice.filter(|_| goes_alike)),
            goal_flock: group.goal_flock.or(self.goal_flock.filter(|_| goes_alike)),
            boids: group.boids.or(self.boids.filter(|_| goes_alike)),
            flock: match guidance {
                // On the air the number of a place stands where that of a flock does.
                GuidanceKind::Formation => 0,
                // Each its own; the last ones share the last.
                _ => group.flock.unwrap_or(places.saturating_add(u8::try_from(index + 1).unwrap_or(u8::MAX))),
            },
        }
    }

    /// What one robot of a list, at `field`, says of its body instead; `None`: nothing.
    pub fn entry(&self, field: &str, entry: &PlaneRobotEntry) -> Option<Self> {
        (entry.radius_m.is_some() || entry.max_speed_mps.is_some()).then(|| Self {
            tables: self.below(field.to_owned()),
            radius_m: entry.radius_m.unwrap_or(self.radius_m),
            max_speed_mps: entry.max_speed_mps.unwrap_or(self.max_speed_mps),
            ..self.clone()
        })
    }

    /// The tables of one that stands in `table` and leaves the rest to this one.
    fn below(&self, table: String) -> Vec<String> {
        let mut tables = vec![table];
        tables.extend_from_slice(&self.tables);
        tables
    }

    /// The table that says most, for errors about who takes part.
    pub fn table(&self) -> &str {
        &self.tables[0]
    }

    /// Where a field that counts for these robots stands, or would.
    pub fn field(&self, source: &Source<'_>, name: &str) -> String {
        let mut fields = self.tables.iter().map(|table| format!("{table}.{name}"));
        let found = fields.find(|field| source.stands(field));
        found.unwrap_or_else(|| format!("{}.{name}", self.tables[0]))
    }

    /// An error unless a value is in its range.
    pub fn within(
        &self,
        source: &Source<'_>,
        name: &str,
        value: f64,
        range: [f64; 2],
        unit: &str,
    ) -> Result<(), ScenarioError> {
        within(source, &self.field(source, name), value, range[0], range[1], unit)
    }
}
