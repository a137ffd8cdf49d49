//! Groups of identical robots: body, law and safety layer.

use super::super::ranges::{self, range, short};
use super::super::source::Source;
use super::super::{ScenarioError, ScenarioFile, params};
use super::fields::Group;
use super::flocks;
use super::table::OrcaTable;
use crate::world::plane::Abilities;
use staya_controller::agent::{AnyHalfPlanes, ContactLossPolicy, GuidanceKind, GuidanceSetup, SafetyKind, SafetySetup};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::parameters::{MIN_DISTANCE, TOLERANCE};
use staya_controller::push_out::{Evasion, Model, PushOutParams};
use staya_controller::template::Template;
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
    /// The guidance law.
    pub guidance: GuidanceSetup,
    /// The safety layer.
    pub safety: SafetySetup,
    /// Reaction to loss of contact.
    pub contact_loss: ContactLossPolicy<f32>,
    /// How long its robots listen before they move. `None`: as long as the radio needs.
    pub listen: Option<Duration>,
    /// Flock number; robots of different flocks avoid each other but do not flock together.
    pub flock: u8,
}

impl RobotGroup {
    /// Creates robots that go straight to their goals, with ORCA as the safety layer: the defaults
    /// of a `[plane]` with only the required fields.
    #[must_use]
    pub fn new(abilities: Abilities, radius_m: f64) -> Self {
        let (cruise_mps, tolerance_m) = (abilities.max_speed_mps, radius_m / 10.0);
        let inflation = inflation(cruise_mps, radius_m);
        Self {
            abilities,
            radius_m,
            cruise_mps,
            tolerance_m,
            sight_m: 10.0,
            guidance: waypoint(cruise_mps, tolerance_m),
            safety: SafetySetup::Orca { params: AvoidParams::default(), inflation, source: AnyHalfPlanes::Analytic },
            contact_loss: ContactLossPolicy::DEFAULT,
            listen: None,
            flock: 0,
        }
    }

    /// Raises the lag of the bodies to at least `lag_s`, and the look-ahead for robots as needed.
    pub fn raise_lag(&mut self, lag_s: f64) {
        self.abilities.lag_s = self.abilities.lag_s.max(lag_s);
        let least_s = self.abilities.least_horizon_s() as f32;
        if let SafetySetup::Orca { params, .. } | SafetySetup::Fly { params, .. } = &mut self.safety {
            params.horizon_s = params.horizon_s.max(least_s);
        }
    }

    /// Returns this group with the waypoint law and the given arrival tolerance, metres.
    #[must_use]
    pub fn to_places(mut self, tolerance_m: f64) -> Self {
        self.tolerance_m = tolerance_m;
        self.guidance = waypoint(self.cruise_mps, tolerance_m);
        self
    }

    /// Ratio of the vertical to the horizontal separation; 1 for groups that do not fly.
    #[must_use]
    pub fn downwash(&self) -> f64 {
        match self.safety {
            SafetySetup::Fly { downwash, .. } => downwash.into(),
            _ => 1.0,
        }
    }

    /// Returns this group with another safety layer. It takes those of the parameters that the
    /// layer uses, and the default inflation of silent robots.
    #[must_use]
    pub fn behind(mut self, safety: SafetyKind, orca: AvoidParams<f32>, push_out: PushOutParams<f32>) -> Self {
        self.safety = safety.setup(orca, inflation(self.abilities.max_speed_mps, self.radius_m), push_out);
        self
    }
}

/// Raises the default growth rate to the speed of the fastest robot; explicit rates are kept.
pub(super) fn grow_as_the_fastest(general: &mut RobotGroup, groups: &mut [RobotGroup]) {
    let speed = |group: &RobotGroup| group.abilities.max_speed_mps;
    let fastest_mps = groups.iter().map(speed).fold(speed(general), f64::max) as f32;
    for group in groups.iter_mut().chain([general]) {
        let usual = inflation(group.abilities.max_speed_mps, group.radius_m).growth_mps;
        if let SafetySetup::Orca { inflation, .. } | SafetySetup::Fly { inflation, .. } = &mut group.safety
            && inflation.growth_mps == usual
        {
            inflation.growth_mps = fastest_mps;
        }
    }
}

const fn waypoint(cruise_mps: f64, tolerance_m: f64) -> GuidanceSetup {
    GuidanceSetup::Waypoint { speed_mps: cruise_mps as f32, tolerance_m: tolerance_m as f32 }
}

const fn inflation(max_speed_mps: f64, radius_m: f64) -> StalenessInflation<f32> {
    StalenessInflation { growth_mps: max_speed_mps as f32, max_m: radius_m as f32 }
}

