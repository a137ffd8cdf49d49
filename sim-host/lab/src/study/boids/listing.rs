//! The boids of STA's listing as printed, and its defects repaired one after the other.
//!
//! Source: V. A. Starovoitova 2018 (STA), section 2.4 and appendix A, classes `Boid` and `TwoD`.
//! The headings are angles as there, so that the printed errors of angles appear; the controller's
//! [`boids`](staya_controller::boids) are the repaired law on unit vectors.

use super::{Given, Study, hash};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use staya_controller::rand::Rng;
use staya_plot::flock::{Body, Sheet, Snapshot};
use staya_sim::metrics::flock::polarisation;
use staya_sim::{choice, defaults, table};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

const STARTS: u32 = 0x0045_0302;
/// Sides of the window, in which boids start within [`AROUND`] of the middle along each axis.
const SIDES: [f64; 2] = [800.0, 600.0];
const AROUND: u32 = 200;
/// Width of the border in which `simulate_wall` turns a boid back.
const WALL: f64 = 100.0;

/// The study.
#[derive(Debug)]
pub struct Listing;

choice! {
    /// The last repair of the listing; each includes those before it.
    #[derive(PartialOrd, Ord)]
    pub enum Repair {
        /// None: the listing as printed.
        Printed = "printed",
        /// `getConnections` numbers the other boids, and indexes the list of all boids with these
        /// numbers, so that a boid sees wrong neighbours. Here it indexes the others.
        Index = "index",
        /// `cohere` turns away from the middle of the neighbours. Here it turns towards it.
        Middle = "middle",
        /// `align` divides a sum of angles and of the own heading by the number of neighbours. Here
        /// the mean heading is the direction of the sum of the neighbours' unit vectors.
        Circle = "circle",
        /// Distances and the middle ignore that boids leave the window on one side and return on
        /// the other. Here they are the shortest on the torus.
        Torus = "torus",
        /// Boids turn one after the other and see the new headings of those before them. Here all
        /// turn at once.
        AtOnce = "at_once",
    }
}

table! {
    /// Parameters of a run; defaults are the listing's, but for `BOIDS = 3`: the text has 20.
    pub struct Parameters {
        /// The last repair.
        pub repair: Repair = Repair::Printed;
        /// Whether `simulate_wall` is called before and after boids turn, as in its comments.
        pub walls: bool = false;
        /// Number of boids.
        pub boids: u32 = 20, 2.0..=1e4, "";
        /// Steps; the last third is measured.
        pub steps: u32 = 3000, 3.0..=1e7, "";
        /// Distance of a boid's step.
        pub speed: f64 = 2.0, 0.0..=100.0, "";
        /// Distance below which a boid turns away; the text has 5.
        pub crowded: f64 = 30.0, 0.0..=1e4, "";
        /// Largest distance of a neighbour.
        pub closest: f64 = 150.0, 0.0..=1e4, "";
        /// Largest turn to the heading or the middle of neighbours, radians.
        pub max_turn: f64 = 0.05, 0.0..=PI, "radians";
        /// Turn away, radians.
        pub max_turn_away: f64 = 0.02, 0.0..=PI, "radians";
    }
}

defaults!(Parameters);

/// A boid of the listing.
#[derive(Clone, Copy, Debug)]
struct Boid {
    at: [f64; 2],
    /// Angle, radians.
    heading: f64,
}

/// All boids.
struct Boids<'a> {
    parameters: &'a Parameters,
    all: Vec<Boid>,
}

impl<'a> Boids<'a> {
    /// Whole coordinates, as `random.randint`, and headings in 0 to 2 pi.
    fn new(parameters: &'a Parameters, seed: u64) -> Self {
        let start = |boid: u32| {
            let mut rng = Rng::keyed(seed, STARTS, boid, 0);
            let at = SIDES.map(|side| side / 2.0 - f64::from(AROUND) + f64::from(rng.below(2 * AROUND + 1)));
            Boid { at, heading: f64::from(rng.next_u32()) / 4_294_967_296.0 * TAU }
        };
        Self { parameters, all: (0..parameters.boids).map(start).collect() }
    }

