//! The top-level fields of a scenario file, with their documentation.
//!
//! Cells are `[x, y]` from the south-west corner of the (cropped) map, x east and y north. Times
//! are simulated. File names are relative to the scenario file.

use super::formation::FormationEntry;
use super::intervention::InterventionTable;
use super::law::LawTable;
use super::maps::MapsTable;
use super::params::{FormationTable, GridTable, RouteTable};
use super::plane::PlaneTable;
use super::plausibility::PlausibilityTable;
use super::robots::RobotsTable;
use crate::radio::RadioParams;
use crate::terrain::LoadOptions;
use crate::terrain::generate::Hills;
use serde::Deserialize;
use staya_controller::grid::Norm;
use std::path::PathBuf;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Name of the scenario; results go to `out/<name>`. Letters, digits, `-` and `_`.
    pub name: String,
    /// Seed of all random draws. Default: 0. `--seed` replaces it.
    #[serde(default)]
    pub seed: u64,
    /// Limit of ticks, 1 or more; the run ends when all have arrived. `--ticks` replaces it.
    pub ticks: u32,
    /// Tick length, 0.001 to 60 s: the time to cross a cell of impassability 1. Default: 1.
    #[serde(default = "one")]
    pub tick_s: f64,
    /// The terrain; optional with `[plane]`.
    pub terrain: Option<TerrainTable>,
    /// Terrain that robots know before they see it. Default: none.
    pub scouting: Option<ScoutingTable>,
    /// Rules of the grid.
    #[serde(default)]
    pub grid: GridTable,
    /// The radio. Default: lossless within 100 m.
    #[serde(default)]
    pub radio: RadioParams,
    /// Robots in cells; with `[plane]`, `plane.robots` may give them in metres instead.
    pub robots: Option<RobotsTable>,
    /// Bodies that move in the plane or in space instead of from cell to cell.
    pub plane: Option<PlaneTable>,
    /// A law that the program adds. Default: the laws of Staya.
    pub law: Option<LawTable>,
    /// Route planning.
    #[serde(default)]
    pub route: RouteTable,
    /// Exchange of terrain maps.
    #[serde(default)]
    pub maps: MapsTable,
    /// Formation keeping.
    #[serde(default)]
    pub formation: FormationTable,
    /// Temporary failures of robots.
    #[serde(default)]
    pub fault: Vec<FaultTable>,
    /// Changes during the run: goals, obstacles, radio, parameters.
    #[serde(default)]
    pub intervention: Vec<InterventionTable>,
    /// Robots that use the id of another robot by mistake.
    #[serde(default)]
    pub misnumbered: Vec<MisnumberedTable>,
    /// Shared key of the robots. Default: beacons are not authenticated.
    pub authentication: Option<AuthenticationTable>,
    /// Plausibility limits on received beacons.
    #[serde(default)]
    pub plausibility: PlausibilityTable,
    /// Attackers with radios.
    #[serde(default)]
    pub attack: Vec<AttackTable>,
}

impl ScenarioFile {
    /// Whether robots given in cells keep a formation.
    #[must_use]
    pub fn cells_in_formation(&self) -> bool {
        self.robots.as_ref().is_some_and(|robots| !robots.formation.is_empty())
    }

    /// Whether any robots keep a formation.
    #[must_use]
    pub fn in_formation(&self) -> bool {
        self.cells_in_formation() || !self.group_formations().is_empty()
    }

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
    /// A map file: `.map` (Moving AI), `.asc` (ESRI heights), `.yaml` (ROS map_server).
    pub file: Option<PathBuf>,
    /// Impassability drawn independently for each cell. With `classes = 1`: flat terrain.
    pub uniform: Option<UniformTable>,
    /// Hills of mud (KUZ section 5).
    pub natural: Option<NaturalTable>,
    /// Terrain with a given configuration entropy and total edge (KUZ section 4).
    pub entropy: Option<EntropyTable>,
    /// Conversion of the file to impassability; see [`LoadOptions`].
    #[serde(default)]
    pub load: LoadOptions,
    /// Part of the map to use. Default: all of it.
    pub crop: Option<Crop>,
    /// Side of a cell in metres, more than 0. Default: the map's value, else 1.
    pub cell_m: Option<f64>,
    /// Changes of the terrain during the run.
    #[serde(default)]
    pub change: Vec<ChangeTable>,
}

