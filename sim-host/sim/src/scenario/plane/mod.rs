//! `[plane]`: robots that move in the plane or in space, and their choice of velocity.

mod checks;
mod fields;
mod flocks;
mod group;
mod inherit;
mod place;
mod remarks;
mod scattered;
mod sensing;
mod starts;
mod table;
mod torus;

pub(crate) use checks::goals;
pub(super) use flocks::remark;
pub(super) use inherit::inherit;
pub(super) use remarks::remarks;
pub(super) use sensing::sensing;

#[cfg(test)]
mod tests;

pub use group::RobotGroup;
pub use place::{Start, Target};
pub use starts::circle_starts;
pub use table::*;

use super::ranges::within;
use super::source::Source;
use super::{Formation, FormationSetup, Part, Robot, Scenario, ScenarioError, ScenarioFile};
use crate::nearby::Space;
use crate::radio::RadioParams;
use crate::terrain::Terrain;
use crate::world::MoveRules;
use crate::world::plane::Solid;
use fields::Group;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{GuidanceKind, RouteSetup};
use staya_controller::formation::FormationParams;
use staya_controller::grid::Cell;
use staya_controller::neighbor::PlausibilityLimits;
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
}

impl PlaneSetup {
    /// Creates a plane with identical robots and without terrain or obstacles.
    #[must_use]
    pub const fn new(general: RobotGroup, starts: Vec<Start>) -> Self {
        Self {
            general,
            groups: Vec::new(),
            has_terrain: false,
            torus_m: None,
            solids: Vec::new(),
            intruders: Vec::new(),
            starts,
            orders: Vec::new(),
        }
    }

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
            let land = terrain.filter(|_| self.group(index).guidance.kind().is_on_grid());
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
        self.plane.as_ref()?.torus_m
    }

    /// Builds a scenario in the plane without a file. It lasts `ticks` of `setup.abilities.step_s`;
    /// robots have ids from 1 in the order of their starts.
    #[must_use]
    pub fn in_plane(name: &str, seed: u64, ticks: u32, radio: RadioParams, setup: PlaneSetup) -> Self {
        let mut scenario = Self {
            name: name.to_owned(),
            seed,
            ticks,
            tick_us: super::ranges::micros(setup.general.abilities.step_s),
            terrain: Terrain::flat(1, 1),
            changes: Vec::new(),
            scouting: None,
            rules: MoveRules::default(),
            radio,
            files: Vec::new(),
            robots: setup.robots(&[], None),
            formations: Vec::new(),
            parts: Vec::new(),
            plane: Some(setup),
            route: RouteSetup::default(),
            formation_law: FormationSetup::Staya(FormationParams::default()),
            law: None,
            sensing: None,
            faults: Vec::new(),
            interventions: Vec::new(),
            misnumbered: Vec::new(),
            keys: None,
            plausibility: PlausibilityLimits::ANY,
            maps: None,
            attacks: Vec::new(),
            parameters: serde_json::Value::Null,
        };
        scenario.plausibility = scenario.usual_claims();
        scenario
    }
}

pub(super) struct Placed {
    pub setup: PlaneSetup,
    pub robots: Vec<Robot>,
    pub formations: Vec<Formation>,
    pub parts: Vec<Part>,
}

