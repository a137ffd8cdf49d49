//! The static part of a run: the message `scene` of `PROTOCOL.md`.

mod bounds;

use crate::claims::Claim;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use bounds::bounds;
use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::names::Named;
use staya_controller::robot;
use staya_sim::scenario::Scenario;
use staya_sim::terrain::Terrain;
use staya_sim::words;
use staya_sim::world::plane::{self, Shape};

/// A fraction of a cell.
const GRID_RADIUS: f64 = 0.35;

/// The static part of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename = "scene")]
pub struct Scene {
    /// Name of the scenario.
    pub name: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Length of a tick, seconds.
    pub tick_s: f64,
    /// Largest number of ticks.
    pub ticks: u32,
    /// Motion of bodies.
    pub kind: Kind,
    /// Actions that a page offers.
    pub mode: Mode,
    /// Origin of all positions, metres.
    pub origin_m: [f64; 3],
    /// Initial view: west, south, east, north, metres.
    pub bounds_m: [f64; 4],
    /// Lowest and highest position of the initial view, metres.
    pub height_m: [f64; 2],
    /// One entry per robot, by number.
    pub robots: Robots,
    /// Initial colours of the robots.
    #[serde(default)]
    pub colour_by: ColourBy,
    /// Ratio of height to width of the space that flyers keep free because of their downwash; 1 in
    /// the plane and without downwash.
    #[serde(default = "no_downwash")]
    pub downwash: f64,
    /// The map, if there is one.
    pub land: Option<Land>,
    /// Obstacles.
    pub solids: Vec<Indexed>,
    /// Bodies that are not robots.
    pub intruders: Vec<Intruder>,
    /// Graph of the formation, if there is one.
    pub formation: Option<Formation>,
    /// Range and loss of the radio.
    pub radio: Radio,
    /// Parameters that can be changed during the run.
    pub parameters: Vec<Parameter>,
    /// Names of the numbers in frames.
    pub words: Words,
    /// Robots with a recorded mind, by index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub minds: Vec<usize>,
    /// The comment at the top of the scenario, its first paragraph; empty if there is none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// The claims of the paper's figure to which the scenario belongs; empty if there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub claims: Vec<Claim>,
}

/// Motion of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// From cell to cell.
    Grid,
    /// In the plane.
    Plane,
    /// In space.
    Space,
}

/// Actions that a page offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Watch and send orders.
    Live,
    /// Watch and seek.
    Recording,
    /// Watch only.
    Watch,
}

/// Meaning of the robots' colours, in the page and in pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColourBy {
    /// A colour for each group.
    Group,
    /// A colour for each robot.
    Robot,
    /// A colour for each mode.
    #[default]
    Mode,
}

impl ColourBy {
    /// Largest number of robots with individual colours: there are that many colours.
    pub const MOST_ROBOTS: usize = 7;

    /// Chooses the meaning for robots with these groups: few colours that differ.
    #[must_use]
    pub fn of(groups: &[u32]) -> Self {
        match groups {
            [first, ..] if groups.iter().any(|group| group != first) => Self::Group,
            _ if groups.len() <= Self::MOST_ROBOTS => Self::Robot,
            _ => Self::Mode,
        }
    }
}

const fn no_downwash() -> f64 {
    1.0
}

/// Properties of the robots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Robots {
    /// Numbers, rising.
    pub id: Vec<u32>,
    /// Radii, metres.
    pub radius_m: Vec<f64>,
    /// Largest speeds on easy ground, m/s.
    pub max_speed_mps: Vec<f64>,
    /// Groups in the order of the scenario from 1; 0 for no group.
    pub group: Vec<u32>,
}

/// A map of cells with different travel times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Land {
    /// Number of cells from west to east.
    pub width: u16,
    /// Number of cells from south to north.
    pub height: u16,
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// South-west corner, metres.
    pub origin_m: [f64; 2],
    /// Travel time of the slowest class, ticks.
    pub classes: u8,
    /// Base64, one byte per cell by rows from the south-west: 0 for a wall, else ticks to cross.
    pub cells: String,
}

