//! Starts and goals of robots in the plane.

use super::super::clocks::phase_ticks;
use super::super::source::Checked;
use super::super::{Draft, Robot};
use super::body::Group;
use super::checks;
use super::grounds::Surroundings;
use super::group::RobotGroup;
use super::place::{Start, Target};
use super::scattered::{self, TRIES, Taken, between, is_clear, unit};
use super::table::{CircleEntry, CloudEntry, Place, PlaneRobotEntry, PlaneRobots, RobotsSource};
use crate::terrain::Terrain;
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
    pub surroundings: Surroundings<'a>,
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
            RobotsSource::Circle(circle) => {
                let (starts, at) = (circle_starts(circle, self.draft.file.seed), group.at.at("robots.circle"));
                for (index, start) in starts.iter().enumerate() {
                    let number = self.starts.len() + index + 1;
                    self.surroundings.start(&at, "radius_m", number, start.position_m, group.body.radius_m)?;
                    for place in &start.places {
                        self.surroundings.goal(group, &at, "radius_m", place.position_m)?;
                    }
                }
                starts
            }
            RobotsSource::Cloud(cloud) => {
                checks::cloud(group, cloud)?;
                // Laws that go from cell to cell need a free cell, not free land around the body.
                let least_m = if group.kind.is_on_grid() { 0.0 } else { 2.0 * group.body.radius_m };
                let is_open = |place| self.surroundings.is_open(place, least_m);
                let (others, radius_m) = (self.others(), group.body.radius_m);
                let is_free = |place| is_clear(place, radius_m, &others) && is_open(place);
                let first = others.len() as u32;
                let starts = cloud_starts(cloud, radius_m, [self.draft.file.seed, first.into()], is_free);
                starts.ok_or_else(|| {
                    let what = "the robots find no room between the corners";
                    group.at.error("robots.cloud", what, "give fewer robots, or corners farther apart on open land")
                })?
            }
            RobotsSource::Scattered(entry) => scattered::starts(group, entry, &self.others(), &self.surroundings)?,
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
            let own = kind.of_entry(entry);
            let group = own.as_ref().map(|own| self.add(own)).transpose()?.or(group);
            let mut rng = Rng::keyed(self.draft.file.seed, STARTS, self.starts.len() as u32, 2);
            let [x, y, z] = entry.start_m.0;
            let mut noise = || (2.0 * unit(&mut rng) - 1.0) * noise_m;
            let position_m = [x + noise(), y + noise(), z];
            let radius_m = entry.radius_m.unwrap_or(kind.body.radius_m);
            self.surroundings.start(&at, "start_m", self.starts.len() + 1, position_m, radius_m)?;
            for (index, place) in entry.via_m.iter().enumerate() {
                self.surroundings.goal(own.as_ref().unwrap_or(kind), &at, &format!("via_m[{index}]"), place.0)?;
            }
            if let Some(goal) = entry.goal_m {
                self.surroundings.goal(own.as_ref().unwrap_or(kind), &at, "goal_m", goal.0)?;
            }
            self.starts.push(Start {
                position_m,
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

/// Uniform random starts without overlaps at places that are free of other robots, if they fit.
/// `first` is the index of the first robot.
fn cloud_starts(
    cloud: &CloudEntry,
    radius_m: f64,
    [seed, first]: [u64; 2],
    is_free: impl Fn([f64; 3]) -> bool,
) -> Option<Vec<Start>> {
    let velocity_mps = cloud.goal_velocity_mps.0;
    let places: Vec<_> = cloud.goals_m.iter().map(|goal| Target { position_m: goal.0, velocity_mps }).collect();
    let mut taken = Taken::new(2.0 * radius_m, 1.0);
    let start = |index: u32| {
        let mut rng = Rng::keyed(seed, STARTS, first as u32 + index, 1);
        let mut draws = (0..TRIES).map(|_| between(&mut rng, cloud.from_m, cloud.to_m));
        let position_m = draws.find(|&place| taken.is_free(place) && is_free(place))?;
        taken.take(position_m);
        let velocity_mps = between(&mut rng, cloud.velocity_from_mps, cloud.velocity_to_mps);
        Some(Start { position_m, velocity_mps, places: places.clone(), group: None, phase_ticks: None })
    };
    (0..cloud.count).map(start).collect()
}
