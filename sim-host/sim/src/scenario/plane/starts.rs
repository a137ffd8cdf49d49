//! Starts and goals of robots in the plane.

use super::super::source::Source;
use super::super::{Robot, ScenarioError, ScenarioFile};
use super::checks;
use super::fields::Group;
use super::group::RobotGroup;
use super::place::{Start, Target};
use super::scattered::{self, TRIES, Taken, between, is_clear, unit};
use super::table::{CloudEntry, Place, PlaneRobotEntry, PlaneRobots};
use crate::terrain::Terrain;
use crate::world::plane::Solid;
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;

const STARTS: u32 = 0x0053_0003;

pub(super) fn on_land(robots: &[Robot], terrain: &Terrain) -> Vec<Start> {
    let center = |cell: Cell| {
        let [x, y] = terrain.center_m(cell);
        [x, y, 0.0]
    };
    let start = |robot: &Robot| Start {
        position_m: center(robot.start),
        velocity_mps: [0.0; 3],
        places: vec![Target { position_m: center(robot.goal), velocity_mps: [0.0; 3] }],
        group: None,
    };
    robots.iter().map(start).collect()
}

pub(super) struct Placing<'a> {
    pub source: &'a Source<'a>,
    pub file: &'a ScenarioFile,
    pub general_m: f64,
    pub solids: &'a [Solid],
    pub groups: &'a mut Vec<RobotGroup>,
    pub starts: &'a mut Vec<Start>,
}

impl Placing<'_> {
    pub fn add(&mut self, group: &Group) -> Result<usize, ScenarioError> {
        self.groups.push(group.build(self.source, self.file)?);
        Ok(self.groups.len() - 1)
    }

    /// Places the robots of a group (`None`: the general one), which `group` describes.
    pub fn place(&mut self, kind: &Group, group: Option<usize>, robots: &PlaneRobots) -> Result<(), ScenarioError> {
        let (source, table) = (self.source, format!("{}.robots", kind.table));
        let mut placed = match (&robots.list, &robots.circle, &robots.cloud, &robots.scattered) {
            (Some(list), None, None, None) => {
                checks::list(source, kind, list)?;
                return self.list(kind, group, list, robots.noise_m);
            }
            (None, Some(circle), None, None) => {
                circle_starts(circle.count, circle.radius_m, circle.noise_m, self.file.seed)
            }
            (None, None, Some(cloud), None) => {
                checks::cloud(source, kind, cloud)?;
                self.cloud(kind, cloud).ok_or_else(|| {
                    source.error(
                        &format!("{table}.cloud"),
                        "the robots find no room between the corners",
                        "give fewer robots or corners farther apart",
                    )
                })?
            }
            (None, None, None, Some(scattered)) => {
                scattered::starts(source, kind, scattered, &self.others(), self.solids, self.file.seed)?
            }
            _ => {
                let remedy = "give exactly one of list, circle, cloud, scattered";
                return Err(source.error(&table, "the robots are not defined exactly once", remedy));
            }
        };
        placed.iter_mut().for_each(|start| start.group = group);
        self.starts.append(&mut placed);
        Ok(())
    }

    /// A robot whose body differs gets its own group.
    fn list(
        &mut self,
        kind: &Group,
        group: Option<usize>,
        list: &[PlaneRobotEntry],
        noise_m: f64,
    ) -> Result<(), ScenarioError> {
        let fixed = |place: Place| Target { position_m: place.0, velocity_mps: [0.0; 3] };
        for entry in list {
            let group = kind.of_entry(entry).map(|own| self.add(&own)).transpose()?.or(group);
            let mut rng = Rng::keyed(self.file.seed, STARTS, self.starts.len() as u32, 2);
            let [x, y, z] = entry.start_m.0;
            let mut noise = || (2.0 * unit(&mut rng) - 1.0) * noise_m;
            self.starts.push(Start {
                position_m: [x + noise(), y + noise(), z],
                velocity_mps: entry.velocity_mps.0,
                places: entry.via_m.iter().copied().chain(entry.goal_m).map(fixed).collect(),
                group,
            });
        }
        Ok(())
    }

    fn others(&self) -> Vec<([f64; 3], f64)> {
        let others = self.starts.iter().map(|start| {
            let radius_m = start.group.map_or(self.general_m, |group| self.groups[group].radius_m);
            (start.position_m, radius_m)
        });
        others.collect()
    }

    fn cloud(&self, group: &Group, cloud: &CloudEntry) -> Option<Vec<Start>> {
        cloud_starts(cloud, group.body.radius_m, self.file.seed, &self.others())
    }
}

/// Robots evenly spaced on a circle around the origin, counter-clockwise from the east, in metres.
/// The goal is opposite to the exact start; `noise_m` is the largest random offset of the start
/// along each axis.
#[must_use]
pub fn circle_starts(count: u32, radius_m: f64, noise_m: f64, seed: u64) -> Vec<Start> {
    (0..count)
        .map(|index| {
            let angle = 2.0 * std::f64::consts::PI * f64::from(index) / f64::from(count);
            let [x, y] = [libm::cos(angle) * radius_m, libm::sin(angle) * radius_m];
            let mut rng = Rng::keyed(seed, STARTS, index, 0);
            let mut noise = || (2.0 * unit(&mut rng) - 1.0) * noise_m;
            Start {
                position_m: [x + noise(), y + noise(), 0.0],
                velocity_mps: [0.0; 3],
                places: vec![Target { position_m: [-x, -y, 0.0], velocity_mps: [0.0; 3] }],
                group: None,
            }
        })
        .collect()
}

/// Uniform random starts without overlaps, clear of the few `others` (place, radius), if they fit.
fn cloud_starts(cloud: &CloudEntry, radius_m: f64, seed: u64, others: &[([f64; 3], f64)]) -> Option<Vec<Start>> {
    let places: Vec<_> = cloud
        .goals_m
        .iter()
        .map(|goal| Target { position_m: goal.0, velocity_mps: cloud.goal_velocity_mps.0 })
        .collect();
    let first = others.len() as u32;
    let mut taken = Taken::new(2.0 * radius_m, 1.0);
    (0..cloud.count)
        .map(|index| {
            let mut rng = Rng::keyed(seed, STARTS, first + index, 1);
            let position_m = (0..TRIES)
                .map(|_| between(&mut rng, cloud.from_m, cloud.to_m))
                .find(|&place| taken.is_free(place) && is_clear(place, radius_m, others))?;
            taken.take(position_m);
            let (from, to) = (cloud.velocity_from_mps, cloud.velocity_to_mps);
            let velocity_mps = between(&mut rng, from, to);
            Some(Start { position_m, velocity_mps, places: places.clone(), group: None })
        })
        .collect()
}
