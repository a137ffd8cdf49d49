//! `[plane]` as written in a scenario file, with the documentation of its fields.

use super::super::formation::FormationEntry;
use super::super::law::LawPart;
use super::super::layer::LayerPart;
use super::super::read::{Field, Node, Wrong};
use crate::{one_of, table};
use staya_controller::parameters::{RADIUS, TOLERANCE};
use std::ops::RangeInclusive;

/// Coordinates along each axis, metres: beacons encode positions as 32-bit millimetres.
const FAR: RangeInclusive<f64> = -2e6..=2e6;

/// Velocity along each axis, m/s: beacons encode velocities as 16-bit millimetres per second.
const FAST: RangeInclusive<f64> = -32.0..=32.0;

pub(super) const MAX_ROBOTS: f64 = 1_000_000.0;

/// Largest side of a torus, metres: up to here, whole millimetres are also exact in `f32`.
const LARGEST_M: f64 = 16_000.0;

table! {
    /// Fields of `[plane]` and `[[plane.group]]`. A group inherits those of `[plane]` that it
    /// lacks, and the tables of a law or a safety layer if it has the same one.
    pub struct BodyTable {
        part law: LawPart<false>;
        part layer: LayerPart;
        /// Radius of each body, metres.
        pub radius_m: f64, RADIUS;
        /// Highest speed on easy land, m/s.
        pub max_speed_mps: f64, 0.001..=32.0, "m/s";
        /// Highest acceleration, m/s^2. Default: no limit.
        pub max_acceleration_mps2: f64 = f64::INFINITY, 1e-6..=f64::INFINITY, "m/s^2";
        /// Time constant with which the velocity follows a command, seconds. Default: 0, at once.
        pub lag_s: f64 = 0.0, 0.0..=10.0, "seconds";
        /// Preferred speed, m/s. Default: the highest.
        pub cruise_mps: Option<f64>;
        /// Distance at which a goal counts as reached, metres. Default: a tenth of the radius.
        pub tolerance_m: Option<f64>, TOLERANCE;
        /// Range of obstacle detection, metres. Default: 10.
        pub sight_m: f64 = 10.0, 0.0..=2e6, "metres";
        /// Time of the first decision, a whole number of ticks below a step. Default: by
        /// `clocks.phases`.
        pub phase_s: Option<f64>, 0.0..=60.0, "seconds";
    }
}

table! {
    /// `[plane]`.
    pub struct PlaneTable {
        part body: BodyTable;
        /// Side lengths of a torus with periodic borders, metres. Default: the open plane.
        pub torus_m: Option<[f64; 2]>, 0.01..=LARGEST_M, "metres";
        /// The robots, unless the top-level `robots` gives them in cells.
        pub robots: Option<PlaneRobots>;
        /// Further robots with other properties.
        pub group: Vec<GroupTable> = Vec::new();
        /// Foreign bodies that move through everything.
        pub intruder: Vec<IntruderEntry> = Vec::new();
        /// Walls: polylines.
        pub wall: Vec<WallEntry> = Vec::new();
        /// Balls (in the plane: discs).
        pub ball: Vec<BallEntry> = Vec::new();
        /// Balls at random places.
        pub balls: Vec<BallsEntry> = Vec::new();
        /// Half-spaces.
        pub half_space: Vec<HalfSpaceEntry> = Vec::new();
        /// Detection of other robots by sensors.
        pub sensing: Option<SensingTable>;
        /// Goals that an operator sends during the run.
        pub order: Vec<OrderEntry> = Vec::new();
    }
}

