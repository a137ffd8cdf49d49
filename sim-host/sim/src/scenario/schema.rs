//! What a scenario file may say: the one place where every field is documented.
//!
//! Cells are `[x, y]` from the south-west corner of the (cropped) map, x east and y north. Times are
//! simulated. File names are relative to the scenario file.

use super::claims::ClaimsTable;
use super::formation::FormationEntry;
use super::intervention::InterventionTable;
use super::maps::MapsTable;
use super::params::{FormationTable, GridTable, RouteTable};
use super::plane::PlaneTable;
use super::robots::RobotsTable;
use crate::radio::RadioParams;
use crate::terrain::LoadOptions;
use serde::Deserialize;
use staya_controller::grid::Norm;
use std::path::PathBuf;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Name of the scenario; the run's results go to `out/<name>`. Letters, digits, `-` and `_`.
    pub name: String,
    /// Seed of everything random. Default: 0. `--seed` replaces it.
    #[serde(default)]
    pub seed: u64,
    /// Ticks after which the run ends, 1 or more; it ends earlier when all robots have arrived.
    /// `--ticks` replaces it.
    pub ticks: u32,
    /// Length of a tick in seconds, 0.001 to 60: the time in which a robot crosses a cell of
    /// impassability 1. Default: 1.
    #[serde(default = "one")]
    pub tick_s: f64,
    /// The land; may be left out with `[plane]`.
    pub terrain: Option<TerrainTable>,
    /// What robots know of the land before they see it. Default: nothing.
    pub scouting: Option<ScoutingTable>,
    /// Rules of the grid.
    #[serde(default)]
    pub grid: GridTable,
    /// The radio. Without this table: perfect within 100 m.
    #[serde(default)]
    pub radio: RadioParams,
    /// Who takes part, in cells; with `[plane]`, `plane.robots` may say it in metres instead.
    pub robots: Option<RobotsTable>,
    /// Bodies that move in the plane or in space instead of from cell to cell.
    pub plane: Option<PlaneTable>,
    /// How robots find their ways.
    #[serde(default)]
    pub route: RouteTable,
    /// What robots tell each other of the land.
    #[serde(default)]
    pub maps: MapsTable,
    /// How robots keep a formation.
    #[serde(default)]
    pub formation: FormationTable,
    /// Robots that fail during the run.
    #[serde(default)]
    pub fault: Vec<FaultTable>,
    /// What somebody does to the run: goals, obstacles, radio, parameters.
    #[serde(default)]
    pub intervention: Vec<InterventionTable>,
    /// Robots that have the number of another one, by mistake.
    #[serde(default)]
    pub misnumbered: Vec<MisnumberedTable>,
    /// The robots' common key. Without this table everybody is believed.
    pub authentication: Option<AuthenticationTable>,
    /// What robots may say of themselves and be believed.
    #[serde(default)]
    pub claims: ClaimsTable,
    /// Radios at the roadside whose owners want the robots to go elsewhere.
    #[serde(default)]
    pub attack: Vec<AttackTable>,
}

impl ScenarioFile {
    /// Whether robots given in cells keep a formation.
    #[must_use]
    pub fn cells_in_formation(&self) -> bool {
        self.robots.as_ref().is_some_and(|robots| !robots.formation.is_empty())
    }

    /// Whether any robots keep one.
    #[must_use]
    pub fn in_formation(&self) -> bool {
        self.cells_in_formation() || !self.group_formations().is_empty()
    }

    /// The formations of groups in the plane.
    pub(super) fn group_formations(&self) -> Vec<&FormationEntry> {
        let groups = self.plane.iter().flat_map(|plane| &plane.group);
        groups.filter_map(|group| group.robots.formation.as_ref()).collect()
    }
}

const fn one() -> f64 {
    1.0
}

