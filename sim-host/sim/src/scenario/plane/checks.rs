//! Checks of `[plane]`: positions, speeds, and combinations of tables.

use super::super::ScenarioError;
use super::super::ranges::short;
use super::super::source::Source;
use super::fields::Group;
use super::table::{CloudEntry, FAR_M, MAX_ROBOTS, Place, PlaneRobotEntry};
use super::{PlaneSetup, Start, within};
use crate::nearby::{Cells, Query, Search};
use crate::terrain::Terrain;
use crate::world::plane::{Solid, Solids};
use staya_controller::agent::{GOALS, GuidanceKind, WAYPOINTS};

/// Highest speed along each axis, m/s: beacons encode velocities as 16-bit millimetres per second.
const FAST_MPS: f64 = 32.0;

pub(super) fn place(source: &Source<'_>, field: &str, place: Place) -> Result<(), ScenarioError> {
    if place.0.iter().all(|x| x.abs() <= FAR_M) {
        return Ok(());
    }
    let remedy = "stay within 2000 km of the origin";
    Err(source.error(field, "this is too far away", remedy))
}

pub(super) fn velocity(source: &Source<'_>, field: &str, velocity: Place) -> Result<(), ScenarioError> {
    if velocity.0.iter().all(|v| v.abs() <= FAST_MPS) {
        return Ok(());
    }
    let remedy = "give at most 32 m/s along each axis";
    Err(source.error(field, "this is too fast", remedy))
}

/// Checks a velocity at the start of the run against the highest speed.
fn start_velocity(source: &Source<'_>, field: &str, at: Place, most_mps: f64) -> Result<(), ScenarioError> {
    velocity(source, field, at)?;
    let speed_mps = at.0.iter().map(|v| v * v).sum::<f64>().sqrt();
    if speed_mps <= most_mps * (1.0 + 1e-9) {
        return Ok(());
    }
    let what = format!("{} m/s exceeds the highest speed", short(speed_mps));
    Err(source.error(field, what, format!("give at most {} m/s in all", short(most_mps))))
}

pub(crate) const fn goals(guidance: GuidanceKind) -> u8 {
    match guidance {
        GuidanceKind::Waypoint | GuidanceKind::Lattice => 1,
        GuidanceKind::GoalFlock => GOALS as u8,
        GuidanceKind::Boids | GuidanceKind::Route | GuidanceKind::Formation => 0,
    }
}

/// A robot on the grid starts with one goal, which an operator's order cannot move.
fn goal_count(source: &Source<'_>, field: &str, guidance: GuidanceKind, count: usize) -> Result<(), ScenarioError> {
    let most = if guidance == GuidanceKind::Route { 1 } else { goals(guidance) };
    if count <= usize::from(most) {
        return Ok(());
    }
    let what = format!("{count} goals are too many for guidance \"{}\"", guidance.name());
    Err(source.error(field, what, format!("give at most {most}, or another guidance")))
}

/// The terrain for a law that moves from cell to cell; an error if one is given without the other.
pub(super) fn land<'a>(
    source: &Source<'_>,
    group: &Group,
    terrain: Option<&'a Terrain>,
) -> Result<Option<&'a Terrain>, ScenarioError> {
    match (group.body.guidance.is_on_grid(), terrain) {
        (true, None) => {
            let (what, remedy) = ("this guidance goes from cell to cell", "give [terrain], or another guidance");
            Err(source.error(&group.field("guidance"), what, remedy))
        }
        (true, Some(land)) => Ok(Some(land)),
        (false, _) => Ok(None),
    }
}

pub(super) fn in_cells(
    source: &Source<'_>,
    group: &Group,
    land: &Terrain,
    starts: &[Start],
) -> Result<(), ScenarioError> {
    let is_open = |[x, y, z]: [f64; 3]| {
        let cell = land.nearest_cell([x, y]);
        let [at_x, at_y] = land.center_m(cell);
        let half_m = land.cell_m / 2.0;
        z == 0.0 && (x - at_x).abs() <= half_m && (y - at_y).abs() <= half_m && land.is_passable(cell)
    };
    for (index, start) in starts.iter().enumerate() {
        let what = match &start.places[..] {
            _ if !is_open(start.position_m) => "starts in no free cell",
            [goal] if goal.velocity_mps == [0.0; 3] && is_open(goal.position_m) => continue,
            [_] => "has its goal in no free cell",
            _ => "has no goal",
        };
        let what = format!("robot {} of the group goes from cell to cell and {what}", index + 1);
        let remedy = "give each one start and one goal on free land";
        return Err(source.error(&format!("{}.robots", group.table), what, remedy));
    }
    Ok(())
}