table! {
    /// `[plane.sensing]`: robots detect each other with sensors, besides the radio or without it.
    #[derive(Copy)]
    pub struct SensingTable {
        /// Range from centre to centre, metres.
        pub range_m: f64, 0.01..=1e6, "metres";
        /// Standard deviation of measured positions along each axis, metres. Default: 0.
        pub noise_m: f64 = 0.0, 0.0..=10.0, "metres";
        /// Whether bodies, obstacles and closed cells occlude robots behind them. Default: true.
        pub occlusion: bool = true;
        /// Whether a detection contains the robot's id. Default: false.
        pub names: bool = false;
        /// Ticks between two detections of a robot. Default: 1.
        pub every_ticks: u32 = 1, 1.0..=1000.0, "ticks";
        /// Delay of a detection, ticks. Default: 0.
        pub delay_ticks: u32 = 0, 0.0..=1000.0, "ticks";
        /// Whether robots send beacons; an operator's orders reach them in either case. Default:
        /// true.
        pub beacons: bool = true;
        /// Standard deviation of the other robots' accelerations in the tracking filter, m/s^2.
        /// Default: their limit, at most four times the highest speed per second.
        pub acceleration_mps2: Option<f64>, 0.001..=1000.0, "m/s^2";
        /// Gate of the assignment to a track, standard deviations. Default: 4.
        pub gate: f64 = 4.0, 0.1..=100.0, "standard deviations";
        /// Standard deviations of the position that are added to a detected robot's radius.
        /// Default: 2.
        pub margin: f64 = 2.0, 0.0..=100.0, "standard deviations";
        /// Time after which a robot without beacons and detections is dropped, seconds. Default:
        /// three detection intervals plus the delay, at least four steps.
        pub forget_s: Option<f64>;
    }
}

one_of! {
    /// How the robots are given.
    pub enum RobotsSource {
        /// Individual robots.
        List(Vec<PlaneRobotEntry>) = "list";
        /// Robots evenly spaced on a circle, with goals on the opposite side.
        Circle(CircleEntry) = "circle";
        /// Robots at random places with the same goals.
        Cloud(CloudEntry) = "cloud";
        /// Robots at random places with individual goals.
        Scattered(ScatteredDiscs) = "scattered";
        /// A formation, in cells of the terrain; only in a group with `law = "formation"`.
        Formation(FormationEntry) = "formation";
    }
}

table! {
    /// `[plane.robots]`.
    pub struct PlaneRobots {
        part robots: RobotsSource;
        /// Largest random offset of a listed start along each axis, metres. Default: 0.
        pub noise_m: f64 = 0.0, 0.0..=1e6, "metres";
    }
}

table! {
    /// One robot of `plane.robots.list`.
    pub struct PlaneRobotEntry {
        /// Start: x, y, z in metres.
        pub start_m: Place, FAR, "metres";
        /// Goal. Default: none; the robot stays where its law leaves it.
        pub goal_m: Option<Place>, FAR, "metres";
        /// Waypoints on the way to the goal, at most three.
        pub via_m: Vec<Place> = Vec::new(), FAR, "metres";
        /// Initial velocity, m/s. Default: at rest.
        pub velocity_mps: Place = Default::default(), FAST, "m/s";
        /// Radius of the body, metres. Default: that of its group.
        pub radius_m: Option<f64>, RADIUS;
        /// Highest speed on easy land, m/s. Default: that of its group.
        pub max_speed_mps: Option<f64>, 0.001..=32.0, "m/s";
        /// Time of its first decision, a whole number of ticks below a step. Default: that of its
        /// group.
        pub phase_s: Option<f64>, 0.0..=60.0, "seconds";
    }
}

table! {
    /// `[[plane.group]]`: robots that differ from those of `[plane]`.
    pub struct GroupTable {
        part body: BodyTable;
        /// The robots of the group.
        pub robots: PlaneRobots;
        /// Flock number; 0 is the flock of the robots of `[plane]`. Default: a flock of its own.
        pub flock: Option<u8>;
    }
}

table! {
    /// `[[plane.intruder]]`: a foreign body that does not give way.
    #[derive(Copy)]
    pub struct IntruderEntry {
        /// Start, metres.
        pub start_m: Place, FAR, "metres";
        /// Constant velocity, m/s.
        pub velocity_mps: Place, FAST, "m/s";
        /// Radius of the body, metres.
        pub radius_m: f64, RADIUS;
        /// Whether it sends beacons; if not, robots detect its place but not its speed. Default:
        /// true.
        pub heard: bool = true;
    }
}

/// `[x, y]` or `[x, y, z]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place(pub [f64; 3]);

impl Field for Place {
    const KIND: &'static str = "[x, y] or [x, y, z]";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match Vec::read(node).ok().as_deref() {
            Some(&[x, y]) => Ok(Self([x, y, 0.0])),
            Some(&[x, y, z]) => Ok(Self([x, y, z])),
            _ => Err(Wrong::new(node, "expected [x, y] or [x, y, z]")),
        }
    }

    fn written(&self) -> Option<String> {
        self.0.to_vec().written()
    }
}

