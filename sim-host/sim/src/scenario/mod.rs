//! Scenarios: simulation inputs, read from TOML and checked before a run starts.
//!
//! [`ScenarioFile`] documents every field. Errors name file, line, field and remedy.

mod authentication;
mod check;
mod field;
mod fingerprint;
mod formation;
mod intervention;
mod land;
mod law;
mod maps;
mod params;
mod plane;
mod plausibility;
mod ranges;
mod read;
mod robots;
mod schema;
mod scouting;
mod setting;
mod setup;
mod source;
mod write;

pub use authentication::Keys;
pub use field::Field;
pub use formation::FormationEntry;
pub use intervention::{Intervention, InterventionTable, with_interventions};
pub use law::{LawTable, NamedLaw};
pub use maps::MapsTable;
pub use params::{FormationLaw, FormationSetup, FormationTable, GridTable, RouteTable};
pub(crate) use plane::goals;
pub use plane::{
    BallEntry, BallsEntry, BoidsTable, CircleEntry, CloudEntry, GoalFlockTable, GroupTable, HalfSpaceEntry, Intruder,
    IntruderEntry, LatticeTable, OrcaTable, Order, OrderEntry, Place, PlaneRobotEntry, PlaneRobots, PlaneSetup,
    PlaneTable, PushOutTable, RobotGroup, ScatteredDiscs, SensingTable, Start, Target, WallEntry, circle_starts,
};
pub use plausibility::PlausibilityTable;
pub use ranges::within;
pub use read::{AnyTable, Field as Read, Fields, Line, Node, Table, Wrong, empty, nearest, plain, word};
pub use robots::{Formation, Robot, RobotEntry, RobotsTable, ScatteredEntry, ScenEntry};
pub use schema::{
    AttackKind, AttackTable, AuthenticationTable, ChangeTable, Crop, DriftTable, EntropyTable, FaultTable, Lie,
    MisnumberedTable, NaturalTable, RollTable, ScenarioFile, ScoutingTable, TerrainTable, UniformTable,
};
pub use setting::{Setting, text_with, with_settings};
pub use source::{Location, ScenarioError, Source};
pub use write::{fields, inline};

use crate::radio::RadioParams;
use crate::terrain::Terrain;
use crate::terrain::change::LandChange;
use crate::world::MoveRules;
pub use crate::world::plane::Sensing;
pub use crate::world::scouts::Scouting;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{GuidanceSetup, RouteSetup};
use staya_controller::auth::Key;
use staya_controller::land::MapParams;
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::robot::RobotId;
use std::ops::Range;
use std::path::{Path, PathBuf};

const LIST: &str = "scenarios/README.md";

/// Command-line values that replace fields of the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Replaces `seed`.
    pub seed: Option<u64>,
    /// Replaces `ticks`; at least 1.
    pub ticks: Option<u32>,
}

/// Robots that one table of the file describes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The table: `plane`, `plane.group[0]` or `robots.formation[1]`.
    pub table: String,
    /// Robot indices, counted from 0.
    pub members: Range<usize>,
}

/// A temporary failure of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Id of the robot.
    pub robot: RobotId,
    /// First tick in which the robot is stationary and silent.
    pub from_tick: u32,
    /// Tick in which the robot restarts; at least `from_tick`.
    pub to_tick: u32,
}

/// An attacker that tries to divert the robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Attack {
    /// Method of the attack.
    pub kind: AttackKind,
    /// Position of its radio, metres.
    pub place_m: [f64; 2],
    /// First tick in which it sends.
    pub from_tick: u32,
    /// First tick after the attack.
    pub to_tick: u32,
    /// Place to which it orders the robots, metres.
    pub lure_m: [f64; 2],
    /// Robot id that it impersonates.
    pub claims: RobotId,
    /// Replay delay, ticks.
    pub delay_ticks: u32,
    /// False statements of an insider.
    pub lies: Vec<Lie>,
    /// Number of robots that an insider invents.
    pub ghosts: u8,
}

/// The operator that holds the master secret, and its key rotations.
#[derive(Clone, Debug)]
pub struct KeyRotation {
    /// Secret from which all keys are derived.
    pub master: Key,
    /// Position of the operator's radio, metres.
    pub place_m: [f64; 2],
    /// Longest wait in each phase of a key rotation, ticks.
    pub overlap_ticks: u32,
    /// Key rotations, sorted by tick.
    pub rolls: Vec<Roll>,
}

/// A key rotation of the swarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Roll {
    /// Tick in which the rotation begins.
    pub tick: u32,
    /// Robots that do not receive this key or any later one.
    pub revoke: Vec<RobotId>,
}