pub(super) fn list(source: &Source<'_>, group: &Group, list: &[PlaneRobotEntry]) -> Result<(), ScenarioError> {
    let field = format!("{}.robots.list", group.table);
    if list.is_empty() {
        return Err(source.error(&field, "there are no robots", "give one robot or more"));
    }
    within(source, &field, list.len() as f64, 1.0, MAX_ROBOTS, "robots")?;
    for (index, robot) in list.iter().enumerate() {
        let field = |name| format!("{field}[{index}].{name}");
        place(source, &field("start_m"), robot.start_m)?;
        let most_mps = robot.max_speed_mps.unwrap_or(group.body.max_speed_mps);
        start_velocity(source, &field("velocity_mps"), robot.velocity_mps, most_mps)?;
        if let Some(goal_m) = robot.goal_m {
            goal_count(source, &field("goal_m"), group.body.guidance, 1)?;
            place(source, &field("goal_m"), goal_m)?;
        }
        via(source, &field("via_m"), group.body.guidance, robot)?;
    }
    Ok(())
}

fn via(source: &Source<'_>, field: &str, guidance: GuidanceKind, robot: &PlaneRobotEntry) -> Result<(), ScenarioError> {
    let (count, most) = (robot.via_m.len(), WAYPOINTS - 1);
    if count == 0 {
        return Ok(());
    }
    if guidance != GuidanceKind::Waypoint {
        let what = format!("robots with guidance \"{}\" go by no places", guidance.name());
        return Err(source.error(field, what, "give guidance \"waypoint\", or leave it out"));
    }
    if robot.goal_m.is_none() {
        return Err(source.error(field, "a way needs an end", "give goal_m too"));
    }
    if count > most {
        let what = format!("{count} places on the way are too many");
        return Err(source.error(field, what, format!("give at most {most}")));
    }
    let mut places = robot.via_m.iter().enumerate();
    places.try_for_each(|(index, &at)| place(source, &format!("{field}[{index}]"), at))
}

pub(super) fn cloud(source: &Source<'_>, group: &Group, cloud: &CloudEntry) -> Result<(), ScenarioError> {
    let field = |name| format!("{}.robots.cloud.{name}", group.table);
    place(source, &field("from_m"), cloud.from_m)?;
    place(source, &field("to_m"), cloud.to_m)?;
    let (from, to) = (cloud.velocity_from_mps, cloud.velocity_to_mps);
    velocity(source, &field("velocity_from_mps"), from)?;
    let fastest = Place(std::array::from_fn(|axis| from.0[axis].abs().max(to.0[axis].abs())));
    let name = if source.has(&field("velocity_to_mps")) { "velocity_to_mps" } else { "velocity_from_mps" };
    start_velocity(source, &field(name), fastest, group.body.max_speed_mps)?;
    goal_count(source, &field("goals_m"), group.body.guidance, cloud.goals_m.len())?;
    for (index, goal) in cloud.goals_m.iter().enumerate() {
        place(source, &format!("{}[{index}]", field("goals_m")), *goal)?;
    }
    velocity(source, &field("goal_velocity_mps"), cloud.goal_velocity_mps)
}

pub(super) fn starts(source: &Source<'_>, setup: &PlaneSetup) -> Result<(), ScenarioError> {
    let centers: Vec<_> = setup.starts.iter().map(|start| start.position_m).collect();
    let largest_m = setup.kinds().map(|group| group.radius_m).fold(0.0, f64::max);
    let mut index = Cells::<f64, 3>::new(setup.space(), (2.0 * largest_m).max(1e-3));
    index.rebuild(&centers);
    let mut found = Vec::new();
    for (number, at) in (0..).zip(centers) {
        let own_m = setup.group(number as usize).radius_m;
        // Few robots can overlap this one if the earlier robots do not overlap each other.
        let query = Query { at, radius: own_m + largest_m, most: usize::MAX, except: Some(number) };
        index.within(&query, &mut found);
        for near in &found {
            let apart_m = own_m + setup.group(near.index as usize).radius_m;
            if near.distance_squared.sqrt() < apart_m - 1e-6 {
                let (one, two) = (number + 1, near.index + 1);
                let what = format!("robots {one} and {two} overlap at the start");
                let remedy = format!("put them {apart_m} m apart");
                return Err(source.error("plane.robots", what, remedy));
            }
        }
    }
    Ok(())
}

pub(super) fn outside(source: &Source<'_>, setup: &PlaneSetup) -> Result<(), ScenarioError> {
    let largest_m = setup.kinds().map(|group| group.radius_m).fold(0.0, f64::max);
    let solids = Solids::new(setup.solids.clone(), largest_m);
    for (index, start) in setup.starts.iter().enumerate() {
        let (place, radius_m) = (start.position_m, setup.group(index).radius_m);
        let is_in = |solid: &Solid| solid.distance_m(place) < radius_m - 1e-6;
        let intruders = setup.intruders.iter();
        let intruders =
            intruders.map(|intruder| Solid::Ball { center_m: intruder.position_m, radius_m: intruder.radius_m });
        let what = if solids.near(place, radius_m).any(is_in) {
            format!("robot {} starts in an obstacle", index + 1)
        } else if intruders.into_iter().any(|intruder| is_in(&intruder)) {
            format!("robot {} starts in an intruder", index + 1)
        } else {
            continue;
        };
        let remedy = format!("keep its start {radius_m} m away");
        return Err(source.error("plane.robots", what, remedy));
    }
    Ok(())
}
