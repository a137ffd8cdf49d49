//! Boids on a torus, and the cost of neighbour search (V. A. Starovoitova 2018, STA, section 2.3).
//!
//! The controller's boids ([`staya_controller::boids`]) run on the host without radio and
//! packets: each knows the exact places and headings of its neighbours. All searches of
//! [`nearby`](staya_sim::nearby) and [`searches`] have the same start, must give bitwise equal
//! trajectories, and are timed on one thread.

pub mod dimensions;
pub mod listing;
pub mod searches;
#[cfg(test)]
mod tests;

use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use rayon::prelude::*;
use searches::{MidpointTree, MutualPairs, Quadtree, Tree};
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Torus, Vec2, Vec3};
use staya_controller::neighbor::Nearby;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_plot::flock::{Body, Sheet, Snapshot};
use staya_sim::metrics::flock::polarisation;
use staya_sim::nearby::{AllPairs, Cells, Found, Query, Search, Space};
use staya_sim::{choice, defaults, table};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::time::Instant;

const STARTS: u32 = 0x0045_0301;

const PIECE: usize = 256;

/// The study.
#[derive(Debug)]
pub struct Boids;

choice! {
    /// A neighbour search.
    pub enum Method {
        /// Compares each boid with all others.
        AllPairs = "all_pairs",
        /// Compares each pair once.
        PairsOnce = "pairs_once",
        /// Lattice cells.
        Cells = "cells",
        /// Lattice cells on all threads.
        Threads = "threads",
        /// The k-d tree of the crate `kiddo`.
        Tree = "tree",
        /// A k-d tree by the sliding midpoint rule, as in the paper.
        MidpointTree = "midpoint_tree",
        /// A quadtree with a boid in each node, as in the paper.
        Quadtree = "quadtree",
    }
}

table! {
    /// Parameters of a run; lengths are the paper's.
    pub struct Parameters {
        /// Number of boids.
        pub boids: u32 = 100, 1.0..=1e6, "";
        /// The search.
        pub search: Method = Method::Cells;
        /// Timed steps.
        pub steps: u32 = 20, 1.0..=1e6, "";
        /// The searches of pairs have no figures for more boids than this.
        pub all_pairs_up_to: u32 = 10_000;
        /// Area per boid; the paper has 20 boids on a torus of 800 x 600.
        pub area_per_boid: f32 = 24_000.0;
        /// Distance of a boid's step.
        pub speed: f32 = 2.0;
        /// Distance below which a boid turns away.
        pub crowded: f32 = 30.0;
        /// Largest distance of a neighbour.
        pub closest: f32 = 150.0;
        /// Largest turn to the heading or the middle of neighbours, radians.
        pub max_turn: f32 = 0.05, 0.0..=PI, "radians";
        /// Largest turn away, radians.
        pub max_turn_away: f32 = 0.02, 0.0..=PI, "radians";
    }
}

defaults!(Parameters);

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

impl Parameters {
    /// Creates `boids` boids whose places and headings are uniform over the torus, functions of the
    /// seed and the boid's number. The sides of the torus have the ratio 4 to 3 of the paper.
    #[must_use]
    pub fn flock(&self, boids: u32, seed: u64) -> Flock {
        let width = (boids as f32 * self.area_per_boid * 4.0 / 3.0).sqrt();
        self.flock_on(boids, [width, width * 0.75], seed)
    }

