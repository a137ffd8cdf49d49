//! Flocks as papers simulate them: from normally distributed starts, or with exact knowledge of the
//! robots in range instead of agents and radio. All other fields are the scenario's.
//!
//! With exact knowledge, all robots move at once by the law alone (OLF, section VIII; PAV, sections
//! 2 and 3), in doubles. Differences from agents are effects of radio or bodies.

mod crowd;
mod vote;

use super::{Given, Study, rings};
use crate::error::SweepError;
use crate::measure::{Job, draw, measure};
use crate::probe;
use crowd::Crowd;
use staya_controller::agent::GOALS;
use staya_controller::rand::Rng;
use staya_controller::scalar::NumberFormat;
use staya_sim::engine::{self, Outcome};
use staya_sim::scenario::{PlaneSetup, Scenario, Start, Target};
use staya_sim::world::plane::Solid;
use staya_sim::{choice, table};
use std::path::{Path, PathBuf};

const STARTS: u32 = 0x0046_0101;
const SQUARES: u32 = 0x0046_0201;
const TREES: u32 = 0x0046_0102;
const PLACES: u32 = 0x0047_0104;
const TRIES: u32 = 1000;

/// The study.
#[derive(Debug)]
pub struct Flock;

choice! {
    /// Knowledge of a robot about the others.
    pub enum Knowledge {
        /// Agents that receive packets.
        Packets = "packets",
        /// Exact places and velocities of all robots in the law's range.
        All = "all",
    }
}

table! {
    /// Discs of random sizes at random places.
    #[derive(Copy)]
    pub struct Scattered {
        /// Number of discs.
        pub count: u32;
        /// Smallest and largest radius. Default: points.
        pub radius_m: [f64; 2] = [0.0; 2];
        /// South-west corner.
        pub from_m: [f64; 2];
        /// North-east corner.
        pub to_m: [f64; 2];
        /// Least distance of two edges.
        pub gap_m: f64;
    }
}

impl Scattered {
    /// Centres and radii; `None` if they find no room or are invalid.
    fn draw(&self, most: usize, mut rng: Rng) -> Option<Vec<([f64; 3], f64)>> {
        if self.count as usize > most || !self.radius_m.iter().all(|radius| (0.0..=1e5).contains(radius)) {
            return None;
        }
        let mut discs: Vec<([f64; 3], f64)> = Vec::new();
        let [[west, south], [east, north]] = [self.from_m, self.to_m];
        let mut disc = || {
            let [x, y] = [uniform(&mut rng, west, east), uniform(&mut rng, south, north)];
            ([x, y, 0.0], uniform(&mut rng, self.radius_m[0], self.radius_m[1]))
        };
        for _ in 0..self.count {
            let is_free = |&(center, radius): &([f64; 3], f64)| {
                discs.iter().all(|other| distance_m(center, other.0) - radius - other.1 >= self.gap_m)
            };
            let drawn = (0..100 * TRIES).map(|_| disc()).find(is_free)?;
            discs.push(drawn);
        }
        Some(discs)
    }
}

table! {
    /// Starts in squares of rows, one square for each group of robots.
    pub struct Squares {
        /// South-west corners of the squares.
        pub from_m: Vec<[f64; 2]>;
        /// Distance of two rows.
        pub spacing_m: f64;
        /// Largest random offset of a start along each axis.
        pub noise_m: f64;
        /// Largest random offset of a square but the first to the north or south.
        pub shift_m: f64;
    }
}

impl Squares {
    /// `None` if a group has no square.
    fn place(&self, plane: &mut PlaneSetup, mut rng: Rng) -> Option<()> {
        let group_of = |start: &Start| start.group.map_or(0, |group| group + 1);
        for (group, [west, south]) in self.from_m.iter().enumerate() {
            let side = plane.starts.iter().filter(|start| group_of(start) == group).count().isqrt().max(1);
            let shift_m = if group == 0 { 0.0 } else { uniform(&mut rng, -self.shift_m, self.shift_m) };
            let mut noise = || uniform(&mut rng, -self.noise_m, self.noise_m);
            for (number, start) in plane.starts.iter_mut().filter(|start| group_of(start) == group).enumerate() {
                let [east, north] = [number / side, number % side].map(|rows| rows as f64 * self.spacing_m);
                start.position_m = [west + east + noise(), south + shift_m + north + noise(), 0.0];
            }
        }
        plane.starts.iter().all(|start| group_of(start) < self.from_m.len()).then_some(())
    }
}

