//! Checks that involve more than one field.

use super::intervention::tick;
use super::params::{FormationLaw, GridTable};
use super::ranges::{micros, short};
use super::source::Source;
use super::{Crop, Fault, Robot, ScenarioError, ScenarioFile, TerrainTable, UniformTable};
use crate::file::has_memory;
use crate::radio;
use crate::terrain::generate::{self, LandPlan};
use crate::terrain::{Terrain, TerrainError};
use staya_controller::robot::RobotId;
use staya_controller::route::Replan;
use staya_mavlink::any::max_robot;
use std::path::Path;

pub(super) fn general(source: &Source<'_>, file: &ScenarioFile) -> Result<(), ScenarioError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if file.name.is_empty() || file.name.len() > 100 || !file.name.chars().all(allowed) {
        let remedy = "use 1 to 100 letters, digits, - and _";
        return Err(source.error("name", format!("{:?} cannot name a folder of results", file.name), remedy));
    }
    if file.ticks == 0 {
        return Err(source.error("ticks", "a run needs at least one tick", "give 1 or more"));
    }
    Ok(())
}

/// Refuses events after the last of `ticks`.
pub(super) fn times(source: &Source<'_>, file: &ScenarioFile, ticks: u32) -> Result<(), ScenarioError> {
    let orders = file.plane.iter().flat_map(|plane| &plane.order);
    let changes = file.terrain.iter().flat_map(|terrain| &terrain.change);
    let rolls = file.authentication.iter().flat_map(|table| &table.roll);
    let lists: [(_, _, Vec<f64>); 6] = [
        ("fault", "at_s", file.fault.iter().map(|fault| fault.at_s).collect()),
        ("intervention", "at_s", file.intervention.iter().map(|table| table.at_s).collect()),
        ("attack", "from_s", file.attack.iter().map(|attack| attack.from_s).collect()),
        ("plane.order", "at_s", orders.map(|order| order.at_s).collect()),
        ("terrain.change", "at_s", changes.map(|change| change.at_s).collect()),
        ("authentication.roll", "at_s", rolls.map(|roll| roll.at_s).collect()),
    ];
    for (list, name, times_s) in lists {
        if let Some(index) = times_s.iter().position(|&at_s| tick(at_s, file.tick_s) > ticks) {
            let end_s = f64::from(ticks) * file.tick_s;
            let what = format!("{} s is after the end of the run at {} s", short(times_s[index]), short(end_s));
            let remedy = "give an earlier time or more ticks, or leave it out";
            return Err(source.error(&format!("{list}[{index}].{name}"), what, remedy));
        }
    }
    Ok(())
}

pub(super) fn numbers(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
    intruders: usize,
) -> Result<(), ScenarioError> {
    let (format, most) = (file.radio.format, max_robot(file.radio.format, false));
    let last = robots.last().map_or(0, |robot| robot.id.0);
    let ids = robots.iter().map(|robot| robot.id.0).chain((last + 1..).take(intruders));
    match ids.into_iter().find(|&id| id > most.0) {
        None => Ok(()),
        Some(id) => Err(source.error(
            "radio.format",
            format!("robot {id} has no number in {}: systems are 1 to {}", format.name(), most.0),
            "give fewer robots or smaller numbers, or format = \"postcard\"",
        )),
    }
}

pub(super) fn radio(source: &Source<'_>, file: &ScenarioFile) -> Result<(), ScenarioError> {
    let radio = &file.radio;
    if radio.range_m.is_nan() || radio.range_m < 0.0 {
        let remedy = "give metres, 0 or more, or inf";
        return Err(source.error("radio.range_m", format!("{} is not a distance", short(radio.range_m)), remedy));
    }
    if let Some(burst) = &radio.burst {
        let least_ms = file.tick_s * 1000.0 / (1.0 - burst.share);
        if !(burst.mean_ms >= least_ms && burst.mean_ms <= 600_000.0) {
            let what = format!("{} is out of range", short(burst.mean_ms));
            let remedy = format!("with this tick and share, give {least_ms:.1} to 600000 milliseconds");
            return Err(source.error("radio.burst.mean_ms", what, remedy));
        }
    }
    for (index, [from, to]) in radio.blackout_s.iter().enumerate() {
        if !(*from >= 0.0 && from < to && to.is_finite()) {
            let what = format!("[{}, {}] is not a time span", short(*from), short(*to));
            let remedy = "give [from, to] in seconds after the start with 0 <= from < to";
            return Err(source.error(&format!("radio.blackout_s[{index}]"), what, remedy));
        }
    }
    Ok(())
}

