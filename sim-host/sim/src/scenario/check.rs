//! Checks that involve more than one field.

use super::ranges::{micros, short};
use super::source::Checked;
use super::{Crop, Draft, Fault, LandSource, PlaneSetup, Robot, ScenarioError, TerrainTable, UniformTable};
use crate::file::has_memory;
use crate::radio::{self, LAST_START};
use crate::terrain::generate::{self, LandPlan};
use crate::terrain::{Terrain, TerrainError};
use staya_controller::agent::{LawSettings, RELAYS};
use staya_controller::robot::RobotId;
use staya_controller::wire::Format;
use staya_mavlink::any::max_robot;
use std::collections::HashMap;
use std::path::Path;

pub(super) fn general(draft: &Draft<'_>) -> Checked {
    let name = &draft.file.name;
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_name = !name.is_empty() && name.len() <= 100 && name.chars().all(allowed);
    let what = format!("{name:?} cannot name a folder of results");
    draft.require(is_name, "name", what, "use 1 to 100 letters, digits, - and _")?;
    draft.require(draft.file.ticks > 0, "ticks", "a run needs at least one tick", "give 1 or more")
}

/// Refuses events after the last of `ticks`.
pub(super) fn times(draft: &Draft<'_>, ticks: u32) -> Checked {
    let file = &draft.file;
    let orders = file.plane.iter().flat_map(|plane| &plane.order);
    let changes = file.terrain.iter().flat_map(|terrain| &terrain.change);
    let rolls = file.authentication.iter().flat_map(|table| &table.roll);
    let lists: [(_, _, Vec<f64>); 7] = [
        ("fault", "at_s", file.fault.iter().map(|fault| fault.at_s).collect()),
        ("radio.fault", "at_s", file.radio.fault.iter().map(|fault| fault.at_s).collect()),
        ("intervention", "at_s", file.intervention.iter().map(|table| table.at_s).collect()),
        ("attack", "from_s", file.attack.iter().map(|attack| attack.from_s).collect()),
        ("plane.order", "at_s", orders.map(|order| order.at_s).collect()),
        ("terrain.change", "at_s", changes.map(|change| change.at_s).collect()),
        ("authentication.roll", "at_s", rolls.map(|roll| roll.at_s).collect()),
    ];
    for (list, name, times_s) in lists {
        if let Some(index) = times_s.iter().position(|&at_s| draft.tick(at_s) > ticks) {
            let end_s = f64::from(ticks) * file.tick_s;
            let what = format!("{} s is after the end of the run at {} s", short(times_s[index]), short(end_s));
            let remedy = "give an earlier time or more ticks, or leave it out";
            return Err(draft.error(&format!("{list}[{index}].{name}"), what, remedy));
        }
    }
    Ok(())
}

/// Beaconing intruders have the ids after those of the robots.
pub(super) fn numbers(draft: &Draft<'_>, robots: &[Robot], intruders: usize) -> Checked {
    let format = draft.file.radio.format;
    let most = max_robot(format, false).0;
    let last = robots.last().map_or(0, |robot| robot.id.0);
    let mut ids = robots.iter().map(|robot| robot.id.0).chain((last + 1..).take(intruders));
    let Some(id) = ids.find(|&id| id > most) else { return Ok(()) };
    let what = format!("robot {id} has no number in {}: systems are 1 to {most}", format.name());
    Err(draft.error("radio.format", what, "give fewer robots or smaller numbers, or format = \"postcard\""))
}