/// `[[terrain.change]]`: exactly one of `class`, `drift`; at most one of `cells`, `rectangle`,
/// `polygon_m` (one with `class`).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChangeTable {
    /// Time, seconds after the start. Applied before the first tick from then on. Default: 0.
    #[serde(default)]
    pub at_s: f64,
    /// Period of repetition, seconds. Default: once.
    pub every_s: Option<f64>,
    /// With `class`: seconds until the cells revert; less than `every_s`. Default: never.
    pub for_s: Option<f64>,
    /// Individual cells.
    pub cells: Option<Vec<[i16; 2]>>,
    /// All cells of a rectangle.
    pub rectangle: Option<Crop>,
    /// All cells whose centre is in a polygon with these corners, metres.
    pub polygon_m: Option<Vec<[f64; 2]>>,
    /// New value of the cells: ticks to cross one, 1 to 255; 0: closed.
    pub class: Option<u8>,
    /// Makes some of the cells slower or faster instead.
    pub drift: Option<DriftTable>,
}

/// `drift` of `[[terrain.change]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriftTable {
    /// Share of the cells that are drawn each time, 0 to 1; at least one cell.
    pub share: f64,
    /// Change of the crossing time, ticks, 1 to 254. Default: 1.
    #[serde(default = "one_class")]
    pub step: u8,
    /// Longest crossing time of a cell, ticks. Default: the longest of the map.
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
    /// Seed of the terrain. Default: the scenario's seed.
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
    /// Seed of the terrain. Default: the scenario's seed.
    pub seed: Option<u64>,
    /// Number of hilltops.
    pub obstacles: u32,
    /// Shape of a hill: `"euclidean"` (round; the default) or `"chebyshev"` (square).
    #[serde(default)]
    pub norm: Norm,
    /// Slopes of hills: `"even"` (the default), `"rounded"`, `"wide"`, `"added"` or `"rough"`.
    #[serde(default)]
    pub hills: Hills,
    /// Whether the cells are then put in random order: equal entropy without hills. Default: false.
    #[serde(default)]
    pub shuffled: bool,
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
    /// Seed of the terrain. Default: the scenario's seed.
    pub seed: Option<u64>,
    /// Target configuration entropy S, 0 to ln(classes).
    pub entropy: f64,
    /// Tolerance of S. Default: 0.01.
    #[serde(default = "hundredth")]
    pub entropy_tolerance: f64,
    /// Target total edge TE.
    pub total_edge: u64,
    /// Tolerance of TE. Default: 0.
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
    /// An outdated map, read and cropped as in `[terrain]`. Default: the terrain at the start.
    pub map: Option<PathBuf>,
    /// Share of the map's patches that are unknown, 0 to 1. Default: 0.
    pub unknown: f64,
    /// Share of the map's patches that show another part of it, 0 to 1. Default: 0.
    pub wrong: f64,
    /// Side of a patch, cells, 1 to 1000. Default: 1.
    pub patch_cells: Option<u16>,
    /// Assumed crossing time of unknown cells, ticks, 1 to 255. Default: the median of the map.
    pub assumed: Option<u8>,
    /// Seed of the unknown and wrong patches. Default: the scenario's seed.
    pub seed: Option<u64>,
    /// Planning radius, cells in each direction, 1 to 16, at least `route.radius`. Default: 16.
    pub radius: Option<u8>,
}

/// A rectangle of cells: `{ x, y, width, height }`, where x and y are its south-west corner.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "said above")]
pub struct Crop {
    pub x: u16,
    pub y: u16,
    pub width: u16,
    pub height: u16,
}