pub(super) fn moves(source: &Source<'_>, file: &ScenarioFile) -> Result<(), ScenarioError> {
    let GridTable { moves, simultaneous, .. } = file.grid;
    let (field, what, remedy) = match moves {
        4 if file.plane.is_some() => ("moves", "robots in the plane do not move from cell to cell", "leave it out"),
        4 if file.law.is_none() => {
            ("moves", "routes and formations use eight neighbours", "give law.name = \"negotiation\", or leave it out")
        }
        8 if simultaneous => {
            ("simultaneous", "diagonal moves at once would cross each other", "give moves = 4, or leave it out")
        }
        4 | 8 => return Ok(()),
        _ => ("moves", "a cell has 4 or 8 neighbours", "give 4 or 8"),
    };
    Err(source.error(&format!("grid.{field}"), what, remedy))
}

/// Measured lower bound of the memory per robot in bytes: agent, neighbours and packets.
const ROBOT_BYTES: u64 = 4 << 10;
const CELL_BYTES: u64 = 4;

/// Refuses scenarios that do not fit into memory, before the system kills the process.
pub(super) fn memory(
    source: &Source<'_>,
    file: &ScenarioFile,
    positions_m: &[[f64; 2]],
    land: &Terrain,
) -> Result<(), ScenarioError> {
    let (robots, cells) = (positions_m.len(), u64::from(land.width()) * u64::from(land.height()));
    let bytes = robots as u64 * ROBOT_BYTES + cells * CELL_BYTES;
    let packets = radio::expected_bytes(&file.radio, micros(file.tick_s), positions_m);
    let whole = bytes.saturating_add(packets);
    if has_memory(whole) {
        return Ok(());
    }
    let (field, what, remedy) = if packets > bytes {
        let what = format!("the packets of {robots} robots need {} MB of memory", packets >> 20);
        ("radio", what, "give fewer robots, or a smaller range or delay")
    } else {
        let what = format!("{robots} robots and {cells} cells need {} MB of memory", bytes >> 20);
        (if file.plane.is_some() { "plane" } else { "robots" }, what, "give fewer robots or less land")
    };
    Err(source.error(field, format!("{what}, which is not to be had"), format!("{remedy}, or close other programs")))
}

pub(super) fn terrain(source: &Source<'_>, file: &ScenarioFile) -> Result<Terrain, ScenarioError> {
    let Some(table) = &file.terrain else {
        return Err(source.error("terrain", "it is missing", "say what land is meant"));
    };
    let has_map = table.file.is_some() || file.scouting.as_ref().is_some_and(|scouting| scouting.map.is_some());
    if !has_map && source.has("terrain.load") {
        let remedy = "give terrain.file, or leave it out";
        return Err(source.error("terrain.load", "only map files are converted", remedy));
    }
    let plan = |size: UniformTable| {
        let UniformTable { width, height, classes, seed } = size;
        LandPlan { width, height, classes, seed: seed.unwrap_or(file.seed) }
    };
    let (field, made) = match (&table.file, table.uniform, table.natural, table.entropy) {
        (Some(name), None, None, None) => ("terrain.file", load(source, table, name)),
        (None, Some(size), None, None) => ("terrain.uniform", generate::uniform(&plan(size))),
        (None, None, Some(t), None) => {
            let plan = plan(t.size);
            let made = generate::natural_by(&plan, t.obstacles, t.norm, t.hills);
            let order = |land| if t.shuffled { generate::shuffled(&land, plan.seed) } else { Ok(land) };
            ("terrain.natural", made.and_then(order))
        }
        (None, None, None, Some(t)) => {
            let wanted = generate::ByMetrics {
                entropy: t.entropy,
                entropy_tolerance: t.entropy_tolerance,
                total_edge: t.total_edge,
                edge_tolerance: t.edge_tolerance,
            };
            ("terrain.entropy", generate::by_metrics(&plan(t.size), &wanted))
        }
        _ => {
            let remedy = "give exactly one of file, uniform, natural, entropy";
            return Err(source.error("terrain", "it is not clear what land is meant", remedy));
        }
    };
    let made = made.map_err(|error| terrain_error(source, field, &error))?;
    let mut terrain = cropped(source, table, made)?;
    if let Some(cell_m) = table.cell_m {
        terrain.cell_m = cell_m;
    }
    Ok(terrain)
}

/// Loads another map of the same land, with the load options and the crop of `[terrain]`.
pub(super) fn map(source: &Source<'_>, file: &ScenarioFile, name: &Path) -> Result<Terrain, ScenarioError> {
    let usual = TerrainTable::default();
    let table = file.terrain.as_ref().unwrap_or(&usual);
    let made = load(source, table, name).map_err(|error| terrain_error(source, "scouting.map", &error))?;
    cropped(source, table, made)
}

fn load(source: &Source<'_>, table: &TerrainTable, name: &Path) -> Result<Terrain, TerrainError> {
    let path = source.file(name);
    let terrain = Terrain::load_with(&path, &table.load)?;
    source.reads(Terrain::picture(&path));
    Ok(terrain)
}