    fn has(&self, repair: Repair) -> bool {
        self.parameters.repair >= repair
    }

    fn way(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        let is_torus = self.has(Repair::Torus);
        std::array::from_fn(|axis| {
            let (way, side) = (to[axis] - from[axis], SIDES[axis]);
            if is_torus { way - side * libm::rint(way / side) } else { way }
        })
    }

    fn distance(&self, from: [f64; 2], to: [f64; 2]) -> f64 {
        let [x, y] = self.way(from, to);
        libm::hypot(x, y)
    }

    /// `getConnections`. Without the repaired index it may return the boid itself.
    fn connections(&self, own: usize) -> Vec<usize> {
        let others = (0..self.all.len()).filter(|other| *other != own);
        let is_near = |other: &usize| self.distance(self.all[own].at, self.all[*other].at) <= self.parameters.closest;
        let numbered = others.enumerate().filter(|(_, other)| is_near(other));
        numbered.map(|(number, other)| if self.has(Repair::Index) { other } else { number }).collect()
    }

    /// `adjust_heading`.
    fn adjusted(&self, own: usize) -> f64 {
        let Boid { at, heading } = self.all[own];
        let near = self.connections(own);
        let by_distance = near.iter().map(|other| (self.distance(at, self.all[*other].at), *other));
        let nearest = by_distance.fold(None, |best: Option<(f64, usize)>, next| match best {
            Some(best) if best.0 <= next.0 => Some(best),
            _ => Some(next),
        });
        match nearest {
            None => heading,
            Some((distance, other)) if distance < self.parameters.crowded => {
                self.separated(heading, self.all[other].heading)
            }
            Some(_) => self.cohering(own, self.aligned(own, &near), &near),
        }
    }

    /// `separate`.
    fn separated(&self, heading: f64, other: f64) -> f64 {
        let turn = self.parameters.max_turn_away;
        let turned = if difference(heading, other) > 0.0 { heading - turn } else { heading + turn };
        normal(turned)
    }

    /// `turn_towards`.
    fn turned(&self, heading: f64, target: f64) -> f64 {
        let (turn, diff) = (self.parameters.max_turn, difference(heading, target));
        normal(heading + if diff > 0.0 { diff.min(turn) } else { diff.max(-turn) })
    }

    /// `align`.
    fn aligned(&self, own: usize, near: &[usize]) -> f64 {
        let heading = self.all[own].heading;
        let others = near.iter().filter(|other| **other != own).map(|other| self.all[*other].heading);
        if !self.has(Repair::Circle) {
            return self.turned(heading, (heading + others.sum::<f64>()) / near.len() as f64);
        }
        let sum = others.fold([0.0, 0.0], |[x, y], other| [x + libm::cos(other), y + libm::sin(other)]);
        self.turned(heading, libm::atan2(sum[1], sum[0]))
    }

    /// `cohere`, from the aligned heading.
    fn cohering(&self, own: usize, heading: f64, near: &[usize]) -> f64 {
        let at = self.all[own].at;
        let others = near.iter().filter(|other| **other != own).map(|other| self.all[*other].at);
        let middle: [f64; 2] = if self.has(Repair::Torus) {
            let ways = others.map(|other| self.way(at, other));
            ways.fold([0.0; 2], |sum, way| [sum[0] + way[0], sum[1] + way[1]])
        } else {
            let sum = others.fold([0.0; 2], |sum, other| [sum[0] + other[0], sum[1] + other[1]]);
            std::array::from_fn(|axis| sum[axis] / near.len() as f64 - at[axis])
        };
        let sign = if self.has(Repair::Middle) { 1.0 } else { -1.0 };
        self.turned(heading, libm::atan2(sign * middle[1], sign * middle[0]))
    }

