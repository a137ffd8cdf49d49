//! `[plane]`: robots that move in the plane or in space, and how they choose their velocities.

mod checks;
mod flocks;
mod starts;
mod table;

pub(super) use flocks::remark;

#[cfg(test)]
mod tests;

pub use starts::{Start, Target, circle_starts};
pub use table::*;

use super::ranges::within;
use super::source::Source;
use super::{Robot, Scenario, ScenarioError, ScenarioFile, params};
use crate::radio::RadioParams;
use crate::terrain::Terrain;
use crate::world::MoveRules;
use crate::world::plane::{Abilities, Solid};
use staya_controller::agent::{AnyHalfPlanes, GuidanceKind, GuidanceSetup, RouteSetup, SafetyKind, SafetySetup};
use staya_controller::formation::FormationParams;
use staya_controller::grid::Cell;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::{Evasion, PushOutParams};
use staya_controller::robot::RobotId;
use staya_controller::template::Template;

/// Robots that a plane can hold.
const MAX_ROBOTS: u32 = 1_000_000;

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
    pub guidance: GuidanceSetup,
    /// What keeps them apart.
    pub safety: SafetySetup,
    /// By rising tick.
    pub orders: Vec<Order>,
}

impl PlaneSetup {
    /// Robots of `radius_m` at their starts, without land and obstacles, that go straight to their first places behind ORCA:
    /// what a `[plane]` with nothing but the required fields says.
    #[must_use]
    pub fn new(abilities: Abilities, radius_m: f64, starts: Vec<Start>) -> Self {
        let (cruise_mps, tolerance_m) = (abilities.max_speed_mps, radius_m / 10.0);
        let inflation = inflation(cruise_mps, radius_m);
        Self {
            abilities,
            radius_m,
            cruise_mps,
            tolerance_m,
            sight_m: ten(),
            has_terrain: false,
            solids: Vec::new(),
            starts,
            guidance: waypoint(cruise_mps, tolerance_m),
            safety: SafetySetup::Orca { params: AvoidParams::default(), inflation, source: AnyHalfPlanes::Analytic },
            orders: Vec::new(),
        }
    }

    /// The same robots, which go straight to places and count as being there at this distance, metres.
    #[must_use]
    pub fn to_places(mut self, tolerance_m: f64) -> Self {
        self.tolerance_m = tolerance_m;
        self.guidance = waypoint(self.cruise_mps, tolerance_m);
        self
    }

    /// The same robots behind a safety layer with those of the parameters that it has a use for; silent robots grow as
    /// usual.
    #[must_use]
    pub fn behind(mut self, safety: SafetyKind, orca: AvoidParams<f32>, push_out: PushOutParams<f32>) -> Self {
        self.safety = safety.setup(orca, inflation(self.abilities.max_speed_mps, self.radius_m), push_out);
        self
    }

    /// Numbers for the robots: 1, 2, 3, ... in the order of their starts; their cells mean nothing.
    fn robots(&self) -> Vec<Robot> {
        let ids = 1..=self.starts.len() as u32;
        let robot = |id| Robot { id: RobotId(id), start: Cell::default(), goal: Cell::default() };
        ids.map(robot).collect()
    }
}

/// Straight to places.
const fn waypoint(cruise_mps: f64, tolerance_m: f64) -> GuidanceSetup {
    GuidanceSetup::Waypoint { speed_mps: cruise_mps as f32, tolerance_m: tolerance_m as f32 }
}

/// How silent robots grow unless a file says otherwise: by half the highest speed, up to the radius.
const fn inflation(max_speed_mps: f64, radius_m: f64) -> StalenessInflation<f32> {
    StalenessInflation { growth_mps: (max_speed_mps / 2.0) as f32, max_m: radius_m as f32 }
}