/// `[terrain]`: exactly one of `file`, `uniform`, `natural`, `entropy`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TerrainTable {
    /// A map: `.map` (Moving AI), `.asc` (ESRI heights), `.yaml` (ROS map_server).
    pub file: Option<PathBuf>,
    /// Each cell's impassability drawn on its own. With `classes = 1`: flat land.
    pub uniform: Option<UniformTable>,
    /// Hills of mud (KUZ section 5).
    pub natural: Option<NaturalTable>,
    /// Land with a wanted configuration entropy and total edge (KUZ section 4).
    pub entropy: Option<EntropyTable>,
    /// How the file becomes impassability: `{ swamp, downsample, unknown, classes, slope = { classes, max_slope } }`.
    #[serde(default)]
    pub load: LoadOptions,
    /// The part of the map to use. Default: all of it.
    pub crop: Option<Crop>,
    /// Side of a cell in metres, more than 0. Default: what the map says, else 1.
    pub cell_m: Option<f64>,
    /// How the land changes while the run goes on.
    #[serde(default)]
    pub change: Vec<ChangeTable>,
}

/// `[[terrain.change]]`: exactly one of `class`, `drift`; at most one of `cells`, `rectangle`, `polygon_m` (one with `class`).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChangeTable {
    /// When, seconds after the start; before the tick that begins then, or the next one. Default: 0.
    #[serde(default)]
    pub at_s: f64,
    /// It happens again after so many seconds. Default: once.
    pub every_s: Option<f64>,
    /// With `class`: after so many seconds the cells are again as the map has them; less than `every_s`. Default: never.
    pub for_s: Option<f64>,
    /// Cells, each by itself.
    pub cells: Option<Vec<[i16; 2]>>,
    /// All cells of a rectangle.
    pub rectangle: Option<Crop>,
    /// All cells whose middle is in a polygon with these corners, metres.
    pub polygon_m: Option<Vec<[f64; 2]>>,
    /// What the cells become: ticks to cross one, 1 to 255; 0: closed.
    pub class: Option<u8>,
    /// Some of the cells become slower or faster instead.
    pub drift: Option<DriftTable>,
}

/// `drift` of `[[terrain.change]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriftTable {
    /// How many of the cells are drawn each time, as a share of them, 0 to 1; one at least.
    pub share: f64,
    /// By how many ticks they become slower or faster to cross, 1 to 254. Default: 1.
    #[serde(default = "one_class")]
    pub step: u8,
    /// The slowest that a cell becomes, ticks. Default: the slowest of the map.
    pub classes: Option<u8>,
}

const fn one_class() -> u8 {
    1
}

/// `terrain.uniform`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UniformTable {
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Number of classes: a cell takes 1 to this many ticks. Default: 9.
    #[serde(default = "nine")]
    pub classes: u8,
    /// Seed of the land. Default: the scenario's seed.
    pub seed: Option<u64>,
}

/// `terrain.natural`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NaturalTable {
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Number of classes: a cell takes 1 to this many ticks. Default: 9.
    #[serde(default = "nine")]
    pub classes: u8,
    /// Seed of the land. Default: the scenario's seed.
    pub seed: Option<u64>,
    /// Number of hilltops.
    pub obstacles: u32,
    /// Shape of a hill: `"euclidean"` (round; the default) or `"chebyshev"` (square).
    #[serde(default)]
    pub norm: Norm,
}

/// `terrain.entropy`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntropyTable {
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Number of classes: a cell takes 1 to this many ticks. Default: 9.
    #[serde(default = "nine")]
    pub classes: u8,
    /// Seed of the land. Default: the scenario's seed.
    pub seed: Option<u64>,
    /// Wanted configuration entropy S, 0 to ln(classes).
    pub entropy: f64,
    /// How far S may be off. Default: 0.01.
    #[serde(default = "hundredth")]
    pub entropy_tolerance: f64,
    /// Wanted total edge TE.
    pub total_edge: u64,
    /// How far TE may be off. Default: 0.
    #[serde(default)]
    pub edge_tolerance: u64,
}

const fn nine() -> u8 {
    9
}

const fn hundredth() -> f64 {
    0.01
}

/// `[scouting]`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ScoutingTable {
    /// An old map: a file like that of `[terrain]`, read and cropped in the same way. Default: the land as it is at the start.
    pub map: Option<PathBuf>,
    /// Share of the map's patches that are unknown, 0 to 1. Default: 0.
    pub unknown: f64,
    /// Share of the map's patches that show what is elsewhere on it, 0 to 1. Default: 0.
    pub wrong: f64,
    /// Cells along each side of a patch, 1 to 1000. Default: 1.
    pub patch_cells: Option<u16>,
    /// What robots take unknown cells for: ticks to cross one, 1 to 255. Default: the median of the map.
    pub assumed: Option<u8>,
    /// Seed of what is unknown and wrong. Default: the scenario's.
    pub seed: Option<u64>,
    /// How far robots plan on what they know, cells in each direction, 1 to 16, not less than `route.radius`. Default: 16.
    pub radius: Option<u8>,
}

