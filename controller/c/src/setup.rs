//! What a robot is to be, as one plain structure: `staya_setup_defaults` fills it, the caller writes what differs.

// The structures are there in every build, so that the header is the same; what is made of them is not.
#[cfg_attr(not(feature = "push-out"), allow(unused_imports))]
mod avoidance;
#[cfg_attr(not(feature = "flocks"), allow(dead_code, unused_imports))]
mod flocks;
#[cfg_attr(not(feature = "grid"), allow(unused_imports))]
mod grid;
#[cfg(feature = "grid")]
mod laws;

pub use avoidance::*;
pub use flocks::*;
pub use grid::*;

use crate::Number;
use crate::choices::{StayaLaw, StayaSafety, StayaWire};
use crate::law::Law;
use crate::layer::{Layer, Source};
use crate::memory::{plain, zeroed};
use crate::speech::Speech;
use crate::status::{Checked, StayaStatus, answer};
#[cfg(feature = "space")]
use staya_controller::agent::FlySafety;
#[cfg(feature = "push-out")]
use staya_controller::agent::PushOutSafety;
use staya_controller::agent::{AgentConfig, OrcaSafety, Silence, Unguarded, WaypointGuidance};
use staya_controller::neighbor::{Ages, Claims};
#[cfg(feature = "space")]
use staya_controller::orca::InSpace;
use staya_controller::robot::RobotId;
use staya_controller::scalar::cast;
use staya_controller::time::Duration;
use staya_controller::wire::{Postcard, Retry};

/// Bytes of a swarm's key.
pub const STAYA_KEY: usize = 32;

/// Bytes of a StayaSetup, on every machine.
pub const STAYA_SETUP_SIZE: usize = 400;

const _: () = assert!(size_of::<StayaSetup>() == STAYA_SETUP_SIZE);
#[cfg(feature = "auth")]
const _: () = assert!(STAYA_KEY == staya_controller::auth::KEY_LEN);

/// All that makes a robot what it is before it has sensed anything. Fill it by `staya_setup_defaults`, then change what differs.
///
/// What the chosen law and layer have no use for plays no part.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaSetup {
    /// Written by `staya_setup_defaults`: header and library are of one version.
    pub version: u32,
    /// The robot's number, 1 or more, its own in the swarm (MAVLink: up to 254; with a key: below 2^21).
    pub id: u32,
    /// Seed of what it draws at random, together with its number.
    pub seed: u64,
    /// Time from one step to the next, microseconds, which must then be kept; on the grid the time for a cell of impassability 1.
    pub tick_us: i32,
    /// Time between two beacons, microseconds.
    pub beacon_period_us: i32,
    /// How old news is when it arrives, microseconds: neighbours are taken to have gone on for so long.
    pub latency_us: i32,
    /// News older than this is stale, microseconds: a few beacon periods.
    pub stale_after_us: i32,
    /// Who is silent for longer is lost, microseconds; at most half an hour.
    pub lost_after_us: i32,
    /// How long a lost one is remembered, microseconds, at most half an hour.
    pub remember_us: i32,
    /// How long a stop stands that is not renewed, microseconds.
    pub stop_valid_us: i32,
    /// Time between two attempts of a request, microseconds.
    pub retry_interval_us: i32,
    /// Attempts of a request.
    pub retry_attempts: u8,
    /// Changes with each start (counted in lasting memory or drawn), or the others take a restarted robot for a recording.
    pub boot: u8,
    /// The flock that it is of; robots of other flocks are only in its way.
    pub flock: u8,
    /// StayaLaw.
    pub law: u8,
    /// StayaSafety.
    pub safety: u8,
    /// StayaWire.
    pub wire: u8,
    /// Radius of the ball around the body, metres.
    pub radius_m: f32,
    /// Cruising speed, m/s; the body's own limit holds too.
    pub speed_mps: f32,
    /// How near to its waypoint counts as being there, metres.
    pub tolerance_m: f32,
    /// How fast the body can change its velocity, m/s^2; FLT_MAX: at once.
    pub max_acceleration_mps2: f32,
    /// How fast to go when all others are lost, m/s: 0 stands until somebody speaks; above 0 only for robots that may be alone.
    pub alone_mps: f32,
    /// Largest radius that others are believed to have, metres; FLT_MAX: any.
    pub claims_max_radius_m: f32,
    /// Highest speed that they are believed to have, m/s; FLT_MAX: any, and places are not looked at.
    pub claims_max_speed_mps: f32,
    /// How far off two places of a robot may be besides, metres.
    pub claims_slack_m: f32,
    /// For how long a robot that has jumped must say consistent places, microseconds.
    pub claims_settle_us: i32,
    /// The greatest number of any robot.
    pub claims_last_id: u32,
    /// ORCA, in the plane and in space.
    pub orca: StayaOrca,
    /// Push-out.
    pub push_out: StayaPushOut,
    /// The lattice.
    pub lattice: StayaLattice,
    /// The goal flock.
    pub goal_flock: StayaGoalFlock,
    /// Boids.
    pub boids: StayaBoids,
    /// Routes.
    pub route: StayaRoute,
    /// Formations.
    pub formation: StayaFormation,
    /// With STAYA_WIRE_SEALED: how often the robot was started, counted in lasting memory from 0; below 2^20.
    pub starts: u32,
    /// With STAYA_WIRE_SEALED: the swarm's secret. The agent keeps a copy.
    pub key: [u8; STAYA_KEY],
}

