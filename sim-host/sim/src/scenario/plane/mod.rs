//! `[plane]`: robots that move in the plane or in space, and their choice of velocity.

mod body;
mod checks;
mod grounds;
mod group;
mod inherit;
mod place;
mod remarks;
mod scattered;
mod sensing;
mod starts;
mod table;
mod torus;

pub(super) use checks::norm;
pub(super) use inherit::inherit;
pub(super) use remarks::remarks;

#[cfg(test)]
mod tests;

pub use group::RobotGroup;
pub use place::{Start, Target};
pub use table::*;

pub(super) use super::read::Limits;

use super::clocks::phase_ticks;
use super::robots;
use super::source::{Checked, Section};
use super::{Draft, Part, Placed, Robot, Scenario};
use crate::nearby::Space;
use crate::own_law::NEGOTIATION;
use crate::terrain::Terrain;
use crate::world::plane::{Sensing, Solid};
use body::Group;
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;

/// An operator's order to all robots.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Tick in which the order arrives.
    pub tick: u32,
    /// Index of the goal, from 0.
    pub index: u8,
    /// The new goal.
    pub target: Target,
}

/// A foreign body that moves at constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intruder {
    /// Start position, metres.
    pub position_m: [f64; 3],
    /// Velocity, m/s.
    pub velocity_mps: [f64; 3],
    /// Radius of the body, metres.
    pub radius_m: f64,
    /// Whether it sends beacons; otherwise robots detect it like an obstacle.
    pub is_heard: bool,
}

/// A checked `[plane]`.
#[derive(Clone, Debug)]
pub struct PlaneSetup {
    /// Properties of robots outside the groups.
    pub general: RobotGroup,
    /// Properties of the robots in each group.
    pub groups: Vec<RobotGroup>,
    /// Whether there is terrain under the bodies.
    pub has_terrain: bool,
    /// Side lengths of the torus, metres; `None`: an open plane.
    pub torus_m: Option<[f64; 2]>,
    /// Static obstacles.
    pub solids: Vec<Solid>,
    /// Foreign bodies.
    pub intruders: Vec<Intruder>,
    /// Starts, by robot.
    pub starts: Vec<Start>,
    /// Operator's orders, sorted by tick.
    pub orders: Vec<Order>,
    /// Sensing of other robots; `None`: disabled.
    pub sensing: Option<Sensing>,
}

impl PlaneSetup {
    /// Geometry of the plane: open or a torus.
    #[must_use]
    pub fn space(&self) -> Space<f64, 3> {
        torus::space(self.torus_m)
    }

    /// Properties of robot `index`.
    #[must_use]
    pub fn group(&self, index: usize) -> &RobotGroup {
        let group = self.starts.get(index).and_then(|start| self.groups.get(start.group?));
        group.unwrap_or(&self.general)
    }

    /// Whether some robots have a phase of their own other than 0.
    pub(super) fn has_phases(&self) -> bool {
        self.starts.iter().any(|start| start.phase_ticks.is_some_and(|phase| phase > 0))
    }

    /// Number of intruders that send beacons.
    #[must_use]
    pub fn heard(&self) -> usize {
        self.intruders.iter().filter(|intruder| intruder.is_heard).count()
    }

    /// Distinct robot properties, without groups that have no robots.
    pub fn kinds(&self) -> impl Iterator<Item = &RobotGroup> {
        let general = Some(&self.general).filter(|_| self.starts.iter().any(|start| start.group.is_none()));
        general.into_iter().chain(&self.groups)
    }

    /// The cells of robots given in metres are valid only if their law moves from cell to cell.
    fn robots(&self, in_cells: &[Robot], terrain: Option<&Terrain>) -> Vec<Robot> {
        let cell = |index: usize, place_m: Option<[f64; 3]>| {
            let land = terrain.filter(|_| self.group(index).law.is_on_grid());
            land.zip(place_m).map_or_else(Cell::default, |(land, [x, y, _])| land.nearest_cell([x, y]))
        };
        let last = in_cells.last().map_or(0, |robot| robot.id.0);
        let others = (in_cells.len()..).zip(&self.starts[in_cells.len()..]).zip(last.saturating_add(1)..);
        let others = others.map(|((index, start), id)| Robot {
            id: RobotId(id),
            start: cell(index, Some(start.position_m)),
            goal: cell(index, start.places.first().map(|target| target.position_m)),
        });
        in_cells.iter().copied().chain(others).collect()
    }
}

impl Scenario {
    /// Side lengths of the torus, metres; `None`: an open plane.
    #[must_use]
    pub fn torus_m(&self) -> Option<[f64; 2]> {
        self.plane()?.torus_m
    }
}

