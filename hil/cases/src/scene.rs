//! Scenes of one agent behind ORCA among sixteen robots, with all parameters that its work depends
//! on, and the scenes in which a directed search found the longest steps.
//!
//! The program `search` of `hil/firmware` changes scenes at random and keeps those whose longest
//! step takes more instructions. `cargo xtask size --search` runs it and prints the scenes for
//! [`FOUND`].
//!
//! The search does not vary the body (no inertia, no lag) and the inbox (one beacon of each robot
//! that is heard, no robot beyond the sixteen).

use crate::plane::STEP;
use crate::{Probe, Summary, hash::Hashes};
use core::fmt::{Display, Formatter};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{Agent, AgentConfig, InPlane, Inputs, KinematicState, OrcaSafety, Outputs, Waypoint};
use staya_controller::agent::{Law as _, Protocol as _, WaypointGuidance, WaypointOrder, Waypoints};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{AvoidParams, HalfSpaces};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Header, Message, Postcard, encode};

#[rustfmt::skip]
mod found;

pub use found::FOUND;

/// Robots of a scene besides the agent.
pub const ROBOTS: usize = 16;
const WALLS: usize = 4;
/// Times of the steps in milliseconds. At the second step, robots that were silent since the first
/// one are lost; at the third step, those that were silent since the second one are stale.
const TIMES_MS: [i32; 7] = [0, 3_100, 3_600, 3_700, 3_800, 3_900, 4_000];
/// Far away from the origin, and with large ids, frames have the most bytes.
const CENTER_MM: [i32; 2] = [1_900_000_000, -1_900_000_000];
const FIRST_ID: u32 = 1_900_000_000;
/// The agent's place among the ids.
const OWN: RobotId = RobotId(FIRST_ID + 5);
const OWN_RADIUS_MM: i32 = 150;
/// Largest values of a scene: coordinates, speeds, radii, distance to the goal.
const PLACE_MM: i16 = 1_500;
const SPEED_MMPS: i16 = 700;
const RADII_MM: [i16; 2] = [50, 400];
const WAY_MM: i16 = 9_000;
const MODES: [Mode; 4] = [Mode::Cruise, Mode::Arrived, Mode::Hold, Mode::Fault];

type Inbox = Vec<u8, { ROBOTS * Beacon::MAX_FRAME_LEN }>;

/// How much of a robot is received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Radio {
    /// A beacon in each step.
    #[default]
    Heard,
    /// No beacon after the second step.
    Stale,
    /// No beacon after the first step.
    Lost,
}

/// One of the other robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Robot {
    /// Position in the last step, relative to the agent, millimetres.
    pub at_mm: [i16; 2],
    /// Velocity, mm/s; earlier positions follow from it.
    pub velocity_mmps: [i16; 2],
    /// Radius, millimetres.
    pub radius_mm: i16,
    /// Index of its mode in the list of modes.
    pub mode: u8,
    /// Whether it is silent or lost.
    pub radio: Radio,
}

/// A scene: the agent remains at one place, and its state reports the velocity `velocity_mmps`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scene {
    /// Own velocity, mm/s.
    pub velocity_mmps: [i16; 2],
    /// Offset of the goal, millimetres.
    pub way_mm: [i16; 2],
    /// Whether the goal comes after a waypoint that the agent has passed.
    pub is_second: bool,
    /// Ends of the walls, millimetres.
    pub walls_mm: [[[i16; 2]; 2]; WALLS],
    /// The other robots.
    pub robots: [Robot; ROBOTS],
}

fn draw(rng: &mut Rng, low: i16, high: i16) -> i16 {
    let span = i32::from(high) - i32::from(low) + 1;
    (i32::from(low) + rng.below(span.unsigned_abs()).cast_signed()) as i16
}

/// Draws a new value, or one near the present value.
fn vary(rng: &mut Rng, value: &mut i16, low: i16, high: i16) {
    let scale = match rng.below(4) {
        0 => return *value = draw(rng, low, high),
        1 => 8,
        2 => 64,
        _ => 256,
    };
    *value = value.saturating_add(draw(rng, -scale, scale)).clamp(low, high);
}

fn vary_point(rng: &mut Rng, point: &mut [i16; 2], most: i16) {
    for value in point {
        vary(rng, value, -most, most);
    }
}

impl Robot {
    fn random(rng: &mut Rng) -> Self {
        let mut point = |most: i16| [draw(rng, -most, most), draw(rng, -most, most)];
        let (at_mm, velocity_mmps) = (point(PLACE_MM), point(SPEED_MMPS));
        let [least, most] = RADII_MM;
        Self { at_mm, velocity_mmps, radius_mm: draw(rng, least, most), ..Self::default() }
    }