plain!(StayaSetup);

/// What header and library must agree on.
const VERSION: u32 = u32::from_be_bytes(*b"sty1");

/// Numbers that must be above 0 and finite.
fn positive(numbers: &[f32]) -> Checked<()> {
    if numbers.iter().all(|number| *number > 0.0 && number.is_finite()) { Ok(()) } else { Err(StayaStatus::Number) }
}

impl StayaSetup {
    fn defaults(&mut self, id: u32, radius_m: f32, tick_us: i32) {
        let config = AgentConfig::new(RobotId(id), radius_m, Duration::from_micros(tick_us));
        let diameter_m = 2.0 * radius_m.max(0.05);
        self.version = VERSION;
        self.id = id;
        self.tick_us = tick_us;
        self.beacon_period_us = config.beacon_period.as_micros();
        self.stale_after_us = config.ages.stale_after.as_micros();
        self.lost_after_us = config.ages.expire_after.as_micros();
        self.remember_us = config.silence.remember.as_micros();
        self.stop_valid_us = config.stop_valid.as_micros();
        self.retry_interval_us = config.retry.interval.as_micros();
        self.retry_attempts = config.retry.attempts;
        self.radius_m = radius_m;
        self.speed_mps = 0.5;
        self.tolerance_m = 0.05;
        self.max_acceleration_mps2 = config.max_acceleration_mps2;
        self.alone_mps = config.silence.alone_mps;
        self.claims_max_radius_m = config.claims.max_radius_m;
        self.claims_max_speed_mps = config.claims.max_speed_mps;
        self.claims_slack_m = config.claims.slack_m;
        self.claims_settle_us = config.claims.settle.as_micros();
        self.claims_last_id = config.claims.last.0;
        self.safety = StayaSafety::Orca as u8;
        self.orca = StayaOrca::defaults();
        self.push_out.min_distance_m = 1.5 * diameter_m;
        self.lattice = StayaLattice::defaults(3.0 * diameter_m);
        self.goal_flock = StayaGoalFlock::defaults(1.5 * diameter_m);
        self.boids = StayaBoids::defaults(0.1 * diameter_m);
        #[cfg(feature = "grid")]
        laws::defaults(self);
    }

