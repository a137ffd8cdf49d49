//! A user-defined guidance law: robots patrol a ring with even gaps. Each robot adjusts its speed
//! to stay midway between the nearest robots that it hears ahead and behind.
#![no_std]

use core::f32::consts::TAU;
use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec3};
use staya_controller::scalar::Scalar;

/// State and parameters of the law, which serde carries to devices, checkpoints and the trace hash.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Patrol {
    /// Radius of the ring, metres.
    pub ring_m: f32,
    /// Speed while the gaps are even, m/s.
    pub cruise_mps: f32,
}

impl Patrol {
    /// A ring of 8 m radius, at 0.5 m/s.
    pub const RING: Self = Self { ring_m: 8.0, cruise_mps: 0.5 };
}

impl<S: Scalar> Law<S> for Patrol {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = ();
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S>,
        _: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let number = |x: f32| S::from_f32(x).unwrap_or(S::ZERO);
        let (turn, place) = (number(TAU), view.state.position.since::<S>(Position::default()));
        let bearing = |place: Vec3<S>| place.y.atan2(place.x);
        // Smallest arcs to another robot, ahead and behind.
        let (mut ahead, mut behind) = (turn, turn);
        for other in view.nearby {
            let angle = bearing(place + other.offset_m) - bearing(place);
            let angle = if angle < S::ZERO { angle + turn } else { angle };
            (ahead, behind) = (ahead.min(angle), behind.min(turn - angle));
        }
        let out = place.normalized().unwrap_or_default();
        let along = out.xy().perp().extend(S::ZERO);
        let pace =
            number(self.cruise_mps) + ((ahead - behind) * number(4.0)).clamp(-number(0.4), number(0.4));
        let wish_mps = along * pace + out * (number(self.ring_m) - place.norm());
        let wish_mps = wish_mps.clamp_norm(view.body.max_speed_mps);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }
}
