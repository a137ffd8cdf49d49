//! The configuration of a robot: `staya_setup_defaults` fills it, then the caller changes fields
//! and chooses law and layer by name.

mod formation;

pub use formation::*;

use crate::Number;
use crate::choices::StayaWire;
use crate::memory::{answers, plain};
use crate::speech::Speech;
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{
    AgentConfig, CELLS, ContactLossPolicy, OrcaSettings, RouteSettings, Settings, WaypointSettings,
};
use staya_controller::neighbor::{Ages, PlausibilityLimits};
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;
use staya_controller::wire::{Postcard, Retry};

/// Number of values of a law in a setup.
pub const STAYA_LAW_VALUES: usize = 24;
/// Number of values of a safety layer in a setup.
pub const STAYA_LAYER_VALUES: usize = 12;

/// Length of a swarm's key in bytes.
pub const STAYA_KEY: usize = 32;

/// Size of a StayaSetup in bytes, on every machine.
pub const STAYA_SETUP_SIZE: usize = 416;

const _: () = assert!(size_of::<StayaSetup>() == STAYA_SETUP_SIZE);
#[cfg(feature = "auth")]
const _: () = assert!(STAYA_KEY == staya_controller::auth::KEY_LEN);

/// The configuration of a robot. Fill it with `staya_setup_defaults`, change fields, and choose law
/// and layer by `staya_choose_law` and `staya_choose_layer`, with values by `staya_set`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaSetup {
    /// Written by `staya_setup_defaults`; shows that header and library have the same version.
    pub version: u32,
    /// The robot's number from 1, unique in the swarm (MAVLink: up to 254; with a key: below 2^21).
    pub id: u32,
    /// Seed of its random decisions, together with its number.
    pub seed: u64,
    /// Seed of draws that all robots make alike, as of the goals of a flock: the same in all.
    pub common_seed: u64,
    /// Time from one step to the next, microseconds, which the caller must keep; on the grid the
    /// time for a cell of impassability 1.
    pub tick_us: i32,
    /// Time between two beacons, microseconds.
    pub beacon_period_us: i32,
    /// Age of a beacon when it arrives, microseconds: neighbours are extrapolated by this time.
    pub latency_us: i32,
    /// Beacons older than this are stale, microseconds: use a few beacon periods.
    pub stale_after_us: i32,
    /// A robot that is silent for longer is lost, microseconds; at most half an hour.
    pub lost_after_us: i32,
    /// Silence after which a lost robot counts as standing even if most robots are lost,
    /// microseconds; at most ten minutes.
    pub stands_after_us: i32,
    /// How long the robot stands and listens after its start, microseconds.
    pub listen_us: i32,
    /// How long a message of a law across land in cells is resent at most, and how long a stop
    /// lasts unless it is renewed, microseconds.
    pub message_valid_us: i32,
    /// Time between two attempts of a message, microseconds.
    pub retry_interval_us: i32,
    /// Number of attempts of a message.
    pub retry_attempts: u8,
    /// Beacons of other robots of the formation that it relays behind each of its own, 0 to 3, for
    /// those that distance or land hides from each other.
    pub relays: u8,
    /// Must change with each start (a stored counter or random), or others take it for a replay.
    pub boot: u8,
    /// The robot's flock; robots of other flocks are only obstacles.
    pub flock: u8,
    /// Private to the library: see `staya_choose_law`.
    pub law: u8,
    /// Private to the library: see `staya_choose_layer`.
    pub layer: u8,
    /// StayaWire.
    pub wire: u8,
    /// Above 0: a robot that has not heard another one stands.
    pub expects_others: u8,
    /// With the law "external": the protocol of its payloads and messages, 64 to 255.
    pub protocol: u8,
    /// Other than 0: the body moves from cell to cell; commands are moves, `speed_mps` is ignored.
    pub on_grid: u8,
    /// Over cells: sight in each direction, 1 to STAYA_MAX_RADIUS.
    pub sight_cells: u8,
    /// Over cells, other than 0: a diagonal move is as long as a straight one.
    pub diagonals_count_as_one: u8,
    /// Over cells, other than 0: diagonal moves may pass a blocked corner.
    pub cuts_corners: u8,
    /// Radius of the ball around the body, metres.
    pub radius_m: f32,
    /// Cruising speed, m/s; limited by that of the body.
    pub speed_mps: f32,
    /// Highest speed of the body, m/s; 0: `speed_mps`.
    pub max_speed_mps: f32,
    /// Highest speed of any robot, m/s; 0: that of the body.
    pub fastest_mps: f32,
    /// Distance within which its waypoint counts as reached, metres.
    pub tolerance_m: f32,
    /// How fast the body can change its velocity, m/s^2; FLT_MAX: at once.
    pub max_acceleration_mps2: f32,
    /// Time constant with which the body follows a velocity command, seconds; 0: at once.
    pub lag_s: f32,
    /// Speed if all other robots are lost, m/s. 0: it stops until it receives a beacon; above 0:
    /// only for robots that may be alone.
    pub alone_mps: f32,
    /// Distance within which the radio works when nothing disturbs it, metres; 0: unknown.
    pub reach_m: f32,
    /// Largest radius accepted in a beacon, metres; FLT_MAX: any.
    pub plausibility_max_radius_m: f32,
    /// Highest speed accepted in a beacon, m/s; FLT_MAX: any, and positions are not checked.
    pub plausibility_max_speed_mps: f32,
    /// Additional tolerance between two positions of a robot, metres.
    pub plausibility_slack_m: f32,
    /// How long a robot that has jumped must send consistent positions, microseconds.
    pub plausibility_settle_us: i32,
    /// The greatest number of any robot.
    pub plausibility_last_id: u32,
    /// Private to the library: values of the law; NaN: not given.
    pub law_values: [f32; STAYA_LAW_VALUES],
    /// Private to the library: values of the layer; NaN: not given.
    pub layer_values: [f32; STAYA_LAYER_VALUES],
    /// The robot's place in a formation.
    pub formation: StayaFormation,
    /// With STAYA_WIRE_SEALED: its count of starts, in persistent memory from 0; below 2^20.
    pub starts: u32,
    /// With STAYA_WIRE_SEALED: the swarm's secret. The agent keeps a copy.
    pub key: [u8; STAYA_KEY],
}

