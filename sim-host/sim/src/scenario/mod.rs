//! Scenarios: simulation inputs, read from TOML and checked before a run starts.
//!
//! [`ScenarioFile`] documents every field. Errors name file, line, field and remedy.

mod authentication;
mod check;
mod clocks;
mod field;
mod fingerprint;
mod formation;
mod grid;
mod intervention;
mod land;
mod law;
mod layer;
mod maps;
mod parameters;
mod plane;
mod plausibility;
mod ranges;
mod read;
mod renamed;
mod robots;
mod rows;
mod schema;
mod scouting;
mod setting;
mod setup;
mod source;
mod table;
mod write;

pub use authentication::Keys;
pub use clocks::{Clocks, ClocksTable, Phases};
pub use field::Field;
pub use formation::{FormationEntry, FormationStarts};
pub use grid::GridTable;
pub use intervention::{Intervention, InterventionTable, with_interventions};
pub use law::{AddedLaw, LawPart, LawSetup, laws};
pub use layer::{LayerPart, OrcaTable};
pub use maps::MapsTable;
pub use parameters::parameters;
pub use plane::{
    BallEntry, BallsEntry, CircleEntry, CloudEntry, GroupTable, HalfSpaceEntry, Intruder, IntruderEntry, Order,
    OrderEntry, Place, PlaneRobotEntry, PlaneRobots, PlaneSetup, PlaneTable, RobotGroup, RobotsSource, ScatteredDiscs,
    SensingTable, Start, Target, WallEntry,
};
pub use plausibility::PlausibilityTable;
pub use read::{AnyTable, Field as Read, Limits, Line, Node, Table, Usual, Wrong, documented, nearest, word};
pub use renamed::{formation_law, value as renamed_value};
pub use robots::{Formation, Robot, RobotEntry, RobotsTable, ScatteredEntry, ScenEntry};
pub use rows::{Tables, lines_of, store_given};
pub use schema::{
    Area, AttackKind, AttackTable, AuthenticationTable, ChangeSource, ChangeTable, Crop, DriftTable, EntropyTable,
    FaultTable, LandSource, Lie, MisnumberedTable, NaturalTable, RollTable, ScenarioFile, ScoutingTable, Secret,
    TerrainTable, UniformTable,
};
pub use scouting::KnownLand;
pub use setting::{Setting, named, text_with, with_settings};
use source::{Checked, Section};
pub use source::{Location, ScenarioError, Source};
pub use table::{Fields, OneOf, empty, plain};
pub use write::{fields, inline};

use crate::radio::RadioParams;
use crate::terrain::Terrain;
use crate::terrain::change::LandChange;
use crate::world::MoveRules;
pub use crate::world::plane::Sensing;
pub use crate::world::scouts::Scouting;
use serde::{Deserialize, Serialize};
use staya_controller::agent::RouteSettings;
use staya_controller::auth::Key;
use staya_controller::land::MapParams;
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::robot::RobotId;
use staya_controller::scalar::NumberFormat;
use std::collections::HashMap;
use std::ops::{Deref, Range};
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

/// A file that is being checked, with overrides applied.
#[derive(Debug)]
struct Draft<'a> {
    whole: Section<'a>,
    file: ScenarioFile,
}

impl Draft<'_> {
    /// See [`ranges::tick`].
    fn tick(&self, at_s: f64) -> u32 {
        ranges::tick(at_s, self.file.tick_s)
    }
}

impl<'a> Deref for Draft<'a> {
    type Target = Section<'a>;

    fn deref(&self) -> &Self::Target {
        &self.whole
    }
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
    /// The terrain, its changes, and what robots know of it.
    pub land: Land,
    /// When the robots decide.
    pub clocks: Clocks,
    /// Parameters of the radio.
    pub radio: RadioParams,
    /// Robots, sorted by id. Starts are free and distinct; goals are distinct.
    pub robots: Vec<Robot>,
    /// Formations; each robot is in at most one.
    pub formations: Vec<Formation>,
    /// How the bodies move.
    pub movement: Movement,
    /// The laws of the robots, as far as groups in the plane do not have their own.
    pub laws: Laws,
    /// Identities, and which packets the robots trust.
    pub trust: Trust,
    /// Events of the run, besides changes of the terrain, orders and key rotations.
    pub events: Events,
    /// Where the scenario comes from.
    pub origin: Origin,
}

/// The terrain of a scenario.
#[derive(Clone, Debug)]
pub struct Land {
    /// The terrain; one flat cell for a plane without terrain.
    pub terrain: Terrain,
    /// Changes of the terrain during the run.
    pub changes: Vec<LandChange>,
    /// Terrain that robots know before they see it; `None`: only what their laws remember.
    pub scouting: Option<Scouting>,
    /// The map that robots carry as tables; `None`: none.
    pub known: Option<KnownLand>,
}

