//! Local minima of the potentials of alpha flocks (OLF, sections IV and V): V of algorithm 1, and
//! U_lambda = V + lambda J of algorithm 2. The paper claims that all minima of V are lattices
//! (theorem 3), and conjectures that those of U_lambda are connected (conjecture 1).
//!
//! A run descends from a random start to rest and computes the eigenvalues of the Hessian there. A
//! minimum is strict, up to translation and rotation, if all but three are positive. Values are
//! doubles, not intervals: a strict minimum is established numerically, not proved.

mod eigen;
mod potential;
#[cfg(test)]
mod tests;

use super::flock::normal;
use super::rings::{ring, rings};
use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use eigen::eigenvalues;
use potential::Potential;
use staya_controller::rand::Rng;
use staya_sim::metrics::flock::{FlockMeter, crossings};
use staya_sim::nearby::Space;
use staya_sim::{choice, table};

const STARTS: u32 = 0x0046_0301;

/// The study.
#[derive(Debug)]
pub struct Minima;

choice! {
    /// Arrangement of a start.
    pub enum Shape {
        /// Normally distributed places.
        Cloud = "cloud",
        /// A lattice that grows around a robot, ring after ring.
        Disc = "disc",
        /// Some rings of the lattice around a robot, without those between.
        Ring = "ring",
        /// A disc with two robots in its middle.
        Double = "double",
    }
}

table! {
    /// Parameters of a run; lengths are in spacings d.
    pub struct Parameters {
        /// Arrangement of the start.
        pub start: Shape = Shape::Cloud;
        /// Number of robots, but for a ring.
        pub robots: u32 = 15, 2.0..=200.0, "";
        /// First and last ring of the lattice around the robot in a ring.
        pub rings: [u32; 2] = [2, 3];
        /// Weight of J, half the sum of squared distances from the centroid; the ratio of the gains
        /// of reference and robots in algorithm 2.
        pub lambda: f64 = 0.0, 0.0..=10.0, "";
        /// Another lambda of a descent before, which gathers a cloud.
        pub gathers: f64 = 0.0, 0.0..=10.0, "";
        /// Standard deviation of places along each axis: of the cloud, or of the other starts from
        /// their arrangement.
        pub deviation: f64 = 0.0, 0.0..=100.0, "d";
    }
}

impl Study for Minima {
    fn name(&self) -> &'static str {
        "minima"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("parts", "connected parts at rest; links are up to 1.2 spacings long"),
            ("links", "links at rest"),
            ("crossings", "pairs of links that cross at rest"),
            ("off_lattice", "largest difference of a link's length from the spacing, in spacings"),
            ("force", "largest force on a robot at rest, in the paper's units"),
            ("null", "eigenvalues of the Hessian that are 0: three if no part moves freely"),
            ("least_eigenvalue", "least other eigenvalue of the Hessian"),
            ("strict", "1 if the minimum is strict, up to translation and rotation; else 0"),
            ("strict_off_lattice", "1 if the minimum is strict and no lattice within 0.1 %; else 0"),
            ("strained", "1 if in addition no two robots are within half a spacing; else 0"),
            ("shortest", "length of the shortest link at rest, in spacings"),
            ("potential", "V + lambda J at rest, in the paper's units"),
            ("over_collision", "the potential at rest over that of two robots in one place, psi(0)"),
            ("returned", "1 if it is the minimum of the start without deviation; else 0"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let parameters: Parameters = given.parameters()?;
        let [first, last] = parameters.rings;
        if !(1 <= first && first <= last && last <= 6) {
            return Err(given.error("rings", "rings are numbered 1 to 6", "give the first and the last"));
        }
        if parameters.start == Shape::Cloud && parameters.deviation == 0.0 {
            return Err(given.error("deviation", "a cloud has one", "give study.deviation"));
        }
        let (returns, seed) = (given.measures.iter().any(|name| name == "returned"), given.seed);
        Ok(Box::new(move |watch| parameters.measured(seed, returns, watch)))
    }
}

