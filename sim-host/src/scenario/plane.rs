//! `[plane]`: robots that move in the plane or in space, and how they choose their velocities.

use super::check::within;
use super::source::Source;
use super::{Robot, ScenarioError, ScenarioFile};
use crate::terrain::Terrain;
use crate::world::plane::{Abilities, Solid};
use serde::Deserialize;
use staya_controller::grid::Cell;
use staya_controller::neighbor::Doubt;
use staya_controller::orca::AvoidParams;
use staya_controller::rand::Rng;
use staya_controller::wire::RobotId;

/// Keep the draws of this module apart from all others.
const STARTS: u32 = 0x0053_0003;

/// Robots that a plane can hold.
const MAX_ROBOTS: u32 = 1_000_000;

/// `[plane]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneTable {
    /// Radius of each body, metres.
    pub radius_m: f64,
    /// Highest speed on easy land, m/s.
    pub max_speed_mps: f64,
    /// Highest acceleration, m/s^2. Default: no limit.
    #[serde(default = "infinite")]
    pub max_acceleration_mps2: f64,
    /// Speed that robots like to go, m/s. Default: the highest.
    pub cruise_mps: Option<f64>,
    /// How near to a goal counts as being there, metres. Default: a tenth of the radius.
    pub tolerance_m: Option<f64>,
    /// How far robots see obstacles, metres. Default: 10.
    #[serde(default = "ten")]
    pub sight_m: f64,
    /// Where they want to go.
    #[serde(default)]
    pub guidance: GuidanceName,
    /// What keeps them apart.
    #[serde(default)]
    pub safety: SafetyName,
    /// Who takes part, unless the top-level `robots` says it in cells.
    pub robots: Option<PlaneRobots>,
    /// Walls: chains of points.
    #[serde(default)]
    pub wall: Vec<WallEntry>,
    /// Balls (in the plane: discs).
    #[serde(default)]
    pub ball: Vec<BallEntry>,
    /// Half-spaces.
    #[serde(default)]
    pub half_space: Vec<HalfSpaceEntry>,
    /// Parameters of ORCA.
    #[serde(default)]
    pub orca: OrcaTable,
    /// What moves during the run: goals that an operator sends.
    #[serde(default)]
    pub order: Vec<OrderEntry>,
}

const fn infinite() -> f64 {
    f64::INFINITY
}

const fn ten() -> f64 {
    10.0
}

/// `plane.guidance`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GuidanceName {
    /// Straight to the goal.
    #[default]
    Waypoint,
    /// By the grid's windowed routing (KUZ), from cell to cell; needs `[terrain]`.
    Route,
    /// As `route`, keeping a formation; needs `robots.formation`.
    Formation,
}

impl GuidanceName {
    /// Whether it goes from cell to cell.
    #[must_use]
    pub const fn is_on_grid(self) -> bool {
        matches!(self, Self::Route | Self::Formation)
    }
}

/// `plane.safety`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SafetyName {
    /// Nothing.
    None,
    /// ORCA with exact half-planes.
    #[default]
    Orca,
}

/// `[plane.robots]`: exactly one of these.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneRobots {
    /// Each robot by itself.
    pub list: Option<Vec<PlaneRobotEntry>>,
    /// Robots evenly on a circle, each with its goal on the opposite side.
    pub circle: Option<CircleEntry>,
    /// Robots at random places, all with the same goals.
    pub cloud: Option<CloudEntry>,
}

/// One robot of `plane.robots.list`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneRobotEntry {
    /// Where it starts: x, y, z in metres.
    pub start_m: Place,
    /// Where it should go. Without it, it stays where guidance leaves it.
    pub goal_m: Option<Place>,
    /// How fast it is at the start. Default: at rest.
    #[serde(default)]
    pub velocity_mps: Place,
}

/// `[x, y]` or `[x, y, z]`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(from = "PlaceEntry")]
pub struct Place(pub [f64; 3]);

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected [x, y] or [x, y, z]")]
enum PlaceEntry {
    Flat([f64; 2]),
    Full([f64; 3]),
}

impl From<PlaceEntry> for Place {
    fn from(entry: PlaceEntry) -> Self {
        match entry {
            PlaceEntry::Flat([x, y]) => Self([x, y, 0.0]),
            PlaceEntry::Full(place) => Self(place),
        }
    }
}