pub(super) fn build(draft: &Draft<'_>, table: &PlaneTable, terrain: Option<&Terrain>) -> Checked<(Placed, PlaneSetup)> {
    let file = &draft.file;
    let cells = match (&file.robots, terrain) {
        (Some(_), Some(land)) => Some(robots::build(draft, land)?),
        (Some(_), None) => {
            return Err(draft.error("robots", "there are no cells", "give [terrain], or plane.robots in metres"));
        }
        (None, _) => None,
    };
    let (group, has_cells) = (Group::general(draft, &table.body), cells.is_some());
    let remedy = "give [terrain] and the top-level [robots], or another law";
    let fits = has_cells || !group.kind.is_on_grid() || table.robots.is_none();
    draft.require(fits, "plane.law", "this law goes from cell to cell", remedy)?;
    let go_together = !has_cells || group.kind.fits_robots(file.cells_in_formation());
    let what = "robots.formation and the law \"formation\" go together";
    draft.require(go_together, "plane.law", what, "give both or none of them")?;
    let in_metres = table.robots.as_ref();
    let is_formation = in_metres.is_some_and(|given| matches!(given.robots, RobotsSource::Formation(_)));
    let remedy = "give it as the top-level robots.formation, or to a plane.group";
    draft.require(!is_formation, "plane.robots.formation", "a formation stands in cells", remedy)?;
    let has_groups = !table.group.is_empty();
    let is_defined = has_cells != in_metres.is_some() || (!has_cells && has_groups);
    let what = "the robots are not defined exactly once";
    let remedy = "give either plane.robots in metres or the top-level robots in cells, with plane.group if you like";
    draft.require(is_defined, "plane.robots", what, remedy)?;

    let mut general = group.build()?;
    let solids = solids(draft, table)?;
    let (cells, mut formations) = cells.unwrap_or_default();
    let last = cells.last().map_or(0, |robot| robot.id.0);
    let phase = phase_ticks(draft, &group.at, group.body.phase_s)?;
    let mut placing = starts::Placing {
        draft,
        general_m: general.radius_m,
        surroundings: grounds::Surroundings::new(draft, terrain, &solids),
        groups: Vec::new(),
        starts: terrain.map_or_else(Vec::new, |land| starts::on_land(&cells, land, phase)),
    };
    if let Some(robots) = in_metres {
        placing.place(&group, None, robots)?;
    }
    let mut parts = vec![Part { table: "plane".to_owned(), members: 0..placing.starts.len() }];
    for (index, entry) in table.group.iter().enumerate() {
        let (group, before) = (Group::numbered(draft, index, entry), placing.starts.len());
        let land = checks::land(&group, terrain)?;
        let number = placing.add(&group)?;
        match (group.kind.keeps_formation(), &entry.robots.robots, land) {
            (true, RobotsSource::Formation(formation), Some(land)) => {
                let at = group.at.at("robots.formation");
                let (robots, formation) = robots::of_group(draft, &at, formation, land)?;
                let phase = phase_ticks(draft, &group.at, group.body.phase_s)?;
                let members = starts::on_land(&robots, land, phase).into_iter();
                placing.starts.extend(members.map(|start| Start { group: Some(number), ..start }));
                let id = last.saturating_add(u32::try_from(before - cells.len()).unwrap_or(u32::MAX)).saturating_add(1);
                formations.push(formation.of(before, id));
            }
            (true, ..) | (false, RobotsSource::Formation(_), _) => {
                let what = "the law \"formation\" and robots.formation go together, without other robots";
                return Err(group.at.error("law", what, "give both or none of them"));
            }
            (false, _, land) => {
                placing.place(&group, Some(number), &entry.robots)?;
                if let Some(land) = land {
                    checks::in_cells(&group, land, &placing.starts[before..])?;
                }
            }
        }
        parts.push(Part { table: group.at.path, members: before..placing.starts.len() });
    }
    fit_around_corners(draft, &general, &placing.groups, terrain)?;
    let starts::Placing { mut groups, starts, .. } = placing;
    parts.retain(|part| has_groups && !part.members.is_empty());
    group::grow_as_the_fastest(&mut general, &mut groups);
    let mut setup = PlaneSetup {
        general,
        groups,
        has_terrain: terrain.is_some(),
        torus_m: table.torus_m,
        intruders: intruders(draft, table)?,
        solids,
        starts,
        orders: Vec::new(),
        sensing: None,
    };
    torus::check(draft, table, &setup)?;
    checks::starts(draft, &setup)?;
    checks::outside(draft, &setup)?;
    setup.orders = orders(draft, table, &setup)?;
    setup.sensing = sensing::sensing(draft, table, &setup)?;
    Ok((Placed { robots: setup.robots(&cells, terrain), formations, parts }, setup))
}

/// Largest radius of robots that negotiate, cells: two that follow each other around a corner pass
/// at 0.7 cells.
const WIDEST: f64 = 0.35;

