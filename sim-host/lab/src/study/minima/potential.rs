//! The potential of an alpha flock in the plane, its gradient and its Hessian.

use crate::measure::Watch;
use staya_controller::flock::action::{PhiAlpha, SPACING, sigma_norm, sigmoid_shift};
use staya_controller::lattice::LatticeParams;
use staya_sim::metrics::flock::EnergyMeter;
use std::cell::RefCell;

/// Step of the descent: less than 2 over the largest curvature of a crowded start.
const STEP: f64 = 2e-3;
/// Most steps.
const STEPS: u32 = 200_000;
/// Steps between two calls of a run's watch.
const WATCHED: u32 = 1000;
/// Largest force at which a descent ends.
const FORCE: f64 = 1e-10;
/// Half the distance of finite differences, in the paper's units.
const NEAR: f64 = 1e-5;

/// V + lambda J in the paper's units. Places are in spacings d.
pub(super) struct Potential {
    d: f64,
    range: f64,
    lambda: f64,
    phi: PhiAlpha<f64>,
    meter: RefCell<EnergyMeter<2>>,
}

impl Potential {
    /// With the paper's constants.
    pub(super) fn new(lambda: f64) -> Option<Self> {
        let d = f64::from(SPACING);
        let mut params = LatticeParams::<f64>::new(d);
        params.alpha.position = 1.0;
        let range = params.range_m();
        let phi = PhiAlpha {
            r_alpha: sigma_norm(range * range).sigma,
            d_alpha: sigma_norm(d * d).sigma,
            a: params.attraction,
            b: params.repulsion,
            c: sigmoid_shift(params.attraction, params.repulsion)?,
        };
        Some(Self { d, range, lambda, phi, meter: RefCell::new(EnergyMeter::new(&params)?) })
    }

    /// Range of interaction in spacings.
    pub(super) fn range(&self) -> f64 {
        self.range / self.d
    }

    /// Potential of two robots in one place, psi(0).
    pub(super) fn collision(&self) -> f64 {
        self.meter.borrow().collision()
    }

    /// Value at these places; not a number if a place is not finite.
    pub(super) fn at(&self, places: &[[f64; 2]]) -> f64 {
        let places: Vec<[f64; 2]> = places.iter().map(|place| place.map(|c| c * self.d)).collect();
        let energy = self.meter.borrow_mut().look(&places, &vec![[0.0; 2]; places.len()]);
        let middle = mean(&places);
        let squares = places.iter().flat_map(|place| [0, 1].map(|axis| place[axis] - middle[axis]));
        let spread: f64 = squares.map(|off| off * off / 2.0).sum();
        energy.map_or(f64::NAN, |energy| energy.lattice + self.lambda * spread)
    }

    /// Gradient in the paper's units at places in these units. O(n^2).
    pub(super) fn gradient(&self, places: &[[f64; 2]], gradient: &mut Vec<[f64; 2]>) {
        let middle = mean(places);
        gradient.clear();
        gradient.extend(places.iter().map(|place| [0, 1].map(|axis| self.lambda * (place[axis] - middle[axis]))));
        let most = self.range * self.range;
        for (robot, from) in places.iter().enumerate() {
            for (other, to) in places.iter().enumerate().skip(robot + 1) {
                let [x, y] = [to[0] - from[0], to[1] - from[1]];
                let squared = x * x + y * y;
                if squared >= most {
                    continue;
                }
                let norm = sigma_norm(squared);
                let pull = self.phi.at(norm.sigma, self.phi.adjacency(norm.sigma)) * norm.slope;
                for (axis, offset) in [x, y].into_iter().enumerate() {
                    gradient[robot][axis] -= pull * offset;
                    gradient[other][axis] += pull * offset;
                }
            }
        }
    }

    /// Largest force on a robot.
    pub(super) fn force(&self, places: &[[f64; 2]]) -> f64 {
        let places: Vec<[f64; 2]> = places.iter().map(|place| place.map(|c| c * self.d)).collect();
        let mut gradient = Vec::new();
        self.gradient(&places, &mut gradient);
        largest(&gradient)
    }

    /// Descends from a start to rest: Nesterov's method, which begins again where it would rise.
    /// Also returns whether the watch has ended it.
    pub(super) fn rest(&self, start: Vec<[f64; 2]>, watch: &Watch<'_>) -> (Vec<[f64; 2]>, bool) {
        let mut places: Vec<[f64; 2]> = start.iter().map(|place| place.map(|c| c * self.d)).collect();
        let (mut ahead, mut gradient) = (places.clone(), Vec::new());
        let mut since = 0_u32;
        for step in 0..STEPS {
            if step % WATCHED == 0 && !watch(step) {
                return (places, true);
            }
            self.gradient(&ahead, &mut gradient);
            if largest(&gradient) < FORCE {
                places.clone_from(&ahead);
                break;
            }
            let momentum = f64::from(since) / f64::from(since + 3);
            let mut rise = 0.0;
            for ((place, ahead), slope) in places.iter_mut().zip(&mut ahead).zip(&gradient) {
                for axis in [0, 1] {
                    let next = ahead[axis] - STEP * slope[axis];
                    let way = next - place[axis];
                    rise += slope[axis] * way;
                    place[axis] = next;
                    ahead[axis] = next + momentum * way;
                }
            }
            since += 1;
            if rise > 0.0 {
                since = 0;
                ahead.clone_from(&places);
            }
        }
        (places.iter().map(|place| place.map(|c| c / self.d)).collect(), false)
    }

    /// The symmetric matrix of second derivatives, by central differences of the gradient.
    pub(super) fn hessian(&self, places: &[[f64; 2]]) -> Vec<Vec<f64>> {
        let mut places: Vec<[f64; 2]> = places.iter().map(|place| place.map(|c| c * self.d)).collect();
        let n = 2 * places.len();
        let (mut above, mut below) = (Vec::new(), Vec::new());
        let mut matrix = vec![vec![0.0; n]; n];
        for robot in 0..places.len() {
            for axis in [0, 1] {
                let here = places[robot][axis];
                places[robot][axis] = here + NEAR;
                self.gradient(&places, &mut above);
                places[robot][axis] = here - NEAR;
                self.gradient(&places, &mut below);
                places[robot][axis] = here;
                let (column, slopes) = (2 * robot + axis, above.iter().flatten().zip(below.iter().flatten()));
                for (row, (above, below)) in slopes.enumerate() {
                    let entry = (above - below) / (4.0 * NEAR);
                    matrix[row][column] += entry;
                    matrix[column][row] += entry;
                }
            }
        }
        matrix
    }
}

fn largest(forces: &[[f64; 2]]) -> f64 {
    forces.iter().map(|[x, y]| libm::hypot(*x, *y)).fold(0.0, f64::max)
}

fn mean(places: &[[f64; 2]]) -> [f64; 2] {
    let sum = places.iter().fold([0.0; 2], |sum, place| [sum[0] + place[0], sum[1] + place[1]]);
    sum.map(|c| c / places.len() as f64)
}