    fn vary(&mut self, rng: &mut Rng) {
        match rng.below(8) {
            0 => *self = Self::random(rng),
            1..=3 => vary_point(rng, &mut self.at_mm, PLACE_MM),
            4 | 5 => vary_point(rng, &mut self.velocity_mmps, SPEED_MMPS),
            6 => {
                let [least, most] = RADII_MM;
                vary(rng, &mut self.radius_mm, least, most);
            }
            _ => {
                self.mode = rng.below(MODES.len() as u32) as u8;
                self.radio = match rng.below(4) {
                    0 => Radio::Stale,
                    1 => Radio::Lost,
                    _ => Radio::Heard,
                };
            }
        }
    }

    fn beacon(&self, before_ms: i32) -> Beacon {
        let [x, y] = CENTER_MM;
        let [east, north] = self.at_mm.map(i32::from);
        let [vx, vy] = self.velocity_mmps.map(|v| i32::from(v) * before_ms / 1_000);
        let [east_mmps, north_mmps] = self.velocity_mmps;
        Beacon {
            position_mm: [x + east - vx, y + north - vy, 0],
            velocity_mmps: [east_mmps, north_mmps, 0],
            radius_mm: self.radius_mm.unsigned_abs(),
            mode: MODES.get(usize::from(self.mode)).copied().unwrap_or_default(),
            protocol: Waypoints::ID,
            ..Beacon::default()
        }
    }

    /// The last step in which it is heard.
    const fn last_step(&self) -> usize {
        match self.radio {
            Radio::Heard => TIMES_MS.len(),
            Radio::Stale => 1,
            Radio::Lost => 0,
        }
    }
}

impl Scene {
    /// Draws a scene.
    #[must_use]
    pub fn random(rng: &mut Rng) -> Self {
        let mut scene = Self { robots: [(); ROBOTS].map(|()| Robot::random(rng)), ..Self::default() };
        for end in scene.walls_mm.as_flattened_mut() {
            *end = [draw(rng, -PLACE_MM, PLACE_MM), draw(rng, -PLACE_MM, PLACE_MM)];
        }
        scene.way_mm = [draw(rng, -WAY_MM, WAY_MM), draw(rng, -WAY_MM, WAY_MM)];
        scene.velocity_mmps = [draw(rng, -SPEED_MMPS, SPEED_MMPS), draw(rng, -SPEED_MMPS, SPEED_MMPS)];
        scene
    }

    /// Changes one to four things.
    #[must_use]
    pub fn varied(mut self, rng: &mut Rng) -> Self {
        for _ in 0..=rng.below(4) {
            match rng.below(24) {
                0 => vary_point(rng, &mut self.velocity_mmps, SPEED_MMPS),
                1 => vary_point(rng, &mut self.way_mm, WAY_MM),
                2 => self.is_second = rng.below(2) == 0,
                3..=6 => {
                    let ends = self.walls_mm.as_flattened_mut();
                    if let Some(end) = ends.get_mut(rng.below(2 * WALLS as u32) as usize) {
                        vary_point(rng, end, PLACE_MM);
                    }
                }
                // The order of robots matters.
                7 => {
                    let [one, other] = [0; 2].map(|_| rng.below(ROBOTS as u32) as usize);
                    let robots = (self.robots.get(one).copied(), self.robots.get(other).copied());
                    if let (Some(first), Some(second)) = robots {
                        self.robots.get_mut(one).into_iter().for_each(|it| *it = second);
                        self.robots.get_mut(other).into_iter().for_each(|it| *it = first);
                    }
                }
                _ => {
                    if let Some(robot) = self.robots.get_mut(rng.below(ROBOTS as u32) as usize) {
                        robot.vary(rng);
                    }
                }
            }
        }
        self
    }

    /// Takes each robot, the walls and the rest from this scene or from `other`.
    #[must_use]
    pub fn crossed(&self, other: &Self, rng: &mut Rng) -> Self {
        let mut is_other = || rng.below(2) == 0;
        let mut scene = if is_other() { *other } else { *self };
        scene.walls_mm = if is_other() { other.walls_mm } else { self.walls_mm };
        for (robot, (one, two)) in scene.robots.iter_mut().zip(self.robots.iter().zip(&other.robots)) {
            *robot = if is_other() { *two } else { *one };
        }
        scene
    }

