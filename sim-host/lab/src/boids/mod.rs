//! Boids on a torus, and the cost of neighbour search (V. A. Starovoitova 2018, STA, section 2.3).
//!
//! The controller's boids ([`staya_controller::boids`]) run on the host without radio and
//! packets: each knows the exact places and headings of its neighbours. All searches of
//! [`nearby`](staya_sim::nearby) and [`searches`] have the same start, must give bitwise equal
//! trajectories, and are timed on one thread.

mod method;
mod pictures;
mod report;
pub mod searches;
#[cfg(test)]
mod tests;

pub use method::Method;
pub use report::{Report, Row, Timing};

use crate::experiment::Experiment;
use crate::experiment::rows::Jobs;
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::Args;
use method::AnySearch;
use rayon::prelude::*;
use staya_console::options;
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Torus, Vec2, Vec3};
use staya_controller::neighbor::Nearby;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::nearby::{Cells, Found, Query, Search, Space};
use std::path::{Path, PathBuf};
use std::time::Instant;

const STARTS: u32 = 0x0045_0301;

const PIECE: usize = 256;

/// Default limit of boids for searches over all pairs: about a second per step.
pub const MOST_BY_ALL_PAIRS: u32 = 10_000;

/// Boids on a torus: trajectories and cost of five neighbour searches (Starovoitova, section 2.3).
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of boids, one line of the table each.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "100,300,1000,3000,10000,30000,100000")]
    pub boids: Vec<u32>,
    /// Timed steps for each search and number of boids; the hash is that of the last step.
    #[arg(long, default_value_t = 20)]
    pub steps: u32,
    /// Skip the search of all pairs for more boids than this.
    #[arg(long = "all-pairs-up-to", value_name = "N", default_value_t = MOST_BY_ALL_PAIRS)]
    pub most_by_all_pairs: u32,
    /// Boids in the picture.
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub picture_boids: u32,
    /// Steps until the last picture.
    #[arg(long, value_name = "STEPS", default_value_t = 2000)]
    pub picture_steps: u32,
    /// Area per boid; the paper has 20 boids on a torus of 800 x 600.
    #[arg(long, value_name = "AREA", default_value_t = 24_000.0)]
    pub area_per_boid: f32,
    /// Distance of a boid's step.
    #[arg(long, value_name = "LENGTH", default_value_t = 2.0)]
    pub speed: f32,
    /// Distance below which a boid turns away.
    #[arg(long, value_name = "LENGTH", default_value_t = 30.0)]
    pub crowded: f32,
    /// Largest distance of a neighbour.
    #[arg(long, value_name = "LENGTH", default_value_t = 150.0)]
    pub closest: f32,
    /// Largest turn to the heading or the middle of neighbours, radians.
    #[arg(long, value_name = "RADIANS", default_value_t = 0.05)]
    pub max_turn: f32,
    /// Largest turn away, radians.
    #[arg(long, value_name = "RADIANS", default_value_t = 0.02)]
    pub max_turn_away: f32,
    /// Seed; equal seeds give equal trajectories.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-boids")]
    pub out: PathBuf,
}

impl Default for Plan {
    fn default() -> Self {
        options::defaults()
    }
}

/// Boids on a torus.
#[derive(Clone, Debug)]
pub struct Flock {
    space: Space<f32, 2>,
    torus: Torus<f32>,
    params: BoidsParams<f32>,
    closest: f32,
    speed: f32,
    places: Vec<[f32; 2]>,
    headings: Vec<Vec2<f32>>,
    next: Vec<Vec2<f32>>,
}

impl Plan {
    /// Creates `boids` boids whose places and headings are uniform over the torus, functions of the
    /// seed and the boid's number. The sides of the torus have the ratio 4 to 3 of the paper.
    #[must_use]
    pub fn flock(&self, boids: u32) -> Flock {
        let width = (boids as f32 * self.area_per_boid * 4.0 / 3.0).sqrt();
        self.flock_on(boids, [width, width * 0.75])
    }

    /// Like [`Plan::flock`], on a torus with these sides, which must be above 0.
    #[must_use]
    pub fn flock_on(&self, boids: u32, sides: [f32; 2]) -> Flock {
        let start = |boid: u32| {
            let mut rng = Rng::keyed(self.seed, STARTS, boid, 0);
            // 24 bits: exact in f32 and below 1.
            let mut share = || (rng.next_u32() >> 8) as f32 / 16_777_216.0;
            let place = [share() * sides[0], share() * sides[1]];
            let (sin, cos) = libm::sincosf(share() * std::f32::consts::TAU);
            (place, Vec2::new(cos, sin))
        };
        let (places, headings) = (0..boids).map(start).unzip();
        Flock {
            space: Space::torus(sides).unwrap_or(Space::OPEN),
            torus: Torus { size_m: sides },
            params: BoidsParams::new(self.crowded, self.closest, self.max_turn, self.max_turn_away),
            closest: self.closest,
            speed: self.speed,
            places,
            headings,
            next: vec![Vec2::ZERO; boids as usize],
        }
    }

