//! Energy of an alpha flock (OLF section V), which algorithms 1 and 2 can only decrease.

use super::{mean, minus, squared};
use crate::nearby::{Cells, Found, Query, Search as _, Space};
use serde::Serialize;
use staya_controller::flock::action::{PhiAlpha, PhiBeta, SPACING, sigma_norm, sigmoid_shift};
use staya_controller::lattice::{Algorithm, LatticeParams};

const INTERVALS: usize = 4096;

/// Energy of a flock at one moment, in the paper's units (a spacing is 7, a second 1, a mass 1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Energy {
    /// K: half the squared velocities relative to their mean.
    pub kinetic: f64,
    /// c1 V: pair potential times gain, summed; pairs out of range count as at the range.
    pub lattice: f64,
    /// c1 J: half the squared distances from the centroid, times gain; 0 but in algorithm 2.
    pub reference: f64,
}

impl Energy {
    /// Structural Hamiltonian (eq. 36): H = V + K, plus the reference in algorithm 2.
    #[must_use]
    pub fn hamiltonian(&self) -> f64 {
        self.kinetic + self.lattice + self.reference
    }
}

/// Computes the energy of flocks with fixed parameters; keeps its buffers between moments.
///
/// H falls along every solution of algorithms 1 and 2 in free space (eq. 41 and the proof of
/// theorem 2): dH/dt = -c2 v' L v - c2 v' v, with the velocity gains of robots and reference. V and
/// J are multiplied by position gains; the paper omits that of V and calls that of J lambda.
///
/// H may rise near obstacles and with a bounded pull as in algorithm 3. There the energy that falls
/// (theorem 6) also has the terms [`Self::obstacle`] and [`Self::pull`] of each robot, and its
/// kinetic energy is that of velocities, not relative to their mean.
#[derive(Clone, Debug)]
pub struct EnergyMeter<const D: usize> {
    units: f64,
    range_m: f64,
    alpha: f64,
    beta: f64,
    gamma: f64,
    pull: f64,
    r_alpha: f64,
    /// psi_alpha at equidistant arguments from 0 to r_alpha, in the sigma norm.
    psi: Vec<f64>,
    d_beta: f64,
    /// psi_beta likewise, from 0 to d_beta.
    psi_beta: Vec<f64>,
    cells: Cells<f64, D>,
    found: Vec<Found<f64, D>>,
}

impl<const D: usize> EnergyMeter<D> {
    /// Creates a meter; `None` if the parameters are invalid.
    #[must_use]
    pub fn new(params: &LatticeParams<f64>) -> Option<Self> {
        let c = sigmoid_shift(params.attraction, params.repulsion).filter(|_| params.is_sound())?;
        let d = f64::from(SPACING);
        let range = d * params.range_ratio;
        let phi = PhiAlpha {
            r_alpha: sigma_norm(range * range).sigma,
            d_alpha: sigma_norm(d * d).sigma,
            a: params.attraction,
            b: params.repulsion,
            c,
        };
        let keep = d * params.obstacle_ratio;
        let phi_beta = PhiBeta { d_beta: sigma_norm(keep * keep).sigma };
        Some(Self {
            units: d / params.spacing_m,
            range_m: params.range_m(),
            alpha: params.alpha.position,
            beta: params.beta.position,
            pull: params.gamma.position,
            d_beta: phi_beta.d_beta,
            psi_beta: potential(phi_beta.d_beta, phi_beta.d_beta, |z| phi_beta.at(z, phi_beta.adjacency(z))),
            gamma: if params.algorithm == Algorithm::Two { params.gamma.position } else { 0.0 },
            r_alpha: phi.r_alpha,
            psi: potential(phi.r_alpha, phi.d_alpha, |z| phi.at(z, phi.adjacency(z))),
            cells: Cells::new(Space::OPEN, params.range_m()),
            found: Vec::new(),
        })
    }

    /// psi_alpha (eq. 16) of two robots at distance `z` in the sigma norm: 0 at the spacing,
    /// constant beyond the range. Within 1e-6 of the integral.
    #[must_use]
    pub fn pair(&self, z: f64) -> f64 {
        between(&self.psi, z / self.r_alpha)
    }