    /// Runs the steps of the scene with the first `N` robots and at most `K` half-planes from
    /// `source`.
    pub fn play<S: Scalar, H: HalfSpaces<S> + Serialize, P: Probe<S>, const N: usize, const K: usize>(
        &self,
        source: H,
        probe: &mut P,
        mut done: impl FnMut(&SceneAgent<S, H, N, K>, &Outputs<S>),
    ) {
        let config =
            AgentConfig { seed: 1, latency: STEP, ..AgentConfig::new(OWN, S::from_milli(OWN_RADIUS_MM), STEP) };
        let inflation = StalenessInflation { growth_mps: S::HALF, max_m: S::from_milli(300) };
        let safety = OrcaSafety::<S, K, H>::with_source(AvoidParams::default(), inflation, source);
        let mut law = WaypointGuidance::new(S::ONE, S::from_milli(10));
        let [x, y] = CENTER_MM;
        let [east, north] = self.way_mm.map(i32::from);
        let goal = Waypoint::fixed(Position::from_mm([x + east, y + north, 0]));
        if self.is_second {
            let _ = law.order(&WaypointOrder::first(Waypoint::fixed(Position::from_mm([x, y, 0]))));
        }
        let _ = law.order(&WaypointOrder { index: u8::from(self.is_second), waypoint: goal });
        let mut agent = Agent::<S, _, N, _>::new(&config, law, safety, Postcard);
        let mut obstacles = Vec::<Obstacle<S>, WALLS>::new();
        for ends in self.walls_mm {
            let _ = obstacles.push(Obstacle::Wall(ends.map(|[x, y]| Vec2::new(metres(x), metres(y)))));
        }
        let [east, north] = self.velocity_mmps;
        let state = KinematicState {
            position: Position::from_mm([x, y, 0]),
            velocity_mps: Vec3::new(metres(east), metres(north), S::ZERO),
        };
        let last_ms = TIMES_MS.last().copied().unwrap_or_default();
        let mut inbox = Inbox::new();
        for (step, time_ms) in TIMES_MS.into_iter().enumerate() {
            let now = Instant::from_micros(0) + Duration::from_millis(time_ms);
            inbox.clear();
            let numbers = (FIRST_ID..).filter(|id| *id != OWN.0);
            for (id, robot) in numbers.zip(&self.robots).take(N).filter(|(_, robot)| step <= robot.last_step()) {
                let header = Header { boot: 0, sender: RobotId(id), sequence: step as u16 };
                // At the position of now, although the agent takes it for as old as the latency.
                let beacon = robot.beacon(last_ms - time_ms);
                let _ = encode(header, &Message::Beacon(beacon), &mut inbox);
            }
            let surroundings = InPlane { max_speed_mps: S::ONE, obstacles: &obstacles };
            let inputs = Inputs { state, surroundings, inbox: &inbox };
            let mut out = Outputs::default();
            probe.step(&mut agent, &inputs, now, &mut (), &mut out);
            done(&agent, &out);
        }
    }
}

/// The agent of a scene.
pub type SceneAgent<S, H, const N: usize, const K: usize> = Agent<S, WaypointGuidance<S>, N, OrcaSafety<S, K, H>>;

fn metres<S: Scalar>(milli: i16) -> S {
    S::from_milli(milli.into())
}

/// Runs all scenes of [`FOUND`].
#[inline(never)]
pub(crate) fn found<S: Scalar, H, P: Probe<S>, const N: usize, const K: usize>(source: H, probe: &mut P) -> Summary
where
    H: HalfSpaces<S> + Serialize + Copy,
{
    let mut summary = Summary::of::<SceneAgent<S, H, N, K>, ()>();
    let mut hashes = Hashes::new();
    for scene in FOUND {
        scene.play::<S, H, P, N, K>(source, probe, |agent, out| {
            hashes.step(out, agent.digest());
            summary.count(out);
        });
    }
    summary.ticks = TIMES_MS.len() as u32;
    hashes.put(&mut summary);
    summary
}

/// The expression of this scene in `found.rs`, in lines.
impl Display for Scene {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        let Self { velocity_mmps, way_mm, is_second, walls_mm, robots } = self;
        writeln!(f, "    Scene {{")?;
        writeln!(f, "        velocity_mmps: {velocity_mmps:?}, way_mm: {way_mm:?}, is_second: {is_second},")?;
        writeln!(f, "        walls_mm: {walls_mm:?},")?;
        writeln!(f, "        robots: [")?;
        for Robot { at_mm: [x, y], velocity_mmps: [vx, vy], radius_mm, mode, radio } in robots {
            writeln!(f, "            robot([{x}, {y}], [{vx}, {vy}], {radius_mm}, {mode}, {radio:?}),")?;
        }
        writeln!(f, "        ],\n    }},")
    }
}