pub(super) fn radio(draft: &Draft<'_>) -> Checked {
    let radio = &draft.file.radio;
    if let Some(burst) = &radio.burst {
        let least_ms = draft.file.tick_s * 1000.0 / (1.0 - burst.share);
        let what = format!("{} is out of range", short(burst.mean_ms));
        let remedy = format!("with this tick and share, give {least_ms:.1} to 600000 milliseconds");
        draft.require((least_ms..=600_000.0).contains(&burst.mean_ms), "radio.burst.mean_ms", what, remedy)?;
    }
    for (index, [from, to]) in radio.blackout_s.iter().enumerate() {
        let what = format!("[{}, {}] is not a time span", short(*from), short(*to));
        let remedy = "give [from, to] in seconds after the start with 0 <= from < to";
        let is_span = *from >= 0.0 && from < to && to.is_finite();
        draft.require(is_span, &format!("radio.blackout_s[{index}]"), what, remedy)?;
    }
    draft.within("radio.relays", radio.relays.into(), 0.0..=RELAYS as f64, "packets")?;
    let is_of_use = radio.relays == 0 || draft.file.in_formation();
    let what = "no robots are in a formation, whose beacons could be relayed";
    draft.require(is_of_use, "radio.relays", what, "give [robots.formation], or leave it out")?;
    let overtaken_ms = if radio.reorder > 0.0 { radio.reorder_ms } else { 0.0 };
    let longest_ms = radio.delay_ms + radio.jitter_ms + overtaken_ms;
    let is_quick = draft.file.plane.is_some() || longest_ms < draft.file.tick_s * 1000.0;
    let what = format!("packets may take {} ms, longer than a tick, so old states would stay", short(longest_ms));
    draft.require(radio.relays == 0 || is_quick, "radio.relays", what, "give shorter delays, or leave it out")?;
    let has_land = draft.file.terrain.is_some() || draft.file.plane.is_none();
    let what = "there is no land that could stand in the way";
    draft.require(radio.shadow.is_none() || has_land, "radio.shadow", what, "give [terrain], or leave it out")
}

pub(super) fn radio_faults(draft: &Draft<'_>, robots: &[Robot]) -> Checked {
    for (index, fault) in draft.file.radio.fault.iter().enumerate() {
        let at = draft.at(format!("radio.fault[{index}]"));
        for (name, numbers) in [("from", &fault.from), ("to", &fault.to)] {
            let Some(numbers) = numbers else { continue };
            at.require(!numbers.is_empty(), name, "the list is empty", "give robots, or leave it out for all")?;
            for (place, &robot) in numbers.iter().enumerate() {
                known(draft, robots, &at.field(&format!("{name}[{place}]")), robot)?;
            }
        }
        if let (Some([from]), Some([to])) = (fault.from.as_deref(), fault.to.as_deref()) {
            at.require(from != to, "to", format!("robot {to} has no link to itself"), "give another robot")?;
        }
        let is_one_way = !fault.both_ways || fault.from.is_some() || fault.to.is_some();
        let what = "a fault of all radios has both directions anyway";
        at.require(is_one_way, "both_ways", what, "give `from` or `to`, or leave it out")?;
    }
    Ok(())
}

pub(super) fn moves(draft: &Draft<'_>) -> Checked {
    let (grid, has_plane) = (&draft.file.grid, draft.file.plane.is_some());
    let (is_four, field) = (grid.moves == 4, "grid.moves");
    draft.require(is_four || grid.moves == 8, field, "a cell has 4 or 8 neighbours", "give 4 or 8")?;
    let what = "robots in the plane do not move from cell to cell";
    draft.require(!(is_four && has_plane), field, what, "leave it out")?;
    let remedy = "give law = \"negotiation\", or leave it out";
    let name = grid.law.name.as_deref();
    let is_known = !is_four || name.is_some_and(|name| LawSettings::by_name(name).is_none());
    draft.require(is_known, field, "routes and formations use eight neighbours", remedy)?;
    let (what, remedy) = ("diagonal moves at once would cross each other", "give moves = 4, or leave it out");
    draft.require(is_four || !grid.simultaneous, "grid.simultaneous", what, remedy)
}

/// Measured lower bound of the memory per robot in bytes: agent, neighbours and packets.
const ROBOT_BYTES: u64 = 4 << 10;
const CELL_BYTES: u64 = 4;