    /// `simulate_wall`: its four cases are one, the direction to the middle of the window.
    fn wall(&mut self) {
        if !self.parameters.walls {
            return;
        }
        for boid in &mut self.all {
            let is_at_wall = |axis: usize| boid.at[axis] < WALL || boid.at[axis] > SIDES[axis] - WALL;
            if is_at_wall(0) || is_at_wall(1) {
                let [x, y]: [f64; 2] = std::array::from_fn(|axis| SIDES[axis] / 2.0 - boid.at[axis]);
                boid.heading = libm::atan2(y, x);
            }
        }
    }

    /// `move`.
    fn step(&mut self) {
        self.wall();
        if self.has(Repair::AtOnce) {
            let next: Vec<f64> = (0..self.all.len()).map(|own| self.adjusted(own)).collect();
            self.all.iter_mut().zip(next).for_each(|(boid, heading)| boid.heading = heading);
        } else {
            for own in 0..self.all.len() {
                self.all[own].heading = self.adjusted(own);
            }
        }
        self.wall();
        for boid in &mut self.all {
            let ahead = [libm::cos(boid.heading), libm::sin(boid.heading)];
            for axis in 0..2 {
                let at = &mut boid.at[axis];
                *at += self.parameters.speed * ahead[axis];
                if *at > SIDES[axis] {
                    *at -= SIDES[axis];
                } else if *at < 0.0 {
                    *at += SIDES[axis];
                }
            }
        }
    }

    /// Length of the mean heading, 0 to 1.
    fn order(&self) -> f64 {
        polarisation::<2>(&self.headings().collect::<Vec<_>>())
    }

    fn headings(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.all.iter().map(|boid| [libm::cos(boid.heading), libm::sin(boid.heading)])
    }

    fn snapshot(&self, step: u32) -> Snapshot {
        let bodies = self.all.iter().zip(self.headings()).map(|(boid, [x, y])| Body {
            position_m: [boid.at[0], boid.at[1], 0.0],
            velocity_mps: [x, y, 0.0],
            ..Body::default()
        });
        Snapshot {
            title: format!("step {step}, group order {:.2}", self.order()),
            bodies: bodies.collect(),
            span_m: Some([[0.0; 3], [SIDES[0], SIDES[1], 0.0]]),
            labels: ["x".into(), "y".into()],
            size: [440.0, 366.0],
            ..Snapshot::default()
        }
    }
}

/// `subtract_headings`: in -pi to pi only if the angles are at most two turns apart.
fn difference(own: f64, other: f64) -> f64 {
    let mut diff = other - own;
    if diff <= -PI {
        diff += TAU;
    }
    if diff > PI {
        diff -= TAU;
    }
    diff
}

fn normal(heading: f64) -> f64 {
    let heading = if heading < 0.0 { heading + TAU } else { heading };
    if heading >= TAU { heading - TAU } else { heading }
}

impl Parameters {
    fn measure(&self, seed: u64, watch: &Watch<'_>) -> Measured {
        let mut boids = Boids::new(self, seed);
        let (mut sum, mut looks) = (0.0, 0_u32);
        for step in 0..self.steps {
            if !watch(step) {
                return Measured { is_cut: true, ..Measured::default() };
            }
            boids.step();
            if step >= self.steps - self.steps / 3 {
                sum += boids.order();
                looks += 1;
            }
        }
        let values = [("order", Some(sum / f64::from(looks))), ("order_at_end", Some(boids.order()))];
        let bits = boids.all.iter().flat_map(|boid| [boid.at[0], boid.at[1], boid.heading].map(f64::to_bits));
        Measured { trace_hash: format!("{:016x}", hash(bits.flat_map(u64::to_le_bytes))), ..Measured::of(values) }
    }
}

impl Study for Listing {
    fn name(&self) -> &'static str {
        "listing"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("order", "length of the mean heading, 0 to 1, mean over the last third of the steps"),
            ("order_at_end", "the same after the last step"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (parameters, seed): (Parameters, _) = (given.parameters()?, given.seed);
        Ok(Box::new(move |watch| Ok(parameters.measure(seed, watch))))
    }