plain!(StayaSetup);

const VERSION: u32 = u32::from_be_bytes(*b"sty4");

/// Largest `sight_cells`.
pub const STAYA_MAX_RADIUS: u8 = 5;

const _: () = {
    let side = 2 * STAYA_MAX_RADIUS as usize + 3;
    assert!(side * side == CELLS);
};

impl StayaSetup {
    fn defaults(&mut self, id: u32, radius_m: f32, tick_us: i32) -> Checked<()> {
        let config = AgentConfig::new(RobotId(id), radius_m, Duration::from_micros(tick_us));
        let AgentConfig { ages, retry, contact_loss, plausibility, .. } = config;
        (self.version, self.id, self.radius_m, self.tick_us) = (VERSION, id, radius_m, tick_us);
        self.beacon_period_us = config.beacon_period.as_micros();
        self.stale_after_us = ages.stale_after.as_micros();
        self.lost_after_us = ages.expire_after.as_micros();
        self.stands_after_us = contact_loss.stands_after.as_micros();
        self.listen_us = contact_loss.listen.as_micros();
        self.message_valid_us = config.message_valid.as_micros();
        (self.retry_interval_us, self.retry_attempts) = (retry.interval.as_micros(), retry.attempts);
        (self.speed_mps, self.tolerance_m) = (0.5, 0.05);
        self.max_acceleration_mps2 = config.max_acceleration_mps2;
        self.alone_mps = contact_loss.alone_mps;
        self.plausibility_max_radius_m = plausibility.max_radius_m;
        self.plausibility_max_speed_mps = plausibility.max_speed_mps;
        self.plausibility_slack_m = plausibility.slack_m;
        self.plausibility_settle_us = plausibility.settle.as_micros();
        self.plausibility_last_id = plausibility.last.0;
        self.sight_cells = RouteSettings::default().params.radius;
        self.choose_law(WaypointSettings::NAME)?;
        self.choose_layer(OrcaSettings::NAME)
    }