/// `[[fault]]`: a robot's computer fails and restarts. It keeps only id, parameters and task; its
/// clock restarts at 0.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultTable {
    /// Id of the robot.
    pub robot: u32,
    /// Time of the failure, seconds after the start.
    pub at_s: f64,
    /// Time until the restart, seconds; the robot is stationary and silent. Default: 0.
    #[serde(default)]
    pub down_s: f64,
}

/// `[[misnumbered]]`: a robot with the id of another one; file and results use its own.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MisnumberedTable {
    /// Correct id of the robot.
    pub robot: u32,
    /// Id that the robot uses.
    pub number: u32,
}

/// `[authentication]`: exactly one of the four key fields. Robots then tag (postcard) or sign
/// (MAVLink) their frames, and reject frames without a valid key.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AuthenticationTable {
    /// A file with 64 hexadecimal digits, or with `passphrase: ` and words.
    pub key_file: Option<PathBuf>,
    /// The same text inline, for demonstrations only: a scenario file is not a place for secrets.
    pub key: Option<String>,
    /// Instead of a key, such a file with the operator's master secret: each robot then also has
    /// its own key, and accepts orders and new keys only under that key.
    pub master_file: Option<PathBuf>,
    /// The same text inline, for demonstrations only.
    pub master: Option<String>,
    /// With a master: position of the operator's radio, metres. Default: the south-west corner.
    pub place_m: Option<[f64; 2]>,
    /// With a master: longest wait for answers per phase of a rotation, seconds. Default: 5.
    pub overlap_s: Option<f64>,
    /// With a master: key rotations.
    #[serde(default)]
    pub roll: Vec<RollTable>,
}

/// `[[authentication.roll]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollTable {
    /// Time at which the operator begins, seconds after the start.
    pub at_s: f64,
    /// Robots that do not receive this key or any later one.
    #[serde(default)]
    pub revoke: Vec<u32>,
}

/// Method of an attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AttackKind {
    /// Records all frames that it receives and repeats them later.
    Replay,
    /// Sends orders under a robot's id, with a tag or signature of a guessed key.
    Forge,
    /// Sends the same orders without tag or signature.
    Unsigned,
    /// Controls a robot with its keys, and sends false messages.
    Insider,
}

/// A false statement of an insider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lie {
    /// Orders all robots to the lure.
    Orders,
    /// Claims the largest radius that a beacon can encode, at the lure.
    Radius,
    /// Claims the highest speed that a beacon can encode, from its place towards the lure.
    Speed,
    /// Claims to be at the lure in one tick and at its place in the next.
    Jump,
    /// Claims that further robots exist around the lure.
    Ghosts,
}

/// `[[attack]]`: a hostile radio with the properties of the robots' radios.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AttackTable {
    /// `"replay"`, `"forge"`, `"unsigned"` or `"insider"`.
    pub kind: AttackKind,
    /// Position, metres from the south-west corner.
    pub place_m: [f64; 2],
    /// Start of the attack, seconds after the start of the run. Default: 0.
    #[serde(default)]
    pub from_s: f64,
    /// End of the attack, seconds. Default: never.
    pub to_s: Option<f64>,
    /// Place to which it orders the robots, or about which it lies, metres; not for `"replay"`.
    pub lure_m: Option<[f64; 2]>,
    /// Id of the robot that it impersonates. Default: the last one.
    pub claims: Option<u32>,
    /// Replay delay, seconds. Default: 10; only for `"replay"`.
    pub delay_s: Option<f64>,
    /// Lies of an `"insider"`: any of `"orders"`, `"radius"`, `"speed"`, `"jump"`, `"ghosts"`.
    #[serde(default)]
    pub lies: Vec<Lie>,
    /// Number of invented robots, 1 to 100. Default: 16; only for `"ghosts"`.
    pub ghosts: Option<u8>,
}