impl Group {
    pub fn build(&self, source: &Source<'_>, file: &ScenarioFile) -> Result<RobotGroup, ScenarioError> {
        let body = &self.body;
        if body.max_acceleration_mps2.is_nan() || body.max_acceleration_mps2 <= 0.0 {
            let what = format!("{} is out of range", short(body.max_acceleration_mps2));
            let remedy = "give more than 0, in m/s^2, or inf";
            return Err(source.error(&self.field("max_acceleration_mps2"), what, remedy));
        }
        let cruise_mps = body.cruise_mps.unwrap_or(body.max_speed_mps);
        let slowest_mps = 0.001_f64.min(body.max_speed_mps);
        self.within(source, "cruise_mps", cruise_mps, [slowest_mps, body.max_speed_mps], "m/s")?;
        let tolerance_m = body.tolerance_m.unwrap_or(body.radius_m / 10.0);
        self.within(source, "tolerance_m", tolerance_m, range(&TOLERANCE), "metres")?;
        let abilities = Abilities {
            max_speed_mps: body.max_speed_mps,
            max_acceleration_mps2: body.max_acceleration_mps2,
            lag_s: body.lag_s,
            step_s: f64::from(ranges::micros(file.tick_s)) / 1e6,
        };
        let orca = body.orca.unwrap_or_default();
        let group = RobotGroup {
            abilities,
            radius_m: body.radius_m,
            cruise_mps,
            tolerance_m,
            sight_m: body.sight_m,
            guidance: self.guidance(source, file, cruise_mps, tolerance_m)?,
            safety: self.safety(source, &abilities, &orca)?,
            contact_loss: contact_loss(&orca),
            listen: orca.listen_s.map(duration),
            flock: self.flock,
        };
        if matches!(body.safety, SafetyKind::None | SafetyKind::PushOut) && body.orca.is_some() {
            let remedy = format!("give {}.safety = \"orca\", or leave this table out", self.table);
            return Err(source.error(&self.field("orca"), "these robots have another safety layer", remedy));
        }
        Ok(group)
    }

    fn guidance(
        &self,
        source: &Source<'_>,
        file: &ScenarioFile,
        cruise_mps: f64,
        tolerance_m: f64,
    ) -> Result<GuidanceSetup, ScenarioError> {
        let flocks = [
            flocks::lattice(source, file, self)?,
            flocks::goal_flock(source, self, cruise_mps, file.seed)?,
            flocks::boids(source, self, cruise_mps)?,
        ];
        // Each function refuses a table without its law, and a flocking law without its table.
        if let Some(flock) = flocks.into_iter().flatten().next() {
            return Ok(flock);
        }
        if !self.body.guidance.is_on_grid() {
            return Ok(waypoint(cruise_mps, tolerance_m));
        }
        let (route, speed_mps) = (params::routing(source, file)?, Some(cruise_mps as f32));
        if self.body.guidance == GuidanceKind::Route {
            return Ok(GuidanceSetup::Route { route, speed_mps });
        }
        let formation = params::formation(source, &file.formation)?;
        // Templates differ by robot: see `Scenario::guidance`.
        Ok(GuidanceSetup::Formation { route, formation, template: Template::default(), speed_mps })
    }

    fn safety(
        &self,
        source: &Source<'_>,
        abilities: &Abilities,
        table: &OrcaTable,
    ) -> Result<SafetySetup, ScenarioError> {
        let mut params = AvoidParams::<f32>::default();
        let brake_s = abilities.least_horizon_s();
        params.horizon_s = params.horizon_s.max(brake_s as f32);
        if let Some(given) = table.horizon_s.filter(|&given| given < brake_s) {
            let what = format!("{} is less than 2 (max_speed_mps / max_acceleration_mps2 + lag_s)", short(given));
            let remedy = format!("give {} seconds or more, or leave it out", short(brake_s));
            return Err(source.error(&self.field("orca.horizon_s"), what, remedy));
        }
        let fields = [
            ("horizon_s", table.horizon_s),
            ("wall_horizon_s", table.wall_horizon_s),
            ("share", table.share),
            ("margin_m", table.margin_m),
        ];
        self.set(source, "orca", &mut params, &fields)?;
        let usual = inflation(self.body.max_speed_mps, self.body.radius_m);
        let inflation = StalenessInflation {
            growth_mps: table.inflation_mps.map_or(usual.growth_mps, |value| value as f32),
            max_m: table.inflation_m.map_or(usual.max_m, |value| value as f32),
        };
        let mut setup = self.body.safety.setup(params, inflation, self.push_out(source)?);
        match (&mut setup, table.downwash) {
            (_, None) => {}
            (SafetySetup::Fly { downwash, .. }, Some(value)) => *downwash = value as f32,
            (_, Some(_)) => {
                let what = "robots in the plane are not above each other";
                let remedy = "give safety = \"fly\", or leave it out";
                return Err(source.error(&self.field("orca.downwash"), what, remedy));
            }
        }
        Ok(setup)
    }

    fn push_out(&self, source: &Source<'_>) -> Result<PushOutParams<f32>, ScenarioError> {
        let given = match (self.body.safety == SafetyKind::PushOut, self.body.push_out) {
            (false, None) => return Ok(PushOutParams::new(1.0)),
            (true, Some(given)) => given,
            _ => {
                let what = "safety \"push_out\" and its table go together";
                return Err(source.error(&self.field("push_out"), what, "give both or none of them"));
            }
        };
        if self.body.guidance == GuidanceKind::Waypoint && given.model == Model::Tangential {
            let what = "robots that go straight to a place jam for ever in each other's way";
            let remedy = "give \"radial\", or safety \"orca\"";
            return Err(source.error(&self.field("push_out.model"), what, remedy));
        }
        self.within(source, "push_out.min_distance_m", given.min_distance_m, range(&MIN_DISTANCE), "metres")?;
        Ok(PushOutParams {
            model: given.model,
            evasion: if given.single { Evasion::Single } else { Evasion::Multiple },
            min_distance_m: given.min_distance_m as f32,
        })
    }
}

fn contact_loss(table: &OrcaTable) -> ContactLossPolicy<f32> {
    let usual = ContactLossPolicy::DEFAULT;
    ContactLossPolicy {
        stands_after: table.stands_after_s.map_or(usual.stands_after, duration),
        expects_others: table.expects_others.unwrap_or_default(),
        alone_mps: table.alone_mps.map_or(usual.alone_mps, |mps| mps.min(f64::from(f32::MAX)) as f32),
        ..usual
    }
}

fn duration(seconds: f64) -> Duration {
    Duration::from_micros(libm::round(seconds * 1e6) as i32)
}
