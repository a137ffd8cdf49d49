//! Detections of other robots by sensors, parameters of tracking, and counts of a step.

use crate::geom::Vec3;
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// A detection of another robot by the robot's own sensors (camera, UWB, motion capture).
///
/// Its position is relative to the own one, so a robot with odometry alone can avoid others.
/// Beacons are in the common frame; merging them with detections requires that frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting<S> {
    /// Its position minus the own position at the time of the detection, metres, along world axes.
    pub offset_m: Vec3<S>,
    /// Standard deviation of the offset along each axis, metres; above 0, at least 4 mm is used.
    pub deviation_m: S,
    /// Time since the detection; 0 or more.
    pub age: Duration,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// The id, if the sensor identifies the robot; `None` for an anonymous detection.
    pub id: Option<RobotId>,
    /// Its world velocity and the standard deviation along each axis, m/s, if measured.
    pub velocity_mps: Option<(Vec3<S>, S)>,
}

/// Parameters of tracking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TrackParams<S> {
    /// Standard deviation of the other robots' accelerations, m/s^2. Larger: the estimate follows
    /// turns sooner. Smaller: it is smoother and lags behind.
    pub acceleration_mps2: S,
    /// Standard deviation of the velocity of a new track, m/s: about the speed of other robots.
    pub speed_mps: S,
    /// Standard deviation of the positions in beacons, metres: the sender's positioning error.
    pub heard_m: S,
    /// Standard deviation of the velocities in beacons, m/s: how well bodies follow them.
    pub heard_mps: S,
    /// Largest distance between a detection and the prediction of its track, in standard
    /// deviations; a detection that would overlap the body matches anyway. Larger: robots that pass
    /// each other are confused. Smaller: one robot becomes two.
    pub gate: S,
    /// Standard deviations of the position that are added to the radius of a tracked robot.
    /// Smaller: overlaps. Larger: crowds stop. (D. Hennes, D. Claes, W. Meeussen, K. Tuyls,
    /// "Multi-robot collision avoidance with localization uncertainty", AAMAS 2012, section 3.)
    pub margin: S,
    /// Time after which a robot without beacons that is out of sight is forgotten. Longer: a robot
    /// that reappears is known sooner, and its last position stays blocked. Above
    /// [`Ages::stale_after`](super::Ages::stale_after) it counts as silent meanwhile.
    pub forget: Duration,
}

impl<S: Scalar> TrackParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> TrackParams<T> {
        TrackParams {
            acceleration_mps2: cast(self.acceleration_mps2),
            speed_mps: cast(self.speed_mps),
            heard_m: cast(self.heard_m),
            heard_mps: cast(self.heard_mps),
            gate: cast(self.gate),
            margin: cast(self.margin),
            forget: self.forget,
        }
    }
}

/// Counts of the detections of a step by their result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighted {
    /// Assigned to an existing track.
    pub known: u16,
    /// Started a new track.
    pub new: u16,
    /// Repeated: an id already seen in this step, or inside the body of a robot already seen.
    pub repeated: u16,
    /// Invalid: not a number, deviation of 0 or less, negative age, own or impossible id.
    pub refused: u16,
    /// Dropped: all detections or tracks of the fixed buffers are in use.
    pub no_room: u16,
}

impl<S: Scalar> Sighting<S> {
    pub(super) fn is_sound(&self, own: RobotId) -> bool {
        let Self { offset_m, deviation_m, age, radius_m, id, velocity_mps } = self;
        let is_size = |x: S| x.is_finite() && x >= S::ZERO;
        offset_m.is_finite()
            && is_size(*deviation_m)
            && *deviation_m > S::ZERO
            && is_size(*radius_m)
            && *age >= Duration::ZERO
            && id.is_none_or(|id| id.is_some() && id != own && id.duplicate_of().is_none() && !id.is_local())
            && velocity_mps.is_none_or(|(v, deviation)| v.is_finite() && is_size(deviation))
    }
}
