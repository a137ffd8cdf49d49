//! What a scenario file says in `[robots]`.

use super::super::formation::{self, FormationEntry};
use serde::Deserialize;
use std::path::PathBuf;

/// `[robots]`: exactly one of these fields.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotsTable {
    /// Each robot by itself.
    pub list: Option<Vec<RobotEntry>>,
    /// A formation that travels together, or several: `[[robots.formation]]`.
    #[serde(default, deserialize_with = "formation::one_or_more")]
    pub formation: Vec<FormationEntry>,
    /// The first robots of a Moving AI multi-agent scenario.
    pub scen: Option<ScenEntry>,
    /// Robots at random places.
    pub scattered: Option<ScatteredEntry>,
}

/// One robot of `robots.list`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEntry {
    /// Its number, 1 or more. Default: its place in the list, counted from 1.
    pub id: Option<u32>,
    /// The cell where it starts.
    pub start: [i16; 2],
    /// The cell where it should go.
    pub goal: [i16; 2],
}

/// `robots.scen`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenEntry {
    /// The `.scen` file; its map must be the terrain, uncropped.
    pub file: PathBuf,
    /// How many robots to take from it, from the top.
    pub count: u32,
}

/// `robots.scattered`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatteredEntry {
    /// How many robots, each in a cell of its own.
    pub count: u32,
    /// Farthest distance of a goal from its start in cells along each axis. Default: the whole map.
    pub travel: Option<u16>,
}