    /// c1 psi_beta of a robot's centre at this distance from an obstacle's border, metres: 0 from
    /// the distance on that is kept, greatest on the border; the paper has no value inside.
    #[must_use]
    pub fn obstacle(&self, distance_m: f64) -> f64 {
        let distance = (distance_m * self.units).max(0.0);
        self.beta * between(&self.psi_beta, sigma_norm(distance * distance).sigma / self.d_beta)
    }

    /// Potential of the bounded pull of algorithm 3 at this offset from the reference, metres: c1
    /// (sqrt(1 + z^2) - 1).
    #[must_use]
    pub fn pull(&self, offset_m: [f64; D]) -> f64 {
        self.pull * (libm::sqrt(1.0 + squared(offset_m) * self.units * self.units) - 1.0)
    }

    /// The paper's units in a metre.
    #[must_use]
    pub const fn units(&self) -> f64 {
        self.units
    }

    /// Potential of two robots in one place, psi_alpha(0) (c* of the paper) times its gain. From an
    /// energy H below (k + 1) times this, at most k pairs of robots ever collide.
    #[must_use]
    pub fn collision(&self) -> f64 {
        self.alpha * self.pair(0.0)
    }

    /// Energy of robots with these positions, metres, and velocities, m/s. `None` if there are none
    /// or a value is not finite. O(n + edges).
    ///
    /// # Panics
    /// If there are not as many velocities as positions.
    pub fn look(&mut self, places_m: &[[f64; D]], velocities_mps: &[[f64; D]]) -> Option<Energy> {
        assert_eq!(places_m.len(), velocities_mps.len(), "one velocity a robot");
        let is_sound = |vectors: &[[f64; D]]| vectors.iter().flatten().all(|c| c.is_finite());
        if places_m.is_empty() || !is_sound(places_m) || !is_sound(velocities_mps) {
            return None;
        }
        let n = places_m.len() as f64;
        let beyond = self.pair(self.r_alpha);
        // Starts with all pairs out of range, then corrects those in range.
        let mut potential = beyond * n * (n - 1.0) / 2.0;
        self.cells.rebuild(places_m);
        for (robot, &at) in (0..).zip(places_m) {
            let query = Query { at, radius: self.range_m, most: usize::MAX, except: Some(robot) };
            self.cells.within(&query, &mut self.found);
            for other in self.found.iter().filter(|other| other.index > robot) {
                let squared = other.distance_squared * self.units * self.units;
                potential += self.pair(sigma_norm(squared).sigma) - beyond;
            }
        }
        let spread = |vectors: &[[f64; D]]| {
            let middle = mean(vectors);
            let halves = vectors.iter().map(|&vector| squared(minus(vector, middle)) / 2.0);
            halves.sum::<f64>() * self.units * self.units
        };
        Some(Energy {
            kinetic: spread(velocities_mps),
            lattice: self.alpha * potential,
            reference: if self.gamma > 0.0 { self.gamma * spread(places_m) } else { 0.0 },
        })
    }
}

/// Value of a table over 0 to 1.
fn between(table: &[f64], share: f64) -> f64 {
    let place = share.clamp(0.0, 1.0) * INTERVALS as f64;
    let below = (place as usize).min(INTERVALS - 1);
    let share = place - below as f64;
    table[below] * (1.0 - share) + table[below + 1] * share
}

/// Integral of a force from `zero`, tabulated from 0 to `end` (Simpson's rule).
fn potential(end: f64, zero: f64, force: impl Fn(f64) -> f64) -> Vec<f64> {
    let step = end / INTERVALS as f64;
    let over = |from: f64, to: f64| (force(from) + 4.0 * force((from + to) / 2.0) + force(to)) * (to - from) / 6.0;
    let mut sum = 0.0;
    let mut psi = vec![0.0];
    for interval in 0..INTERVALS {
        let from = interval as f64 * step;
        sum += over(from, from + step);
        psi.push(sum);
    }
    // The integral so far begins at 0; shift it to be 0 at `zero`.
    let interval = (zero / step) as usize;
    let from = interval as f64 * step;
    let least = psi[interval.min(INTERVALS)] + over(from, zero);
    psi.iter_mut().for_each(|value| *value -= least);
    psi
}