table! {
    /// Starts in rings of a lattice around the first robot.
    #[derive(Copy)]
    pub struct Rings {
        /// First and last ring; the one around the robot is 1.
        pub rings: [u32; 2];
        /// Distance of neighbours.
        pub spacing_m: f64;
        /// Standard deviation of a start from the lattice along each axis.
        pub deviation_m: f64;
    }
}

impl Rings {
    /// `None` if the robots do not fill the rings.
    fn place(&self, plane: &mut PlaneSetup, seed: u64) -> Option<()> {
        let places: Vec<[f64; 2]> = rings::rings(self.rings).take(plane.starts.len() + 1).collect();
        if places.len() != plane.starts.len() {
            return None;
        }
        for (robot, (start, place)) in (0..).zip(plane.starts.iter_mut().zip(places)) {
            let mut rng = Rng::keyed(seed, STARTS, robot, 0);
            let [x, y] = place.map(|c| c * self.spacing_m + normal(&mut rng, self.deviation_m));
            start.position_m = [x, y, 0.0];
        }
        Some(())
    }
}

table! {
    /// Parameters of a run.
    pub struct Parameters {
        /// Knowledge of a robot about the others. Default: `"packets"`.
        pub knows: Knowledge = Knowledge::Packets;
        /// Number of nearest robots that each robot knows with exact knowledge.
        pub nearest: usize = usize::MAX;
        /// Number of robots, the first ones, that know the goals of a goal flock (with exact
        /// knowledge). The goal of the others is the nearest of these in their range. Default: all.
        pub leaders: u32 = u32::MAX;
        /// Number of robots, the first ones, that die: they stay where they are, and are not seen.
        pub dying: u32 = 0;
        /// When they die, seconds.
        pub die_s: f64 = 0.0, 0.0..=1e9, "s";
        /// Rule by which robots vote for one of the goals of a goal flock (with exact knowledge);
        /// each then moves there at once. The leaders' rule is without effect.
        pub votes: vote::Rule = vote::Rule::None;
        /// Probability of a first vote for the first goal; the others are equally likely.
        pub first_goal: f64 = 0.5, 0.0..=1.0, "";
        /// Speed limit of alpha flocks with exact knowledge; the paper has none.
        pub fastest_mps: f64 = f64::MAX;
        /// Standard deviation of starts along each axis, instead of the scenario's starts.
        pub deviation_m: [f64; 3] = [0.0; 3];
        /// Starts instead of the scenario's.
        pub squares: Option<Squares>;
        /// Starts instead of the scenario's.
        pub rings: Option<Rings>;
        /// Balls besides those of the scenario.
        pub forest: Option<Scattered>;
        /// Goals instead of those of the scenario, in its plane.
        pub goals: Option<Scattered>;
    }
}

/// A checked run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scenario, with its starts drawn.
    pub scenario: Scenario,
    parameters: Parameters,
}

impl Study for Flock {
    fn name(&self) -> &'static str {
        "flock"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        let own = [
            ("collisions", "pairs of bodies that overlap, summed over ticks"),
            ("least_gap_m", "smallest gap between two bodies; empty: none came close"),
            ("least_obstacle_gap_m", "smallest gap between a body and an obstacle"),
        ];
        own.map(|(name, meaning)| (name.to_owned(), meaning)).into_iter().chain(probe::measures()).collect()
    }

    fn takes_scenario(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (run, measures) = (Run::read(given, given.parameters()?)?, given.measures.to_vec());
        Ok(Box::new(move |watch| measure(&run.scenario, &measures, watch, &|each| run.simulate(each))))
    }

    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let run = Run::read(given, given.parameters()?)?;
        draw(&run.scenario, given.measures, &|each| run.simulate(each), title, stem)
    }
}

