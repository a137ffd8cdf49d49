//! Flocking quality of any crowd: connectivity, cohesion, spacing, velocity match, and overlaps.
//!
//! Source: OLF (R. Olfati-Saber 2006), sections II.B and IX, in the plane or in space. Polarisation
//! is a measure of PAV and STA. All sums run in the order of the robots on one thread, so that
//! values are identical on any machine.
//!
//! [`FlockMeter::look`] measures a moment, [`alpha_flocking`] classifies a trace of such moments,
//! [`Gaps`] counts overlaps, [`crossings`] those of links, and [`EnergyMeter`] computes the
//! Hamiltonian.

mod attitude;
mod energy;
mod gaps;
mod planar;
#[cfg(test)]
mod tests;

pub use attitude::attitude;
pub use energy::{Energy, EnergyMeter};
pub use gaps::{Gaps, Obstacle, gaps};
pub use planar::crossings;

use crate::nearby::{Cells, Found, Query, Search as _, Space};
use serde::{Deserialize, Serialize};

/// Flocking quality at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlockMeasure {
    /// Number of robots.
    pub robots: usize,
    /// Pairs of robots in range of each other.
    pub edges: usize,
    /// Connected components of the proximity graph.
    pub components: usize,
    /// Robots in the largest component.
    pub largest_component: usize,
    /// C, relative connectivity: (n - components) / (n - 1); 1 for a single robot.
    pub connectivity: f64,
    /// R, largest distance from the centroid, metres.
    pub radius_m: f64,
    /// E / d^2: sum of (length - d)^2 over ordered pairs, over their number plus 1, over d^2.
    pub deviation_energy: f64,
    /// K / n, (m/s)^2: half the squared velocities relative to their mean, per robot.
    pub velocity_mismatch: f64,
    /// Group order, 0 to 1: length of the mean direction of moving robots; 0 if all are stationary.
    pub polarisation: f64,
}

/// Measures crowds; keeps its buffers between moments.
#[derive(Clone, Debug)]
pub struct FlockMeter<const D: usize> {
    spacing_m: f64,
    range_m: f64,
    cells: Cells<f64, D>,
    found: Vec<Found<f64, D>>,
    edges: Vec<(u32, u32)>,
    parents: Vec<u32>,
}

impl<const D: usize> FlockMeter<D> {
    /// Creates a meter for spacing d and neighbours up to `range_m` (r, for OLF (1 + e0) d) in
    /// `space`. On a torus, R and the centroid are those of folded positions and have no meaning.
    #[must_use]
    pub fn new(spacing_m: f64, range_m: f64, space: Space<f64, D>) -> Self {
        Self {
            spacing_m,
            range_m,
            cells: Cells::new(space, range_m),
            found: Vec::new(),
            edges: Vec::new(),
            parents: Vec::new(),
        }
    }

    /// Measures robots with these positions, metres, and velocities, m/s. `None` if there are none
    /// or a value is not finite. O(n + edges) if robots are not much denser than the range.
    ///
    /// # Panics
    /// If there are not as many velocities as positions.
    pub fn look(&mut self, places_m: &[[f64; D]], velocities_mps: &[[f64; D]]) -> Option<FlockMeasure> {
        assert_eq!(places_m.len(), velocities_mps.len(), "one velocity a robot");
        let is_sound = |vectors: &[[f64; D]]| vectors.iter().flatten().all(|c| c.is_finite());
        if places_m.is_empty() || !is_sound(places_m) || !is_sound(velocities_mps) {
            return None;
        }
        let robots = places_m.len();
        let energy = self.link(places_m);
        let (components, largest_component) = self.components(robots);
        let edges = self.edges.len();
        let centre = mean(places_m);
        let radius_m = places_m.iter().map(|&place| length(minus(place, centre))).fold(0.0, f64::max);
        let drift = mean(velocities_mps);
        let kinetic: f64 = velocities_mps.iter().map(|&velocity| squared(minus(velocity, drift)) / 2.0).sum();
        Some(FlockMeasure {
            robots,
            edges,
            components,
            largest_component,
            connectivity: if robots > 1 { (robots - components) as f64 / (robots - 1) as f64 } else { 1.0 },
            radius_m,
            deviation_energy: 2.0 * energy / (2 * edges + 1) as f64 / (self.spacing_m * self.spacing_m),
            velocity_mismatch: kinetic / robots as f64,
            polarisation: polarisation(velocities_mps),
        })
    }

    /// Pairs of neighbours in the last measurement, as sorted indices, the smaller first.
    #[must_use]
    pub fn edges(&self) -> &[(u32, u32)] {
        &self.edges
    }

    /// Returns the sum of (length - d)^2.
    fn link(&mut self, places_m: &[[f64; D]]) -> f64 {
        self.cells.rebuild(places_m);
        self.edges.clear();
        self.parents.clear();
        self.parents.extend(0..places_m.len() as u32);
        let mut energy = 0.0;
        for (robot, &at) in (0..).zip(places_m) {
            let query = Query { at, radius: self.range_m, most: usize::MAX, except: Some(robot) };
            self.cells.within(&query, &mut self.found);
            for other in self.found.iter().filter(|other| other.index > robot) {
                let off = other.distance_squared.sqrt() - self.spacing_m;
                energy += off * off;
                self.edges.push((robot, other.index));
                let (a, b) = (root(&mut self.parents, robot), root(&mut self.parents, other.index));
                self.parents[a.max(b) as usize] = a.min(b);
            }
        }
        energy
    }

