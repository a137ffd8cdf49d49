//! Groups of identical robots: body, law and safety layer.

use super::super::grid::around;
use super::super::law::LawSetup;
use super::super::layer::OrcaTable;
use super::super::ranges::{duration, micros};
use super::super::source::Checked;
use super::body::Group;
use super::checks;
use crate::voxel::NeighborModel;
use crate::world::plane::Abilities;
use staya_controller::agent::{Around, ContactLossPolicy, Goals, LayerSettings};
use staya_controller::parameters::TOLERANCE;
use staya_controller::push_out::Model;
use staya_controller::time::Duration;

/// Properties that the robots of a group have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotGroup {
    /// Speed and acceleration limits.
    pub abilities: Abilities,
    /// Radius of the body, metres.
    pub radius_m: f64,
    /// Preferred speed, m/s.
    pub cruise_mps: f64,
    /// Distance at which a goal counts as reached, metres.
    pub tolerance_m: f64,
    /// Range of obstacle detection, metres.
    pub sight_m: f64,
    /// The law; formations add the robot's place.
    pub law: LawSetup,
    /// The safety layer.
    pub safety: LayerSettings,
    /// The model that replaces ORCA's formula; `None`: none.
    pub half_planes: Option<NeighborModel>,
    /// Whether the ball around a silent robot grows as fast as the fastest robot moves.
    grows_as_the_fastest: bool,
    /// Reaction to loss of contact.
    pub contact_loss: ContactLossPolicy<f32>,
    /// How long its robots listen before they move. `None`: as long as the radio needs.
    pub listen: Option<Duration>,
    /// Whether they stand until they have heard another robot. `None`: if another one that works
    /// starts within radio range.
    pub expects_others: Option<bool>,
    /// Flock number; robots of different flocks avoid each other but do not flock together.
    pub flock: u8,
}

impl RobotGroup {
    /// Raises the lag of the bodies to at least `lag_s`, and the look-ahead for robots as needed.
    pub fn raise_lag(&mut self, lag_s: f64) {
        self.abilities.lag_s = self.abilities.lag_s.max(lag_s);
        let least_s = self.abilities.least_horizon_s() as f32;
        if let Some(orca) = self.safety.orca_mut() {
            orca.params.horizon_s = orca.params.horizon_s.max(least_s);
        }
    }

    /// Whether the safety layer avoids robots that have fallen silent.
    #[must_use]
    pub const fn tracks_silence(&self) -> bool {
        self.safety.orca().is_some()
    }

    /// Ratio of the vertical to the horizontal separation; 1 for groups that do not fly.
    #[must_use]
    pub fn downwash(&self) -> f64 {
        match self.safety {
            LayerSettings::Fly(fly) => fly.downwash.into(),
            _ => 1.0,
        }
    }
}

/// Sets the growth rates that are not given to the speed of the fastest robot.
pub(super) fn grow_as_the_fastest(general: &mut RobotGroup, groups: &mut [RobotGroup]) {
    let speed = |group: &RobotGroup| group.abilities.max_speed_mps as f32;
    let fastest_mps = groups.iter().map(speed).fold(speed(general), f32::max);
    for group in groups.iter_mut().chain([general]).filter(|group| group.grows_as_the_fastest) {
        if let Some(orca) = group.safety.orca_mut() {
            orca.inflation.growth_mps = fastest_mps;
        }
    }
}

impl Group<'_> {
    pub fn build(&self) -> Checked<RobotGroup> {
        let body = &self.body;
        let cruise_mps = body.cruise_mps.unwrap_or(body.max_speed_mps);
        let slowest_mps = 0.001_f64.min(body.max_speed_mps);
        self.at.within("cruise_mps", cruise_mps, slowest_mps..=body.max_speed_mps, "m/s")?;
        let tolerance_m = body.tolerance_m.unwrap_or(body.radius_m / 10.0);
        self.at.limit("tolerance_m", tolerance_m, &super::Limits::of(&TOLERANCE))?;
        let abilities = Abilities {
            max_speed_mps: body.max_speed_mps,
            max_acceleration_mps2: body.max_acceleration_mps2,
            lag_s: body.lag_s,
            step_s: f64::from(micros(self.draft.step_s())) / 1e6,
            tick_s: f64::from(micros(self.draft.file.tick_s)) / 1e6,
        };
        let around = Around {
            radius_m: body.radius_m as f32,
            max_speed_mps: body.max_speed_mps as f32,
            fastest_mps: body.max_speed_mps as f32,
            brake_s: abilities.least_horizon_s() as f32,
            has_goal: self.has_goals(),
            ..around(self.draft, Some(cruise_mps), tolerance_m)?
        };
        let law = self.law(&around)?;
        checks::law(self, &law)?;
        let safety = body.layer.build(&self.at, &around)?;
        let half_planes = body.layer.half_planes(&self.at, safety)?;
        let jams = self.kind.goals() == Goals::Waypoints
            && matches!(&safety, LayerSettings::PushOut(push_out) if push_out.params.model == Model::Tangential);
        let what = "robots that go straight to a place jam for ever in each other's way";
        self.at.require(!jams, "push_out.model", what, "give \"radial\", or safety \"orca\"")?;
        let beside = &body.layer.beside;
        Ok(RobotGroup {
            abilities,
            radius_m: body.radius_m,
            cruise_mps,
            tolerance_m,
            sight_m: body.sight_m,
            law,
            safety,
            half_planes,
            grows_as_the_fastest: body.layer.get("inflation_mps").is_none(),
            contact_loss: contact_loss(beside),
            listen: beside.listen_s.map(duration),
            expects_others: beside.expects_others,
            flock: self.flock,
        })
    }
}

fn contact_loss(table: &OrcaTable) -> ContactLossPolicy<f32> {
    let usual = ContactLossPolicy::DEFAULT;
    ContactLossPolicy {
        stands_after: table.stands_after_s.map_or(usual.stands_after, duration),
        alone_mps: table.alone_mps.map_or(usual.alone_mps, |mps| mps.min(f64::from(f32::MAX)) as f32),
        ..usual
    }
}
