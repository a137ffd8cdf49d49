//! Checks of `[plane]`: positions, speeds, and which tables go together.

use super::super::ScenarioError;
use super::super::source::Source;
use super::table::{CloudEntry, Place, PlaneRobotEntry, PlaneTable};
use super::{PlaneSetup, Start, check_count};
use crate::nearby::{Cells, Query, Search, Space};
use staya_controller::agent::{GOALS, GuidanceKind, SafetyKind};

/// Farthest from the origin along each axis, metres: places go over the air as millimetres in 32 bits.
pub(super) const FAR_M: f64 = 2_000_000.0;

/// Fastest along each axis, m/s: velocities go over the air as millimetres a second in 16 bits.
const FAST_MPS: f64 = 32.0;

pub(super) fn place(source: &Source<'_>, field: &str, place: Place) -> Result<(), ScenarioError> {
    if place.0.iter().all(|x| x.abs() <= FAR_M) {
        return Ok(());
    }
    let remedy = "stay within 2000 km of the origin";
    Err(source.error(field, "this is too far away", remedy))
}

fn velocity(source: &Source<'_>, field: &str, velocity: Place) -> Result<(), ScenarioError> {
    if velocity.0.iter().all(|v| v.abs() <= FAST_MPS) {
        return Ok(());
    }
    let remedy = "give at most 32 m/s along each axis";
    Err(source.error(field, "this is too fast", remedy))
}

/// The velocity of a goal.
pub(super) fn goal_velocity(
    source: &Source<'_>,
    field: &str,
    guidance: GuidanceKind,
    given: Place,
) -> Result<(), ScenarioError> {
    if guidance == GuidanceKind::GoalFlock && given.0 != [0.0; 3] {
        let what = "goals of guidance \"goal_flock\" do not move";
        return Err(source.error(field, what, "leave it out"));
    }
    velocity(source, field, given)
}

/// How many goals robots have room for.
pub(super) const fn goals(guidance: GuidanceKind) -> u8 {
    match guidance {
        GuidanceKind::Waypoint | GuidanceKind::Lattice => 1,
        GuidanceKind::GoalFlock => GOALS as u8,
        GuidanceKind::Boids | GuidanceKind::Route | GuidanceKind::Formation => 0,
    }
}

fn goal_count(source: &Source<'_>, field: &str, guidance: GuidanceKind, count: usize) -> Result<(), ScenarioError> {
    let most = goals(guidance);
    if count <= usize::from(most) {
        return Ok(());
    }
    let what = format!("{count} goals are too many for guidance \"{}\"", guidance.name());
    Err(source.error(field, what, format!("give at most {most}, or another guidance")))
}

pub(super) fn list(source: &Source<'_>, guidance: GuidanceKind, list: &[PlaneRobotEntry]) -> Result<(), ScenarioError> {
    let field = "plane.robots.list";
    if list.is_empty() {
        return Err(source.error(field, "nobody takes part", "give one robot or more"));
    }
    check_count(source, field, u32::try_from(list.len()).unwrap_or(u32::MAX))?;
    for (index, robot) in list.iter().enumerate() {
        let field = |name| format!("{field}[{index}].{name}");
        place(source, &field("start_m"), robot.start_m)?;
        velocity(source, &field("velocity_mps"), robot.velocity_mps)?;
        if let Some(goal_m) = robot.goal_m {
            goal_count(source, &field("goal_m"), guidance, 1)?;
            place(source, &field("goal_m"), goal_m)?;
        }
    }
    Ok(())
}

pub(super) fn cloud(source: &Source<'_>, guidance: GuidanceKind, cloud: &CloudEntry) -> Result<(), ScenarioError> {
    let field = |name| format!("plane.robots.cloud.{name}");
    place(source, &field("from_m"), cloud.from_m)?;
    place(source, &field("to_m"), cloud.to_m)?;
    let (from, to) = (cloud.velocity_from_mps, cloud.velocity_to_mps);
    velocity(source, &field("velocity_from_mps"), from)?;
    velocity(source, &field("velocity_to_mps"), to)?;
    goal_count(source, &field("goals_m"), guidance, cloud.goals_m.len())?;
    for (index, goal) in cloud.goals_m.iter().enumerate() {
        place(source, &format!("plane.robots.cloud.goals_m[{index}]"), *goal)?;
    }
    let moves = cloud.goal_velocity_mps;
    goal_velocity(source, &field("goal_velocity_mps"), guidance, moves)
}

/// No two robots overlap, however they were placed.
pub(super) fn starts(source: &Source<'_>, starts: &[Start], radius_m: f64) -> Result<(), ScenarioError> {
    let centers: Vec<_> = starts.iter().map(|start| start.position_m).collect();
    // Less than that is rounding.
    let least_m = 2.0 * radius_m - 1e-6;
    let mut index = Cells::<f64, 3>::new(Space::OPEN, least_m);
    index.rebuild(&centers);
    let mut found = Vec::new();
    for (number, at) in (0..).zip(centers) {
        let query = Query { at, radius: least_m, most: 1, except: Some(number) };
        index.within(&query, &mut found);
        if let Some(near) = found.first() {
            let (one, two) = (number + 1, near.index + 1);
            let what = format!("robots {one} and {two} overlap at the start");
            let remedy = format!("put them {} m apart", 2.0 * radius_m);
            return Err(source.error("plane.robots", what, remedy));
        }
    }
    Ok(())
}

/// No robot starts in an obstacle.
pub(super) fn outside(source: &Source<'_>, setup: &PlaneSetup) -> Result<(), ScenarioError> {
    for (number, start) in (1..).zip(&setup.starts) {
        let place = start.position_m;
        let is_in = |solid: &crate::world::plane::Solid| solid.distance_m(place) < setup.radius_m - 1e-6;
        if setup.solids.iter().any(is_in) {
            let what = format!("robot {number} starts in an obstacle");
            let remedy = format!("keep starts {} m away from obstacles", setup.radius_m);
            return Err(source.error("plane.robots", what, remedy));
        }
    }
    Ok(())
}

/// What would be ignored is refused.
pub(super) fn safety_tables(source: &Source<'_>, table: &PlaneTable) -> Result<(), ScenarioError> {
    let is_used = !matches!(table.safety, SafetyKind::None | SafetyKind::PushOut);
    if is_used || table.orca.is_empty() {
        return Ok(());
    }
    let remedy = "give plane.safety = \"orca\", or leave this table out";
    Err(source.error("plane.orca", "these robots have another safety layer", remedy))
}