/// How the bodies of a scenario move.
#[derive(Clone, Debug)]
pub enum Movement {
    /// From cell to cell.
    Cells(MoveRules),
    /// In the plane or in space.
    Plane(Box<PlaneSetup>),
}

/// Laws of the robots of a scenario.
#[derive(Clone, Debug)]
pub struct Laws {
    /// The law of robots that move from cell to cell; groups in the plane have their own.
    pub on_grid: LawSetup,
    /// Sight of robots over cells in each direction, cells.
    pub radius: u8,
    /// Routes of robots whose law does not say otherwise.
    pub usual_route: RouteSettings,
    /// Exchange of terrain maps; `None`: disabled.
    pub maps: Option<MapParams>,
    /// Number format of their arithmetic. An [`Engine`](crate::engine::Engine) computes in `f32`;
    /// robots in other formats are external to it.
    pub numbers: NumberFormat,
}

/// Identities of the robots, and which packets they trust.
#[derive(Clone, Debug)]
pub struct Trust {
    /// Robots with a wrong id: the id in this scenario, then the id that the robot claims.
    pub misnumbered: Vec<(RobotId, RobotId)>,
    /// Keys of the swarm; `None`: beacons are not authenticated.
    pub keys: Option<Keys>,
    /// Plausibility limits on received beacons.
    pub plausibility: PlausibilityLimits<f32>,
}

/// Events of a run.
#[derive(Clone, Debug)]
pub struct Events {
    /// Temporary failures of robots.
    pub faults: Vec<Fault>,
    /// Interventions with their ticks, sorted by tick.
    pub interventions: Vec<(u32, Intervention)>,
    /// Attackers.
    pub attacks: Vec<Attack>,
}