    fn components(&mut self, robots: usize) -> (usize, usize) {
        let mut sizes = vec![0_usize; robots];
        for robot in 0..robots as u32 {
            sizes[root(&mut self.parents, robot) as usize] += 1;
        }
        let components = sizes.iter().filter(|size| **size > 0).count();
        (components, sizes.into_iter().max().unwrap_or(0))
    }
}

fn root(parents: &mut [u32], mut robot: u32) -> u32 {
    while parents[robot as usize] != robot {
        parents[robot as usize] = parents[parents[robot as usize] as usize];
        robot = parents[robot as usize];
    }
    robot
}

/// Length of the mean direction of the nonzero velocities, 0 to 1; 0 if all are zero.
#[must_use]
pub fn polarisation<const D: usize>(velocities_mps: &[[f64; D]]) -> f64 {
    let directions: Vec<[f64; D]> = velocities_mps
        .iter()
        .map(|&velocity| (velocity, length(velocity)))
        .filter(|(_, length)| *length > 0.0)
        .map(|(velocity, length)| velocity.map(|c| c / length))
        .collect();
    if directions.is_empty() { 0.0 } else { length(mean(&directions)) }
}

/// Limits of alpha-flocking (OLF definition 4), with values for "few" and "bounded".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaLimits {
    /// Largest E / d^2 (e1).
    pub deviation_energy: f64,
    /// Largest K / n (e2).
    pub velocity_mismatch: f64,
    /// Smallest share of robots in a quasi-flock's largest component ("highly populated").
    pub quasi_flock_share: f64,
    /// Largest R of a cohesive group, metres. The paper only asks that some bound exists.
    pub cohesion_radius_m: f64,
}

impl AlphaLimits {
    /// e1 = 0.005, e2 = 0.001 (OLF figure 12), nine tenths connected, all in `cohesion_radius_m`.
    #[must_use]
    pub const fn paper(cohesion_radius_m: f64) -> Self {
        Self { deviation_energy: 0.005, velocity_mismatch: 0.001, quasi_flock_share: 0.9, cohesion_radius_m }
    }
}

/// The moment from which each condition holds until the end of a trace; `None`: never.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct AlphaVerdict {
    /// The largest component is large enough.
    pub quasi_flock: Option<usize>,
    /// All robots are near their centroid.
    pub cohesive: Option<usize>,
    /// E is small.
    pub evenly_spaced: Option<usize>,
    /// K is small.
    pub of_one_velocity: Option<usize>,
    /// All four conditions: alpha-flocking.
    pub alpha_flocking: Option<usize>,
    /// The graph is connected, E and K are small: strict alpha-flocking.
    pub strict: Option<usize>,
}

/// Classifies a trace. The graphs must have been measured with r = (1 + e0) d. A moment without a
/// measure meets no condition. O(moments).
#[must_use]
pub fn alpha_flocking(trace: &[Option<FlockMeasure>], limits: &AlphaLimits) -> AlphaVerdict {
    let from = |holds: &dyn Fn(&FlockMeasure) -> bool| {
        let is_broken = |moment: &Option<FlockMeasure>| !moment.as_ref().is_some_and(holds);
        let first = trace.iter().rposition(is_broken).map_or(0, |last| last + 1);
        (first < trace.len()).then_some(first)
    };
    let is_quasi = |m: &FlockMeasure| m.largest_component as f64 >= limits.quasi_flock_share * m.robots as f64;
    let is_cohesive = |m: &FlockMeasure| m.radius_m <= limits.cohesion_radius_m;
    let is_even = |m: &FlockMeasure| m.deviation_energy <= limits.deviation_energy;
    let is_still = |m: &FlockMeasure| m.velocity_mismatch <= limits.velocity_mismatch;
    AlphaVerdict {
        quasi_flock: from(&is_quasi),
        cohesive: from(&is_cohesive),
        evenly_spaced: from(&is_even),
        of_one_velocity: from(&is_still),
        alpha_flocking: from(&|m| is_quasi(m) && is_cohesive(m) && is_even(m) && is_still(m)),
        strict: from(&|m| m.components == 1 && is_even(m) && is_still(m)),
    }
}

fn minus<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|axis| a[axis] * b[axis]).sum()
}

fn squared<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a)
}

fn length<const D: usize>(a: [f64; D]) -> f64 {
    squared(a).sqrt()
}

fn mean<const D: usize>(vectors: &[[f64; D]]) -> [f64; D] {
    let mut sum = [0.0; D];
    for vector in vectors {
        for axis in 0..D {
            sum[axis] += vector[axis];
        }
    }
    sum.map(|c| c / vectors.len() as f64)
}