impl Parameters {
    fn measured(&self, seed: u64, returns: bool, watch: &Watch<'_>) -> Result<Measured, String> {
        let potential = Potential::new(self.lambda).ok_or("no potential")?;
        let mut starts = self.starts(seed, self.deviation);
        if self.gathers > 0.0 {
            (starts, _) = Potential::new(self.gathers).ok_or("no potential")?.rest(starts, watch);
        }
        let (places, is_cut) = potential.rest(starts, watch);
        if is_cut {
            return Ok(Measured { is_cut, ..Measured::default() });
        }
        let mut meter = FlockMeter::new(1.0, potential.range(), Space::OPEN);
        let measure = meter.look(&places, &vec![[0.0; 2]; places.len()]).ok_or("the robots diverge")?;
        let length = |&(a, b): &(u32, u32)| {
            let [from, to] = [a, b].map(|robot| places[robot as usize]);
            libm::hypot(to[0] - from[0], to[1] - from[1])
        };
        let off_lattice = meter.edges().iter().map(|link| (length(link) - 1.0).abs()).fold(0.0, f64::max);
        let shortest = meter.edges().iter().map(length).reduce(f64::min);
        let (force, at_rest) = (potential.force(&places), potential.at(&places));
        let eigenvalues = eigenvalues(potential.hessian(&places));
        let is_null = |value: &&f64| value.abs() < NULL;
        let least = eigenvalues.iter().filter(|value| value.abs() >= NULL).copied().reduce(f64::min);
        let null = eigenvalues.iter().filter(is_null).count();
        let is_strict = force < REST && null == 3 && least.is_some_and(|least| least > 0.0);
        let returned = (returns && self.start != Shape::Cloud).then(|| {
            let (own, _) = potential.rest(self.starts(seed, 0.0), watch);
            (potential.at(&own) - at_rest).abs() < 1e-6 * at_rest.abs().max(1.0)
        });
        let flag = |is: bool| Some(f64::from(u8::from(is)));
        Ok(Measured::of([
            ("parts", Some(measure.components as f64)),
            ("links", Some(measure.edges as f64)),
            ("crossings", crossings(&places, meter.edges()).map(|count| count as f64)),
            ("off_lattice", Some(off_lattice)),
            ("force", Some(force)),
            ("null", Some(null as f64)),
            ("least_eigenvalue", least),
            ("strict", flag(is_strict)),
            ("strict_off_lattice", flag(is_strict && off_lattice > 1e-3)),
            ("strained", flag(is_strict && off_lattice > 1e-3 && shortest.is_some_and(|length| length > 0.5))),
            ("shortest", shortest),
            ("potential", Some(at_rest)),
            ("over_collision", Some(at_rest / potential.collision())),
            ("returned", returned.and_then(flag)),
        ]))
    }

    /// Places in spacings, each a function of the seed and the robot.
    fn starts(&self, seed: u64, deviation: f64) -> Vec<[f64; 2]> {
        let mut places: Vec<[f64; 2]> = match self.start {
            Shape::Cloud => vec![[0.0; 2]; self.robots as usize],
            Shape::Disc => (0..).flat_map(ring).take(self.robots as usize).collect(),
            Shape::Double => std::iter::once(0).chain(0..).flat_map(ring).take(self.robots as usize).collect(),
            Shape::Ring => rings(self.rings).collect(),
        };
        for (robot, place) in (0..).zip(&mut places) {
            let mut rng = Rng::keyed(seed, STARTS, robot, 0);
            *place = place.map(|c| c + normal(&mut rng, deviation));
        }
        places
    }
}

/// Forces below this are 0; the largest of a link is above 10.
const REST: f64 = 1e-6;
/// Eigenvalues below this are 0, with the error of finite differences.
const NULL: f64 = 1e-5;