/// `plane.robots.circle`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CircleEntry {
    /// How many.
    pub count: u32,
    /// Radius of the circle around the origin, metres.
    pub radius_m: f64,
    /// Each start is off by up to this along both axes, metres. Default: 0, the exact circle.
    #[serde(default)]
    pub noise_m: f64,
}

/// `plane.robots.cloud`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CloudEntry {
    /// How many.
    pub count: u32,
    /// Starts are drawn evenly between these corners, metres, and again while they overlap others.
    pub from_m: Place,
    /// See `from_m`.
    pub to_m: Place,
    /// Velocities at the start are drawn evenly between these corners, m/s. Default: at rest.
    #[serde(default)]
    pub velocity_from_mps: Place,
    /// See `velocity_from_mps`.
    #[serde(default)]
    pub velocity_to_mps: Place,
    /// Goals of all.
    #[serde(default)]
    pub goals_m: Vec<Place>,
    /// Velocity of the goals, m/s. Default: they stay.
    #[serde(default)]
    pub goal_velocity_mps: Place,
}

/// `[[plane.wall]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallEntry {
    /// Two or more points, each joined to the next.
    pub points_m: Vec<[f64; 2]>,
    /// Whether the last is joined to the first: a polygon. Default: false.
    #[serde(default)]
    pub closed: bool,
}

/// `[[plane.ball]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallEntry {
    /// Its centre.
    pub center_m: Place,
    /// Its radius, metres.
    pub radius_m: f64,
}

/// `[[plane.half_space]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpaceEntry {
    /// A point of its border.
    pub point_m: Place,
    /// A vector out of it, of any length.
    pub normal: Place,
}

/// `[[plane.order]]`: a goal that moves.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrderEntry {
    /// When, seconds after the start.
    pub at_s: f64,
    /// Which of the goals, from 0. Default: 0.
    #[serde(default)]
    pub goal: u8,
    /// Where to.
    pub place_m: Place,
    /// And on from there, m/s. Default: it stays.
    #[serde(default)]
    pub velocity_mps: Place,
}

/// `[plane.orca]`. All fields are optional; the defaults are the controller's.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OrcaTable {
    /// Time ahead in which robots must not meet, seconds.
    pub horizon_s: Option<f64>,
    /// Time ahead in which a robot must not meet an obstacle, seconds.
    pub wall_horizon_s: Option<f64>,
    /// Own share of a correction.
    pub share: Option<f64>,
    /// Distance kept on top of the radii, metres.
    pub margin_m: Option<f64>,
    /// How fast the ball around a silent robot grows, m/s. Default: half the highest speed.
    pub doubt_mps: Option<f64>,
    /// How much it grows at most, metres. Default: the radius.
    pub doubt_m: Option<f64>,
}

/// Where a robot starts and what it is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// World position, metres.
    pub position_m: [f64; 3],
    /// World velocity, m/s.
    pub velocity_mps: [f64; 3],
    /// The places it is told to go to.
    pub places: Vec<Target>,
}

/// A place to go to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Where it is at the start of the run, or of an order, metres.
    pub position_m: [f64; 3],
    /// How it moves, m/s.
    pub velocity_mps: [f64; 3],
}

/// An operator's order to all robots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// The tick in which it arrives.
    pub tick: u32,
    /// Which of the goals.
    pub index: u8,
    /// The goal.
    pub target: Target,
}

/// A checked `[plane]`.
#[derive(Clone, Debug)]
pub struct PlaneSetup {
    /// What bodies can do.
    pub abilities: Abilities,
    /// Radius of each body, metres.
    pub radius_m: f64,
    /// Speed that robots like to go, m/s.
    pub cruise_mps: f64,
    /// How near to a goal counts as being there, metres.
    pub tolerance_m: f64,
    /// How far robots see obstacles, metres.
    pub sight_m: f64,
    /// Whether there is land under the bodies.
    pub has_terrain: bool,
    /// What does not move.
    pub solids: Vec<Solid>,
    /// By robot.
    pub starts: Vec<Start>,
    /// Where they want to go.
    pub guidance: GuidanceName,
    /// What keeps them apart.
    pub safety: SafetyName,
    /// Parameters of ORCA.
    pub orca: AvoidParams<f32>,
    /// How silent robots are seen.
    pub doubt: Doubt<f32>,
    /// By rising tick.
    pub orders: Vec<Order>,
}