    /// Whether this search is used for this number of boids.
    #[must_use]
    pub const fn is_run(&self, method: Method, boids: u32) -> bool {
        !matches!(method, Method::AllPairs | Method::MutualPairs) || boids <= self.most_by_all_pairs
    }

    /// `None` if it was stopped, because an incomplete row compares nothing.
    fn row(&self, boids: u32, may_continue: &dyn Fn() -> bool) -> Option<Row> {
        let mut row = Row::new(boids, self.steps);
        for method in Method::ALL {
            if !may_continue() {
                return None;
            }
            if self.is_run(method, boids) {
                row.timings.push(self.time(method, boids, &mut row.mean_neighbours));
            }
        }
        row.parallel_us_per_boid = self.time_in_parallel(boids);
        row.settle();
        Some(row)
    }

    fn time(&self, method: Method, boids: u32, mean_neighbours: &mut f64) -> Timing {
        let mut flock = self.flock(boids);
        let mut search = method.search(flock.space, self.closest);
        let seconds = self.seconds_a_step(|| flock.step_by(&mut search));
        let neighbours = match &search {
            AnySearch::AllPairs(search) => flock.neighbours(search),
            AnySearch::MutualPairs(search) => flock.neighbours(search),
            AnySearch::Cells(search) => flock.neighbours(search),
            AnySearch::Tree(search) => flock.neighbours(search),
            AnySearch::MidpointTree(search) => flock.neighbours(search),
        };
        *mean_neighbours = neighbours as f64 / f64::from(boids);
        Timing {
            method: method.name(),
            us_per_boid: seconds * 1e6 / f64::from(boids),
            ms_per_step: seconds * 1e3,
            hash: format!("{:016x}", flock.hash()),
        }
    }

    fn time_in_parallel(&self, boids: u32) -> f64 {
        let mut flock = self.flock(boids);
        let mut cells = Cells::new(flock.space, self.closest);
        self.seconds_a_step(|| flock.step_in_parallel(&mut cells)) * 1e6 / f64::from(boids)
    }

    fn seconds_a_step(&self, mut step: impl FnMut()) -> f64 {
        let timed = |_| {
            let begun = Instant::now();
            step();
            begun.elapsed().as_secs_f64()
        };
        let mut times: Vec<f64> = (0..self.steps).map(timed).collect();
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    }