    /// Like [`Parameters::flock`], on a torus with these sides, which must be above 0.
    #[must_use]
    pub fn flock_on(&self, boids: u32, sides: [f32; 2], seed: u64) -> Flock {
        let start = |boid: u32| {
            let mut rng = Rng::keyed(seed, STARTS, boid, 0);
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

    fn read(given: &Given<'_>) -> Result<Self, SweepError> {
        let this: Self = given.parameters()?;
        let Self { area_per_boid, speed, crowded, closest, .. } = this;
        let lengths = [("area_per_boid", area_per_boid), ("speed", speed), ("crowded", crowded), ("closest", closest)];
        for (name, value) in lengths {
            if !(value > 0.0 && value.is_finite()) {
                return Err(given.error(name, format!("{value} is out of range"), "give a number above 0"));
            }
        }
        Ok(this)
    }

    fn measure(&self, seed: u64, watch: &Watch<'_>) -> Measured {
        let is_of_pairs = matches!(self.search, Method::AllPairs | Method::PairsOnce);
        if is_of_pairs && self.boids > self.all_pairs_up_to {
            return Measured::default();
        }
        let mut flock = self.flock(self.boids, seed);
        let mut reference = flock.clone();
        let mut cells = Cells::new(flock.space, self.closest);
        let mut other: Box<dyn Search<f32, 2>> = match self.search {
            Method::AllPairs => Box::new(AllPairs::new(flock.space)),
            Method::PairsOnce => Box::new(MutualPairs::new(flock.space, self.closest)),
            Method::Tree => Box::new(Tree::new(flock.space)),
            Method::MidpointTree => Box::new(MidpointTree::new(flock.space)),
            Method::Quadtree => Box::new(Quadtree::new(flock.space)),
            // For up to 150 neighbours, cells as large as the radius are fastest.
            Method::Cells | Method::Threads => Box::new(cells.clone()),
        };
        let mut times = Vec::new();
        for step in 0..self.steps {
            if !watch(step) {
                return Measured { is_cut: true, ..Measured::default() };
            }
            let begun = Instant::now();
            match self.search {
                Method::Cells => flock.step_by_cells(&mut cells),
                Method::Threads => flock.step_in_parallel(&mut cells),
                _ => flock.step(&mut *other),
            }
            times.push(begun.elapsed().as_secs_f64());
        }
        times.sort_unstable_by(f64::total_cmp);
        let boids = f64::from(self.boids);
        other.rebuild(&flock.places);
        let neighbours = flock.neighbours(&*other) as f64 / boids;
        (0..self.steps).for_each(|_| reference.step_by_cells(&mut cells));
        let is_equal = reference.hash() == flock.hash();
        let values = [
            ("us_per_boid", times[times.len() / 2] * 1e6 / boids),
            ("neighbours", neighbours),
            ("order", flock.order()),
            ("equal", f64::from(u8::from(is_equal))),
        ];
        let measured = Measured::of(values.map(|(name, value)| (name, Some(value))));
        Measured { trace_hash: format!("{:016x}", flock.hash()), ..measured }
    }
}

impl Study for Boids {
    fn name(&self) -> &'static str {
        "boids"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("us_per_boid", "wall time of the median step per boid, with building the index, microseconds"),
            ("neighbours", "mean number of neighbours after the last step"),
            ("order", "length of the mean heading after the last step, 0 to 1"),
            ("equal", "1: the trajectories are those of lattice cells, bit for bit"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn is_timed(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (parameters, seed) = (Parameters::read(given)?, given.seed);
        Ok(Box::new(move |watch| Ok(parameters.measure(seed, watch))))
    }

    /// The flock at its start, after a tenth of the steps, and at its end.
    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let parameters = Parameters::read(given)?;
        let mut flock = parameters.flock(parameters.boids, given.seed);
        let mut cells = Cells::new(flock.space, parameters.closest);
        let mut sheet = Sheet::new(title, 3);
        for step in 0..=parameters.steps {
            if [0, parameters.steps / 10, parameters.steps].contains(&step) {
                sheet = sheet.with(flock.snapshot(step));
            }
            flock.step_by_cells(&mut cells);
        }
        Ok(sheet.draw().write(stem)?)
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

    /// Turns all boids at once, then moves them. Runs on one thread.
    pub fn step(&mut self, search: &mut (impl Search<f32, 2> + ?Sized)) {
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

    fn steer(&self, search: &(impl Search<f32, 2> + ?Sized), boid: u32, scratch: &mut Scratch) -> Vec2<f32> {
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

    /// Length of the mean heading, 0 to 1.
    fn order(&self) -> f64 {
        polarisation::<2>(&self.headings.iter().map(|h| [h.x, h.y].map(f64::from)).collect::<Vec<_>>())
    }

    fn snapshot(&self, step: u32) -> Snapshot {
        let [width, height] = self.sides().map(f64::from);
        let bodies = self.places.iter().zip(&self.headings).map(|(&[x, y], heading)| Body {
            position_m: [x, y, 0.0].map(f64::from),
            velocity_mps: [heading.x, heading.y, 0.0].map(f64::from),
            ..Body::default()
        });
        Snapshot {
            title: format!("step {step}, group order {:.2}", self.order()),
            bodies: bodies.collect(),
            span_m: Some([[0.0; 3], [width, height, 0.0]]),
            labels: ["x".into(), "y".into()],
            size: [440.0, 366.0],
            ..Snapshot::default()
        }
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

    fn neighbours(&self, search: &dyn Search<f32, 2>) -> u64 {
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
        let headings = self.headings.iter().flat_map(|h| [h.x, h.y]);
        let places = self.places.iter().copied().flatten();
        hash(places.chain(headings).flat_map(|x| x.to_bits().to_le_bytes()))
    }
}

fn hash(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[derive(Debug, Default)]
struct Scratch {
    found: Vec<Found<f32, 2>>,
    nearby: Vec<Nearby<f32>>,
}
