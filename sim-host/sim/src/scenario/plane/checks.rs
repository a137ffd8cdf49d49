//! Checks of `[plane]`: positions, speeds, and combinations of tables.

use super::super::Draft;
use super::super::law::LawSetup;
use super::super::ranges::short;
use super::super::source::{Checked, Section};
use super::body::Group;
use super::table::{CloudEntry, MAX_ROBOTS, Place, PlaneRobotEntry};
use super::{PlaneSetup, Start};
use crate::nearby::{Cells, Query, Search};
use crate::own_law::Site;
use crate::terrain::Terrain;
use crate::world::plane::{Solid, Solids};
use staya_controller::agent::{Goals, WAYPOINTS};

pub(in super::super) fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Checks a velocity at the start of the run against the highest speed.
fn start_velocity(at: &Section<'_>, name: &str, start: Place, most_mps: f64) -> Checked {
    let speed_mps = norm(start.0);
    if speed_mps <= most_mps * (1.0 + 1e-9) {
        return Ok(());
    }
    let what = format!("{} m/s exceeds the highest speed", short(speed_mps));
    Err(at.error(name, what, format!("give at most {} m/s in all", short(most_mps))))
}

/// A robot over cells starts with one goal, which an operator's order cannot move.
fn goal_count(group: &Group<'_>, at: &Section<'_>, name: &str, count: usize) -> Checked {
    let most = match group.kind.goals() {
        Goals::None => 0,
        Goals::Cell | Goals::Waypoints => 1,
        Goals::Shared(most) => usize::from(most),
    };
    if count <= most {
        return Ok(());
    }
    let law = group.kind.name();
    let (what, remedy) = match most {
        0 => (format!("the law \"{law}\" takes no goal"), "leave it out, or give another law".to_owned()),
        _ => (
            format!("{count} goals are too many for the law \"{law}\""),
            format!("give at most {most}, or another law"),
        ),
    };
    Err(at.error(name, what, remedy))
}

/// The terrain for a law that moves from cell to cell; an error if there is none.
pub(super) fn land<'a>(group: &Group<'_>, terrain: Option<&'a Terrain>) -> Checked<Option<&'a Terrain>> {
    let is_on_grid = group.kind.is_on_grid();
    let (what, remedy) = ("this law goes from cell to cell", "give [terrain], or another law");
    group.at.require(!is_on_grid || terrain.is_some(), "law", what, remedy)?;
    Ok(terrain.filter(|_| is_on_grid))
}

pub(super) fn in_cells(group: &Group<'_>, land: &Terrain, starts: &[Start]) -> Checked {
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
        return Err(group.at.error("robots", what, "give each one start and one goal on free land"));
    }
    Ok(())
}

pub(super) fn list(group: &Group<'_>, list: &[PlaneRobotEntry]) -> Checked {
    let what = "robots.list";
    group.at.within(what, list.len() as f64, 1.0..=MAX_ROBOTS, "robots")?;
    for (index, robot) in list.iter().enumerate() {
        let at = group.at.at(format!("robots.list[{index}]"));
        let most_mps = robot.max_speed_mps.unwrap_or(group.body.max_speed_mps);
        start_velocity(&at, "velocity_mps", robot.velocity_mps, most_mps)?;
        if robot.goal_m.is_some() {
            goal_count(group, &at, "goal_m", 1)?;
        }
        if !robot.via_m.is_empty() {
            via(&group.kind, &at, robot)?;
        }
    }
    Ok(())
}

fn via(law: &LawSetup, at: &Section<'_>, robot: &PlaneRobotEntry) -> Checked {
    let (count, most) = (robot.via_m.len(), WAYPOINTS - 1);
    let what = format!("robots with the law \"{}\" go by no places", law.name());
    let remedy = "give law = \"waypoint\", or leave it out";
    at.require(law.takes_ways(), "via_m", what, remedy)?;
    at.require(robot.goal_m.is_some(), "via_m", "a way needs an end", "give goal_m too")?;
    let what = format!("{count} places on the way are too many");
    at.require(count <= most, "via_m", what, format!("give at most {most}"))
}

pub(super) fn cloud(group: &Group<'_>, cloud: &CloudEntry) -> Checked {
    let at = group.at.at("robots.cloud");
    let (from, to) = (cloud.velocity_from_mps, cloud.velocity_to_mps);
    let fastest = Place(std::array::from_fn(|axis| from.0[axis].abs().max(to.0[axis].abs())));
    let name = if at.has("velocity_to_mps") { "velocity_to_mps" } else { "velocity_from_mps" };
    start_velocity(&at, name, fastest, group.body.max_speed_mps)?;
    goal_count(group, &at, "goals_m", cloud.goals_m.len())
}

pub(super) fn starts(draft: &Draft<'_>, setup: &PlaneSetup) -> Checked {
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
                return Err(draft.error("plane.robots", what, remedy));
            }
        }
    }
    Ok(())
}

pub(super) fn outside(draft: &Draft<'_>, setup: &PlaneSetup) -> Checked {
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
        return Err(draft.error("plane.robots", what, remedy));
    }
    Ok(())
}

/// Refuses a law that these bodies cannot have, or values of it that have no meaning for them.
pub(super) fn law(group: &Group<'_>, law: &LawSetup) -> Checked {
    let what = format!("the law \"{}\" goes from cell to cell", law.name());
    // Whether there are cells for a law over cells is asked where its robots are placed.
    let has_cells = group.draft.file.terrain.is_some() || law.is_on_grid();
    let site = if has_cells { Site::PlaneOverCells } else { Site::Plane };
    group.at.require(law.fits(site), "law", what, "give a law that goes by velocities, or leave [plane] out")?;
    let name = law.name();
    let what = "robots in the plane do not wait; the slowest sets the pace";
    let is_free = !(law.keeps_formation() && group.body.law.given("waits"));
    group.at.require(is_free, &format!("{name}.waits"), what, "leave it out")
}
