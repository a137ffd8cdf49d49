//! What a robot's agent knows of itself from its start.

use super::Silence;
use crate::neighbor::{Ages, Claims};
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use crate::wire::Retry;
use serde::{Deserialize, Serialize};

/// What does not change while the robot runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AgentConfig<S> {
    /// Own number, 1 or more.
    pub id: RobotId,
    /// Seed of what the robot draws at random, together with its number.
    pub seed: u64,
    /// Changes with each start (counted in lasting memory, or drawn at random): with the old one a robot that has restarted is not heard
    /// until the others have forgotten it; see [`crate::wire::SequenceWindow`].
    pub boot: u8,
    /// More than 0. On the grid the time in which the robot crosses a cell of impassability 1; for robots that go by velocities the time
    /// from one step to the next, which must then be kept: the command is meant to hold for so long.
    pub tick: Duration,
    /// Time between two beacons. Longer saves the radio and makes everybody's news older.
    pub beacon_period: Duration,
    /// Radius of the ball around the body, metres.
    pub radius_m: S,
    /// How fast the body can change its velocity, m/s^2; [`Scalar::MAX`]: at once. For robots that do not
    /// move cell by cell.
    pub max_acceleration_mps2: S,
    /// How old news is when it arrives: neighbours are taken to have gone on for so long. At least 0.
    pub latency: Duration,
    /// How old news of others may be.
    pub ages: Ages,
    /// How requests are resent.
    pub retry: Retry,
    /// How long a stop stands that is not renewed: bounds what a lost "resume" costs.
    pub stop_valid: Duration,
    /// What it makes of silence.
    pub silence: Silence<S>,
    /// What others may say of themselves and be believed.
    pub claims: Claims<S>,
    /// The flock that it is of. Those of other flocks are nothing but in the way of one that [flocks](crate::flock). Any number;
    /// 0 too is a flock, of all who are in none. A robot in formation has 0: what says the flock on the air says its
    /// place there ([`Beacon::slot`](crate::wire::Beacon::slot)).
    pub flock: u8,
}

impl<S: Scalar> AgentConfig<S> {
    /// The same in another kind of number.
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
            silence: self.silence.cast(),
            claims: self.claims.cast(),
            flock: self.flock,
        }
    }

    /// What no robot can do without; `tick` and `radius_m` as the fields say. On the grid, where a body is its cell, the radius counts for
    /// nothing and may be 0.
    ///
    /// The rest: seed 0, flock 0, a beacon each tick, news stale after 4 and forgotten after 30 ticks, requests resent every
    /// 3 ticks, stops for 12 ticks, no inertia, no latency, and whatever others say of themselves is believed. Robots that go by velocities on real radios need their
    /// [`latency`](Self::latency) besides.
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
            silence: Silence::DEFAULT,
            claims: Claims::ANY,
            flock: 0,
        }
    }
}
