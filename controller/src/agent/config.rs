//! The configuration with which the agent of one robot starts.

use super::ContactLossPolicy;
use crate::neighbor::{Ages, PlausibilityLimits};
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
    /// Seed of the robot's random numbers, combined with its id.
    pub seed: u64,
    /// Boot number, which must change at each start (a counter in non-volatile memory, or a random
    /// number). After a restart with an unchanged number, other robots ignore this robot until they
    /// have forgotten it; see [`crate::wire::SequenceWindow`].
    pub boot: u8,
    /// Time base; above 0. On the grid, the time to cross a cell of impassability 1. For robots
    /// that move by velocities, the time between two steps, which the caller must keep, since a
    /// command is planned for exactly that time.
    pub tick: Duration,
    /// Time between two beacons. A longer period saves airtime, and neighbours work with older
    /// states.
    pub beacon_period: Duration,
    /// Radius of the ball around the body, metres.
    pub radius_m: S,
    /// Largest acceleration of the body, m/s^2; [`Scalar::MAX`] for no limit. Used by robots that
    /// move by velocities.
    pub max_acceleration_mps2: S,
    /// Age of a beacon when it arrives; at least 0. Neighbours are extrapolated over this time.
    pub latency: Duration,
    /// Ages at which the state of a neighbour counts as stale and as expired.
    pub ages: Ages,
    /// How requests are resent.
    pub retry: Retry,
    /// Lifetime of a stop request that is not renewed. It bounds the delay that a lost resume
    /// request costs.
    pub stop_valid: Duration,
    /// The reaction to lost contact.
    pub contact_loss: ContactLossPolicy<S>,
    /// Limits on the values that other robots may report.
    pub plausibility: PlausibilityLimits<S>,
    /// The own flock. A robot that [flocks](crate::flock) treats members of other flocks as
    /// obstacles only. Flock 0 is the flock of all robots that belong to none.
    ///
    /// A robot in formation has flock 0, because its beacon carries its place there in the field of
    /// the flock ([`Beacon::slot`](crate::wire::Beacon::slot)).
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
            beacon_period: self.beacon_period,
            radius_m: cast(self.radius_m),
            max_acceleration_mps2: cast(self.max_acceleration_mps2),
            latency: self.latency,
            ages: self.ages,
            retry: self.retry,
            stop_valid: self.stop_valid,
            contact_loss: self.contact_loss.cast(),
            plausibility: self.plausibility.cast(),
            flock: self.flock,
        }
    }

    /// Creates a configuration from the values that every robot needs. On the grid a body is a
    /// cell, so the radius is unused and may be 0.
    ///
    /// Defaults: seed 0, boot 0, flock 0, a beacon per tick, states stale after 4 ticks and expired
    /// after 30, requests resent every 3 ticks, stops valid for 12 ticks, no inertia, no latency,
    /// and no plausibility limits. A robot that moves by velocities with a real radio also needs
    /// its [`latency`](Self::latency).
    #[must_use]
    pub const fn new(id: RobotId, radius_m: S, tick: Duration) -> Self {
        Self {
            id,
            seed: 0,
            boot: 0,
            tick,
            beacon_period: tick,
            radius_m,
            max_acceleration_mps2: S::MAX,
            latency: Duration::ZERO,
            ages: Ages { stale_after: tick.saturating_mul(4), expire_after: tick.saturating_mul(30) },
            retry: Retry { attempts: 5, interval: tick.saturating_mul(3) },
            stop_valid: tick.saturating_mul(12),
            contact_loss: ContactLossPolicy::DEFAULT,
            plausibility: PlausibilityLimits::ANY,
            flock: 0,
        }
    }
}
