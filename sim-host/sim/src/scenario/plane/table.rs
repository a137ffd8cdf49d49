//! `[plane]` as it stands in the file: every field is documented here.

use super::super::formation::FormationEntry;
use serde::Deserialize;
use staya_controller::agent::{GuidanceKind, SafetyKind};
use staya_controller::push_out::Model;

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
    /// Sides of a torus that robots live on instead of the open plane, metres: who leaves on one side comes in on the other.
    pub torus_m: Option<[f64; 2]>,
    /// Where they want to go; `"route"` and `"formation"` need `[terrain]`, the latter `robots.formation`.
    #[serde(default)]
    pub guidance: GuidanceKind,
    /// What keeps them apart.
    #[serde(default)]
    pub safety: SafetyKind,
    /// Who takes part, unless the top-level `robots` says it in cells.
    pub robots: Option<PlaneRobots>,
    /// Further robots, which differ from what is said here.
    #[serde(default)]
    pub group: Vec<GroupTable>,
    /// Bodies that are no robots and go through.
    #[serde(default)]
    pub intruder: Vec<IntruderEntry>,
    /// Walls: chains of points.
    #[serde(default)]
    pub wall: Vec<WallEntry>,
    /// Balls (in the plane: discs).
    #[serde(default)]
    pub ball: Vec<BallEntry>,
    /// Balls at random places.
    #[serde(default)]
    pub balls: Vec<BallsEntry>,
    /// Half-spaces.
    #[serde(default)]
    pub half_space: Vec<HalfSpaceEntry>,
    /// Parameters of ORCA.
    #[serde(default)]
    pub orca: OrcaTable,
    /// Parameters of push-out; required for it.
    pub push_out: Option<PushOutTable>,
    /// Parameters of the alpha flock; required for it.
    pub lattice: Option<LatticeTable>,
    /// Parameters of the goal flock; required for it.
    pub goal_flock: Option<GoalFlockTable>,
    /// Parameters of boids; required for them.
    pub boids: Option<BoidsTable>,
    /// Robots see each other.
    pub eyes: Option<EyesTable>,
    /// What moves during the run: goals that an operator sends.
    #[serde(default)]
    pub order: Vec<OrderEntry>,
}

const fn infinite() -> f64 {
    f64::INFINITY
}

/// How far robots see, metres.
pub(super) const fn ten() -> f64 {
    10.0
}

/// `[plane.eyes]`: robots see each other, beside the radio or without it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyesTable {
    /// How far, from centre to centre, metres.
    pub range_m: f64,
    /// Standard deviation of places seen along each axis, metres. Default: 0.
    #[serde(default)]
    pub noise_m: f64,
    /// Whether bodies, obstacles and closed cells hide whose centre is behind them. Default: true.
    #[serde(default = "yes")]
    pub occlusion: bool,
    /// Whether they see who it is. Default: false.
    #[serde(default)]
    pub names: bool,
    /// Each robot looks once in so many ticks. Default: 1.
    #[serde(default = "one")]
    pub every_ticks: u32,
    /// How many ticks later what was seen is there. Default: 0.
    #[serde(default)]
    pub delay_ticks: u32,
    /// Whether robots say anything on the radio; orders reach them all the same. Default: true.
    #[serde(default = "yes")]
    pub beacons: bool,
    /// Standard deviation of the others' accelerations, m/s^2, as the filter has it. Default: what they can do, at most four times the highest
    /// speed in a second.
    pub acceleration_mps2: Option<f64>,
    /// Standard deviations within which a sighting is of a robot that is known. Default: 4.
    #[serde(default = "four")]
    pub gate: f64,
    /// Standard deviations of a place that are added to the radius of who is seen. Default: 2.
    #[serde(default = "two")]
    pub margin: f64,
    /// After how long somebody who says nothing and is not seen any more is forgotten, seconds. Default: three looks and
    /// the delay, at least four ticks.
    pub forget_s: Option<f64>,
}

const fn one() -> u32 {
    1
}

