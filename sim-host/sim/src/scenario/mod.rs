//! Scenarios: what to simulate, read from TOML and checked before anything runs.
//!
//! [`ScenarioFile`] documents every field. A wrong one gives an error that names the file, the line,
//! the field and the remedy.

mod authentication;
mod check;
mod claims;
mod de;
mod field;
mod fingerprint;
mod formation;
mod intervention;
mod land;
mod maps;
mod params;
mod plane;
mod ranges;
mod robots;
mod schema;
mod scouting;
mod setting;
mod setup;
mod source;

pub use claims::ClaimsTable;
pub use field::Field;
pub use formation::FormationEntry;
pub use intervention::{Intervention, InterventionTable, with_interventions};
pub use maps::MapsTable;
pub use params::{FormationTable, GridTable, RouteTable};
pub(crate) use plane::goals;
pub use plane::{
    BallEntry, BallsEntry, BoidsTable, CircleEntry, CloudEntry, EyesTable, GoalFlockTable, GroupTable, HalfSpaceEntry,
    Intruder, IntruderEntry, LatticeTable, OrcaTable, Order, OrderEntry, Place, PlaneRobotEntry, PlaneRobots,
    PlaneSetup, PlaneTable, PushOutTable, RobotGroup, ScatteredDiscs, Start, Target, WallEntry, circle_starts,
};
pub use ranges::within;
pub use robots::{Formation, Robot, RobotEntry, RobotsTable, ScatteredEntry, ScenEntry};
pub use schema::{
    AttackKind, AttackTable, AuthenticationTable, ChangeTable, Crop, DriftTable, EntropyTable, FaultTable, Lie,
    MisnumberedTable, NaturalTable, RollTable, ScenarioFile, ScoutingTable, TerrainTable, UniformTable,
};
pub use setting::{Setting, text_with, with_settings};
pub use source::ScenarioError;
pub use source::Source;

use crate::file::{TEXT, read_text};
use crate::radio::RadioParams;
use crate::terrain::Terrain;
use crate::terrain::change::LandChange;
use crate::world::MoveRules;
pub use crate::world::plane::Eyes;
pub use crate::world::scouts::Scouting;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{GuidanceSetup, RouteSetup};
use staya_controller::auth::Key;
use staya_controller::formation::FormationParams;
use staya_controller::formation::published::PublishedParams;
use staya_controller::land::MapParams;
use staya_controller::neighbor::Claims;
use staya_controller::robot::RobotId;
use std::ops::Range;
use std::path::Path;

/// Where the fields are listed.
const LIST: &str = "scenarios/README.md";

/// What the command line may say instead of the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Instead of `seed`.
    pub seed: Option<u64>,
    /// Instead of `ticks`; at least 1.
    pub ticks: Option<u32>,
}

/// Robots that stand in one place of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The table that describes them: `plane`, `plane.group[0]`, `robots.formation[1]`.
    pub table: String,
    /// The robots, counted from 0.
    pub members: Range<usize>,
}

/// A robot that goes down for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Which one.
    pub robot: RobotId,
    /// The first tick in which it stands and is silent.
    pub from_tick: u32,
    /// The tick in which it starts anew; not before `from_tick`.
    pub to_tick: u32,
}

/// Somebody who wants the robots to go elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Attack {
    /// What it does.
    pub kind: AttackKind,
    /// Where it stands, metres.
    pub place_m: [f64; 2],
    /// The first tick in which it sends.
    pub from_tick: u32,
    /// The first tick in which it does not any more.
    pub to_tick: u32,
    /// Where it orders the robots to, metres.
    pub lure_m: [f64; 2],
    /// In whose name.
    pub claims: RobotId,
    /// Ticks from what it hears to its repetition.
    pub delay_ticks: u32,
    /// What an insider says.
    pub lies: Vec<Lie>,
    /// How many robots of an insider's do not exist.
    pub ghosts: u8,
}

/// Who has what all keys are made of, and what he does with it.
#[derive(Clone, Debug)]
pub struct Keeping {
    /// His secret.
    pub master: Key,
    /// Where his radio stands, metres.
    pub place_m: [f64; 2],
    /// Ticks for which he waits at most, in each phase of a roll.
    pub overlap_ticks: u32,
    /// By rising tick.
    pub rolls: Vec<Roll>,
}

/// The swarm gets another key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Roll {
    /// When it begins.
    pub tick: u32,
    /// Who does not get it, nor any later one.
    pub revoke: Vec<RobotId>,
}