/// Checks the table and places the robots; `cells` are those that the top-level `robots` gives.
pub(super) fn build(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    terrain: Option<&Terrain>,
    cells: Option<&[Robot]>,
) -> Result<(PlaneSetup, Vec<Robot>), ScenarioError> {
    let far = 2_000_000.0;
    for (field, value, low, high, unit) in [
        ("plane.radius_m", table.radius_m, 0.001, 65.0, "metres"),
        ("plane.max_speed_mps", table.max_speed_mps, 0.001, 32.0, "m/s"),
        ("plane.sight_m", table.sight_m, 0.0, far, "metres"),
    ] {
        within(source, field, value, low, high, unit)?;
    }
    if table.max_acceleration_mps2.is_nan() || table.max_acceleration_mps2 <= 0.0 {
        let what = format!("{} is no acceleration", table.max_acceleration_mps2);
        let remedy = "give more than 0, in m/s^2, or inf";
        return Err(source.error("plane.max_acceleration_mps2", what, remedy));
    }
    let cruise_mps = table.cruise_mps.unwrap_or(table.max_speed_mps);
    within(source, "plane.cruise_mps", cruise_mps, 0.0, table.max_speed_mps, "m/s")?;
    let tolerance_m = table.tolerance_m.unwrap_or(table.radius_m / 10.0);
    within(source, "plane.tolerance_m", tolerance_m, 0.001, far, "metres")?;
    if table.guidance.is_on_grid() && (terrain.is_none() || cells.is_none()) {
        return Err(source.error(
            "plane.guidance",
            "this guidance goes from cell to cell",
            "give [terrain] and the top-level [robots], or another guidance",
        ));
    }
    if (table.guidance == GuidanceName::Formation) != file.in_formation() {
        return Err(source.error(
            "plane.guidance",
            "robots.formation and guidance \"formation\" go together",
            "give both or none of them",
        ));
    }
    let starts = match (cells, &table.robots) {
        (Some(robots), None) => {
            let terrain = terrain.expect("cells have been checked against the land");
            on_land(robots, terrain)
        }
        (None, Some(robots)) => placed(source, file.seed, table, robots)?,
        _ => {
            return Err(source.error(
                "plane.robots",
                "it is not clear who takes part",
                "give either plane.robots in metres or the top-level robots in cells",
            ));
        }
    };
    for (index, start) in starts.iter().enumerate() {
        let places = start.places.iter().map(|target| target.position_m);
        for place in places.chain([start.position_m]) {
            if !place.iter().all(|x| x.abs() <= far) {
                let what = format!("robot {} starts or goes too far away", index + 1);
                let remedy = "stay within 2000 km of the origin";
                return Err(source.error("plane.robots", what, remedy));
            }
        }
    }
    let robots = match cells {
        Some(robots) => robots.to_vec(),
        None => (1..=starts.len() as u32)
            .map(|id| Robot {
                id: RobotId(id),
                start: Cell::default(),
                goal: Cell::default(),
            })
            .collect(),
    };
    let setup = PlaneSetup {
        abilities: Abilities {
            max_speed_mps: table.max_speed_mps,
            max_acceleration_mps2: table.max_acceleration_mps2,
            step_s: f64::from(super::check::micros(file.tick_s)) / 1e6,
        },
        radius_m: table.radius_m,
        cruise_mps,
        tolerance_m,
        sight_m: table.sight_m,
        has_terrain: terrain.is_some(),
        solids: solids(source, table)?,
        starts,
        guidance: table.guidance,
        safety: table.safety,
        orca: orca(source, &table.orca)?,
        doubt: doubt(source, table)?,
        orders: orders(source, file, table)?,
    };
    Ok((setup, robots))
}

/// Robots of the grid, in the middles of their cells.
fn on_land(robots: &[Robot], terrain: &Terrain) -> Vec<Start> {
    let center = |cell: Cell| {
        let at = |cells: i16, axis: usize| {
            terrain.origin_m[axis] + (f64::from(cells) + 0.5) * terrain.cell_m
        };
        [at(cell.x, 0), at(cell.y, 1), 0.0]
    };
    let start = |robot: &Robot| Start {
        position_m: center(robot.start),
        velocity_mps: [0.0; 3],
        places: vec![Target {
            position_m: center(robot.goal),
            velocity_mps: [0.0; 3],
        }],
    };
    robots.iter().map(start).collect()
}

