//! Groups of identical robots: body, law and safety layer.

use super::super::law::LawSetup;
use super::super::ranges::{duration, micros, short};
use super::super::source::Checked;
use super::body::Group;
use super::checks;
use super::table::OrcaTable;
use crate::world::plane::Abilities;
use staya_controller::agent::{ContactLossPolicy, Goals, SafetyKind, SafetySetup};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::parameters::TOLERANCE;
use staya_controller::push_out::{Evasion, Model, PushOutParams};
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
    pub safety: SafetySetup,
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
        if let SafetySetup::Orca { params, .. } | SafetySetup::Fly { params, .. } = &mut self.safety {
            params.horizon_s = params.horizon_s.max(least_s);
        }
    }

    /// Whether the safety layer avoids robots that have fallen silent.
    #[must_use]
    pub fn tracks_silence(&self) -> bool {
        !matches!(self.safety.kind(), SafetyKind::None | SafetyKind::PushOut)
    }

    /// Ratio of the vertical to the horizontal separation; 1 for groups that do not fly.
    #[must_use]
    pub fn downwash(&self) -> f64 {
        match self.safety {
            SafetySetup::Fly { downwash, .. } => downwash.into(),
            _ => 1.0,
        }
    }
}

/// Sets the growth rates that are not given to the speed of the fastest robot.
pub(super) fn grow_as_the_fastest(general: &mut RobotGroup, groups: &mut [RobotGroup]) {
    let speed = |group: &RobotGroup| group.abilities.max_speed_mps as f32;
    let fastest_mps = groups.iter().map(speed).fold(speed(general), f32::max);
    for group in groups.iter_mut().chain([general]).filter(|group| group.grows_as_the_fastest) {
        if let SafetySetup::Orca { inflation, .. } | SafetySetup::Fly { inflation, .. } = &mut group.safety {
            inflation.growth_mps = fastest_mps;
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
        let orca = body.orca.clone().unwrap_or_default();
        let law = self.law(cruise_mps, tolerance_m)?;
        checks::law(self, &law)?;
        let safety = self.safety(&abilities, &orca)?;
        let has_orca = !matches!(body.safety, SafetyKind::None | SafetyKind::PushOut);
        let remedy = format!("give {}.safety = \"orca\", or leave this table out", self.at.path);
        self.at.require(has_orca || body.orca.is_none(), "orca", "these robots have another safety layer", remedy)?;
        Ok(RobotGroup {
            abilities,
            radius_m: body.radius_m,
            cruise_mps,
            tolerance_m,
            sight_m: body.sight_m,
            law,
            safety,
            grows_as_the_fastest: orca.inflation_mps.is_none(),
            contact_loss: contact_loss(&orca),
            listen: orca.listen_s.map(duration),
            expects_others: orca.expects_others,
            flock: self.flock,
        })
    }

    fn safety(&self, abilities: &Abilities, table: &OrcaTable) -> Checked<SafetySetup> {
        let mut params = self.look_ahead();
        let brake_s = abilities.least_horizon_s();
        params.horizon_s = params.horizon_s.max(brake_s as f32);
        if let Some(given) = table.params.get("horizon_s").filter(|&given| given < brake_s) {
            let what = format!("{} is less than 2 (max_speed_mps / max_acceleration_mps2 + lag_s)", short(given));
            let remedy = format!("give {} seconds or more, or leave it out", short(brake_s));
            return Err(self.at.error("orca.horizon_s", what, remedy));
        }
        table.params.store(&mut params);
        let inflation = StalenessInflation {
            growth_mps: table.inflation_mps.unwrap_or(self.body.max_speed_mps) as f32,
            max_m: table.inflation_m.unwrap_or(self.body.radius_m) as f32,
        };
        let mut setup = self.body.safety.setup(params, inflation, self.push_out()?);
        match (&mut setup, table.downwash) {
            (_, None) => {}
            (SafetySetup::Fly { downwash, .. }, Some(value)) => *downwash = value as f32,
            (_, Some(_)) => {
                let what = "robots in the plane are not above each other";
                return Err(self.at.error("orca.downwash", what, "give safety = \"fly\", or leave it out"));
            }
        }
        Ok(setup)
    }

    /// A flock has the longest look-ahead: its members move together, and have no places of their
    /// own that they could be late at. So have flyers, which jam in a downwash with less.
    fn look_ahead(&self) -> AvoidParams<f32> {
        if !self.has_goals() || self.body.safety == SafetyKind::Fly {
            return AvoidParams::default();
        }
        AvoidParams::for_body(self.body.radius_m as f32, self.body.max_speed_mps as f32)
    }

    fn push_out(&self) -> Checked<PushOutParams<f32>> {
        let mut params = PushOutParams::new(1.0);
        let given = self.body.push_out.as_ref();
        let go_together = (self.body.safety == SafetyKind::PushOut) == given.is_some();
        let what = "safety \"push_out\" and its table go together";
        self.at.require(go_together, "push_out", what, "give both or none of them")?;
        let Some(given) = given else { return Ok(params) };
        let jams = self.kind.goals() == Goals::Waypoints && given.model == Model::Tangential;
        let what = "robots that go straight to a place jam for ever in each other's way";
        self.at.require(!jams, "push_out.model", what, "give \"radial\", or safety \"orca\"")?;
        given.params.store(&mut params);
        params.model = given.model;
        params.evasion = if given.single { Evasion::Single } else { Evasion::Multiple };
        Ok(params)
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
