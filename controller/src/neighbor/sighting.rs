//! Detections of other robots by sensors, the parameters of tracking them, and the counts of a
//! step.

use crate::geom::Vec3;
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// A detection of another robot by the robot's own sensors.
///
/// The position is relative to the own one: a camera or UWB measures it without a common frame, so
/// a robot with odometry alone can avoid other robots. Beacons are in the common frame; merging
/// them with detections requires it. Motion capture reports positions in the common frame; subtract
/// the own position.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting<S> {
    /// Its position minus the own position at the time of the detection, metres, along world axes
    /// (not body axes).
    pub offset_m: Vec3<S>,
    /// Standard deviation of the offset along each axis, metres; above 0. Values below 4 mm count
    /// as 4 mm.
    pub deviation_m: S,
    /// Time since the detection; 0 or more.
    pub age: Duration,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// The id, if the sensor identifies the robot; `None` for an anonymous detection.
    pub id: Option<RobotId>,
    /// Its world velocity and the standard deviation along each axis, m/s, if the sensor measures
    /// it.
    pub velocity_mps: Option<(Vec3<S>, S)>,
}

/// Parameters of tracking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TrackParams<S> {
    /// Standard deviation of the other robots' accelerations, m/s^2. Larger: the estimate follows
    /// turns sooner and weights each detection more. Smaller: it is smoother and lags behind turns.
    pub acceleration_mps2: S,
    /// Standard deviation of the velocity of a new track along each axis, m/s: about the speed of
    /// other robots.
    pub speed_mps: S,
    /// Standard deviation of the positions in beacons, metres: the positioning error of the sender.
    pub heard_m: S,
    /// Standard deviation of the velocities in beacons, m/s: how well a body follows its reported
    /// velocity.
    pub heard_mps: S,
    /// Largest distance between a detection and the predicted position of its track, in standard
    /// deviations. A detection that would overlap the body of the track matches at any value.
    /// Larger: two robots that pass each other are confused. Smaller: one robot becomes two.
    pub gate: S,
    /// Standard deviations of the position that are added to the radius of a tracked robot.
    /// Smaller: errors lead to overlaps. Larger: crowds come to a stop. (D. Hennes, D. Claes, W.
    /// Meeussen, K. Tuyls, "Multi-robot collision avoidance with localization uncertainty", AAMAS
    /// 2012, section 3: bodies grow by the localization error.)
    pub margin: S,
    /// Time after which a robot without beacons that is out of sight is forgotten. Such a robot is
    /// occluded or out of view, so its silence does not mean that it is near. Longer: a robot that
    /// reappears is known sooner, and its last position stays blocked for longer. Above
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
    /// Repeated detections of one robot: with an id already seen in this step, or inside the body
    /// of a robot already seen.
    pub repeated: u16,
    /// Invalid: a value that is not a number, a deviation of 0 or less, a negative age, the own id,
    /// or an id that no robot can have.
    pub refused: u16,
    /// Dropped because all detections or tracks of the fixed buffers are in use.
    pub no_room: u16,
}

impl<S: Scalar> Sighting<S> {
    /// Returns whether this can be a detection by robot `own`.
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