impl Scenario {
    /// A scenario in the plane that no file says: `ticks` of `setup.abilities.step_s`, with a radio. Robots are numbered
    /// from 1 in the order of their starts.
    #[must_use]
    pub fn in_plane(name: &str, seed: u64, ticks: u32, radio: RadioParams, setup: PlaneSetup) -> Self {
        Self {
            name: name.to_owned(),
            seed,
            ticks,
            tick_us: super::ranges::micros(setup.abilities.step_s),
            terrain: Terrain::flat(1, 1),
            rules: MoveRules::default(),
            radio,
            robots: setup.robots(),
            formation: None,
            plane: Some(setup),
            route: RouteSetup::default(),
            formation_params: FormationParams::default(),
            faults: Vec::new(),
            key: None,
            key_remark: None,
            attacks: Vec::new(),
        }
    }
}

/// Checks the table and places the robots; `cells` are those that the top-level `robots` gives.
pub(super) fn build(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    terrain: Option<&Terrain>,
    cells: Option<&[Robot]>,
) -> Result<(PlaneSetup, Vec<Robot>), ScenarioError> {
    let far = checks::FAR_M;
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
    within(source, "plane.cruise_mps", cruise_mps, 0.001_f64.min(table.max_speed_mps), table.max_speed_mps, "m/s")?;
    let tolerance_m = table.tolerance_m.unwrap_or(table.radius_m / 10.0);
    within(source, "plane.tolerance_m", tolerance_m, 0.001, far, "metres")?;
    if table.guidance.is_on_grid() && (terrain.is_none() || cells.is_none()) {
        return Err(source.error(
            "plane.guidance",
            "this guidance goes from cell to cell",
            "give [terrain] and the top-level [robots], or another guidance",
        ));
    }
    if (table.guidance == GuidanceKind::Formation) != file.in_formation() {
        return Err(source.error(
            "plane.guidance",
            "robots.formation and guidance \"formation\" go together",
            "give both or none of them",
        ));
    }
    let starts = match (cells, &table.robots) {
        (Some(robots), None) => {
            let terrain = terrain.expect("cells have been checked against the land");
            starts::on_land(robots, terrain)
        }
        (None, Some(robots)) => starts::placed(source, file.seed, table, robots)?,
        _ => {
            return Err(source.error(
                "plane.robots",
                "it is not clear who takes part",
                "give either plane.robots in metres or the top-level robots in cells",
            ));
        }
    };
    checks::starts(source, &starts, table.radius_m)?;
    let setup = PlaneSetup {
        abilities: Abilities {
            max_speed_mps: table.max_speed_mps,
            max_acceleration_mps2: table.max_acceleration_mps2,
            step_s: f64::from(super::ranges::micros(file.tick_s)) / 1e6,
        },
        radius_m: table.radius_m,
        cruise_mps,
        tolerance_m,
        sight_m: table.sight_m,
        has_terrain: terrain.is_some(),
        solids: solids(source, table)?,
        starts,
        safety: safety(source, table)?,
        guidance: guidance(source, file, table, cruise_mps, tolerance_m)?,
        orders: orders(source, file, table)?,
    };
    checks::outside(source, &setup)?;
    checks::safety_tables(source, table)?;
    let robots = cells.map_or_else(|| setup.robots(), <[Robot]>::to_vec);
    Ok((setup, robots))
}

fn solids(source: &Source<'_>, table: &PlaneTable) -> Result<Vec<Solid>, ScenarioError> {
    let mut solids = Vec::new();
    for (index, wall) in table.wall.iter().enumerate() {
        let is_sound = wall.points_m.iter().flatten().all(|x| x.abs() <= checks::FAR_M);
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
        let field = format!("plane.ball[{index}].center_m");
        checks::place(source, &field, ball.center_m)?;
        let field = format!("plane.ball[{index}].radius_m");
        within(source, &field, ball.radius_m, 0.001, 1e6, "metres")?;
        solids.push(Solid::Ball { center_m: ball.center_m.0, radius_m: ball.radius_m });
    }
    for (index, entry) in table.half_space.iter().enumerate() {
        let field = format!("plane.half_space[{index}].point_m");
        checks::place(source, &field, entry.point_m)?;
        let length = entry.normal.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            let field = format!("plane.half_space[{index}].normal");
            return Err(source.error(&field, "this is no direction", "give a vector that is not zero"));
        }
        solids.push(Solid::Plane { point_m: entry.point_m.0, normal: entry.normal.0.map(|x| x / length) });
    }
    Ok(solids)
}

