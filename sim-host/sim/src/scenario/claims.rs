//! `[claims]`: what robots may say of themselves and be believed by the others.

use super::ranges::within;
use super::source::Source;
use super::{PlaneSetup, Robot, Scenario, ScenarioError, ScenarioFile};
use serde::Deserialize;
use staya_controller::neighbor::Claims;
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;

/// How many times the largest body and the highest speed there are, by default.
const TIMES: f64 = 2.0;
/// How many radii of the largest body, or half cells, a place may be off besides.
const SLACK_RADII: f64 = 4.0;
/// Ticks for which a robot that has jumped must be consistent: as long as news may be old before it is stale.
const SETTLE_TICKS: u32 = 4;

/// `[claims]`: bounds on what robots say of themselves. Without this table no honest robot meets them.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimsTable {
    /// Whether there are any. Default: true.
    pub bounded: Option<bool>,
    /// The largest radius, metres. Default: twice that of the largest body.
    pub max_radius_m: Option<f64>,
    /// The highest speed, m/s. Default: twice the highest there is.
    pub max_speed_mps: Option<f64>,
    /// How far a place may be off besides, metres. Default: four radii of the largest body; on the grid two cells.
    pub slack_m: Option<f64>,
    /// How long a robot that jumped must be consistent, seconds. Default: four ticks.
    pub settle_s: Option<f64>,
    /// The greatest number. Default: the greatest there is.
    pub last_robot: Option<u32>,
}

/// What is believed by default: `radius_m` and `speed_mps` are the largest body's and the highest.
fn usual(radius_m: f64, speed_mps: f64, tick_us: u32, last: u32) -> Claims<f32> {
    Claims {
        max_radius_m: (TIMES * radius_m) as f32,
        max_speed_mps: (TIMES * speed_mps) as f32,
        slack_m: (SLACK_RADII * radius_m) as f32,
        settle: Duration::from_micros(i32::try_from(tick_us.saturating_mul(SETTLE_TICKS)).unwrap_or(i32::MAX)),
        last: RobotId(last),
    }
}

/// Bodies in the plane; numbers up to `last`.
pub(super) fn in_plane(setup: &PlaneSetup, tick_us: u32, last: u32) -> Claims<f32> {
    let norm = |v: [f64; 3]| libm::sqrt(v.iter().map(|v| v * v).sum());
    let kinds = setup.kinds().map(|group| (group.radius_m, group.abilities.max_speed_mps));
    let intruders = setup.intruders.iter().map(|intruder| (intruder.radius_m, norm(intruder.velocity_mps)));
    let starts = setup.starts.iter().map(|start| (0.0, norm(start.velocity_mps)));
    let all = kinds.chain(intruders).chain(starts);
    let (radius_m, speed_mps) = all.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
    usual(radius_m, speed_mps, tick_us, last)
}

/// Bodies that hold a cell each.
pub(super) fn on_grid(cell_m: f64, tick_us: u32, last: u32) -> Claims<f32> {
    usual(cell_m / 2.0, cell_m * 1e6 / f64::from(tick_us), tick_us, last)
}

impl Scenario {
    /// What is believed where nobody says otherwise.
    #[must_use]
    pub fn usual_claims(&self) -> Claims<f32> {
        let numbers = self.robots.iter().map(|robot| robot.id).chain(self.misnumbered.iter().map(|(_, said)| *said));
        let last = numbers.max().unwrap_or_default().0;
        match &self.plane {
            // Intruders that are heard have the numbers behind the robots'.
            Some(plane) => in_plane(plane, self.tick_us, last + plane.heard() as u32),
            None => on_grid(self.terrain.cell_m, self.tick_us, last),
        }
    }
}

/// What the file says instead.
pub(super) fn said(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
    usual: Claims<f32>,
) -> Result<Claims<f32>, ScenarioError> {
    let (table, mut claims) = (file.claims, usual);
    if table.bounded == Some(false) {
        let ClaimsTable { bounded: _, max_radius_m, max_speed_mps, slack_m, settle_s, last_robot } = table;
        if [max_radius_m, max_speed_mps, slack_m, settle_s].iter().any(Option::is_some) || last_robot.is_some() {
            let remedy = "leave the other fields of this table out, or bounded";
            return Err(source.error("claims.bounded", "there are bounds in this table", remedy));
        }
        return Ok(Claims::ANY);
    }
    for (field, value, low, unit, bound) in [
        ("max_radius_m", table.max_radius_m, 0.001, "metres", &mut claims.max_radius_m),
        ("max_speed_mps", table.max_speed_mps, 0.001, "m/s", &mut claims.max_speed_mps),
        ("slack_m", table.slack_m, 0.0, "metres", &mut claims.slack_m),
    ] {
        if let Some(value) = value {
            within(source, &format!("claims.{field}"), value, low, 1e6, unit)?;
            *bound = value as f32;
        }
    }
    if let Some(settle_s) = table.settle_s {
        within(source, "claims.settle_s", settle_s, 0.0, 1800.0, "seconds")?;
        claims.settle = Duration::from_micros(libm::round(settle_s * 1e6) as i32);
    }
    if let Some(last) = table.last_robot {
        let least = robots.last().map_or(1, |robot| robot.id.0);
        if last < least {
            let what = format!("robot {least} would not be believed");
            return Err(source.error("claims.last_robot", what, format!("give {least} or more")));
        }
        claims.last = RobotId(last);
    }
    Ok(claims)
}
