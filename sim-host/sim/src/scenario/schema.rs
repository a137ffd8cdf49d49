//! The top-level fields of a scenario file, with their documentation.
//!
//! Cells are `[x, y]` from the south-west corner of the (cropped) map, x east and y north. Times
//! are simulated. File names are relative to the scenario file.

use super::clocks::ClocksTable;
use super::formation::FormationEntry;
use super::grid::GridTable;
use super::intervention::InterventionTable;
use super::maps::MapsTable;
use super::plane::{PlaneTable, RobotsSource};
use super::plausibility::PlausibilityTable;
use super::read::AnyTable;
use super::robots::RobotsTable;
use crate::radio::RadioParams;
use crate::terrain::LoadOptions;
use crate::terrain::generate::Hills;
use crate::terrain::known::{LEAST_BYTES, MOST_BYTES};
use crate::{choice, names, one_of, table};
use staya_controller::grid::Norm;
use staya_controller::scalar::NumberFormat;
use std::path::PathBuf;

table! {
    /// A whole file.
    pub struct ScenarioFile {
        /// Name of the scenario; results go to `out/<name>`. Letters, digits, `-` and `_`.
        pub name: String;
        /// Seed of all random draws. Default: 0. `--seed` replaces it.
        pub seed: u64 = 0;
        /// Limit of ticks, 1 or more; the run ends when all have arrived. `--ticks` replaces it.
        pub ticks: u32;
        /// Tick length, 0.001 to 60 s: the time to cross a cell of impassability 1. Default: 1.
        pub tick_s: f64 = 1.0, 0.001..=60.0, "seconds";
        /// Number format of the robots' arithmetic. Default: `"f32"`. Others run by `staya hil` and
        /// `staya experiment`.
        pub numbers: NumberFormat = NumberFormat::F32;
        /// When robots in the plane decide. Default: all of them in each tick.
        pub clocks: ClocksTable = Default::default();
        /// The terrain; optional with `[plane]`.
        pub terrain: Option<TerrainTable>;
        /// Terrain that robots know before they see it. Default: none.
        pub scouting: Option<ScoutingTable>;
        /// Rules of the grid.
        pub grid: GridTable = Default::default();
        /// The radio. Default: lossless within 100 m.
        pub radio: RadioParams = Default::default();
        /// Robots in cells; with `[plane]`, `plane.robots` may give them in metres instead.
        pub robots: Option<RobotsTable>;
        /// Bodies that move in the plane or in space instead of from cell to cell.
        pub plane: Option<PlaneTable>;
        /// Exchange of terrain maps.
        pub maps: MapsTable = Default::default();
        /// Temporary failures of robots.
        pub fault: Vec<FaultTable> = Vec::new();
        /// Changes during the run: goals, obstacles, radio, parameters.
        pub intervention: Vec<InterventionTable> = Vec::new();
        /// Robots that use the id of another robot by mistake.
        pub misnumbered: Vec<MisnumberedTable> = Vec::new();
        /// Shared key of the robots. Default: beacons are not authenticated.
        pub authentication: Option<AuthenticationTable>;
        /// Plausibility limits on received beacons.
        pub plausibility: PlausibilityTable = Default::default();
        /// Attackers with radios.
        pub attack: Vec<AttackTable> = Vec::new();
        /// Fields of a study, which only `staya experiment` uses.
        pub study: Option<AnyTable>;
    }
}

impl ScenarioFile {
    /// Whether robots given in cells keep a formation.
    #[must_use]
    pub fn cells_in_formation(&self) -> bool {
        matches!(&self.robots, Some(RobotsTable::Formation(_)))
    }

    /// Whether any robots keep a formation.
    #[must_use]
    pub fn in_formation(&self) -> bool {
        self.formations().next().is_some()
    }

    pub(super) fn formations(&self) -> impl Iterator<Item = &FormationEntry> {
        let in_cells = match &self.robots {
            Some(RobotsTable::Formation(formations)) => &formations.0[..],
            _ => &[],
        };
        let groups = self.plane.iter().flat_map(|plane| &plane.group);
        in_cells.iter().chain(groups.filter_map(|group| match &group.robots.robots {
            RobotsSource::Formation(formation) => Some(formation),
            _ => None,
        }))
    }
}

table! {
    /// `[terrain]`.
    pub struct TerrainTable {
        part land: LandSource;
        /// Conversion of the file to impassability.
        pub load: LoadOptions = Default::default();
        /// Part of the map to use. Default: all of it.
        pub crop: Option<Crop>;
        /// Side of a cell in metres, more than 0. Default: the map's value, else 1.
        pub cell_m: Option<f64>, 0.001..=100_000.0, "metres";
        /// Changes of the terrain during the run.
        pub change: Vec<ChangeTable> = Vec::new();
    }
}

one_of! {
    /// Origin of the terrain.
    pub enum LandSource {
        /// A map file: `.map` (Moving AI), `.asc` (ESRI heights), `.yaml` (ROS map_server).
        File(PathBuf) = "file";
        /// Impassability drawn independently for each cell. With `classes = 1`: flat terrain.
        Uniform(UniformTable) = "uniform";
        /// Hills of mud (KUZ section 5).
        Natural(NaturalTable) = "natural";
        /// Terrain with a given configuration entropy and total edge (KUZ section 4).
        Entropy(EntropyTable) = "entropy";
    }
}