pub(super) fn build(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    terrain: Option<&Terrain>,
    cells: Option<(Vec<Robot>, Vec<Formation>)>,
) -> Result<Placed, ScenarioError> {
    if table.body.guidance.is_on_grid() && (terrain.is_none() || cells.is_none()) {
        let remedy = "give [terrain] and the top-level [robots], or another guidance";
        return Err(source.error("plane.guidance", "this guidance goes from cell to cell", remedy));
    }
    if (table.body.guidance == GuidanceKind::Formation) != file.cells_in_formation() && cells.is_some() {
        let remedy = "give both or none of them";
        return Err(source.error("plane.guidance", "robots.formation and guidance \"formation\" go together", remedy));
    }
    if table.robots.as_ref().is_some_and(|robots| robots.formation.is_some()) {
        let remedy = "give it as the top-level robots.formation, or to a plane.group";
        return Err(source.error("plane.robots.formation", "a formation stands in cells", remedy));
    }
    let places = flocks::places(file);
    let kind = Group::general(&table.body, places);
    let mut general = kind.build(source, file)?;
    let solids = solids(source, file, table)?;
    let has_groups = !table.group.is_empty();
    if cells.is_some() == table.robots.is_some() && (cells.is_some() || !has_groups) {
        return Err(source.error(
            "plane.robots",
            "the robots are not defined exactly once",
            "give either plane.robots in metres or the top-level robots in cells, with plane.group if you like",
        ));
    }
    let (cells, mut formations) = cells.unwrap_or_default();
    let mut starts = terrain.map_or_else(Vec::new, |land| starts::on_land(&cells, land));
    let last = cells.last().map_or(0, |robot| robot.id.0);
    let mut groups = Vec::new();
    let mut placing = starts::Placing {
        source,
        file,
        general_m: general.radius_m,
        solids: &solids,
        groups: &mut groups,
        starts: &mut starts,
    };
    if let Some(robots) = &table.robots {
        placing.place(&kind, None, robots)?;
    }
    let mut parts = vec![Part { table: "plane".to_owned(), members: 0..placing.starts.len() }];
    for (index, entry) in table.group.iter().enumerate() {
        let (group, before) = (Group::numbered(index, entry, places), placing.starts.len());
        let land = checks::land(source, &group, terrain)?;
        flocks::number(source, &group, entry.flock, places)?;
        let number = placing.add(&group)?;
        match (group.body.guidance == GuidanceKind::Formation, &entry.robots, land) {
            (
                true,
                PlaneRobots {
                    formation: Some(formation), list: None, circle: None, cloud: None, scattered: None, ..
                },
                Some(land),
            ) => {
                let field = format!("{}.robots.formation", group.table);
                let (robots, formation) = super::robots::of_group(source, &field, formation, file, land)?;
                let mut members = starts::on_land(&robots, land);
                members.iter_mut().for_each(|start| start.group = Some(number));
                placing.starts.append(&mut members);
                let id = last.saturating_add(u32::try_from(before - cells.len()).unwrap_or(u32::MAX)).saturating_add(1);
                formations.push(formation.of(before, id));
            }
            (false, PlaneRobots { formation: None, .. }, land) => {
                placing.place(&group, Some(number), &entry.robots)?;
                if let Some(land) = land {
                    checks::in_cells(source, &group, land, &placing.starts[before..])?;
                }
            }
            _ => {
                let what = "guidance \"formation\" and robots.formation go together, without other robots";
                return Err(source.error(&group.field("guidance"), what, "give both or none of them"));
            }
        }
        parts.push(Part { table: group.table.clone(), members: before..placing.starts.len() });
    }
    parts.retain(|part| has_groups && !part.members.is_empty());
    group::grow_as_the_fastest(&mut general, &mut groups);
    let setup = PlaneSetup {
        general,
        groups,
        has_terrain: terrain.is_some(),
        torus_m: table.torus_m,
        solids,
        intruders: intruders(source, table)?,
        starts,
        orders: Vec::new(),
    };
    torus::check(source, file, table, &setup)?;
    checks::starts(source, &setup)?;
    checks::outside(source, &setup)?;
    let setup = PlaneSetup { orders: orders(source, file, table, &setup)?, ..setup };
    let robots = setup.robots(&cells, terrain);
    Ok(Placed { setup, robots, formations, parts })
}

fn intruders(source: &Source<'_>, table: &PlaneTable) -> Result<Vec<Intruder>, ScenarioError> {
    let mut intruders = Vec::new();
    for (index, entry) in table.intruder.iter().enumerate() {
        let field = |name| format!("plane.intruder[{index}].{name}");
        checks::place(source, &field("start_m"), entry.start_m)?;
        checks::velocity(source, &field("velocity_mps"), entry.velocity_mps)?;
        if entry.heard && source.has("authentication") {
            let remedy = "give heard = false, or leave [authentication] out";
            let what = "an intruder does not have the key, so robots reject its beacons";
            return Err(source.error(&field("heard"), what, remedy));
        }
        intruders.push(Intruder {
            position_m: entry.start_m.0,
            velocity_mps: entry.velocity_mps.0,
            radius_m: entry.radius_m,
            is_heard: entry.heard,
        });
    }
    Ok(intruders)
}