    pub(crate) fn check_version(&self) -> Checked<&Self> {
        if self.version == VERSION { Ok(self) } else { Err(StayaStatus::Version) }
    }

    pub(crate) fn config(&self) -> Checked<AgentConfig<Number>> {
        self.check_version()?;
        if self.id == 0 {
            return Err(StayaStatus::NoRobot);
        }
        let us = [self.tick_us, self.beacon_period_us, self.stale_after_us, self.lost_after_us, self.retry_interval_us];
        if us.iter().any(|time| *time <= 0) || !(self.radius_m >= 0.0 && self.radius_m.is_finite()) {
            return Err(StayaStatus::Number);
        }
        let us = Duration::from_micros;
        let Self { seed, boot, flock, radius_m, max_acceleration_mps2, lag_s, alone_mps, reach_m, .. } = *self;
        let config = AgentConfig::<f32> {
            id: RobotId(self.id),
            seed,
            boot,
            tick: us(self.tick_us),
            // Robots with clocks of their own.
            is_synchronous: false,
            beacon_period: us(self.beacon_period_us),
            radius_m,
            max_acceleration_mps2,
            lag_s,
            latency: us(self.latency_us.max(0)),
            ages: Ages { stale_after: us(self.stale_after_us), expire_after: us(self.lost_after_us) },
            retry: Retry { attempts: self.retry_attempts, interval: us(self.retry_interval_us) },
            message_valid: us(self.message_valid_us),
            relays: self.relays,
            contact_loss: ContactLossPolicy {
                stands_after: us(self.stands_after_us),
                alone_mps,
                listen: us(self.listen_us.max(0)),
                expects_others: self.expects_others > 0,
                reach_m,
            },
            plausibility: PlausibilityLimits {
                max_radius_m: self.plausibility_max_radius_m,
                max_speed_mps: self.plausibility_max_speed_mps,
                slack_m: self.plausibility_slack_m,
                settle: us(self.plausibility_settle_us),
                last: RobotId(self.plausibility_last_id),
            },
            flock,
        };
        Ok(config.cast())
    }

    pub(crate) fn speech(&self) -> Checked<Speech> {
        match StayaWire::of(self.wire)? {
            StayaWire::Postcard => Ok(Speech::Postcard(Postcard)),
            #[cfg(feature = "mavlink")]
            StayaWire::Mavlink => {
                let is_robot = self.id <= u32::from(staya_mavlink::wire::MAX_ROBOT);
                is_robot.then_some(Speech::Mavlink(staya_mavlink::wire::Mavlink)).ok_or(StayaStatus::Number)
            }
            #[cfg(feature = "auth")]
            StayaWire::Sealed => {
                let key = staya_controller::auth::Key::new(self.key);
                let sealed = staya_controller::wire::Sealed::at_start(&key, self.starts);
                let fits = self.id <= staya_controller::wire::MAX_TAGGED_ROBOT.0;
                sealed.filter(|_| fits).map(Speech::Sealed).ok_or(StayaStatus::Number)
            }
            #[cfg(not(all(feature = "mavlink", feature = "auth")))]
            _ => Err(StayaStatus::NotBuilt),
        }
    }
}

/// Fills a setup for robot `id` with defaults: the law "waypoint" at 0.5 m/s behind the layer
/// "orca", a beacon each step, no inertia, no latency. `radius_m` is that of the ball around the
/// body, `tick_us` the time between two steps. `staya_init` checks them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_setup_defaults(
    setup: *mut StayaSetup,
    id: u32,
    radius_m: f32,
    tick_us: i32,
) -> StayaStatus {
    answers!(|call| call.zeroed(setup)?.defaults(id, radius_m, tick_us))
}