    /// The boids at their start and at their end.
    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let parameters: Parameters = given.parameters()?;
        let mut boids = Boids::new(&parameters, given.seed);
        let first = boids.snapshot(0);
        (0..parameters.steps).for_each(|_| boids.step());
        let sheet = Sheet::new(title, 2).with(first).with(boids.snapshot(parameters.steps));
        Ok(sheet.draw().write(stem)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::boids::BoidsParams;
    use staya_controller::geom::{Vec2, Vec3};
    use staya_controller::neighbor::Nearby;
    use staya_controller::robot::{Mode, RobotId};

    const REPAIRS: [Repair; 6] =
        [Repair::Printed, Repair::Index, Repair::Middle, Repair::Circle, Repair::Torus, Repair::AtOnce];

    fn three(repair: Repair) -> Vec<usize> {
        let parameters = Parameters { repair, ..Parameters::default() };
        let boid = |x| Boid { at: [x, 300.0], heading: 0.0 };
        // The second sees the third, across the border of the torus also the first.
        let all = vec![boid(790.0), boid(10.0), boid(150.0)];
        Boids { parameters: &parameters, all }.connections(1)
    }

    #[test]
    fn printed_index_selects_the_boid_before() {
        assert_eq!(three(Repair::Printed), [1], "itself");
        assert_eq!(three(Repair::Index), [2]);
        assert_eq!(three(Repair::Torus), [0, 2]);
    }

    #[test]
    fn each_repair_changes_the_flight() {
        let of = |repair, walls| {
            let parameters = Parameters { repair, walls, steps: 300, ..Parameters::default() };
            parameters.measure(7, &|_| true).trace_hash
        };
        let mut hashes: Vec<_> = REPAIRS.iter().flat_map(|repair| [of(*repair, false), of(*repair, true)]).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 12);
        assert!(Parameters::default().measure(7, &|step| step < 5).is_cut);
    }

    #[test]
    fn walls_keep_boids_off_the_border() {
        let parameters = Parameters { walls: true, ..Parameters::default() };
        let mut boids = Boids::new(&parameters, 3);
        (0..1000).for_each(|_| boids.step());
        let least = WALL - parameters.speed;
        let is_inside = |boid: &Boid| (0..2).all(|axis| (least..=SIDES[axis] - least).contains(&boid.at[axis]));
        assert!(boids.all.iter().all(is_inside));
    }

    /// Two implementations of one law: this one on angles, the controller's on unit vectors.
    #[test]
    fn all_repairs_together_are_the_law_of_the_controller() {
        let parameters = Parameters { repair: Repair::AtOnce, ..Parameters::default() };
        let params = BoidsParams::<f64>::new(30.0, 150.0, 0.05, 0.02);
        let mut boids = Boids::new(&parameters, 11);
        for _ in 0..300 {
            for own in 0..boids.all.len() {
                let unit = |heading: f64| Vec2::new(libm::cos(heading), libm::sin(heading));
                let at = boids.all[own].at;
                let nearby = boids.connections(own).into_iter().map(|other| {
                    let [x, y] = boids.way(at, boids.all[other].at);
                    Nearby {
                        id: RobotId(other as u32 + 1),
                        offset_m: Vec3::new(x, y, 0.0),
                        velocity_mps: unit(boids.all[other].heading).extend(0.0),
                        radius_m: 0.0,
                        gives_way: true,
                        mode: Mode::Cruise,
                        is_stranger: false,
                    }
                });
                let nearby: Vec<_> = nearby.collect();
                let law = params.steer(RobotId(own as u32 + 1), unit(boids.all[own].heading), &nearby);
                let here = unit(boids.adjusted(own));
                assert!((law - here).norm() < 1e-6, "{own}: {law:?} {here:?}");
            }
            boids.step();
        }
    }
}
