//! Fields of a group of robots before they are checked.

use super::super::source::Source;
use super::super::{ScenarioError, ranges};
use super::table::{
    BoidsTable, GoalFlockTable, GroupTable, LatticeTable, OrcaTable, PlaneRobotEntry, PlaneTable, PushOutTable,
};
use super::within;
use staya_controller::agent::{GuidanceKind, SafetyKind};
use staya_controller::parameters::Parameters;

#[derive(Clone, Debug)]
pub(super) struct Spec {
    /// Tables that define the group, highest precedence first: `plane.group[1]`, `plane`.
    tables: Vec<String>,
    pub radius_m: f64,
    pub max_speed_mps: f64,
    pub max_acceleration_mps2: f64,
    pub lag_s: f64,
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
    /// The fields of `[plane]`. `places` is the size of the largest formation.
    pub fn general(table: &PlaneTable, places: u8) -> Self {
        Self {
            tables: vec!["plane".to_owned()],
            radius_m: table.radius_m,
            max_speed_mps: table.max_speed_mps,
            max_acceleration_mps2: table.max_acceleration_mps2,
            lag_s: table.lag_s,
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

    /// Inherits the tables of a law or a safety layer from `[plane]` only if it uses the same one.
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
            lag_s: group.lag_s.unwrap_or(self.lag_s),
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
                // A beacon stores a formation place and a flock number in the same field.
                GuidanceKind::Formation => 0,
                // Each group has its own flock; when numbers run out, the last groups share one.
                _ => group.flock.unwrap_or(places.saturating_add(u8::try_from(index + 1).unwrap_or(u8::MAX))),
            },
        }
    }

    /// The fields with the overrides of the list entry at `field`; `None` if it has none.
    pub fn entry(&self, field: &str, entry: &PlaneRobotEntry) -> Option<Self> {
        (entry.radius_m.is_some() || entry.max_speed_mps.is_some()).then(|| Self {
            tables: self.below(field.to_owned()),
            radius_m: entry.radius_m.unwrap_or(self.radius_m),
            max_speed_mps: entry.max_speed_mps.unwrap_or(self.max_speed_mps),
            ..self.clone()
        })
    }

    fn below(&self, table: String) -> Vec<String> {
        let mut tables = vec![table];
        tables.extend_from_slice(&self.tables);
        tables
    }

    pub fn table(&self) -> &str {
        &self.tables[0]
    }

    /// Path of a field: where the file sets it for these robots, else in the first table.
    pub fn field(&self, source: &Source<'_>, name: &str) -> String {
        let mut fields = self.tables.iter().map(|table| format!("{table}.{name}"));
        let found = fields.find(|field| source.stands(field));
        found.unwrap_or_else(|| format!("{}.{name}", self.tables[0]))
    }

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

    /// Checks the fields of `table` against the parameters with the same names and stores them.
    pub fn set(
        &self,
        source: &Source<'_>,
        table: &str,
        params: &mut dyn Parameters,
        fields: &[(&str, Option<f64>)],
    ) -> Result<(), ScenarioError> {
        for (name, value) in fields {
            ranges::set(source, &self.field(source, &format!("{table}.{name}")), *value, params, name)?;
        }
        Ok(())
    }
}