const fn two() -> f64 {
    2.0
}

const fn four() -> f64 {
    4.0
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
    /// Robots at random places, each with a goal of its own.
    pub scattered: Option<ScatteredDiscs>,
    /// A formation, in cells of the land; of a group, with guidance `"formation"`.
    pub formation: Option<FormationEntry>,
}

/// One robot of `plane.robots.list`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneRobotEntry {
    /// Where it starts: x, y, z in metres.
    pub start_m: Place,
    /// Where it should go. Without it, it stays where guidance leaves it.
    pub goal_m: Option<Place>,
    /// Places to go by on the way to the goal, at most three.
    #[serde(default)]
    pub via_m: Vec<Place>,
    /// How fast it is at the start. Default: at rest.
    #[serde(default)]
    pub velocity_mps: Place,
    /// Radius of its body, metres. Default: that of its group.
    pub radius_m: Option<f64>,
    /// Its highest speed on easy land, m/s. Default: that of its group.
    pub max_speed_mps: Option<f64>,
}

/// `[[plane.group]]`: robots that differ from what `[plane]` says; what is not given here is what it says. Their tables
/// stand here when their guidance or their safety layer is another one.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupTable {
    /// Who is in it.
    pub robots: PlaneRobots,
    /// Radius of each body, metres.
    pub radius_m: Option<f64>,
    /// Highest speed on easy land, m/s.
    pub max_speed_mps: Option<f64>,
    /// Highest acceleration, m/s^2.
    pub max_acceleration_mps2: Option<f64>,
    /// Speed that they like to go, m/s.
    pub cruise_mps: Option<f64>,
    /// How near to a goal counts as being there, metres.
    pub tolerance_m: Option<f64>,
    /// How far they see obstacles, metres.
    pub sight_m: Option<f64>,
    /// Where they want to go; from cell to cell, and in formation, on land alone.
    pub guidance: Option<GuidanceKind>,
    /// The flock that they are of; 0 is that of the robots of `[plane]`; beside formations not less than these have places. Default: one of their own.
    pub flock: Option<u8>,
    /// What keeps them apart.
    pub safety: Option<SafetyKind>,
    /// Parameters of ORCA.
    pub orca: Option<OrcaTable>,
    /// Parameters of push-out.
    pub push_out: Option<PushOutTable>,
    /// Parameters of the alpha flock.
    pub lattice: Option<LatticeTable>,
    /// Parameters of the goal flock.
    pub goal_flock: Option<GoalFlockTable>,
    /// Parameters of boids.
    pub boids: Option<BoidsTable>,
}

/// `[[plane.intruder]]`: a body that is no robot of the swarm and gives way to nobody.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntruderEntry {
    /// Where it starts.
    pub start_m: Place,
    /// How it goes, all the time, m/s.
    pub velocity_mps: Place,
    /// Radius of its body, metres.
    pub radius_m: f64,
    /// Whether it says where it is, in beacons of a robot that gives no way; otherwise robots see it as they see
    /// obstacles: where it is, not how fast. Default: true.
    #[serde(default = "yes")]
    pub heard: bool,
}

const fn yes() -> bool {
    true
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

/// `plane.robots.scattered`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatteredDiscs {
    /// How many.
    pub count: u32,
    /// Starts and goals are drawn evenly between these corners, metres, and again while they are too near to others.
    pub from_m: Place,
    /// See `from_m`.
    pub to_m: Place,
    /// Goals are at most so far away along each axis, metres. Default: anywhere between the corners.
    #[serde(default = "infinite")]
    pub travel_m: f64,
    /// Least distance of two starts, and of two goals, metres; as much as two radii, or more. Default: three radii.
    pub spacing_m: Option<f64>,
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

/// `[[plane.balls]]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallsEntry {
    /// How many.
    pub count: u32,
    /// Radius of each, metres.
    pub radius_m: f64,
    /// Centres are drawn evenly between these corners, metres.
    pub from_m: Place,
    /// See `from_m`.
    pub to_m: Place,
    /// Least distance of two of their surfaces, metres. Default: 0.
    #[serde(default)]
    pub gap_m: f64,
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
    /// How fast the ball around a silent robot grows, m/s. Default: the highest speed.
    #[serde(alias = "doubt_mps")]
    pub inflation_mps: Option<f64>,
    /// How much it grows at most around one that is lost, metres. Default: the radius.
    #[serde(alias = "doubt_m")]
    pub inflation_m: Option<f64>,
    /// In space: how many times as far as beside each other robots keep apart above and below each other. Default: 1.
    pub downwash: Option<f64>,
    /// How long a lost robot is remembered, seconds.
    pub remember_s: Option<f64>,
    /// How fast a robot goes that has lost all others, m/s; `inf`: as ever.
    pub alone_mps: Option<f64>,
}