    /// What does not change while the robot runs.
    pub(crate) fn config(&self) -> Checked<AgentConfig<Number>> {
        if self.version != VERSION {
            return Err(StayaStatus::Version);
        }
        if self.id == 0 {
            return Err(StayaStatus::Nobody);
        }
        let times = [self.beacon_period_us, self.stale_after_us, self.lost_after_us, self.retry_interval_us];
        if self.tick_us <= 0 || times.iter().any(|time| *time <= 0) {
            return Err(StayaStatus::Number);
        }
        if !(self.radius_m >= 0.0 && self.radius_m.is_finite()) {
            return Err(StayaStatus::Number);
        }
        let us = Duration::from_micros;
        let config = AgentConfig::<f32> {
            id: RobotId(self.id),
            seed: self.seed,
            boot: self.boot,
            tick: us(self.tick_us),
            beacon_period: us(self.beacon_period_us),
            radius_m: self.radius_m,
            max_acceleration_mps2: self.max_acceleration_mps2,
            latency: us(self.latency_us.max(0)),
            ages: Ages { stale_after: us(self.stale_after_us), expire_after: us(self.lost_after_us) },
            retry: Retry { attempts: self.retry_attempts, interval: us(self.retry_interval_us) },
            stop_valid: us(self.stop_valid_us),
            silence: Silence { remember: us(self.remember_us), alone_mps: self.alone_mps },
            claims: Claims {
                max_radius_m: self.claims_max_radius_m,
                max_speed_mps: self.claims_max_speed_mps,
                slack_m: self.claims_slack_m,
                settle: us(self.claims_settle_us),
                last: RobotId(self.claims_last_id),
            },
            flock: self.flock,
        };
        Ok(config.cast())
    }

    /// The guidance law, just started.
    pub(crate) fn law(&self) -> Checked<Law> {
        let law = StayaLaw::of(self.law)?;
        if !matches!(law, StayaLaw::RouteOnGrid | StayaLaw::FormationOnGrid) {
            positive(&[self.speed_mps])?;
        }
        match law {
            StayaLaw::Waypoint => {
                positive(&[self.tolerance_m])?;
                Ok(Law::Waypoint(WaypointGuidance::new(cast(self.speed_mps), cast(self.tolerance_m))))
            }
            StayaLaw::Lattice | StayaLaw::GoalFlock | StayaLaw::Boids => {
                #[cfg(feature = "flocks")]
                {
                    flocks::law(self, law)
                }
                #[cfg(not(feature = "flocks"))]
                Err(StayaStatus::NotBuilt)
            }
            StayaLaw::Route | StayaLaw::Formation | StayaLaw::RouteOnGrid | StayaLaw::FormationOnGrid => {
                #[cfg(feature = "grid")]
                {
                    laws::law(self, law)
                }
                #[cfg(not(feature = "grid"))]
                Err(StayaStatus::NotBuilt)
            }
        }
    }

    /// The safety layer, just started.
    pub(crate) fn layer(&self) -> Checked<Layer> {
        let orca = |source| {
            positive(&[self.orca.horizon_s, self.orca.wall_horizon_s])?;
            Ok(Layer::Orca(OrcaSafety::with_source(self.orca.params(), self.orca.inflation(), source)))
        };
        match StayaSafety::of(self.safety)? {
            StayaSafety::None => Ok(Layer::None(Unguarded)),
            StayaSafety::Orca => orca(Source::Formula),
            #[cfg(feature = "table")]
            StayaSafety::OrcaTable => orca(Source::Table),
            #[cfg(feature = "space")]
            StayaSafety::Fly => {
                positive(&[self.orca.horizon_s, self.orca.wall_horizon_s])?;
                let source = InSpace { downwash: cast(self.orca.downwash) };
                let (params, inflation) = (self.orca.params(), self.orca.inflation());
                Ok(Layer::Fly(FlySafety::with_source(params, inflation, source)))
            }
            #[cfg(feature = "push-out")]
            StayaSafety::PushOut => {
                positive(&[self.push_out.min_distance_m])?;
                Ok(Layer::PushOut(PushOutSafety::new(self.push_out.params()?)))
            }
            #[cfg(not(all(feature = "table", feature = "space", feature = "push-out")))]
            _ => Err(StayaStatus::NotBuilt),
        }
    }

    /// How it speaks.
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

/// Fills a setup for robot `id` with what robots can do with: straight to waypoints at 0.5 m/s behind ORCA, a beacon each step, no
/// inertia, no latency. Lengths of the other laws follow from the radius.
///
/// `radius_m` is that of the ball around the body, metres; `tick_us` the time from one step to the next, microseconds. They are
/// judged by `staya_init`.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_setup_defaults(
    setup: *mut StayaSetup,
    id: u32,
    radius_m: f32,
    tick_us: i32,
) -> StayaStatus {
    // SAFETY: the caller gives room for a setup, or what `zeroed` refuses.
    answer(unsafe { zeroed(setup) }.map(|setup| setup.defaults(id, radius_m, tick_us)))
}