fn guidance(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    cruise_mps: f64,
    tolerance_m: f64,
) -> Result<GuidanceSetup, ScenarioError> {
    let flocks = [
        flocks::lattice(source, file, table)?,
        flocks::goal_flock(source, table, cruise_mps, file.seed)?,
        flocks::boids(source, table, cruise_mps)?,
    ];
    // A table of another guidance is refused, and so is a flock without its own.
    if let Some(flock) = flocks.into_iter().flatten().next() {
        return Ok(flock);
    }
    if !table.guidance.is_on_grid() {
        return Ok(waypoint(cruise_mps, tolerance_m));
    }
    let (route, speed_mps) = (params::routing(source, &file.route, &file.grid)?, Some(cruise_mps as f32));
    if table.guidance == GuidanceKind::Route {
        return Ok(GuidanceSetup::Route { route, speed_mps });
    }
    let formation = params::formation(source, &file.formation)?;
    // Each robot has its own template: see `Scenario::guidance`.
    Ok(GuidanceSetup::Formation { route, formation, template: Template::default(), speed_mps })
}

fn safety(source: &Source<'_>, table: &PlaneTable) -> Result<SafetySetup, ScenarioError> {
    let orca = orca(source, &table.orca)?;
    let mut inflation = inflation(table.max_speed_mps, table.radius_m);
    for (field, value, unit, param) in [
        ("inflation_mps", table.orca.inflation_mps, "m/s", &mut inflation.growth_mps),
        ("inflation_m", table.orca.inflation_m, "metres", &mut inflation.max_m),
    ] {
        if let Some(value) = value {
            within(source, &format!("plane.orca.{field}"), value, 0.0, 1000.0, unit)?;
            *param = value as f32;
        }
    }
    Ok(table.safety.setup(orca, inflation, push_out(source, table)?))
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

fn push_out(source: &Source<'_>, table: &PlaneTable) -> Result<PushOutParams<f32>, ScenarioError> {
    let given = match (table.safety == SafetyKind::PushOut, table.push_out) {
        (false, None) => return Ok(PushOutParams::new(1.0)),
        (true, Some(given)) => given,
        _ => {
            let what = "safety \"push_out\" and its table go together";
            return Err(source.error("plane.push_out", what, "give both or none of them"));
        }
    };
    let field = "plane.push_out.min_distance_m";
    within(source, field, given.min_distance_m, 0.001, 1e5, "metres")?;
    Ok(PushOutParams {
        model: given.model,
        evasion: if given.single { Evasion::Single } else { Evasion::Multiple },
        min_distance_m: given.min_distance_m as f32,
    })
}

fn orders(source: &Source<'_>, file: &ScenarioFile, table: &PlaneTable) -> Result<Vec<Order>, ScenarioError> {
    let mut orders = Vec::new();
    for (index, order) in table.order.iter().enumerate() {
        let field = format!("plane.order[{index}].at_s");
        within(source, &field, order.at_s, 0.0, 1e9, "seconds")?;
        if order.goal >= checks::goals(table.guidance) {
            let field = format!("plane.order[{index}].goal");
            let name = table.guidance.name();
            let what = format!("robots with guidance \"{name}\" have no goal {}", order.goal);
            let remedy = "give one that they have, from 0, or another guidance";
            return Err(source.error(&field, what, remedy));
        }
        checks::place(source, &format!("plane.order[{index}].place_m"), order.place_m)?;
        let field = format!("plane.order[{index}].velocity_mps");
        checks::goal_velocity(source, &field, table.guidance, order.velocity_mps)?;
        orders.push(Order {
            tick: libm::ceil(order.at_s / file.tick_s) as u32,
            index: order.goal,
            target: Target { position_m: order.place_m.0, velocity_mps: order.velocity_mps.0 },
        });
    }
    orders.sort_by_key(|order| order.tick);
    Ok(orders)
}

fn check_count(source: &Source<'_>, field: &str, count: u32) -> Result<(), ScenarioError> {
    if (1..=MAX_ROBOTS).contains(&count) {
        return Ok(());
    }
    let remedy = format!("give 1 to {MAX_ROBOTS}");
    Err(source.error(field, format!("{count} robots are no swarm"), remedy))
}
