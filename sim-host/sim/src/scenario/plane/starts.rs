//! Starts and goals of robots in the plane.

use super::super::clocks::phase_ticks;
use super::super::source::Checked;
use super::super::{Draft, Robot};
use super::body::Group;
use super::checks;
use super::group::RobotGroup;
use super::place::{Start, Target};
use super::scattered::{self, TRIES, Taken, between, is_clear, unit};
use super::table::{CircleEntry, CloudEntry, Place, PlaneRobotEntry, PlaneRobots, RobotsSource};
use crate::terrain::Terrain;
use crate::world::plane::Solid;
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;

const STARTS: u32 = 0x0053_0003;

pub(super) fn on_land(robots: &[Robot], terrain: &Terrain, phase_ticks: Option<u32>) -> Vec<Start> {
    let center = |cell: Cell| {
        let [x, y] = terrain.center_m(cell);
        [x, y, 0.0]
    };
    let start = |robot: &Robot| Start {
        position_m: center(robot.start),
        velocity_mps: [0.0; 3],
        places: vec![Target::fixed(center(robot.goal))],
        group: None,
        phase_ticks,
    };
    robots.iter().map(start).collect()
}

pub(super) struct Placing<'a> {
    pub draft: &'a Draft<'a>,
    /// Radius of the robots without a group.
    pub general_m: f64,
    pub solids: &'a [Solid],
    pub groups: Vec<RobotGroup>,
    pub starts: Vec<Start>,
}

impl Placing<'_> {
    pub fn add(&mut self, group: &Group<'_>) -> Checked<usize> {
        self.groups.push(group.build()?);
        Ok(self.groups.len() - 1)
    }

    /// Places the robots of group number `number`, `None` for the general one.
    pub fn place(&mut self, group: &Group<'_>, number: Option<usize>, robots: &PlaneRobots) -> Checked {
        let placed = match &robots.robots {
            RobotsSource::List(list) => {
                checks::list(group, list)?;
                return self.list(group, number, list, robots.noise_m);
            }
            RobotsSource::Circle(circle) => circle_starts(circle, self.draft.file.seed),
            RobotsSource::Cloud(cloud) => {
                checks::cloud(group, cloud)?;
                let starts = cloud_starts(cloud, group.body.radius_m, self.draft.file.seed, &self.others());
                starts.ok_or_else(|| {
                    let what = "the robots find no room between the corners";
                    group.at.error("robots.cloud", what, "give fewer robots or corners farther apart")
                })?
            }
            RobotsSource::Scattered(entry) => scattered::starts(group, entry, &self.others(), self.solids)?,
            // The caller places formations.
            RobotsSource::Formation(_) => Vec::new(),
        };
        let phase_ticks = phase_ticks(self.draft, &group.at, group.body.phase_s)?;
        self.starts.extend(placed.into_iter().map(|start| Start { group: number, phase_ticks, ..start }));
        Ok(())
    }

    /// A robot whose body differs gets its own group.
    fn list(&mut self, kind: &Group<'_>, group: Option<usize>, list: &[PlaneRobotEntry], noise_m: f64) -> Checked {
        let common = phase_ticks(self.draft, &kind.at, kind.body.phase_s)?;
        for (index, entry) in list.iter().enumerate() {
            let at = kind.at.at(format!("robots.list[{index}]"));
            let group = kind.of_entry(entry).map(|own| self.add(&own)).transpose()?.or(group);
            let mut rng = Rng::keyed(self.draft.file.seed, STARTS, self.starts.len() as u32, 2);
            let [x, y, z] = entry.start_m.0;
            let mut noise = || (2.0 * unit(&mut rng) - 1.0) * noise_m;
            self.starts.push(Start {
                position_m: [x + noise(), y + noise(), z],
                velocity_mps: entry.velocity_mps.0,
                places: entry.via_m.iter().copied().chain(entry.goal_m).map(|Place(at)| Target::fixed(at)).collect(),
                group,
                phase_ticks: phase_ticks(self.draft, &at, entry.phase_s)?.or(common),
            });
        }
        Ok(())
    }

    /// Place and radius of each robot so far.
    fn others(&self) -> Vec<([f64; 3], f64)> {
        let radius_m = |start: &Start| start.group.map_or(self.general_m, |group| self.groups[group].radius_m);
        self.starts.iter().map(|start| (start.position_m, radius_m(start))).collect()
    }
}

/// Robots evenly spaced on a circle around the origin, counter-clockwise from the east. The goal is
/// opposite to the exact start.
fn circle_starts(circle: &CircleEntry, seed: u64) -> Vec<Start> {
    let start = |index: u32| {
        let angle = 2.0 * std::f64::consts::PI * f64::from(index) / f64::from(circle.count);
        let [x, y] = [libm::cos(angle) * circle.radius_m, libm::sin(angle) * circle.radius_m];
        let mut rng = Rng::keyed(seed, STARTS, index, 0);
        let mut noise = || (2.0 * unit(&mut rng) - 1.0) * circle.noise_m;
        Start {
            position_m: [x + noise(), y + noise(), 0.0],
            velocity_mps: [0.0; 3],
            places: vec![Target::fixed([-x, -y, 0.0])],
            group: None,
            phase_ticks: None,
        }
    };
    (0..circle.count).map(start).collect()
}

/// Uniform random starts without overlaps, clear of the few `others` (place, radius), if they fit.
fn cloud_starts(cloud: &CloudEntry, radius_m: f64, seed: u64, others: &[([f64; 3], f64)]) -> Option<Vec<Start>> {
    let velocity_mps = cloud.goal_velocity_mps.0;
    let places: Vec<_> = cloud.goals_m.iter().map(|goal| Target { position_m: goal.0, velocity_mps }).collect();
    let first = others.len() as u32;
    let mut taken = Taken::new(2.0 * radius_m, 1.0);
    let start = |index: u32| {
        let mut rng = Rng::keyed(seed, STARTS, first + index, 1);
        let mut draws = (0..TRIES).map(|_| between(&mut rng, cloud.from_m, cloud.to_m));
        let position_m = draws.find(|&place| taken.is_free(place) && is_clear(place, radius_m, others))?;
        taken.take(position_m);
        let velocity_mps = between(&mut rng, cloud.velocity_from_mps, cloud.velocity_to_mps);
        Some(Start { position_m, velocity_mps, places: places.clone(), group: None, phase_ticks: None })
    };
    (0..cloud.count).map(start).collect()
}