fn cropped(source: &Source<'_>, table: &TerrainTable, made: Terrain) -> Result<Terrain, ScenarioError> {
    let Some(Crop { x, y, width, height }) = table.crop else {
        return Ok(made);
    };
    made.crop(x, y, width, height).map_err(|error| terrain_error(source, "terrain.crop", &error))
}

fn terrain_error(source: &Source<'_>, field: &str, error: &TerrainError) -> ScenarioError {
    let remedy = match error {
        TerrainError::Read { .. } => "file names are relative to the scenario file",
        _ => "see maps/README.md",
    };
    source.error(field, error.to_string(), remedy)
}

pub(super) fn formation_only(source: &Source<'_>, file: &ScenarioFile) -> Result<(), ScenarioError> {
    let in_formation = file.in_formation();
    if !in_formation && source.has("formation") {
        let remedy = "give robots.formation, or leave this table out";
        return Err(source.error("formation", "these robots keep no formation", remedy));
    }
    law_only(source, file)?;
    if in_formation && matches!(file.route.replan, Some(Replan::UntilChanged)) {
        let remedy = "give \"each_cell\", or leave it out";
        return Err(source.error("route.replan", "robots in formation search in each cell", remedy));
    }
    Ok(())
}

fn law_only(source: &Source<'_>, file: &ScenarioFile) -> Result<(), ScenarioError> {
    let law = file.formation.law.unwrap_or_default();
    let is_paper = law == FormationLaw::Paper;
    if law != FormationLaw::Staya && file.plane.is_some() {
        let (what, remedy) =
            (format!("the law \"{law}\" goes from cell to cell"), "give \"staya\", or leave [plane] out");
        return Err(source.error("formation.law", what, remedy));
    }
    let foreign: &[&str] =
        if is_paper { &["waits", "lead", "closes_ranks", "footprint", "recovery"] } else { &["crowd"] };
    for name in foreign {
        let field = format!("formation.{name}");
        if source.has(&field) {
            return Err(source.error(&field, format!("the law \"{law}\" has no use for it"), "leave it out"));
        }
    }
    if file.formation.waits == Some(false) {
        if file.plane.is_some() {
            let what = "robots in the plane do not wait; the slowest sets the pace";
            return Err(source.error("formation.waits", what, "leave it out"));
        }
        for name in ["formation.halt_cells", "formation.resume_cells"] {
            if source.has(name) {
                return Err(source.error(name, "with waits = false no robot waits", "leave out one of the two"));
            }
        }
    }
    Ok(())
}

pub(super) fn misnumbered(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
) -> Result<Vec<(RobotId, RobotId)>, ScenarioError> {
    let most = max_robot(file.radio.format, source.has("authentication"));
    let mut known = Vec::with_capacity(file.misnumbered.len());
    for (index, entry) in file.misnumbered.iter().enumerate() {
        let (robot, number) = (RobotId(entry.robot), RobotId(entry.number));
        let (field, what, remedy) = if robots.binary_search_by_key(&robot, |r| r.id).is_err() {
            let what = format!("there is no robot {robot}");
            ("robot", what, "give the number of a robot of this scenario".to_owned())
        } else if known.iter().any(|(listed, _)| *listed == robot) {
            ("robot", format!("robot {robot} has been given a number before"), "give each robot one".to_owned())
        } else if robot == number {
            ("number", format!("robot {robot} has this number anyway"), "give that of another robot".to_owned())
        } else if !(RobotId(1)..=most).contains(&number) {
            let what = format!("{} is not a valid robot number", entry.number);
            ("number", what, format!("give 1 to {}", most.0))
        } else {
            known.push((robot, number));
            continue;
        };
        return Err(source.error(&format!("misnumbered[{index}].{field}"), what, remedy));
    }
    Ok(known)
}

pub(super) fn faults(source: &Source<'_>, file: &ScenarioFile, robots: &[Robot]) -> Result<Vec<Fault>, ScenarioError> {
    let mut faults = Vec::with_capacity(file.fault.len());
    for (index, fault) in file.fault.iter().enumerate() {
        let robot = RobotId(fault.robot);
        if robots.binary_search_by_key(&robot, |r| r.id).is_err() {
            let what = format!("there is no robot {}", fault.robot);
            let remedy = "give the number of a robot of this scenario";
            return Err(source.error(&format!("fault[{index}].robot"), what, remedy));
        }
        let tick = |seconds: f64| libm::ceil(seconds / file.tick_s) as u32;
        faults.push(Fault { robot, from_tick: tick(fault.at_s), to_tick: tick(fault.at_s + fault.down_s) });
    }
    Ok(faults)
}