/// Refuses scenarios that do not fit into memory, before the system kills the process.
pub(super) fn memory(draft: &Draft<'_>, robots: &[Robot], plane: Option<&PlaneSetup>, land: &Terrain) -> Checked {
    let positions_m: Vec<[f64; 3]> = match plane {
        Some(setup) => setup.starts.iter().map(|start| start.position_m).collect(),
        None => robots.iter().map(|robot| land.center_m(robot.start)).map(|[x, y]| [x, y, 0.0]).collect(),
    };
    let (robots, cells) = (positions_m.len(), u64::from(land.width()) * u64::from(land.height()));
    let table = draft.file.scouting.as_ref().and_then(|scouting| scouting.model_bytes).unwrap_or(0);
    let bytes = robots as u64 * (ROBOT_BYTES + u64::from(table)) + cells * CELL_BYTES;
    let per_tick = 1.0 / f64::from(draft.step_ticks().max(1));
    let packets = radio::expected_bytes(&draft.file.radio, micros(draft.file.tick_s), per_tick, &positions_m);
    if has_memory(bytes.saturating_add(packets)) {
        return Ok(());
    }
    let (field, what, remedy) = if packets > bytes {
        let what = format!("the packets of {robots} robots need {} MB of memory", packets >> 20);
        ("radio", what, "give fewer robots, or a smaller range or delay")
    } else {
        let what = format!("{robots} robots and {cells} cells need {} MB of memory", bytes >> 20);
        (if plane.is_some() { "plane" } else { "robots" }, what, "give fewer robots or less land")
    };
    Err(draft.error(field, format!("{what}, which is not to be had"), format!("{remedy}, or close other programs")))
}

/// The terrain, if the file describes it.
pub(super) fn terrain(draft: &Draft<'_>) -> Checked<Option<Terrain>> {
    let Some(table) = &draft.file.terrain else { return Ok(None) };
    let plan = |size: &UniformTable| {
        let UniformTable { width, height, classes, seed } = *size;
        LandPlan { width, height, classes, seed: seed.unwrap_or(draft.file.seed) }
    };
    let (name, made) = match &table.land {
        LandSource::File(name) => ("file", load(draft, table, name)),
        LandSource::Uniform(size) => ("uniform", generate::uniform(&plan(size))),
        LandSource::Natural(natural) => {
            let plan = plan(&natural.size);
            let made = generate::natural_by(&plan, natural.obstacles, natural.norm, natural.hills);
            let order = |land| if natural.shuffled { generate::shuffled(&land, plan.seed) } else { Ok(land) };
            ("natural", made.and_then(order))
        }
        LandSource::Entropy(wanted) => {
            let plan = plan(&wanted.size);
            let wanted = generate::ByMetrics {
                entropy: wanted.entropy,
                entropy_tolerance: wanted.entropy_tolerance,
                total_edge: wanted.total_edge,
                edge_tolerance: wanted.edge_tolerance,
            };
            ("entropy", generate::by_metrics(&plan, &wanted))
        }
    };
    let has_map = name == "file" || draft.file.scouting.as_ref().is_some_and(|scouting| scouting.map.is_some());
    let is_used = has_map || !draft.has("terrain.load");
    draft.require(is_used, "terrain.load", "only map files are converted", "give terrain.file, or leave it out")?;
    let made = made.map_err(|error| terrain_error(draft, &format!("terrain.{name}"), &error))?;
    let mut terrain = cropped(draft, table, made)?;
    terrain.cell_m = table.cell_m.unwrap_or(terrain.cell_m);
    Ok(Some(terrain))
}

/// Loads another map of the same land, with the load options and the crop of `[terrain]`.
pub(super) fn map(draft: &Draft<'_>, table: &TerrainTable, name: &Path) -> Checked<Terrain> {
    let made = load(draft, table, name).map_err(|error| terrain_error(draft, "scouting.map", &error))?;
    cropped(draft, table, made)
}

fn load(draft: &Draft<'_>, table: &TerrainTable, name: &Path) -> Result<Terrain, TerrainError> {
    let path = draft.source.file(name);
    let terrain = Terrain::load_with(&path, &table.load)?;
    draft.source.reads(Terrain::picture(&path));
    Ok(terrain)
}