fn wall_with_door(
    source: &Source<'_>,
    field: &str,
    wall: &WallEntry,
    door_m: f64,
) -> Result<[Solid; 2], ScenarioError> {
    let [from, to] = wall.points_m[..] else {
        return Err(source.error(field, "only a wall of two points has a door", "give two points in points_m"));
    };
    let length_m = libm::hypot(to[0] - from[0], to[1] - from[1]);
    within(source, field, door_m, 0.0, length_m, "metres, the length of the wall")?;
    let at =
        |along_m: f64| [0, 1].map(|axis| (from[axis] + to[axis] + (to[axis] - from[axis]) / length_m * along_m) / 2.0);
    Ok([Solid::Wall([from, at(-door_m)]), Solid::Wall([at(door_m), to])])
}

fn solids(source: &Source<'_>, file: &ScenarioFile, table: &PlaneTable) -> Result<Vec<Solid>, ScenarioError> {
    let mut solids = Vec::new();
    for (index, wall) in table.wall.iter().enumerate() {
        let is_sound = wall.points_m.iter().flatten().all(|x| x.abs() <= table::FAR_M);
        if wall.points_m.len() < 2 || !is_sound {
            let field = format!("plane.wall[{index}].points_m");
            return Err(source.error(&field, "this is not a wall", "give two or more points in metres"));
        }
        if let Some(door_m) = wall.door_m {
            solids.extend(wall_with_door(source, &format!("plane.wall[{index}].door_m"), wall, door_m)?);
            continue;
        }
        let pairs = wall.points_m.windows(2).map(|pair| [pair[0], pair[1]]);
        solids.extend(pairs.map(Solid::Wall));
        if wall.closed {
            let ends = [wall.points_m[wall.points_m.len() - 1], wall.points_m[0]];
            solids.push(Solid::Wall(ends));
        }
    }
    for (index, ball) in table.ball.iter().enumerate() {
        let field = format!("plane.ball[{index}].center_m");
        checks::place(source, &field, ball.center_m)?;
        solids.push(Solid::Ball { center_m: ball.center_m.0, radius_m: ball.radius_m });
    }
    solids.extend(scattered::balls(source, &table.balls, file.seed)?);
    for (index, entry) in table.half_space.iter().enumerate() {
        let field = format!("plane.half_space[{index}].point_m");
        checks::place(source, &field, entry.point_m)?;
        let length = entry.normal.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            let field = format!("plane.half_space[{index}].normal");
            return Err(source.error(&field, "this is not a direction", "give a vector that is not zero"));
        }
        solids.push(Solid::Plane { point_m: entry.point_m.0, normal: entry.normal.0.map(|x| x / length) });
    }
    Ok(solids)
}

fn orders(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    setup: &PlaneSetup,
) -> Result<Vec<Order>, ScenarioError> {
    let mut guidances: Vec<_> = setup.kinds().map(|group| group.guidance.kind()).collect();
    guidances.dedup();
    let mut orders = Vec::new();
    for (index, order) in table.order.iter().enumerate() {
        if guidances.iter().all(|&guidance| order.goal >= checks::goals(guidance)) {
            let field = format!("plane.order[{index}].goal");
            let names: Vec<_> = guidances.iter().map(|guidance| format!("\"{}\"", guidance.name())).collect();
            let what = format!("robots with guidance {} have no goal {}", names.join(" or "), order.goal);
            let remedy = "give one that they have, from 0, or another guidance";
            return Err(source.error(&field, what, remedy));
        }
        checks::place(source, &format!("plane.order[{index}].place_m"), order.place_m)?;
        checks::velocity(source, &format!("plane.order[{index}].velocity_mps"), order.velocity_mps)?;
        orders.push(Order {
            tick: libm::ceil(order.at_s / file.tick_s) as u32,
            index: order.goal,
            target: Target { position_m: order.place_m.0, velocity_mps: order.velocity_mps.0 },
        });
    }
    orders.sort_by_key(|order| order.tick);
    Ok(orders)
}