fn placed(
    source: &Source<'_>,
    seed: u64,
    table: &PlaneTable,
    robots: &PlaneRobots,
) -> Result<Vec<Start>, ScenarioError> {
    let fixed = |place: Place| Target {
        position_m: place.0,
        velocity_mps: [0.0; 3],
    };
    let starts = match (&robots.list, &robots.circle, &robots.cloud) {
        (Some(list), None, None) => list
            .iter()
            .map(|entry| Start {
                position_m: entry.start_m.0,
                velocity_mps: entry.velocity_mps.0,
                places: entry.goal_m.into_iter().map(fixed).collect(),
            })
            .collect(),
        (None, Some(circle), None) => {
            count(source, "plane.robots.circle.count", circle.count)?;
            let field = "plane.robots.circle.radius_m";
            within(source, field, circle.radius_m, 0.001, 1e6, "metres")?;
            let field = "plane.robots.circle.noise_m";
            within(source, field, circle.noise_m, 0.0, 1e6, "metres")?;
            circle_starts(circle.count, circle.radius_m, circle.noise_m, seed)
        }
        (None, None, Some(cloud)) => {
            count(source, "plane.robots.cloud.count", cloud.count)?;
            cloud_starts(cloud, table.radius_m, seed).ok_or_else(|| {
                source.error(
                    "plane.robots.cloud",
                    "the robots find no room between the corners",
                    "give fewer robots or corners farther apart",
                )
            })?
        }
        _ => {
            return Err(source.error(
                "plane.robots",
                "it is not clear who takes part",
                "give exactly one of list, circle, cloud",
            ));
        }
    };
    Ok(starts)
}

fn count(source: &Source<'_>, field: &str, count: u32) -> Result<(), ScenarioError> {
    if (1..=MAX_ROBOTS).contains(&count) {
        return Ok(());
    }
    let remedy = format!("give 1 to {MAX_ROBOTS}");
    Err(source.error(field, format!("{count} robots are no swarm"), remedy))
}

/// Evenly on the circle from the east on, each with its goal on the opposite side of its own start; `noise_m` moves the starts, and
/// the goals stay exact.
#[must_use]
pub fn circle_starts(count: u32, radius_m: f64, noise_m: f64, seed: u64) -> Vec<Start> {
    (0..count)
        .map(|index| {
            let angle = 2.0 * std::f64::consts::PI * f64::from(index) / f64::from(count);
            let [x, y] = [libm::cos(angle) * radius_m, libm::sin(angle) * radius_m];
            let mut rng = Rng::keyed(seed, STARTS, index, 0);
            let mut noise = || (2.0 * unit(&mut rng) - 1.0) * noise_m;
            Start {
                position_m: [x + noise(), y + noise(), 0.0],
                velocity_mps: [0.0; 3],
                places: vec![Target {
                    position_m: [-x, -y, 0.0],
                    velocity_mps: [0.0; 3],
                }],
            }
        })
        .collect()
}

/// Evenly on [0, 1).
fn unit(rng: &mut Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Draws of a place before the cloud is refused as too crowded.
const TRIES: u32 = 1000;

/// Evenly between the corners without overlaps; `None` when there is no room.
fn cloud_starts(cloud: &CloudEntry, radius_m: f64, seed: u64) -> Option<Vec<Start>> {
    let between = |rng: &mut Rng, from: Place, to: Place| {
        let mut place = [0.0; 3];
        for (axis, place) in place.iter_mut().enumerate() {
            *place = from.0[axis] + (to.0[axis] - from.0[axis]) * unit(rng);
        }
        place
    };
    let places: Vec<_> = cloud
        .goals_m
        .iter()
        .map(|goal| Target {
            position_m: goal.0,
            velocity_mps: cloud.goal_velocity_mps.0,
        })
        .collect();
    let mut taken = std::collections::HashMap::<[i64; 3], Vec<[f64; 3]>>::new();
    let bucket = |place: [f64; 3]| place.map(|x| libm::floor(x / (2.0 * radius_m)) as i64);
    let is_free = |taken: &std::collections::HashMap<[i64; 3], Vec<[f64; 3]>>, place: [f64; 3]| {
        let [x, y, z] = bucket(place);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy)));
        let around = around.flat_map(|(dx, dy)| (-1..=1).map(move |dz| [x + dx, y + dy, z + dz]));
        let mut near = around.filter_map(|at| taken.get(&at)).flatten();
        !near.any(|other| {
            let squared: f64 = (0..3).map(|i| (place[i] - other[i]) * (place[i] - other[i])).sum();
            squared < 4.0 * radius_m * radius_m
        })
    };
    (0..cloud.count)
        .map(|index| {
            let mut rng = Rng::keyed(seed, STARTS, index, 1);
            let position_m = (0..TRIES)
                .map(|_| between(&mut rng, cloud.from_m, cloud.to_m))
                .find(|&place| is_free(&taken, place))?;
            taken.entry(bucket(position_m)).or_default().push(position_m);
            let (from, to) = (cloud.velocity_from_mps, cloud.velocity_to_mps);
            Some(Start {
                position_m,
                velocity_mps: between(&mut rng, from, to),
                places: places.clone(),
            })
        })
        .collect()
}