table! {
    /// `plane.robots.circle`.
    #[derive(Copy)]
    pub struct CircleEntry {
        /// Number of robots.
        pub count: u32, 1.0..=MAX_ROBOTS, "robots";
        /// Radius of the circle around the origin, metres.
        pub radius_m: f64, 0.001..=1e6, "metres";
        /// Largest random offset of a start along each axis, metres. Default: 0, the exact circle.
        pub noise_m: f64 = 0.0, 0.0..=1e6, "metres";
    }
}

table! {
    /// `plane.robots.cloud`.
    pub struct CloudEntry {
        /// Number of robots.
        pub count: u32, 1.0..=MAX_ROBOTS, "robots";
        /// Corner of the box of uniform random starts, metres; overlapping starts are redrawn.
        pub from_m: Place, FAR, "metres";
        /// Opposite corner.
        pub to_m: Place, FAR, "metres";
        /// Corner of the box of uniform random initial velocities, m/s. Default: at rest.
        pub velocity_from_mps: Place = Default::default(), FAST, "m/s";
        /// Opposite corner.
        pub velocity_to_mps: Place = Default::default(), FAST, "m/s";
        /// Goals of all robots.
        pub goals_m: Vec<Place> = Vec::new(), FAR, "metres";
        /// Velocity of the goals, m/s. Default: at rest.
        pub goal_velocity_mps: Place = Default::default(), FAST, "m/s";
    }
}

table! {
    /// `plane.robots.scattered`.
    #[derive(Copy)]
    pub struct ScatteredDiscs {
        /// Number of robots.
        pub count: u32, 1.0..=MAX_ROBOTS, "robots";
        /// Corner of the box of uniform starts and goals, metres; those too close are redrawn.
        pub from_m: Place, FAR, "metres";
        /// Opposite corner.
        pub to_m: Place, FAR, "metres";
        /// Farthest distance of a goal from its start along each axis, metres. Default: the whole
        /// box.
        pub travel_m: f64 = f64::INFINITY, 0.001..=f64::INFINITY, "metres";
        /// Smallest distance of starts and of goals, metres, two radii or more. Default: three.
        pub spacing_m: Option<f64>;
    }
}

table! {
    /// `[[plane.wall]]`.
    pub struct WallEntry {
        /// Two or more points, each joined to the next.
        pub points_m: Vec<[f64; 2]>, FAR, "metres";
        /// Whether the last point is joined to the first: a polygon. Default: false.
        pub closed: bool = false;
        /// Width of a door in the middle of a wall of two points, metres. Default: no door.
        pub door_m: Option<f64>;
    }
}

table! {
    /// `[[plane.ball]]`.
    #[derive(Copy)]
    pub struct BallEntry {
        /// Centre, metres.
        pub center_m: Place, FAR, "metres";
        /// Radius, metres.
        pub radius_m: f64, 0.001..=1e6, "metres";
    }
}

table! {
    /// `[[plane.balls]]`.
    #[derive(Copy)]
    pub struct BallsEntry {
        /// Number of balls.
        pub count: u32, 1.0..=1e6, "balls";
        /// Radius of each, metres.
        pub radius_m: f64, 0.001..=1e6, "metres";
        /// Corner of the box of uniform random centres, metres.
        pub from_m: Place, FAR, "metres";
        /// Opposite corner.
        pub to_m: Place, FAR, "metres";
        /// Smallest distance between two surfaces, metres. Default: 0.
        pub gap_m: f64 = 0.0, 0.0..=1e6, "metres";
    }
}

table! {
    /// `[[plane.half_space]]`.
    #[derive(Copy)]
    pub struct HalfSpaceEntry {
        /// A point on its border, metres.
        pub point_m: Place, FAR, "metres";
        /// A vector out of it, of any length.
        pub normal: Place;
    }
}

table! {
    /// `[[plane.order]]`: a new goal from an operator.
    #[derive(Copy)]
    pub struct OrderEntry {
        /// Time, seconds after the start.
        pub at_s: f64, 0.0..=1e9, "seconds";
        /// Index of the goal, from 0. Default: 0.
        pub goal: u8 = 0;
        /// Position of the goal, metres.
        pub place_m: Place, FAR, "metres";
        /// Velocity of the goal, m/s. Default: at rest.
        pub velocity_mps: Place = Default::default(), FAST, "m/s";
    }
}