one_of! {
    /// Cells that change.
    pub enum Area {
        /// Individual cells.
        Cells(Vec<[i16; 2]>) = "cells";
        /// All cells of a rectangle.
        Rectangle(Crop) = "rectangle";
        /// All cells whose centre is in a polygon with these corners, metres.
        Polygon(Vec<[f64; 2]>) = "polygon_m";
    }
}

one_of! {
    /// How cells change.
    pub enum ChangeSource {
        /// New value of the cells: ticks to cross one, 1 to 255; 0: closed.
        Class(u8) = "class";
        /// Makes some of the cells slower or faster instead.
        Drift(DriftTable) = "drift";
    }
}

table! {
    /// `[[terrain.change]]`. A `class` needs an area.
    pub struct ChangeTable {
        part area: Option<Area>;
        part becomes: ChangeSource;
        /// Time, seconds after the start. Applied before the first tick from then on. Default: 0.
        pub at_s: f64 = 0.0, 0.0..=14_400_000.0, "seconds";
        /// Period of repetition, seconds. Default: once.
        pub every_s: Option<f64>;
        /// With `class`: seconds until the cells revert; less than `every_s`. Default: never.
        pub for_s: Option<f64>;
    }
}

table! {
    /// `drift` of `[[terrain.change]]`.
    #[derive(Copy)]
    pub struct DriftTable {
        /// Share of the cells that are drawn each time, 0 to 1; at least one cell.
        pub share: f64, 0.0..=1.0, "(a share)";
        /// Change of the crossing time. Cells take 1 to 255 ticks, so more than 254 has no effect.
        pub step: u8 = 1, 1.0..=254.0, "ticks";
        /// Longest crossing time of a cell, ticks. Default: the longest of the map.
        pub classes: Option<u8>, 1.0..=255.0, "ticks";
    }
}

table! {
    /// `terrain.uniform`.
    #[derive(Copy)]
    pub struct UniformTable {
        /// Cells from west to east.
        pub width: u16;
        /// Cells from south to north.
        pub height: u16;
        /// Number of classes: a cell takes 1 to this many ticks. Default: 9.
        pub classes: u8 = 9;
        /// Seed of the terrain. Default: the scenario's seed.
        pub seed: Option<u64>;
    }
}

table! {
    /// `terrain.natural`.
    #[derive(Copy)]
    pub struct NaturalTable {
        part size: UniformTable;
        /// Number of hilltops.
        pub obstacles: u32;
        /// Shape of a hill: `"euclidean"` (round; the default) or `"chebyshev"` (square).
        pub norm: Norm = Default::default();
        /// Slopes of hills: `"even"` (the default), `"rounded"`, `"wide"`, `"added"` or `"rough"`.
        pub hills: Hills = Default::default();
        /// Whether the cells are then put in random order: equal entropy without hills. Default:
        /// false.
        pub shuffled: bool = false;
    }
}

table! {
    /// `terrain.entropy`.
    #[derive(Copy)]
    pub struct EntropyTable {
        part size: UniformTable;
        /// Target configuration entropy S, 0 to ln(classes).
        pub entropy: f64;
        /// Tolerance of S. Default: 0.01.
        pub entropy_tolerance: f64 = 0.01;
        /// Target total edge TE.
        pub total_edge: u64;
        /// Tolerance of TE. Default: 0.
        pub edge_tolerance: u64 = 0;
    }
}

table! {
    /// `[scouting]`.
    pub struct ScoutingTable {
        /// An outdated map, read and cropped as in `[terrain]`. Default: the terrain at the start.
        pub map: Option<PathBuf>;
        /// Share of the map's patches that are unknown, 0 to 1. Default: 0.
        pub unknown: f64 = 0.0, 0.0..=1.0, "(a share)";
        /// Share of the map's patches that show another part of it, 0 to 1. Default: 0.
        pub wrong: f64 = 0.0, 0.0..=1.0, "(a share)";
        /// Side of a patch, cells, 1 to 1000. Default: 1.
        pub patch_cells: Option<u16>, 1.0..=1000.0, "cells";
        /// Assumed crossing time of unknown cells, ticks, 1 to 255. Default: the median of the map.
        pub assumed: Option<u8>, 1.0..=255.0, "ticks";
        /// Seed of the unknown and wrong patches. Default: the scenario's seed.
        pub seed: Option<u64>;
        /// Planning radius, cells in each direction, 1 to 16, at least `grid.radius`. Default: 16.
        pub radius: Option<u8>;
        /// Most bytes of a table of costs to go to its goal, which each robot keeps instead of the
        /// map, 32 to 65536. Default: none.
        pub model_bytes: Option<u32>, LEAST_BYTES as f64..=MOST_BYTES as f64, "bytes";
    }
}

