//! `[plausibility]`: limits within which received beacons count as plausible.

use super::source::Source;
use super::{PlaneSetup, Robot, Scenario, ScenarioError, ScenarioFile};
use crate::{defaults, table};
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;

/// Default limits on radius and speed, as a multiple of the largest values in the scenario.
const TIMES: f64 = 2.0;
/// Default position tolerance, in radii of the largest body (on the grid: half cells).
const SLACK_RADII: f64 = 4.0;
/// Ticks for which a robot must be consistent after a jump: the age at which a beacon is stale.
const SETTLE_TICKS: u32 = 4;

table! {
    /// `[plausibility]`: plausibility limits on beacons. The defaults accept every honest robot.
    #[derive(Copy)]
    pub struct PlausibilityTable {
        /// Whether beacons are checked. Default: true.
        pub bounded: Option<bool>;
        /// Largest radius, metres. Default: twice the radius of the largest body.
        pub max_radius_m: Option<f64>, 0.001..=1e6, "metres";
        /// Highest speed, m/s. Default: twice the highest speed in the scenario.
        pub max_speed_mps: Option<f64>, 0.001..=1e6, "m/s";
        /// Position tolerance, metres. Default: four radii of the largest body; two cells on the
        /// grid.
        pub slack_m: Option<f64>, 0.0..=1e6, "metres";
        /// How long a robot must be consistent after a jump, seconds. Default: four ticks.
        pub settle_s: Option<f64>, 0.0..=1800.0, "seconds";
        /// Largest robot id. Default: the largest id in the scenario.
        pub last_robot: Option<u32>;
    }
}

defaults!(PlausibilityTable);

fn usual(radius_m: f64, speed_mps: f64, tick_us: u32, last: u32) -> PlausibilityLimits<f32> {
    PlausibilityLimits {
        max_radius_m: (TIMES * radius_m) as f32,
        max_speed_mps: (TIMES * speed_mps) as f32,
        slack_m: (SLACK_RADII * radius_m) as f32,
        settle: Duration::from_micros(i32::try_from(tick_us.saturating_mul(SETTLE_TICKS)).unwrap_or(i32::MAX)),
        last: RobotId(last),
    }
}

pub(super) fn in_plane(setup: &PlaneSetup, tick_us: u32, last: u32) -> PlausibilityLimits<f32> {
    let norm = |v: [f64; 3]| libm::sqrt(v.iter().map(|v| v * v).sum());
    let kinds = setup.kinds().map(|group| (group.radius_m, group.abilities.max_speed_mps));
    let intruders = setup.intruders.iter().map(|intruder| (intruder.radius_m, norm(intruder.velocity_mps)));
    let starts = setup.starts.iter().map(|start| (0.0, norm(start.velocity_mps)));
    let all = kinds.chain(intruders).chain(starts);
    let (radius_m, speed_mps) = all.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
    usual(radius_m, speed_mps, tick_us, last)
}

pub(super) fn on_grid(cell_m: f64, tick_us: u32, last: u32) -> PlausibilityLimits<f32> {
    usual(cell_m / 2.0, cell_m * 1e6 / f64::from(tick_us), tick_us, last)
}

impl Scenario {
    /// Plausibility limits of a scenario without `[plausibility]`. O(robots).
    #[must_use]
    pub fn usual_claims(&self) -> PlausibilityLimits<f32> {
        let numbers = self.robots.iter().map(|robot| robot.id).chain(self.misnumbered.iter().map(|(_, said)| *said));
        let last = numbers.max().unwrap_or_default().0;
        match &self.plane {
            // Beaconing intruders have the ids after those of the robots.
            Some(plane) => in_plane(plane, self.tick_us, last + plane.heard() as u32),
            None => on_grid(self.terrain.cell_m, self.tick_us, last),
        }
    }
}

pub(super) fn said(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
    usual: PlausibilityLimits<f32>,
) -> Result<PlausibilityLimits<f32>, ScenarioError> {
    let (table, mut plausibility) = (file.plausibility, usual);
    if table.bounded == Some(false) {
        let PlausibilityTable { bounded: _, max_radius_m, max_speed_mps, slack_m, settle_s, last_robot } = table;
        if [max_radius_m, max_speed_mps, slack_m, settle_s].iter().any(Option::is_some) || last_robot.is_some() {
            let remedy = "leave the other fields of this table out, or bounded";
            return Err(source.error("plausibility.bounded", "there are bounds in this table", remedy));
        }
        return Ok(PlausibilityLimits::ANY);
    }
    for (value, bound) in [
        (table.max_radius_m, &mut plausibility.max_radius_m),
        (table.max_speed_mps, &mut plausibility.max_speed_mps),
        (table.slack_m, &mut plausibility.slack_m),
    ] {
        *bound = value.map_or(*bound, |value| value as f32);
    }
    if let Some(settle_s) = table.settle_s {
        plausibility.settle = Duration::from_micros(libm::round(settle_s * 1e6) as i32);
    }
    if let Some(last) = table.last_robot {
        let least = robots.last().map_or(1, |robot| robot.id.0);
        if last < least {
            let what = format!("robot {least} would not be believed");
            return Err(source.error("plausibility.last_robot", what, format!("give {least} or more")));
        }
        plausibility.last = RobotId(last);
    }
    Ok(plausibility)
}
