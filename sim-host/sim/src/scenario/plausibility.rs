//! `[plausibility]`: limits within which received beacons count as plausible.

use super::source::Checked;
use super::{Draft, Robot, Scenario, plane::norm, ranges::duration};
use crate::{defaults, table};
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;

/// Default limits on radius and speed, as a multiple of the largest values in the scenario.
const TIMES: f64 = 2.0;
/// Default position tolerance, in radii of the largest body (on the grid: half cells).
const SLACK_RADII: f64 = 4.0;
/// Steps for which a robot must be consistent after a jump: the age at which a beacon is stale.
const SETTLE_STEPS: u32 = 4;

table! {
    /// `[plausibility]`: plausibility limits on beacons. The defaults accept every honest robot.
    #[derive(Copy)]
    pub struct PlausibilityTable {
        /// Whether beacons are checked. Default: true.
        pub bounded: bool = true;
        /// Largest radius, metres. Default: twice the radius of the largest body.
        pub max_radius_m: Option<f64>, 0.001..=1e6, "metres";
        /// Highest speed, m/s. Default: twice the highest speed in the scenario.
        pub max_speed_mps: Option<f64>, 0.001..=1e6, "m/s";
        /// Position tolerance, metres. Default: four radii of the largest body; two cells on the
        /// grid.
        pub slack_m: Option<f64>, 0.0..=1e6, "metres";
        /// How long a robot must be consistent after a jump, seconds. Default: four steps.
        pub settle_s: Option<f64>, 0.0..=1800.0, "seconds";
        /// Largest robot id. Default: the largest id in the scenario.
        pub last_robot: Option<u32>;
    }
}

defaults!(PlausibilityTable);

fn usual(radius_m: f64, speed_mps: f64, step_us: u32, last: u32) -> PlausibilityLimits<f32> {
    PlausibilityLimits {
        max_radius_m: (TIMES * radius_m) as f32,
        max_speed_mps: (TIMES * speed_mps) as f32,
        slack_m: (SLACK_RADII * radius_m) as f32,
        settle: Duration::from_micros(i32::try_from(step_us.saturating_mul(SETTLE_STEPS)).unwrap_or(i32::MAX)),
        last: RobotId(last),
    }
}

impl Scenario {
    /// Plausibility limits of a scenario without `[plausibility]`. O(robots).
    #[must_use]
    pub fn usual_claims(&self) -> PlausibilityLimits<f32> {
        let numbers =
            self.robots.iter().map(|robot| robot.id).chain(self.trust.misnumbered.iter().map(|(_, said)| *said));
        let last = numbers.max().unwrap_or_default().0;
        let Some(plane) = self.plane() else {
            let cell_m = self.land.terrain.cell_m;
            return usual(cell_m / 2.0, cell_m * 1e6 / f64::from(self.tick_us), self.tick_us, last);
        };
        let kinds = plane.kinds().map(|group| (group.radius_m, group.abilities.max_speed_mps));
        let intruders = plane.intruders.iter().map(|intruder| (intruder.radius_m, norm(intruder.velocity_mps)));
        let starts = plane.starts.iter().map(|start| (0.0, norm(start.velocity_mps)));
        let all = kinds.chain(intruders).chain(starts);
        let (radius_m, speed_mps) = all.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
        // Beaconing intruders have the ids after those of the robots.
        usual(radius_m, speed_mps, self.clocks.step_us(), last + plane.heard() as u32)
    }
}

pub(super) fn limits(
    draft: &Draft<'_>,
    robots: &[Robot],
    usual: PlausibilityLimits<f32>,
) -> Checked<PlausibilityLimits<f32>> {
    let table = draft.file.plausibility;
    if !table.bounded {
        let others = ["max_radius_m", "max_speed_mps", "slack_m", "settle_s", "last_robot"];
        let is_alone = others.iter().all(|name| !draft.has(&format!("plausibility.{name}")));
        let remedy = "leave the other fields of this table out, or bounded";
        draft.require(is_alone, "plausibility.bounded", "there are bounds in this table", remedy)?;
        return Ok(PlausibilityLimits::ANY);
    }
    let least = robots.last().map_or(1, |robot| robot.id.0);
    let last = table.last_robot.map_or(usual.last, RobotId);
    let (what, remedy) = (format!("robot {least} would not be believed"), format!("give {least} or more"));
    draft.require(last.0 >= least, "plausibility.last_robot", what, remedy)?;
    let or = |value: Option<f64>, usual| value.map_or(usual, |value| value as f32);
    Ok(PlausibilityLimits {
        max_radius_m: or(table.max_radius_m, usual.max_radius_m),
        max_speed_mps: or(table.max_speed_mps, usual.max_speed_mps),
        slack_m: or(table.slack_m, usual.slack_m),
        settle: table.settle_s.map_or(usual.settle, duration),
        last,
    })
}
