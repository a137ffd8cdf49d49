//! Fields of the `[robots]` table.

use super::super::formation::{self, FormationEntry};
use serde::Deserialize;
use std::path::PathBuf;

/// `[robots]`: exactly one of these fields.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotsTable {
    /// Individual robots.
    pub list: Option<Vec<RobotEntry>>,
    /// A formation that travels together, or several: `[[robots.formation]]`.
    #[serde(default, deserialize_with = "formation::one_or_more")]
    pub formation: Vec<FormationEntry>,
    /// The first robots of a Moving AI multi-agent scenario.
    pub scen: Option<ScenEntry>,
    /// Robots at random cells.
    pub scattered: Option<ScatteredEntry>,
}

/// One robot of `robots.list`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEntry {
    /// Id, 1 or more. Default: its position in the list, counted from 1.
    pub id: Option<u32>,
    /// Start cell.
    pub start: [i16; 2],
    /// Goal cell.
    pub goal: [i16; 2],
}

/// `robots.scen`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenEntry {
    /// The `.scen` file; its map must be the terrain, uncropped.
    pub file: PathBuf,
    /// Number of robots to take, from the top of the file.
    pub count: u32,
}

/// `robots.scattered`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatteredEntry {
    /// Number of robots, each in its own cell.
    pub count: u32,
    /// Farthest distance of a goal from its start along each axis, cells. Default: the whole map.
    pub travel: Option<u16>,
    /// Smallest distance of a goal from its start along the longer axis, cells. Default: 0.
    #[serde(default)]
    pub least: u16,
}