fn fit_around_corners(
    draft: &Draft<'_>,
    general: &RobotGroup,
    groups: &[RobotGroup],
    terrain: Option<&Terrain>,
) -> Checked {
    let Some(land) = terrain else { return Ok(()) };
    let widest_m = land.cell_m * WIDEST;
    let paths = (0..groups.len()).map(|index| format!("plane.group[{index}]"));
    for (path, group) in paths.zip(groups).chain([("plane".to_owned(), general)]) {
        let fits = group.law.name() != NEGOTIATION || group.radius_m <= widest_m;
        let what = format!("{} m are more than {WIDEST} cells: robots touch at a corner", group.radius_m);
        let remedy = format!("give at most {widest_m}, or a larger terrain.cell_m");
        draft.at(path).require(fits, "radius_m", what, remedy)?;
    }
    Ok(())
}

fn intruders(draft: &Draft<'_>, table: &PlaneTable) -> Checked<Vec<Intruder>> {
    let intruder = |(index, entry): (usize, &IntruderEntry)| {
        let at = draft.at(format!("plane.intruder[{index}]"));
        let has_key = !entry.heard || !draft.has("authentication");
        let what = "an intruder does not have the key, so robots reject its beacons";
        at.require(has_key, "heard", what, "give heard = false, or leave [authentication] out")?;
        Ok(Intruder {
            position_m: entry.start_m.0,
            velocity_mps: entry.velocity_mps.0,
            radius_m: entry.radius_m,
            is_heard: entry.heard,
        })
    };
    table.intruder.iter().enumerate().map(intruder).collect()
}

fn wall(at: &Section<'_>, wall: &WallEntry) -> Checked<Vec<Solid>> {
    let points = &wall.points_m[..];
    at.require(points.len() >= 2, "points_m", "this is not a wall", "give two or more points in metres")?;
    let Some(door_m) = wall.door_m else {
        let closing = wall.closed.then(|| [points[points.len() - 1], points[0]]);
        return Ok(points.windows(2).map(|pair| [pair[0], pair[1]]).chain(closing).map(Solid::Wall).collect());
    };
    let [from, to] = *points else {
        return Err(at.error("door_m", "only a wall of two points has a door", "give two points in points_m"));
    };
    let length_m = libm::hypot(to[0] - from[0], to[1] - from[1]);
    at.within("door_m", door_m, 0.0..=length_m, "metres, the length of the wall")?;
    let side =
        |along_m: f64| [0, 1].map(|axis| (from[axis] + to[axis] + (to[axis] - from[axis]) / length_m * along_m) / 2.0);
    Ok(vec![Solid::Wall([from, side(-door_m)]), Solid::Wall([side(door_m), to])])
}

fn solids(draft: &Draft<'_>, table: &PlaneTable) -> Checked<Vec<Solid>> {
    let mut solids = Vec::new();
    for (index, entry) in table.wall.iter().enumerate() {
        solids.extend(wall(&draft.at(format!("plane.wall[{index}]")), entry)?);
    }
    let balls = table.ball.iter();
    solids.extend(balls.map(|ball| Solid::Ball { center_m: ball.center_m.0, radius_m: ball.radius_m }));
    solids.extend(scattered::balls(draft, &table.balls)?);
    for (index, entry) in table.half_space.iter().enumerate() {
        let at = draft.at(format!("plane.half_space[{index}]"));
        let length = checks::norm(entry.normal.0);
        let is_direction = length > 0.0 && length.is_finite();
        at.require(is_direction, "normal", "this is not a direction", "give a vector that is not zero")?;
        solids.push(Solid::Plane { point_m: entry.point_m.0, normal: entry.normal.0.map(|x| x / length) });
    }
    Ok(solids)
}

fn orders(draft: &Draft<'_>, table: &PlaneTable, setup: &PlaneSetup) -> Checked<Vec<Order>> {
    let mut laws: Vec<_> = setup.kinds().map(|group| (group.law.name(), group.law.goals())).collect();
    laws.dedup();
    let names: Vec<_> = laws.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let order = |(index, order): (usize, &OrderEntry)| {
        let at = draft.at(format!("plane.order[{index}]"));
        let what = format!("robots with the law {} have no goal {}", names.join(" or "), order.goal);
        let has_goal = laws.iter().any(|(_, goals)| order.goal < goals.movable());
        at.require(has_goal, "goal", what, "give one that they have, from 0, or another law")?;
        let target = Target { position_m: order.place_m.0, velocity_mps: order.velocity_mps.0 };
        Ok(Order { tick: draft.tick(order.at_s), index: order.goal, target })
    };
    let mut orders = table.order.iter().enumerate().map(order).collect::<Checked<Vec<_>>>()?;
    orders.sort_by_key(|order| order.tick);
    Ok(orders)
}
