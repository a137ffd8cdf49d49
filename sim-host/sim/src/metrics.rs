//! What a run is measured by: how well the formation is kept, and when robots arrive.
//!
//! Source: A. V. Kuznetsov 2017 (KUZ), section 6. All sums run over robots in the order of their numbers, on one
//! thread, so that every figure is the same on any machine. Distances are Euclidean, between cells.

pub mod flock;
pub mod waits;

use crate::scenario::Formation;
use crate::terrain::Terrain;
use crate::world::Body;
use staya_controller::grid::Cell;

/// How well a formation is kept at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keeping {
    /// Mean over the robots of |desired - actual|, cells, when the graph is placed on where the top
    /// leader (robot 1) is. The leader itself counts, with 0.
    pub error_per_agent: f64,
    /// The same when the graph is placed by the translation that fits all robots best (least
    /// squares): tells a formation that is out of shape from one that only lags behind its leader.
    pub best_fit_error_per_agent: f64,
    /// Graph distance, see [`FormationMeter`].
    pub graph_distance: f64,
}

impl std::ops::AddAssign for Keeping {
    fn add_assign(&mut self, other: Self) {
        self.error_per_agent += other.error_per_agent;
        self.best_fit_error_per_agent += other.best_fit_error_per_agent;
        self.graph_distance += other.graph_distance;
    }
}

/// Measures a formation tick by tick: the formation error dPhi = (1/T) sum over robots and ticks of
/// |desired - actual|, here per robot, and the graph distance.
///
/// The graph distance is dist = m0 + m1 + kappa * sum of |desired - actual| over the common vertices,
/// with kappa = 1 / diagonal of the map and the graph placed on the top leader. A vertex is common
/// when its robot is within `eps` cells (along either axis, as in algorithm 5) of its place. m0
/// counts the places that are missed. m1 counts those of them near which (`eps` again) another
/// robot stands that has itself lost its place: without that condition every robot of a formation
/// narrower than eps would stand in for all others.
#[derive(Clone, Debug)]
pub struct FormationMeter {
    places: Vec<Cell>,
    eps: u32,
    /// 1 / diagonal of the map, 1/cells.
    kappa: f64,
    ticks: u32,
    sum: Keeping,
    errors: Vec<f64>,
    missing: Vec<usize>,
}

impl FormationMeter {
    /// A meter that has measured nothing yet.
    #[must_use]
    pub fn new(formation: &Formation, eps: u8, terrain: &Terrain) -> Self {
        let [width, height] = [terrain.width(), terrain.height()].map(|side| f64::from(side) - 1.0);
        let diagonal = (width * width + height * height).sqrt().max(1.0);
        Self {
            places: formation.places.clone(),
            eps: eps.into(),
            kappa: 1.0 / diagonal,
            ticks: 0,
            sum: Keeping { error_per_agent: 0.0, best_fit_error_per_agent: 0.0, graph_distance: 0.0 },
            errors: Vec::new(),
            missing: Vec::new(),
        }
    }

    /// Takes one tick into the means; see [`FormationMeter::look`].
    ///
    /// # Panics
    /// When there are no bodies, or more of them than places.
    pub fn measure(&mut self, bodies: &[Body]) -> Keeping {
        let now = self.look(bodies);
        self.sum += now;
        self.ticks += 1;
        now
    }

    /// How the formation is kept right now; `bodies[i]` is the robot of place i. O(n), and O(m^2) for
    /// m lost robots.
    ///
    /// # Panics
    /// When there are no bodies, or more of them than places.
    pub fn look(&mut self, bodies: &[Body]) -> Keeping {
        let top = offset(bodies[0].cell, self.places[0]);
        self.errors.clear();
        self.missing.clear();
        let (mut graph, mut mean) = (0.0, [0.0; 2]);
        for (index, body) in bodies.iter().enumerate() {
            let [x, y] = offset(body.cell, self.places[index]);
            let off = [x - top[0], y - top[1]];
            mean = [mean[0] + f64::from(x), mean[1] + f64::from(y)];
            let error = length(off.map(f64::from));
            self.errors.push(error);
            if off.iter().all(|d| d.unsigned_abs() <= self.eps) {
                graph += self.kappa * error;
            } else {
                self.missing.push(index);
            }
        }
        let count = bodies.len() as f64;
        let mean = mean.map(|sum| sum / count);
        let fit: f64 = bodies
            .iter()
            .zip(&self.places)
            .map(|(body, &place)| {
                let [x, y] = offset(body.cell, place);
                length([f64::from(x) - mean[0], f64::from(y) - mean[1]])
            })
            .sum();
        Keeping {
            error_per_agent: self.errors.iter().sum::<f64>() / count,
            best_fit_error_per_agent: fit / count,
            graph_distance: graph + (self.missing.len() + self.taken(bodies, top)) as f64,
        }
    }

    /// How many of the missed places have another lost robot near them.
    fn taken(&self, bodies: &[Body], top: [i32; 2]) -> usize {
        let is_near = |place: usize, robot: usize| {
            let [x, y] = offset(bodies[robot].cell, self.places[place]);
            (x - top[0]).unsigned_abs() <= self.eps && (y - top[1]).unsigned_abs() <= self.eps
        };
        let missing = self.missing.iter();
        missing.filter(|&&place| self.missing.iter().any(|&robot| is_near(place, robot))).count()
    }

    /// Distance of each robot from its place when it was looked at last, cells, graph on the top leader.
    #[must_use]
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// The means over all ticks so far; `None` before the first.
    #[must_use]
    pub fn mean(&self) -> Option<Keeping> {
        let ticks = f64::from(self.ticks);
        (self.ticks > 0).then(|| Keeping {
            error_per_agent: self.sum.error_per_agent / ticks,
            best_fit_error_per_agent: self.sum.best_fit_error_per_agent / ticks,
            graph_distance: self.sum.graph_distance / ticks,
        })
    }
}