table! {
    /// A rectangle of cells: `{ x, y, width, height }`, where x and y are its south-west corner.
    #[derive(Copy)]
    pub struct Crop {
        /// Column of the south-west corner.
        pub x: u16;
        /// Row of the south-west corner.
        pub y: u16;
        /// Number of columns.
        pub width: u16;
        /// Number of rows.
        pub height: u16;
    }
}

table! {
    /// `[[fault]]`: a robot's computer fails and restarts. It keeps only id, parameters and task;
    /// its clock restarts at 0.
    #[derive(Copy)]
    pub struct FaultTable {
        /// Id of the robot.
        pub robot: u32;
        /// Time of the failure, seconds after the start.
        pub at_s: f64, 0.0..=1e9, "seconds";
        /// Time until the restart, seconds; the robot is stationary and silent. Default: 0.
        pub down_s: f64 = 0.0, 0.0..=1e9, "seconds";
    }
}

table! {
    /// `[[misnumbered]]`: a robot with the id of another one; file and results use its own.
    #[derive(Copy)]
    pub struct MisnumberedTable {
        /// Correct id of the robot.
        pub robot: u32;
        /// Id that the robot uses.
        pub number: u32;
    }
}

one_of! {
    /// A key of all robots, or a secret of the operator.
    pub enum Secret {
        /// A file with 64 hexadecimal digits, or with `passphrase: ` and words.
        KeyFile(PathBuf) = "key_file";
        /// The same text inline, for demonstrations only: a scenario file is not a place for
        /// secrets.
        Key(String) = "key";
        /// Instead of a key, such a file with the operator's master secret: each robot then also
        /// has its own key, and accepts orders and new keys only under that key.
        MasterFile(PathBuf) = "master_file";
        /// The same text inline, for demonstrations only.
        Master(String) = "master";
    }
}

table! {
    /// `[authentication]`: robots tag (postcard) or sign (MAVLink) their frames, and reject frames
    /// without a valid key.
    pub struct AuthenticationTable {
        part secret: Secret;
        /// With a master: position of the operator's radio, metres. Default: the south-west corner.
        pub place_m: Option<[f64; 2]>, -2e6..=2e6, "metres";
        /// With a master: longest wait for answers per phase of a rotation, seconds. Default: 5.
        pub overlap_s: Option<f64>, 0.0..=1e9, "seconds";
        /// With a master: key rotations.
        pub roll: Vec<RollTable> = Vec::new();
    }
}

table! {
    /// `[[authentication.roll]]`
    pub struct RollTable {
        /// Time at which the operator begins, seconds after the start.
        pub at_s: f64, 0.0..=1e9, "seconds";
        /// Robots that do not receive this key or any later one.
        pub revoke: Vec<u32> = Vec::new();
    }
}

choice! {
    /// Method of an attack.
    pub enum AttackKind {
        /// Records all frames that it receives and repeats them later.
        Replay = "replay",
        /// Sends orders under a robot's id, with a tag or signature of a guessed key.
        Forge = "forge",
        /// Sends the same orders without tag or signature.
        Unsigned = "unsigned",
        /// Controls a robot with its keys, and sends false messages.
        Insider = "insider",
    }
}

choice! {
    /// A false statement of an insider.
    pub enum Lie {
        /// Orders all robots to the lure.
        Orders = "orders",
        /// Claims the largest radius that a beacon can encode, at the lure.
        Radius = "radius",
        /// Claims the highest speed that a beacon can encode, from its place towards the lure.
        Speed = "speed",
        /// Claims to be at the lure in one tick and at its place in the next.
        Jump = "jump",
        /// Claims that further robots exist around the lure.
        Ghosts = "ghosts",
    }
}

table! {
    /// `[[attack]]`: a hostile radio with the properties of the robots' radios.
    pub struct AttackTable {
        /// `"replay"`, `"forge"`, `"unsigned"` or `"insider"`.
        pub kind: AttackKind;
        /// Position, metres from the south-west corner.
        pub place_m: [f64; 2], -2e6..=2e6, "metres";
        /// Start of the attack, seconds after the start of the run. Default: 0.
        pub from_s: f64 = 0.0, 0.0..=1e9, "seconds";
        /// End of the attack, seconds. Default: never.
        pub to_s: Option<f64>, 0.0..=1e9, "seconds";
        /// Place to which it orders the robots, or about which it lies, metres; not for `"replay"`.
        pub lure_m: Option<[f64; 2]>, -2e6..=2e6, "metres";
        /// Id of the robot that it impersonates. Default: the last one.
        pub claims: Option<u32>;
        /// Replay delay, seconds. Default: 10; only for `"replay"`.
        pub delay_s: Option<f64>, 0.0..=1e9, "seconds";
        /// Lies of an `"insider"`: any of `"orders"`, `"radius"`, `"speed"`, `"jump"`, `"ghosts"`.
        pub lies: Vec<Lie> = Vec::new();
        /// Number of invented robots, 1 to 100. Default: 16; only for `"ghosts"`.
        pub ghosts: Option<u8>, 1.0..=100.0, "robots";
    }
}

names!(Hills, NumberFormat);