/// A checked scenario, ready to run.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name of the scenario.
    pub name: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Ticks after which the run ends.
    pub ticks: u32,
    /// Length of a tick, microseconds.
    pub tick_us: u32,
    /// The terrain; one flat cell for a plane without terrain.
    pub terrain: Terrain,
    /// Changes of the terrain during the run.
    pub changes: Vec<LandChange>,
    /// Terrain that robots know before they see it; `None`: only what their laws remember.
    pub scouting: Option<Scouting>,
    /// Rules of movement on the grid.
    pub rules: MoveRules,
    /// Parameters of the radio.
    pub radio: RadioParams,
    /// Robots, sorted by id. Starts are free and distinct; goals are distinct.
    pub robots: Vec<Robot>,
    /// Formations; each robot is in at most one.
    pub formations: Vec<Formation>,
    /// Groups of different robots, in the file's order; empty if all robots are alike.
    pub parts: Vec<Part>,
    /// Bodies in the plane or in space; `None`: robots move from cell to cell.
    pub plane: Option<PlaneSetup>,
    /// Sensing of other robots in the plane; `None`: disabled.
    pub sensing: Option<Sensing>,
    /// The law of all robots, if the program adds it.
    pub law: Option<NamedLaw>,
    /// Route planning of the robots.
    pub route: RouteSetup,
    /// Exchange of terrain maps; `None`: disabled.
    pub maps: Option<MapParams>,
    /// The law of formations.
    pub formation_law: FormationSetup,
    /// Temporary failures of robots.
    pub faults: Vec<Fault>,
    /// Interventions with their ticks, sorted by tick.
    pub interventions: Vec<(u32, Intervention)>,
    /// Robots with a wrong id: the id in this scenario, then the id that the robot claims.
    pub misnumbered: Vec<(RobotId, RobotId)>,
    /// Keys of the swarm; `None`: beacons are not authenticated.
    pub keys: Option<Keys>,
    /// Plausibility limits on received beacons.
    pub plausibility: PlausibilityLimits<f32>,
    /// Attackers.
    pub attacks: Vec<Attack>,
    /// The files that the scenario was read from.
    pub files: Vec<PathBuf>,
    /// Fields of the file with overrides applied, for result files; without secrets.
    pub parameters: serde_json::Value,
}

impl Scenario {
    /// Reads and checks a scenario file and the files that it names.
    ///
    /// # Errors
    /// A [`ScenarioError`] that names file, line, field and remedy.
    pub fn load(path: &Path, overrides: &Overrides) -> Result<Self, ScenarioError> {
        Self::load_with(path, overrides, &[])
    }