fn solids(source: &Source<'_>, table: &PlaneTable) -> Result<Vec<Solid>, ScenarioError> {
    let mut solids = Vec::new();
    for (index, wall) in table.wall.iter().enumerate() {
        let is_sound = wall.points_m.iter().flatten().all(|x| x.is_finite());
        if wall.points_m.len() < 2 || !is_sound {
            let field = format!("plane.wall[{index}].points_m");
            return Err(source.error(&field, "this is no wall", "give two or more points in metres"));
        }
        let pairs = wall.points_m.windows(2).map(|pair| [pair[0], pair[1]]);
        solids.extend(pairs.map(Solid::Wall));
        if wall.closed {
            let ends = [wall.points_m[wall.points_m.len() - 1], wall.points_m[0]];
            solids.push(Solid::Wall(ends));
        }
    }
    for (index, ball) in table.ball.iter().enumerate() {
        let field = format!("plane.ball[{index}].radius_m");
        within(source, &field, ball.radius_m, 0.001, 1e6, "metres")?;
        solids.push(Solid::Ball {
            center_m: ball.center_m.0,
            radius_m: ball.radius_m,
        });
    }
    for (index, entry) in table.half_space.iter().enumerate() {
        let length = entry.normal.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            let field = format!("plane.half_space[{index}].normal");
            return Err(source.error(&field, "this is no direction", "give a vector that is not zero"));
        }
        solids.push(Solid::Plane {
            point_m: entry.point_m.0,
            normal: entry.normal.0.map(|x| x / length),
        });
    }
    Ok(solids)
}

fn orca(source: &Source<'_>, table: &OrcaTable) -> Result<AvoidParams<f32>, ScenarioError> {
    let mut params = AvoidParams::<f32>::default();
    for (field, value, low, high, unit, param) in [
        ("horizon_s", table.horizon_s, 0.01, 60.0, "seconds", &mut params.horizon_s),
        ("wall_horizon_s", table.wall_horizon_s, 0.01, 60.0, "seconds", &mut params.wall_horizon_s),
        ("share", table.share, 0.0, 1.0, "", &mut params.share),
        ("margin_m", table.margin_m, 0.0, 10.0, "metres", &mut params.margin_m),
    ] {
        if let Some(value) = value {
            within(source, &format!("plane.orca.{field}"), value, low, high, unit)?;
            *param = value as f32;
        }
    }
    Ok(params)
}

fn doubt(source: &Source<'_>, table: &PlaneTable) -> Result<Doubt<f32>, ScenarioError> {
    let growth_mps = table.orca.doubt_mps.unwrap_or(table.max_speed_mps / 2.0);
    let most_m = table.orca.doubt_m.unwrap_or(table.radius_m);
    within(source, "plane.orca.doubt_mps", growth_mps, 0.0, 1000.0, "m/s")?;
    within(source, "plane.orca.doubt_m", most_m, 0.0, 1000.0, "metres")?;
    Ok(Doubt {
        growth_mps: growth_mps as f32,
        most_m: most_m as f32,
    })
}

fn orders(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
) -> Result<Vec<Order>, ScenarioError> {
    let mut orders = Vec::new();
    for (index, order) in table.order.iter().enumerate() {
        let field = format!("plane.order[{index}].at_s");
        within(source, &field, order.at_s, 0.0, 1e9, "seconds")?;
        if order.goal > 3 {
            let field = format!("plane.order[{index}].goal");
            return Err(source.error(&field, "robots have goals 0 to 3", "give one of them"));
        }
        orders.push(Order {
            tick: libm::ceil(order.at_s / file.tick_s) as u32,
            index: order.goal,
            target: Target {
                position_m: order.place_m.0,
                velocity_mps: order.velocity_mps.0,
            },
        });
    }
    orders.sort_by_key(|order| order.tick);
    Ok(orders)
}