/// A checked scenario, ready to run.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Ticks after which the run ends.
    pub ticks: u32,
    /// Length of a tick, microseconds.
    pub tick_us: u32,
    /// The land; one flat cell when bodies in the plane have none.
    pub terrain: Terrain,
    /// How it changes while the run goes on.
    pub changes: Vec<LandChange>,
    /// What robots know of it before they see it; `None`: nothing, and they remember no more than their laws do.
    pub scouting: Option<Scouting>,
    /// How bodies move.
    pub rules: MoveRules,
    /// The radio.
    pub radio: RadioParams,
    /// Who takes part, by rising number; starts are free and no two are the same, nor are goals.
    pub robots: Vec<Robot>,
    /// The formations that robots keep; nobody is in two.
    pub formations: Vec<Formation>,
    /// Groups of robots that differ, as the file has them; empty: all are alike.
    pub parts: Vec<Part>,
    /// Bodies in the plane or in space, if they do not move from cell to cell.
    pub plane: Option<PlaneSetup>,
    /// How robots in the plane see each other, if they do.
    pub eyes: Option<Eyes>,
    /// How robots find their ways.
    pub route: RouteSetup,
    /// How robots share what they see of the land, if they do.
    pub maps: Option<MapParams>,
    /// How robots keep a formation, if they do.
    pub formation_params: FormationParams,
    /// How they do instead, if they do as the paper has it: cell by cell only.
    pub published: Option<PublishedParams>,
    /// Whether those who follow look ahead ([`Course`](staya_controller::formation::Course)): cell by cell only.
    pub looks_ahead: bool,
    /// Robots that go down.
    pub faults: Vec<Fault>,
    /// What somebody does to the run, by rising tick.
    pub interventions: Vec<(u32, Intervention)>,
    /// Robots by their numbers here, each with the number that it says.
    pub misnumbered: Vec<(RobotId, RobotId)>,
    /// What all robots share; `None`: they believe everybody.
    pub key: Option<Key>,
    /// The operator, if each robot has a key of its own.
    pub keeping: Option<Keeping>,
    /// What the owner of the key's file should know, as a line for people.
    pub key_remark: Option<String>,
    /// What robots may say of themselves and be believed.
    pub claims: Claims<f32>,
    /// Those who want something else.
    pub attacks: Vec<Attack>,
    /// What its file says, with what the command line says instead, for results; secrets are left out.
    pub parameters: serde_json::Value,
}

impl Scenario {
    /// Reads and checks a scenario file and the files that it names.
    ///
    /// # Errors
    /// [`ScenarioError`], naming file, line, field and remedy.
    pub fn load(path: &Path, overrides: &Overrides) -> Result<Self, ScenarioError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        Self::parse(&text, path, overrides)
    }

    /// As [`Scenario::load`], of a text that stands (or might stand) in the file `path`.
    ///
    /// # Errors
    /// See [`Scenario::load`].
    pub fn parse(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, ScenarioError> {
        let source = Source::new(path, text)?;
        let mut file: ScenarioFile = source.read(LIST)?;
        file.seed = overrides.seed.unwrap_or(file.seed);
        file.ticks = overrides.ticks.unwrap_or(file.ticks);
        check::general(&source, &file)?;
        check::radio(&source, &file)?;
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
        check::memory(&source, &file, robots.len(), &terrain)?;
        let keys = authentication::key(&source, &file, &robots)?;
        let (key, key_remark, keeping) =
            keys.map_or((None, None, None), |keys| (Some(keys.key), keys.remark, keys.keeping));
        let attacks = authentication::attacks(&source, &file, &robots)?;
        let faults = check::faults(&source, &file, &robots)?;
        let interventions = intervention::interventions(&source, &file, &robots)?;
        let changes = land::changes(&source, &file, &terrain)?;
        let misnumbered = check::misnumbered(&source, &file, &robots)?;
        check::formation_only(&source, &file)?;
        let route = params::routing(&source, &file)?;
        let land = Some(&terrain).filter(|_| file.terrain.is_some());
        let scouting = scouting::scouting(&source, &file, land, params::sight(&file))?;
        let eyes = match file.plane.as_ref().zip(plane.as_ref()) {
            Some((table, setup)) => plane::eyes(&source, &file, table, setup)?,
            None => None,
        };
        let maps = maps::sharing(&source, &file, &route, plane.as_ref())?;
        let formation_params = params::formation(&source, &file.formation)?;
        let published = params::published(&source, &file.formation)?;
        let looks_ahead = params::looks_ahead(&file.formation);
        let mut scenario = Self {
            name: file.name.clone(),
            seed: file.seed,
            ticks: file.ticks,
            tick_us: ranges::micros(file.tick_s),
            terrain,
            changes,
            scouting,
            rules: MoveRules { norm: file.grid.norm, corner_cutting: file.grid.corner_cutting },
            radio: file.radio.clone(),
            robots,
            formations,
            parts,
            plane,
            eyes,
            route,
            maps,
            formation_params,
            published,
            looks_ahead,
            faults,
            interventions,
            misnumbered,
            key,
            key_remark,
            keeping,
            claims: Claims::ANY,
            attacks,
            parameters: parameters(&source, &file),
        };
        scenario.claims = claims::said(&source, &file, &scenario.robots, scenario.usual_claims())?;
        Ok(scenario)
    }

    /// What who runs it should know: lines for people, about the key's file, gains that are dangerous, and what is hardly meant in `[plane]`.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let groups = self.plane.iter().flat_map(PlaneSetup::kinds);
        let gains = groups.filter_map(|group| match &group.guidance {
            GuidanceSetup::Lattice { params, .. } => plane::remark(params, &self.radio, self.tick_s()),
            _ => None,
        });
        let plane = self.plane.iter().flat_map(|setup| plane::remarks(setup, self.tick_s()));
        self.key_remark.clone().into_iter().chain(gains).chain(plane).collect()
    }

    /// The robots, each with the number that it says.
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

/// The fields of a scenario's text, which is sound, with the seed and the ticks that are in force.
fn parameters(source: &Source<'_>, file: &ScenarioFile) -> serde_json::Value {
    let mut fields: serde_json::Value = source.read(LIST).unwrap_or_default();
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
