//! The configuration of the agent of one robot.

use super::ContactLossPolicy;
use crate::neighbor::{Ages, PlausibilityLimits, Rounding, TooCoarse};
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use crate::wire::Retry;
use serde::{Deserialize, Serialize};

/// The configuration of one robot, fixed while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AgentConfig<S> {
    /// Own id, 1 or more.
    pub id: RobotId,
    /// Seed of the random numbers, combined with the id.
    pub seed: u64,
    /// Boot number, which must change at each start (a non-volatile counter, or random). Otherwise
    /// other robots ignore this robot for a time; see [`crate::wire::SequenceWindow`].
    pub boot: u8,
    /// Time base; above 0. On the grid, the time to cross a cell of impassability 1. In the plane,
    /// the time between two steps and the time for which each command is carried out. A step may
    /// come later, if the body stands meanwhile, but not earlier.
    pub tick: Duration,
    /// Whether all robots decide at the same instants, as robots of a simulator may. Robots with
    /// clocks of their own do not.
    pub is_synchronous: bool,
    /// Time between two beacons, the same in all robots of a swarm with a key, whose numbers count
    /// these periods. A longer period saves airtime but gives neighbours older states.
    pub beacon_period: Duration,
    /// Radius of the ball around the body, metres.
    pub radius_m: S,
    /// Largest acceleration in the plane, m/s^2; [`Scalar::MAX`] for no limit.
    pub max_acceleration_mps2: S,
    /// Time constant with which the body follows a velocity command (first order), seconds; 0 for a
    /// body that follows at once. A body has the same one in all directions.
    pub lag_s: S,
    /// Greatest age of a beacon when it is first used; at least 0. Neighbours are extrapolated over
    /// this time. In the plane, a tick for a radio that takes less than a quarter of a tick, if
    /// each step reads all packets that have arrived; a tick more for each further tick that it may
    /// take.
    pub latency: Duration,
    /// Ages at which the state of a neighbour counts as stale and as expired.
    pub ages: Ages,
    /// How messages of laws are resent.
    pub retry: Retry,
    /// Lifetime of a message that laws on the grid send, and of a stop that is not renewed: it
    /// bounds the cost of a lost resume.
    pub message_valid: Duration,
    /// The reaction to lost contact.
    pub contact_loss: ContactLossPolicy<S>,
    /// Limits on the values that other robots may report.
    pub plausibility: PlausibilityLimits<S>,
    /// Frames behind each beacon that relay the last beacons of robots which the law needs, for
    /// members of a formation that distance or land hides from each other, at most
    /// [`RELAYS`](super::RELAYS). 0: none is relayed, and none is received. A frame must arrive
    /// within [`latency`](Self::latency) and a beacon period,
    /// or states get younger from robot to robot.
    pub relays: u8,
    /// The own flock. A robot that [flocks](crate::flock) treats members of other flocks as
    /// obstacles.
    pub flock: u8,
}

impl<S: Scalar> AgentConfig<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> AgentConfig<T> {
        AgentConfig {
            id: self.id,
            seed: self.seed,
            boot: self.boot,
            tick: self.tick,
            is_synchronous: self.is_synchronous,
            beacon_period: self.beacon_period,
            radius_m: cast(self.radius_m),
            max_acceleration_mps2: cast(self.max_acceleration_mps2),
            lag_s: cast(self.lag_s),
            latency: self.latency,
            ages: self.ages,
            retry: self.retry,
            message_valid: self.message_valid,
            contact_loss: self.contact_loss.cast(),
            plausibility: self.plausibility.cast(),
            relays: self.relays,
            flock: self.flock,
        }
    }

    /// Returns whether the gaps that robots keep cover all rounding errors, if no robot is faster
    /// than `fastest_mps`. Check it when a robot is configured, for a safety layer with
    /// [`inflation`](super::Safety::inflation).
    ///
    /// # Errors
    /// The tick, the speed, or the way in [`expire_after`](Ages::expire_after) is too long.
    pub fn check_rounding(&self, fastest_mps: S, is_in_space: bool) -> Result<(), TooCoarse> {
        let range_m = fastest_mps * S::from_micro(self.ages.expire_after.as_micros());
        Rounding {
            step: self.tick,
            fastest_mmps: fastest_mps.to_milli().unwrap_or(i32::MAX),
            range_m: range_m.floor_to_i32().unwrap_or(i32::MAX),
            is_in_space,
        }
        .check()
    }

    /// Creates a configuration from the values that every robot needs (on the grid any `radius_m`).
    ///
    /// Defaults: seed 0, boot 0, flock 0, a beacon per tick, states stale after 4 ticks and expired
    /// after 30, messages resent every 3 ticks, valid for 12 ticks, no inertia, no lag, no
    /// latency (set [`latency`](Self::latency) for a real radio in the plane), steps at any
    /// instants, and no plausibility limits.
    #[must_use]
    pub const fn new(id: RobotId, radius_m: S, tick: Duration) -> Self {
        Self {
            id,
            seed: 0,
            boot: 0,
            tick,
            is_synchronous: false,
            beacon_period: tick,
            radius_m,
            max_acceleration_mps2: S::MAX,
            lag_s: S::ZERO,
            latency: Duration::ZERO,
            ages: Ages { stale_after: tick.saturating_mul(4), expire_after: tick.saturating_mul(30) },
            retry: Retry { attempts: 5, interval: tick.saturating_mul(3) },
            message_valid: tick.saturating_mul(12),
            contact_loss: ContactLossPolicy::DEFAULT,
            plausibility: PlausibilityLimits::ANY,
            relays: 0,
            flock: 0,
        }
    }
}
