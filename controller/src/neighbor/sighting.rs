//! What eyes tell, how it is taken, and what became of it.

use crate::geom::Vec3;
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// Another robot, as somebody's own sensors show it.
///
/// The place is relative to the own one, since that is what a camera or UWB measures and needs no frame in common: a robot that goes by
/// odometry alone avoids whom it sees. What is heard besides is in the common frame, and merging both needs it. Motion capture
/// tells places in it: subtract the own one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting<S> {
    /// Its place minus the own one when it was seen, metres, along the axes of the world (not of the body).
    pub offset_m: Vec3<S>,
    /// Standard deviation of that along each axis, metres; above 0. Less than 4 mm counts as 4 mm.
    pub deviation_m: S,
    /// How long ago it was seen; 0 or more.
    pub age: Duration,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// Who it is, if the sensor can tell; `None`: somebody.
    pub id: Option<RobotId>,
    /// Its world velocity and the standard deviation of that along each axis, m/s, if the sensor can tell.
    pub velocity_mps: Option<(Vec3<S>, S)>,
}

/// How sightings become neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TrackParams<S> {
    /// Standard deviation of the others' accelerations, m/s^2. Larger: the estimate follows turns sooner and believes each single
    /// sighting more; smaller: it is smoother, and late where somebody turns.
    pub acceleration_mps2: S,
    /// Standard deviation of the velocity along each axis of somebody who has just come into sight, m/s: about what others can do.
    pub speed_mps: S,
    /// Standard deviation of the places that others say, metres: their positioning.
    pub heard_m: S,
    /// Standard deviation of the velocities that others say, m/s: how well their bodies do what they say.
    pub heard_mps: S,
    /// How many standard deviations from where it should be a sighting may be and still be of that robot (and, whatever this is, as far as
    /// two bodies would overlap). Larger: two who pass
    /// each other are taken for each other; smaller: one robot becomes two.
    pub gate: S,
    /// How many standard deviations of its place are added to the radius of one that is seen. Smaller: errors lead to overlaps; larger:
    /// crowds stand still. (D. Hennes, D. Claes, W. Meeussen, K. Tuyls, "Multi-robot collision avoidance with localization
    /// uncertainty", AAMAS 2012, section 3: bodies grow by the error of localization.)
    pub margin: S,
    /// After how long one that says nothing and is not seen any more is forgotten. It is behind something or out of sight, so its silence
    /// is no sign that it is near. Longer: who comes out from behind others is known sooner, and places where somebody was are kept
    /// clear for longer. With more than [`Ages::stale_after`](super::Ages::stale_after) it counts as fallen silent meanwhile.
    pub forget: Duration,
}

impl<S: Scalar> TrackParams<S> {
    /// The same in another kind of number.
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

/// What became of the sightings of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighted {
    /// Of robots that were known.
    pub known: u16,
    /// Of robots that were not.
    pub new: u16,
    /// Of one robot a second time: of the same number, or in the place of one that was seen already.
    pub repeated: u16,
    /// That cannot be: no numbers, a deviation of 0 or less, an age below 0, the own number, one that no robot has.
    pub refused: u16,
    /// For which there is no room.
    pub no_room: u16,
}

impl<S: Scalar> Sighting<S> {
    /// Whether it can be what robot `own` saw.
    pub(super) fn is_sound(&self, own: RobotId) -> bool {
        let Self { offset_m, deviation_m, age, radius_m, id, velocity_mps } = self;
        let is_size = |x: S| x.is_finite() && x >= S::ZERO;
        offset_m.is_finite()
            && is_size(*deviation_m)
            && *deviation_m > S::ZERO
            && is_size(*radius_m)
            && *age >= Duration::ZERO
            && id.is_none_or(|id| id.is_somebody() && id != own && id.doubled().is_none() && !id.is_local())
            && velocity_mps.is_none_or(|(v, deviation)| v.is_finite() && is_size(deviation))
    }
}