impl OrcaTable {
    /// Whether it says nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { horizon_s, wall_horizon_s, share, margin_m, inflation_mps, inflation_m, .. } = self;
        let Self { downwash, remember_s, alone_mps, .. } = self;
        let fields = [horizon_s, wall_horizon_s, share, margin_m, inflation_mps, inflation_m];
        let fields = fields.into_iter().chain([downwash, remember_s, alone_mps]);
        fields.into_iter().all(Option::is_none)
    }
}

/// `[plane.push_out]` (PAV).
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushOutTable {
    /// Least distance of two robots' centres, and of a centre from an obstacle (R_MinDist), metres.
    pub min_distance_m: f64,
    /// `"radial"` (model 1: along the radius; the default) or `"tangential"` (model 2: along the border).
    #[serde(default)]
    pub model: Model,
    /// Whether only the nearest robot in the way is evaded. Default: false, all are.
    #[serde(default)]
    pub single: bool,
}

/// `[plane.lattice]` (OLF).
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeTable {
    /// Distance of neighbours (d), metres.
    pub spacing_m: f64,
    /// 1: only the others; 2: and the goal; 3: and obstacles. Default: 3.
    pub algorithm: Option<u8>,
    /// Gain on positions of robots among each other (c1 of the alpha-agents), 1/s^2.
    pub c_alpha: Option<f64>,
    /// The same of obstacles.
    pub c_beta: Option<f64>,
    /// The same of the goal.
    pub c_gamma: Option<f64>,
    /// Whether the goal moves with its velocity (a dynamic gamma-agent) or stays although it has one. Default: true.
    pub goal_moves: Option<bool>,
    /// Over which way behind a goal that stays its velocity fades, metres: the flock comes to rest within it. Default: never.
    pub goal_rest_m: Option<f64>,
    /// Whether robots in algorithm 3 press on nobody who is nearer to the goal: so they pass gaps one after the other. Default: false.
    pub takes_turns: Option<bool>,
    /// Distance kept from obstacles over spacing (d' / d). Default: 0.6.
    pub obstacle_ratio: Option<f64>,
}

/// `[plane.goal_flock]` (PAV).
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalFlockTable {
    /// Least distance of two robots' centres (R_MinDist), metres.
    pub min_distance_m: f64,
    /// How far neighbours are seen (R_nbh), metres. Default: four times that.
    pub neighborhood_m: Option<f64>,
    /// Pull of the goal.
    pub k1: Option<f64>,
    /// Pull of the middle of the neighbours.
    pub k2: Option<f64>,
    /// Push of neighbours that are too near.
    pub k3: Option<f64>,
    /// How near a goal counts as being there, metres. Default: `neighborhood_m`.
    pub arrival_m: Option<f64>,
}

/// `[plane.boids]` (STA).
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoidsTable {
    /// Nearer than this, a boid turns away, metres.
    pub crowded_m: f64,
    /// Up to this a neighbour counts, metres.
    pub closest_m: f64,
    /// Largest turn in a tick towards the others, radians. Default: 0.05.
    pub max_turn: Option<f64>,
    /// Largest turn in a tick away from one that is too near, radians. Default: 0.02.
    pub max_turn_away: Option<f64>,
}