    /// Parses and checks the text of a scenario. `path` appears in errors and resolves relative
    /// file names; the file does not have to exist. Unlike [`Scenario::load`], this accepts events
    /// after the end, since the text may belong to a run that was shortened.
    ///
    /// # Errors
    /// See [`Scenario::load`].
    pub fn parse(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, ScenarioError> {
        Self::read(Source::new(path, text)?, overrides)
    }

    /// Like [`Scenario::parse`], for parsed fields.
    ///
    /// # Errors
    /// See [`Scenario::load`].
    pub fn read(source: Source<'_>, overrides: &Overrides) -> Result<Self, ScenarioError> {
        Self::build(source, overrides, u32::MAX)
    }

    /// Refuses events that are later than `ticks`, than the text's ticks, and than the override's.
    fn build(mut source: Source<'_>, overrides: &Overrides, ticks: u32) -> Result<Self, ScenarioError> {
        let parameters = source.json();
        plane::inherit(source.root_mut());
        let mut file: ScenarioFile = source.read(LIST)?;
        let ticks = ticks.max(file.ticks);
        file.seed = overrides.seed.unwrap_or(file.seed);
        file.ticks = overrides.ticks.unwrap_or(file.ticks);
        check::general(&source, &file)?;
        check::times(&source, &file, ticks.max(file.ticks))?;
        check::radio(&source, &file)?;
        check::moves(&source, &file)?;
        let (terrain, robots, formations, parts, plane) = match &file.plane {
            None => {
                let terrain = check::terrain(&source, &file)?;
                let (robots, formations) = robots::build(&source, &file, &terrain)?;
                let parts = formations.iter().enumerate().filter(|_| formations.len() > 1);
                let parts = parts.map(|(index, formation)| Part {
                    table: format!("robots.formation[{index}]"),
                    members: formation.members(),
                });
                let parts = parts.collect();
                (terrain, robots, formations, parts, None)
            }
            Some(table) => {
                let land = match &file.terrain {
                    Some(_) => Some(check::terrain(&source, &file)?),
                    None => None,
                };
                let cells = match (&file.robots, &land) {
                    (Some(_), Some(land)) => Some(robots::build(&source, &file, land)?),
                    (Some(_), None) => {
                        let remedy = "give [terrain], or plane.robots in metres";
                        return Err(source.error("robots", "there are no cells", remedy));
                    }
                    (None, _) => None,
                };
                let plane::Placed { setup, robots, formations, parts } =
                    plane::build(&source, &file, table, land.as_ref(), cells)?;
                let land = land.unwrap_or_else(|| Terrain::flat(1, 1));
                (land, robots, formations, parts, Some(setup))
            }
        };
        let heard = plane.as_ref().map_or(0, PlaneSetup::heard);
        check::numbers(&source, &file, &robots, heard)?;
        let positions_m: Vec<[f64; 2]> = match &plane {
            Some(setup) => setup.starts.iter().map(|start| [start.position_m[0], start.position_m[1]]).collect(),
            None => robots.iter().map(|robot| terrain.center_m(robot.start)).collect(),
        };
        check::memory(&source, &file, &positions_m, &terrain)?;
        let keys = authentication::key(&source, &file, &robots)?;
        let attacks = authentication::attacks(&source, &file, &robots)?;
        let faults = check::faults(&source, &file, &robots)?;
        let interventions = intervention::interventions(&source, &file, &robots)?;
        let changes = land::changes(&source, &file, &terrain)?;
        let misnumbered = check::misnumbered(&source, &file, &robots)?;
        check::formation_only(&source, &file)?;
        let route = params::routing(&source, &file)?;
        let land = Some(&terrain).filter(|_| file.terrain.is_some());
        let scouting = scouting::scouting(&source, &file, land, params::sight(&file))?;
        let sensing = match file.plane.as_ref().zip(plane.as_ref()) {
            Some((table, setup)) => plane::sensing(&source, &file, table, setup)?,
            None => None,
        };
        let maps = maps::sharing(&source, &file, &route, plane.as_ref())?;
        let formation_law = FormationSetup::new(&source, &file.formation)?;
        let law = law::law(&source, &file, plane.as_ref(), land)?;
        let mut scenario = Self {
            name: file.name.clone(),
            seed: file.seed,
            ticks: file.ticks,
            tick_us: ranges::micros(file.tick_s),
            terrain,
            changes,
            scouting,
            rules: MoveRules {
                norm: file.grid.norm,
                corner_cutting: file.grid.corner_cutting,
                crossing: matches!(formation_law, FormationSetup::Published(_)),
                orthogonal: file.grid.moves == 4,
                simultaneous: file.grid.simultaneous,
            },
            radio: file.radio.clone(),
            robots,
            formations,
            parts,
            plane,
            sensing,
            law,
            route,
            maps,
            formation_law,
            faults,
            interventions,
            misnumbered,
            keys,
            plausibility: PlausibilityLimits::ANY,
            attacks,
            files: source.files(),
            parameters: with_overrides(parameters, &file),
        };
        scenario.plausibility = plausibility::said(&source, &file, &scenario.robots, scenario.usual_claims())?;
        Ok(scenario)
    }

    /// Warnings, one line each: key file, unstable gains, probable mistakes in `[plane]`.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let groups = self.plane.iter().flat_map(PlaneSetup::kinds);
        let gains = groups.filter_map(|group| match &group.guidance {
            GuidanceSetup::Lattice { params, .. } => plane::remark(params, &self.radio, self.tick_s()),
            _ => None,
        });
        let plane = self.plane.iter().flat_map(|setup| plane::remarks(setup, self.tick_s()));
        self.keys.iter().filter_map(|keys| keys.remark.clone()).chain(gains).chain(plane).collect()
    }

    /// The key that all robots share, or the operator's first one.
    #[must_use]
    pub fn key(&self) -> Option<&Key> {
        self.keys.as_ref().map(|keys| &keys.key)
    }

    /// The operator's keys, if each robot has its own key.
    #[must_use]
    pub fn key_rotation(&self) -> Option<&KeyRotation> {
        self.keys.as_ref()?.rotation.as_ref()
    }

    /// The robots with the ids that they claim ([`misnumbered`](Self::misnumbered)).
    #[must_use]
    pub fn numbered(&self) -> Vec<Robot> {
        let number =
            |id: RobotId| self.misnumbered.iter().find(|(robot, _)| *robot == id).map_or(id, |(_, said)| *said);
        let robots = self.robots.iter();
        robots.map(|robot| Robot { id: number(robot.id), ..*robot }).collect()
    }

    /// Length of a tick, seconds.
    #[must_use]
    pub fn tick_s(&self) -> f64 {
        f64::from(self.tick_us) / 1e6
    }
}

/// The fields of the file with overrides applied, without secrets.
fn with_overrides(mut fields: serde_json::Value, file: &ScenarioFile) -> serde_json::Value {
    if let Some(fields) = fields.as_object_mut() {
        fields.insert("seed".into(), file.seed.into());
        fields.insert("ticks".into(), file.ticks.into());
        if let Some(table) = fields.get_mut("authentication").and_then(serde_json::Value::as_object_mut) {
            for secret in ["key", "master"] {
                if let Some(said) = table.get_mut(secret) {
                    *said = "(left out)".into();
                }
            }
        }
    }
    fields
}

#[cfg(test)]
mod tests;