/// An obstacle with its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Indexed {
    /// Number in orders.
    pub index: usize,
    /// Its shape.
    #[serde(flatten)]
    pub solid: Solid,
}

/// An obstacle, metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Solid {
    /// A shape that orders can also create.
    Shape(Shape),
    /// A half-space.
    HalfSpace(HalfSpace),
}

/// The half-space behind a plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename = "plane")]
pub struct HalfSpace {
    /// A point of the plane.
    pub point_m: [f64; 3],
    /// Unit vector out of the obstacle.
    pub normal: [f64; 3],
}

/// A body that is not a robot. Its position is in the frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intruder {
    /// Radius, metres.
    pub radius_m: f64,
    /// Whether it sends beacons.
    pub heard: bool,
}

/// The graph of a formation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Formation {
    /// Pairs of neighbours, by robot index.
    pub edges: Vec<[u32; 2]>,
}

/// Radio model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Radio {
    /// Range, metres; `None` for no limit.
    pub range_m: Option<f64>,
    /// Fraction of lost packets, 0 to 1.
    pub loss: f64,
}

/// A parameter that can be changed during the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub greatest: f64,
    /// Value of the first robot that has the parameter.
    pub value: Option<f64>,
    /// Description.
    pub what: String,
}

/// Names of the numbers in frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Words {
    /// Names of the modes.
    pub modes: Vec<String>,
    /// Names of the reasons to wait.
    pub waits: Vec<String>,
    /// By group and mode: what a robot does.
    #[serde(default)]
    pub does: Vec<Vec<String>>,
    /// By reason to wait: the reason as a clause.
    #[serde(default)]
    pub because: Vec<String>,
}

impl Words {
    /// The words of a scenario whose robots are in these groups. O(robots).
    fn new(scenario: &Scenario, groups: &[u32]) -> Self {
        let most = groups.iter().max().map_or(0, |last| *last as usize + 1);
        let mut does = vec![Vec::new(); most];
        for (index, group) in groups.iter().enumerate() {
            let does = &mut does[*group as usize];
            if does.is_empty() {
                let goals = scenario.law_of(index).goals();
                *does = robot::Mode::NAMES.iter().map(|(_, mode)| words::does(*mode, goals).to_owned()).collect();
            }
        }
        let because = Wait::NAMES.iter().map(|(_, wait)| words::because(*wait).to_owned());
        Self { modes: names::<robot::Mode>(), waits: names::<Wait>(), does, because: because.collect() }
    }
}

impl Scene {
    /// Creates the scene of a scenario before its first tick. O(robots + cells).
    #[must_use]
    pub fn new(scenario: &Scenario, mode: Mode) -> Self {
        let setup = scenario.plane();
        let has_land = setup.is_none_or(|setup| setup.has_terrain);
        let origin = origin_m(scenario);
        let (bounds_m, height_m) = bounds(scenario, origin);
        let robots = robots(scenario);
        let words = Words::new(scenario, &robots.group);
        Self {
            name: scenario.name.clone(),
            seed: scenario.seed,
            tick_s: scenario.tick_s(),
            ticks: scenario.ticks,
            kind: match setup {
                None => Kind::Grid,
                Some(_) if is_in_space(scenario) => Kind::Space,
                Some(_) => Kind::Plane,
            },
            mode,
            origin_m: origin,
            bounds_m,
            height_m,
            colour_by: ColourBy::of(&robots.group),
            robots,
            downwash: downwash(scenario),
            land: has_land.then(|| land(&scenario.land.terrain, origin)),
            solids: setup.map_or_else(Vec::new, |setup| solids(&setup.solids, is_in_space(scenario), origin)),
            intruders: setup.map_or(&[][..], |setup| &setup.intruders).iter().map(Intruder::from).collect(),
            formation: (!scenario.formations.is_empty())
                .then(|| Formation { edges: scenario.edges().map(|edge| edge.map(|at| at as u32)).collect() }),
            radio: Radio::of(scenario),
            parameters: Vec::new(),
            words,
            minds: Vec::new(),
            description: String::new(),
            claims: Vec::new(),
        }
    }
}