/// A rectangle of cells: `{ x, y, width, height }`, x and y being its south-west corner.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "said above")]
pub struct Crop {
    pub x: u16,
    pub y: u16,
    pub width: u16,
    pub height: u16,
}

/// `[[fault]]`: a robot whose computer goes down and comes up again, having forgotten everything
/// but its number, its parameters and its task.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultTable {
    /// The robot.
    pub robot: u32,
    /// When it goes down, seconds after the start.
    pub at_s: f64,
    /// How long it stands and is silent, seconds. Its clock starts from 0 again. Default: 0.
    #[serde(default)]
    pub down_s: f64,
}

/// `[[misnumbered]]`: a robot whose owner gave it the number of another one. In this file and in the results it keeps its own.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MisnumberedTable {
    /// The robot.
    pub robot: u32,
    /// The number that it takes for its own.
    pub number: u32,
}

/// `[authentication]`: exactly one of these. Robots then tag (postcard) or sign (MAVLink) what they send, and hear only who has the key.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AuthenticationTable {
    /// A file with 64 hexadecimal digits, or with `passphrase: ` and words.
    pub key_file: Option<PathBuf>,
    /// The same text, for demonstrations: a scenario is no place for a secret.
    pub key: Option<String>,
    /// Instead of a key, such a file with the operator's secret: each robot then has a key of its own too, under which alone it takes orders and keys.
    pub master_file: Option<PathBuf>,
    /// The same text, for demonstrations.
    pub master: Option<String>,
    /// With a master: where the operator's radio stands, metres. Default: the south-west corner.
    pub place_m: Option<[f64; 2]>,
    /// With a master: how long the operator waits at most for all robots to answer, in each phase of a roll, seconds. Default: 5.
    pub overlap_s: Option<f64>,
    /// With a master: when the swarm gets another key.
    #[serde(default)]
    pub roll: Vec<RollTable>,
}

/// `[[authentication.roll]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollTable {
    /// When the operator begins, seconds after the start.
    pub at_s: f64,
    /// Robots that do not get this key, nor any later one.
    #[serde(default)]
    pub revoke: Vec<u32>,
}

/// What an attacker does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AttackKind {
    /// Records all that it hears, and sends it again later.
    Replay,
    /// Sends orders in a robot's name, with a tag or signature of a key that it guesses.
    Forge,
    /// Sends the same orders without tag or signature.
    Unsigned,
    /// Has a robot, with all that the robot knows, and lies with its keys.
    Insider,
}

/// What an insider says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lie {
    /// Orders everybody to the lure.
    Orders,
    /// That its robot is as large as a beacon can say, at the lure.
    Radius,
    /// That it goes as fast as a beacon can say, from where it stands to the lure.
    Speed,
    /// That it is at the lure in one tick and where it stands in the next one.
    Jump,
    /// That there are further robots, around the lure.
    Ghosts,
}

/// `[[attack]]`: a radio like those of the robots, and nobody's friend.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AttackTable {
    /// `"replay"`, `"forge"`, `"unsigned"` or `"insider"`.
    pub kind: AttackKind,
    /// Where it stands, metres from the south-west corner.
    pub place_m: [f64; 2],
    /// When it begins to send, seconds after the start. Default: 0.
    #[serde(default)]
    pub from_s: f64,
    /// When it ends. Default: never.
    pub to_s: Option<f64>,
    /// Where it orders the robots to, or what an insider lies about, metres; not for `"replay"`.
    pub lure_m: Option<[f64; 2]>,
    /// The robot in whose name it speaks. Default: the last one.
    pub claims: Option<u32>,
    /// Seconds from what it hears to its repetition. Default: 10; only for `"replay"`.
    pub delay_s: Option<f64>,
    /// What an `"insider"` says: one or more of `"orders"`, `"radius"`, `"speed"`, `"jump"`, `"ghosts"`.
    #[serde(default)]
    pub lies: Vec<Lie>,
    /// How many robots there are that do not exist, 1 to 100. Default: 16; only for `"ghosts"`.
    pub ghosts: Option<u8>,
}