fn cropped(draft: &Draft<'_>, table: &TerrainTable, made: Terrain) -> Checked<Terrain> {
    let Some(Crop { x, y, width, height }) = table.crop else { return Ok(made) };
    made.crop(x, y, width, height).map_err(|error| terrain_error(draft, "terrain.crop", &error))
}

fn terrain_error(draft: &Draft<'_>, field: &str, error: &TerrainError) -> ScenarioError {
    let remedy = match error {
        TerrainError::Read { .. } => "file names are relative to the scenario file",
        _ => "see maps/README.md",
    };
    draft.error(field, error.to_string(), remedy)
}

/// Refuses a robot that is not in the scenario.
pub(super) fn known(draft: &Draft<'_>, robots: &[Robot], field: &str, robot: u32) -> Checked<RobotId> {
    let is_known = robots.binary_search_by_key(&RobotId(robot), |known| known.id).is_ok();
    let remedy = "give the number of a robot of this scenario";
    draft.require(is_known, field, format!("there is no robot {robot}"), remedy)?;
    Ok(RobotId(robot))
}

pub(super) fn misnumbered(draft: &Draft<'_>, robots: &[Robot]) -> Checked<Vec<(RobotId, RobotId)>> {
    let most = max_robot(draft.file.radio.format, draft.has("authentication"));
    let mut listed: Vec<(RobotId, RobotId)> = Vec::new();
    for (index, entry) in draft.file.misnumbered.iter().enumerate() {
        let at = draft.at(format!("misnumbered[{index}]"));
        let (robot, number) = (known(draft, robots, &at.field("robot"), entry.robot)?, RobotId(entry.number));
        let is_first = listed.iter().all(|(other, _)| *other != robot);
        let what = format!("robot {robot} has been given a number before");
        at.require(is_first, "robot", what, "give each robot one")?;
        let what = format!("robot {robot} has this number anyway");
        at.require(robot != number, "number", what, "give that of another robot")?;
        let what = format!("{number} is not a valid robot number");
        at.require((RobotId(1)..=most).contains(&number), "number", what, format!("give 1 to {}", most.0))?;
        listed.push((robot, number));
    }
    Ok(listed)
}

pub(super) fn faults(draft: &Draft<'_>, robots: &[Robot]) -> Checked<Vec<Fault>> {
    let fault = |(index, fault): (usize, &super::FaultTable)| {
        let robot = known(draft, robots, &format!("fault[{index}].robot"), fault.robot)?;
        Ok(Fault { robot, from_tick: draft.tick(fault.at_s), to_tick: draft.tick(fault.at_s + fault.down_s) })
    };
    let faults: Vec<Fault> = draft.file.fault.iter().enumerate().map(fault).collect::<Checked<_>>()?;
    let counts = draft.file.authentication.is_some() && draft.file.radio.format == Format::Postcard;
    if counts && let Some(index) = fault_beyond(&faults, LAST_START) {
        let (field, robot) = (format!("fault[{index}].robot"), faults[index].robot);
        let what = format!("robot {robot} restarts more than {LAST_START} times, more than frames with a key count");
        draft.require(false, &field, what, "give it fewer faults, or leave [authentication] out")?;
    }
    Ok(faults)
}

/// The first fault of a robot beyond `most`.
fn fault_beyond(faults: &[Fault], most: u32) -> Option<usize> {
    let mut restarts = HashMap::<RobotId, u32>::new();
    faults.iter().position(|fault| {
        let count = restarts.entry(fault.robot).or_default();
        *count += 1;
        *count > most
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_fault_of_a_robot_beyond_the_limit_is_found() {
        let faults = [1, 2, 1, 2, 2, 1, 2].map(|robot| Fault { robot: RobotId(robot), from_tick: 0, to_tick: 0 });
        assert_eq!([0, 1, 2, 3, 4].map(|most| fault_beyond(&faults, most)), [Some(0), Some(2), Some(4), Some(6), None]);
    }
}