impl Radio {
    /// The radio at the start of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let radio = &scenario.radio;
        Self { range_m: Some(radio.range_m).filter(|range_m| range_m.is_finite()), loss: radio.loss }
    }
}

impl From<&staya_sim::scenario::Intruder> for Intruder {
    fn from(intruder: &staya_sim::scenario::Intruder) -> Self {
        Self { radius_m: intruder.radius_m, heard: intruder.is_heard }
    }
}

/// The description of a scenario: the first paragraph of the comment at the top of its text.
#[must_use]
pub fn description(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    comment.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

fn names<T: Named>() -> Vec<String> {
    T::NAMES.iter().map(|(name, _)| (*name).to_owned()).collect()
}

/// Origin of a scenario's scene and frames, metres: near enough to the bodies for `f32`.
#[must_use]
pub fn origin_m(scenario: &Scenario) -> [f64; 3] {
    match scenario.plane() {
        Some(setup) if !setup.has_terrain => {
            // Coordinates of the scenario stay unchanged unless that would cost precision.
            let far = setup.starts.iter().flat_map(|start| start.position_m).fold(0.0, |far: f64, x| far.max(x.abs()));
            match setup.starts.first() {
                Some(start) if far > 1e4 => start.position_m.map(libm::round),
                _ => [0.0; 3],
            }
        }
        _ => [scenario.land.terrain.origin_m[0], scenario.land.terrain.origin_m[1], 0.0],
    }
}

/// Whether bodies of a scenario have heights.
#[must_use]
pub fn is_in_space(scenario: &Scenario) -> bool {
    scenario.plane().is_some_and(|setup| {
        let starts = setup.starts.iter();
        let moves = starts.clone().map(|start| (start.position_m, start.velocity_mps));
        let goals = starts.flat_map(|start| &start.places).chain(setup.orders.iter().map(|order| &order.target));
        let goals = goals.map(|target| (target.position_m, target.velocity_mps));
        let intruders = setup.intruders.iter().map(|intruder| (intruder.position_m, intruder.velocity_mps));
        let mut all = moves.chain(goals).chain(intruders);
        all.any(|(at, by)| at[2] != 0.0 || by[2] != 0.0)
    })
}

/// The group of robot `index`, in the order of the scenario from 1; 0 for no group.
#[must_use]
pub fn group(scenario: &Scenario, index: usize) -> u32 {
    let group = scenario.plane().and_then(|setup| setup.starts.get(index)?.group);
    group.map_or(0, |group| group as u32 + 1)
}

/// Largest [`Scene::downwash`] of the robots.
#[must_use]
pub fn downwash(scenario: &Scenario) -> f64 {
    scenario.plane().into_iter().flat_map(|setup| setup.kinds()).map(|group| group.downwash()).fold(1.0, f64::max)
}

/// The map relative to `origin_m`.
#[must_use]
pub fn land(terrain: &Terrain, origin_m: [f64; 3]) -> Land {
    Land {
        width: terrain.width(),
        height: terrain.height(),
        cell_m: terrain.cell_m,
        origin_m: [0, 1].map(|axis| terrain.origin_m[axis] - origin_m[axis]),
        classes: terrain.cells().iter().copied().max().unwrap_or(0),
        cells: BASE64_STANDARD.encode(terrain.cells()),
    }
}

/// Obstacles relative to `origin_m`. In the plane balls become discs.
#[must_use]
pub fn solids(solids: &[plane::Solid], is_in_space: bool, origin_m: [f64; 3]) -> Vec<Indexed> {
    let flat = |at: [f64; 2]| [at[0] - origin_m[0], at[1] - origin_m[1]];
    let near = |at: [f64; 3]| [0, 1, 2].map(|axis| at[axis] - origin_m[axis]);
    let shape = |solid: &plane::Solid| match *solid {
        plane::Solid::Wall([from, to]) => Solid::Shape(Shape::Segment { from_m: flat(from), to_m: flat(to) }),
        plane::Solid::Ball { center_m, radius_m } if is_in_space => {
            Solid::Shape(Shape::Ball { center_m: near(center_m), radius_m })
        }
        plane::Solid::Ball { center_m: [x, y, _], radius_m } => {
            Solid::Shape(Shape::Circle { center_m: flat([x, y]), radius_m })
        }
        plane::Solid::Plane { point_m, normal } => Solid::HalfSpace(HalfSpace { point_m: near(point_m), normal }),
    };
    solids.iter().enumerate().map(|(index, solid)| Indexed { index, solid: shape(solid) }).collect()
}

/// The radius of robot `index`, metres; on the grid a fraction of a cell.
#[must_use]
pub fn radius_m(scenario: &Scenario, index: usize) -> f64 {
    match scenario.plane() {
        Some(setup) => setup.group(index).radius_m,
        None => scenario.land.terrain.cell_m * GRID_RADIUS,
    }
}

fn robots(scenario: &Scenario) -> Robots {
    let mut robots = Robots::default();
    for (index, robot) in scenario.robots.iter().enumerate() {
        robots.id.push(robot.id.0);
        robots.radius_m.push(radius_m(scenario, index));
        robots.max_speed_mps.push(match scenario.plane() {
            Some(setup) => setup.group(index).abilities.max_speed_mps,
            None => scenario.land.terrain.cell_m / scenario.tick_s(),
        });
        robots.group.push(group(scenario, index));
    }
    robots
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::scenario::Overrides;
    use std::path::Path;

    fn scene(name: &str) -> Scene {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
        Scene::new(&Scenario::load(&path, &Overrides::default()).unwrap(), Mode::Recording)
    }

    #[test]
    fn scenes_round_trip_as_json() {
        for (name, kind) in [
            ("six-robots.toml", Kind::Grid),
            ("twenty-discs.toml", Kind::Plane),
            ("doorway.toml", Kind::Plane),
            ("downwash.toml", Kind::Space),
            ("mixed.toml", Kind::Plane),
        ] {
            let scene = scene(name);
            assert_eq!(scene.kind, kind, "{name}");
            let text = serde_json::to_string(&scene).unwrap();
            let json: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert_eq!((&json["type"], &json["mode"]), (&"scene".into(), &"recording".into()));
            assert_eq!(serde_json::from_str::<Scene>(&text).unwrap(), scene, "{name}");
            let [west, south, east, north] = scene.bounds_m;
            assert!(west < east && south < north, "{name}");
            let robots = scene.robots.id.len();
            assert!(robots > 0 && scene.robots.radius_m.len() == robots && scene.robots.group.len() == robots);
        }
    }

    #[test]
    fn robots_have_few_colours_and_flyers_their_downwash() {
        for (name, by, downwash) in [
            ("six-robots.toml", ColourBy::Robot, 1.0),
            ("ten-robots.toml", ColourBy::Mode, 1.0),
            ("mixed.toml", ColourBy::Group, 1.0),
            ("downwash.toml", ColourBy::Mode, 3.0),
        ] {
            let scene = scene(name);
            assert_eq!((scene.colour_by, scene.downwash), (by, downwash), "{name}");
        }
        assert_eq!(ColourBy::of(&[2; 8]), ColourBy::Mode, "one group for all robots does not tell them apart");
    }

    #[test]
    fn the_description_is_the_first_paragraph_of_the_comment() {
        assert_eq!(description("# Two robots\n# meet.\n#\n# Fields: see there.\nname = \"t\"\n"), "Two robots meet.");
        assert_eq!(description("name = \"t\"\n# Not this.\n"), "");
    }

    #[test]
    fn scenes_contain_map_obstacles_and_formation() {
        let six = scene("six-robots.toml");
        let land = six.land.unwrap();
        let cells = BASE64_STANDARD.decode(&land.cells).unwrap();
        assert_eq!(cells.len(), usize::from(land.width) * usize::from(land.height));
        assert_eq!(land.origin_m, [0.0; 2]);
        assert!(!six.formation.unwrap().edges.is_empty());
        let door = scene("doorway.toml");
        assert!(door.land.is_none() && !door.solids.is_empty());
        let text = serde_json::to_value(&door.solids[0]).unwrap();
        assert!(text["kind"].is_string() && text["index"] == 0, "{text}");
    }
}