/// Files and fields from which a scenario was read; no influence on the run.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The files.
    pub files: Vec<PathBuf>,
    /// Fields of the file with overrides applied, for result files; without secrets.
    pub parameters: serde_json::Value,
    /// Groups of different robots, in the file's order; empty if all robots are alike.
    pub parts: Vec<Part>,
    /// Whether the file has fields of a study, which a run of the scenario does not use.
    pub has_study: bool,
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
    fn build(mut source: Source<'_>, overrides: &Overrides, ticks: u32) -> Checked<Self> {
        let parameters = source.json();
        renamed::refuse(&source)?;
        plane::inherit(source.root_mut());
        let mut file: ScenarioFile = source.read(LIST)?;
        let ticks = ticks.max(file.ticks);
        file.seed = overrides.seed.unwrap_or(file.seed);
        file.ticks = overrides.ticks.unwrap_or(file.ticks);
        let draft = &Draft { whole: source.whole(), file };
        let file = &draft.file;
        check::general(draft)?;
        check::times(draft, ticks.max(file.ticks))?;
        check::radio(draft)?;
        check::moves(draft)?;
        let mut clocks = clocks::clocks(draft)?;
        let land = check::terrain(draft)?;
        let (on_grid, radius) = (grid::law(draft)?, grid::radius(draft)?);
        let (Placed { robots, formations, parts }, movement) = match &file.plane {
            Some(table) => {
                let (placed, setup) = plane::build(draft, table, land.as_ref())?;
                (placed, Movement::Plane(Box::new(setup)))
            }
            None => {
                let rules = MoveRules {
                    norm: file.grid.norm,
                    corner_cutting: file.grid.corner_cutting,
                    crossing: matches!(on_grid, LawSetup::Published(_)),
                    orthogonal: file.grid.moves == 4,
                    simultaneous: file.grid.simultaneous,
                };
                (robots::in_cells(draft, land.as_ref())?, Movement::Cells(rules))
            }
        };
        let plane = movement.plane();
        clocks.has_own_phases = plane.is_some_and(PlaneSetup::has_phases);
        check::numbers(draft, &robots, plane.map_or(0, PlaneSetup::heard))?;
        check::radio_faults(draft, &robots)?;
        let kinds: Vec<&LawSetup> = match plane {
            Some(plane) => plane.kinds().map(|group| &group.law).collect(),
            None => vec![&on_grid],
        };
        let maps = maps::sharing(draft, &kinds)?;
        let law = plane.map_or(&on_grid, |plane| &plane.general.law);
        let (scouting, known) = scouting::scouting(draft, law, &kinds, robots.len(), land.as_ref())?;
        let laws = Laws { on_grid, radius, usual_route: grid::usual_route(draft)?, maps, numbers: file.numbers };
        let terrain = land.unwrap_or_else(|| Terrain::flat(1, 1));
        check::memory(draft, &robots, plane, &terrain)?;
        let mut scenario = Self {
            name: file.name.clone(),
            seed: file.seed,
            ticks: file.ticks,
            tick_us: ranges::micros(file.tick_s),
            clocks,
            land: Land { changes: land::changes(draft, &terrain)?, terrain, scouting, known },
            radio: file.radio.clone(),
            trust: Trust {
                misnumbered: check::misnumbered(draft, &robots)?,
                keys: authentication::key(draft, &robots)?,
                plausibility: PlausibilityLimits::ANY,
            },
            events: Events {
                faults: check::faults(draft, &robots)?,
                interventions: intervention::interventions(draft, &robots)?,
                attacks: authentication::attacks(draft, &robots)?,
            },
            robots,
            formations,
            movement,
            laws,
            origin: Origin {
                files: source.files(),
                parameters: with_overrides(parameters, file),
                parts,
                has_study: source.has("study"),
            },
        };
        scenario.trust.plausibility = plausibility::limits(draft, &scenario.robots, scenario.usual_claims())?;
        Ok(scenario)
    }

    /// Bodies in the plane or in space; `None`: robots move from cell to cell.
    #[must_use]
    pub fn plane(&self) -> Option<&PlaneSetup> {
        self.movement.plane()
    }

    /// See [`plane`](Self::plane).
    pub fn plane_mut(&mut self) -> Option<&mut PlaneSetup> {
        match &mut self.movement {
            Movement::Cells(_) => None,
            Movement::Plane(setup) => Some(setup),
        }
    }

    /// Sensing of other robots in the plane; `None`: disabled.
    #[must_use]
    pub fn sensing(&self) -> Option<Sensing> {
        self.plane()?.sensing
    }

    /// Warnings, one line each: key file, fields of a study, unstable gains, probable mistakes in
    /// `[plane]`.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let key = self.trust.keys.iter().filter_map(|keys| keys.remark.clone());
        let study = self.origin.has_study.then(|| {
            "[study] has no effect on this run; `staya experiment` uses it with the figure that names this file"
                .to_owned()
        });
        let known = scouting::remark(self);
        key.chain(study)
            .chain(known)
            .chain(self.plane().into_iter().flat_map(|setup| plane::remarks(self, setup)))
            .collect()
    }

    /// The number of faults of the robot that has most of them.
    pub(crate) fn most_restarts(&self) -> u32 {
        let mut restarts = HashMap::<RobotId, u32>::new();
        self.events.faults.iter().for_each(|fault| *restarts.entry(fault.robot).or_default() += 1);
        restarts.into_values().max().unwrap_or(0)
    }

    /// The key that all robots share, or the operator's first one.
    #[must_use]
    pub fn key(&self) -> Option<&Key> {
        self.trust.keys.as_ref().map(|keys| &keys.key)
    }

    /// The operator's keys, if each robot has its own key.
    #[must_use]
    pub fn key_rotation(&self) -> Option<&KeyRotation> {
        self.trust.keys.as_ref()?.rotation.as_ref()
    }

    /// The robots with the ids that they claim ([`Trust::misnumbered`]).
    #[must_use]
    pub fn numbered(&self) -> Vec<Robot> {
        let claims = &self.trust.misnumbered;
        let number = |id| claims.iter().find(|(robot, _)| *robot == id).map_or(id, |(_, claimed)| *claimed);
        self.robots.iter().map(|robot| Robot { id: number(robot.id), ..*robot }).collect()
    }

    /// Length of a tick, seconds.
    #[must_use]
    pub fn tick_s(&self) -> f64 {
        f64::from(self.tick_us) / 1e6
    }

    /// Time between two decisions of a robot, seconds.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        f64::from(self.clocks.step_us()) / 1e6
    }
}

impl Movement {
    const fn plane(&self) -> Option<&PlaneSetup> {
        match self {
            Self::Cells(_) => None,
            Self::Plane(setup) => Some(setup),
        }
    }
}

/// Robots with their formations, and the tables of the file that describe them.
struct Placed {
    robots: Vec<Robot>,
    formations: Vec<Formation>,
    parts: Vec<Part>,
}

/// The fields of the file with overrides applied, without secrets.
fn with_overrides(mut fields: serde_json::Value, file: &ScenarioFile) -> serde_json::Value {
    fields["seed"] = file.seed.into();
    fields["ticks"] = file.ticks.into();
    for secret in ["/authentication/key", "/authentication/master"] {
        if let Some(text) = fields.pointer_mut(secret) {
            *text = "(left out)".into();
        }
    }
    fields
}

#[cfg(test)]
mod tests;