/// `cell - place` without saturation.
fn offset(cell: Cell, place: Cell) -> [i32; 2] {
    [i32::from(cell.x) - i32::from(place.x), i32::from(cell.y) - i32::from(place.y)]
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// When each robot came to its target for good.
#[derive(Clone, Debug)]
pub struct Arrivals {
    at: Vec<Option<u64>>,
    count: usize,
}

impl Arrivals {
    /// Nobody has arrived.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        Self { at: vec![None; robots], count: 0 }
    }

    /// Takes note of whether robot number `index` stands at its target now; `free_at` is when its
    /// body's last crossing ends, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick. A robot
    /// that leaves its target has not arrived.
    pub fn note(&mut self, index: usize, is_there: bool, free_at: u64) {
        let before = self.at[index];
        let now = is_there.then_some(before.unwrap_or(free_at));
        self.at[index] = now;
        self.count = self.count + usize::from(now.is_some()) - usize::from(before.is_some());
    }

    /// How many robots stand at their targets.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Whether all do.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.count == self.at.len()
    }

    /// When each robot's last move was over, [`UNIT`](staya_controller::grid::UNIT)ths of a tick
    /// after the start: the travel time of KUZ eq. 7, waiting included. `None`: not there.
    #[must_use]
    pub fn times(&self) -> &[Option<u64>] {
        &self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::grid::Dir;
    use staya_controller::robot::RobotId;

    fn bodies(cells: &[(i16, i16)]) -> Vec<Body> {
        (1..)
            .zip(cells)
            .map(|(id, &(x, y))| Body { id: RobotId(id), cell: Cell::new(x, y), entered_by: Dir::Stay, free_at: 0 })
            .collect()
    }

    fn meter(places: &[(i16, i16)], eps: u8) -> FormationMeter {
        let formation = Formation {
            places: places.iter().map(|&(x, y)| Cell::new(x, y)).collect(),
            edges: Vec::new(),
            templates: Vec::new(),
        };
        // Diagonal: 5 cells.
        FormationMeter::new(&formation, eps, &Terrain::flat(5, 4))
    }

    #[test]
    fn a_formation_in_place_has_no_error_anywhere_on_the_map() {
        let mut meter = meter(&[(0, 0), (-3, 0), (0, -3)], 2);
        for (x, y) in [(0, 0), (30, -7), (i16::MAX, i16::MAX)] {
            let now = meter.measure(&bodies(&[(x, y), (x - 3, y), (x, y - 3)]));
            let none = Keeping { error_per_agent: 0.0, best_fit_error_per_agent: 0.0, graph_distance: 0.0 };
            assert_eq!(now, none);
            assert_eq!(meter.errors(), [0.0; 3]);
        }
    }

    #[test]
    fn errors_are_per_robot_and_mean_over_ticks() {
        let mut meter = meter(&[(0, 0), (-3, 0)], 5);
        assert!(meter.mean().is_none());
        // Robot 2 is off by (3, 4), half of which a translation explains.
        let now = meter.measure(&bodies(&[(10, 10), (10, 14)]));
        assert_eq!(meter.errors(), [0.0, 5.0]);
        assert_eq!((now.error_per_agent, now.best_fit_error_per_agent), (2.5, 2.5));
        assert_eq!(now.graph_distance, 1.0);
        meter.measure(&bodies(&[(10, 10), (7, 10)]));
        meter.look(&bodies(&[(10, 10), (90, 90)]));
        let mean = meter.mean().expect("two ticks");
        assert_eq!((mean.error_per_agent, mean.graph_distance), (1.25, 0.5));
    }

    #[test]
    fn best_fit_does_not_blame_all_for_a_leader_that_runs_ahead() {
        let mut meter = meter(&[(0, 0), (-3, 0), (-6, 0), (-9, 0)], 5);
        let now = meter.measure(&bodies(&[(14, 0), (7, 0), (4, 0), (1, 0)]));
        assert_eq!(now.error_per_agent, 3.0);
        assert_eq!(now.best_fit_error_per_agent, 1.5);
    }

    #[test]
    fn graph_distance_counts_missing_places_and_strangers_on_them() {
        let places = [(0, 0), (-3, 0), (-6, 0)];
        // The place of robot 2 is missed; robot 3 is near it but has its own: only m0.
        let now = meter(&places, 3).measure(&bodies(&[(10, 0), (90, 0), (4, 0)]));
        assert_eq!(now.graph_distance, 1.0);
        // Robots 2 and 3 have changed places: m0 = m1 = 2.
        let now = meter(&places, 2).measure(&bodies(&[(10, 0), (4, 0), (7, 0)]));
        assert_eq!(now.graph_distance, 4.0);
        // Just within eps.
        let now = meter(&places, 3).measure(&bodies(&[(10, 0), (4, 0), (7, 0)]));
        assert!((now.graph_distance - 6.0 / 5.0).abs() < 1e-12);
    }

    #[test]
    fn who_leaves_his_target_has_not_arrived() {
        let mut arrivals = Arrivals::new(2);
        arrivals.note(0, true, 70);
        arrivals.note(0, true, 700);
        assert_eq!((arrivals.count(), arrivals.times()), (1, &[Some(70), None][..]));
        arrivals.note(0, false, 700);
        arrivals.note(1, true, 99);
        assert_eq!((arrivals.count(), arrivals.times()), (1, &[None, Some(99)][..]));
        assert!(!arrivals.is_complete());
        arrivals.note(0, true, 800);
        assert!(arrivals.is_complete());
    }
}