impl Run {
    /// Reads the scenario of a run and checks it with the parameters.
    ///
    /// # Errors
    /// Names the field that is wrong.
    pub fn read(given: &Given<'_>, parameters: Parameters) -> Result<Self, SweepError> {
        let mut scenario = given.scenario()?;
        let Some(plane) = scenario.plane_mut().filter(|plane| plane.torus_m.is_none()) else {
            return Err(given.error("knows", "the scenario has no open plane", "name a scenario in the plane"));
        };
        if parameters.deviation_m != [0.0; 3] {
            let is_possible = parameters.deviation_m.iter().all(|deviation| (0.0..=1e5).contains(deviation));
            let drawn = is_possible.then(|| draw_starts(plane, parameters.deviation_m, given.seed)).flatten();
            if drawn.is_none() {
                let what = format!("the robots find no room with deviations of {:?} m", parameters.deviation_m);
                return Err(given.error("deviation_m", what, "give larger ones, up to 100,000"));
            }
        }
        if let Some(squares) = &parameters.squares
            && squares.place(plane, Rng::keyed(given.seed, SQUARES, 0, 0)).is_none()
        {
            let what = "there are more groups than squares";
            return Err(given.error("squares.from_m", what, "give a corner for each group, beginning with [plane]"));
        }
        if let Some(rings) = &parameters.rings
            && rings.place(plane, given.seed).is_none()
        {
            let what = "the robots do not fill the rings";
            return Err(given.error("rings.rings", what, "give one robot, and six times the number of each ring"));
        }
        let scattered = |field: &str, discs: Option<Scattered>, most: usize, key| {
            let no_room = || {
                let what = format!("they find no room, are more than {most}, or have a radius out of range");
                given.error(field, what, "give fewer, radii of 0 to 100,000 m, or corners farther apart")
            };
            let drawn = discs.map(|discs| discs.draw(most, Rng::keyed(given.seed, key, 0, 0)).ok_or_else(no_room));
            Ok::<_, SweepError>(drawn.transpose()?.unwrap_or_default())
        };
        for (center_m, radius_m) in scattered("forest", parameters.forest, 10_000, TREES)? {
            plane.solids.push(Solid::Ball { center_m, radius_m });
        }
        let goals = scattered("goals", parameters.goals, GOALS, PLACES)?;
        if let Some(first) = plane.starts.first().and_then(|start| start.places.first()).filter(|_| !goals.is_empty()) {
            let velocity_mps = first.velocity_mps;
            let target = |&(position_m, _): &([f64; 3], f64)| Target { position_m, velocity_mps };
            let targets: Vec<Target> = goals.iter().map(target).collect();
            plane.starts.iter_mut().for_each(|start| start.places.clone_from(&targets));
        }
        let run = Self { scenario, parameters };
        if run.parameters.knows == Knowledge::All
            && run.scenario.plane().and_then(|plane| Crowd::new(&run, plane)).is_none()
        {
            let what = "exact knowledge is for one alpha flock, or goal flock behind push-out, among balls";
            return Err(given.error("knows", what, "give \"packets\""));
        }
        if run.parameters.knows == Knowledge::All && run.scenario.laws.numbers != NumberFormat::F32 {
            return Err(given.error(
                "knows",
                "robots with exact knowledge compute in f32",
                "give \"packets\", or leave out numbers",
            ));
        }
        Ok(run)
    }

    /// Runs the scenario, passing each moment to the callback.
    ///
    /// # Errors
    /// The robots cannot be placed, or leave the world.
    pub fn simulate(&self, each: &mut engine::Watch<'_>) -> Result<Outcome, String> {
        let exact = self.scenario.plane().filter(|_| self.parameters.knows == Knowledge::All);
        match exact.and_then(|plane| Crowd::new(self, plane)) {
            Some(crowd) => crowd.simulate(&self.scenario, each),
            None => staya_numbers::simulate(&self.scenario, each),
        }
    }
}

/// Starts at least two radii apart, each a function of the seed and the robot.
fn draw_starts(plane: &mut PlaneSetup, deviation_m: [f64; 3], seed: u64) -> Option<()> {
    let mut places: Vec<[f64; 3]> = Vec::new();
    for robot in 0..plane.starts.len() {
        let apart_m = 2.0 * plane.group(robot).radius_m;
        let mut rng = Rng::keyed(seed, STARTS, robot as u32, 0);
        let is_free = |at: &[f64; 3]| places.iter().all(|other| distance_m(*other, *at) >= apart_m);
        let place = (0..TRIES).map(|_| deviation_m.map(|deviation| normal(&mut rng, deviation))).find(is_free)?;
        places.push(place);
    }
    for (start, place) in plane.starts.iter_mut().zip(places) {
        start.position_m = place;
    }
    Some(())
}

fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
}

/// Mean 0 (Box and Muller).
pub(super) fn normal(rng: &mut Rng, deviation: f64) -> f64 {
    let length = libm::sqrt(-2.0 * libm::log(1.0 - uniform(rng, 0.0, 1.0)));
    deviation * length * libm::cos(2.0 * std::f64::consts::PI * uniform(rng, 0.0, 1.0))
}

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::sqrt(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
}

#[cfg(test)]
mod tests;