    /// The flock at its start, after a tenth of the steps, and at its end.
    fn picture(&self) -> Vec<(u32, Flock)> {
        let mut flock = self.flock(self.picture_boids);
        let mut cells = Cells::new(flock.space, self.closest);
        let moments = [0, self.picture_steps / 10, self.picture_steps];
        let mut kept = vec![(0, flock.clone())];
        for step in 1..=self.picture_steps {
            flock.step(&mut cells);
            if moments.contains(&step) {
                kept.push((step, flock.clone()));
            }
        }
        kept
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "boids";
    const UNIT: &'static str = "lines";
    const ALONE: bool = true;
    type Run = Row;
    type Report = Report;

    fn check(&self) -> Result<()> {
        ensure!(!self.boids.is_empty(), "no numbers of boids; give one or more");
        for boids in self.boids.iter().chain([&self.picture_boids]) {
            ensure!((1..=1_000_000).contains(boids), "{boids} boids; give 1 to 1000000");
        }
        ensure!(self.steps > 0, "0 steps; give 1 or more");
        for (name, value) in [
            ("area per boid", self.area_per_boid),
            ("speed", self.speed),
            ("crowded", self.crowded),
            ("closest", self.closest),
        ] {
            ensure!(value > 0.0 && value.is_finite(), "{name} = {value}; give a number above 0");
        }
        for (name, turn) in [("largest turn", self.max_turn), ("largest turn away", self.max_turn_away)] {
            let is_angle = (0.0..=std::f32::consts::PI).contains(&turn);
            ensure!(is_angle, "{name} = {turn} radians; give 0 to pi");
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.boids.len()
    }

    fn runs(&self) -> u32 {
        1
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            boids,
            steps,
            most_by_all_pairs,
            picture_boids: _,
            picture_steps: _,
            area_per_boid,
            speed,
            crowded,
            closest,
            max_turn,
            max_turn_away,
            seed: _,
            out: _,
        } = self;
        let number = |value: f32| Value::from(f64::from(value));
        vec![
            ("boids", boids[point].into()),
            ("steps", (*steps).into()),
            ("all_pairs_up_to", (*most_by_all_pairs).into()),
            ("area_per_boid", number(*area_per_boid)),
            ("speed", number(*speed)),
            ("crowded", number(*crowded)),
            ("closest", number(*closest)),
            ("max_turn", number(*max_turn)),
            ("max_turn_away", number(*max_turn_away)),
            ("threads", (rayon::current_num_threads() as u32).into()),
        ]
    }

    fn seed(&self, _: usize, _: u32) -> u64 {
        self.seed
    }

    fn blank(&self, point: usize, _: u32) -> Row {
        Row::new(self.boids[point], self.steps)
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Row>>> {
        jobs.each(|(): &mut (), point, _| Ok(self.row(self.boids[point], &|| jobs.may_continue())))
    }

    fn report(&self, rows: &[Vec<Row>]) -> Report {
        let mut rows = rows.concat();
        rows.iter_mut().for_each(Row::tell_hashes);
        let is_complete = rows.len() == self.boids.len();
        let picture = if is_complete { self.picture() } else { Vec::new() };
        Report::new(self, rows, picture)
    }

    fn draw(&self, _: &[Vec<Row>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        Ok(report.draw(dir)?)
    }

    fn judge(report: &Report) -> Result<()> {
        ensure!(report.equal, "the searches gave different flights: a defect, please report it");
        Ok(())
    }
}

impl Flock {
    /// Places on the torus.
    #[must_use]
    pub fn places(&self) -> &[[f32; 2]] {
        &self.places
    }

    /// Headings as unit vectors.
    #[must_use]
    pub fn headings(&self) -> &[Vec2<f32>] {
        &self.headings
    }

    /// Sides of the torus.
    #[must_use]
    pub const fn sides(&self) -> [f32; 2] {
        self.torus.size_m
    }

    fn step_by(&mut self, search: &mut AnySearch) {
        match search {
            AnySearch::AllPairs(search) => self.step(search),
            AnySearch::MutualPairs(search) => self.step(search),
            AnySearch::Cells(search) => self.step_by_cells(search),
            AnySearch::Tree(search) => self.step(search),
            AnySearch::MidpointTree(search) => self.step(search),
        }
    }

    /// Turns all boids at once, then moves them. Runs on one thread.
    pub fn step(&mut self, search: &mut impl Search<f32, 2>) {
        search.rebuild(&self.places);
        let mut scratch = Scratch::default();
        let mut next = std::mem::take(&mut self.next);
        for (boid, next) in (0..).zip(&mut next) {
            *next = self.steer(search, boid, &mut scratch);
        }
        self.next = next;
        self.advance();
    }

    /// Like [`Flock::step`] with equal results, in the order of the cells: better for the cache.
    pub fn step_by_cells(&mut self, cells: &mut Cells<f32, 2>) {
        cells.rebuild(&self.places);
        let mut scratch = Scratch::default();
        let mut next = std::mem::take(&mut self.next);
        for &boid in cells.order() {
            next[boid as usize] = self.steer(cells, boid, &mut scratch);
        }
        self.next = next;
        self.advance();
    }

    /// Like [`Flock::step`] with equal results, on all threads.
    pub fn step_in_parallel(&mut self, cells: &mut Cells<f32, 2>) {
        cells.rebuild(&self.places);
        let (order, this) = (cells.order(), &*self);
        let turned: Vec<(u32, Vec2<f32>)> = order
            .par_iter()
            .with_min_len(PIECE)
            .map_init(Scratch::default, |scratch, &boid| (boid, this.steer(cells, boid, scratch)))
            .collect();
        for (boid, heading) in turned {
            self.next[boid as usize] = heading;
        }
        self.advance();
    }

    fn steer(&self, search: &impl Search<f32, 2>, boid: u32, scratch: &mut Scratch) -> Vec2<f32> {
        let query = self.query(boid);
        search.within(&query, &mut scratch.found);
        scratch.nearby.clear();
        let seen = scratch.found.iter().map(|other| {
            let [x, y] = other.offset;
            let heading = self.headings[other.index as usize];
            Nearby {
                id: RobotId(other.index + 1),
                offset_m: Vec3::new(x, y, 0.0),
                velocity_mps: heading.extend(0.0),
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            }
        });
        scratch.nearby.extend(seen);
        let heading = self.headings[boid as usize];
        self.params.steer(RobotId(boid + 1), heading, &scratch.nearby)
    }

    fn query(&self, boid: u32) -> Query<f32, 2> {
        Query { at: self.places[boid as usize], radius: self.closest, most: usize::MAX, except: Some(boid) }
    }

    fn advance(&mut self) {
        std::mem::swap(&mut self.headings, &mut self.next);
        for (place, heading) in self.places.iter_mut().zip(&self.headings) {
            let moved = Vec2::new(place[0], place[1]) + *heading * self.speed;
            let Vec2 { x, y } = self.torus.wrap(moved);
            *place = [x, y];
        }
    }

    fn neighbours(&self, search: &impl Search<f32, 2>) -> u64 {
        let mut found = Vec::new();
        let mut count = 0;
        for boid in 0..self.places.len() as u32 {
            search.within(&self.query(boid), &mut found);
            count += found.len() as u64;
        }
        count
    }

    /// Hash of the bits of all places and headings.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let headings = self.headings.iter().flat_map(|h| [h.x, h.y]);
        let places = self.places.iter().copied().flatten();
        for byte in places.chain(headings).flat_map(|x| x.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        hash
    }
}

#[derive(Debug, Default)]
struct Scratch {
    found: Vec<Found<f32, 2>>,
    nearby: Vec<Nearby<f32>>,
}
