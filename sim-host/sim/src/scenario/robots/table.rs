//! Fields of the `[robots]` table.

use super::super::formation::FormationEntries;
use crate::{one_of, table};
use std::path::PathBuf;

one_of! {
    /// `[robots]`.
    pub enum RobotsTable {
        /// Individual robots.
        List(Vec<RobotEntry>) = "list";
        /// A formation that travels together, or several: `[[robots.formation]]`.
        Formation(FormationEntries) = "formation";
        /// The first robots of a Moving AI multi-agent scenario.
        Scen(ScenEntry) = "scen";
        /// Robots at random cells.
        Scattered(ScatteredEntry) = "scattered";
    }
}

table! {
    /// One robot of `robots.list`.
    #[derive(Copy)]
    pub struct RobotEntry {
        /// Id, 1 or more. Default: its position in the list, counted from 1.
        pub id: Option<u32>;
        /// Start cell.
        pub start: [i16; 2];
        /// Goal cell.
        pub goal: [i16; 2];
    }
}

table! {
    /// `robots.scen`.
    pub struct ScenEntry {
        /// The `.scen` file; its map must be the terrain, uncropped.
        pub file: PathBuf;
        /// Number of robots to take, from the top of the file.
        pub count: u32;
    }
}

table! {
    /// `robots.scattered`.
    #[derive(Copy)]
    pub struct ScatteredEntry {
        /// Number of robots, each in its own cell.
        pub count: u32;
        /// Farthest distance of a goal from its start along each axis, cells. Default: the whole
        /// map.
        pub travel: Option<u16>;
        /// Smallest distance of a goal from its start along the longer axis, cells. Default: 0.
        pub least: u16 = 0;
    }
}
